#include "planning/files/trajectory_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/csv_field.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/load_json.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {
namespace {

constexpr std::size_t ur_joints = 6;

/// Never an integer, never an exponent: YAML 1.1 readers take 1e-05 for a word.
std::string decimal(double value) {
  char buffer[512];
  std::string text(buffer,
                   std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed).ptr);
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

std::string list(const Configuration& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + decimal(value);
  return "[" + text + "]";
}

/// A name in double quotes, line breaks and control characters escaped; YAML reads JSON's quotes.
std::string quoted(const std::string& name) {
  return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A line of comment for each event.
std::string events_text(const Trajectory& trajectory) {
  std::string text;
  for (const TrajectoryEvent& event : trajectory.events)
    text += "# at " + to_text(event.time) + " s: " + std::string(to_string(event.kind)) + " " +
            quoted(event.load) + ", at rest for " + to_text(event.rest) + " s\n";
  return text;
}

/// Loads that ride from the first point to the last: no event says so.
std::vector<LegLoad> carried_throughout(const Plan& plan, const Trajectory& trajectory) {
  std::vector<LegLoad> loads;
  for (const LegLoad& load : plan.loads)
    if (std::none_of(trajectory.events.begin(), trajectory.events.end(),
                     [&](const TrajectoryEvent& event) { return event.load == load.load.name; }))
      loads.push_back({load.load, {}});
  return loads;
}

/// Another than the usual one, which whoever reads the file takes unless it says more.
bool has_own_gravity(const Plan& plan) { return plan.gravity != Plan().gravity; }

/// What the motion was proved for beside its joints: where the base is, those that stand still, and what
/// rides.
std::string standing_text(const Plan& plan, const Trajectory& trajectory) {
  const Eigen::Vector3d& at = plan.map_from_base.translation();
  const Eigen::Quaterniond turn(plan.map_from_base.linear());
  std::string text = "\n# base: at " + to_text(at.x()) + ", " + to_text(at.y()) + ", " + to_text(at.z()) +
                     " m, quaternion x y z w " + to_text(turn.x()) + ", " + to_text(turn.y()) + ", " +
                     to_text(turn.z()) + ", " + to_text(turn.w());
  if (!plan.group.empty()) text += "\n# group: " + quoted(plan.group);
  for (const auto& [joint, value] : plan.held) text += "\n# held: " + quoted(joint) + " at " + to_text(value);
  if (const auto loads = carried_throughout(plan, trajectory); !loads.empty())
    text += "\n# carries: " +
            json_of(loads).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (plan.payload > 0.0) text += "\n# payload: " + to_text(plan.payload);
  if (has_own_gravity(plan))
    text += "\n# gravity: " + to_text(plan.gravity.x()) + ", " + to_text(plan.gravity.y()) + ", " +
            to_text(plan.gravity.z());
  return text;
}

std::string heading(const Plan& plan, const Trajectory& trajectory) {
  return "# robot: " + quoted(plan.robot) + ", scale " + to_text(plan.robot_scale) +
         standing_text(plan, trajectory) + "\n# planner: " + quoted(plan.planner) + ", seed " +
         std::to_string(plan.seed) + "\n# map: " + quoted(plan.map_file) + ", sha256 " +
         quoted(plan.map_sha256) + "\n# points: " + std::to_string(trajectory.points.size()) +
         ", one every " + to_text(trajectory.sampling_period) + " s\n" + events_text(trajectory);
}

std::string no_refusal(const Robot&) { return {}; }

std::string write_ros(const Robot& robot, const Plan& plan, const Trajectory& trajectory) {
  std::string text = "# trajectory_msgs/JointTrajectory\n" + heading(plan, trajectory);
  text += "header:\n  frame_id: " + quoted(robot.links.front().name) + "\njoint_names:\n";
  for (const Joint& joint : robot.joints) text += "  - " + quoted(joint.name) + "\n";
  text += "points:\n";
  for (const TrajectoryPoint& point : trajectory.points) {
    const long long nanoseconds = std::llround(point.time * 1e9);
    text += "  - positions: " + list(point.position) + "\n    velocities: " + list(point.velocity) +
            (point.acceleration.size() > 0 ? "\n    accelerations: " + list(point.acceleration) : "") +
            "\n    time_from_start: {sec: " + std::to_string(nanoseconds / 1'000'000'000) +
            ", nanosec: " + std::to_string(nanoseconds % 1'000'000'000) + "}\n";
  }
  return text;
}

nlohmann::ordered_json time_json(double time) {
  const long long nanoseconds = std::llround(time * 1e9);
  return {{"sec", nanoseconds / 1'000'000'000}, {"nanosec", nanoseconds % 1'000'000'000}};
}

std::string text_of(const nlohmann::ordered_json& json) {
  return json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string write_ros_json(const Robot& robot, const Plan&, const Trajectory& trajectory) {
  nlohmann::ordered_json json = {
      {"header", {{"stamp", time_json(0.0)}, {"frame_id", robot.links.front().name}}},
      {"joint_names", joint_names(robot)}};
  json["points"] = nlohmann::ordered_json::array();
  for (const TrajectoryPoint& point : trajectory.points)
    json["points"].push_back({{"positions", json_of(point.position)},
                              {"velocities", json_of(point.velocity)},
                              {"accelerations", json_of(point.acceleration)},
                              {"effort", nlohmann::ordered_json::array()},
                              {"time_from_start", time_json(point.time)}});
  return text_of(json);
}

std::string write_json(const Robot& robot, const Plan& plan, const Trajectory& trajectory) {
  nlohmann::ordered_json json = {{"robot", plan.robot},
                                 {"scale", plan.robot_scale},
                                 {"planner", plan.planner},
                                 {"seed", plan.seed},
                                 {"map", {{"file", plan.map_file}, {"sha256", plan.map_sha256}}},
                                 {"joints", joint_names(robot)},
                                 {"period_s", trajectory.sampling_period}};
  const Eigen::Vector3d& at = plan.map_from_base.translation();
  const Eigen::Quaterniond turn(plan.map_from_base.linear());
  json["base"] = {{"position_m", {at.x(), at.y(), at.z()}},
                  {"quaternion_xyzw", {turn.x(), turn.y(), turn.z(), turn.w()}}};
  if (!plan.group.empty()) json["group"] = plan.group;
  if (!plan.held.empty()) json["held"] = plan.held;
  if (const auto loads = carried_throughout(plan, trajectory); !loads.empty()) json["loads"] = json_of(loads);
  if (plan.payload > 0.0) json["payload_kg"] = plan.payload;
  if (has_own_gravity(plan)) json["gravity"] = {plan.gravity.x(), plan.gravity.y(), plan.gravity.z()};
  for (const char* name : {"times_s", "positions", "velocities", "accelerations"})
    json[name] = nlohmann::ordered_json::array();
  for (const TrajectoryPoint& point : trajectory.points) {
    json["times_s"].push_back(point.time);
    json["positions"].push_back(json_of(point.position));
    json["velocities"].push_back(json_of(point.velocity));
    json["accelerations"].push_back(json_of(point.acceleration));
  }
  for (const TrajectoryEvent& event : trajectory.events)
    json["events"].push_back({{"time_s", event.time},
                              {"action", to_string(event.kind)},
                              {"load", event.load},
                              {"rest_s", event.rest}});
  return text_of(json);
}

std::string write_csv(const Robot& robot, const Plan&, const Trajectory& trajectory) {
  std::string text = "time_s";
  for (const char* what : {"", " velocity", " acceleration"}) {
    const bool has_accelerations =
        !trajectory.points.empty() && trajectory.points.front().acceleration.size() > 0;
    if (*what == ' ' && what[1] == 'a' && !has_accelerations) break;
    for (const Joint& joint : robot.joints) text += "," + csv_field(joint.name + what);
  }
  if (!trajectory.events.empty()) text += ",event";
  auto event = trajectory.events.begin();
  for (const TrajectoryPoint& point : trajectory.points) {
    text += "\n" + to_text(point.time);
    for (const auto* values : {&point.position, &point.velocity, &point.acceleration})
      for (const double value : *values) text += "," + to_text(value);
    if (trajectory.events.empty()) continue;
    std::string happens;
    for (; event != trajectory.events.end() && event->time <= point.time; ++event)
      happens += (happens.empty() ? "" : "; ") + std::string(to_string(event->kind)) + " " + event->load;
    text += "," + csv_field(happens);
  }
  return text + "\n";
}

std::string urscript_refusal(const Robot& robot) {
  std::size_t revolute = 0;
  for (const Joint& joint : robot.joints) revolute += joint.kind == JointKind::revolute ? 1 : 0;
  if (robot.dof() == ur_joints && revolute == ur_joints) return {};
  return "urscript drives six revolute joints, robot '" + robot.name + "' has " +
         counted(robot.dof(), "joint") + ", " + std::to_string(revolute) + " of them revolute";
}

/// What the program calls where the hand has something to do; whoever has a gripper writes it in there.
std::string urscript_events(const Trajectory& trajectory) {
  std::string text;
  for (const auto kind : {TrajectoryEvent::Kind::attach, TrajectoryEvent::Kind::detach})
    for (const TrajectoryEvent& event : trajectory.events) {
      if (event.kind != kind) continue;
      const std::string word(to_string(kind));
      text += "  def " + word + "(load):\n    # " +
              (kind == TrajectoryEvent::Kind::attach ? "Close" : "Open") +
              " the gripper here: the arm is at rest.\n    textmsg(\"" + word + " \", load)\n    sleep(" +
              decimal(event.rest) + ")\n  end\n";
      break;
    }
  return text;
}

/// Functions of the program: whether the arm is somewhere, and how it comes to rest there.
std::string urscript_stops(const std::string& timing, const std::string& period) {
  return "  def is_at(target, tolerance):\n"
         "    local actual = get_actual_joint_positions()\n"
         "    local joint = 0\n"
         "    while joint < 6:\n"
         "      if norm(actual[joint] - target[joint]) > tolerance:\n"
         "        return False\n"
         "      end\n"
         "      joint = joint + 1\n"
         "    end\n"
         "    return True\n"
         "  end\n"
         "  def require_at(target, message):\n"
         "    if not is_at(target, 0.01):\n"
         "      popup(message, title=\"Clearway\", error=True, blocking=True)\n"
         "      halt\n"
         "    end\n"
         "  end\n"
         "  def come_to_rest(target):\n"
         "    # servoj lags behind: holds the arm at the target until it has caught up, at most 2 s.\n"
         "    local left = 2.0\n"
         "    while left > 0.0 and not is_at(target, 0.001):\n"
         "      servoj(target" +
         timing + "      left = left - " + period +
         "\n"
         "    end\n"
         "    stopj(5.0)\n"
         "    require_at(target, \"The arm has not come to where the path stops.\")\n"
         "  end\n";
}

bool is_at_rest(const TrajectoryPoint& point) {
  constexpr double still = 1e-9;  // rad/s: what rounding leaves
  return point.velocity.cwiseAbs().maxCoeff() <= still;
}

std::string write_urscript(const Robot& robot, const Plan& plan, const Trajectory& trajectory) {
  std::string joints;
  for (const Joint& joint : robot.joints) joints += (joints.empty() ? "" : ", ") + quoted(joint.name);
  const std::string timing =
      ", t=" + decimal(trajectory.sampling_period) + ", lookahead_time=0.03, gain=300)\n";
  std::string text =
      heading(plan, trajectory) + "# joints, base first: " + joints + "\ndef clearway_path():\n" +
      urscript_stops(timing, decimal(trajectory.sampling_period)) + urscript_events(trajectory) +
      "  # The way to the start of the path is not checked.\n"
      "  require_at(" +
      list(trajectory.points.front().position) + ", \"The arm is not at the start of the path.\")\n";
  auto event = trajectory.events.begin();
  double rests_until = -1.0;
  bool has_moved = false;  // since the start, or since it last came to rest
  for (std::size_t k = 0; k < trajectory.points.size(); ++k) {
    const TrajectoryPoint& point = trajectory.points[k];
    if (point.time > rests_until) text += "  servoj(" + list(point.position) + timing;
    for (; event != trajectory.events.end() && event->time <= point.time; ++event) {
      if (event->time > rests_until + 1e-9) text += "  come_to_rest(" + list(point.position) + ")\n";
      text += "  " + std::string(to_string(event->kind)) + "(" + quoted(event->load) + ")\n";
      rests_until = event->time + event->rest;
      has_moved = false;
    }
    const bool goes_on = k + 1 < trajectory.points.size() && !is_at_rest(trajectory.points[k + 1]);
    if (has_moved && goes_on && is_at_rest(point)) {
      text += "  come_to_rest(" + list(point.position) + ")\n";
      has_moved = false;
    }
    if (!is_at_rest(point)) has_moved = true;
  }
  return text + "  come_to_rest(" + list(trajectory.points.back().position) + ")\nend\n";
}

}  // namespace

const std::vector<TrajectoryFormat>& trajectory_formats() {
  static const std::vector<TrajectoryFormat> table = {
      {"ros", "YAML of a trajectory_msgs/JointTrajectory", no_refusal, write_ros},
      {"ros-json", "the same message as JSON", no_refusal, write_ros_json},
      {"urscript", "a URScript program that streams with servoj", urscript_refusal, write_urscript},
      {"json", "arrays of times, positions, velocities and accelerations", no_refusal, write_json},
      {"csv", "the same as a table, one line for each time", no_refusal, write_csv},
  };
  return table;
}

const TrajectoryFormat& trajectory_format(std::string_view name, const Robot& robot) {
  std::vector<std::string> names;
  for (const TrajectoryFormat& format : trajectory_formats()) {
    names.emplace_back(format.name);
    if (format.name != name) continue;
    const std::string refusal = format.refusal(robot);
    if (!refusal.empty()) throw std::invalid_argument("trajectory: " + refusal);
    return format;
  }
  throw std::invalid_argument("trajectory: unknown format " + quote(name) + "; " + suggestion(name, names));
}

}  // namespace clearway
