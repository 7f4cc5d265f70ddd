#include "datasets/camera_files/printed_camera.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "datasets/ros/ros_camera.hpp"

namespace clearway {

bool is_printed_camera(const YamlFields& file) {
  if (file.has("k")) return true;
  return file.is_list("K") && (file.has("P") || file.has("R") || file.has("header"));
}

CameraIntrinsics read_printed_camera(const YamlFields& file, bool is_rectified) {
  RosCameraInfo info;
  info.width = static_cast<std::uint32_t>(file.integer("width", {32, 20000}));
  info.height = static_cast<std::uint32_t>(file.integer("height", {32, 20000}));
  info.distortion_model = file.text("distortion_model", "");
  const bool is_ros1 = file.has("K");
  info.d = file.numbers(is_ros1 ? "D" : "d", within_reach);
  const auto take = [&](const char* ros1, const char* ros2, auto& matrix) {
    const std::vector<double> values = file.numbers(is_ros1 ? ros1 : ros2, within_reach, matrix.size());
    std::copy(values.begin(), values.end(), matrix.begin());
  };
  take("K", "k", info.k);
  take("R", "r", info.r);
  take("P", "p", info.p);
  const auto count = [](const YamlFields& fields, const char* key) {
    return static_cast<std::uint32_t>(fields.integer(key, {0, 20000}, 0));
  };
  info.binning_x = count(file, "binning_x");
  info.binning_y = count(file, "binning_y");
  if (file.has("roi")) {
    const YamlFields roi = file.map("roi");
    info.roi_x = count(roi, "x_offset");
    info.roi_y = count(roi, "y_offset");
    info.roi_width = count(roi, "width");
    info.roi_height = count(roi, "height");
    if (roi.has("do_rectify")) info.do_rectify = roi.boolean("do_rectify");
  }
  try {
    return (is_rectified ? rectified_camera(info) : raw_camera(info)).intrinsics;
  } catch (const std::runtime_error& error) {
    file.fail("", error.what());
  }
}

}  // namespace clearway
