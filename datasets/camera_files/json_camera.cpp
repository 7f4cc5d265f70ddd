#include "datasets/camera_files/json_camera.hpp"

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"
#include "datasets/camera_files/opencv_camera.hpp"
#include "datasets/cameras/realsense_lens.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// @param x, y the keys of its principal point
CameraIntrinsics read_pinhole(const YamlFields& fields, std::optional<ImageSize> given, const char* x,
                              const char* y) {
  const ImageSize size = read_size(fields, given);
  const double fx = fields.number("fx", above_zero), fy = fields.number("fy", above_zero);
  return {size.width, size.height, fx, fy, fields.number(x, within_reach), fields.number(y, within_reach),
          {}};
}

/// librealsense's intrinsics, by their names there.
CameraIntrinsics read_realsense(const YamlFields& fields, std::optional<ImageSize> given, bool is_rectified) {
  CameraIntrinsics camera = read_pinhole(fields, given, "ppx", "ppy");
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
  CameraIntrinsics camera = read_pinhole(fields, given, "cx", "cy");
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

bool is_realsense(const YamlFields& fields) { return fields.has("ppx"); }
bool is_open3d(const YamlFields& fields) { return fields.has("intrinsic_matrix"); }

}  // namespace

bool is_plain_camera(const YamlFields& fields) {
  return fields.has("fx") && fields.has("fy") && fields.has("cx") && fields.has("cy");
}

std::optional<YamlFields> json_camera(const YamlFields& file, const std::string& wanted) {
  std::vector<std::pair<std::string, YamlFields>> found;
  const auto look = [&](const auto& again, const YamlFields& fields, const std::string& name) -> void {
    constexpr std::size_t most = 100, most_keys = 1000;
    if (is_realsense(fields) || is_open3d(fields) || is_plain_camera(fields))
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

CameraIntrinsics read_json_camera(const YamlFields& fields, std::optional<ImageSize> given,
                                  bool is_rectified) {
  if (is_realsense(fields)) return read_realsense(fields, given, is_rectified);
  return is_open3d(fields) ? read_open3d(fields, given, is_rectified)
                           : read_plain(fields, given, is_rectified);
}

}  // namespace clearway
