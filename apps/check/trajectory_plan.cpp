#include "apps/check/trajectory_plan.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/query/query.hpp"
#include "datasets/descriptions/yaml_fields.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double stands_within = 1e-4;  ///< rad or m
constexpr Bounds any_value{-1e6, 1e6};

/// The map that holds `joint_names`.
std::optional<YamlFields> innermost(const YamlFields& root) {
  if (root.has("joint_names") && root.has("joint_trajectory"))
    root.fail("joint_trajectory", "expected it or 'joint_names', got both");
  if (root.has("joint_names")) return root;
  if (root.has("multi_dof_joint_trajectory") &&
      !root.map("multi_dof_joint_trajectory").list_of_maps("points").empty())
    root.fail("multi_dof_joint_trajectory", "expected no points: the robot's base stands still");
  if (root.has("joint_trajectory")) return root.map("joint_trajectory");
  if (!root.has("trajectory")) return std::nullopt;
  const std::vector<YamlFields> list = root.list_of_maps("trajectory");
  if (list.size() != 1)
    root.fail("trajectory", "expected one trajectory, got " + std::to_string(list.size()));
  return innermost(list.front());
}

/// Where the robot is before the trajectory, as a DisplayTrajectory says; not with anything in its hand.
std::map<std::string, double> start_of(const YamlFields& root) {
  std::map<std::string, double> start;
  if (!root.has("trajectory_start")) return start;
  const YamlFields state = root.map("trajectory_start");
  if (!state.list_of_maps("attached_collision_objects").empty())
    state.fail("attached_collision_objects", "expected none; --attach says what the robot carries");
  if (!state.has("joint_state")) return start;
  const YamlFields joints = state.map("joint_state");
  const std::vector<std::string> names = joints.texts("name");
  const std::vector<double> values = joints.numbers("position", any_value, names.size());
  for (std::size_t i = 0; i < names.size(); ++i) start[names[i]] = values[i];
  if (joints.has("velocity"))
    for (const double velocity : joints.numbers("velocity", any_value))
      if (std::abs(velocity) > 1e-6)
        joints.fail("velocity", "expected 0: only a robot that rests before a trajectory is judged");
  return start;
}

const HeldJoint* held_joint(const Robot& robot, const std::string& name) {
  const auto held = std::find_if(robot.held.begin(), robot.held.end(),
                                 [&](const HeldJoint& joint) { return joint.name == name; });
  return held == robot.held.end() ? nullptr : &*held;
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
      refuse(file, "says nothing of joint " + quote(joint.name) + " of robot " + quote(robot.name) +
                       ", expected its values, or --fix or --group, by which it stands still");
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
  /// @param place of `name` among the trajectory's joints
  /// @param master place of the joint that it follows
  Follower(const Robot& robot, const Link& link, std::size_t place, std::size_t master)
      : place_(place),
        master_(master),
        multiplier_(link.multiplier),
        offset_(link.offset),
        name_(link.joint_name),
        master_name_(robot.joints[static_cast<std::size_t>(link.joint)].name) {}

  void require(const ForeignTrajectory& trajectory, const std::filesystem::path& file) const {
    for (const std::vector<double>& point : trajectory.points) require(point, offset_, "stands", file);
    for (const std::vector<double>& rates : trajectory.velocities) require(rates, 0.0, "moves", file);
    for (const std::vector<double>& rates : trajectory.accelerations)
      require(rates, 0.0, "is accelerated", file);
  }

 private:
  /// @param values of all joints; none: the file does not state them
  void require(const std::vector<double>& values, double offset, const std::string& does,
               const std::filesystem::path& file) const {
    if (values.empty()) return;
    const double expected = multiplier_ * values[master_] + offset;
    if (std::abs(values[place_] - expected) <= stands_within * std::max(1.0, std::abs(expected))) return;
    refuse(file, "has joint " + quote(name_) + " at " + significant(values[place_], 6) + ", which " + does +
                     " at " + significant(expected, 6) + ", as it follows " + quote(master_name_) +
                     " (mimic), expected that, or the joint left out");
  }

  std::size_t place_, master_;
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

/// @param places of the robot's joints among the trajectory's
void require_standing(const ForeignTrajectory& trajectory, const Robot& robot,
                      const std::vector<std::size_t>& places, const std::filesystem::path& file) {
  for (std::size_t j = 0; j < trajectory.joints.size(); ++j) {
    if (is_planned(robot, trajectory.joints[j])) continue;
    const Link* link = link_under(robot, trajectory.joints[j]);
    if (link != nullptr && link->joint >= 0) {
      Follower(robot, *link, j, places[static_cast<std::size_t>(link->joint)]).require(trajectory, file);
      continue;
    }
    const StillJoint joint(trajectory.joints[j], robot, file);
    for (const std::vector<double>& point : trajectory.points) joint.require(point[j]);
  }
  for (const auto& [name, value] : trajectory.start)
    if (held_joint(robot, name) != nullptr) StillJoint(name, robot, file).require(value);
}

/// Seconds, as ROS 2 (sec, nanosec), ROS 1 (secs, nsecs) and bridges between them (sec, nsec) write them.
double time_of(const YamlFields& point) {
  const YamlFields time = point.map("time_from_start");
  double sum = 0.0;
  std::size_t known = 0;
  const auto add = [&](std::initializer_list<const char*> names, Bounds bounds, double unit) {
    const auto found =
        std::count_if(names.begin(), names.end(), [&](const char* name) { return time.has(name); });
    if (found > 1) time.fail(*names.begin(), "expected one of its names");
    for (const char* name : names)
      if (time.has(name)) sum += unit * time.number(name, bounds);
    known += static_cast<std::size_t>(found);
  };
  add({"sec", "secs"}, {0.0, 1e9}, 1.0);
  add({"nanosec", "nsec", "nsecs"}, {0.0, 999'999'999.0}, 1e-9);
  if (known == 0 || known != time.keys().size())
    time.fail("", "expected sec and nanosec (ROS 2), or secs and nsecs (ROS 1), and nothing else");
  return sum;
}

/// The values of a field that a point may leave out.
std::vector<double> rates_of(const YamlFields& point, const std::string& key, std::size_t joints) {
  if (!point.has(key)) return {};
  std::vector<double> values = point.numbers(key, any_value);
  if (!values.empty() && values.size() != joints)
    point.fail(key, "expected none or " + std::to_string(joints) + " numbers, one for each joint, got " +
                        std::to_string(values.size()));
  return values;
}

void read_times(const std::vector<YamlFields>& points, ForeignTrajectory& trajectory) {
  const auto has_time = [](const YamlFields& point) { return point.has("time_from_start"); };
  if (std::none_of(points.begin(), points.end(), has_time)) return;
  for (const YamlFields& point : points) {
    if (!has_time(point)) point.fail("time_from_start", "expected it as other points have it");
    trajectory.times.push_back(time_of(point));
  }
  if (std::all_of(trajectory.times.begin(), trajectory.times.end(), [](double t) { return t == 0.0; })) {
    trajectory.times.clear();
    return;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0 && !(trajectory.times[i] > trajectory.times[i - 1]))
      points[i].fail("time_from_start", "expected more than the " + significant(trajectory.times[i - 1], 10) +
                                            " s of the point before, got " +
                                            significant(trajectory.times[i], 10) + " s");
    trajectory.velocities.push_back(rates_of(points[i], "velocities", trajectory.joints.size()));
    trajectory.accelerations.push_back(rates_of(points[i], "accelerations", trajectory.joints.size()));
    if (trajectory.velocities.back().empty() && !trajectory.accelerations.back().empty())
      points[i].fail("velocities", "expected them where there are accelerations");
  }
}

/// The rates of all points, each of them with or without.
std::vector<std::vector<double>> rates_in(const YamlFields& root, const std::string& key,
                                          const ForeignTrajectory& trajectory) {
  const std::size_t count = trajectory.points.size(), joints = trajectory.joints.size();
  std::vector<std::vector<double>> rates(count);
  if (root.has(key)) rates = root.lists_of_numbers(key, any_value);
  const bool fits = std::all_of(rates.begin(), rates.end(), [&](const std::vector<double>& list) {
    return list.empty() || list.size() == joints;
  });
  if (rates.size() != count || !fits)
    root.fail(key, "expected " + std::to_string(joints) + " numbers or none for each of the " +
                       std::to_string(count) + " points");
  return rates;
}

/// What `plan --export json` writes: a list for each quantity.
ForeignTrajectory own_export(const YamlFields& root) {
  if (root.has("events"))
    root.fail("events",
              "expected none: what the robot carries, and when, is in the plan's JSON "
              "(plan --out --motion), which check reads");
  ForeignTrajectory trajectory;
  trajectory.joints = root.texts("joints");
  if (trajectory.joints.empty()) root.fail("joints", "expected at least one");
  trajectory.times = root.numbers("times_s", {0.0, 1e9});
  trajectory.points = root.lists_of_numbers("positions", any_value, trajectory.joints.size());
  if (trajectory.points.empty()) root.fail("positions", "expected at least one");
  if (trajectory.times.size() != trajectory.points.size())
    root.fail("times_s", "expected as many as there are positions, " +
                             std::to_string(trajectory.points.size()) + ", got " +
                             std::to_string(trajectory.times.size()));
  for (std::size_t i = 1; i < trajectory.times.size(); ++i)
    if (!(trajectory.times[i] > trajectory.times[i - 1]))
      root.fail("times_s", "expected times that rise, got " + significant(trajectory.times[i], 10) +
                               " after " + significant(trajectory.times[i - 1], 10));
  trajectory.velocities = rates_in(root, "velocities", trajectory);
  trajectory.accelerations = rates_in(root, "accelerations", trajectory);
  return trajectory;
}

template <typename Value>
void take_default(Term<Value>& term) {
  if (term.source == TermSource::plan) term.source = TermSource::by_default;
}

}  // namespace

std::optional<ForeignTrajectory> read_trajectory(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  if (kind == ".csv")
    throw std::invalid_argument(file.string() +
                                ": a trajectory as CSV is for spreadsheets, expected a plan's JSON, or a "
                                "trajectory as --export ros, ros-json or json writes it");
  const bool is_yaml = kind == ".yaml" || kind == ".yml";
  if (!is_yaml && kind != ".json") return std::nullopt;
  const std::string text = read_input(file, "plan file", 64U << 20U);
  const bool is_own = !is_yaml && text.find("\"times_s\"") != std::string::npos &&
                      text.find("\"joints\"") != std::string::npos &&
                      text.find("\"legs\"") == std::string::npos;
  if (!is_yaml && !is_own && text.find("\"joint_names\"") == std::string::npos) return std::nullopt;
  const YamlFields root(text, "trajectory " + quote_path(file.string()));
  if (is_own) return own_export(root);
  const std::optional<YamlFields> found = innermost(root);
  if (!found) root.fail("joint_names", "expected the names of a JointTrajectory");
  ForeignTrajectory trajectory;
  trajectory.start = start_of(root);
  trajectory.joints = found->texts("joint_names");
  if (trajectory.joints.empty()) found->fail("joint_names", "expected at least one");
  if (std::set<std::string>(trajectory.joints.begin(), trajectory.joints.end()).size() !=
      trajectory.joints.size())
    found->fail("joint_names", "expected each name once");
  const std::vector<YamlFields> points = found->list_of_maps("points");
  for (const YamlFields& point : points)
    trajectory.points.push_back(point.numbers("positions", any_value, trajectory.joints.size()));
  if (trajectory.points.empty()) found->fail("points", "expected at least one");
  read_times(points, trajectory);
  return trajectory;
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

void adopt_terms(Contract& contract, Plan& plan, bool is_timed) {
  plan.robot = contract.robot.value;
  plan.robot_scale = contract.scale.value;
  plan.map_from_base = contract.map_from_base.value;
  plan.policies = policies_of(contract);
  plan.padding = contract.padding.value;
  plan.seen_within = contract.seen_within.value;
  plan.payload = contract.payload.value;
  plan.gravity = contract.gravity.value;
  plan.map_sha256 = contract.map_sha256.value;
  plan.loads = contract.loads.value;
  take_default(contract.group);
  for (auto& [joint, term] : contract.held) take_default(term);
  take_default(contract.scale);
  take_default(contract.map_from_base);
  for (auto& [part, term] : contract.policies) take_default(term);
  take_default(contract.padding);
  take_default(contract.seen_within);
  take_default(contract.payload);
  take_default(contract.gravity);
  take_default(contract.loads);
  if (is_timed) return;
  contract.notes.push_back(
      "the points of the trajectory, which have no times, are checked as joined by straight edges; where a "
      "controller goes between them is not known");
}

Plan in_order_of(const Robot& robot, Plan plan) {
  const std::vector<std::string> own = joint_names(robot);
  if (own == plan.joints ||
      !std::is_permutation(own.begin(), own.end(), plan.joints.begin(), plan.joints.end()))
    return plan;
  std::vector<Eigen::Index> places;
  for (const std::string& name : own)
    places.push_back(std::find(plan.joints.begin(), plan.joints.end(), name) - plan.joints.begin());
  const auto reorder = [&](std::vector<Configuration>& list) {
    for (Configuration& q : list) q = Configuration(q(places));
  };
  if (plan.start.size() > 0) plan.start = Configuration(plan.start(places));
  reorder(plan.goals);
  for (PlanResult& leg : plan.legs) reorder(leg.waypoints);
  if (plan.motion)
    for (auto* list : {&plan.motion->motion.positions, &plan.motion->motion.velocities,
                       &plan.motion->motion.accelerations})
      reorder(*list);
  plan.joints = own;
  return plan;
}

}  // namespace clearway
