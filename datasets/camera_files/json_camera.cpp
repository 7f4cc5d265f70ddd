#include "datasets/camera_files/json_camera.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"
#include "datasets/camera_files/opencv_camera.hpp"
#include "datasets/camera_files/slam_camera.hpp"
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
CameraIntrinsics read_realsense(const YamlFields& fields, std::optional<ImageSize> given) {
  CameraIntrinsics camera = read_pinhole(fields, given, "ppx", "ppy");
  std::vector<double> coefficients;
  if (fields.has("coeffs")) coefficients = fields.numbers("coeffs", within_reach, 5);
  try {
    set_realsense_lens(camera, fields.text("model", ""), coefficients);
  } catch (const std::runtime_error& error) {
    fields.fail(fields.has("model") ? "model" : "coeffs", error.what());
  }
  return camera;
}

/// Open3D's PinholeCameraIntrinsic: its matrix stands column by column.
CameraIntrinsics read_open3d(const YamlFields& fields, std::optional<ImageSize> given) {
  const std::vector<double> k = fields.numbers("intrinsic_matrix", within_reach, 9);
  if (k[0] <= 0.0 || k[4] <= 0.0 || k[1] != 0.0 || k[2] != 0.0 || k[3] != 0.0 || k[5] != 0.0 || k[8] != 1.0)
    fields.fail("intrinsic_matrix",
                "expected [fx, 0, 0, 0, fy, 0, cx, cy, 1] column by column, fx and fy > 0");
  const ImageSize size = read_size(fields, given);
  return {size.width, size.height, k[0], k[4], k[6], k[7], {}};
}

/// The lens that the camera names, or what holds it, or the setup.
std::optional<LensModel> lens_of(const JsonCamera& camera, std::optional<LensModel> otherwise) {
  if (const auto lens = named_lens(camera.fields)) return lens;
  for (auto holder = camera.holders.rbegin(); holder != camera.holders.rend(); ++holder)
    if (const auto lens = lens_of_holder(holder->fields)) return lens;
  return otherwise;
}

bool has_named_coefficients(const YamlFields& fields) { return fields.has("k1") || fields.has("p1"); }

/// Where the camera's coefficients stand, in it or beside it.
std::optional<CoefficientsPlace> coefficients_of_camera(const JsonCamera& camera, bool is_rectified) {
  std::vector<CoefficientsPlace> found;
  if (has_named_coefficients(camera.fields)) found.push_back({camera.fields, ""});
  if (const std::string key = coefficients_key(camera.fields); !key.empty())
    if (const auto place = coefficients_at(camera.fields, key)) found.push_back(*place);
  if (!is_rectified)
    if (const auto place = coefficients_beside(camera.holders)) found.push_back(*place);
  if (found.size() > 1) camera.fields.fail("", "expected the coefficients of its lens once, got them twice");
  return found.empty() ? std::nullopt : std::optional(found.front());
}

/// Numbers alone, by the names that a setup has, too, and OpenCV's.
CameraIntrinsics read_plain(const JsonCamera& found, BesideFile& beside) {
  const YamlFields& fields = found.fields;
  CameraIntrinsics camera = read_pinhole(fields, beside.size, "cx", "cy");
  const auto place = coefficients_of_camera(found, beside.is_rectified);
  const std::optional<LensModel> lens = lens_of(found, beside.lens);
  if (!place && lens == LensModel::fisheye && !beside.is_rectified)
    fields.fail("k1", "it has no coefficients of its fisheye, expected k1, k2, k3, k4");
  if (!place) {
    take_named_coefficients(fields, "", std::nullopt, camera);  // refuses those of other lenses
  } else if (place->key.empty()) {
    take_named_coefficients(place->fields, "", lens, camera);
  } else {
    take_listed_coefficients(place->fields, place->key, lens, camera, beside);
  }
  return camera;
}

}  // namespace

std::optional<JsonCamera> json_camera(const YamlFields& file, const std::string& wanted) {
  std::vector<std::pair<std::string, JsonCamera>> found;
  const auto look = [&](const auto& again, const JsonCamera& at, const std::string& name) -> void {
    constexpr std::size_t most = 100, most_keys = 1000;
    if (is_realsense(at.fields) || is_open3d(at.fields) || is_plain_camera(at.fields))
      return found.emplace_back(name, at), void();
    const std::vector<std::string> keys = at.fields.keys();
    for (const std::string& key : keys) {
      if (keys.size() > most_keys || found.size() >= most || !at.fields.is_map(key)) continue;
      JsonCamera inner{at.fields.map(key), at.holders};
      inner.holders.push_back({at.fields, key});
      again(again, inner, name.empty() ? key : name + "." + key);
    }
  };
  look(look, {file, {}}, "");
  if (found.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& [name, camera] : found) {
    if (name.empty()) require_name(camera.fields, wanted);
    if (found.size() == 1 && (wanted.empty() || name.empty())) return camera;
    if (!wanted.empty() && (name == wanted || name.starts_with(wanted + "."))) return camera;
    names.push_back(quote(name));
  }
  file.fail("", (wanted.empty() ? "" : "it has no camera " + quote(wanted) + "; ") + "it has " +
                    listed(names) + ": expected `camera: {file: …, name: …}` to name one of them");
}

CameraIntrinsics read_json_camera(const JsonCamera& found, BesideFile& beside) {
  if (!found.holders.empty()) require_raw_of_stella(found.holders.front().fields, beside.is_rectified);
  if (is_realsense(found.fields))
    return only_camera(found.fields, read_realsense(found.fields, beside.size), beside.is_rectified);
  if (!is_open3d(found.fields))
    return only_camera(found.fields, read_plain(found, beside), beside.is_rectified);
  CameraIntrinsics camera = read_open3d(found.fields, beside.size);
  const auto place = beside.is_rectified ? std::nullopt : coefficients_beside(found.holders);
  if (place && place->key.empty())
    take_named_coefficients(place->fields, "", beside.lens, camera);
  else if (place)
    take_listed_coefficients(place->fields, place->key, beside.lens, camera, beside);
  return only_camera(found.fields, camera, beside.is_rectified);
}

}  // namespace clearway
