#include "datasets/camera_files/slam_camera.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"
#include "datasets/camera_files/opencv_camera.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

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

/// The lens that ORB-SLAM3's `Camera.type` or OpenVSLAM's `Camera.model` names.
std::optional<LensModel> orb_slam_lens(const YamlFields& fields) {
  if (fields.has("Camera.type")) {
    const std::string type = fields.text("Camera.type");
    if (type == "PinHole") return LensModel::rational;  // with k4, k5 and k6, else a plumb bob
    if (type == "KannalaBrandt8") return LensModel::fisheye;
    fields.fail("Camera.type", "expected PinHole, KannalaBrandt8 or Rectified, got " + quote(type));
  }
  const std::string model = fields.is_word("Camera.model") ? fields.text("Camera.model") : "";
  if (model == "fisheye") return LensModel::fisheye;
  if (model == "equirectangular" || model == "radial_division")
    fields.fail("Camera.model", "expected perspective or fisheye, got " + quote(model));
  if (fields.has("Camera.FishEye") && fields.integer("Camera.FishEye", {0, 1}) == 1)
    return LensModel::fisheye;
  return std::nullopt;
}

/// @param beside the lens that the setup states
void take_orb_slam_lens(const YamlFields& fields, const std::string& prefix, std::optional<LensModel> beside,
                        CameraIntrinsics& camera) {
  if (fields.has("Camera.type") && fields.text("Camera.type") == "Rectified") return;
  const std::optional<LensModel> named = orb_slam_lens(fields);
  if (!named && beside == LensModel::fisheye && !fields.has(prefix + "k1"))
    fields.fail(prefix + "k1", "it has no coefficients of its fisheye, expected k1, k2, k3, k4");
  if (named != LensModel::fisheye)
    return take_named_coefficients(fields, prefix, named ? named : beside, camera);
  std::array<double, 4> coefficients{};  // they read no others, whatever else stands there
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    coefficients[i] = fields.number(prefix + "k" + std::to_string(i + 1), within_reach, 0.0);
  set_lens(camera, LensModel::fisheye, coefficients);
}

/// By either's names, else `given`.
ImageSize orb_slam_size(const YamlFields& fields, std::optional<ImageSize> given) {
  constexpr Bounds sides{32, 20000};
  if (fields.has("Camera.cols") || fields.has("Camera.rows"))
    return {fields.integer("Camera.cols", sides), fields.integer("Camera.rows", sides)};
  if (!fields.has("Camera.width") && !fields.has("Camera.height")) {
    if (given) return *given;
    fields.fail(
        "Camera.width",
        "it does not say how large the pictures are: expected Camera.width and Camera.height, or `width` "
        "and `height` beside `file`");
  }
  return {fields.integer("Camera.width", sides), fields.integer("Camera.height", sides)};
}

}  // namespace

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

bool is_orb_slam(const YamlFields& file) { return !orb_slam_prefixes(file).empty(); }

CameraIntrinsics read_orb_slam(const YamlFields& fields, const std::string& wanted,
                               const BesideFile& beside) {
  if ((wanted == "LEFT" || wanted == "RIGHT") && fields.has(wanted + ".K"))
    return read_orb_slam_raw(fields, wanted, beside.is_rectified);
  if (fields.has("LEFT.K") && !beside.is_rectified)
    fields.fail("LEFT.K",
                "Camera.fx and so on are of rectified pictures, LEFT.K and RIGHT.K of raw ones: expected "
                "`name: LEFT` or `name: RIGHT` beside `file`, or `rectified: true`");
  require_raw_of_stella(fields, beside.is_rectified);
  const std::vector<std::string> prefixes = orb_slam_prefixes(fields);
  const std::string prefix = wanted.empty() ? prefixes.front() : wanted + ".";
  if (std::find(prefixes.begin(), prefixes.end(), prefix) == prefixes.end())
    fields.fail("", "it has no camera " + quote(wanted) +
                        ", expected `name` beside `file` to be as its keys " + "begin, such as Camera1");
  const ImageSize size = orb_slam_size(fields, beside.size);
  CameraIntrinsics camera{size.width,
                          size.height,
                          fields.number(prefix + "fx", above_zero),
                          fields.number(prefix + "fy", above_zero),
                          fields.number(prefix + "cx", within_reach),
                          fields.number(prefix + "cy", within_reach),
                          {}};
  take_orb_slam_lens(fields, prefix, beside.is_rectified ? std::nullopt : beside.lens, camera);
  return only_camera(fields, camera, beside.is_rectified);
}

void require_raw_of_stella(const YamlFields& file, bool is_rectified) {
  if (!is_rectified && (file.is_map("StereoRectifier") || file.has("StereoRectifier.K_left")))
    file.fail("StereoRectifier",
              "Camera is of rectified pictures, K_left and K_right of raw ones: expected `rectified: true` "
              "beside `file`, or the raw camera's numbers in the setup");
}

}  // namespace clearway
