#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "datasets/poses/pose_stream.hpp"

namespace clearway {

/// Poses from text in the format of the TUM RGB-D benchmark: lines "time x y z qx qy qz qw" (m, and times as
/// make_seconds reads them); `#` starts a comment. A head before the first pose, commented out or not, may
/// say that the quaternion begins with w ("# time tx ty tz qw qx qy qz"). Lines apart by commas need a head,
/// as some programs begin with w there (VINS-Mono) and some do not; it may name more columns behind these,
/// which are skipped (EuRoC's data.csv), or give the time as seconds and nanoseconds of it, possibly behind a
/// counter (Newer College's "#sec,nsec,x,y,z,qx,qy,qz,qw").
/// @param left_out counts lines whose pose is not known (nan) and a last one that is cut off; none: they are
/// refused @throws std::invalid_argument naming `name`, the line and what was expected.
PoseStream parse_tum_poses(const std::string& text, const std::string& name, double max_gap,
                           std::size_t* left_out = nullptr);

/// The same from a file of at most 256 MB. @throws std::invalid_argument also when it cannot be read.
PoseStream load_tum_poses(const std::filesystem::path& file, double max_gap, std::size_t* left_out = nullptr);

/// The sentence about poses that can hardly be metres, as those in millimetres are: they usually move at more
/// than 60 m/s. Empty: they do not.
std::optional<std::string> too_fast_poses(const std::filesystem::path& file, const PoseStream& poses);

/// The sentence about poses that jump, between which nothing is placed. Empty: none do.
std::optional<std::string> jumping_poses(const std::filesystem::path& file, const PoseStream& poses);

/// The sentence about so many lines that were left out.
std::string left_out_poses(const std::filesystem::path& file, std::size_t left_out);

}  // namespace clearway
