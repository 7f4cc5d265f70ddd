#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/poses/numbered_poses.hpp"

namespace clearway {

/// Poses of an array of NumPy (.npy), m: matrices N x 4 x 4 or N x 3 x 4, or their rows in N x 16 or N x 12;
/// real numbers of 32 or 64 bits. A matrix that is not finite is a pose that is not known.
/// @throws std::invalid_argument naming `name`, which matrix is no rigid transform and what was expected
NumberedPoses parse_npy_poses(const std::string& bytes, const std::string& name);

/// The same of one matrix alone, 4 x 4 or 3 x 4, also behind an axis of one entry.
std::optional<Eigen::Isometry3d> parse_npy_pose(const std::string& bytes, const std::string& name);

/// Their times, s: those in the one of NAME_times, NAME_timestamps, times and timestamps (.npy, or .txt with
/// one number a line) that comes first beside NAME.npy; empty: there is none of these.
/// @param notes takes a sentence for each file of times or timestamps that is about something else
/// @throws std::invalid_argument where those of NAME do not rise, or are not as many as the poses
std::vector<double> times_of_npy_poses(const std::filesystem::path& poses, std::size_t count,
                                       std::vector<std::string>& notes);

}  // namespace clearway
