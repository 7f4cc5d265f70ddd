#include "datasets/camera_files/camera_fields.hpp"

#include <array>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::pair<const char*, const char*> size_keys[] = {
    {"image_width", "image_height"},
    {"image_Width", "image_Height"},
    {"imageWidth", "imageHeight"},
    {"calibration_image_width", "calibration_image_height"},
    {"width", "height"},
    {"cols", "rows"},  // stella_vslam
    {"w", "h"}};

/// Refuses what is not 0 of the names behind `prefix`.
void refuse_numbers(const YamlFields& fields, const std::string& prefix, std::span<const char* const> names,
                    const std::string& expected) {
  for (const char* name : names) {
    const std::string key = prefix + name;
    if (fields.has(key) && !fields.is_map(key) && !fields.is_word(key) && !fields.is_list(key) &&
        fields.number(key, within_reach) != 0.0)
      fields.fail(key, expected);
  }
}

}  // namespace

void take_named_coefficients(const YamlFields& fields, const std::string& prefix,
                             std::optional<LensModel> lens, CameraIntrinsics& camera) {
  constexpr std::array none_of_any{"xi", "alpha", "beta", "omega", "skew", "r1", "r2",
                                   "r3", "t1",    "t2",   "s1",    "s2",   "s3", "s4"};
  constexpr std::array none_of_fisheye{"k5", "k6", "p1", "p2"};
  constexpr std::array none_of_plumb_bob{"k4", "k5", "k6"};
  const bool is_fisheye = lens == LensModel::fisheye;
  const bool has_rational =
      fields.has(prefix + "k4") && fields.has(prefix + "k5") && fields.has(prefix + "k6");
  const bool is_rational = has_rational && lens.value_or(LensModel::rational) == LensModel::rational;
  const std::string plumb_bob = "expected a plumb_bob, whose coefficients are k1, k2, p1, p2, k3";
  const std::string fisheye = "expected a fisheye, whose coefficients are k1, k2, k3, k4";
  const std::string cure = lens ? "" : "; `lens: fisheye` beside `file` takes k1, k2, k3, k4";
  refuse_numbers(fields, prefix, none_of_any, is_fisheye ? fisheye : plumb_bob);
  if (is_fisheye)
    refuse_numbers(fields, prefix, none_of_fisheye, fisheye);
  else if (!is_rational)
    refuse_numbers(fields, prefix, none_of_plumb_bob, plumb_bob + cure);

  std::vector<const char*> names{"k1", "k2", "p1", "p2", "k3"};
  if (is_fisheye) names = {"k1", "k2", "k3", "k4"};
  if (is_rational) names.insert(names.end(), {"k4", "k5", "k6"});
  std::vector<double> coefficients;
  for (const char* name : names) coefficients.push_back(fields.number(prefix + name, within_reach, 0.0));
  set_lens(camera,
           is_fisheye    ? LensModel::fisheye
           : is_rational ? LensModel::rational
                         : LensModel::plumb_bob,
           coefficients);
}

void take_distortion(const YamlFields& fields, const std::string& key, LensModel lens,
                     CameraIntrinsics& camera) {
  const std::vector<double> values = fields.flat_numbers(key, within_reach);
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
  const std::string name = lower_case(fields.text(key, otherwise));
  if (name == "none") return LensModel::plumb_bob;
  const auto lens = lens_named(name);
  if (!lens) fields.fail(key, "the lens '" + name + "' is not known, expected " + known_lenses);
  return *lens;
}

std::optional<LensModel> named_lens(const YamlFields& file) {
  if (file.has("distortion_model")) return read_lens(file, "distortion_model", "plumb_bob");
  for (const char* key : {"model", "camera_model", "lens", "lens_model", "camera_type", "distortionModel",
                          "distortion_type", "cameraModel"}) {
    if (!file.is_word(key)) continue;
    const std::string name = lower_case(file.text(key));
    const auto says = [&](const char* word) { return name.find(word) != std::string::npos; };
    const bool is_other_fisheye = says("solid") || says("stereographic") || says("orthographic");
    const bool is_fisheye = says("fisheye") || says("equidist") || name == "equi" || says("kannala") ||
                            name == "kb4" || name == "kb8";
    if (is_fisheye && !is_other_fisheye) return LensModel::fisheye;
    if (const auto lens = lens_named(name)) return lens;
    const bool is_other = is_other_fisheye || says("equirect") || says("omni") || says("fov") ||
                          says("sphere") || says("mei") || says("eucm") || says("unified") ||
                          says("scaramuzza") || says("division") || name == "ds" || name == "ucm" ||
                          name == "atan";
    if (is_other) file.fail(key, "the lens " + quote(name) + " is not known, expected " + known_lenses);
  }
  return std::nullopt;
}

CameraIntrinsics only_camera(const YamlFields& fields, CameraIntrinsics camera, bool is_rectified) {
  if (is_rectified && has_distortion(camera))
    fields.fail("",
                "it says nothing of rectified pictures: expected ROS's camera_info with a projection_matrix");
  camera.is_rectified = is_rectified;
  return camera;
}

void require_name(const YamlFields& file, const std::string& wanted) {
  if (wanted.empty() || (file.has("camera_name") && file.text("camera_name") == wanted)) return;
  file.fail("", "it has one camera, which is not called " + quote(wanted) +
                    ": expected no `name` beside `file`, or another file");
}

ImageSize read_size(const YamlFields& file, std::optional<ImageSize> given) {
  constexpr Bounds sides{32, 20000};
  for (const auto& [width, height] : size_keys)
    if (file.has(width) || file.has(height)) return {file.integer(width, sides), file.integer(height, sides)};
  if (file.is_map("resolution")) {  // PhotonVision
    const YamlFields size = file.map("resolution");
    return {size.integer("width", sides), size.integer("height", sides)};
  }
  for (const char* name : {"image_size", "imageSize", "img_size"}) {
    if (!file.has(name)) continue;
    const std::vector<double> size =
        file.is_map(name) ? file.map(name).numbers("data", sides, 2) : file.numbers(name, sides, 2);
    return {static_cast<int>(size[0]), static_cast<int>(size[1])};
  }
  if (!given)
    file.fail("image_width",
              "it does not say how large the pictures are: expected image_width and image_height, or `width` "
              "and `height` beside `file`");
  return *given;
}

}  // namespace clearway
