#include "mapping/system/input_file.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

std::string kind(mode_t mode) {
  if (S_ISDIR(mode)) return "it is a folder";
  if (S_ISFIFO(mode)) return "it is a pipe";
  if (S_ISSOCK(mode)) return "it is a socket";
  return "it is a device";
}

constexpr std::size_t largest_kept = 100U << 20U;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Under which it is kept that a file was not there.
std::string absence_of(const std::string& key) { return "absent: " + key; }

}  // namespace

struct InputKeeper::Store {
  static inline std::mutex mutex;  ///< of all that follows
  static inline Store* current = nullptr;
  /// A forked process is a copy: the mutex, held by a thread that is not in it, would be held for ever.
  static inline const int guard_forks =
      ::pthread_atfork([] { mutex.lock(); }, [] { mutex.unlock(); }, [] { mutex.unlock(); });

  fs::path whole(const fs::path& file) const { return (folder / file).lexically_normal(); }
  std::string key_of(const fs::path& file) const { return plain(whole(file).string()); }

  bool is_apart(const fs::path& file) const {
    std::error_code error;
    const std::string place = fs::weakly_canonical(file, error).string();
    return std::any_of(apart.begin(), apart.end(), [&](const std::string& folder) {
      return place == folder || place.starts_with(folder + "/");
    });
  }

  void keep(const fs::path& file, const fs::path& place) {
    std::error_code error;
    const std::string key = key_of(file);
    if (kept.contains(key) || !fs::is_regular_file(place, error)) return;
    if (is_apart(file) || is_apart(whole(file))) return;
    if (fs::file_size(place, error) <= largest_kept && !error) kept[key] = bytes_of(place);
  }

  std::map<std::string, fs::path> given;
  std::map<std::string, std::string> kept;
  std::vector<std::string> apart;
  fs::path folder;
};

InputKeeper::InputKeeper(std::map<std::string, fs::path> given, const std::vector<fs::path>& apart,
                         fs::path folder)
    : store_(std::make_unique<Store>()) {
  store_->given = std::move(given);
  store_->folder = folder.empty() ? fs::current_path() : std::move(folder);
  for (const fs::path& place : apart) {
    std::error_code error;
    if (!place.empty()) store_->apart.push_back(fs::weakly_canonical(place, error).string());
  }
  const std::lock_guard lock(Store::mutex);
  if (Store::current != nullptr) throw std::logic_error("inputs are kept already");
  Store::current = store_.get();
}

InputKeeper::~InputKeeper() {
  const std::lock_guard lock(Store::mutex);
  Store::current = nullptr;
}

std::map<std::string, std::string> InputKeeper::kept() const {
  const std::lock_guard lock(Store::mutex);
  return store_->kept;
}

NamelessFile::NamelessFile(std::string_view bytes) {
  const FileDescriptor made(::memfd_create("input", MFD_CLOEXEC));
  descriptor_ = FileDescriptor(::fcntl(made.number(), F_DUPFD_CLOEXEC, 3));
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t written = ::write(descriptor(), bytes.data() + at, bytes.size() - at);
    if (written <= 0) throw std::runtime_error("there is no memory for it");
    at += static_cast<std::size_t>(written);
  }
}

std::string NamelessFile::name() const { return "/proc/self/fd/" + std::to_string(descriptor()); }

namespace {

thread_local const HeldInput* innermost_held = nullptr;

}  // namespace

HeldInput::HeldInput(fs::path file, std::string_view bytes)
    : file_(std::move(file)), bytes_(bytes), outer_(std::exchange(innermost_held, this)) {}

HeldInput::~HeldInput() { innermost_held = outer_; }

const NamelessFile* HeldInput::of(const fs::path& file) {
  for (const HeldInput* held = innermost_held; held != nullptr; held = held->outer_)
    if (held->file_ == file) return &held->bytes_;
  return nullptr;
}

fs::path input_place(const fs::path& file) {
  if (const NamelessFile* held = HeldInput::of(file)) return held->name();
  const std::lock_guard lock(InputKeeper::Store::mutex);
  InputKeeper::Store* store = InputKeeper::Store::current;
  if (store == nullptr) return file;
  const auto given = store->given.find(store->key_of(file));
  fs::path place = given == store->given.end() ? file : given->second;
  store->keep(file, place);
  return place;
}

fs::path whole_input_path(const fs::path& file) {
  const std::lock_guard lock(InputKeeper::Store::mutex);
  const InputKeeper::Store* store = InputKeeper::Store::current;
  return (store == nullptr ? fs::current_path() : store->folder) / file;  // also of none
}

bool is_input_there(const fs::path& file) {
  std::error_code error;
  const bool is_there = fs::is_regular_file(file, error);
  const std::lock_guard lock(InputKeeper::Store::mutex);
  InputKeeper::Store* store = InputKeeper::Store::current;
  if (store == nullptr) return is_there;
  const std::string key = store->key_of(file), absence = absence_of(key);
  if (store->given.contains(key)) return true;
  if (is_there && !store->given.contains(absence)) return true;
  store->kept[absence] = "";
  return false;
}

std::string kept_answer(const std::string& asked, const std::function<std::string()>& ask) {
  const std::string question = plain(asked);
  std::unique_lock lock(InputKeeper::Store::mutex);
  InputKeeper::Store* store = InputKeeper::Store::current;
  if (store == nullptr) {
    lock.unlock();
    return ask();
  }
  if (const auto given = store->given.find(question); given != store->given.end())
    return store->kept[question] = bytes_of(given->second);
  lock.unlock();
  const std::string answer = ask();
  lock.lock();
  return store->kept[question] = answer;
}

namespace {

// A pipe without a writer would keep a plain open() waiting; which file it is, is only certain once open.
constexpr int to_read = O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC;

FileDescriptor open_in(const FileDescriptor& folder, const fs::path& file) {
  const fs::path place = input_place(file);
  return FileDescriptor(place == file ? ::openat(folder.number(), file.filename().c_str(), to_read)
                                      : ::open(place.c_str(), to_read));  // held or given
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& file, const std::string& what)
    : name_(what + " " + quote_path(file.string())), descriptor_(::open(input_place(file).c_str(), to_read)) {
  require_regular();
}

InputFile::InputFile(const FileDescriptor& folder, const std::filesystem::path& file, const std::string& what)
    : name_(what + " " + quote_path(file.string())), descriptor_(open_in(folder, file)) {
  require_regular();
}

void InputFile::require_regular() {
  if (!descriptor_.is_open()) refuse(errno == ENXIO ? "it is not a regular file" : std::strerror(errno));
  struct stat status {};
  if (::fstat(descriptor(), &status) != 0) refuse(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) refuse(kind(status.st_mode) + ", expected a regular file");
  size_ = static_cast<std::size_t>(status.st_size);
}

std::string InputFile::read(std::size_t largest) const {
  if (size_ > largest) refuse_size(largest);
  std::string bytes(size_ + 1, '\0');  // one more: files of /proc say that they have no size
  std::size_t done = 0;
  for (;;) {
    const ssize_t got = ::read(descriptor(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
    if (done > largest) refuse_size(largest);
    if (done == bytes.size()) bytes.resize(2 * bytes.size());
  }
  if (done < size_) refuse("it became shorter while it was read");
  bytes.resize(done);
  return bytes;
}

void InputFile::read_at(std::size_t from, std::size_t count, std::string& piece) const {
  piece.resize(count);
  std::size_t done = 0;
  while (done < count) {
    const ssize_t got =
        ::pread(descriptor(), piece.data() + done, count - done, static_cast<off_t>(from + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::strerror(errno));
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  piece.resize(done);
}

void InputFile::refuse(const std::string& why) const {
  throw std::invalid_argument(name_ + " cannot be read: " + why);
}

void InputFile::refuse_size(std::size_t largest) const {
  const bool megabytes = largest >= 1U << 20U;
  refuse("it has more than " + std::to_string(largest >> (megabytes ? 20U : 10U)) +
         (megabytes ? " MB" : " kB") + ", the most that is read");
}

InputFolder::InputFolder(fs::path folder)
    : folder_(std::move(folder)),
      descriptor_(::open(folder_.empty() ? "." : folder_.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC)) {
  if (!descriptor_.is_open())
    throw std::invalid_argument("folder " + quote_path(folder_.string()) +
                                " cannot be read: " + std::strerror(errno));
}

std::optional<std::string> InputFolder::read(const std::string& name, const std::string& what,
                                             std::size_t largest) {
  const fs::path file = folder_ / name;
  struct stat status {};
  const bool is_missing = input_place(file) == file &&
                          ::fstatat(descriptor_.number(), name.c_str(), &status, AT_SYMLINK_NOFOLLOW) != 0 &&
                          errno == ENOENT;
  asked_[name] = stamp_of(file);  // before it is read: what changes while it is read is seen in the end
  if (is_missing) return std::nullopt;
  return InputFile(descriptor_, file, what).read(largest);
}

std::optional<InputFolder::Stamp> InputFolder::stamp_of(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return Stamp{static_cast<std::int64_t>(status.st_dev),
               static_cast<std::int64_t>(status.st_ino),
               static_cast<std::int64_t>(status.st_size),
               status.st_mtim.tv_sec,
               status.st_mtim.tv_nsec,
               status.st_ctim.tv_sec,
               status.st_ctim.tv_nsec};
}

bool InputFolder::is_unchanged() const {
  struct stat opened {
  }, named{};
  if (::fstat(descriptor_.number(), &opened) != 0 ||
      ::stat(folder_.empty() ? "." : folder_.c_str(), &named) != 0)
    return false;
  if (opened.st_dev != named.st_dev || opened.st_ino != named.st_ino) return false;
  return std::all_of(asked_.begin(), asked_.end(),
                     [&](const auto& file) { return stamp_of(folder_ / file.first) == file.second; });
}

std::string read_input(const std::filesystem::path& file, const std::string& what, std::size_t largest) {
  return InputFile(file, what).read(largest);
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

void require_input(const std::filesystem::path& file, const std::string& what) {
  static_cast<void>(InputFile(file, what));
}

}  // namespace clearway
