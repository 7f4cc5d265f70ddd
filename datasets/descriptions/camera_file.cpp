#include "datasets/descriptions/camera_file.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "datasets/cameras/matrix_text.hpp"
#include "datasets/cameras/opencv_xml.hpp"
#include "datasets/cameras/realsense_lens.hpp"
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

/// The camera of a file that knows no rectified one beside it.
CameraIntrinsics only_camera(const YamlFields& fields, CameraIntrinsics camera, bool is_rectified) {
  if (is_rectified && has_distortion(camera))
    fields.fail("",
                "it says nothing of rectified pictures: expected ROS's camera_info with a projection_matrix");
  camera.is_rectified = is_rectified;
  return camera;
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
  return only_camera(fields, camera, is_rectified);
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
void take_coefficients(const YamlFields& file, const std::string& key, CameraIntrinsics& camera) {
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

/// How OpenCV's users call a camera's matrix, and its coefficients: those of any name, or of one of two.
struct MatrixKey {
  const char *matrix, *coefficients;
};
constexpr MatrixKey matrix_keys[] = {{"camera_matrix", ""},
                                     {"cameraMatrix", ""},
                                     {"Camera_Matrix", ""},
                                     {"CameraMatrix", ""},
                                     {"K", ""},
                                     {"M1", "D1"},
                                     {"M2", "D2"},
                                     {"K1", "D1"},
                                     {"K2", "D2"},
                                     {"cameraMatrix1", "distCoeffs1"},
                                     {"cameraMatrix2", "distCoeffs2"}};
constexpr const char* coefficient_keys[] = {"distortion_coefficients",
                                            "distCoeffs",
                                            "dist_coeffs",
                                            "Distortion_Coefficients",
                                            "DistortionCoefficients",
                                            "distortionCoefficients",
                                            "distortion",
                                            "dist",
                                            "D"};
constexpr std::pair<const char*, const char*> size_keys[] = {
    {"image_width", "image_height"},
    {"image_Width", "image_Height"},
    {"imageWidth", "imageHeight"},
    {"calibration_image_width", "calibration_image_height"},
    {"width", "height"}};

/// The matrix that the file has, of several the one that is wanted.
MatrixKey matrix_key(const YamlFields& file, const std::string& wanted) {
  std::vector<MatrixKey> found;
  std::string names;
  for (const MatrixKey& key : matrix_keys) {
    if (!file.has(key.matrix)) continue;
    if (wanted == key.matrix) return key;
    found.push_back(key);
    names += (names.empty() ? "" : ", ") + std::string(key.matrix);
  }
  if (found.size() > 1)
    file.fail("", "it has several cameras, " + names +
                      ": expected `camera: {file: …, name: …}` to name one of them");
  return found.empty() ? matrix_keys[0] : found.front();
}

/// Nine numbers, row by row: as OpenCV's matrix, as a list or as three lists.
std::vector<double> read_matrix(const YamlFields& file, const std::string& key) {
  std::vector<double> k;
  const bool is_list = file.is_list(key);
  const YamlFields fields = is_list ? file : file.map(key);
  const std::string numbers = is_list ? key : "data";
  for (const auto& row : fields.rows(numbers, within_reach, 3, {})) k.insert(k.end(), row.begin(), row.end());
  const bool is_camera = k.size() == 9 && k[0] > 0.0 && k[4] > 0.0 && k[1] == 0.0 && k[3] == 0.0 &&
                         k[6] == 0.0 && k[7] == 0.0 && k[8] == 1.0;
  if (!is_camera) fields.fail(numbers, "expected [fx, 0, cx, 0, fy, cy, 0, 0, 1] row by row, fx and fy > 0");
  return k;
}

/// That of the file, else `given`.
ImageSize read_size(const YamlFields& file, std::optional<ImageSize> given) {
  constexpr Bounds sides{32, 20000};
  for (const auto& [width, height] : size_keys)
    if (file.has(width) || file.has(height)) return {file.integer(width, sides), file.integer(height, sides)};
  for (const char* name : {"image_size", "imageSize"}) {
    if (!file.has(name)) continue;
    const std::vector<double> size = file.numbers(name, sides, 2);
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
  }
  if (!given)
    file.fail("image_width",
              "it does not say how large the pictures are: expected image_width and image_height, or `width` "
              "and `height` beside `file`");
  return *given;
}

/// The coefficients' key; empty: it has none. One that looks like it and is not known is refused.
std::string coefficients_key(const YamlFields& file, const MatrixKey& matrix) {
  if (*matrix.coefficients != '\0') {
    if (!file.has(matrix.coefficients))
      file.fail(matrix.coefficients,
                "expected the coefficients that belong to " + std::string(matrix.matrix));
    return matrix.coefficients;
  }
  std::string found;
  for (const char* key : coefficient_keys) {
    if (!file.has(key)) continue;
    if (!found.empty()) file.fail(key, "expected one list of coefficients, got '" + found + "', too");
    found = key;
  }
  if (!found.empty()) return found;
  if (file.has("distortion_model") && file.text("distortion_model") != "none")
    file.fail("distortion_coefficients", "expected those of its distortion_model, got nothing of that name");
  for (const std::string& key : file.keys()) {
    std::string low = key;
    for (char& c : low) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const bool is_other = low.ends_with("model") || low.ends_with("type");
    if (!is_other && (low.find("distort") != std::string::npos || low.find("distc") != std::string::npos))
      file.fail(key, "expected the lens's coefficients as distortion_coefficients, got another name");
  }
  return "";
}

/// ROS's camera_info, and what OpenCV's users write.
CameraIntrinsics read_camera_info(const YamlFields& file, const std::string& wanted,
                                  std::optional<ImageSize> given, bool is_rectified) {
  const MatrixKey matrix = matrix_key(file, wanted);
  const std::vector<double> k = read_matrix(file, matrix.matrix);
  const ImageSize size = read_size(file, given);
  CameraIntrinsics camera{size.width, size.height, k[0], k[4], k[2], k[5], {}};
  const std::string coefficients = coefficients_key(file, matrix);
  if (!coefficients.empty()) take_coefficients(file, coefficients, camera);
  return is_rectified ? read_rectified(file, camera) : camera;
}

/// librealsense's intrinsics, by their names there.
CameraIntrinsics read_realsense(const YamlFields& fields, std::optional<ImageSize> given, bool is_rectified) {
  const ImageSize size = read_size(fields, given);
  CameraIntrinsics camera{size.width,
                          size.height,
                          fields.number("fx", positive),
                          fields.number("fy", positive),
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

bool is_realsense(const YamlFields& fields) { return fields.has("ppx"); }
bool is_open3d(const YamlFields& fields) { return fields.has("intrinsic_matrix"); }

/// The map of the file that is a camera of one of these two kinds: itself, or one in it, by the name of that
/// or of what holds it. Nothing when there is none.
std::optional<YamlFields> json_camera(const YamlFields& file, const std::string& wanted) {
  std::vector<std::pair<std::string, YamlFields>> found;
  const auto look = [&](const auto& again, const YamlFields& fields, const std::string& name) -> void {
    constexpr std::size_t most = 100, most_keys = 1000;
    if (is_realsense(fields) || is_open3d(fields)) return found.emplace_back(name, fields), void();
    const std::vector<std::string> keys = fields.keys();
    for (const std::string& key : keys)
      if (keys.size() <= most_keys && found.size() < most && fields.is_map(key))
        again(again, fields.map(key), name.empty() ? key : name + "." + key);
  };
  look(look, file, "");
  if (found.empty()) return std::nullopt;
  std::string names;
  for (const auto& [name, fields] : found) {
    if (found.size() == 1 && (wanted.empty() || name.empty())) return fields;
    if (!wanted.empty() && (name == wanted || name.starts_with(wanted + "."))) return fields;
    names += (names.empty() ? "" : ", ") + quote(name);
  }
  file.fail("", (wanted.empty() ? "" : "it has no camera " + quote(wanted) + "; ") + "it has " + names +
                    ": expected `camera: {file: …, name: …}` to name one of them");
}

/// A message as it is printed says more of its K than OpenCV's users do.
bool is_echo(const YamlFields& file) {
  if (file.has("k")) return true;
  return file.has("K") && (file.has("P") || file.has("R") || file.has("header"));
}

bool has_any_matrix(const YamlFields& file) {
  return std::any_of(std::begin(matrix_keys), std::end(matrix_keys),
                     [&file](const MatrixKey& key) { return file.has(key.matrix); });
}

CameraIntrinsics read_any(const YamlFields& file, const std::string& camera, bool is_rectified,
                          std::optional<ImageSize> size) {
  if (is_echo(file)) return read_echo(file, is_rectified);
  if (file.has("image_width") || has_any_matrix(file))
    return read_camera_info(file, camera, size, is_rectified);
  if (const auto fields = json_camera(file, camera))
    return is_realsense(*fields) ? read_realsense(*fields, size, is_rectified)
                                 : read_open3d(*fields, size, is_rectified);
  const std::vector<std::string> keys = file.keys();
  if (std::any_of(keys.begin(), keys.end(), [](const std::string& key) { return key.starts_with("cam"); }))
    return read_camchain(file, camera, is_rectified);
  file.fail("",
            "expected kalibr's camchain (`cam0`), ROS's camera_info or OpenCV's calibration (`image_width`, "
            "`camera_matrix`), a CameraInfo as `ros2 topic echo` prints it (`width`, `k`), librealsense's "
            "intrinsics (`fx`, `ppx`), Open3D's (`intrinsic_matrix`), or a matrix alone");
}

}  // namespace

CameraIntrinsics parse_camera_file(const std::string& text, const std::string& name,
                                   const std::string& camera, bool is_rectified,
                                   std::optional<ImageSize> size) {
  const std::string called = "camera file " + quote_path(name);
  if (is_numbers_alone(text)) {
    CameraIntrinsics pinhole = camera_of_matrix_text(text, called, size);
    pinhole.is_rectified = is_rectified;
    return pinhole;
  }
  // OpenCV's FileStorage begins with a directive that YAML does not have.
  const bool is_opencv = text.starts_with("%YAML:1.0");
  const YamlFields file(is_xml(text) ? yaml_of_opencv_xml(text, called)
                        : is_opencv  ? text.substr(std::min(text.find('\n'), text.size()))
                                     : text,
                        called);
  const CameraIntrinsics read = read_any(file, camera, is_rectified, size);
  const auto sides = [](const ImageSize& of) {
    return std::to_string(of.width) + " x " + std::to_string(of.height);
  };
  if (size && *size != ImageSize{read.width, read.height})
    file.fail("", "its pictures have " + sides({read.width, read.height}) + " pixels, expected " +
                      sides(*size) + ", as the pictures have or the setup says");
  return read;
}

CameraIntrinsics load_camera_file(const std::filesystem::path& file, const std::string& camera,
                                  bool is_rectified, std::optional<ImageSize> size) {
  return parse_camera_file(read_text(file, "camera file"), file.string(), camera, is_rectified, size);
}

}  // namespace clearway
