#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>

namespace clearway {

/// Whether the head of a table of poses says that they are those of a body which carries the sensors: EuRoC's
/// data.csv, `p_RS_R`.
bool are_poses_of_body(const std::string& text);

/// Where a camera is on the body whose poses a table holds.
struct CameraOnBody {
  Eigen::Isometry3d body_from_camera = Eigen::Isometry3d::Identity();  ///< optical frame, m
  std::string note;                                                    ///< a sentence: what says so
};

/// By `T_BS` of EuRoC's sensor.yaml, body_from_sensor. A sensor.yaml beside the table, of another sensor than
/// a camera (vicon0), says where on the body that is whose poses they are.
/// @param poses a table for which are_poses_of_body @param camera the file of the camera; empty: none
/// @throws std::invalid_argument in one sentence where the camera's file states no T_BS, or no rigid one
CameraOnBody camera_on_body(const std::filesystem::path& poses, const std::filesystem::path& camera);

}  // namespace clearway
