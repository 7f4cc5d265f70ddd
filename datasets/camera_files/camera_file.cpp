#include "datasets/camera_files/camera_file.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "datasets/camera_files/json_camera.hpp"
#include "datasets/camera_files/kalibr_camera.hpp"
#include "datasets/camera_files/opencv_camera.hpp"
#include "datasets/camera_files/printed_camera.hpp"
#include "datasets/camera_files/slam_camera.hpp"
#include "datasets/cameras/colmap_camera.hpp"
#include "datasets/cameras/matrix_text.hpp"
#include "datasets/cameras/nerf_camera.hpp"
#include "datasets/cameras/opencv_xml.hpp"
#include "datasets/cameras/sensor_info.hpp"
#include "datasets/sources/lens.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Whether it is a file of json_camera's kinds, and of no other that is looked for before.
bool is_json_camera(const YamlFields& file) {
  return !is_printed_camera(file) && !file.is_list("intrinsics") && !file.is_map("projection_parameters") &&
         !file.has("image_width") && !has_any_matrix(file) && !is_orb_slam(file);
}

CameraIntrinsics read_any(const YamlFields& file, const std::string& camera, BesideFile& beside) {
  const bool is_rectified = beside.is_rectified;
  const bool is_chain_camera = file.is_list("intrinsics") && file.is_list("resolution");
  if (is_printed_camera(file) || is_chain_camera || file.is_map("projection_parameters"))
    require_name(file, camera);
  if (is_printed_camera(file)) return read_printed_camera(file, is_rectified);
  if (is_chain_camera) return read_chain_camera(file, is_rectified);
  if (file.is_map("projection_parameters")) return read_camodocal(file, beside.size, is_rectified);
  if (file.has("image_width") || has_any_matrix(file)) return read_camera_info(file, camera, beside);
  if (is_orb_slam(file)) return read_orb_slam(file, camera, beside);
  if (const auto found = json_camera(file, camera)) return read_json_camera(*found, beside);
  const std::vector<std::string> keys = file.keys();
  if (std::any_of(keys.begin(), keys.end(),
                  [&](const std::string& key) { return is_of_camchain(file, key); }))
    return read_camchain(file, camera, is_rectified);
  file.fail("",
            "expected kalibr's camchain (`cam0`), ROS's camera_info or OpenCV's calibration (`image_width`, "
            "`camera_matrix`), a CameraInfo as `ros2 topic echo` prints it (`width`, `k`), librealsense's "
            "intrinsics (`fx`, `ppx`), Open3D's (`intrinsic_matrix`), EuRoC's sensor.yaml, ORB-SLAM's "
            "settings (`Camera.fx`, `Camera1.fx`), camodocal's (`projection_parameters`), Replica's "
            "cam_params.json (`fx`, `cx`), nerfstudio's transforms.json, COLMAP's cameras.txt or "
            "cameras.bin, or a matrix alone");
}

void require_size(const CameraIntrinsics& camera, const ImageSize& expected, const std::string& called) {
  const auto sides = [](const ImageSize& of) {
    return std::to_string(of.width) + " x " + std::to_string(of.height);
  };
  const ImageSize stated{camera.width, camera.height};
  if (stated != expected)
    throw std::invalid_argument(called + ": its pictures have " + sides(stated) + " pixels, expected " +
                                sides(expected) + ", as the pictures have or the setup says");
}

CameraIntrinsics camera_of_info(const std::string& text, const std::string& called, const std::string& which,
                                bool is_rectified, std::optional<ImageSize> size) {
  if (!which.empty() && which != "depth" && which != "color")
    throw std::invalid_argument(called + ": it has no camera " + quote(which) +
                                ", expected 'depth' or 'color'");
  const SensorInfo info = parse_sensor_info(text, called);
  CameraIntrinsics camera = which == "color" ? info.colour : info.depth;
  camera.is_rectified = is_rectified;
  if (size) require_size(camera, *size, called);
  return camera;
}

/// With a blank behind `key:` where a list follows at once, which OpenCV reads (ORB-SLAM2's EuRoC.yaml).
std::string with_blanks(const std::string& text) {
  std::string spaced;
  bool is_key = true;  // of this line, so far
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    spaced += c;
    if (is_key && c == ':' && i + 1 < text.size() && text[i + 1] == '[') spaced += ' ';
    if (c == '\n')
      is_key = true;
    else if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.' && c != ' ')
      is_key = false;
  }
  return spaced;
}

/// Of YAML, JSON, or what OpenCV's FileStorage wrote, which as YAML begins with a directive of its own.
YamlFields fields_of(const std::string& text, const std::string& called) {
  const bool is_opencv = text.starts_with("%YAML:1.0");
  return {is_xml(text) ? yaml_of_opencv_xml(text, called)
          : is_opencv  ? with_blanks(text.substr(std::min(text.find('\n'), text.size())))
                       : text,
          called};
}

}  // namespace

CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera, bool is_rectified,
                                   std::optional<ImageSize> size, std::optional<LensModel> lens,
                                   std::string* note) {
  const std::string called = "camera file " + quote_path(name);
  if (is_sensor_info(text)) return camera_of_info(text, called, camera, is_rectified, size);
  const auto require_lens = [&](const CameraIntrinsics& read) {
    const bool is_other = lens && (read.lens == LensModel::fisheye) != (*lens == LensModel::fisheye);
    if (is_other && !is_rectified)
      throw std::invalid_argument(called + ": its lens is " + lens_name(read.lens) + ", expected " +
                                  lens_name(*lens) + ", as `lens` beside `file` says.");
  };
  const bool is_nerf = is_nerf_file(text);
  if (is_nerf && !camera.empty())
    throw std::invalid_argument(
        called + " has one camera, for all of its pictures: expected no `name` beside `file`.");
  if (is_nerf || is_colmap_cameras(text)) {
    CameraIntrinsics read =
        is_nerf ? camera_of_nerf_file(text, called, size) : camera_of_colmap(text, called, camera);
    require_lens(read);
    if (is_rectified && has_distortion(read))
      throw std::invalid_argument(
          called + " has a camera with a distortion: expected that of the rectified pictures.");
    read.is_rectified = is_rectified;
    if (size) require_size(read, *size, called);
    return read;
  }
  if (is_numbers_alone(text)) {
    if (!camera.empty())
      throw std::invalid_argument(called + " has a matrix alone: expected no `name` beside `file`.");
    CameraIntrinsics pinhole = camera_of_matrix_text(text, called, size);
    pinhole.is_rectified = is_rectified;
    if (lens.value_or(LensModel::plumb_bob) == LensModel::fisheye)
      throw std::invalid_argument(called + " has a matrix alone: expected no `lens` beside it.");
    return pinhole;
  }
  const YamlFields file = fields_of(text, called);
  BesideFile beside{is_rectified, size, lens, ""};
  const CameraIntrinsics read = read_any(file, camera, beside);
  if (note != nullptr && !beside.note.empty()) *note = called + " " + beside.note;
  require_lens(read);
  if (size) require_size(read, *size, called);
  return read;
}

CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera,
                                  bool is_rectified, std::optional<ImageSize> size,
                                  std::optional<LensModel> lens, std::string* note) {
  return parse_camera_file(read_text(file, "camera file"), file.string(), camera, is_rectified, size, lens,
                           note);
}

namespace {

/// What no camera's file should mean: a step of less than a micrometre or more than 2 cm.
double plausible_step(const YamlFields& fields, const std::string& key, double step) {
  if (!(step >= 1e-6 && step <= 0.02))
    fields.fail(key, "it makes steps of depth " + short_text(step) +
                         " m: expected `source: {depth: {scale: …}}` in the setup to state them");
  return step;
}

/// m, by `depth_scale` of whoever writes cameras as `camera` is written.
double step_of_depth_scale(const YamlFields& fields, const YamlFields& camera) {
  const double scale = fields.number("depth_scale", {1e-7, 1e7});
  const bool is_of_bop = is_plain_camera(camera) && scale >= 0.01 && scale <= 10.0;
  const double step = is_of_bop       ? 1e-3 * scale  // mm
                      : scale <= 0.02 ? scale         // m, as librealsense has it
                                      : 1.0 / scale;  // steps in a metre, as Open3D has it
  return plausible_step(fields, "depth_scale", step);
}

}  // namespace

std::optional<double> depth_scale_of_file(const std::filesystem::path& file, const std::string& name) {
  const std::string text = read_text(file, "camera file"),
                    called = "camera file " + quote_path(file.string());
  if (is_sensor_info(text)) return 1.0 / parse_sensor_info(text, called).steps_per_metre;
  if (is_numbers_alone(text) || is_colmap_cameras(text) || is_nerf_file(text)) return std::nullopt;
  const YamlFields whole = fields_of(text, called);
  const std::optional<JsonCamera> found = is_json_camera(whole) ? json_camera(whole, name) : std::nullopt;
  const YamlFields& camera = found ? found->fields : whole;
  const YamlFields inner = whole.is_map("camera") ? whole.map("camera") : whole;
  const bool is_replica = file.filename() == "cam_params.json" ||
                          (whole.is_map("camera") && inner.has("fx") && inner.has("scale") &&
                           inner.number("scale", {-1e9, 1e9}) >= 100.0);  // smaller ones mean something else
  if (is_replica)
    if (const auto steps = inner.optional_number("scale", {1, 1e7})) return 1.0 / *steps;
  for (const char* key : {"DepthMapFactor", "RGBD.DepthMapFactor"}) {
    const auto steps = whole.optional_number(key, {0, 1e7});
    // Up to 1 it says that depth is in metres already, as pictures of floats are (ORB-SLAM2, Tracking.cc).
    if (steps && *steps > 1.0) return plausible_step(whole, key, 1.0 / *steps);
  }
  for (const YamlFields& fields : {camera, inner, whole})  // steps in a metre (gradslam, NICE-SLAM)
    if (const auto steps = fields.optional_number("png_depth_scale", {1e-7, 1e7}))
      return plausible_step(fields, "png_depth_scale", 1.0 / *steps);
  for (const YamlFields& fields : {camera, inner, whole})
    if (fields.has("depth_scale")) return step_of_depth_scale(fields, camera);
  return std::nullopt;
}

}  // namespace clearway
