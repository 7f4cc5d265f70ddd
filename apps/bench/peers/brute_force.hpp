#pragma once

// The slow and obvious judge of configuration checks: every body against every blocked voxel cube near it,
// by FCL's contact test (LIBCCD: no contact missed in 360,000 measured pairs of shape and voxel).

#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "apps/bench/worlds/arm_worlds.hpp"
#include "planning/geometry/fcl_geometry.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway::bench {

/// What each voxel near an arm is, leaf by leaf into a plain array.
class VoxelGrid {
 public:
  VoxelGrid(const Snapshot& map, const Eigen::AlignedBox3d& box)
      : edge_(map.resolution()), first_(cell(box.min())), size_(cell(box.max()) - first_ + Cell::Ones()) {
    voxels_.resize(static_cast<std::size_t>(size_.prod()));
    map.visit_leaves([this](const Voxel& leaf) {
      const Eigen::Vector3d corner = leaf.center.array() - leaf.size / 2 + edge_ / 2;
      const Cell low = cell(corner);
      const Cell high = low.array() + static_cast<int>(std::lround(leaf.size / edge_));
      const Cell from = low.cwiseMax(first_), to = high.cwiseMin(first_ + size_);
      for (int z = from.z(); z < to.z(); ++z) {
        for (int y = from.y(); y < to.y(); ++y) {
          for (int x = from.x(); x < to.x(); ++x) voxels_[index({x, y, z})] = {leaf.state, leaf.volumes};
        }
      }
    });
  }

  using Cell = Eigen::Vector3i;
  double edge() const { return edge_; }
  Cell cell(const Eigen::Vector3d& point) const { return (point / edge_).array().floor().cast<int>(); }
  Eigen::Vector3d center(const Cell& at) const { return (at.cast<double>().array() + 0.5) * edge_; }
  bool is_blocked(const Cell& at, const Requirement& requirement) const {
    const Cell inside = at - first_;
    const bool known = (inside.array() >= 0).all() && (inside.array() < size_.array()).all();
    const auto [state, volumes] = known ? voxels_[index(at)] : Entry{};
    return !allows(requirement, state, volumes);
  }

 private:
  struct Entry {
    VoxelState state = VoxelState::unknown;
    std::uint16_t volumes = 0;
  };
  std::size_t index(const Cell& at) const {
    const Eigen::Matrix<std::size_t, 3, 1> inside = (at - first_).cast<std::size_t>();
    const Eigen::Matrix<std::size_t, 3, 1> size = size_.cast<std::size_t>();
    return (inside.z() * size.y() + inside.y()) * size.x() + inside.x();
  }

  double edge_;
  Cell first_, size_;
  std::vector<Entry> voxels_;
};

class BruteForce {
 public:
  /// @param requirements one for each body of the robot
  BruteForce(const Robot& robot, VoxelGrid grid, std::vector<Requirement> requirements)
      : robot_(robot),
        grid_(std::move(grid)),
        requirements_(std::move(requirements)),
        cube_(grid_.edge(), grid_.edge(), grid_.edge()) {
    for (const Body& body : robot.bodies) {
      shapes_.push_back(fcl_geometry(body.shape));
      shapes_.back()->computeLocalAABB();
    }
  }

  /// The configuration's bodies meet no blocked cube and not each other.
  bool is_free(const LinkPoses& poses) const { return !touches_map(poses) && !touches_itself(poses); }

  bool touches_map(const LinkPoses& poses) const {
    return visit_near(poses, 0.0, [&](std::size_t i, const Eigen::Isometry3d& pose, const auto& cube) {
      return collide(shapes_[i].get(), pose, &cube_, cube);
    });
  }

  /// Distance to the nearest blocked cube, or between two bodies that are not exempt, at most `cap`; 0 when
  /// touching.
  double distance(const LinkPoses& poses, double cap) const {
    double least = cap;
    visit_near(poses, cap, [&](std::size_t i, const Eigen::Isometry3d& pose, const auto& cube) {
      least = std::min(least, smaller_distance(shapes_[i].get(), pose, &cube_, cube));
      return least <= 0.0;
    });
    visit_pairs(poses, [&](const auto* a, const auto& pose_a, const auto* b, const auto& pose_b) {
      least = std::min(least, smaller_distance(a, pose_a, b, pose_b));
      return least <= 0.0;
    });
    return std::max(least, 0.0);
  }

  bool touches_itself(const LinkPoses& poses) const { return visit_pairs(poses, collide); }

  Eigen::Isometry3d place(std::size_t body, const LinkPoses& poses) const {
    return poses[static_cast<std::size_t>(robot_.bodies[body].link)] * robot_.bodies[body].link_from_shape;
  }

  static bool collide(const fcl::CollisionGeometryd* a, const Eigen::Isometry3d& pose_a,
                      const fcl::CollisionGeometryd* b, const Eigen::Isometry3d& pose_b) {
    fcl::CollisionResultd result;
    return fcl::collide(a, pose_a, b, pose_b, fcl::CollisionRequestd(), result) > 0;
  }

 private:
  bool is_moved(std::size_t body) const {
    for (int link = robot_.bodies[body].link; link >= 0;
         link = robot_.links[static_cast<std::size_t>(link)].parent) {
      if (robot_.links[static_cast<std::size_t>(link)].joint >= 0) return true;
    }
    return false;
  }

  /// The smaller of FCL's two solvers, for either alone is at times far too large.
  static double smaller_distance(const fcl::CollisionGeometryd* a, const Eigen::Isometry3d& pose_a,
                                 const fcl::CollisionGeometryd* b, const Eigen::Isometry3d& pose_b) {
    double least = 1e9;
    for (const fcl::GJKSolverType solver : {fcl::GST_LIBCCD, fcl::GST_INDEP}) {
      fcl::DistanceRequestd request;
      request.gjk_solver_type = solver;
      fcl::DistanceResultd result;
      least = std::min(least, fcl::distance(a, pose_a, b, pose_b, request, result));
    }
    return least;
  }

  /// Calls `test(a, pose of a, b, pose of b)` for the pairs of bodies that are not exempt until it is true.
  template <typename Test>
  bool visit_pairs(const LinkPoses& poses, const Test& test) const {
    for (std::size_t a = 0; a < shapes_.size(); ++a) {
      for (std::size_t b = a + 1; b < shapes_.size(); ++b) {
        const std::pair<int, int> pair(static_cast<int>(a), static_cast<int>(b));
        if (std::find(robot_.exempt.begin(), robot_.exempt.end(), pair) != robot_.exempt.end()) continue;
        if (test(shapes_[a].get(), place(a, poses), shapes_[b].get(), place(b, poses))) return true;
      }
    }
    return false;
  }

  /// Calls `test(body, pose, cube's pose)` for each blocked cube that meets the oriented box around a moved
  /// body, grown by `margin`, until it returns true.
  template <typename Test>
  bool visit_near(const LinkPoses& poses, double margin, const Test& test) const {
    for (std::size_t i = shapes_.size(); i-- > 0;) {  // the hand first: it touches most
      if (!is_moved(i)) continue;
      const Eigen::Isometry3d pose = place(i, poses);
      const fcl::AABBd& box = shapes_[i]->aabb_local;
      const Eigen::Vector3d half = (box.max_ - box.min_) / 2, middle = (box.max_ + box.min_) / 2;
      const Eigen::Vector3d center = pose * middle;  // a hull's is not at its origin
      const Eigen::Isometry3d body_from_map = pose.inverse();
      const Eigen::Vector3d reach = (pose.linear().cwiseAbs() * half).array() + (margin + 1e-6);
      const VoxelGrid::Cell low = grid_.cell(center - reach);
      const VoxelGrid::Cell high = grid_.cell(center + reach);
      const double near = std::sqrt(0.75) * grid_.edge() + margin + 1e-6;
      for (int z = low.z(); z <= high.z(); ++z) {
        for (int y = low.y(); y <= high.y(); ++y) {
          for (int x = low.x(); x <= high.x(); ++x) {
            if (!grid_.is_blocked({x, y, z}, requirements_[i])) continue;
            const Eigen::Isometry3d cube(Eigen::Translation3d(grid_.center({x, y, z})));
            const Eigen::Vector3d local = body_from_map * cube.translation() - middle;
            if ((local.cwiseAbs() - half).cwiseMax(0.0).norm() > near) continue;
            if (test(i, pose, cube)) return true;
          }
        }
      }
    }
    return false;
  }

  const Robot& robot_;
  VoxelGrid grid_;
  std::vector<Requirement> requirements_;
  fcl::Boxd cube_;
  std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes_;
};

/// A space's answers to random configurations beside brute force's.
struct Agreement {
  int checked = 0, free = 0, touching = 0;  ///< by brute force
  int wrongly_accepted = 0, wrongly_refused = 0;
  double widest = 0.0;  ///< of the wrongly refused, metres from touching

  Agreement& operator+=(const Agreement& other) {
    checked += other.checked;
    free += other.free;
    touching += other.touching;
    wrongly_accepted += other.wrongly_accepted;
    wrongly_refused += other.wrongly_refused;
    widest = std::max(widest, other.widest);
    return *this;
  }
};

inline BruteForce brute_force_of(const ConfigurationSpace& space) {
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(2.0);
  std::vector<Requirement> requirements;
  for (const Body& body : space.robot().bodies) {
    requirements.push_back(
        part_requirement(space.robot(), space.map(), body.part, space.policies().at(body.part)));
  }
  return {space.robot(), {space.map(), {-reach, reach}}, requirements};
}

/// Uniform configurations; and, `borderline` of them, halved `halvings` times between a free and a blocked
/// one towards where the arm just touches (the free and the blocked end of what is left).
inline Agreement compare(const ConfigurationSpace& space, const BruteForce& truth, Dice& dice, int uniform,
                         int borderline, int halvings) {
  Agreement sum;
  const auto judge = [&](const Configuration& q) {
    const LinkPoses poses = forward_kinematics(space.robot(), q);
    const bool expected = truth.is_free(poses), answer = space.is_free(q);
    ++sum.checked;
    (expected ? sum.free : sum.touching)++;
    if (answer && !expected) ++sum.wrongly_accepted;
    if (!answer && expected) {
      ++sum.wrongly_refused;
      sum.widest = std::max(sum.widest, truth.distance(poses, 0.1));
    }
    return expected;
  };
  for (int i = 0; i < uniform; ++i) judge(dice.configuration(space.robot()));
  const auto is_free = [&](const Configuration& q) {
    return truth.is_free(forward_kinematics(space.robot(), q));
  };
  for (int i = 0; i < borderline;) {
    Configuration free = dice.configuration(space.robot()), blocked = dice.configuration(space.robot());
    if (!is_free(free) || is_free(blocked)) continue;
    for (int k = 0; k < halvings; ++k) {
      const Configuration middle = (free + blocked) / 2;
      (is_free(middle) ? free : blocked) = middle;
    }
    judge(free);
    judge(blocked);
    i += 2;
  }
  return sum;
}

}  // namespace clearway::bench
