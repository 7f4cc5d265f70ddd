#pragma once

#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <span>
#include <variant>
#include <vector>

#include "datasets/descriptions/scene.hpp"

namespace clearway {

/// A printed tag with its quiet zone: opaque, grey from behind. Frame as in TagSetup.
struct TagShape {
  double size;  ///< m, outer edge of the black border
  std::array<bool, 100> cells;
};

/// Where a ray meets a surface.
struct Hit {
  double along = std::numeric_limits<double>::infinity();  ///< in lengths of the ray's direction
  int part = 0;     ///< face or colour: neighbours with another part have an edge between them
  double grey = 0;  ///< before shading
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, in the map frame, towards the viewer
};

/// Something a ray can meet, in the map frame.
class Surface {
 public:
  explicit Surface(const SceneShape& shape);
  Surface(const TagShape& tag, const Eigen::Isometry3d& map_from_tag);

  /// Puts the first meeting in front of `nearest.along` into `nearest` and returns true, or leaves it alone.
  bool meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, Hit& nearest) const;

  /// Corners of a box around all of it, in the map frame.
  Eigen::Matrix<double, 3, 8> corners() const;

 private:
  friend class SurfaceView;
  std::variant<BoxShape, CylinderShape, SphereShape, TagShape> geometry_;
  Eigen::Isometry3d map_from_surface_, surface_from_map_;
  double grey_;
  Eigen::Vector3d half_;  ///< sides of the box around it, halved, in its own frame
};

/// A surface from one place: what all rays that begin there share is computed once. It refers to the surface.
class SurfaceView {
 public:
  SurfaceView(const Surface& surface, const Eigen::Vector3d& origin);
  /// As Surface::meet, of a ray from `origin`.
  bool meet(const Eigen::Vector3d& direction, Hit& nearest) const;
  const Surface& surface() const { return *surface_; }

 private:
  const Surface* surface_;
  Eigen::Vector3d to_center_, origin_in_surface_;
  Eigen::Matrix3d surface_from_map_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero(),
                  high_ = low_;  ///< sides of a box from the origin, in its frame
  double outside_;  ///< how much farther than its reach the surface's centre is, squared: below 0 within it
};

std::vector<SurfaceView> views_from(const Eigen::Vector3d& origin, std::span<const Surface> surfaces);

/// The nearest of `surfaces` along the ray and its index, -1 for none.
struct CastResult {
  Hit hit;
  int index = -1;
};
CastResult cast_ray(std::span<const Surface* const> surfaces, const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& direction);
/// The same of surfaces that are seen from one place.
CastResult cast_ray(std::span<const SurfaceView> surfaces, const Eigen::Vector3d& direction);

}  // namespace clearway
