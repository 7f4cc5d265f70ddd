#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "apps/fusion/open_frames.hpp"
#include "apps/teach/teach_session.hpp"
#include "mapping/system/file_descriptor.hpp"

namespace clearway {

/// What a teaching session was made from, kept in DIR/session so that it can be done again: the source, the
/// setup's text and the settings; the events are beside them, in events.jsonl.
struct RecordedSession {
  std::filesystem::path source;      ///< once loaded, in the folder
  std::filesystem::path setup_file;  ///< where the setup's text came from; empty: embedded in the source
  std::string setup_text;
  double resolution = 0.0;    ///< m; 0: the setup's
  std::string integration{};  ///< empty: the setup's
  std::uint64_t seed = 1;
  double time_limit = 60.0;        ///< s
  std::filesystem::path folder{};  ///< that its relative paths are of; empty: the current one
  /// Once loaded, where its copies of the files lie that it read beside its source: camera, robots, loads, …
  std::map<std::string, std::filesystem::path> inputs{};
};

/// Whether a folder holds a recorded session.
bool is_session_folder(const std::filesystem::path& folder);

/// @throws std::invalid_argument when a session is to be written over, by the name of the flag --out
void require_no_session(const std::filesystem::path& out);

/// Writes session.json, setup.yaml and `inputs`, what was read besides (InputKeeper::kept), and takes the
/// source into the folder: as a copy, above 256 MB as hard links where the disk allows it. Live frames are
/// recorded there: before they are all there, and after, the same call writes what is known.
/// @throws std::runtime_error naming the file that cannot be written
void save_session(const RecordedSession& session, const std::map<std::string, std::string>& inputs,
                  const std::filesystem::path& folder);

/// events.jsonl: what was done or refused, but for what came too late, in order.
void save_session_events(const std::vector<TaughtEvent>& events, const std::filesystem::path& folder);

/// The same file while a session goes on: what is written outlives the process, however it ends.
class GrowingEvents {
 public:
  /// @throws std::runtime_error naming the file that cannot be written, as `add` does
  explicit GrowingEvents(const std::filesystem::path& folder);
  /// @param events of the session up to now, of which the new ones are written
  void add(const std::vector<TaughtEvent>& events);

 private:
  std::filesystem::path file_;
  FileDescriptor open_;
  std::size_t written_ = 0;
};

/// @throws std::invalid_argument naming the file and the field that is wrong
RecordedSession load_session(const std::filesystem::path& folder);

/// Its setup, which is read as if it lay where it came from.
ChosenSetup setup_of(const RecordedSession& session);

}  // namespace clearway
