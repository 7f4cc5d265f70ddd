#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "tracking/camera.hpp"

namespace clearway {

/// A corner of what is drawn, in the camera frame.
struct CameraCorner {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< metres
  double light = 1.0;                               ///< share of the colour's brightness that is seen, 0 to 1
};

/// A corner in the image.
struct ScreenCorner {
  float x = 0.0F, y = 0.0F;    ///< pixels, the upper left one's centre at (0, 0)
  float inverse_depth = 0.0F;  ///< 1/z, per metre
  float light = 1.0F;
};

using ScreenTriangle = std::array<ScreenCorner, 3>;

struct ProjectorOptions {
  double near = 0.005;      ///< metres before the camera; nothing nearer is drawn
  double tolerance = 0.25;  ///< pixels by which a drawn edge may leave the lens's curve
};

/// Takes points, segments and triangles of the camera frame to the pixels of a lens with distortion.
///
/// On the plane of normalised points (x/z, y/z) edges are straight and 1/z is linear, whatever the depth. So
/// parts before the near plane are kept, cut there to the rectangle that the image sees, and halved at their
/// longest edge until the lens bends no edge by more than the tolerance: then the corners are distorted and
/// what lies between them is linear in pixels. An edge is halved or not by itself alone, so that two
/// triangles that share it fit together.
class Projector {
 public:
  /// @throws std::invalid_argument as Camera::validate, and for options that are not positive.
  explicit Projector(const Camera& camera, const ProjectorOptions& options = {});

  const Camera& camera() const { return camera_; }
  double near() const { return options_.near; }

  /// Where a point is seen, possibly outside the image. Empty nearer than the near plane, behind the camera
  /// and beyond the angle at which the lens folds.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& point) const;

  /// The corner alone, for a triangle whose corners are shared; empty where `is_plain` does not hold for it.
  std::optional<ScreenCorner> plain_corner(const CameraCorner& corner) const;
  /// Whether a triangle of plain corners can be drawn as it is: no edge of it needs to be halved.
  bool is_plain(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const;

  /// Calls `emit` for the pieces of a triangle that the image may see, in a fixed order.
  void triangle(const std::array<CameraCorner, 3>& corners,
                const std::function<void(const ScreenTriangle&)>& emit) const;

  /// The pieces of a segment that the image may see, end to end; two corners each.
  std::vector<std::array<ScreenCorner, 2>> segment(const Eigen::Vector3d& from,
                                                   const Eigen::Vector3d& to) const;

 private:
  /// On the plane of normalised points.
  struct RayCorner {
    double u = 0.0, v = 0.0, inverse_depth = 0.0, light = 1.0;
  };
  struct Bounds {
    Eigen::Array2d low, high;
  };
  static RayCorner ray(const CameraCorner& corner);
  static RayCorner between(const RayCorner& a, const RayCorner& b, double share);
  static Bounds seen_rays(const Camera& camera);
  double strongest_bend() const;
  std::optional<ScreenCorner> screen(const RayCorner& corner) const;
  bool is_long(const RayCorner& a, const RayCorner& b) const;
  bool is_bent(const RayCorner& a, const RayCorner& b) const;
  std::vector<double> shares_of(const RayCorner& begin, const RayCorner& end) const;
  std::vector<RayCorner> cut(const std::array<CameraCorner, 3>& corners) const;
  void halve(const std::array<RayCorner, 3>& corners, int depth,
             const std::function<void(const ScreenTriangle&)>& emit) const;

  Camera camera_;
  ProjectorOptions options_;
  LensDistortion lens_;
  Bounds seen_;
  double longest_squared_;  ///< of a plumb bob: edge that need not be halved, normalised
};

}  // namespace clearway
