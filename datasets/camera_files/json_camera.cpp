#include "datasets/camera_files/json_camera.hpp"

#include <algorithm>
#include <cstring>
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

/// A key in lower case, without the words that say which of a camera's numbers stand there: "rgb" of
/// "rgbDistortion" and of "rgb_intrinsics".
std::string camera_word(const std::string& key) {
  std::string word = lower_case(key);
  for (const char* part :
       {"distortion", "undistort", "distort", "dist", "coefficients", "coeffs", "coeff", "coefs",
        "parameters", "params", "intrinsics", "intrinsic", "camera", "lens", "_", "-", "."})
    for (std::size_t at; (at = word.find(part)) != std::string::npos;) word.erase(at, std::strlen(part));
  return word;
}

bool is_coefficients_key(const YamlFields& fields, const std::string& key) {
  const std::string low = lower_case(key);
  return (fields.is_map(key) || fields.is_list(key)) &&
         (low.find("distort") != std::string::npos || low.find("dist_c") != std::string::npos ||
          low.find("distc") != std::string::npos);
}

/// Whether another map beside it is a camera of that word.
bool is_of_other(const JsonCamera::Holder& holder, const std::string& word) {
  const std::vector<std::string> keys = holder.fields.keys();
  return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
    return key != holder.key && holder.fields.is_map(key) && !is_coefficients_key(holder.fields, key) &&
           camera_word(key) == word;
  });
}

/// The key beside a camera whose coefficients are that camera's; empty: none. Refuses what may be.
std::string coefficients_beside(const JsonCamera::Holder& holder) {
  std::string found;
  for (const std::string& key : holder.fields.keys()) {
    if (!is_coefficients_key(holder.fields, key) || key == holder.key) continue;
    const std::string word = camera_word(key);
    if (word != camera_word(holder.key)) {
      if (!is_of_other(holder, word))
        holder.fields.fail(key, "expected the coefficients inside of " + quote(holder.key) +
                                    ", or beside it as " + quote(holder.key + "_distortion"));
      continue;
    }
    if (!found.empty())
      holder.fields.fail(key, "expected one list of coefficients, got " + quote(found) + ", too");
    found = key;
  }
  return found;
}

/// Coefficients at a key, by their names or as a list.
void take_coefficients_at(const YamlFields& fields, const std::string& key, CameraIntrinsics& camera,
                          BesideFile& beside) {
  if (!fields.is_map(key) || fields.map(key).has("data"))
    return take_coefficients(fields, key, camera, beside);
  const YamlFields named = fields.map(key);
  if (!named.has("k1") && !named.has("p1"))
    fields.fail(key, "expected a list, or the coefficients by their names, k1, k2, p1, p2, k3");
  const auto lens = named_lens(named);
  take_named_coefficients(named, "", lens ? lens : beside.lens, camera);
}

/// The lens that the camera names, or what holds it, or the setup.
std::optional<LensModel> lens_of(const JsonCamera& camera, std::optional<LensModel> otherwise) {
  if (const auto lens = named_lens(camera.fields)) return lens;
  for (auto holder = camera.holders.rbegin(); holder != camera.holders.rend(); ++holder)
    if (const auto lens = named_lens(holder->fields)) return lens;
  return otherwise;
}

/// Numbers alone, by the names that a setup has, too, and OpenCV's.
CameraIntrinsics read_plain(const YamlFields& fields, BesideFile& beside) {
  CameraIntrinsics camera = read_pinhole(fields, beside.size, "cx", "cy");
  take_named_coefficients(fields, "", beside.lens, camera);
  if (const std::string key = coefficients_key(fields); !key.empty())
    take_coefficients_at(fields, key, camera, beside);
  return camera;
}

bool is_realsense(const YamlFields& fields) { return fields.has("ppx"); }
bool is_open3d(const YamlFields& fields) { return fields.has("intrinsic_matrix"); }

}  // namespace

bool is_plain_camera(const YamlFields& fields) {
  return fields.has("fx") && fields.has("fy") && fields.has("cx") && fields.has("cy");
}

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
  BesideFile here = beside;
  here.lens = lens_of(found, beside.lens);
  CameraIntrinsics camera = is_realsense(found.fields) ? read_realsense(found.fields, beside.size)
                            : is_open3d(found.fields)  ? read_open3d(found.fields, beside.size)
                                                       : read_plain(found.fields, here);
  for (const JsonCamera::Holder& holder : found.holders) {
    const std::string key = coefficients_beside(holder);
    if (key.empty()) continue;
    const auto own = coefficients_of(camera);
    const bool is_bent = std::any_of(own.begin(), own.end(), [](double k) { return k != 0.0; });
    if (is_bent) holder.fields.fail(key, "expected one list of coefficients, got others, too");
    take_coefficients_at(holder.fields, key, camera, here);
  }
  beside.note = here.note;
  return only_camera(found.fields, camera, beside.is_rectified);
}

}  // namespace clearway
