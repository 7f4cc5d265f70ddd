#pragma once

// Private to path_check: the robot and the map in FCL's and KDL's own terms. Nothing here calls the
// kinematics, distances or fields that the planners use.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/robot/robot.hpp"

namespace clearway::check {

/// What a body is placed at: pose of every body in the map frame.
using BodyPoses = std::vector<Eigen::Isometry3d>;

/// Kinematics by KDL: one chain from the root to the link of each body. Of a robot with a URDF, KDL's tree is
/// kdl_parser's reading of that file; of a robot that was made in memory, it is built from the robot.
class KdlArm {
 public:
  /// @throws FileDisagrees (path_check_links.hpp) for a robot whose file has other links, joints or bodies.
  explicit KdlArm(const Robot& robot);
  ~KdlArm();
  KdlArm(const KdlArm&) = delete;
  KdlArm& operator=(const KdlArm&) = delete;

  /// Places all bodies.
  void place(const Eigen::VectorXd& q, BodyPoses& poses) const;

  /// Places all links and bodies in the frame of the robot's base, wherever that stands. A turned link's
  /// frame is the file's; the robot's has another orientation.
  void place_on_base(const Eigen::VectorXd& q, std::vector<Eigen::Isometry3d>& links,
                     BodyPoses& bodies) const;
  bool is_turned(std::size_t link) const;

  /// Bound on the path length of any point of the body when each joint j turns or slides by abs_dq[j] in all.
  double motion(std::size_t body, const Eigen::VectorXd& abs_dq) const;
  /// The same for the approach of two bodies to each other.
  double approach(std::size_t a, std::size_t b, const Eigen::VectorXd& abs_dq) const;
  bool is_moved(std::size_t body) const;

 private:
  struct Chains;
  std::unique_ptr<Chains> chains_;
};

/// Compares the poses of all links and bodies with those of the planners' kinematics, at the limits and over
/// random configurations from a fixed seed. This alone calls what planners use.
/// @throws FileDisagrees naming the first link or body that is more than 1e-9 m or rad elsewhere.
void require_same_poses(const Robot& robot, const KdlArm& arm);

/// Certified distances by FCL: LIBCCD `collide` first, then unsigned `distance` for a direction, and a
/// separating plane along that direction for the proof. A wrong distance from FCL can only make the proof
/// weaker. 0 when they touch or nothing is proved.
class FclBodies {
 public:
  explicit FclBodies(const Robot& robot);
  ~FclBodies();
  FclBodies(const FclBodies&) = delete;
  FclBodies& operator=(const FclBodies&) = delete;

  bool touches_cube(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                    double edge) const;
  double cube_distance(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                       double edge) const;
  bool touch(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
             const Eigen::Isometry3d& pose_b) const;
  double distance(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                  const Eigen::Isometry3d& pose_b) const;

  /// Half edges of a box in the body's own frame that holds the body, about `box_center`.
  const Eigen::Vector3d& box_half(std::size_t body) const;
  const Eigen::Vector3d& box_center(std::size_t body) const;

 private:
  struct Geometries;
  std::unique_ptr<Geometries> geometries_;
};

/// The voxels that one part may not touch, read from the tree's leaves one by one inside `box`; everything
/// outside the stored leaves is unknown. Kept as one byte per voxel.
class BlockedCells {
 public:
  /// @param seen_within under `known_free` voxels seen free longer than so many seconds before the map's
  ///        newest look are unknown; 0: never
  BlockedCells(const Snapshot& map, Policy policy, std::uint16_t volumes, const Eigen::AlignedBox3d& box,
               double seen_within);

  double edge() const { return edge_; }
  bool is_blocked(const Eigen::Vector3i& cell) const;
  Eigen::Vector3d center(const Eigen::Vector3i& cell) const {
    return (cell.cast<double>().array() + 0.5) * edge_;
  }
  /// The blocked cells that touch the box and are not wholly surrounded by blocked cells: a connected body
  /// with one point in a free cell cannot reach the others without touching one of these.
  std::vector<Eigen::Vector3i> shell(const Eigen::AlignedBox3d& box) const;
  Eigen::Vector3i cell(const Eigen::Vector3d& point) const;

 private:
  enum : std::uint8_t { free_cell = 0, blocked_cell = 1, surrounded_cell = 2 };
  void mark_surrounded();
  void mark_blocks();
  std::size_t block_index(const Eigen::Vector3i& block) const;
  void append_shell(const Eigen::Vector3i& begin, const Eigen::Vector3i& end,
                    std::vector<Eigen::Vector3i>& found) const;
  std::size_t index(const Eigen::Vector3i& cell) const;
  bool is_inside(const Eigen::Vector3i& cell) const;
  double edge_ = 0.0;
  bool outside_blocked_ = false;
  Eigen::Vector3i first_ = Eigen::Vector3i::Zero(), size_ = Eigen::Vector3i::Zero();
  std::vector<std::uint8_t> cells_;
  Eigen::Vector3i blocks_ = Eigen::Vector3i::Zero();  ///< of 8 x 8 x 8 cells, along each axis
  std::vector<bool> block_has_shell_;
};

/// How near a body or pair is to what it must not touch, certified.
struct Nearest {
  double distance = 0.0;
  std::optional<Eigen::Vector3d> cube;  ///< centre of the nearest blocked voxel
};

/// Map-frame box around a placed body, grown by `margin`.
Eigen::AlignedBox3d bounds(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                           double margin);

/// The nearest blocked voxel no farther than `limit` from the body; `distance` is `limit` when there is none.
/// `inside`: a point inside the body, map frame.
Nearest nearest_voxel(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                      const Eigen::Vector3d& inside, const BlockedCells& cells, double limit);

/// What must be proved along every edge: a body against its voxels, or two bodies against each other.
struct Item {
  std::size_t body = 0;
  std::optional<std::size_t> other;
  std::size_t group = 0;  ///< which block of voxels
};

/// Bodies whose parts share a policy and painted volumes share their blocked voxels.
struct Group {
  Policy policy = Policy::not_occupied;
  std::uint16_t volumes = 0xffff;
  bool operator==(const Group&) const = default;
};

/// All that must be proved for a robot in a map.
struct Tasks {
  std::vector<Group> groups;
  std::vector<Item> items;  ///< moved bodies in order, then pairs that are not exempt
};
Tasks list_tasks(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 const KdlArm& arm);

/// A box that holds what the bodies of a group sweep on one edge, looked at every `spacing` of motion.
Eigen::AlignedBox3d swept_box(const KdlArm& arm, const FclBodies& bodies, const Tasks& tasks,
                              std::size_t group, const Eigen::VectorXd& start, const Eigen::VectorXd& step,
                              double spacing);

}  // namespace clearway::check
