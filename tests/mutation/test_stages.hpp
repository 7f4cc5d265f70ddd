#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace clearway::mutation {

/// Filters of gtest for the tests that may notice a fault in a source, to be run one after the other: those
/// of the mirrored file and of files that include its header, or, where there are none, of what includes its
/// header; then those of the mirrored folder, then the floor's others (of apps none: they start browsers).
/// @param source relative to the repository
std::vector<std::string> stages_for(const std::filesystem::path& repository,
                                    const std::filesystem::path& source);

}  // namespace clearway::mutation
