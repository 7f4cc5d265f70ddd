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

}  // namespace clearway
