#include "planning/robot/goal_configurations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/robot/puma_branches.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

constexpr double same_configuration = 1e-3;  ///< rad or m

double largest_apart(const Configuration& a, const Configuration& b) {
  return (a - b).lpNorm<Eigen::Infinity>();
}

/// Within the limits, or a turn either way of `near`; joints that do not move the tip are as `near` has them.
Configuration random_start(const Robot& robot, const Configuration& near, std::mt19937_64& random) {
  Configuration q = near;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    double& value = q[static_cast<Eigen::Index>(j)];
    const double lower = std::isfinite(joint.lower) ? joint.lower : value - std::numbers::pi;
    const double upper = std::isfinite(joint.upper) ? joint.upper : value + std::numbers::pi;
    const double unit = random_unit(random);
    if (moves_tip(robot, j)) value = lower + (upper - lower) * unit;
  }
  return q;
}

/// Six turning joints of which the axes of the last three meet in a point: where that is, the first three
/// say, and the last three turn the tip about it (Pieper 1968).
struct SphericalWrist {
  std::size_t link = 0;             ///< that the last joint moves
  Eigen::Vector3d center;           ///< in its frame
  std::array<std::size_t, 3> bent;  ///< the links that its joints move
};

/// A joint's axis, in the map.
struct JointAxis {
  Eigen::Vector3d point, direction;
};

double distance_to(const JointAxis& axis, const Eigen::Vector3d& point) {
  return axis.direction.cross(point - axis.point).norm();
}

/// Links that move the tip, the last first.
std::vector<std::size_t> moved_links(const Robot& robot) {
  std::vector<std::size_t> moved;
  for (int at = robot.tip_link; at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent)
    if (robot.links[static_cast<std::size_t>(at)].joint >= 0) moved.push_back(static_cast<std::size_t>(at));
  return moved;
}

std::optional<SphericalWrist> spherical_wrist(const Robot& robot, const Configuration& q) {
  constexpr double near = 1e-6;  // m, and sine of an angle
  const std::vector<std::size_t> moved = moved_links(robot);
  const bool is_arm = moved.size() == 6 && joints_of_tip(robot) == 6 &&
                      std::all_of(moved.begin(), moved.end(), [&](std::size_t i) {
                        const Link& link = robot.links[i];
                        return link.multiplier == 1.0 && kind_of(robot, link) == JointKind::revolute;
                      });
  if (!is_arm) return std::nullopt;
  const LinkPoses poses = forward_kinematics(robot, q);
  const auto placed_axis = [&](std::size_t i) {
    return JointAxis{poses[i].translation(), poses[i].linear() * axis_of(robot, robot.links[i])};
  };
  const JointAxis last = placed_axis(moved[0]), middle = placed_axis(moved[1]), first = placed_axis(moved[2]);
  const Eigen::Vector3d across = first.direction.cross(middle.direction);
  if (across.norm() < near || last.direction.cross(middle.direction).norm() < near) return std::nullopt;
  // The point of the middle axis that is nearest to the first one.
  const double along =
      (first.point - middle.point).cross(first.direction).dot(middle.direction.cross(first.direction)) /
      across.squaredNorm();
  const Eigen::Vector3d center = middle.point + along * middle.direction;
  if (distance_to(first, center) > near || distance_to(last, center) > near) return std::nullopt;
  SphericalWrist wrist;
  wrist.link = moved[0];
  wrist.center = poses[moved[0]].inverse() * center;
  wrist.bent = {moved[2], moved[1], moved[0]};
  return wrist;
}

/// rad, by which `from` has to turn about the axis to lie over `to`.
double turn_about(const Eigen::Vector3d& axis, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d u = axis.cross(from), v = axis.cross(to);
  return std::atan2(axis.dot(u.cross(v)), u.dot(v));
}

/// The two ways in which the wrist turns the tip to the pose, the first three joints being as they are (Paden
/// and Kahan's second subproblem: Murray, Li, Sastry 1994, 3.3.2); none where it cannot.
std::vector<Configuration> turned_wrists(const Robot& robot, const SphericalWrist& wrist,
                                         const Eigen::Isometry3d& map_from_tip, const Configuration& q) {
  const LinkPoses poses = forward_kinematics(robot, q);
  std::array<Eigen::Vector3d, 3> axes;
  std::array<Eigen::Index, 3> joints{};
  for (std::size_t k = 0; k < 3; ++k) {
    joints[k] = robot.links[wrist.bent[k]].joint;
    axes[k] = poses[wrist.bent[k]].linear() * axis_of(robot, robot.links[wrist.bent[k]]);
  }
  const Eigen::Matrix3d turn =
      map_from_tip.linear() *
      (poses[static_cast<std::size_t>(robot.tip_link)] * robot.link_from_tip).linear().transpose();
  const auto& [first, middle, last] = axes;
  // exp(first a) exp(middle b) last = turn last: `met` is where both turns meet.
  const Eigen::Vector3d to = turn * last;
  const double lean = first.dot(middle), least = lean * lean - 1.0;
  const double along = (lean * middle.dot(last) - first.dot(to)) / least;
  const double beside = (lean * first.dot(to) - middle.dot(last)) / least;
  const double square = (1.0 - along * along - beside * beside - 2.0 * along * beside * lean) / -least;
  if (square < -1e-3) return {};  // what the arm is off may hide that they touch
  std::vector<Configuration> ways;
  for (const double side : {1.0, -1.0}) {
    const Eigen::Vector3d met =
        along * first + beside * middle + side * std::sqrt(std::max(0.0, square)) * first.cross(middle);
    const double b = turn_about(middle, last, met), a = turn_about(first, met, to);
    const Eigen::Matrix3d rest =
        (Eigen::AngleAxisd(a, first) * Eigen::AngleAxisd(b, middle)).inverse() * turn;
    const Eigen::Vector3d across = last.unitOrthogonal();
    Configuration way = q;
    way[joints[0]] += a;
    way[joints[1]] += b;
    way[joints[2]] += turn_about(last, across, rest * across);
    ways.push_back(std::move(way));
  }
  return ways;
}

/// Configurations that put the middle of the wrist where the pose wants it: of each place of the first three
/// joints one.
std::vector<Configuration> reaching_arms(const Robot& robot, const SphericalWrist& wrist,
                                         const Eigen::Isometry3d& map_from_tip, const Configuration& near,
                                         int starts, std::mt19937_64& random) {
  const LinkPoses poses = forward_kinematics(robot, near);
  const Eigen::Isometry3d tip_from_link =
      (poses[static_cast<std::size_t>(robot.tip_link)] * robot.link_from_tip).inverse() * poses[wrist.link];
  Robot to_center = robot;
  to_center.tip_link = static_cast<int>(wrist.link);
  to_center.link_from_tip = Eigen::Translation3d(wrist.center);
  const Eigen::Isometry3d place = map_from_tip * tip_from_link * to_center.link_from_tip;
  std::vector<Configuration> arms;
  for (int start = 0; start < starts; ++start) {
    const auto q = inverse_kinematics(to_center, place, random_start(robot, near, random),
                                      {.restarts = 0, .position_only = true});
    const bool is_new = q && std::none_of(arms.begin(), arms.end(), [&](const Configuration& known) {
                          Configuration apart = *q - known;
                          for (const std::size_t link : wrist.bent) apart[robot.links[link].joint] = 0.0;
                          return apart.lpNorm<Eigen::Infinity>() <= same_configuration;
                        });
    if (is_new) arms.push_back(*q);
  }
  return arms;
}

/// Each once, of joints that turn more than once the turn nearest to `near`, within limits.
class FoundConfigurations {
 public:
  FoundConfigurations(const Robot& robot, const Configuration& near) : robot_(robot), near_(near) {}

  void add(const Configuration& solution) {
    // A joint that turns more than once reaches the pose by several of its turns.
    const Configuration q = unwrapped_within_limits(robot_, solution, near_).value_or(solution);
    const bool is_known = std::any_of(found_.begin(), found_.end(), [&](const Configuration& known) {
      return largest_apart(known, q) <= same_configuration;
    });
    if (!is_known && limit_violation(robot_, q).empty()) found_.push_back(q);
  }

  std::vector<Configuration> nearest_first() {
    std::stable_sort(found_.begin(), found_.end(), [&](const Configuration& a, const Configuration& b) {
      return largest_apart(a, near_) < largest_apart(b, near_);
    });
    return std::move(found_);
  }

 private:
  const Robot& robot_;
  const Configuration& near_;
  std::vector<Configuration> found_;
};

constexpr double least_difference = 1e-5;  ///< m and rad, of poses that count as the same

/// Number `index` of the Halton sequence of this base, in (0, 1).
double halton(int index, int base) {
  double value = 0.0, share = 1.0;
  for (; index > 0; index /= base) {
    share /= base;
    value += share * (index % base);
  }
  return value;
}

/// A vector within the ball of radius 1, evenly spread over three numbers from 0 to 1.
Eigen::Vector3d within_ball(double along, double around, double out) {
  const double z = 2.0 * along - 1.0, angle = 2.0 * std::numbers::pi * around;
  const double width = std::sqrt(1.0 - z * z);
  return std::cbrt(out) * Eigen::Vector3d(width * std::cos(angle), width * std::sin(angle), z);
}

Eigen::Isometry3d turned(const Eigen::Isometry3d& pose, const Eigen::Vector3d& by) {
  Eigen::Isometry3d result = pose;
  if (by.norm() > 0.0) result.linear() = pose.linear() * Eigen::AngleAxisd(by.norm(), by.normalized());
  return result;
}

}  // namespace

bool reaches(const GoalPose& goal, const Eigen::Isometry3d& map_from_tip) {
  if ((map_from_tip.translation() - goal.map_from_tip.translation()).norm() >
      goal.position_tolerance + least_difference)
    return false;
  const Eigen::Matrix3d apart = goal.map_from_tip.linear().transpose() * map_from_tip.linear();
  double turn = Eigen::AngleAxisd(apart).angle();
  if (goal.free_axis) {  // what is left when the tip has turned back about its axis as far as it helps
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(*goal.free_axis);
    turn = std::atan2(axis.cross(apart * axis).norm(), axis.dot(apart * axis));
  }
  return turn <= goal.turn_tolerance + least_difference;
}

std::vector<Eigen::Isometry3d> poses_of(const GoalPose& goal, int count) {
  constexpr int steps = 24;
  std::vector<Eigen::Isometry3d> poses{goal.map_from_tip};
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(goal.free_axis.value_or(0));
  for (int i = 2; goal.free_axis && i <= steps; ++i) {
    const double turn = 2.0 * std::numbers::pi / steps * (i / 2) * (i % 2 == 0 ? 1.0 : -1.0);
    poses.push_back(turned(goal.map_from_tip, turn * axis));
  }
  if (goal.position_tolerance == 0.0 && goal.turn_tolerance == 0.0) return poses;
  for (int i = 1; i <= count; ++i) {
    const Eigen::Vector3d tilt = within_ball(halton(i, 7), halton(i, 11), halton(i, 13));
    Eigen::Isometry3d pose = turned(goal.map_from_tip, goal.turn_tolerance * tilt);
    if (goal.free_axis) pose = turned(pose, 2.0 * std::numbers::pi * halton(i, 17) * axis);
    pose.translation() += goal.position_tolerance * within_ball(halton(i, 2), halton(i, 3), halton(i, 5));
    poses.push_back(pose);
  }
  return poses;
}

Robot with_tip(const Robot& robot, const std::string& link) {
  std::vector<std::string> names;
  for (const Link& known : robot.links) names.push_back(known.name);
  const auto found = std::find(names.begin(), names.end(), link);
  if (found == names.end())
    throw std::invalid_argument("--tip: robot " + quote(robot.name) + " has no link " + quote(link) + ", " +
                                suggestion(link, names));
  Robot result = robot;
  result.tip_link = static_cast<int>(found - names.begin());
  result.link_from_tip.setIdentity();
  result.tip_choice = {};
  result.inverse_kinematics = "numeric";
  if (!is_moved(result, result.tip_link))
    throw std::invalid_argument("--tip: no joint of robot " + quote(robot.name) + " moves link " +
                                quote(link));
  return result;
}

std::size_t joints_of_tip(const Robot& robot) {
  std::size_t joints = 0;
  for (std::size_t j = 0; j < robot.dof(); ++j) joints += moves_tip(robot, j);
  return joints;
}

std::vector<Configuration> goal_configurations(const Robot& robot, const Eigen::Isometry3d& map_from_tip,
                                               const Configuration& near, int starts, std::uint64_t seed) {
  require_configuration(robot, near, "goal configurations: near");
  FoundConfigurations found(robot, near);
  const auto add = [&](const Configuration& q) { found.add(q); };
  if (robot.inverse_kinematics == "puma")
    for (const Configuration& q : puma_inverse_kinematics(robot, map_from_tip)) add(q);
  std::mt19937_64 random(seed);
  const auto look_from = [&](const Configuration& from) {
    if (const auto q = inverse_kinematics(robot, map_from_tip, from, {.restarts = 0})) add(*q);
  };
  look_from(near);
  const bool is_closed = robot.inverse_kinematics == "puma";
  const auto wrist = is_closed ? std::nullopt : spherical_wrist(robot, near);
  if (wrist) {
    for (const Configuration& arm : reaching_arms(robot, *wrist, map_from_tip, near, starts, random))
      for (const Configuration& way : turned_wrists(robot, *wrist, map_from_tip, arm))
        if (const auto q = unwrapped_within_limits(robot, way, near)) look_from(*q);
  } else if (!is_closed) {
    for (int start = 0; start < starts; ++start) look_from(random_start(robot, near, random));
  }
  return found.nearest_first();
}

std::vector<Configuration> goal_configurations(const Robot& robot, const GoalPose& goal,
                                               const Configuration& near, int starts, std::uint64_t seed) {
  require_configuration(robot, near, "goal configurations: near");
  const IkOptions options{.restarts = 0,
                          .free_distance = goal.position_tolerance,
                          .free_turn = goal.turn_tolerance,
                          .free_axis = goal.free_axis};
  FoundConfigurations found(robot, near);
  std::mt19937_64 random(seed);
  for (int start = 0; start <= starts; ++start) {
    const Configuration from = start == 0 ? near : random_start(robot, near, random);
    if (const auto q = inverse_kinematics(robot, goal.map_from_tip, from, options)) found.add(*q);
  }
  return found.nearest_first();
}

}  // namespace clearway
