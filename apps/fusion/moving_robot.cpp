#include "apps/fusion/moving_robot.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "datasets/bags/bag_source.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Of each joint: how far a radian of it moves the body's farthest point.
std::vector<double> levers_of(const Robot& robot, const Body& body) {
  std::vector<double> levers(robot.dof(), 0.0);
  for (int i = body.link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent) {
    const Link& link = robot.links[static_cast<std::size_t>(i)];
    if (link.joint >= 0)
      levers[static_cast<std::size_t>(link.joint)] += std::abs(link.multiplier) * lever(robot, i, body);
  }
  return levers;
}

/// Calls the recorded joints as the robot does.
JointStream named_as_robot(const RobotSetup& setup, JointStream joints) {
  const std::string& prefix = setup.joint_prefix;
  const std::vector<std::string> known = joints.names();
  std::map<std::string, std::string> recorded;  // names by the robot's
  for (const std::string& name : known)
    if (!prefix.empty() && name.size() > prefix.size() && name.starts_with(prefix))
      recorded[name.substr(prefix.size())] = name;
  if (!prefix.empty() && recorded.empty())
    throw std::invalid_argument(
        "setup, robot, field 'joint_prefix': no name of a recorded joint begins with " + quote(prefix) +
        "; these are " + listed(known));
  for (const auto& [joint, name] : setup.joint_names) {
    if (!std::binary_search(known.begin(), known.end(), name))
      throw std::invalid_argument(
          "setup, robot, field 'joint_names': the recorded joint positions have no joint " + quote(name) +
          ", " + suggestion(name, known));
    recorded[joint] = name;
  }
  joints.rename(recorded);
  return joints;
}

}  // namespace

std::optional<JointStream> recorded_joints(const Setup& setup, const std::filesystem::path& recording) {
  constexpr double max_gap = 0.5;  // s
  if (!setup.robot) return std::nullopt;
  const RobotSetup& robot = *setup.robot;
  if (!robot.joint_file.empty()) return named_as_robot(robot, load_joint_states(robot.joint_file, max_gap));
  if (robot.joint_topic.empty()) return std::nullopt;
  if (!is_bag(recording))
    throw std::invalid_argument("setup, robot, field 'joint_topic': expected a bag as recording, got " +
                                quote_path(recording.string()));
  return named_as_robot(robot, read_joints(recording, robot.joint_topic, max_gap, setup.source.bag));
}

MovingRobot::MovingRobot(const RobotSetup& setup, JointStream joints)
    : MovingRobot(setup, robot_as_read(setup, joints), joints) {}

MovingRobot::MovingRobot(const RobotSetup& setup, RobotAsRead read, JointStream joints)
    : setup_(setup),
      doubts_(std::move(read.doubts)),
      joints_(std::move(joints)),
      robot_(std::move(read.robot)),
      held_at_(std::move(read.held_at)) {
  for (const Joint& joint : robot_.joints) {
    names_.push_back(joint.name);
    take(joint);
  }
  for (const Body& body : robot_.bodies) levers_.push_back(levers_of(robot_, body));
}

void MovingRobot::take(const Joint& joint) {
  constexpr double whole_turn = 2.0 * std::numbers::pi;
  // One that cannot turn past itself does not wrap.
  if (joint.kind == JointKind::revolute && joint.upper - joint.lower > whole_turn - 0.1)
    joints_.let_wrap(joint.name);
  if (joint.max_acceleration > 0.0) joints_.let_accelerate(joint.name, joint.max_acceleration);
  const std::map<double, double> readings = joints_.readings(joint.name);
  const std::vector<double> impossible = impossible_times(joint, readings);
  const auto where = [](double time) {
    return "the recorded joint positions at " + short_text(time, 15) + " s";
  };
  if (are_in_other_units(impossible, readings))
    require_possible(joint, readings.at(impossible.front()), where(impossible.front()));
  for (const double time : impossible) joints_.leave_out(joint.name, time);
  if (!impossible.empty())
    doubts_.push_back(std::to_string(impossible.size()) + " of " + std::to_string(readings.size()) +
                      " readings of joint " + quote(joint.name) + " cannot be, the first at " +
                      short_text(impossible.front(), 15) + " s (" +
                      short_text(readings.at(impossible.front())) + "), and were left out");
  for (const auto& [time, position] : joints_.readings(joint.name)) {
    const auto doubt = beyond_limits(joint, position);
    if (!doubt) continue;
    doubts_.push_back("of " + where(time) + ", " + *doubt);
    break;
  }
}

std::vector<double> MovingRobot::of_known(Figures figures, double time, double span) const {
  std::vector<double> result(names_.size(), 0.0);
  for (std::size_t j = 0; j < names_.size(); ++j)
    if (joints_.at({names_[j]}, time)) result[j] = (joints_.*figures)({names_[j]}, time, span).front();
  return result;
}

double MovingRobot::open_between_readings(double time) const {
  const std::vector<double> bent = of_known(&JointStream::uncertainties, time, setup_.latency);
  double most = 0.0;
  for (const std::vector<double>& levers : levers_)
    most = std::max(most, std::inner_product(levers.begin(), levers.end(), bent.begin(), 0.0));
  return most;
}

std::string MovingRobot::why_unknown(double time) const {
  if (!positions(time)) {
    std::vector<std::string> group = names_;
    std::erase_if(group, [&](const std::string& name) { return held_at_.contains(name); });
    return joints_.why_unknown(group, time);
  }
  const double open = open_between_readings(time);
  if (open <= most_open) return "";
  return "the readings around it leave open by " + short_text(open, 2) +
         " m where its bodies were, at most " + short_text(most_open, 2) + " m";
}

std::vector<double> MovingRobot::deviations(double time, double span) const {
  std::vector<double> moved = of_known(&JointStream::deviations, time, span);
  const std::vector<double> bent = of_known(&JointStream::uncertainties, time, span);
  for (std::size_t j = 0; j < moved.size(); ++j) moved[j] += bent[j];
  return moved;
}

std::vector<double> MovingRobot::growths(double time) const { return growths(time, setup_.latency); }

std::vector<double> MovingRobot::growths(double time, double span) const {
  const std::vector<double> moved = deviations(time, span);
  std::vector<double> result;
  for (const std::vector<double>& levers : levers_) {
    double growth = setup_.self_margin + setup_.place_error;
    for (std::size_t j = 0; j < levers.size(); ++j) growth += levers[j] * (moved[j] + setup_.joint_error);
    result.push_back(growth);
  }
  return result;
}

std::vector<double> MovingRobot::place_errors() const {
  std::vector<double> result;
  for (const std::vector<double>& levers : levers_)
    result.push_back(setup_.place_error +
                     setup_.joint_error * std::accumulate(levers.begin(), levers.end(), 0.0));
  return result;
}

std::vector<double> MovingRobot::times(const std::vector<std::size_t>& bodies) const {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < names_.size(); ++j)
    if (std::any_of(bodies.begin(), bodies.end(), [&](std::size_t body) { return levers_[body][j] > 0.0; }))
      names.push_back(names_[j]);
  return joints_.times(names.empty() ? names_ : names);
}

std::optional<std::vector<double>> MovingRobot::positions(double time) const {
  std::vector<double> positions;
  for (const std::string& name : names_) {
    const auto known = joints_.at({name}, time);
    const auto held = held_at_.find(name);
    if (!known && held == held_at_.end()) return std::nullopt;
    positions.push_back(known ? known->front() : held->second);
  }
  return positions;
}

std::optional<LinkPoses> MovingRobot::poses(double time) const {
  const auto q = positions(time);
  if (!q) return std::nullopt;
  return forward_kinematics(robot_,
                            Eigen::Map<const Configuration>(q->data(), static_cast<Eigen::Index>(q->size())));
}

bool MovingRobot::knows(double time, int link) const {
  std::vector<std::string> names;
  for (int at = link; at >= 0; at = robot_.links[static_cast<std::size_t>(at)].parent)
    if (const int joint = robot_.links[static_cast<std::size_t>(at)].joint; joint >= 0)
      names.push_back(names_[static_cast<std::size_t>(joint)]);
  return joints_.at(names, time).has_value();
}

std::pair<double, double> MovingRobot::motion(double time, int link, const Eigen::Vector3d& in_link) const {
  const LinkPoses links = *poses(time);
  const Eigen::Vector3d point = links[static_cast<std::size_t>(link)] * in_link;
  const auto by_joints = jacobian(robot_, links, link, point);
  const std::vector<double> moved = deviations(time, setup_.latency);
  double shift = 0.0, turn = 0.0;
  for (std::size_t j = 0; j < moved.size(); ++j) {
    const auto by_joint = by_joints.col(static_cast<Eigen::Index>(j));
    shift += by_joint.head<3>().norm() * moved[j];
    turn += by_joint.tail<3>().norm() * moved[j];
  }
  return {shift, turn};
}

/// Whether a point is no farther than `within` from a body.
struct MovingRobot::Grown {
  const Body& body;
  Eigen::Isometry3d shape_from_map;
  double within;

  bool holds(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d local = shape_from_map * point;
    if (local.norm() > body.shape.bounding_radius() + within) return false;
    if (body.shape.has_exact_distance()) return body.shape.signed_distance(local) <= within;
    const Shape dot = Shape::sphere(1e-9);
    return distance(body.shape, Eigen::Isometry3d::Identity(), dot,
                    Eigen::Isometry3d(Eigen::Translation3d(local)), within)
               .lower <= within;
  }
};

std::vector<MovingRobot::Grown> MovingRobot::bodies(double time, double span) const {
  const LinkPoses links = *poses(time);
  const std::vector<double> growth = growths(time, span);
  std::vector<Grown> bodies;
  for (std::size_t i = 0; i < robot_.bodies.size(); ++i) {
    const Body& body = robot_.bodies[i];
    const Eigen::Isometry3d map_from_shape =
        links[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    bodies.push_back({body, map_from_shape.inverse(), growth[i]});
  }
  return bodies;
}

namespace {

/// Which points of a scan were seen at nearly the same time: within half of `longest_part` of it.
struct Part {
  double time = 0.0;
  std::vector<std::size_t> points;
};
constexpr double longest_part = 1e-3;  ///< s

std::vector<Part> parts_of(const Scan& scan, const std::vector<float>& times) {
  std::map<long, std::vector<std::size_t>> points;
  for (std::size_t i = 0; i < times.size(); ++i)
    points[std::lround(static_cast<double>(times[i]) / longest_part)].push_back(i);
  std::vector<Part> parts;
  for (auto& [number, seen] : points)
    parts.push_back({scan.time + longest_part * static_cast<double>(number), std::move(seen)});
  return parts;
}

/// Moves those points of a scan to `taken_out`, in their order. @return how many
std::size_t move_own(Scan& scan, const std::vector<bool>& is_own) {
  std::vector<Eigen::Vector3f> others;
  others.reserve(scan.points.size());
  for (std::size_t i = 0; i < is_own.size(); ++i)
    (is_own[i] ? scan.taken_out : others).push_back(scan.points[i]);
  const std::size_t count = scan.points.size() - others.size();
  scan.points = std::move(others);
  return count;
}

}  // namespace

MovingRobot::TakenOut MovingRobot::take_out(Scan& scan, const std::vector<float>& times) const {
  std::vector<Part> parts = parts_of(scan, times);
  const bool is_sweep = !times.empty() && times.size() == scan.points.size();
  if (!is_sweep) {
    parts.assign(1, {scan.time, std::vector<std::size_t>(scan.points.size())});
    std::iota(parts[0].points.begin(), parts[0].points.end(), std::size_t{0});
  }
  std::vector<bool> is_own(scan.points.size(), false);
  for (const Part& part : parts) {
    if (std::string unknown = why_unknown(part.time); !unknown.empty()) return {0, std::move(unknown)};
    const std::vector<Grown> robot =
        bodies(part.time, setup_.latency + (is_sweep ? 0.5 * longest_part : 0.0));
    for (const std::size_t i : part.points) {
      const Eigen::Vector3d placed = scan.map_from_sensor * scan.points[i].cast<double>();
      is_own[i] =
          std::any_of(robot.begin(), robot.end(), [&](const Grown& body) { return body.holds(placed); });
    }
  }
  return {move_own(scan, is_own)};
}

}  // namespace clearway
