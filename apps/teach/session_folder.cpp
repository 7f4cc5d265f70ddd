#include "apps/teach/session_folder.hpp"

#include <fcntl.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* format = "clearway session 1";

/// std::filesystem::copy_file calls a full disk an input/output error.
void copy_bytes(const fs::path& from, const fs::path& to) {
  std::ifstream source(from, std::ios::binary);
  if (!source) throw std::runtime_error("'" + from.string() + "' cannot be read: " + std::strerror(errno));
  const FileDescriptor copy(::open(to.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!copy.is_open()) fail_to_write(to);
  std::string piece(1 << 20, '\0');
  while (source) {
    source.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    write_all(copy, std::string_view(piece).substr(0, static_cast<std::size_t>(source.gcount())), to);
  }
  if (source.bad()) throw std::runtime_error("'" + from.string() + "' cannot be read to its end");
}

/// Whether all that lies there is small enough for a copy, which stays as it is when the original is written
/// over.
bool is_small(const fs::path& source) {
  constexpr std::uintmax_t largest_copy = std::uintmax_t{256} << 20U;
  std::error_code error;
  if (!fs::is_directory(source)) return fs::file_size(source, error) <= largest_copy;
  std::uintmax_t size = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source))
    if (entry.is_regular_file(error)) size += entry.file_size(error);
  return size <= largest_copy;
}

/// A copy, or a hard link where the disk allows it.
void take_file(const fs::path& from, const fs::path& to, bool is_copied) {
  std::error_code error;
  if (!is_copied) fs::create_hard_link(fs::canonical(from), to, error);
  if (is_copied || error) copy_bytes(from, to);
}

void take_source(const fs::path& from, const fs::path& to) {
  const bool is_copied = is_small(from);
  fs::create_directories(to.parent_path());
  if (!fs::is_directory(from)) return take_file(from, to, is_copied);
  fs::create_directory(to);
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path place = to / fs::relative(entry.path(), from);
    if (entry.is_directory())
      fs::create_directories(place);
    else if (entry.is_regular_file())
      take_file(entry.path(), place, is_copied);
    else  // a link to nothing, a pipe: damage of the source, which is to be reported again
      fs::create_symlink(fs::absolute(entry.path()), place);
  }
}

/// Of a file's bytes; of one that cannot be read, which is damage of the source, "none".
std::string digest_of_file(const fs::path& file) {
  try {
    return fs::is_regular_file(file) ? file_sha256(file) : "none";
  } catch (const std::runtime_error&) {
    return "none";
  }
}

/// Of a file; of a folder, of the names and digests of all files below it, in the order of the names.
std::string digest_of(const fs::path& source) {
  if (!fs::is_directory(source)) return fs::is_regular_file(source) ? digest_of_file(source) : "";
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(source))
    if (!entry.is_directory())
      files[entry.path().lexically_relative(source).generic_string()] = digest_of_file(entry.path());
  std::string text;
  for (const auto& [name, digest] : files) text += digest + "  " + name + '\n';
  return sha256(text);
}

/// The end of a path or question, which says what kind of file it is, in letters that any disk takes.
std::string kept_name(const std::string& name) {
  std::string last = fs::path(name).filename().string();
  if (last.size() > 100) last.erase(0, last.size() - 100);
  for (char& c : last) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_letter && c != '.' && c != '-') c = '_';
  }
  return last.find_first_not_of('.') == std::string::npos ? "answer" : last;
}

/// files/001/camera.yaml for the first of them: names of our own, which end as the files' do.
Json save_inputs(const std::map<std::string, std::string>& inputs, const fs::path& folder) {
  Json list = Json::array();
  for (const auto& [name, bytes] : inputs) {
    std::string number = std::to_string(list.size() + 1);
    number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
    const fs::path kept = fs::path("files") / number / kept_name(name);
    fs::create_directories((folder / kept).parent_path());
    save_file(folder / kept, bytes);
    list.push_back({{"of", name}, {"file", kept.string()}, {"sha256", sha256(bytes)}});
  }
  return list;
}

/// What an earlier save has left in files/ that is not in the list.
void remove_others(const Json& list, const fs::path& folder) {
  std::set<fs::path> kept;
  for (const Json& entry : list) kept.insert(folder / entry["file"].get<std::string>());
  std::error_code error;
  for (const auto& number : fs::directory_iterator(folder / "files", error)) {
    for (const auto& entry : fs::directory_iterator(number))
      if (!kept.contains(entry.path())) fs::remove(entry.path(), error);
    fs::remove(number.path(), error);  // if it is empty
  }
}

/// A path in the session's folder. @throws std::invalid_argument for one that leads out of it
fs::path inner_path(const JsonField& field) {
  const fs::path path = field.text();
  if (path.is_absolute() || path.lexically_normal().string().starts_with(".."))
    field.refuse("a file in this folder");
  return path;
}

std::map<std::string, fs::path> load_inputs(const JsonField& field, const fs::path& folder) {
  std::map<std::string, fs::path> inputs;
  for (const JsonField& entry : field.items()) {
    const fs::path kept = inner_path(entry.at("file"));
    if (sha256(read_input(folder / kept, "file of a session", 1U << 27U)) != entry.at("sha256").text())
      throw std::invalid_argument("session " + quote_path(folder.string()) + ": its file " +
                                  quote_path(kept.string()) + " is not the one that it was made from");
    inputs[entry.at("of").text()] = folder / kept;
  }
  return inputs;
}

}  // namespace

bool is_session_folder(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "session.json", error);
}

void require_no_session(const fs::path& out) {
  if (is_session_folder(out))
    throw std::invalid_argument("--out: " + quote_path(out.string()) +
                                " is a recorded session, which stays as it is: expected another folder");
}

void save_session(const RecordedSession& session, const std::map<std::string, std::string>& inputs,
                  const fs::path& folder) {
  const fs::path source =
      fs::path("source") / plain(fs::weakly_canonical(session.source).filename().string());
  const fs::path kept = folder / source;
  if (session.source != kept && !fs::exists(kept)) take_source(session.source, kept);
  const Json json{
      {"format", format},
      {"source", source.string()},
      {"sha256", digest_of(kept)},
      {"setup_file", plain(session.setup_file.empty() ? "" : fs::absolute(session.setup_file).string())},
      {"folder", plain((session.folder.empty() ? fs::current_path() : session.folder).string())},
      {"resolution", session.resolution},
      {"integration", session.integration},
      {"seed", session.seed},
      {"time_limit", session.time_limit},
      {"files", save_inputs(inputs, folder)}};
  save_file(folder / "session.json", json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  if (!session.setup_text.empty()) save_file(folder / "setup.yaml", session.setup_text);
  remove_others(json["files"], folder);
}

void save_session_events(const std::vector<TaughtEvent>& events, const fs::path& folder) {
  std::string text;
  for (const TaughtEvent& event : events)
    if (!event.is_late) text += to_json_line(event.event) + "\n";
  save_file(folder / "events.jsonl", text);
}

GrowingEvents::GrowingEvents(const fs::path& folder)
    : file_(folder / "events.jsonl"),
      open_(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666)) {
  if (!open_.is_open()) fail_to_write(file_);
}

void GrowingEvents::add(const std::vector<TaughtEvent>& events) {
  for (; written_ < events.size(); ++written_)
    if (const TaughtEvent& event = events[written_]; !event.is_late)
      write_all(open_, to_json_line(event.event) + "\n", file_);
}

RecordedSession load_session(const fs::path& folder) {
  const fs::path file = folder / "session.json";
  const std::string text = read_input(file, "session", 1U << 20U);
  require_json(text, quote_path(file.string()));
  const Json json = Json::parse(text);
  const JsonField field(json, "session " + quote_path(file.string()));
  if (field.at("format").text() != format) field.at("format").refuse("'" + std::string(format) + "'");
  RecordedSession session;
  const fs::path source = inner_path(field.at("source"));
  session.source = folder / source;
  const std::string digest = field.at("sha256").text();
  if (!digest.empty() && digest_of(session.source) != digest)
    throw std::invalid_argument("session " + quote_path(folder.string()) + ": its recording " +
                                quote_path(source.string()) + " is not the one that it was made from");
  session.setup_file = field.at("setup_file").text();
  if (field.has("folder")) session.folder = field.at("folder").text();
  session.resolution = field.at("resolution").number();
  if (session.resolution != 0.0 && !(session.resolution >= 1e-4 && session.resolution <= 100.0))
    field.at("resolution").refuse("0, or 0.0001 to 100 (metres)");
  session.integration = field.at("integration").text();
  if (!session.integration.empty() && session.integration != "safe" && session.integration != "compatible")
    field.at("integration").refuse("safe or compatible");
  session.seed = field.at("seed").count();
  session.time_limit = field.at("time_limit").number();
  if (!(session.time_limit > 0.0)) field.at("time_limit").refuse("seconds, more than 0");
  if (field.has("files")) session.inputs = load_inputs(field.at("files"), folder);
  if (!session.setup_file.empty()) session.setup_text = read_text(folder / "setup.yaml", "setup");
  return session;
}

ChosenSetup setup_of(const RecordedSession& session) {
  if (session.setup_file.empty()) return choose_setup(session.source, {});
  return {parse_setup(session.setup_text, session.setup_file.string()), session.setup_file.string()};
}

}  // namespace clearway
