#include "apps/check/trajectory_file.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "apps/check/trajectory_entries.hpp"
#include "apps/console/parse.hpp"
#include "apps/problem_sets/scene_fields.hpp"
#include "datasets/yaml/message_keys.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr Bounds any_value{-1e6, 1e6};

/// A long trajectory is millions of short numbers: as many as fill the largest file that is read, for which
/// yaml-cpp takes some 4 GB.
const YamlBounds dense_numbers{.nodes = 8'000'000,
                               .advice = "; expected fewer points, as of a longer --period"};

/// What holds a trajectory and, beside it, where the robot is before: of actions and services of ROS and
/// MoveIt the field with the message.
YamlFields unwrapped(const YamlFields& root) {
  for (const char* key : {"goal", "result", "motion_plan_response"})
    if (root.is_map(key)) return unwrapped(root.map(key));
  constexpr double success = 1.0;  // moveit_msgs/MoveItErrorCodes
  if (root.is_map("error_code") && root.map("error_code").has("val") &&
      root.map("error_code").number("val", any_value) != success)
    root.map("error_code").fail("val", "expected 1: there is no trajectory where planning failed");
  return root;
}

/// The maps that hold `joint_names`.
std::vector<YamlFields> innermost(const YamlFields& root) {
  if (root.has("joint_names") && root.has("joint_trajectory"))
    root.fail("joint_trajectory", "expected it or 'joint_names', got both");
  if (root.has("joint_names")) return {root};
  if (root.has("multi_dof_joint_trajectory") &&
      !root.map("multi_dof_joint_trajectory").list_of_maps("points").empty())
    root.fail("multi_dof_joint_trajectory", "expected no points: the robot's base stands still");
  if (root.has("joint_trajectory")) return {root.map("joint_trajectory")};
  for (const char* key : {"planned_trajectory", "trajectory"})
    if (root.is_map(key)) return innermost(root.map(key));
  std::vector<YamlFields> found;
  if (!root.has("trajectory")) return found;
  for (const YamlFields& entry : root.list_of_maps("trajectory")) {
    const std::vector<YamlFields> inner = innermost(entry);
    if (inner.size() != 1) entry.fail("joint_trajectory", "expected the one trajectory of this entry");
    found.push_back(inner.front());
  }
  if (found.empty()) root.fail("trajectory", "expected at least one");
  return found;
}

/// Where the robot's base is before the trajectory, and stays, if the file says it: the pose of the virtual
/// joint that holds it. The map's origin is what planners say that know of no other place.
std::optional<Eigen::Isometry3d> base_of(const YamlFields& root) {
  if (!root.has("trajectory_start") || !root.map("trajectory_start").has("multi_dof_joint_state"))
    return std::nullopt;
  std::optional<Eigen::Isometry3d> base;
  const YamlFields state = root.map("trajectory_start").map("multi_dof_joint_state");
  require_no_lost_keys(state, RosMessage::multi_dof_joint_state);
  for (const YamlFields& transform : state.list_of_maps("transforms")) {
    const Eigen::Isometry3d pose = ros_transform(transform);
    if (pose.isApprox(Eigen::Isometry3d::Identity(), 1e-9)) continue;
    if (base) state.fail("transforms", "expected at most one that is not the identity: the robot's base");
    base = pose;
  }
  return base;
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

/// Seconds, as ROS 2 (sec, nanosec), ROS 1 (secs, nsecs) and bridges between them (sec, nsec) write them, or
/// a number of seconds, as Robowflex does.
double time_of(const YamlFields& point) {
  if (!point.is_map("time_from_start")) return point.number("time_from_start", {0.0, 1e9});
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
    point.fail(key, "expected none or " + counted(joints, "number") + ", one for each joint, got " +
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
                       counted(count, "point"));
  return rates;
}

/// What `plan --export json` writes: a list for each quantity.
ForeignTrajectory own_export(const YamlFields& root, const std::string& text,
                             const std::filesystem::path& file) {
  if (root.has("events")) root.fail("events", expected_no_events);
  ForeignTrajectory trajectory;
  trajectory.stated = stated_in_json(root, text, file);
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

ForeignTrajectory trajectory_of(const YamlFields& found) {
  ForeignTrajectory trajectory;
  trajectory.joints = found.texts("joint_names");
  if (trajectory.joints.empty()) found.fail("joint_names", "expected at least one");
  if (std::set<std::string>(trajectory.joints.begin(), trajectory.joints.end()).size() !=
      trajectory.joints.size())
    found.fail("joint_names", "expected each name once");
  const std::vector<YamlFields> points = found.list_of_maps("points");
  for (const YamlFields& point : points)
    trajectory.points.push_back(point.numbers("positions", any_value, trajectory.joints.size()));
  if (trajectory.points.empty()) found.fail("points", "expected at least one");
  read_times(points, trajectory);
  return trajectory;
}

}  // namespace

std::vector<ForeignTrajectory> read_trajectories(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  if (kind == ".csv" || kind == ".script" || kind == ".urscript")
    throw std::invalid_argument(
        file.string() + ": " +
        (kind == ".csv" ? "a trajectory as CSV is for spreadsheets" : "a program is for its controller") +
        ", expected a plan's JSON, or a trajectory as --trajectory ros, ros-json or "
        "json writes it");
  const bool is_yaml = kind == ".yaml" || kind == ".yml";
  if (!is_yaml && kind != ".json") return {};
  const std::string text = read_input(file, "plan file", 64U << 20U);
  const bool is_own = !is_yaml && text.find("\"times_s\"") != std::string::npos &&
                      text.find("\"joints\"") != std::string::npos &&
                      text.find("\"legs\"") == std::string::npos;
  if (!is_yaml && !is_own && text.find("\"joint_names\"") == std::string::npos) return {};
  const YamlFields whole(text, "trajectory " + quote_path(file.string()), dense_numbers);
  if (is_own) return {own_export(whole, text, file)};
  const YamlFields root = unwrapped(whole);
  std::vector<ForeignTrajectory> entries;
  for (const YamlFields& found : innermost(root)) entries.push_back(trajectory_of(found));
  if (entries.empty()) root.fail("joint_names", "expected the names of a JointTrajectory");
  if (is_yaml) entries.front().stated = stated_in_comments(text, file);
  entries.front().start = entries.front().stated_start = start_of(root);
  entries.front().map_from_base = base_of(root);
  if (!root.is_map("model_id") && !root.is_list("model_id"))
    entries.front().model = root.prose("model_id", "");
  join_entries(entries, file);
  return entries;
}

}  // namespace clearway
