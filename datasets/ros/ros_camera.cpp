#include "datasets/ros/ros_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <stdexcept>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool is_side(std::uint32_t side) { return side >= 1 && side <= most_image_side; }

template <class Numbers>
bool is_zero(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return x == 0.0; });
}

template <class Numbers>
bool is_finite(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

/// Of the whole sensor, without distortion. @param matrix K or P, row by row @param columns 3 or 4
CameraIntrinsics pinhole(const RosCameraInfo& info, std::span<const double> matrix, std::size_t columns) {
  return {static_cast<int>(info.width),
          static_cast<int>(info.height),
          matrix[0],
          matrix[columns + 1],
          matrix[2],
          matrix[columns + 2],
          {}};
}

void set_lens_of(const RosCameraInfo& info, CameraIntrinsics& camera) {
  const auto lens = lens_named(info.distortion_model);
  if (lens == LensModel::fisheye && info.d.size() < 4)
    throw std::runtime_error("its distortion " + quote(info.distortion_model) + " has " +
                             std::to_string(info.d.size()) + " numbers, expected k1, k2, k3, k4");
  if (lens != LensModel::fisheye && is_zero(info.d)) return;
  if (!lens)
    throw std::runtime_error("its distortion " + quote(info.distortion_model) +
                             " is not known here, expected " + known_lenses);
  try {
    set_lens(camera, *lens, info.d);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error("its distortion does not fit " + quote(info.distortion_model) + ": " +
                             error.what());
  }
}

/// From the whole sensor to what is read out of it.
CameraIntrinsics read_out(const RosCameraInfo& info, CameraIntrinsics camera) {
  const bool is_part = info.roi_width > 0 && info.roi_height > 0;
  if (is_part && (info.roi_x > info.width || info.roi_width > info.width - info.roi_x ||
                  info.roi_y > info.height || info.roi_height > info.height - info.roi_y))
    throw std::runtime_error("its region of interest lies beyond its sensor");
  const std::uint32_t columns = std::max(info.binning_x, 1U), rows = std::max(info.binning_y, 1U);
  camera.width = static_cast<int>((is_part ? info.roi_width : info.width) / columns);
  camera.height = static_cast<int>((is_part ? info.roi_height : info.height) / rows);
  if (camera.width == 0 || camera.height == 0)
    throw std::runtime_error("its binning leaves no pixel of its image");
  if (is_part) {
    camera.cx -= info.roi_x;
    camera.cy -= info.roi_y;
  }
  camera.fx /= columns;
  camera.cx /= columns;
  camera.fy /= rows;
  camera.cy /= rows;
  return camera;
}

/// R, or no turn where it was left zero.
Eigen::Matrix3d rectification_of(const RosCameraInfo& info) {
  if (is_zero(info.r)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d turn = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(info.r.data());
  constexpr double rounding = 1e-4;  // of calibrations that were written with few digits
  const bool is_turn = is_finite(info.r) && turn.determinant() > 0.0 &&
                       (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm() < rounding;
  if (!is_turn) throw std::runtime_error("its R is not a rotation");
  return turn;
}

/// The rows of a projection without skew: fx 0 cx Tx, 0 fy cy Ty, 0 0 1 0.
void require_projection(const std::array<double, 12>& p) {
  const bool is_sound = is_finite(p) && p[0] > 0.0 && p[5] > 0.0 && p[1] == 0.0 && p[4] == 0.0 &&
                        p[8] == 0.0 && p[9] == 0.0 && p[10] == 1.0;
  if (!is_sound)
    throw std::runtime_error("its P is not a projection: expected fx 0 cx Tx, 0 fy cy Ty, 0 0 1 0");
}

/// Throws where the message is no calibration at all.
/// @returns whether the lens is without distortion
bool require_calibration(const RosCameraInfo& info) {
  if (!is_side(info.width) || !is_side(info.height))
    throw std::runtime_error("its sides are not 1 to 20000 pixels each");
  if (!is_finite(info.k) || !is_finite(info.d) || info.k[0] <= 0.0 || info.k[4] <= 0.0)
    throw std::runtime_error("it is not calibrated");
  return lens_named(info.distortion_model) != LensModel::fisheye && is_zero(info.d);
}

}  // namespace

bool is_named_rectified(const std::string& topic) {
  std::string name = topic;
  for (const char* transport : {"/compressed", "/compressedDepth", "/zstd", "/theora"})
    if (topic.ends_with(transport)) name.resize(topic.size() - std::string(transport).size());
  return name.substr(name.rfind('/') + 1).starts_with("image_rect");
}

RosCamera raw_camera(const RosCameraInfo& info) {
  require_calibration(info);
  CameraIntrinsics camera = pinhole(info, info.k, 3);
  set_lens_of(info, camera);
  return {read_out(info, camera), rectification_of(info)};
}

RosCamera rectified_camera(const RosCameraInfo& info) {
  CameraIntrinsics camera;
  if (!is_zero(info.p)) {
    if (!is_side(info.width) || !is_side(info.height))
      throw std::runtime_error("its sides are not 1 to 20000 pixels each");
    require_projection(info.p);
    camera = pinhole(info, info.p, 4);
  } else {
    const bool is_pinhole = require_calibration(info);
    if (!is_pinhole || !rectification_of(info).isIdentity())
      throw std::runtime_error(
          "its P is all 0, so that nothing says what its rectified images follow; expected "
          "P, or raw images ('rectified: false')");
    camera = pinhole(info, info.k, 3);
  }
  camera.is_rectified = true;
  return {read_out(info, camera), Eigen::Matrix3d::Identity()};
}

std::vector<Eigen::Vector2d> depth_rays(const CameraIntrinsics& camera) {
  const bool is_bent = camera.lens == LensModel::fisheye || !is_zero(camera.distortion);
  CameraIntrinsics limited = camera;  // a plumb bob is a rational lens, and as such it has an end
  if (is_bent && camera.lens == LensModel::plumb_bob) limited.lens = LensModel::rational;
  const Lens lens(limited);
  const Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Eigen::Vector2d> rays;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      if (!is_bent) {
        rays.emplace_back((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy);
        continue;
      }
      const auto ray = lens.pixel_ray({column, row});
      rays.push_back(ray ? Eigen::Vector2d(ray->head<2>()) : nowhere);
    }
  }
  return rays;
}

}  // namespace clearway
