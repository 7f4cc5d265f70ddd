#include "datasets/descriptions/camera_file.hpp"

#include <algorithm>
#include <stdexcept>

#include "datasets/descriptions/setup.hpp"
#include "datasets/descriptions/yaml_fields.hpp"
#include "datasets/ros/ros_camera.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// OpenCV's coefficients, as many as the lens has; OpenCV writes 5, 8, 12 or 14 for one that has fewer.
void take_distortion(const YamlFields& fields, const std::string& key, LensModel lens,
                     CameraIntrinsics& camera) {
  const std::vector<double> values = fields.numbers(key, within_reach);
  const std::size_t size = values.size();
  const bool is_list = size == 4 || size == 5 || size == 8 || size == 12 || size == 14;
  if (!is_list && !(values.empty() && lens != LensModel::fisheye))
    fields.fail(key, std::string("expected ") + (lens == LensModel::fisheye ? "4" : "4, 5 or 8") +
                         " numbers, got " + std::to_string(size));
  try {
    set_lens(camera, lens, values);
  } catch (const std::runtime_error& error) {
    fields.fail(key, error.what());
  }
}

LensModel read_lens(const YamlFields& fields, const std::string& key, const std::string& otherwise) {
  const std::string name = fields.text(key, otherwise);
  if (name == "none") return LensModel::plumb_bob;
  const auto lens = lens_named(name);
  if (!lens) fields.fail(key, "the lens '" + name + "' is not known, expected " + known_lenses);
  return *lens;
}

CameraIntrinsics read_camchain(const YamlFields& file, const std::string& wanted, bool is_rectified) {
  std::vector<std::string> cameras = file.keys();
  std::erase_if(cameras, [](const std::string& key) { return !key.starts_with("cam"); });
  const std::string name = wanted.empty() && cameras.size() == 1 ? cameras.front() : wanted;
  if (std::find(cameras.begin(), cameras.end(), name) == cameras.end())
    file.fail("", (wanted.empty() ? "" : "it has no camera " + quote(wanted) + "; ") + "it has " +
                      std::to_string(cameras.size()) +
                      " cameras, expected `camera: {file: …, name: …}` to name one of them");
  const YamlFields fields = file.map(name);
  if (const std::string model = fields.text("camera_model", "pinhole"); model != "pinhole")
    fields.fail("camera_model", "the camera model '" + model + "' is not known, expected pinhole");
  const bool has_lens = fields.text("distortion_model", "none") != "none";
  const LensModel lens = read_lens(fields, "distortion_model", "none");
  const std::vector<double> k = fields.numbers("intrinsics", within_reach, 4);
  const std::vector<double> size = fields.numbers("resolution", {32, 20000}, 2);
  CameraIntrinsics camera{static_cast<int>(size[0]), static_cast<int>(size[1]), k[0], k[1], k[2], k[3], {}};
  if (has_lens && (fields.has("distortion_coeffs") || lens == LensModel::fisheye))
    take_distortion(fields, "distortion_coeffs", lens, camera);
  if (camera.fx <= 0.0 || camera.fy <= 0.0)
    fields.fail("intrinsics", "expected [fx, fy, cx, cy], fx and fy > 0");
  if (is_rectified && has_distortion(camera))
    fields.fail("",
                "it says nothing of rectified pictures: expected ROS's camera_info with a projection_matrix");
  camera.is_rectified = is_rectified;
  return camera;
}

/// Of the pictures that ROS rectifies with this file.
CameraIntrinsics read_rectified(const YamlFields& file, const CameraIntrinsics& raw) {
  RosCameraInfo info;
  info.width = static_cast<std::uint32_t>(raw.width);
  info.height = static_cast<std::uint32_t>(raw.height);
  info.distortion_model = lens_name(raw.lens);
  info.d.assign(raw.distortion.begin(), raw.distortion.end());
  info.k = {raw.fx, 0, raw.cx, 0, raw.fy, raw.cy, 0, 0, 1};
  const auto take = [&file](const std::string& key, auto& matrix) {
    if (!file.has(key)) return;
    const std::vector<double> values = file.map(key).numbers("data", within_reach, matrix.size());
    std::copy(values.begin(), values.end(), matrix.begin());
  };
  take("rectification_matrix", info.r);
  take("projection_matrix", info.p);
  try {
    return rectified_camera(info).intrinsics;
  } catch (const std::runtime_error& error) {
    file.fail("projection_matrix", error.what());
  }
}

/// The lens of a file that OpenCV wrote: by the number of its coefficients.
LensModel read_opencv_lens(const YamlFields& file, const std::vector<double>& coefficients) {
  if (file.integer("fisheye_model", {0, 1}, 0) == 1) return LensModel::fisheye;
  return coefficients.size() > 5 ? LensModel::rational : LensModel::plumb_bob;
}

/// As a matrix with `data`, or as a plain list.
void take_coefficients(const YamlFields& file, CameraIntrinsics& camera) {
  const std::string key = "distortion_coefficients";
  const bool is_list = file.is_list(key);
  const YamlFields fields = is_list ? file : file.map(key);
  const std::string numbers = is_list ? key : "data";
  const LensModel lens = file.has("distortion_model")
                             ? read_lens(file, "distortion_model", "plumb_bob")
                             : read_opencv_lens(file, fields.numbers(numbers, within_reach));
  take_distortion(fields, numbers, lens, camera);
}

/// What `rostopic echo` and `ros2 topic echo` print of a CameraInfo: one message.
CameraIntrinsics read_echo(const YamlFields& file, bool is_rectified) {
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

CameraIntrinsics read_camera_info(const YamlFields& file, bool is_rectified) {
  CameraIntrinsics camera;
  camera.width = file.integer("image_width", {32, 20000});
  camera.height = file.integer("image_height", {32, 20000});
  const YamlFields matrix = file.map("camera_matrix");
  const std::vector<double> k = matrix.numbers("data", within_reach, 9);
  if (k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    matrix.fail("data", "expected [fx, 0, cx, 0, fy, cy, 0, 0, 1] row by row, fx and fy > 0");
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  if (file.has("distortion_coefficients"))
    take_coefficients(file, camera);
  else if (file.has("distortion_model") && file.text("distortion_model") != "none")
    file.fail("distortion_coefficients", "expected those of its distortion_model, got nothing of that name");
  return is_rectified ? read_rectified(file, camera) : camera;
}

}  // namespace

CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera, bool is_rectified) {
  // OpenCV's FileStorage begins with a directive that YAML does not have.
  const bool is_opencv = text.starts_with("%YAML:1.0");
  const YamlFields file(is_opencv ? text.substr(std::min(text.find('\n'), text.size())) : text,
                        "camera file " + quote_path(name));
  if (file.has("K") || file.has("k")) return read_echo(file, is_rectified);
  if (file.has("image_width") || file.has("camera_matrix")) return read_camera_info(file, is_rectified);
  const std::vector<std::string> keys = file.keys();
  if (std::any_of(keys.begin(), keys.end(), [](const std::string& key) { return key.starts_with("cam"); }))
    return read_camchain(file, camera, is_rectified);
  file.fail("",
            "expected kalibr's camchain (`cam0`), ROS's camera_info or OpenCV's calibration (`image_width`, "
            "`camera_matrix`), or a CameraInfo as `ros2 topic echo` prints it (`width`, `k`)");
}

CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera,
                                  bool is_rectified) {
  return parse_camera_file(read_text(file, "camera file"), file.string(), camera, is_rectified);
}

}  // namespace clearway
