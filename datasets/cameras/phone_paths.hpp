#pragma once

#include <filesystem>

#include "datasets/cameras/camera_shots.hpp"

namespace clearway {

/// In a folder: Record3D's metadata.json of an export as EXR and JPG, or ScanNet++'s pose_intrinsic_imu.json;
/// empty: there is none of these.
std::filesystem::path phone_path_file(const std::filesystem::path& folder);

/// Whether it has `poses` of 7 numbers each, `K` of 9, `w` and `h`.
bool is_record3d(const PathFields& file);
bool is_scannetpp(const PathFields& file);

/// Record3D's: `poses`, each [qx, qy, qz, qw, x, y, z], world_from_camera of a camera with x right, y up and
/// z back, in ARKit's world, whose y points up; `K` column by column, or each picture's own
/// `perFrameIntrinsicCoeffs` [fx, fy, cx, cy], of colour pictures of `w` x `h`; `frameTimestamps`. Picture 0
/// is called 0. No shot has a pose where all are the identity, as those of the front camera are, which has
/// none.
CameraPath read_record3d(const PathFields& file);

/// ScanNet++'s of the phone: by the name of the picture `aligned_pose`, world_from_camera of the optical
/// frame in the world of the scan's mesh, `intrinsic` of pictures of 1920 x 1440, and `timestamp`; steps of
/// depth are mm. Shots whose `aligned_pose` is no rigid transform have none, and the note counts them.
CameraPath read_scannetpp(const PathFields& file);

}  // namespace clearway
