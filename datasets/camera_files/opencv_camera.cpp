#include "datasets/camera_files/opencv_camera.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "datasets/ros/ros_camera.hpp"
#include "datasets/sources/lens.hpp"

namespace clearway {
namespace {

/// The lens of a file that OpenCV wrote: by the number of its coefficients.
LensModel read_opencv_lens(const YamlFields& file, const std::vector<double>& coefficients) {
  if (file.integer("fisheye_model", {0, 1}, 0) == 1) return LensModel::fisheye;
  return coefficients.size() > 5 ? LensModel::rational : LensModel::plumb_bob;
}

/// How OpenCV's users call a camera's matrix, and its coefficients: those of any name, or of one of two.
struct MatrixKey {
  const char *matrix, *coefficients;
};
constexpr MatrixKey matrix_keys[] = {{"camera_matrix", ""},
                                     {"cameraMatrix", ""},
                                     {"Camera_Matrix", ""},
                                     {"CameraMatrix", ""},
                                     {"cameraIntrinsics", ""},
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
                                            "dist_coeff",
                                            "dist_coefs",
                                            "distortion_coeffs",
                                            "Distortion_Coefficients",
                                            "DistortionCoefficients",
                                            "DistCoeffs",
                                            "distortionCoefficients",
                                            "distortion",
                                            "dist",
                                            "kc",
                                            "D"};
/// The matrix that the file has, of several the one that is wanted.
MatrixKey matrix_key(const YamlFields& file, const std::string& wanted) {
  std::vector<MatrixKey> found;
  std::string names;
  for (const MatrixKey& key : matrix_keys) {
    if (!file.has(key.matrix)) continue;
    found.push_back(key);
    if (wanted == key.matrix) return key;
    names += (names.empty() ? "" : ", ") + std::string(key.matrix);
  }
  if (found.size() > 1)
    file.fail("", "it has several cameras, " + names +
                      ": expected `camera: {file: …, name: …}` to name one of them");
  require_name(file, wanted);
  return found.empty() ? matrix_keys[0] : found.front();
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
    const std::string low = lower_case(key);
    const bool holds_numbers = file.is_list(key) || file.is_map(key);
    const bool is_other = low.ends_with("model") || low.ends_with("type");
    if (!is_other &&
        (low.find("distort") != std::string::npos || low.find("distc") != std::string::npos ||
         (holds_numbers && (low.find("dist") != std::string::npos || low.find("coef") != std::string::npos ||
                            low == "radial" || low == "tangential"))))
      file.fail(key, "expected the lens's coefficients as distortion_coefficients, got another name");
  }
  return "";
}

}  // namespace

bool has_any_matrix(const YamlFields& file) {
  return std::any_of(std::begin(matrix_keys), std::end(matrix_keys),
                     [&file](const MatrixKey& key) { return file.has(key.matrix); });
}

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

void take_coefficients(const YamlFields& file, const std::string& key, CameraIntrinsics& camera,
                       BesideFile& beside) {
  const bool is_list = file.is_list(key);
  const YamlFields fields = is_list ? file : file.map(key);
  const std::string numbers = is_list ? key : "data";
  const std::vector<double> values = fields.flat_numbers(numbers, within_reach);
  std::optional<LensModel> lens = named_lens(file);
  if (!lens) lens = beside.lens;
  if (!lens && file.has("fisheye_model")) lens = read_opencv_lens(file, values);
  take_listed_coefficients(fields, numbers, lens, camera, beside);
}

void take_listed_coefficients(const YamlFields& fields, const std::string& key, std::optional<LensModel> lens,
                              CameraIntrinsics& camera, BesideFile& beside) {
  const std::size_t count = fields.flat_numbers(key, within_reach).size();
  take_distortion(fields, key, lens.value_or(count > 5 ? LensModel::rational : LensModel::plumb_bob), camera);
  if (!lens && count == 4 && has_distortion(camera))
    beside.note =
        "has four coefficients and names no lens: they are taken as k1, k2, p1, p2 of a plumb_bob; "
        "`lens: fisheye` beside `file` makes them cv::fisheye's, `lens: plumb_bob` ends this note";
}

std::string coefficients_key(const YamlFields& file) { return coefficients_key(file, matrix_keys[0]); }

CameraIntrinsics read_rectified(const YamlFields& file, const CameraIntrinsics& raw, const std::string& r,
                                const std::string& p) {
  RosCameraInfo info;
  info.width = static_cast<std::uint32_t>(raw.width);
  info.height = static_cast<std::uint32_t>(raw.height);
  info.distortion_model = lens_name(raw.lens);
  info.d.assign(raw.distortion.begin(), raw.distortion.end());
  info.k = {raw.fx, 0, raw.cx, 0, raw.fy, raw.cy, 0, 0, 1};
  const auto take = [&file](const std::string& ros, const std::string& opencv, auto& matrix) {
    const std::string key = file.has(ros) ? ros : opencv;
    if (!file.is_map(key)) return;
    const std::vector<double> values = file.map(key).numbers("data", within_reach, matrix.size());
    std::copy(values.begin(), values.end(), matrix.begin());
  };
  take("rectification_matrix", r, info.r);
  take("projection_matrix", p, info.p);
  try {
    return rectified_camera(info).intrinsics;
  } catch (const std::runtime_error& error) {
    file.fail("projection_matrix", error.what());
  }
}

CameraIntrinsics read_camera_info(const YamlFields& file, const std::string& wanted, BesideFile& beside) {
  const MatrixKey matrix = matrix_key(file, wanted);
  const std::vector<double> k = read_matrix(file, matrix.matrix);
  const ImageSize size = read_size(file, beside.size);
  CameraIntrinsics camera{size.width, size.height, k[0], k[4], k[2], k[5], {}};
  const std::string coefficients = coefficients_key(file, matrix);
  if (!coefficients.empty()) take_coefficients(file, coefficients, camera, beside);
  const std::string name = matrix.matrix, number = name.ends_with('1') ? "1" : name.ends_with('2') ? "2" : "";
  return beside.is_rectified ? read_rectified(file, camera, "R" + number, "P" + number) : camera;
}

}  // namespace clearway
