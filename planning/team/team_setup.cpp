#include "planning/team/team_setup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/require.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/team/team_member.hpp"

namespace clearway {
namespace {

/// What the others are for robot `i`: their bodies, then the obstacles.
struct Surroundings {
  std::vector<PlacedShape> shapes;
  std::vector<std::string> names;
};

/// The others as they stand at the start or the goal, and at the start the obstacles.
Surroundings around(const Team& team, const TeamOptions& options, std::size_t i, bool at_goal,
                    bool with_sensed) {
  Surroundings all;
  for (std::size_t j = 0; j < team.robots.size(); ++j) {
    const TeamRobot& other = team.robots[j];
    if (j == i) continue;
    const Robot& robot = other.space->robot();
    for (const PlacedShape& body :
         placed_bodies(robot, forward_kinematics(robot, at_goal ? other.goal : other.start)))
      all.shapes.push_back(body);
    for (const Body& body : robot.bodies) all.names.push_back(other.name + "/" + body.part);
  }
  if (at_goal) return all;
  for (const MovingObstacle& obstacle : team.obstacles) {
    if (obstacle.is_sensed && !with_sensed) continue;
    all.shapes.push_back(obstacle.placed(0.0, options.period));
    all.names.push_back(obstacle.name);
  }
  return all;
}

/// "tool touches right/forearm" for the first body that touches something; empty when none does. Bodies that
/// no joint moves count like all others.
std::string touching(const Robot& robot, const Configuration& q, const Surroundings& others) {
  const std::vector<PlacedShape> own = placed_bodies(robot, forward_kinematics(robot, q));
  for (std::size_t b = 0; b < own.size(); ++b) {
    for (std::size_t s = 0; s < others.shapes.size(); ++s) {
      const PlacedShape& other = others.shapes[s];
      const double apart = (own[b].pose.translation() - other.pose.translation()).norm();
      if (apart > own[b].shape.bounding_radius() + other.shape.bounding_radius() + 1e-6) continue;
      if (distance(own[b].shape, own[b].pose, other.shape, other.pose).lower > 0.0) continue;
      return robot.bodies[b].part + " touches " + others.names[s];
    }
  }
  return "";
}

/// The least separation, at most `limit`, at starts and goals: of robots from the map and themselves, or from
/// the others.
double least_at_ends(const Team& team, const TeamOptions& options, double limit, bool own) {
  double least = limit;
  for (const bool at_goal : {false, true}) {
    for (std::size_t i = 0; i < team.robots.size(); ++i) {
      const ConfigurationSpace& space = *team.robots[i].space;
      const Configuration& q = at_goal ? team.robots[i].goal : team.robots[i].start;
      if (own) {
        for (const ProximityConstraint& constraint : space.proximity_constraints(q, limit))
          least = std::min(least, constraint.distance);
        continue;
      }
      std::vector<ObstacleConstraint> constraints;
      ObstacleConstraints(space.robot())
          .append(forward_kinematics(space.robot(), q), around(team, options, i, at_goal, false).shapes,
                  limit, constraints);
      for (const ObstacleConstraint& constraint : constraints) least = std::min(least, constraint.distance);
    }
  }
  return least;
}

}  // namespace

void check_team_inputs(const Team& team, const TeamOptions& options) {
  require(!team.robots.empty(), "a team needs at least one robot");
  require(options.period > 0.0 && std::isfinite(options.period), "team: period: expected more than 0 s");
  require(options.duration >= options.period && options.duration / options.period <= 1e6,
          "team: duration: expected one to a million periods");
  require(options.max_acceleration > 0.0 && std::isfinite(options.max_acceleration),
          "team: max_acceleration: expected more than 0");
  text_of_options("team", options.boundary);  // refuses what is out of range
  std::set<std::string> names;
  for (const TeamRobot& member : team.robots) {
    const Robot& robot = member.space->robot();
    const auto n = static_cast<Eigen::Index>(robot.dof());
    require(names.insert(member.name).second,
            "two robots are called '" + member.name + "': expected names that differ");
    require(member.start.size() == n && member.goal.size() == n,
            "robot '" + member.name + "': start and goal: expected " + std::to_string(n) + " values each");
    for (const Joint& joint : robot.joints) {
      require(joint.max_velocity > 0.0, "robot '" + member.name + "', joint '" + joint.name +
                                            "': its velocity limit is 0 or not given; expected one over 0 " +
                                            "to move it in time");
    }
  }
  choose_figures(team, options);
}

TeamFigures choose_figures(const Team& team, const TeamOptions& options) {
  TeamFigures figures;
  const ConstraintOptions& given = options.boundary.local;
  std::vector<double> reach;
  for (const TeamRobot& robot : team.robots)
    reach.push_back(weighted_reach(*robot.space, given.prismatic_scale));
  const double longest = *std::max_element(reach.begin(), reach.end());
  figures.influence_distance = given.influence_distance > 0.0 ? given.influence_distance : longest / 5.0;
  const double d_i = figures.influence_distance;
  const auto automatic = [&](bool own) {
    const double half = least_at_ends(team, options, d_i, own) / 2.0;
    return std::clamp(half, 1e-3 * std::min(d_i, longest / 5.0), d_i / 8.0);
  };
  const bool is_given = given.security_distance > 0.0;
  figures.security_distance = is_given ? given.security_distance : automatic(false);
  figures.own_security_distance =
      is_given ? given.security_distance : std::min(figures.security_distance, automatic(true));
  const double margin = d_i - figures.security_distance;
  require(margin > 0.0, "team: security_distance " + to_text(figures.security_distance) +
                            ", influence_distance " + to_text(d_i) + ": expected security < influence");
  double fastest = 0.0;
  for (std::size_t i = 0; i < team.robots.size(); ++i) {
    const ConfigurationSpace& space = *team.robots[i].space;
    const double braking =
        given.max_step > 0.0 ? std::numeric_limits<double>::infinity() : margin / (2.0 * reach[i]);
    const double longest_kept = longest_step(space, given.prismatic_scale, options, braking);
    const double step = given.max_step > 0.0 ? std::min(given.max_step, longest_kept) : longest_kept;
    figures.max_step.push_back(step);
    fastest = std::max(fastest, step * reach[i]);
  }
  figures.xi = given.xi > 0.0 ? given.xi : std::min(2.0 * fastest, margin);
  require(figures.xi <= margin * (1.0 + 1e-12),
          "team: security_distance " + to_text(figures.security_distance) + ", influence_distance " +
              to_text(d_i) + ", xi " + to_text(figures.xi) + ": expected xi <= influence - security");
  for (const MovingObstacle& obstacle : team.obstacles)
    figures.greatest_obstacle_speed = std::max(figures.greatest_obstacle_speed, obstacle.greatest_speed());
  return figures;
}

PlanResult check_team_ends(const Team& team, const TeamOptions& options) {
  PlanResult result;
  result.status = PlanStatus::solved;
  for (const bool at_goal : {false, true}) {
    for (std::size_t i = 0; i < team.robots.size(); ++i) {
      const TeamRobot& member = team.robots[i];
      const Configuration& q = at_goal ? member.goal : member.start;
      const std::string who = "Robot '" + member.name + "' at its " + (at_goal ? "goal" : "start") + ": ";
      const Verdict verdict = member.space->check(q);
      std::string sentence = verdict.is_free() ? "" : verdict.sentence();
      if (sentence.empty())
        sentence = touching(member.space->robot(), q, around(team, options, i, at_goal, true));
      if (sentence.empty()) continue;
      result.status = at_goal ? PlanStatus::goal_invalid : PlanStatus::start_invalid;
      result.explanation = who + sentence + ".";
      return result;
    }
  }
  return result;
}

TeamOptions team_options(const std::string& planner, const PlannerOptions& options) {
  require(planner == "constraint" || planner == "boundary",
          "planner '" + planner +
              "' cannot lead a team: expected constraint or boundary, which move step by step");
  TeamOptions all;
  OptionReader reader(planner, options);
  all.follows_boundaries = planner == "boundary";
  if (all.follows_boundaries) {
    all.boundary = read_options(reader, BoundaryOptions());
  } else {
    all.boundary.local = read_options(reader, ConstraintOptions());
  }
  reader.refuse_unknown();
  require(
      all.boundary.local.max_steps == 0,
      planner + ": option 'max_steps' does not apply to a team, whose duration ends a run: expected auto");
  return all;
}

}  // namespace clearway
