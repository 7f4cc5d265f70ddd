#include "apps/check/timed_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {
namespace {

constexpr double swings_within = 1e-4;      ///< rad or m
constexpr double starts_within = 0.01;      ///< rad or m, MoveIt's default
constexpr double rests_within = 1e-6;       ///< rad/s or m/s
constexpr double same_place_within = 1e-9;  ///< rad or m
constexpr double torque_rounding = 1e-3;    ///< of a limit, of velocities and accelerations in a file

bool moves_by_plan(const Robot& robot, const std::string& name) {
  return std::any_of(robot.joints.begin(), robot.joints.end(),
                     [&](const Joint& joint) { return joint.name == name; });
}

/// What a joint that stands still does between its points: the control points of its polynomials stay there.
void require_still(const ForeignTrajectory& trajectory, const Robot& robot,
                   const std::filesystem::path& file) {
  double longest = trajectory.times.front();
  for (std::size_t i = 1; i < trajectory.times.size(); ++i)
    longest = std::max(longest, trajectory.times[i] - trajectory.times[i - 1]);
  for (std::size_t j = 0; j < trajectory.joints.size(); ++j) {
    if (moves_by_plan(robot, trajectory.joints[j])) continue;
    for (std::size_t i = 0; i < trajectory.times.size(); ++i) {
      const auto rate = [&](const std::vector<std::vector<double>>& rates) {
        return rates[i].empty() ? 0.0 : std::abs(rates[i][j]);
      };
      const double swing = 0.4 * longest * rate(trajectory.velocities) +
                           longest * longest / 20.0 * rate(trajectory.accelerations);
      if (swing > swings_within)
        throw std::invalid_argument(file.string() + ": the trajectory has joint " +
                                    quote(trajectory.joints[j]) + ", which stands still, move at points[" +
                                    std::to_string(i) + "], expected velocities and accelerations of 0");
    }
  }
}

/// Values of the robot's joints among those of the trajectory.
Eigen::VectorXd picked(const ForeignTrajectory& trajectory, const Robot& robot,
                       const std::vector<double>& values) {
  if (values.empty()) return {};
  Eigen::VectorXd own(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto found = std::find(trajectory.joints.begin(), trajectory.joints.end(), robot.joints[j].name);
    own[static_cast<Eigen::Index>(j)] = values[static_cast<std::size_t>(found - trajectory.joints.begin())];
  }
  return own;
}

/// From where the robot is before to the first point.
void add_start(const ForeignTrajectory& trajectory, const Robot& robot, TimedTrajectory& timed) {
  const SplinePoint first = timed.points.front();
  Configuration start = first.position;
  bool is_stated = false;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto found = trajectory.start.find(robot.joints[j].name);
    if (found == trajectory.start.end()) continue;
    start[static_cast<Eigen::Index>(j)] = found->second;
    is_stated = true;
  }
  start = by_whole_turns(robot, start, first.position);
  if (is_stated)
    for (const Joint& joint : robot.joints)
      if (!trajectory.start.contains(joint.name))
        timed.notes.push_back("where joint " + shortened(joint.name) +
                              " is before the trajectory is not said: it is taken to be at the first point");
  if (first.time <= 0.0 && first.velocity.size() > 0 && first.velocity.cwiseAbs().maxCoeff() > rests_within)
    timed.notes.push_back("the first point has a velocity: how the robot comes to it is not judged");
  if (first.time > 0.0) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(start.size());
    if (is_stated) {
      timed.points.insert(timed.points.begin(), {0.0, start, rest, rest});
      timed.has_start = true;
    } else
      timed.notes.push_back("where the robot is before the first point, which it reaches after " +
                            significant(first.time) + " s, is not said: the way there is not judged");
    return;
  }
  Eigen::Index joint = 0;
  const double apart = (start - first.position).cwiseAbs().maxCoeff(&joint);
  if (apart <= same_place_within) return;
  timed.before = start;
  if (apart > starts_within)
    timed.fault = "motion: joint " + shortened(robot.joints[static_cast<std::size_t>(joint)].name) +
                  " is at " + significant(start[joint]) + " before and at " +
                  significant(first.position[joint]) +
                  " at the first point, expected a time_from_start above 0 in which it gets there";
}

/// Why no motion through points on straight lines keeps the limits of acceleration: over two edges that meet
/// it is, somewhere, twice the change of the mean velocities over the time of both (a second divided
/// difference is half a second derivative); beside a point at which the robot rests, twice the mean velocity
/// over the edge's time, and on the way from rest to rest by one edge four times. Empty where one may.
std::string corner_fault(const TimedTrajectory& trajectory, const Robot& robot) {
  constexpr double rounding = 0.01;  // of a limit
  const std::vector<SplinePoint>& points = trajectory.points;
  const bool is_one = points.size() == 2 && points[0].velocity.size() + points[1].velocity.size() == 0;
  const double factor = is_one ? 4.0 : 2.0;
  const auto is_line = [&](std::size_t edge) {
    return edge + 1 < points.size() &&
           (points[edge].velocity.size() == 0 || points[edge + 1].velocity.size() == 0);
  };
  const auto time_of = [&](std::size_t edge) { return points[edge + 1].time - points[edge].time; };
  const auto velocity = [&](std::size_t edge, Eigen::Index j) {
    return (points[edge + 1].position[j] - points[edge].position[j]) / time_of(edge);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool after = is_line(i), before = i > 0 && is_line(i - 1);
    const bool is_end = i == 0 || i + 1 == points.size();
    if (is_end && points[i].velocity.size() > 0 && points[i].velocity.cwiseAbs().maxCoeff() > rests_within)
      continue;
    if ((!after && !before) || (i > 0 && i + 1 < points.size() && !(after && before))) continue;
    const double time = (before ? time_of(i - 1) : 0.0) + (after ? time_of(i) : 0.0);
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      const double from = before ? velocity(i - 1, joint) : 0.0, to = after ? velocity(i, joint) : 0.0;
      const double limit = robot.joints[j].max_acceleration, asked = factor * std::abs(to - from) / time;
      if (limit <= 0.0 || asked <= (1.0 + rounding) * limit) continue;
      return "motion: joint " + shortened(robot.joints[j].name) + " has to come from " + significant(from) +
             " to " + significant(to) + " at the point at " + significant(points[i].time) +
             " s: no motion through the points does so within its acceleration limit of " +
             significant(limit);
    }
  }
  return {};
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string joints_without(const Robot& robot, double Joint::*limit) {
  std::string names;
  std::size_t count = 0;
  for (const Joint& joint : robot.joints) {
    if (joint.*limit > 0.0) continue;
    names += (count == 0 ? "" : ", ") + shortened(joint.name);
    ++count;
  }
  return count == robot.dof() && count > 1 ? "any joint" : names;
}

}  // namespace

std::optional<TimedTrajectory> timed_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                                                const std::filesystem::path& file) {
  if (trajectory.times.empty()) return std::nullopt;
  require_still(trajectory, robot, file);
  TimedTrajectory timed;
  for (std::size_t i = 0; i < trajectory.points.size(); ++i)
    timed.points.push_back({trajectory.times[i], picked(trajectory, robot, trajectory.points[i]),
                            picked(trajectory, robot, trajectory.velocities[i]),
                            picked(trajectory, robot, trajectory.accelerations[i])});
  add_start(trajectory, robot, timed);
  const Eigen::VectorXd& last = timed.points.back().velocity;
  if (last.size() > 0 && last.cwiseAbs().maxCoeff() > rests_within)
    timed.notes.push_back("the last point has a velocity: how the robot stops after it is not judged");
  return timed;
}

SplineVerdict check_timed(const TimedTrajectory& trajectory, const Robot& robot, const Snapshot& map,
                          const std::map<std::string, Policy>& policies, double padding, double seen_within) {
  SplineVerdict verdict = check_splines(robot, map, policies, padding, trajectory.points, seen_within);
  if (trajectory.has_start) {
    // Of a robot whose hardware states no accelerations, or no velocities, the controller knows less of the
    // start: then it takes a cubic or a line.
    SplinePoint start = trajectory.points.front();
    for (auto* unknown : {&start.acceleration, &start.velocity}) {
      unknown->resize(0);
      const SplineVerdict other =
          check_splines(robot, map, policies, padding, {start, trajectory.points[1]}, seen_within);
      if (verdict.fault.empty()) verdict.fault = other.fault;
      if (verdict.path.valid && !other.path.valid) verdict.path = other.path;
    }
  }
  if (verdict.fault.empty()) verdict.fault = corner_fault(trajectory, robot);
  if (!trajectory.fault.empty()) verdict.fault = trajectory.fault;
  if (trajectory.before.size() == 0 || !verdict.path.valid) return verdict;
  PathVerdict way = check_path(robot, map, policies, padding,
                               {trajectory.before, trajectory.points.front().position}, 0.0, seen_within);
  way.clearance.clear();
  if (way.valid) way.min_clearance = std::min(way.min_clearance, verdict.path.min_clearance);
  if (!way.valid) way.first_contact = "on the way to the first point: " + way.first_contact;
  verdict.path = way;
  verdict.chords.insert(verdict.chords.begin(), trajectory.before);
  return verdict;
}

TorqueFinding torques_of(const TimedTrajectory& trajectory, const Robot& robot, const JointLoad& load,
                         SplineVerdict& verdict) {
  const TorqueTerms terms = torque_terms(robot, load);
  const TorqueFinding found = greatest_torques(robot, spline_states(trajectory.points), terms);
  verdict.fault = torque_fault(robot, 1.0, terms, found, torque_rounding);
  return found;
}

std::vector<std::string> notes_of(const TimedTrajectory& trajectory, const SplineVerdict& verdict,
                                  const Robot& robot) {
  std::string edges;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) edges += (edges.empty() ? ": " : ", ") + counted(count, one, many);
  };
  add(verdict.quintics, "quintic", "quintics");
  add(verdict.cubics, "cubic", "cubics");
  add(verdict.lines, "straight line without velocities", "straight lines without velocities");
  std::vector<std::string> notes{"the trajectory is judged as ROS's joint_trajectory_controller runs it" +
                                 edges};
  if (const std::string names = joints_without(robot, &Joint::max_velocity); !names.empty())
    notes.push_back("the robot states no velocity limit of " + names + ", so none is compared");
  if (verdict.cubics + verdict.quintics > 0)
    if (const std::string names = joints_without(robot, &Joint::max_acceleration); !names.empty())
      notes.push_back("the robot states no acceleration limit of " + names + ", so none is compared");
  if (verdict.lines > 0)
    notes.emplace_back(
        "on straight lines without velocities, where these jump, torques are those of level speed and "
        "accelerations the least that the points ask for");
  notes.insert(notes.end(), trajectory.notes.begin(), trajectory.notes.end());
  return notes;
}

}  // namespace clearway
