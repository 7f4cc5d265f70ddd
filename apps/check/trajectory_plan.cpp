#include "apps/check/trajectory_plan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/limit_rounding.hpp"

namespace clearway {
namespace {

constexpr double stands_within = 1e-4;  ///< rad or m

bool is_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d between = a.inverse() * b;
  return between.translation().norm() <= stands_within &&
         Eigen::AngleAxisd(between.linear()).angle() <= stands_within;
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw std::invalid_argument(file.string() + ": the trajectory " + what);
}

/// The place of each of the robot's joints among those of the trajectory.
std::vector<std::size_t> places_of_joints(const ForeignTrajectory& trajectory, const Robot& robot,
                                          const std::filesystem::path& file) {
  std::vector<std::size_t> places;
  for (const Joint& joint : robot.joints) {
    const auto found = std::find(trajectory.joints.begin(), trajectory.joints.end(), joint.name);
    if (found == trajectory.joints.end())
      refuse(file,
             "says nothing of joint " + quote(joint.name) + " of robot " + quote(robot.name) +
                 ", expected its values, or where it is before (trajectory_start), or --fix or --group, "
                 "by which it stands still");
    places.push_back(static_cast<std::size_t>(found - trajectory.joints.begin()));
  }
  return places;
}

Configuration configuration_of(const std::vector<double>& point, const std::vector<std::size_t>& places) {
  Configuration q(static_cast<Eigen::Index>(places.size()));
  for (std::size_t j = 0; j < places.size(); ++j) q[static_cast<Eigen::Index>(j)] = point[places[j]];
  return q;
}

/// The link that hangs on a joint, moving or not; null: none does.
const Link* link_under(const Robot& robot, const std::string& joint) {
  const auto found = std::find_if(robot.links.begin(), robot.links.end(),
                                  [&](const Link& link) { return link.joint_name == joint; });
  return found == robot.links.end() ? nullptr : &*found;
}

/// A joint that follows another (mimic) has to be where that one takes it, at its rates: a controller that
/// is given both moves each as the file says.
class Follower {
 public:
  Follower(const Robot& robot, const Link& link)
      : multiplier_(link.multiplier),
        offset_(link.offset),
        name_(link.joint_name),
        master_name_(robot.joints[static_cast<std::size_t>(link.joint)].name) {}

  const std::string& master_name() const { return master_name_; }

  /// @param place of it among the trajectory's joints @param master place of the joint that it follows
  void require(const ForeignTrajectory& trajectory, std::size_t place, std::size_t master,
               const std::filesystem::path& file) const {
    const auto require_all = [&](const std::vector<std::vector<double>>& list, double offset,
                                 const std::string& does) {
      for (const std::vector<double>& values : list)  // none: the file does not state them
        if (!values.empty()) require(values[place], values[master], offset, does, file);
    };
    require_all(trajectory.points, offset_, "stands");
    require_all(trajectory.velocities, 0.0, "moves");
    require_all(trajectory.accelerations, 0.0, "is accelerated");
  }
  /// Before the trajectory. @param master value of the joint that it follows
  void require_start(double value, double master, const std::filesystem::path& file) const {
    require(value, master, offset_, "stands before it (trajectory_start)", file);
  }

 private:
  void require(double value, double master, double offset, const std::string& does,
               const std::filesystem::path& file) const {
    const double expected = multiplier_ * master + offset;
    if (std::abs(value - expected) <= stands_within * std::max(1.0, std::abs(expected))) return;
    refuse(file, "has joint " + quote(name_) + " at " + significant(value, 6) + ", which " + does + " at " +
                     significant(expected, 6) + ", as it follows " + quote(master_name_) +
                     " (mimic), expected that, or the joint left out");
  }

  double multiplier_, offset_;
  const std::string& name_;
  const std::string& master_name_;
};

/// What the trajectory says of a joint that the robot does not plan for.
class StillJoint {
 public:
  StillJoint(const std::string& name, const Robot& robot, const std::filesystem::path& file)
      : name_(name), file_(file), held_(held_joint(robot, name)) {
    if (held_ == nullptr && link_under(robot, name) != nullptr)
      refuse(file, "has values of joint " + quote(name) +
                       ", which is fixed or follows one that stands still, expected it to be left out");
    if (held_ == nullptr)
      refuse(file,
             "has values of joint " + quote(name) + ", which robot " + quote(robot.name) + " does not have");
    if (robot.scale != 1.0)
      refuse(file, "has values of joint " + quote(name) +
                       ", which stands still, expected it to be left out for a robot of another scale");
  }
  void require(double value) const {
    if (std::abs(value - held_->value) <= stands_within) return;
    refuse(file_, "has joint " + quote(name_) + " at " + significant(value) + ", which stands at " +
                      significant(held_->value) + ", expected --fix " + name_ +
                      "=VALUE or a --group that it is part of");
  }

 private:
  const std::string& name_;
  const std::filesystem::path& file_;
  const HeldJoint* held_;
};

bool is_planned(const Robot& robot, const std::string& name) {
  return std::any_of(robot.joints.begin(), robot.joints.end(),
                     [&](const Joint& joint) { return joint.name == name; });
}

/// What the file says of joints before the trajectory: those that stand still, and followers, of which only
/// trajectory_start itself is known to be of one moment.
/// @param places of the robot's joints among the trajectory's
void require_start(const ForeignTrajectory& trajectory, const Robot& robot,
                   const std::vector<std::size_t>& places, const std::filesystem::path& file) {
  for (const auto& [name, value] : trajectory.start)
    if (held_joint(robot, name) != nullptr) StillJoint(name, robot, file).require(value);
  for (const auto& [name, value] : trajectory.stated_start) {
    const Link* link = link_under(robot, name);
    if (is_planned(robot, name) || link == nullptr || link->joint < 0) continue;
    const Follower follower(robot, *link);
    const auto master = trajectory.stated_start.find(follower.master_name());
    const std::size_t place = places[static_cast<std::size_t>(link->joint)];
    follower.require_start(
        value, master != trajectory.stated_start.end() ? master->second : trajectory.points.front()[place],
        file);
  }
}

/// @param places of the robot's joints among the trajectory's
void require_standing(const ForeignTrajectory& trajectory, const Robot& robot,
                      const std::vector<std::size_t>& places, const std::filesystem::path& file) {
  for (std::size_t j = 0; j < trajectory.joints.size(); ++j) {
    if (is_planned(robot, trajectory.joints[j])) continue;
    const Link* link = link_under(robot, trajectory.joints[j]);
    if (link != nullptr && link->joint >= 0) {
      Follower(robot, *link).require(trajectory, j, places[static_cast<std::size_t>(link->joint)], file);
      continue;
    }
    const StillJoint joint(trajectory.joints[j], robot, file);
    for (const std::vector<double>& point : trajectory.points) joint.require(point[j]);
  }
  require_start(trajectory, robot, places, file);
}

template <typename Value>
void take_default(Term<Value>& term) {
  if (term.source == TermSource::plan) term.source = TermSource::by_default;
}

}  // namespace

const HeldJoint* held_joint(const Robot& robot, const std::string& name) {
  const auto held = std::find_if(robot.held.begin(), robot.held.end(),
                                 [&](const HeldJoint& joint) { return joint.name == name; });
  return held == robot.held.end() ? nullptr : &*held;
}

std::vector<std::string> hold_unnamed_joints(ForeignTrajectory& trajectory, const Robot& robot) {
  std::vector<std::string> unnamed;
  const auto append = [](std::vector<std::vector<double>>& list, double value) {
    for (std::vector<double>& values : list)
      if (!values.empty()) values.push_back(value);
  };
  for (const Joint& joint : robot.joints) {
    const auto start = trajectory.start.find(joint.name);
    if (start == trajectory.start.end() ||
        std::find(trajectory.joints.begin(), trajectory.joints.end(), joint.name) != trajectory.joints.end())
      continue;
    unnamed.push_back(joint.name);
    trajectory.joints.push_back(joint.name);
    append(trajectory.points, start->second);
    append(trajectory.velocities, 0.0);
    append(trajectory.accelerations, 0.0);
  }
  return unnamed;
}

void draw_to_limits(ForeignTrajectory& trajectory, const Robot& robot) {
  for (const Joint& joint : robot.joints) {
    double farthest = 0.0;
    const auto draw = [&](double& value) {
      const double drawn = drawn_to_limit(joint, value);
      farthest = std::max(farthest, std::abs(value - drawn));
      value = drawn;
    };
    const auto place =
        static_cast<std::size_t>(std::find(trajectory.joints.begin(), trajectory.joints.end(), joint.name) -
                                 trajectory.joints.begin());
    if (place < trajectory.joints.size())
      for (std::vector<double>& point : trajectory.points) draw(point[place]);
    if (const auto start = trajectory.start.find(joint.name); start != trajectory.start.end())
      draw(start->second);
    if (farthest > 0.0) trajectory.drawn[joint.name] = farthest;
  }
}

std::vector<std::string> drawn_notes(const std::vector<ForeignTrajectory>& trajectories) {
  std::map<std::string, double> farthest;
  for (const ForeignTrajectory& trajectory : trajectories)
    for (const auto& [joint, by] : trajectory.drawn) farthest[joint] = std::max(farthest[joint], by);
  std::vector<std::string> notes;
  constexpr double unseen = 1e-9;  // rad or m
  for (const auto& [joint, by] : farthest)
    if (by > unseen)
      notes.push_back("joint " + shortened(joint) + " is beyond its limit by up to " + significant(by, 3) +
                      ", as rounding to single precision has it: judged at the limit");
  return notes;
}

void require_base(const ForeignTrajectory& trajectory, const Eigen::Isometry3d& map_from_base,
                  const std::filesystem::path& file) {
  if (!trajectory.map_from_base || is_near(*trajectory.map_from_base, map_from_base)) return;
  std::string flag;
  for (const double number : numbers_from_pose(*trajectory.map_from_base))
    flag += (flag.empty() ? "" : ",") + significant(number, 9);
  refuse(file, "begins with the robot's base at " + to_text(*trajectory.map_from_base) +
                   " (multi_dof_joint_state), which is judged at " + to_text(map_from_base) +
                   ", expected --base " + flag + ", if that pose is of the map's frame, or no such pose");
}

std::string degrees_note(const Plan& plan, const Robot& robot) {
  const std::vector<Configuration> path = plan.waypoints();
  const auto found = std::find_if(path.begin(), path.end(),
                                  [&](const Configuration& q) { return looks_like_degrees(robot, q); });
  if (found == path.end()) return "";
  return "the trajectory's waypoint " + std::to_string(found - path.begin() + 1) +
         " is far outside of the joint limits in radians and within them in degrees: expected radians";
}

std::string model_note(const ForeignTrajectory& trajectory, const Robot& robot) {
  const std::string& model = trajectory.model;
  if (model.empty() || model == robot.name || model == robot.model) return {};
  return "the trajectory is for robot " + quote(model) + " (model_id), and judged for " +
         quote(robot.model.empty() ? robot.name : robot.model);
}

Plan plan_of_trajectory(const ForeignTrajectory& trajectory, const Robot& robot,
                        const std::filesystem::path& file) {
  const std::vector<std::size_t> places = places_of_joints(trajectory, robot, file);
  require_standing(trajectory, robot, places, file);
  PlanResult leg;
  leg.status = PlanStatus::solved;
  if (!trajectory.start.empty()) {  // from there a controller goes to the first point
    Configuration q = configuration_of(trajectory.points.front(), places);
    for (std::size_t j = 0; j < robot.dof(); ++j)
      if (const auto found = trajectory.start.find(robot.joints[j].name); found != trajectory.start.end())
        q[static_cast<Eigen::Index>(j)] = found->second;
    leg.waypoints.push_back(q);
  }
  for (const std::vector<double>& point : trajectory.points) {
    const Configuration q = configuration_of(point, places);
    if (leg.waypoints.empty() || q != leg.waypoints.back()) leg.waypoints.push_back(q);
  }
  if (leg.waypoints.size() == 1) leg.waypoints.push_back(leg.waypoints.front());
  Plan plan;
  plan.robot = robot.name;
  plan.robot_scale = robot.scale;
  plan.map_from_base = robot.map_from_base;
  plan.joints = joint_names(robot);
  plan.group = robot.group;
  for (const HeldJoint& joint : robot.held) plan.held[joint.name] = joint.value;
  plan.xacro = robot.xacro;
  plan.planner = "a trajectory";
  plan.start = leg.waypoints.front();
  plan.goals = {leg.waypoints.back()};
  plan.legs.push_back(std::move(leg));
  return plan;
}

void adopt_terms(const std::optional<StatedTerms>& stated, bool is_timed, Contract& contract, Plan& plan) {
  if (!stated) {
    plan.robot = contract.robot.value;
    plan.robot_scale = contract.scale.value;
    plan.map_from_base = contract.map_from_base.value;
    take_default(contract.group);
    for (auto& [joint, term] : contract.held) take_default(term);
    take_default(contract.scale);
    take_default(contract.map_from_base);
  }
  plan.policies = policies_of(contract);
  plan.padding = contract.padding.value;
  plan.seen_within = contract.seen_within.value;
  if (!stated || stated->payload == 0.0) {
    plan.payload = contract.payload.value;
    take_default(contract.payload);
  }
  if (!stated || stated->loads.empty()) {
    plan.loads = contract.loads.value;
    take_default(contract.loads);
  }
  if (!stated || !stated->gravity) {
    plan.gravity = contract.gravity.value;
    take_default(contract.gravity);
  }
  if (plan.map_sha256.empty()) plan.map_sha256 = contract.map_sha256.value;
  for (auto& [part, term] : contract.policies) take_default(term);
  take_default(contract.padding);
  take_default(contract.seen_within);
  if (is_timed) return;
  contract.notes.push_back(
      "the points of the trajectory, which have no times, are checked as joined by straight edges; where a "
      "controller goes between them is not known");
}

std::optional<Deviation> group_deviation(const std::optional<StatedTerms>& stated, const Contract& contract,
                                         const std::set<AcceptedTerm>& accepted) {
  const std::string& group = contract.group.value;
  if (!stated || stated->group.empty() || group.empty() || stated->group == group) return std::nullopt;
  return Deviation{AcceptedTerm::held,
                   "group: expected " + quote(group) + ", the trajectory says " + quote(stated->group),
                   accepted.contains(AcceptedTerm::held)};
}

void cut_at_goals(Contract& contract, Plan& plan) {
  const std::vector<Configuration>& goals = contract.goals.value;
  const bool rides = contract.pick.value || !contract.loads.value.empty() || !plan.loads.empty();
  if (plan.legs.size() != 1 || goals.size() < 2 || rides) return;
  const std::vector<Configuration> path = plan.legs.front().waypoints;
  std::vector<std::size_t> ends;
  std::string numbers;
  for (std::size_t at = 0; ends.size() + 1 < goals.size();) {
    const Configuration& goal = goals[ends.size()];
    const auto is_goal = [&](const Configuration& q) {
      return q.size() == goal.size() && (q - goal).cwiseAbs().maxCoeff() <= contract_tolerance;
    };
    const auto found = std::find_if(path.begin() + static_cast<std::ptrdiff_t>(at), path.end(), is_goal);
    if (found == path.end()) return;  // told by whoever compares goals
    at = static_cast<std::size_t>(found - path.begin());
    ends.push_back(at);
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(at + 1);
  }
  ends.push_back(path.size() - 1);
  const PlanResult whole = plan.legs.front();
  plan.legs.assign(goals.size(), whole);
  plan.goals = goals;
  plan.goals.back() = path.back();
  for (std::size_t leg = 0, begin = 0; leg < ends.size(); begin = ends[leg++])
    plan.legs[leg].waypoints.assign(path.begin() + static_cast<std::ptrdiff_t>(begin),
                                    path.begin() + static_cast<std::ptrdiff_t>(ends[leg]) + 1);
  contract.notes.push_back("the trajectory comes to the goals before the last at its points " + numbers);
}

}  // namespace clearway
