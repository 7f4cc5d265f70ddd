#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "planning/boundary/boundary.hpp"
#include "planning/problem/planner.hpp"
#include "planning/space/configuration_space.hpp"
#include "planning/team/rigid_motion.hpp"

namespace clearway {

/// A robot of a team: where it stands is part of its robot (map_from_base).
struct TeamRobot {
  std::string name;
  std::shared_ptr<const ConfigurationSpace> space;
  Configuration start, goal;
};

/// What a robot sees of the map at some time; null: as before. Called once for each robot and period, in
/// order.
using SensedSpace = std::function<std::shared_ptr<const ConfigurationSpace>(std::size_t robot, double time)>;

/// Robots that share a place with each other and with things that move.
struct Team {
  std::vector<TeamRobot> robots;
  std::vector<MovingObstacle> obstacles;
  SensedSpace sensed = nullptr;  ///< the map as it is sensed anew
};

/// Options of a team: local method, period, limits.
struct TeamOptions {
  BoundaryOptions boundary;        ///< 0 = auto for d_i, d_s, xi and max_step; see TeamFigures
  bool follows_boundaries = true;  ///< false: the local method alone (Lahouar 2006, eq. 1-9)
  double period = 0.02;            ///< T, seconds between two steps
  double duration = 60.0;          ///< seconds after which the run ends
  double max_acceleration = 5.0;   ///< a, of every joint, rad/s^2 or m/s^2
};

/// Options of the planners that can lead a team, `constraint` and `boundary`, as they are given to
/// make_planner.
/// @throws std::invalid_argument for another planner, naming these two, and as make_planner; for `max_steps`,
///         in whose place a team has its duration
TeamOptions team_options(const std::string& planner, const PlannerOptions& options);

/// Whatever run_team would throw is thrown, without a run.
void check_team_inputs(const Team& team, const TeamOptions& options);

/// The values in force, common to the team. Chosen so that braking before an obstacle needs no more than the
/// acceleration `a`: speeds fall in proportion to the distance left, the faster the smaller d_i.
struct TeamFigures {
  double influence_distance = 0.0;  ///< d_i, m; auto: a fifth of the longest reach
  double security_distance = 0.0;   ///< d_s, m, from other robots and obstacles; auto: d_i / 8, at most half
                                    ///< of the least such separation at start or goal
  double own_security_distance = 0.0;  ///< m, the same from the map and from itself; auto: d_s, at most half
                                       ///< of the least such separation at start or goal
  double xi = 0.0;                     ///< m per period; auto: twice what a robot can move a point in one
  std::vector<double> max_step;  ///< of each robot, weighted units per period: no joint over its velocity
                                 ///< limit, and sqrt(a (d_i - d_s) / (2 reach))
  double greatest_obstacle_speed = 0.0;  ///< v_obs, m/s
};

/// What one robot did. Entry k is at time k T.
struct TeamTrace {
  std::vector<Configuration> positions;
  std::vector<double>
      separations;  ///< to the nearest of all, m, certified lower bounds; d_i where all is farther
  std::vector<bool> along_boundary;  ///< the step from here followed a boundary
  int deadlocks = 0, switches = 0, returns = 0;
  int accelerated = 0;    ///< steps over the acceleration limit: separation, which goes first, demanded them
  int relaxed = 0;        ///< steps on which the separation demanded could not be kept, whoever demanded it
  int shortened = 0;      ///< steps cut short because the map's certificate ended there
  double arrival = -1.0;  ///< s; negative: did not arrive
  double greatest_motion = 0.0;  ///< m: no point of the robot moved farther in one period
};

/// A run from first to last step.
struct TeamRun {
  PlanStatus status = PlanStatus::no_path;  ///< solved: all stand at their goals
  std::string explanation;
  double period = 0.0;
  TeamFigures figures;
  std::vector<TeamTrace> traces;
  std::string outrun;  ///< which obstacle outran whom first, and when; empty: none

  std::size_t steps() const { return traces.empty() ? 0 : traces.front().positions.size() - 1; }
  double least_separation() const;
  /// How much nearer two robots, or a robot and an obstacle, can have come in one period at most, m: what a
  /// linear damper may miss.
  double step_bound() const;
};

/// Lets the robots move at the same time, each by its own local step and boundary following (Lahouar et al.
/// 2006): once a period every robot sees where the others and the obstacles are, takes xi / 2 of the approach
/// to another robot (Lahouar 2006, eq. 8) and all of it to an obstacle, whose velocity enters (eq. 5), and
/// steps. Where things move, coming back to a deadlock is no proof: the robot goes on. The run ends when all
/// stand at their goals and every obstacle that does not repeat its way has gone it; when nobody moves any
/// more where nothing else moves; or after the duration. Deterministic. `out_of_time` ends the run early
/// (timed_out).
/// @throws std::invalid_argument in one sentence: no robots, names given twice, sizes, joints without a
///         velocity limit, not d_s < d_i, xi over d_i - d_s, a period or duration that is not positive
TeamRun run_team(
    const Team& team, const TeamOptions& options,
    const std::function<bool()>& out_of_time = [] { return false; });

}  // namespace clearway
