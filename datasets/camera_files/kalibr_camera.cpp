#include "datasets/camera_files/kalibr_camera.hpp"

#include <algorithm>
#include <vector>

#include "datasets/camera_files/camera_fields.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

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

}  // namespace clearway
