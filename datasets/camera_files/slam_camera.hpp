#pragma once

#include <optional>
#include <string>

#include "datasets/camera_files/camera_fields.hpp"

namespace clearway {

/// camodocal's, which VINS takes: a pinhole with a plumb bob, or Kannala and Brandt's, whose coefficients
/// count from k2 (camodocal, EquidistantCamera.cc). @throws std::invalid_argument by YamlFields::fail
CameraIntrinsics read_camodocal(const YamlFields& file, std::optional<ImageSize> given, bool is_rectified);

/// Whether it is settings of an ORB-SLAM, or of OpenVSLAM, which names things alike.
bool is_orb_slam(const YamlFields& file);

/// Their camera that is wanted; else the one or the left one. @throws std::invalid_argument by
/// YamlFields::fail
CameraIntrinsics read_orb_slam(const YamlFields& fields, const std::string& wanted, const BesideFile& beside);

/// Refuses the camera of stella_vslam's (OpenVSLAM's) settings for raw pictures where it is of rectified
/// ones.
void require_raw_of_stella(const YamlFields& file, bool is_rectified);

}  // namespace clearway
