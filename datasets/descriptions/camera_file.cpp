#include "datasets/descriptions/camera_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "datasets/cameras/colmap_camera.hpp"
#include "datasets/cameras/matrix_text.hpp"
#include "datasets/cameras/opencv_xml.hpp"
#include "datasets/cameras/realsense_lens.hpp"
#include "datasets/cameras/sensor_info.hpp"
#include "datasets/descriptions/opencv_camera.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/ros/ros_camera.hpp"
#include "datasets/sources/lens.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// One camera of kalibr's camchain, or EuRoC's sensor.yaml.
CameraIntrinsics read_chain_camera(const YamlFields& fields, bool is_rectified) {
  if (const std::string model = fields.text("camera_model", "pinhole"); model != "pinhole")
    fields.fail("camera_model", "the camera model '" + model + "' is not known, expected pinhole");
  const bool has_lens = fields.text("distortion_model", "none") != "none";
  const LensModel lens = read_lens(fields, "distortion_model", "none");
  const std::vector<double> k = fields.numbers("intrinsics", within_reach, 4);
  const std::vector<double> size = fields.numbers("resolution", {32, 20000}, 2);
  CameraIntrinsics camera{static_cast<int>(size[0]), static_cast<int>(size[1]), k[0], k[1], k[2], k[3], {}};
  const char* const key =
      fields.has("distortion_coefficients") ? "distortion_coefficients" : "distortion_coeffs";
  if (has_lens && (fields.has(key) || lens == LensModel::fisheye)) take_distortion(fields, key, lens, camera);
  if (camera.fx <= 0.0 || camera.fy <= 0.0)
    fields.fail("intrinsics", "expected [fx, fy, cx, cy], fx and fy > 0");
  return only_camera(fields, camera, is_rectified);
}

bool is_of_camchain(const YamlFields& file, const std::string& key) {
  return key.starts_with("cam") && file.is_map(key);
}

CameraIntrinsics read_camchain(const YamlFields& file, const std::string& wanted, bool is_rectified) {
  std::vector<std::string> cameras = file.keys();
  std::erase_if(cameras, [&](const std::string& key) { return !is_of_camchain(file, key); });
  const std::string name = wanted.empty() && cameras.size() == 1 ? cameras.front() : wanted;
  if (std::find(cameras.begin(), cameras.end(), name) == cameras.end())
    file.fail("", (wanted.empty() ? "" : "it has no camera " + quote(wanted) + "; ") + "it has " +
                      std::to_string(cameras.size()) +
                      " cameras, expected `camera: {file: …, name: …}` to name one of them");
  return read_chain_camera(file.map(name), is_rectified);
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

/// librealsense's intrinsics, by their names there.
CameraIntrinsics read_realsense(const YamlFields& fields, std::optional<ImageSize> given, bool is_rectified) {
  const ImageSize size = read_size(fields, given);
  CameraIntrinsics camera{size.width,
                          size.height,
                          fields.number("fx", above_zero),
                          fields.number("fy", above_zero),
                          fields.number("ppx", within_reach),
                          fields.number("ppy", within_reach),
                          {}};
  std::vector<double> coefficients;
  if (fields.has("coeffs")) coefficients = fields.numbers("coeffs", within_reach, 5);
  try {
    set_realsense_lens(camera, fields.text("model", ""), coefficients);
  } catch (const std::runtime_error& error) {
    fields.fail(fields.has("model") ? "model" : "coeffs", error.what());
  }
  return only_camera(fields, camera, is_rectified);
}

/// Open3D's PinholeCameraIntrinsic: its matrix stands column by column.
CameraIntrinsics read_open3d(const YamlFields& fields, std::optional<ImageSize> given, bool is_rectified) {
  const std::vector<double> k = fields.numbers("intrinsic_matrix", within_reach, 9);
  if (k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[2] != 0.0 || k[3] != 0.0 || k[5] != 0.0 || k[8] != 1.0)
    fields.fail("intrinsic_matrix",
                "expected [fx, 0, 0, 0, fy, 0, cx, cy, 1] column by column, fx and fy > 0");
  const ImageSize size = read_size(fields, given);
  return only_camera(fields, {size.width, size.height, k[0], k[4], k[6], k[7], {}}, is_rectified);
}

/// Refuses numbers of lenses that a plumb bob does not have.
void refuse_other_lenses(const YamlFields& fields) {
  for (const char* key : {"k4", "k5", "k6", "xi", "alpha", "beta", "omega", "skew", "r1", "r2", "r3", "t1",
                          "t2", "s1", "s2", "s3", "s4"})
    if (fields.has(key) && !fields.is_map(key) && !fields.is_word(key) && !fields.is_list(key) &&
        fields.number(key, within_reach) != 0.0)
      fields.fail(key, "expected a plumb_bob, whose coefficients are k1, k2, p1, p2, k3");
}

/// Numbers alone, by the names that a setup has, too, and OpenCV's of a plumb bob.
CameraIntrinsics read_plain(const YamlFields& fields, std::optional<ImageSize> given, bool is_rectified) {
  const ImageSize size = read_size(fields, given);
  CameraIntrinsics camera{size.width,
                          size.height,
                          fields.number("fx", above_zero),
                          fields.number("fy", above_zero),
                          fields.number("cx", within_reach),
                          fields.number("cy", within_reach),
                          {}};
  std::array<double, 5> coefficients{};
  const char* const names[] = {"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    coefficients[i] = fields.number(names[i], within_reach, 0.0);
  set_lens(camera, LensModel::plumb_bob, coefficients);
  refuse_other_lenses(fields);
  if (named_lens(fields).value_or(LensModel::plumb_bob) != LensModel::plumb_bob)
    fields.fail("", "expected a plumb_bob, whose coefficients are k1, k2, p1, p2, k3");
  if (const std::string key = coefficients_key(fields); !key.empty())
    take_distortion(fields, key, LensModel::plumb_bob, camera);
  return only_camera(fields, camera, is_rectified);
}

/// camodocal's, which VINS takes: a pinhole with a plumb bob, or Kannala and Brandt's, whose coefficients
/// count from k2 (camodocal, EquidistantCamera.cc).
CameraIntrinsics read_camodocal(const YamlFields& file, std::optional<ImageSize> given, bool is_rectified) {
  const std::string type = lower_case(file.text("model_type", "MEI"));  // there MEI is what it stands for
  const bool is_fisheye = type == "kannala_brandt";
  if (!is_fisheye && type != "pinhole")
    file.fail("model_type",
              "expected PINHOLE or KANNALA_BRANDT, got " + quote(file.text("model_type", "none")));
  const ImageSize size = read_size(file, given);
  const YamlFields of = file.map("projection_parameters");
  const auto number = [&](const char* plain, const char* wide, Bounds bounds) {
    return of.number(is_fisheye ? wide : plain, bounds);
  };
  CameraIntrinsics camera{size.width,
                          size.height,
                          number("fx", "mu", above_zero),
                          number("fy", "mv", above_zero),
                          number("cx", "u0", within_reach),
                          number("cy", "v0", within_reach),
                          {}};
  std::array<double, 4> coefficients{};
  const char* const plain[] = {"k1", "k2", "p1", "p2"};
  const char* const wide[] = {"k2", "k3", "k4", "k5"};
  const YamlFields lens =
      is_fisheye || !file.is_map("distortion_parameters") ? of : file.map("distortion_parameters");
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    coefficients[i] = lens.number(is_fisheye ? wide[i] : plain[i], within_reach, 0.0);
  set_lens(camera, is_fisheye ? LensModel::fisheye : LensModel::plumb_bob, coefficients);
  return only_camera(file, camera, is_rectified);
}

/// How the names of an ORB-SLAM's cameras begin; none: it is none of its settings.
std::vector<std::string> orb_slam_prefixes(const YamlFields& fields) {
  std::vector<std::string> found;
  for (const char* prefix : {"Camera1.", "Camera.", "Camera2."})
    if (fields.has(std::string(prefix) + "fx")) found.emplace_back(prefix);
  return found;
}

/// ORB-SLAM2's stereo settings: Camera.fx, … are of the pictures that it rectifies, LEFT.K, … of the raw
/// ones.
CameraIntrinsics read_orb_slam_raw(const YamlFields& fields, const std::string& side, bool is_rectified) {
  constexpr Bounds sides{32, 20000};
  const std::string prefix = side + ".";
  const std::vector<double> k = read_matrix(fields, prefix + "K");
  CameraIntrinsics camera{fields.integer(prefix + "width", sides),
                          fields.integer(prefix + "height", sides),
                          k[0],
                          k[4],
                          k[2],
                          k[5],
                          {}};
  BesideFile beside;
  take_coefficients(fields, prefix + "D", camera, beside);
  return is_rectified ? read_rectified(fields, camera, prefix + "R", prefix + "P") : camera;
}

/// ORB-SLAM's settings, of the camera that is wanted; else of the one or the left one.
CameraIntrinsics read_orb_slam(const YamlFields& fields, const std::string& wanted,
                               std::optional<ImageSize> given, bool is_rectified) {
  if ((wanted == "LEFT" || wanted == "RIGHT") && fields.has(wanted + ".K"))
    return read_orb_slam_raw(fields, wanted, is_rectified);
  if (fields.has("LEFT.K") && !is_rectified)
    fields.fail("LEFT.K",
                "Camera.fx and so on are of rectified pictures, LEFT.K and RIGHT.K of raw ones: expected "
                "`name: LEFT` or `name: RIGHT` beside `file`, or `rectified: true`");
  const std::vector<std::string> prefixes = orb_slam_prefixes(fields);
  const std::string prefix = wanted.empty() ? prefixes.front() : wanted + ".";
  if (std::find(prefixes.begin(), prefixes.end(), prefix) == prefixes.end())
    fields.fail("", "it has no camera " + quote(wanted) +
                        ", expected `name` beside `file` to be as its keys " + "begin, such as Camera1");
  constexpr Bounds sides{32, 20000};
  const auto of_camera = [&](const char* name, double otherwise) {
    return fields.number(prefix + name, within_reach, otherwise);
  };
  ImageSize size = given.value_or(ImageSize{});
  if (fields.has("Camera.width") || fields.has("Camera.height") || !given)
    size = {fields.integer("Camera.width", sides), fields.integer("Camera.height", sides)};
  CameraIntrinsics camera{size.width,
                          size.height,
                          fields.number(prefix + "fx", above_zero),
                          fields.number(prefix + "fy", above_zero),
                          fields.number(prefix + "cx", within_reach),
                          fields.number(prefix + "cy", within_reach),
                          {}};
  const std::string type = fields.has("Camera.type") ? fields.text("Camera.type") : "PinHole";
  const std::array<double, 5> plumb_bob{of_camera("k1", 0.0), of_camera("k2", 0.0), of_camera("p1", 0.0),
                                        of_camera("p2", 0.0), of_camera("k3", 0.0)};
  const std::array<double, 4> fisheye{of_camera("k1", 0.0), of_camera("k2", 0.0), of_camera("k3", 0.0),
                                      of_camera("k4", 0.0)};
  if (type == "PinHole")
    set_lens(camera, LensModel::plumb_bob, plumb_bob);
  else if (type == "KannalaBrandt8")
    set_lens(camera, LensModel::fisheye, fisheye);
  else if (type != "Rectified")
    fields.fail("Camera.type", "expected PinHole, KannalaBrandt8 or Rectified, got " + quote(type));
  return only_camera(fields, camera, is_rectified);
}

bool is_realsense(const YamlFields& fields) { return fields.has("ppx"); }
bool is_plain(const YamlFields& fields) {
  return fields.has("fx") && fields.has("fy") && fields.has("cx") && fields.has("cy");
}
bool is_open3d(const YamlFields& fields) { return fields.has("intrinsic_matrix"); }

/// The map of the file that is a camera of one of these three kinds: itself, or one in it, by the name of
/// that or of what holds it. Nothing when there is none.
std::optional<YamlFields> json_camera(const YamlFields& file, const std::string& wanted) {
  std::vector<std::pair<std::string, YamlFields>> found;
  const auto look = [&](const auto& again, const YamlFields& fields, const std::string& name) -> void {
    constexpr std::size_t most = 100, most_keys = 1000;
    if (is_realsense(fields) || is_open3d(fields) || is_plain(fields))
      return found.emplace_back(name, fields), void();
    const std::vector<std::string> keys = fields.keys();
    for (const std::string& key : keys)
      if (keys.size() <= most_keys && found.size() < most && fields.is_map(key))
        again(again, fields.map(key), name.empty() ? key : name + "." + key);
  };
  look(look, file, "");
  if (found.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& [name, fields] : found) {
    if (name.empty()) require_name(fields, wanted);
    if (found.size() == 1 && (wanted.empty() || name.empty())) return fields;
    if (!wanted.empty() && (name == wanted || name.starts_with(wanted + "."))) return fields;
    names.push_back(quote(name));
  }
  file.fail("", (wanted.empty() ? "" : "it has no camera " + quote(wanted) + "; ") + "it has " +
                    listed(names) + ": expected `camera: {file: …, name: …}` to name one of them");
}

/// A message as it is printed says more of its K than OpenCV's users do.
bool is_echo(const YamlFields& file) {
  if (file.has("k")) return true;
  return file.is_list("K") && (file.has("P") || file.has("R") || file.has("header"));
}

/// Whether it is a file of json_camera's kinds, and of no other that is looked for before.
bool is_json_camera(const YamlFields& file) {
  return !is_echo(file) && !file.is_list("intrinsics") && !file.is_map("projection_parameters") &&
         !file.has("image_width") && !has_any_matrix(file) && orb_slam_prefixes(file).empty();
}

CameraIntrinsics read_any(const YamlFields& file, const std::string& camera, BesideFile& beside) {
  const bool is_rectified = beside.is_rectified;
  const bool is_chain_camera = file.is_list("intrinsics") && file.is_list("resolution");
  if (is_echo(file) || is_chain_camera || file.is_map("projection_parameters")) require_name(file, camera);
  if (is_echo(file)) return read_echo(file, is_rectified);
  if (is_chain_camera) return read_chain_camera(file, is_rectified);
  if (file.is_map("projection_parameters")) return read_camodocal(file, beside.size, is_rectified);
  if (file.has("image_width") || has_any_matrix(file)) return read_camera_info(file, camera, beside);
  if (!orb_slam_prefixes(file).empty()) return read_orb_slam(file, camera, beside.size, is_rectified);
  if (const auto fields = json_camera(file, camera)) {
    if (is_realsense(*fields)) return read_realsense(*fields, beside.size, is_rectified);
    return is_open3d(*fields) ? read_open3d(*fields, beside.size, is_rectified)
                              : read_plain(*fields, beside.size, is_rectified);
  }
  const std::vector<std::string> keys = file.keys();
  if (std::any_of(keys.begin(), keys.end(),
                  [&](const std::string& key) { return is_of_camchain(file, key); }))
    return read_camchain(file, camera, is_rectified);
  if (file.has("fl_x") || file.has("frames"))
    file.fail("",
              "it is nerfstudio's transforms.json, whose cameras are those of its own pictures: expected "
              "numbers in the setup, or another program's file of the camera");
  file.fail("",
            "expected kalibr's camchain (`cam0`), ROS's camera_info or OpenCV's calibration (`image_width`, "
            "`camera_matrix`), a CameraInfo as `ros2 topic echo` prints it (`width`, `k`), librealsense's "
            "intrinsics (`fx`, `ppx`), Open3D's (`intrinsic_matrix`), EuRoC's sensor.yaml, ORB-SLAM's "
            "settings (`Camera.fx`, `Camera1.fx`), camodocal's (`projection_parameters`), Replica's "
            "cam_params.json (`fx`, `cx`), or a matrix alone");
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
  if (is_colmap_cameras(text)) {
    CameraIntrinsics read = camera_of_colmap(text, called, camera);
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
  const bool is_of_bop = is_plain(camera) && scale >= 0.01 && scale <= 10.0;
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
  if (is_numbers_alone(text) || is_colmap_cameras(text)) return std::nullopt;
  const YamlFields whole = fields_of(text, called);
  const std::optional<YamlFields> camera = is_json_camera(whole) ? json_camera(whole, name) : std::nullopt;
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
  for (const YamlFields& fields : {camera.value_or(whole), inner, whole})
    if (fields.has("depth_scale")) return step_of_depth_scale(fields, camera.value_or(whole));
  return std::nullopt;
}

}  // namespace clearway
