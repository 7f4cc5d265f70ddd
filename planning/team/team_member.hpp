#pragma once

// Private to the sources of run_team.

#include <memory>
#include <string>
#include <vector>

#include "planning/boundary/boundary_controller.hpp"
#include "planning/team/team.hpp"

namespace clearway {

/// Most that one weighted unit of any joint moves a point of the robot, m.
double weighted_reach(const ConfigurationSpace& space, double prismatic_scale);

/// The longest step of one period that keeps every joint's velocity limit and sqrt(a `braking`), weighted
/// units; `braking`: way within which the robot must be able to stop, weighted units.
double longest_step(const ConfigurationSpace& space, double prismatic_scale, const TeamOptions& options,
                    double braking);

/// The longest first step after which steps that shrink by `change` each stop within `room`.
double braking_step(double room, double change);

/// What demanded a separation that a robot could not keep.
struct OutrunBy {
  /// map: the map that it began with, or the robot itself; sensed: what only a newer map has; fixed: an
  /// obstacle, of what no joint moves away; overlap: a newer map says that something is where it stands. Of
  /// equals the later counts.
  enum Kind { nothing, map, robot, sensed, obstacle, fixed, overlap } kind = nothing;
  int index = -1;  ///< of the obstacle
};

/// One robot of a run.
class TeamMember {
 public:
  TeamMember(const TeamRobot& robot, const TeamOptions& options, const TeamFigures& figures,
             std::size_t index);

  void see(std::shared_ptr<const ConfigurationSpace> space);
  /// Its bodies where they are now.
  std::vector<PlacedShape> bodies() const;
  /// Notes what limits it here, given bodies of other robots and obstacles.
  void look(const std::vector<PlacedShape>& robots, const std::vector<PlacedShape>& obstacles);
  /// Decides the next step by it.
  OutrunBy choose();
  /// Takes it, as far as the map's certificate goes. Returns what share of the longest step it was.
  double move();

  /// How far it is from where it was so many steps ago, as a share of what it could have gone.
  double share_gone(std::size_t steps) const;

  bool is_at_goal() const { return position() == robot_.goal; }
  const TeamTrace& trace() const { return trace_; }
  /// "'left' is 0.3 from its goal in joint space: its load is 21 mm from ..."
  std::string where() const;

 private:
  const Configuration& position() const { return trace_.positions.back(); }
  Eigen::VectorXd wanted_step() const;
  void append_constraints(const std::vector<PlacedShape>& robots, const std::vector<PlacedShape>& obstacles);
  void limit_change(const Eigen::VectorXd& wanted);
  OutrunBy who_gave_way() const;
  bool is_overlapped_anew() const;
  std::vector<bool> known_constraints() const;
  Configuration moved(const Eigen::VectorXd& step) const;

  const TeamRobot& robot_;
  const TeamOptions& options_;
  std::shared_ptr<const ConfigurationSpace> space_;
  ObstacleConstraints obstacle_constraints_;
  DamperOptions damper_;
  DamperOptions own_;  ///< the same with the security distance from the map and itself
  BoundaryController controller_;
  StepConstraints constraints_;
  std::vector<OutrunBy> sources_;  ///< of each constraint
  LocalStep local_;
  double unavoidable_ = 0.0;  ///< m from an obstacle to where no joint can move the robot away
  Eigen::VectorXd change_;    ///< a T^2 of each joint, weighted units
  Eigen::VectorXd previous_;  ///< the step before, weighted units
  Eigen::VectorXd step_;
  bool along_boundary_ = false;
  bool is_overlapped_ = false;  ///< the map says that something is where the robot stands
  TeamTrace trace_;
};

}  // namespace clearway
