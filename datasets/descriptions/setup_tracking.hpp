#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"

namespace clearway {

class YamlFields;

// What a setup says of the camera, the tags and what is tracked by them. Each map must hold nothing else.
// All: @throws std::invalid_argument

/// Which way the y axis of a camera may point. ICL-NUIM's depth has it up: its fy is -480.
enum class CameraAxes { y_down, y_down_or_up };

/// {width, height, fx, fy, cx, cy, lens, distortion: [k1, k2, p1, p2, k3]} of a setup or scene.
CameraIntrinsics read_camera(const YamlFields& fields, CameraAxes axes = CameraAxes::y_down);

/// In the setup itself, or in a file that it names, which may say whether pictures are `rectified`.
/// @param is_rectified what they are otherwise; nothing but a file tells both cameras apart
/// @param notes what is to be told of it, added once
CameraIntrinsics read_camera_of_setup(const YamlFields& fields, const std::filesystem::path& folder,
                                      bool is_rectified, std::vector<std::string>& notes,
                                      CameraAxes axes = CameraAxes::y_down);

/// A list of {from, to, radius} under `key`; empty when absent.
std::vector<CapsuleSetup> read_capsules(const YamlFields& fields, const std::string& key);

ErrorsSetup read_errors(const YamlFields& fields);

/// A list under `boards`. @param errors what holds for all boards @param last_id of the tags' family
std::vector<BoardSetup> read_boards(const YamlFields& fields, const BoardErrorsSetup& errors, int last_id);

/// @param setup with its boards
ProbeSetup read_probe(const YamlFields& fields, const Setup& setup);

/// @param setup with its boards and its probe
GripperSetup read_gripper(const YamlFields& fields, const Setup& setup);

HandsSetup read_hands_setup(const YamlFields& fields);
AcceptanceSetup read_acceptance(const YamlFields& fields);
DetectorSetup read_detector(const YamlFields& fields);

}  // namespace clearway
