#include "datasets/ros/ros_camera.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>

#include "datasets/cameras/realsense_lens.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/number_text.hpp"
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
  if (is_realsense_lens(info.distortion_model)) {  // bags of its SDK
    try {
      return set_realsense_lens(camera, info.distortion_model, info.d);
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(std::string("of its distortion, ") + error.what());
    }
  }
  const auto lens = lens_named(info.distortion_model);
  if (lens == LensModel::fisheye && info.d.size() < 4)
    throw std::runtime_error("its distortion " + quote(info.distortion_model) + " has " +
                             counted(info.d.size(), "number") + ", expected k1, k2, k3, k4");
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
  if (!is_part && (info.roi_width > 0 || info.roi_height > 0 || info.roi_x > 0 || info.roi_y > 0))
    throw std::runtime_error("its region of interest begins at " + std::to_string(info.roi_x) + ", " +
                             std::to_string(info.roi_y) + " and has " + std::to_string(info.roi_width) +
                             " x " + std::to_string(info.roi_height) +
                             " pixels, expected all of them 0, or a size");
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

/// The rotation nearest to R, or no turn where it was left zero.
Eigen::Matrix3d rectification_of(const RosCameraInfo& info) {
  if (is_zero(info.r)) return Eigen::Matrix3d::Identity();
  if (!is_finite(info.r)) throw std::runtime_error("its R is not a rotation");
  const Eigen::Matrix3d stated = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(info.r.data());
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(stated, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
  // Each of nine numbers that were rounded to four decimals is off by at most half a step, and the nearest
  // rotation is no farther than the true one.
  constexpr double rounding = 3.0 * 0.5e-4 + 1e-12;
  if (!(turn.determinant() > 0.0 && (turn - stated).norm() <= rounding))
    throw std::runtime_error("its R is not a rotation, even if its numbers were rounded to four decimals");
  return stated.isUnitary(1e-12) ? stated : turn;
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
  const std::array<double, 9>& k = info.k;
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    throw std::runtime_error(
        "its K is no camera matrix without skew: expected fx 0 cx, 0 fy cy, 0 0 1, row by row");
  return lens_named(info.distortion_model) != LensModel::fisheye && is_zero(info.d);
}

}  // namespace

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
  const bool is_part = info.roi_width > 0 && (info.roi_width < info.width || info.roi_height < info.height);
  if (is_part && info.do_rectify)
    throw std::runtime_error(
        "its region of interest has do_rectify, so that its rectified images show another window of which "
        "nothing says where it begins; expected the whole image, do_rectify false, or raw images "
        "('rectified: false')");
  camera.is_rectified = true;
  return {read_out(info, camera), Eigen::Matrix3d::Identity()};
}

}  // namespace clearway
