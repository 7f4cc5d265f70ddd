#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"

namespace clearway {

/// Whether a file has a matrix by one of the names that OpenCV's users give it.
bool has_any_matrix(const YamlFields& file);

/// Nine numbers, row by row: as OpenCV's matrix, as a list or as three lists.
std::vector<double> read_matrix(const YamlFields& file, const std::string& key);

/// As a matrix with `data`, or as a plain list, or as the list of lists that Python's tolist() makes of it.
void take_coefficients(const YamlFields& file, const std::string& key, CameraIntrinsics& camera,
                       BesideFile& beside);

/// A list of them, of the lens that is named, else of as many as there are; notes where they may be
/// another's.
void take_listed_coefficients(const YamlFields& fields, const std::string& key, std::optional<LensModel> lens,
                              CameraIntrinsics& camera, BesideFile& beside);

/// The coefficients' key of a file that has a camera's numbers alone; empty: it has none. One that looks like
/// it and is not known is refused.
std::string coefficients_key(const YamlFields& file);

/// Of the pictures that are rectified with this file, as ROS does.
/// @param r, p the names of OpenCV's R and P, where ROS's are not there
CameraIntrinsics read_rectified(const YamlFields& file, const CameraIntrinsics& raw, const std::string& r,
                                const std::string& p);

/// ROS's camera_info, and what OpenCV's users write. @param wanted the matrix of several; may be empty
CameraIntrinsics read_camera_info(const YamlFields& file, const std::string& wanted, BesideFile& beside);

}  // namespace clearway
