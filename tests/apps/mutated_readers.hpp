#pragma once

// Each reader on files with bytes changed, cut out, doubled or put in, thousands a minute: within a child of
// this process, so that a crash or a hang is one file's and is counted. It ends soon, in little memory, with
// what it read or with one sentence. CLEARWAY_MUTATIONS sets how many of each format. mutated_inputs_test
// runs the whole program on such files.

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <vector>

#include "apps/console/failure.hpp"
#include "tests/worlds/mutated_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr unsigned longest_read = 60;  // sanitizers take many times the time and the memory
inline constexpr long most_kilobytes = 16 * 1024 * 1024;
#else
inline constexpr unsigned longest_read = 5;  ///< seconds for one file
inline constexpr long most_kilobytes = 128 * 1024;
#endif

/// A line of /proc/self/status that begins with `key`, in kB.
inline long status_kilobytes(const char* key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::atol(line.c_str() + std::string_view(key).size() + 1);
  }
  return 0;
}

/// What a reader threw says something, and nothing that would need to be escaped for a terminal.
inline bool is_plain_refusal(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& caught) {
    const std::string_view text = caught.what();
    return !text.empty() && std::all_of(text.begin(), text.end(),
                                        [](char c) { return static_cast<unsigned char>(c) >= 0x20; });
  }
}

/// What the child shares with its parent.
struct MutationProgress {
  int at = 0;         ///< the file under way
  int refused = 0;    ///< of those before it
  char find[2000]{};  ///< what is wrong with it; "" when it ended the child
};

class MutatedReaders : public ::testing::Test {
 protected:
  using Read = std::function<void(const std::filesystem::path&)>;
  using ReadAll = std::function<void(const std::vector<std::filesystem::path>&)>;
  using Mutate = std::function<std::string(const std::string& whole, std::mt19937& random)>;

  MutatedReaders()
      : progress_(static_cast<MutationProgress*>(::mmap(
            nullptr, sizeof(MutationProgress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~MutatedReaders() override { ::munmap(progress_, sizeof(MutationProgress)); }

  /// `read` gets `folder/file`, of which `whole` is the sound content, which it must accept.
  void expect_read_or_refused(const std::string& file, const std::string& whole, const Read& read,
                              const Mutate& mutate = mutated) {
    folder_.write(file, whole);
    ASSERT_NO_THROW(read(folder_.path() / file)) << file;
    const auto write = [&](std::mt19937& random) {
      const std::string bytes = mutate(whole, random);
      folder_.write(file, bytes);
      return bytes.size();
    };
    expect_ends(file, mutations(25), write, [&] { read(folder_.path() / file); });
    folder_.write(file, whole);
  }

  /// The same of files that a reader decodes in one child, which takes longer to begin than a file to read:
  /// `read` gets many at a time, numbered from 1, of which the first is sound, in the time that one may take.
  /// It throws where one of them is refused.
  void expect_all_read_or_refused(const std::filesystem::path& place, const std::string& end,
                                  const std::string& whole, const ReadAll& read) {
    constexpr int together = 25;
    std::vector<std::filesystem::path> files;
    for (int i = 1; i <= 1 + together; ++i)
      files.emplace_back(folder_.write(place / (std::to_string(i) + end), whole));
    ASSERT_NO_THROW(read(files)) << end;
    const auto write = [&](std::mt19937& random) {
      std::size_t largest = 0;
      for (auto file = files.begin() + 1; file != files.end(); ++file) {
        const std::string bytes = mutated(whole, random);
        write_file(*file, bytes);
        largest = std::max(largest, bytes.size());
      }
      return largest;
    };
    expect_ends(place, (mutations(25) + together - 1) / together, write, [&] { read(files); });
    for (const std::filesystem::path& file : files) std::filesystem::remove(file);
  }

  /// A file of the repository.
  static std::string source(const std::string& file) {
    return read_file(std::filesystem::path(CLEARWAY_SOURCE_DIR) / file);
  }

  TemporaryFolder folder_;

 private:
  /// Puts changed bytes into `folder/place` and gives their number.
  using Write = std::function<std::size_t(std::mt19937& random)>;

  void expect_ends(const std::filesystem::path& place, int count, const Write& write,
                   const std::function<void()>& read) {
    *progress_ = {};
    while (progress_->at < count) {
      const int status = run_child(count, write, read);
      if (progress_->at >= count) break;
      const std::string kept = ::testing::TempDir() + "mutated-" + std::to_string(progress_->at) + "-" +
                               (place.empty() ? "files" : place.filename().string());
      std::filesystem::copy(
          folder_.path() / place, kept,
          std::filesystem::copy_options::overwrite_existing | std::filesystem::copy_options::recursive);
      ADD_FAILURE() << kept << ": "
                    << (progress_->find[0] != '\0'    ? progress_->find
                        : !WIFSIGNALED(status)        ? "it ended the program"
                        : WTERMSIG(status) == SIGALRM ? "not read in time"
                                                      : ::strsignal(WTERMSIG(status)));
      progress_->find[0] = '\0';
      ++progress_->at;
    }
    EXPECT_GT(progress_->refused, count / 10) << place << ": hardly one was refused";
  }

  int run_child(int count, const Write& write, const std::function<void()>& read) {
    const pid_t child = ::fork();
    if (child == 0) {
      while (progress_->at < count) {
        std::mt19937 random(static_cast<unsigned>(progress_->at));
        if (!is_read_or_refused(write(random), read)) ::_exit(1);
        ++progress_->at;
      }
      ::_exit(0);
    }
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

  void found(const std::string& what) const {
    std::snprintf(progress_->find, sizeof(progress_->find), "%s", what.c_str());
  }

  bool is_read_or_refused(std::size_t size, const std::function<void()>& read) const {
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak of memory begins anew
    const long before = status_kilobytes("VmRSS:");
    ::alarm(longest_read);
    try {
      read();
    } catch (...) {
      ++progress_->refused;
      const Failure failure = failure_of(std::current_exception());
      if (failure.sentence.starts_with("a library that") || failure.sentence.starts_with("out of memory") ||
          failure.sentence.size() > 700 || !is_plain_refusal(std::current_exception())) {
        found("not a sentence of ours: " + failure.sentence);
        return false;
      }
    }
    ::alarm(0);
    rusage children{};  // of readers that decode in a child of their own
    ::getrusage(RUSAGE_CHILDREN, &children);
    const long taken = std::max(status_kilobytes("VmHWM:"), children.ru_maxrss) - before;
    if (taken <= most_kilobytes + 20 * static_cast<long>(size) / 1024) return true;
    found("it took " + std::to_string(taken) + " kB");
    return false;
  }

  MutationProgress* progress_;
};

}  // namespace clearway
