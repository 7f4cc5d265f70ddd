#include "apps/check/trajectory_slack.hpp"

#include <algorithm>
#include <cmath>

#include "apps/check/trajectory_plan.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Where a joint of the trajectory is judged: factor * the value of another of its joints + offset.
struct JudgedJoint {
  std::size_t master = 0;
  double factor = 0.0, offset = 0.0;
};

std::size_t place_of(const ForeignTrajectory& trajectory, const std::string& joint) {
  const auto found = std::find(trajectory.joints.begin(), trajectory.joints.end(), joint);
  return static_cast<std::size_t>(found - trajectory.joints.begin());
}

/// Of a joint that stands still: its value, whatever the others do.
JudgedJoint judged_joint(const ForeignTrajectory& trajectory, const Robot& robot, const Link& link) {
  if (link.joint >= 0)
    return {place_of(trajectory, robot.joints[static_cast<std::size_t>(link.joint)].name), link.multiplier,
            link.offset};
  const HeldJoint* held = held_joint(robot, link.joint_name);
  return {0, 0.0, held == nullptr ? 0.0 : held->value};
}

double longest_step(const std::vector<double>& times) {
  double longest = times.empty() ? 0.0 : times.front();
  for (std::size_t i = 1; i < times.size(); ++i) longest = std::max(longest, times[i] - times[i - 1]);
  return longest;
}

/// The largest difference of a joint's values, or rates, from those of where it is judged.
double difference(const std::vector<std::vector<double>>& list, std::size_t joint, const JudgedJoint& judged,
                  double offset) {
  double largest = 0.0;
  for (const std::vector<double>& values : list)
    if (!values.empty())
      largest = std::max(largest, std::abs(values[joint] - judged.factor * values[judged.master] - offset));
  return largest;
}

/// Radians or metres. Between two points the control points of a polynomial of degree five are beside the
/// points by at most 2/5 of the step times the velocity and 1/20 of its square times the acceleration.
double difference_of(const ForeignTrajectory& trajectory, std::size_t joint, const JudgedJoint& judged) {
  const double step = longest_step(trajectory.times);
  return difference(trajectory.points, joint, judged, judged.offset) +
         0.4 * step * difference(trajectory.velocities, joint, judged, 0.0) +
         0.05 * step * step * difference(trajectory.accelerations, joint, judged, 0.0);
}

/// The same where the file says that the joint is before the trajectory; of a follower beside its master,
/// which is at the first point if the file does not say otherwise.
double difference_before(const ForeignTrajectory& trajectory, const Robot& robot, const Link& link) {
  const bool is_held = held_joint(robot, link.joint_name) != nullptr;
  const std::map<std::string, double>& before = is_held ? trajectory.start : trajectory.stated_start;
  const auto start = before.find(link.joint_name);
  if (start == before.end() || (!is_held && link.joint < 0)) return 0.0;
  const JudgedJoint judged = judged_joint(trajectory, robot, link);
  const auto master = before.find(trajectory.joints[judged.master]);
  const double leads = master != before.end() ? master->second : trajectory.points.front()[judged.master];
  return std::abs(start->second - judged.factor * leads - judged.offset);
}

/// How far draw_to_limits moved the joint, or the one that it follows, for it.
double drawn_of(const ForeignTrajectory& trajectory, const Robot& robot, const Link& link) {
  if (link.joint < 0) return 0.0;
  const auto found = trajectory.drawn.find(robot.joints[static_cast<std::size_t>(link.joint)].name);
  return found == trajectory.drawn.end() ? 0.0 : std::abs(link.multiplier) * found->second;
}

/// What hangs on a joint moves by at most that for each radian or metre of it.
double reach_of(const Robot& robot, std::size_t link) {
  return std::max(1.0, reach_below(robot, static_cast<int>(link)));
}

double slack_of_joints(const ForeignTrajectory& trajectory, const Robot& robot) {
  double slack = 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const bool is_planned =
        link.joint >= 0 && robot.joints[static_cast<std::size_t>(link.joint)].name == link.joint_name;
    const std::size_t joint = place_of(trajectory, link.joint_name);
    double beside = 0.0;
    if (!is_planned && joint < trajectory.joints.size())
      beside = difference_of(trajectory, joint, judged_joint(trajectory, robot, link));
    if (!is_planned) beside = std::max(beside, difference_before(trajectory, robot, link));
    slack += (beside + drawn_of(trajectory, robot, link)) * reach_of(robot, i);
  }
  return slack;
}

double slack_of_base(const ForeignTrajectory& trajectory, const Robot& robot,
                     const Eigen::Isometry3d& map_from_base) {
  if (!trajectory.map_from_base) return 0.0;
  const Eigen::Isometry3d between = map_from_base.inverse() * *trajectory.map_from_base;
  double reach = 0.0;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].parent < 0)
      reach = std::max(reach, robot.links[i].parent_from_link.translation().norm() +
                                  reach_below(robot, static_cast<int>(i)));
  return between.translation().norm() + Eigen::AngleAxisd(between.linear()).angle() * reach;
}

}  // namespace

double slack_of(const std::vector<ForeignTrajectory>& trajectories, const Robot& robot,
                const Eigen::Isometry3d& map_from_base) {
  double of_joints = 0.0, of_base = 0.0;  // a base that one of them names is that of all
  for (const ForeignTrajectory& trajectory : trajectories) {
    of_joints = std::max(of_joints, slack_of_joints(trajectory, robot));
    of_base = std::max(of_base, slack_of_base(trajectory, robot, map_from_base));
  }
  return of_joints + of_base;
}

}  // namespace clearway
