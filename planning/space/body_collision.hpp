#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {

/// Centres of blocked voxel cubes that a body met lately, the latest first: whoever asks again close by is
/// refused by one of them. Holds for one BodyCollision; it changes how long an answer takes, never the
/// answer.
class RecentCubes {
 public:
  static constexpr std::size_t most = 8;
  std::size_t size() const { return size_; }
  void clear() { size_ = 0; }
  const Eigen::Vector3d& operator[](std::size_t i) const { return cubes_[i]; }
  /// Puts the cube first; a new one takes the place of the oldest.
  void remember(const Eigen::Vector3d& cube);

 private:
  std::array<Eigen::Vector3d, most> cubes_;
  std::size_t size_ = 0;
};

/// What BodyCollision knows of a body alone.
struct BodyGeometry {
  explicit BodyGeometry(const Body& body);

  Body body;
  Sphere bound;            ///< link frame; holds the body
  std::vector<bool> core;  ///< whether a cover sphere's centre lies inside the body
  std::vector<Eigen::Vector3d>
      witnesses;        ///< points inside the body, link frame: its middle, then near its skin
  double excess = 0.0;  ///< how much the cover stands out of the body, metres
  double spread = 0.0;  ///< of the cover's centres about that of `bound`, metres
};

/// A body and the voxels that its part's requirement forbids, ready for many queries. Spheres against the
/// distance field decide the clear cases, the exact shape against voxel cubes the rest. Voxels outside
/// `reach`, which the body cannot get to in any configuration, do not count: the unknown space above and
/// below a disc that slides in one layer of known voxels is no obstacle.
class BodyCollision {
 public:
  /// `reach`: map frame; holds the body, and what it must stay away from, in every configuration.
  BodyCollision(const Body& body, std::shared_ptr<const BlockedSpace> space, const Eigen::AlignedBox3d& reach)
      : BodyCollision(std::make_shared<const BodyGeometry>(body), std::move(space), reach) {}
  BodyCollision(std::shared_ptr<const BodyGeometry> geometry, std::shared_ptr<const BlockedSpace> space,
                const Eigen::AlignedBox3d& reach);

  const Body& body() const { return geometry_->body; }
  const BlockedSpace& space() const { return *space_; }

  /// True when every blocked cube is proved to be farther than `margin` from the body. Exact but for
  /// rounding: what cannot be proved counts as blocked.
  /// @param recent what was met lately is looked at first, and what is met is remembered.
  bool is_clear(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes* recent = nullptr) const;

  /// True when the body, grown by the margin, is known to touch one of the cubes, which this body met before.
  bool is_met(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes& recent) const;

  /// A cube that keeps the body, grown by the margin, from being clear; none when it is clear. Costs as much
  /// as is_clear, however large the body.
  std::optional<Eigen::Vector3d> met_cube(const Eigen::Isometry3d& map_from_link, double margin) const;

  /// True when that cube is proved to be farther than `margin`.
  bool is_clear_of(const Eigen::Isometry3d& map_from_link, const Eigen::Vector3d& cube, double margin) const;

  /// The same as is_clear by spheres and field alone: quick, and false wherever these cannot decide.
  bool is_quickly_clear(const Eigen::Isometry3d& map_from_link, double margin) const;

  /// The same as is_clear of the convex hull of the body at two poses; `middle` is some pose between them,
  /// the nearer to both the quicker. False when that hull cannot be proved clear; the cube for which it
  /// cannot is then remembered.
  bool is_sweep_clear(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& middle,
                      const Eigen::Isometry3d& end, double margin, RecentCubes& in_the_way) const;

  /// Lower bound of the distance to the nearest blocked cube from spheres and field alone; quick, at most the
  /// field's max_distance, below zero when it says nothing.
  double quick_clearance(const Eigen::Isometry3d& map_from_link) const;

  /// The same a little lower (by up to 1.74 voxels) and quicker.
  double coarse_clearance(const Eigen::Isometry3d& map_from_link) const;

  /// is_clear by `padding` in one go with what a search wants to know next: a lower bound of the distance,
  /// proved to be `margin` where it is, else `padding`; negative when the body is not clear by `padding`.
  /// @param margin >= padding
  double clearance_beyond(const Eigen::Isometry3d& map_from_link, double padding, double margin,
                          RecentCubes& recent) const;

  /// Lower bound of that distance from exact shapes, at most `limit` (small: cubes are visited one by one).
  double exact_clearance(const Eigen::Isometry3d& map_from_link, double limit) const;

  /// How much the spheres may stand out of the body, metres: quick_clearance is short by about that.
  double cover_excess() const { return geometry_->excess; }

  /// Calls `visit(cube centre, lower bound of its distance)` for each blocked cube that may lie within
  /// `margin` of the body until it returns false; a cube may come twice. False when it was stopped.
  /// @param only_in_reach leaves out cubes that the body meets in no configuration
  bool visit_near(const Eigen::Isometry3d& map_from_link, double margin,
                  const std::function<bool(const Eigen::Vector3d&, double)>& visit,
                  bool only_in_reach = true) const;

 private:
  static constexpr double half_diagonal = 0.8660254037844387;  ///< of a cube of edge 1, rounded up
  static constexpr int projections = 12;  ///< to and fro before GJK, which costs some forty of them

  /// True when every blocked cube is proved farther from the point than that; a quick look, then a close one.
  bool is_far(const Eigen::Vector3d& point, double distance) const;
  /// True when a point of the body is known to lie in a blocked voxel.
  bool is_pierced(const Eigen::Isometry3d& map_from_link) const;
  enum class Sight { clear, met, unsure };
  double cover_clearance(const Eigen::Isometry3d& map_from_link) const;
  bool is_proved_clear(const Eigen::Isometry3d& map_from_link, double margin, RecentCubes* recent) const;
  void look_up_spheres(const Eigen::Isometry3d& map_from_link) const;
  double close_clearance(std::size_t sphere) const;
  bool is_sphere_far(std::size_t sphere, double distance) const;
  void find_near_spheres(double margin) const;
  void find_near_spheres(const Eigen::Isometry3d& begin, const Eigen::Isometry3d& middle,
                         const Eigen::Isometry3d& end, double margin) const;
  struct Sweep;
  bool is_sweep_past(const Sweep& sweep, const Eigen::Vector3d& cube) const;
  Sight look_at(const Eigen::Isometry3d& map_from_shape, const Eigen::Vector3d& cube, double margin,
                int looks) const;

  std::uint64_t id_;  ///< no other body's, but of copies
  std::shared_ptr<const BodyGeometry> geometry_;
  std::shared_ptr<const BlockedSpace> space_;
  Eigen::AlignedBox3d reach_;
};

}  // namespace clearway
