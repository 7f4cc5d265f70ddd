#include "datasets/descriptions/setup_blocks.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/sources/lens.hpp"
#include "datasets/yaml/moved_files.hpp"
#include "datasets/yaml/pose_numbers.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// Nine digits: more than any measurement has.
std::string digits(double value) { return short_text(std::abs(value) < 1e-15 ? 0.0 : value, 9); }

template <typename Numbers>
std::string flow_list(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "[" : ", ") + digits(number);
  return text + "]";
}

/// {key: value, …} of those that are known; empty for none.
std::string flow_map(const std::vector<std::pair<std::string, std::optional<double>>>& fields) {
  std::string text;
  for (const auto& [key, value] : fields)
    if (value) text += (text.empty() ? "{" : ", ") + key + ": " + digits(*value);
  return text.empty() ? text : text + "}";
}

std::string board_errors(const BoardErrorsSetup& e) {
  return flow_map({{"scale", e.scale}, {"size", e.size}, {"place", e.place}, {"turn", e.turn}});
}

std::string pose_list(const Eigen::Isometry3d& pose) { return flow_list(pose_numbers(pose)); }

}  // namespace

std::string camera_block(const CameraIntrinsics& c) {
  return "camera: {width: " + std::to_string(c.width) + ", height: " + std::to_string(c.height) +
         ", fx: " + digits(c.fx) + ", fy: " + digits(c.fy) + ", cx: " + digits(c.cx) +
         ", cy: " + digits(c.cy) + ",\n         " +
         (c.lens == LensModel::plumb_bob ? "" : "lens: " + lens_name(c.lens) + ", ") +
         "distortion: " + flow_list(coefficients_of(c)) + "}\n";
}

std::string errors_block(const ErrorsSetup& errors) {
  const CameraErrorsSetup& c = errors.camera;
  const std::string camera = flow_map(
      {{"focal", c.focal}, {"aspect", c.aspect}, {"center_px", c.center}, {"distortion_px", c.distortion}});
  const std::string boards = board_errors(errors.boards);
  std::string text = "errors:\n";
  if (!camera.empty()) text += "  camera: " + camera + "\n";
  if (!boards.empty()) text += "  boards: " + boards + "\n";
  if (errors.edge) text += "  edge_px: " + digits(*errors.edge) + "\n";
  return text;
}

std::string boards_block(const std::vector<BoardSetup>& boards) {
  std::string text = "boards:\n";
  for (const BoardSetup& board : boards) {
    text += "  - name: " + yaml_quoted(board.name) + "\n";
    if (board.map_from_board) text += "    map_from_board: " + pose_list(*board.map_from_board) + "\n";
    if (const std::string errors = board_errors(board.errors); !errors.empty())
      text += "    errors: " + errors + "\n";
    text += "    tags:\n";
    for (const TagSetup& tag : board.tags)
      text += "      - {id: " + std::to_string(tag.id) + ", size: " + digits(tag.size) +
              ", pose: " + pose_list(tag.board_from_tag) + "}\n";
  }
  return text;
}

std::string probe_block(const ProbeSetup& probe) {
  std::string text = "probe:\n  board: " + yaml_quoted(probe.board) + "\n  ball_center: " +
                     flow_list(std::vector<double>(probe.ball_center.begin(), probe.ball_center.end())) +
                     "\n  ball_radius: " + digits(probe.ball_radius) +
                     "\n  robot_error: " + digits(probe.robot_error) +
                     "\n  tracking_error: " + digits(probe.tracking_error) +
                     "\n  modelling_error: " + digits(probe.modelling_error) +
                     "\n  tracking: " + (probe.constant_tracking ? "constant" : "bound") + "\n";
  if (!probe.hand.empty()) text += "  hand:\n";
  for (const CapsuleSetup& hand : probe.hand)
    text += "    - {from: " + flow_list(std::vector<double>(hand.from.begin(), hand.from.end())) +
            ", to: " + flow_list(std::vector<double>(hand.to.begin(), hand.to.end())) +
            ", radius: " + digits(hand.radius) + "}\n";
  return text;
}

namespace {

template <typename Values, typename Text>
std::string named_list(const Values& values, const Text& text_of) {
  std::string text;
  for (const auto& [name, value] : values)
    text += (text.empty() ? "" : ", ") + yaml_quoted(name) + ": " + text_of(value);
  return "{" + text + "}\n";
}

std::string terms_lines(const RobotTermsSetup& terms) {
  std::string text;
  if (!terms.srdf.empty()) text += "  srdf: " + yaml_quoted(terms.srdf.string()) + "\n";
  if (!terms.group.empty()) text += "  group: " + yaml_quoted(terms.group) + "\n";
  if (!terms.fixed.empty())
    text += "  fixed: " + named_list(terms.fixed, [](double at) { return digits(at); });
  if (!terms.packages.empty())
    text += "  packages: " + named_list(terms.packages, [](const std::filesystem::path& folder) {
              return yaml_quoted(folder.string());
            });
  if (!terms.xacro.empty()) text += "  xacro: " + named_list(terms.xacro, yaml_quoted);
  return text;
}

}  // namespace

std::string robot_block(const RobotSetup& robot) {
  const std::vector<double> gravity(robot.gravity.begin(), robot.gravity.end());
  std::string text = "robot:\n  name: " + yaml_quoted(robot.name) +
                     "\n  base: " + pose_list(robot.map_from_base) + "\n  payload: " + digits(robot.payload) +
                     "\n  gravity: " + flow_list(gravity) + "\n  self_margin: " + digits(robot.self_margin) +
                     "\n  latency: " + digits(robot.latency) +
                     "\n  joint_error: " + digits(robot.joint_error) +
                     "\n  place_error: " + digits(robot.place_error) + "\n";
  if (robot.scale) text += "  scale: " + digits(*robot.scale) + "\n";
  text += terms_lines(robot.terms);
  if (!robot.joints.empty()) text += "  joints: " + flow_list(robot.joints) + "\n";
  if (!robot.joint_file.empty()) text += "  joint_file: " + yaml_quoted(robot.joint_file.string()) + "\n";
  if (!robot.joint_topic.empty()) text += "  joint_topic: " + yaml_quoted(robot.joint_topic) + "\n";
  if (!robot.joint_names.empty()) text += "  joint_names: " + named_list(robot.joint_names, yaml_quoted);
  if (!robot.joint_prefix.empty()) text += "  joint_prefix: " + yaml_quoted(robot.joint_prefix) + "\n";
  if (!robot.paints.empty()) {
    std::string parts;
    for (const std::string& part : robot.paints) parts += (parts.empty() ? "" : ", ") + yaml_quoted(part);
    text += "  paints: [" + parts + "]\n";
  }
  return text;
}

std::string sensors_block(const std::vector<SensorSetup>& sensors) {
  std::string text = "sensors:\n";
  for (const SensorSetup& sensor : sensors) {
    text += "  - {name: " + yaml_quoted(sensor.name);
    if (!sensor.poses.empty()) text += ", poses: " + yaml_quoted(sensor.poses.string());
    if (!sensor.board.empty()) text += ", board: " + yaml_quoted(sensor.board);
    if (!sensor.link.empty()) text += ", link: " + yaml_quoted(sensor.link);
    text += ", pose: " + pose_list(sensor.mount) + ", max_gap: " + digits(sensor.max_gap) + "}\n";
  }
  return text;
}

std::string with_block(const std::string& setup, const std::string& block) {
  const std::string key = block.substr(0, block.find(':') + 1);
  std::istringstream lines(setup);
  std::string text;
  bool is_inside = false, is_done = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_top = !line.empty() && line[0] != ' ' && line[0] != '\t' && line[0] != '#' &&
                        line[0] != '-' && line[0] != ']' && line[0] != '}' && line[0] != '\r';
    if (is_top && line[0] == '{')
      throw std::invalid_argument("the setup is one map in braces; expected its keys on lines of their own");
    if (is_top) is_inside = line.starts_with(key);
    if (is_inside && is_top) {
      text += block;
      is_done = true;
    }
    if (!is_inside || line.starts_with('#')) text += line + "\n";
  }
  return is_done ? text : text + (text.empty() ? "" : "\n") + block;
}

}  // namespace clearway
