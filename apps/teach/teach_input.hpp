#pragma once

#include <filesystem>
#include <vector>

#include "apps/console/commands.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/teach/session_folder.hpp"
#include "apps/teach/teach_event.hpp"
#include "apps/teach/teach_keys.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {

/// What a session begins with, read and checked before its first image.
struct TeachInput {
  /// @throws std::invalid_argument in one sentence for flags that do not go together, and for an event or a
  /// key whose planner, robot or load is none.
  explicit TeachInput(const TeachCommand& command);

  RecordedSession recorded;
  std::filesystem::path events_file;  ///< empty: keys in the window
  InputKeeper keeper;                 ///< of what is read from here on
  std::vector<TeachEvent> events;
  ChosenSetup setup;
  std::vector<TeachKey> keys;  ///< of --keys
};

}  // namespace clearway
