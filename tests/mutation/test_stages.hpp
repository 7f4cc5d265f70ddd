#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::mutation {

enum class Trials { few, many };  ///< see tests/worlds/trials.hpp

/// Tests that are run in one go.
struct Stage {
  std::string name;    ///< "nearest", "folder", "floor", "drawn cases"
  std::string filter;  ///< of gtest
  Trials trials = Trials::few;
};

/// The tests that may notice a fault in a source, to be run one stage after the other: those of the mirrored
/// file and of files that include its header, or, where there are none, of what includes its header; then
/// those of the mirrored folder, then the floor's others; then those of all these files that draw cases, with
/// many cases. Other tests run the same again. Of apps no other folder's: they start browsers.
/// @param source relative to the repository
std::vector<Stage> stages_for(const std::filesystem::path& repository, const std::filesystem::path& source);

}  // namespace clearway::mutation
