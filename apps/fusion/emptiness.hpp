#pragma once

#include <filesystem>
#include <set>
#include <string>

#include "apps/fusion/fusion.hpp"

namespace clearway {

/// Refuses, in one sentence with the reason, a fusion that was to paint and saw no tag of its boards, and one
/// that put nothing at all into its map. @throws std::invalid_argument
void require_content(const Fusion& fusion, const std::filesystem::path& recording);

/// Tells of each sensor of the setup that no scan was of. Refuses the setup where it placed no scan at all,
/// and the recording has no poses either: then all lie at the origin that were to be placed.
/// @throws std::invalid_argument in one sentence with the names that there are
void require_sensors(Fusion& fusion, const std::filesystem::path& recording);

/// Of a fusion whose balls painted no voxel because each is too small to hold one: a clause that says so and
/// what resolution it takes; else empty.
std::string unpainted_reason(const Fusion& fusion);

/// Whether anything at all is in its map: a painted sphere that held a voxel, or a voxel that a scan hit or
/// freed.
bool has_content(const Fusion& fusion);

/// "3, 7, 20"; of more than ten the first ones.
std::string list_of_ids(const std::set<int>& ids);

/// "too_fast 3, ambiguous_pose 1": why samples were refused, the most frequent first.
std::string refusals_of(const FusionCounts& counts);

}  // namespace clearway
