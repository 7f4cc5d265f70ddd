#include "datasets/descriptions/camera_file.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/descriptions/setup.hpp"
#include "datasets/descriptions/yaml_fields.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr const char* lenses = "Clearway knows pinhole lenses with k1, k2, p1, p2, k3";

/// k1, k2, p1, p2[, k3[, k4, k5, k6]] of OpenCV, the last three 0.
void take_distortion(const YamlFields& fields, const std::string& key, CameraIntrinsics& camera) {
  const std::vector<double> values = fields.numbers(key, within_reach);
  if (values.size() != 4 && values.size() != 5 && values.size() != 8 && !values.empty())
    fields.fail(key, "expected 4, 5 or 8 numbers, got " + std::to_string(values.size()));
  if (std::any_of(values.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(5, values.size())),
                  values.end(), [](double value) { return value != 0.0; }))
    fields.fail(key, std::string("a rational lens with k4, k5, k6 other than 0; ") + lenses +
                         ": calibrate anew with `clearway calibrate camera`");
  std::copy_n(values.begin(), std::min<std::size_t>(5, values.size()), camera.distortion.begin());
}

[[noreturn]] void refuse_lens(const YamlFields& fields, const std::string& key, const std::string& model) {
  fields.fail(key, "the lens '" + model + "' is not known, expected plumb_bob or radtan: " + lenses);
}

CameraIntrinsics read_camchain(const YamlFields& file, const std::string& wanted) {
  std::vector<std::string> cameras = file.keys();
  std::erase_if(cameras, [](const std::string& key) { return !key.starts_with("cam"); });
  const std::string name = wanted.empty() && cameras.size() == 1 ? cameras.front() : wanted;
  if (std::find(cameras.begin(), cameras.end(), name) == cameras.end())
    file.fail("", "it has " + std::to_string(cameras.size()) +
                      " cameras, expected `camera: {file: …, name: …}` to name one of them");
  const YamlFields fields = file.map(name);
  if (const std::string model = fields.text("camera_model", "pinhole"); model != "pinhole")
    refuse_lens(fields, "camera_model", model);
  const std::string lens = fields.text("distortion_model", "none");
  if (lens != "radtan" && lens != "plumb_bob" && lens != "none")
    refuse_lens(fields, "distortion_model", lens);
  const std::vector<double> k = fields.numbers("intrinsics", within_reach, 4);
  const std::vector<double> size = fields.numbers("resolution", {32, 20000}, 2);
  CameraIntrinsics camera{static_cast<int>(size[0]), static_cast<int>(size[1]), k[0], k[1], k[2], k[3], {}};
  if (fields.has("distortion_coeffs") && lens != "none") take_distortion(fields, "distortion_coeffs", camera);
  if (camera.fx <= 0.0 || camera.fy <= 0.0)
    fields.fail("intrinsics", "expected [fx, fy, cx, cy], fx and fy > 0");
  return camera;
}

CameraIntrinsics read_camera_info(const YamlFields& file) {
  CameraIntrinsics camera;
  camera.width = file.integer("image_width", {32, 20000});
  camera.height = file.integer("image_height", {32, 20000});
  const std::string lens = file.text("distortion_model", "plumb_bob");
  if (lens != "plumb_bob" && lens != "rational_polynomial") refuse_lens(file, "distortion_model", lens);
  const YamlFields matrix = file.map("camera_matrix");
  const std::vector<double> k = matrix.numbers("data", within_reach, 9);
  if (k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[8] != 1.0)
    matrix.fail("data", "expected [fx, 0, cx, 0, fy, cy, 0, 0, 1], fx and fy > 0");
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  if (file.has("distortion_coefficients"))
    take_distortion(file.map("distortion_coefficients"), "data", camera);
  return camera;
}

}  // namespace

CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera) {
  const YamlFields file(text, "camera file " + quote_path(name));
  if (file.has("image_width") || file.has("camera_matrix")) return read_camera_info(file);
  const std::vector<std::string> keys = file.keys();
  if (std::any_of(keys.begin(), keys.end(), [](const std::string& key) { return key.starts_with("cam"); }))
    return read_camchain(file, camera);
  file.fail("", "expected kalibr's camchain (`cam0`) or ROS's camera_info (`image_width`, `camera_matrix`)");
}

CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera) {
  return parse_camera_file(read_text(file, "camera file"), file.string(), camera);
}

}  // namespace clearway
