#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"
#include "planning/space/work_meter.hpp"

namespace clearway {

/// The policy of each robot part. Unlisted critical parts (those of the robot and those that a painted volume
/// names) are `painted` (inside the volumes that name the part, or inside any volume when none does), or
/// `known_free` in a map that holds no paint at all. All other parts have `other`; where it is left out,
/// `not_occupied`, but for a robot that names no critical part, of which nobody has said what may go into the
/// unknown: all of it is `known_free` wherever the map holds free voxels, painted or seen.
/// ConfigurationSpace::policies() says what was chosen.
struct Policies {
  std::map<std::string, Policy> parts = {};
  std::optional<Policy> other = std::nullopt;
  bool critical_by_default = true;  ///< what is left out is chosen as above; else it is `not_occupied`
};

/// Padding, resolutions and age limit of a ConfigurationSpace.
struct SpaceOptions {
  double padding = 0.0;           ///< every body keeps this distance from blocked voxels, metres, >= 0
  double max_distance = 0.0;      ///< truncation of the distance fields; 0 = chosen from the robot's size
  double edge_resolution = 1e-4;  ///< an edge undecided at this joint-space length (rad, m) counts as blocked
  double seen_within = 0.0;  ///< of parts under `known_free` (Requirement::seen_within), seconds; 0: ever
};

/// Why a configuration is not free.
enum class Obstruction {
  none,
  not_finite,
  joint_limit,
  self_collision,
  occupied,
  conflict,
  unknown,
  stale,  ///< seen free, but not lately enough
  outside_painted
};

/// The enumerator as a word: "joint_limit".
std::string_view to_string(Obstruction obstruction);

/// Whether a configuration is free; else one reason why not.
struct Verdict {
  Obstruction obstruction = Obstruction::none;      ///< none: it is free
  std::string part;                                 ///< body that is blocked
  std::string other;                                ///< the second body, or the joint
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< map frame: centre of the blocking voxel
  double depth = 0.0;  ///< metres the body, with its padding, reaches in (estimate), or past the limit
  double gap = 0.0;    ///< metres at least from the body to the voxel, where its padding alone reaches in
  bool is_free() const { return obstruction == Obstruction::none; }
  std::string sentence() const;  ///< "tool touches an occupied voxel at (x, y, z), 3 mm deep"; or
                                 ///< "…, with its padding alone: it is 0.6 mm away"
};

/// One nearby pair (robot point, blocked voxel or other body): a linear damper constraint of Lahouar et al.
/// 2006, eq. 6: n^T J dq <= bound(d).
struct ProximityConstraint {
  Eigen::VectorXd gradient;  ///< a = n^T J_x1(q): rate of approach per unit joint rate
  double distance = 0.0;     ///< conservative (<= true) distance d, metres, padding already subtracted
  int body = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< x1, on the robot, map frame
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< n, from the robot to the obstacle
};

/// A straight way in joint space.
struct Edge {
  Configuration from, to;
};

struct CollisionModel;

/// A robot in a map under a policy: the one place that says which configurations and edges are free.
/// Bodies that no joint moves are part of the scene: tested against other bodies, not against the map.
/// Immutable, safe from many threads; counts nothing but in a meter that it is given, prints nothing. Copies
/// share what they are made of and cost nothing; moving copies, too.
class ConfigurationSpace {
 public:
  /// @throws std::invalid_argument: unknown part in the policies, negative padding, region too large, a
  /// seen_within that the map cannot answer or that no part is asked, ...
  ConfigurationSpace(Robot robot, Snapshot map, const Policies& policies = {},
                     const SpaceOptions& options = {});
  ConfigurationSpace(const ConfigurationSpace&) = default;
  ConfigurationSpace& operator=(const ConfigurationSpace&) = default;
  ~ConfigurationSpace() = default;

  const Robot& robot() const;
  const Snapshot& map() const;
  const SpaceOptions& options() const;
  /// Policy of each body's part, as used.
  const std::map<std::string, Policy>& policies() const;

  /// Exact decision: limits, self-collision, every body against every blocked voxel cube of its requirement.
  bool is_free(const Configuration& q) const;
  /// The same of many, several times as fast: by spheres for sixteen at a time, by exact shapes where these
  /// cannot decide. The same answers, whatever the machine and however they are put together.
  std::vector<bool> is_free(std::span<const Configuration> qs) const;
  /// The same with the reason.
  Verdict check(const Configuration& q) const;

  /// Certified for every configuration on the straight edge: adaptive bisection, each piece proved by
  /// clearance over the bodies' reach bounds. False when blocked or undecided at options().edge_resolution.
  bool is_edge_free(const Configuration& from, const Configuration& to) const;

  /// Certified for every configuration of which no joint is farther than `deviation` (rad, m; one value for
  /// each joint) from where it is at one place of the straight edge: a tube about the edge. Of joint limits
  /// only the edge's own are asked. False for a deviation of a wrong size, negative or not finite.
  bool is_edge_free(const Configuration& from, const Configuration& to,
                    const Eigen::VectorXd& deviation) const;

  /// The same of many edges.
  std::vector<bool> is_edge_free(std::span<const Edge> edges) const;

  /// The same by spheres alone, where they decide: never true where is_edge_free() is not, but false on some
  /// of its edges that pass close by. For those who would rather ask elsewhere than wait.
  bool is_edge_quickly_free(const Configuration& from, const Configuration& to) const;

  /// How much of the straight edge is certified free from its start on, 0..1: 1 where is_edge_free() holds,
  /// else a part that costs nothing more to know, often 0 (a part below a quarter may always be). For
  /// searches that go as far as they can.
  double free_share(const Configuration& from, const Configuration& to) const;

  /// Conservative (<= true) smallest distance of any body to what blocks it, or to another body; padding
  /// subtracted, at most the fields' max_distance; <= 0 when not free.
  /// @param at_most metres; larger ones are reported as this, and take less time.
  /// @throws std::invalid_argument when it is NaN
  double clearance(const Configuration& q, double at_most = std::numeric_limits<double>::infinity()) const;

  /// Pairs nearer than `influence_distance`, in a fixed order: for each body (in up to four pieces along its
  /// longest axis) and each of the six map directions the nearest blocked voxel that lies that way, by the
  /// exact shapes; then each pair of bodies that is not exempt. A pair whose distance no joint can change (a
  /// floor under a sliding disc) has no constraint. Penetrating pairs have distance <= 0.
  /// @throws std::invalid_argument when q is not of the robot's joints, finite
  std::vector<ProximityConstraint> proximity_constraints(const Configuration& q,
                                                         double influence_distance) const;

  /// What blocks body `body` (index in robot().bodies), in all the space that it reaches; null for a body
  /// that no joint moves. Valid as long as this object or a copy.
  const BlockedSpace* blocked_space(int body) const;

  /// BlockedSpace::renew() of all bodies' spaces: before a control loop takes over a new map.
  void renew() const;

  /// What the answers are made of, for searches of this floor that remember some of them (LatticeChecks); its
  /// header is not installed.
  const CollisionModel& collision_model() const { return *model_; }

  /// The same space, whose proofs of edges count in `meter`, as does what shortens paths in it. It answers
  /// the same. The meter outlives it.
  ConfigurationSpace metered(WorkMeter& meter) const {
    ConfigurationSpace copy = *this;
    copy.meter_ = &meter;
    return copy;
  }
  /// The meter that it was given; null: none.
  WorkMeter* meter() const { return meter_; }

  /// Bound on how far any point of any body moves when the joints move by |dq|, metres.
  /// @throws std::invalid_argument unless there is one finite value, not below 0, for each joint
  double motion_bound(const Eigen::VectorXd& abs_dq) const;

 private:
  std::shared_ptr<CollisionModel> model_;
  WorkMeter* meter_ = nullptr;
};

}  // namespace clearway
