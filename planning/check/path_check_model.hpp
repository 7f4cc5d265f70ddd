#pragma once

// Private to path_check: the robot and the map in FCL's and KDL's own terms. Nothing here calls the
// kinematics, distances or fields that the planners use.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/robot/robot.hpp"

namespace clearway::check {

class FclBodies;
struct KdlLink;

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
  /// Places one body.
  Eigen::Isometry3d place(const Eigen::VectorXd& q, std::size_t body) const;

  /// Places all links and bodies in the frame of the robot's base, wherever that stands.
  void place_on_base(const Eigen::VectorXd& q, std::vector<Eigen::Isometry3d>& links,
                     BodyPoses& bodies) const;

  /// Bound on the path length of any point of the body when each joint j turns or slides by abs_dq[j] in all.
  double motion(std::size_t body, const Eigen::VectorXd& abs_dq) const;
  /// The same for the approach of two bodies to each other.
  double approach(std::size_t a, std::size_t b, const Eigen::VectorXd& abs_dq) const;
  /// A joint moves them against each other, or one that is held could.
  bool may_touch(std::size_t a, std::size_t b) const;
  /// One joint lies between them, held ones count, and no other body hangs on the links between.
  bool are_neighbours(std::size_t a, std::size_t b) const;
  /// The link that the only joint between two bodies moves; null: there is none, or more than one.
  const KdlLink* only_joint_between(std::size_t a, std::size_t b) const;
  /// The joints of the configuration that hold the load, as grip_joints (planning/robot/load.hpp) says. Found
  /// by walking KDL's links. @param robot with the load
  std::vector<int> joints_that_hold(const Robot& robot, const Load& load) const;
  /// The first joint that moves two links against each other, as KDL has it, held ones aside; empty: none.
  std::string joint_between_links(std::size_t a, std::size_t b) const;
  /// A joint's limits; of one that turns without end half a turn to either side of the slowest link that it
  /// moves. `number`: its index.
  std::pair<double, double> range(const Joint& joint, std::size_t number) const;
  /// A joint moves it, or one that is held could: its place in the map counts.
  bool is_policed(std::size_t body) const;

 private:
  struct Chains;
  std::unique_ptr<Chains> chains_;
};

/// Of the robot's exempt pairs those for which this floor finds a reason of its own: the bodies are
/// neighbours; SRDF or settings name the pair, read again; they stay apart wherever the one joint between
/// them stands, proved; or they touch in nearly all of 200 configurations. The others are tested like all
/// pairs. Of a robot without a file all.
std::set<std::pair<std::size_t, std::size_t>> justified_exemptions(const Robot& robot, const KdlArm& arm,
                                                                   const FclBodies& bodies);

/// Compares the poses of all links and bodies with those of the planners' kinematics, at the limits and over
/// random configurations from a fixed seed. This alone calls what planners use.
/// @throws FileDisagrees naming the first link or body that is more than 1e-9 m or rad elsewhere.
void require_same_poses(const Robot& robot, const KdlArm& arm);

/// From a point in a body's own frame to the body; of a hull to the box that holds it. 0 inside.
struct PointDistance {
  bool is_round = false;                              ///< about z
  double round = 0.0, disc = 0.0, half_length = 0.0;  ///< of a round one, as in ShapeReading
  Eigen::Vector3d box_half = Eigen::Vector3d::Zero(), box_center = Eigen::Vector3d::Zero();

  double operator()(const Eigen::Vector3d& point) const {
    if (!is_round) return ((point - box_center).cwiseAbs() - box_half).cwiseMax(0.0).norm();
    const double across = point.x() * point.x() + point.y() * point.y();
    const double beyond = std::max(std::abs(point.z()) - half_length, 0.0);
    if (round > 0.0) return std::max(std::sqrt(across + beyond * beyond) - round, 0.0);
    const double aside = std::max(std::sqrt(across) - disc, 0.0);
    return std::sqrt(aside * aside + beyond * beyond);
  }
};

/// Certified distances: of a separating plane. Projections to and fro propose planes first
/// (path_check_planes.hpp); where they do not close, FCL decides: LIBCCD `collide`, then unsigned `distance`
/// for a direction and a plane along it. A wrong distance from FCL can only make the proof weaker. 0 when
/// they touch or nothing is proved; more than `enough` may be less than the distance.
class FclBodies {
 public:
  explicit FclBodies(const Robot& robot);
  ~FclBodies();
  FclBodies(const FclBodies&) = delete;
  FclBodies& operator=(const FclBodies&) = delete;

  bool touches_cube(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                    double edge) const;
  double cube_distance(std::size_t body, const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube,
                       double edge, double enough = HUGE_VAL) const;
  bool touch(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
             const Eigen::Isometry3d& pose_b) const;
  double distance(std::size_t a, const Eigen::Isometry3d& pose_a, std::size_t b,
                  const Eigen::Isometry3d& pose_b, double enough = HUGE_VAL) const;

  /// With a box in the body's own frame that holds the body.
  const PointDistance& point_distance(std::size_t body) const;

 private:
  struct Geometries;
  std::unique_ptr<Geometries> geometries_;
};

/// The voxels that one part may not touch, read from the tree's leaves one by one inside `box`; everything
/// outside the stored leaves is unknown. Kept as one bit per voxel.
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
  Eigen::Vector3i cell(const Eigen::Vector3d& point) const;

  /// Visits the blocks of cells that touch the box and hold blocked cells which are not wholly surrounded by
  /// blocked ones: a connected body with one point in a free cell cannot reach those without touching others.
  /// @param visit called with the block's centre, its half diagonal and its place, for visit_shell()
  template <class Visit>
  void visit_blocks(const Eigen::AlignedBox3d& box, const Visit& visit) const {
    Eigen::Vector3i low, high;
    if (!blocks_touching(box, low, high)) return;
    const double half_diagonal = 0.5 * std::sqrt(3.0) * block_edge * edge_ * (1.0 + 1e-9);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        std::size_t i = block_index({low.x(), y, z});
        for (int x = low.x(); x <= high.x(); ++x, ++i) {
          if (!holds_shell_[i]) continue;
          const Eigen::Vector3d middle =
              (first_.cast<double>().array() + block_edge * (Eigen::Array3d(x, y, z) + 0.5)) * edge_;
          visit(middle, half_diagonal, Eigen::Vector3i(x, y, z));
        }
      }
    }
  }

  /// Visits the centres of these cells of a block, from low z, y and x on.
  template <class Visit>
  void visit_shell(const Eigen::Vector3i& block, const Visit& visit) const {
    const Eigen::Vector3i corner = block_edge * block;
    for (int z = corner.z(); z < std::min(corner.z() + block_edge, size_.z()); ++z) {
      for (int y = corner.y(); y < std::min(corner.y() + block_edge, size_.y()); ++y) {
        const std::uint64_t word = shell_[row(y, z) + static_cast<std::size_t>(corner.x() / 64)];
        for (std::uint64_t bits = word >> static_cast<unsigned>(corner.x() % 64) & block_bits; bits != 0;
             bits &= bits - 1)
          visit(center(first_ + Eigen::Vector3i(corner.x() + std::countr_zero(bits), y, z)));
      }
    }
  }

 private:
  static constexpr int block_edge = 4;  ///< cells
  static constexpr std::uint64_t block_bits = (std::uint64_t{1} << block_edge) - 1;
  using Bits = std::vector<std::uint64_t>;

  void read(const Snapshot& map, Policy policy, std::uint16_t volumes, double seen_within);
  void set(const Eigen::Vector3i& begin, const Eigen::Vector3i& end, bool is_blocked);
  Bits surrounded() const;
  void find_shell();
  std::uint64_t rows_together(const Bits& bits, int word, int y, int z) const;
  bool blocks_touching(const Eigen::AlignedBox3d& box, Eigen::Vector3i& low, Eigen::Vector3i& high) const;
  std::size_t block_index(const Eigen::Vector3i& block) const;
  std::size_t row(int y, int z) const;  ///< first word of a row along x, from the block's corner
  bool is_inside(const Eigen::Vector3i& cell) const;

  double edge_ = 0.0;
  bool outside_blocked_ = false;
  Eigen::Vector3i first_ = Eigen::Vector3i::Zero(), size_ = Eigen::Vector3i::Zero();
  std::size_t words_ = 0;  ///< of a row
  Bits blocked_, shell_;
  Eigen::Vector3i blocks_ = Eigen::Vector3i::Zero();  ///< along each axis
  std::vector<bool> holds_shell_;                     ///< of each block
};

/// How near a body or pair is to what it must not touch, certified.
struct Nearest {
  double distance = 0.0;
  std::optional<Eigen::Vector3d> cube;  ///< centre of the nearest blocked voxel
};

/// Map-frame box around a placed body, grown by `margin`.
Eigen::AlignedBox3d bounds(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                           double margin);

/// The nearest blocked voxel that is nearer than `limit` to the body; `distance` is `limit` when there is
/// none. `inside`: a point inside the body, map frame. `hint`: the centre of a blocked voxel that is near, if
/// one is known.
Nearest nearest_voxel(const FclBodies& bodies, std::size_t body, const Eigen::Isometry3d& pose,
                      const Eigen::Vector3d& inside, const BlockedCells& cells, double limit,
                      const std::optional<Eigen::Vector3d>& hint = std::nullopt);

/// Empty, or why these waypoints are no path of this robot. @param edge becomes the waypoint's index
std::string malformed(const Robot& robot, const std::vector<Eigen::VectorXd>& path, int& edge);

/// Empty, or the sentence that a joint which holds a load moves on the way.
std::string let_go(const Robot& robot, const KdlArm& arm, const std::vector<Eigen::VectorXd>& path,
                   const std::vector<Eigen::VectorXd>& deviations);

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
                 const KdlArm& arm, const FclBodies& bodies);

/// A box that holds what the bodies of a group sweep on one edge, looked at every `spacing` of motion.
Eigen::AlignedBox3d swept_box(const KdlArm& arm, const FclBodies& bodies, const Tasks& tasks,
                              std::size_t group, const Eigen::VectorXd& start, const Eigen::VectorXd& step,
                              double spacing);

}  // namespace clearway::check
