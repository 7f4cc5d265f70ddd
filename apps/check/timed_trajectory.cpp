#include "apps/check/timed_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
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

/// Whether it is one of the robot's joints, or follows one (mimic); plan_of_trajectory compares its rates.
bool moves_by_plan(const Robot& robot, const std::string& name) {
  return std::any_of(robot.joints.begin(), robot.joints.end(),
                     [&](const Joint& joint) { return joint.name == name; }) ||
         std::any_of(robot.links.begin(), robot.links.end(),
                     [&](const Link& link) { return link.joint_name == name && link.joint >= 0; });
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

/// A sentence where the first or last point has a velocity, else empty.
std::string moving(const SplinePoint& point, const Robot& robot, const std::string& which,
                   const std::string& what) {
  Eigen::Index joint = 0;
  if (point.velocity.size() == 0 || point.velocity.cwiseAbs().maxCoeff(&joint) <= rests_within) return {};
  return "the " + which + " point moves joint " +
         shortened(robot.joints[static_cast<std::size_t>(joint)].name) + " at " +
         significant(point.velocity[joint], 3) + " a second: " + what;
}

/// A sentence where no robot can be as fast at the first point as that says, from rest at 0 s, else empty:
/// within its limits of acceleration. Without any: within a millisecond, the cycle of fast controllers, or,
/// where the file states the start, at an acceleration that no arm has.
std::string too_soon(const SplinePoint& first, const Robot& robot, bool is_start_stated) {
  constexpr double shortest = 1e-3;  // s
  constexpr double fastest = 1e3;    // rad/s^2 or m/s^2
  constexpr double rounding = 0.01;  // of a limit
  for (Eigen::Index j = 0; j < first.velocity.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const double speed = std::abs(first.velocity[j]), asked = speed / first.time;
    const double limit = joint.max_acceleration;
    const bool is_soon = limit > 0.0       ? asked > (1.0 + rounding) * limit
                         : is_start_stated ? asked > fastest
                                           : first.time < shortest;
    if (speed <= rests_within || !is_soon) continue;
    const bool turns = joint.kind == JointKind::revolute;
    return "the first point moves joint " + shortened(joint.name) + " at " +
           significant(first.velocity[j], 3) + " a second after " + significant(first.time) +
           " s: from rest that takes " + significant(asked, 3) + (turns ? " rad/s^2" : " m/s^2") +
           (limit > 0.0 ? ", beyond its acceleration limit of " + significant(limit) : "") +
           ", expected it to start at rest";
  }
  return {};
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
  const Configuration stated = start;
  start = by_whole_turns(robot, start, first.position);
  if (is_stated)
    for (const Joint& joint : robot.joints)
      if (!trajectory.start.contains(joint.name))
        timed.notes.push_back("where joint " + shortened(joint.name) +
                              " is before the trajectory is not said: it is taken to be at the first point");
  if (first.time <= 0.0)
    timed.moving_start = moving(first, robot, "first",
                                "how the robot comes to it is not judged, expected it to start at rest");
  if (first.time > 0.0) {
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(start.size());
    timed.moving_start = too_soon(first, robot, is_stated);
    if (is_stated) {
      timed.points.insert(timed.points.begin(), {0.0, start, rest, rest});
      timed.has_start = true;
      if (stated != start) timed.stated_start = stated;
    } else {
      timed.notes.push_back("where the robot is before the first point, which it reaches after " +
                            significant(first.time) + " s, is not said: the way there is not judged");
    }
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

/// The least acceleration that takes a joint over an edge of a mean velocity in a time, where the velocities
/// at its ends are known: of one end 2 |v - mean| / time, of both that of full speed up and down once.
double least_acceleration(double mean, double time, std::optional<double> first, std::optional<double> last) {
  if (first && last) {
    const double change = *last - *first, beyond = 2.0 * (mean - 0.5 * (*first + *last));
    return (std::abs(beyond) + std::hypot(beyond, change)) / time;
  }
  if (!first && !last) return 0.0;
  return 2.0 * std::abs((first ? *first : *last) - mean) / time;
}

/// Why no motion through points on straight lines keeps the limits of acceleration: along an edge with a
/// known velocity at an end (that of its point, or rest at the first and the last one) it is what
/// least_acceleration says, and over two edges that meet at a point without one it is, somewhere, twice the
/// change of the mean velocities over the time of both (a second divided difference is half a second
/// derivative). Empty where one may.
/// @param free what is asked of joints without a limit, the greatest
std::string corner_fault(const TimedTrajectory& trajectory, const Robot& robot,
                         std::optional<RatePeak>& free) {
  constexpr double rounding = 0.01;  // of a limit
  const std::vector<SplinePoint>& points = trajectory.points;
  const auto known = [&](std::size_t point, Eigen::Index joint) -> std::optional<double> {
    if (points[point].velocity.size() > 0) return points[point].velocity[joint];
    return point == 0 || point + 1 == points.size() ? std::optional(0.0) : std::nullopt;
  };
  const auto is_line = [&](std::size_t edge) {
    return points[edge].velocity.size() == 0 || points[edge + 1].velocity.size() == 0;
  };
  const auto time_of = [&](std::size_t edge) { return points[edge + 1].time - points[edge].time; };
  const auto mean = [&](std::size_t edge, Eigen::Index j) {
    return (points[edge + 1].position[j] - points[edge].position[j]) / time_of(edge);
  };
  const auto fault = [&](Eigen::Index joint, double asked, double from, double to, std::size_t point) {
    const Joint& mover = robot.joints[static_cast<std::size_t>(joint)];
    const double limit = mover.max_acceleration;
    if (limit <= 0.0) raise(free, RatePeak{asked, static_cast<std::size_t>(joint), points[point].time});
    if (limit <= 0.0 || asked <= (1.0 + rounding) * limit) return std::string();
    return "motion: joint " + shortened(mover.name) + " has to come from " + significant(from) + " to " +
           significant(to) + " at the point at " + significant(points[point].time) +
           " s: no motion through the points does so within its acceleration limit of " + significant(limit);
  };
  for (std::size_t edge = 0; edge + 1 < points.size(); ++edge) {
    if (!is_line(edge)) continue;
    for (Eigen::Index joint = 0; joint < points[edge].position.size(); ++joint) {
      const double along = mean(edge, joint);
      const std::optional<double> first = known(edge, joint), last = known(edge + 1, joint);
      const bool is_first = first && (!last || std::abs(*first - along) >= std::abs(*last - along));
      std::string found =
          fault(joint, least_acceleration(along, time_of(edge), first, last), is_first ? *first : along,
                is_first ? along : last.value_or(along), is_first ? edge : edge + 1);
      if (!found.empty()) return found;
      const bool is_corner = edge + 2 < points.size() && points[edge + 1].velocity.size() == 0;
      if (!is_corner) continue;
      const double next = mean(edge + 1, joint);
      found = fault(joint, 2.0 * std::abs(next - along) / (time_of(edge) + time_of(edge + 1)), along, next,
                    edge + 1);
      if (!found.empty()) return found;
    }
  }
  return {};
}

/// As a controller may know the start, too: of a robot whose hardware states no accelerations, or no
/// velocities, it knows less, and takes a cubic or a line; and of endless joints it may take the long way.
std::vector<SplinePoint> other_starts(const TimedTrajectory& trajectory) {
  if (!trajectory.has_start) return {};
  std::vector<SplinePoint> starts;
  SplinePoint start = trajectory.points.front();
  const auto add_less_known = [&] {
    for (auto* unknown : {&start.acceleration, &start.velocity}) {
      unknown->resize(0);
      starts.push_back(start);
    }
  };
  add_less_known();
  if (trajectory.stated_start.size() == 0) return starts;
  start = trajectory.points.front();
  start.position = trajectory.stated_start;
  starts.push_back(start);
  add_less_known();
  return starts;
}

}  // namespace

std::optional<TimedTrajectory> timed_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                                                const std::filesystem::path& file) {
  if (trajectory.times.empty()) return std::nullopt;
  require_still(trajectory, robot, file);
  TimedTrajectory timed;
  timed.field = trajectory.field;
  for (std::size_t i = 0; i < trajectory.points.size(); ++i)
    timed.points.push_back({trajectory.times[i], picked(trajectory, robot, trajectory.points[i]),
                            picked(trajectory, robot, trajectory.velocities[i]),
                            picked(trajectory, robot, trajectory.accelerations[i])});
  add_start(trajectory, robot, timed);
  timed.moving_end = moving(timed.points.back(), robot, "last",
                            "how the robot stops after it is not judged, expected it to rest there");
  return timed;
}

SplineVerdict check_timed(const TimedTrajectory& trajectory, const Robot& robot, const Snapshot& map,
                          const std::map<std::string, Policy>& policies, double padding, double seen_within) {
  SplineVerdict verdict = check_splines(robot, map, policies, padding, trajectory.points, seen_within);
  for (const SplinePoint& start : other_starts(trajectory)) {
    const SplineVerdict other =
        check_splines(robot, map, policies, padding, {start, trajectory.points[1]}, seen_within);
    if (verdict.fault.empty()) verdict.fault = other.fault;
    const double clearance = std::min(verdict.path.min_clearance, other.path.min_clearance);
    if (verdict.path.valid && !other.path.valid) verdict.path = other.path;
    verdict.path.min_clearance = clearance;
    verdict.velocity_share = std::max(verdict.velocity_share, other.velocity_share);
    verdict.acceleration_share = std::max(verdict.acceleration_share, other.acceleration_share);
    verdict.chords.insert(verdict.chords.begin(), other.chords.begin(), other.chords.end());
    raise_peaks(verdict, other);
  }
  if (verdict.fault.empty()) verdict.fault = corner_fault(trajectory, robot, verdict.free_acceleration);
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

std::vector<std::string> notes_of(const TimedTrajectory& trajectory, const SplineVerdict& verdict) {
  std::string edges;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) edges += (edges.empty() ? ": " : ", ") + counted(count, one, many);
  };
  add(verdict.quintics, "quintic", "quintics");
  add(verdict.cubics, "cubic", "cubics");
  add(verdict.lines, "straight line without velocities", "straight lines without velocities");
  std::vector<std::string> notes{"the trajectory is judged as ROS's joint_trajectory_controller runs it" +
                                 edges};
  if (verdict.lines > 0)
    notes.emplace_back(
        "on straight lines without velocities, where these jump, torques are those of level speed and "
        "accelerations the least that the points ask for");
  notes.insert(notes.end(), trajectory.notes.begin(), trajectory.notes.end());
  return notes;
}

}  // namespace clearway
