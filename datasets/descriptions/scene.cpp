#include "datasets/descriptions/scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <stdexcept>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/descriptions/scene_sensing.hpp"
#include "datasets/descriptions/setup_tracking.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double default_start_time = 1577836800;  // 2020-01-01
constexpr Bounds grey_levels{0, 255};

/// A pose that looks from `eye` at `target`. `forward_axis` is the sensor's own axis that looks (0 = x with z
/// up, 2 = z with y down).
Eigen::Isometry3d read_look_at(const YamlFields& fields, int forward_axis) {
  const Eigen::Vector3d eye = fields.vector("eye"), target = fields.vector("target");
  const Eigen::Vector3d up = fields.has("up") ? fields.vector("up") : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(up.normalized());
  if (!(right.norm() > 1e-6)) fields.fail("target", "expected a point away from the eye, not along 'up'");
  const Eigen::Vector3d right_unit = right.normalized(), down = forward.cross(right_unit);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = eye;
  if (forward_axis == 2)
    pose.linear() << right_unit, down, forward;
  else
    pose.linear() << forward, -right_unit, -down;
  fields.finish();
  return pose;
}

/// @param or_else what else would do
Eigen::Isometry3d read_view(const YamlFields& fields, const std::string& key, int forward_axis,
                            const std::string& or_else = "") {
  if (fields.has("look_at") == fields.has_angles(key))
    fields.fail("look_at", "expected either '" + key + "' or 'look_at: {eye, target}'" + or_else);
  return fields.has("look_at") ? read_look_at(fields.map("look_at"), forward_axis) : fields.pose(key);
}

std::vector<SceneCamera::Waypoint> read_walk(const YamlFields& fields) {
  std::vector<SceneCamera::Waypoint> path;
  for (const auto& entry : fields.list_of_maps("path")) {
    const double time = entry.number("time", {0, 3600});
    if (!path.empty() && time <= path.back().time)
      entry.fail("time", "expected a time after the waypoint's before");
    path.push_back({time, read_view(entry, "map_from_camera", 2)});
    entry.finish();
  }
  return path;
}

SceneCamera read_scene_camera(const YamlFields& fields, uint64_t seed) {
  SceneCamera camera;
  camera.path = read_walk(fields);
  if (!camera.path.empty() && (fields.has("look_at") || fields.has_angles("map_from_camera")))
    fields.fail("path", "expected neither 'map_from_camera' nor 'look_at' beside it");
  if (camera.path.empty())
    camera.map_from_camera =
        read_view(fields, "map_from_camera", 2, ", or 'path' with one of them at each of its times");
  else
    camera.map_from_camera = camera.path.front().map_from_camera;
  camera.sway = read_shake(fields, "sway", camera.sway);
  camera.rate_hz = fields.number("rate_hz", {0.1, 1000}, camera.rate_hz);
  camera.noise_sigma = fields.number("noise_sigma", grey_levels, camera.noise_sigma);
  camera.blur_px = fields.number("blur_px", {0, 20}, camera.blur_px);
  camera.exposure = fields.number("exposure", {0, 1}, camera.exposure);
  read_picture_sensing(fields, seed, camera);
  fields.finish();
  return camera;
}

SceneDepth read_depth(const YamlFields& fields, uint64_t seed) {
  SceneDepth depth;
  depth.intrinsics = read_camera(fields.map("intrinsics"));
  for (const auto& entry : fields.list_of_maps("poses")) {
    depth.map_from_sensor.push_back(read_view(entry, "pose", 0));
    entry.finish();
  }
  if (depth.map_from_sensor.empty()) fields.fail("poses", "expected at least one pose");
  depth.noise_constant = fields.number("noise_constant", {0, 10}, depth.noise_constant);
  depth.noise_quadratic = fields.number("noise_quadratic", {0, 10}, depth.noise_quadratic);
  depth.dropout = fields.number("dropout", {0, 1}, depth.dropout);
  depth.max_range = fields.number("max_range", above_zero, depth.max_range);
  depth.unit = fields.number("unit", {1e-6, 1}, depth.unit);
  if (depth.max_range > 65534 * depth.unit)
    fields.fail("unit", "expected at least max_range / 65534, because ranges are stored in 16 bits");
  depth.beside_pictures = fields.has("beside_pictures") && fields.boolean("beside_pictures");
  if (depth.beside_pictures && fields.has("passes"))
    fields.fail("passes", "expected it or 'beside_pictures', which makes as many as there is time");
  depth.passes = static_cast<size_t>(fields.integer("passes", {1, 1000}, 1));
  depth.interval = fields.number("interval", {1e-3, 1e3}, depth.interval);
  read_sensing(fields, seed, depth);
  fields.finish();
  return depth;
}

/// All waypoints have a time, which rises, or none has.
double read_time(const YamlFields& entry, const SceneStroke& stroke) {
  const bool is_first = stroke.waypoints.empty();
  const double time = entry.number("time", {0, 3600});
  if (!is_first && time <= stroke.waypoints.back().time)
    entry.fail("time", "expected a time after the waypoint's before");
  return time;
}

SceneStroke read_stroke(const YamlFields& fields, uint64_t seed) {
  SceneStroke stroke;
  stroke.speed = fields.optional_number("speed", {1e-4, 100});
  stroke.duration = fields.optional_number("duration", {1e-3, 3600});
  const Eigen::Matrix3d usual =
      fields.has_angles("orientation") ? fields.rotation("orientation") : Eigen::Matrix3d::Identity();
  bool is_timed = false;
  for (const auto& entry : fields.list_of_maps("waypoints")) {
    const Eigen::Vector3d ball = entry.vector("ball");
    const Eigen::Matrix3d turn = entry.has_angles("orientation") ? entry.rotation("orientation") : usual;
    is_timed = stroke.waypoints.empty() ? entry.has("time") : is_timed;
    if (is_timed != entry.has("time")) entry.fail("time", "expected a time of every waypoint, or of none");
    const double time = is_timed ? read_time(entry, stroke) : 0.0;
    if (!is_timed && !stroke.waypoints.empty() && (stroke.waypoints.back().ball - ball).norm() < 1e-6)
      entry.fail("ball", "expected a point away from the waypoint before");
    stroke.waypoints.push_back({ball, Eigen::Quaterniond(turn), time});
    entry.finish();
  }
  if (stroke.waypoints.size() < 2) fields.fail("waypoints", "expected at least two");
  if (int(stroke.speed.has_value()) + int(stroke.duration.has_value()) + int(is_timed) != 1)
    fields.fail("speed", "expected either speed or duration, or times of the waypoints");
  read_tremor(fields, seed, stroke);
  fields.finish();
  return stroke;
}

SceneGripper read_gripper_motion(const YamlFields& fields) {
  SceneGripper gripper;
  for (const auto& entry : fields.list_of_maps("waypoints")) {
    const double time = entry.number("time", {0, 3600});
    if (!gripper.waypoints.empty() && time <= gripper.waypoints.back().time)
      entry.fail("time", "expected a time after the waypoint's before");
    gripper.waypoints.push_back({time, entry.pose("tip", Eigen::Isometry3d::Identity())});
    entry.finish();
  }
  if (gripper.waypoints.empty()) fields.fail("waypoints", "expected at least one");
  fields.finish();
  return gripper;
}

std::filesystem::path expanded(std::string path, const std::filesystem::path& folder) {
  const std::string variable = "${MRPT_DATASETS}";
  if (const auto at = path.find(variable); at != std::string::npos) {
    const char* given = std::getenv("CLEARWAY_MRPT_DATASETS");
    path.replace(at, variable.size(), given ? given : "/usr/share/mrpt/datasets");
  }
  return folder / path;  // an absolute path stays as it is
}

SceneInclude read_include(const YamlFields& fields, const std::filesystem::path& folder) {
  SceneInclude include;
  include.recording = expanded(fields.file("recording"), folder);
  include.world_from_map = fields.pose("world_from_map", include.world_from_map);
  include.sensors = fields.texts("sensors");
  fields.finish();
  return include;
}

/// A picture takes 13 bytes for a pixel and thread while it is drawn; the truth about it stays in memory.
void require_size(const YamlFields& fields, const std::string& key, const CameraIntrinsics& camera) {
  constexpr double most_pixels = 8e6;
  if (static_cast<double>(camera.width) * camera.height > most_pixels)
    fields.fail(key, "expected pictures of at most 8,000,000 pixels, got " + std::to_string(camera.width) +
                         " x " + std::to_string(camera.height));
}

void check_sizes(const YamlFields& fields, const Scene& scene) {
  constexpr size_t most_waypoints = 10'000;
  constexpr double most_pictures = 1e5;
  if (scene.depth) require_size(fields, "depth", scene.depth->intrinsics);
  if (!scene.camera) return;
  require_size(fields, "camera", *scene.setup.camera);
  if (scene.stroke->waypoints.size() > most_waypoints)
    fields.fail("stroke",
                "expected at most 10,000 waypoints, got " + std::to_string(scene.stroke->waypoints.size()));
  const double pictures = duration_of_pictures(scene) * scene.camera->rate_hz;
  if (!(pictures <= most_pictures))
    fields.fail("stroke", "expected at most 100,000 pictures at " + std::to_string(scene.camera->rate_hz) +
                              " Hz, got " + std::to_string(pictures));
}

/// A setup that states no errors is taken as exact, which a scene must not make false.
void check_stated_errors(const YamlFields& fields, const Scene& scene) {
  if (!scene.camera || !scene.camera->errors.has_wrong_setup()) return;
  const CameraErrorsSetup& camera = scene.setup.errors.camera;
  const bool is_stated =
      camera.focal && camera.center && camera.distortion &&
      std::all_of(scene.setup.boards.begin(), scene.setup.boards.end(), [](const BoardSetup& board) {
        return board.errors.scale && board.errors.size && board.errors.place && board.errors.turn;
      });
  if (!is_stated)
    fields.fail("setup",
                "expected a setup that states all `errors` of camera and boards, because the scene's camera "
                "or boards are not what the setup says");
}

void check_parts_fit(const YamlFields& fields, const Scene& scene) {
  if (scene.hands && !scene.camera) fields.fail("hands", "expected a camera that sees them");
  if (scene.depth && scene.depth->beside_pictures && !scene.camera)
    fields.fail("depth", "expected a camera for 'beside_pictures'");
  if (scene.camera.has_value() != scene.stroke.has_value())
    fields.fail("camera", "expected camera and stroke together, or neither");
  if (scene.camera && !scene.setup.camera) fields.fail("setup", "expected a setup with a camera");
  if (scene.camera && !scene.setup.probe) fields.fail("setup", "expected a setup with a probe");
  if (scene.camera && scene.setup.board(scene.setup.probe->board)->map_from_board)
    fields.fail("setup", "expected the probe's board to have no map_from_board");
  if (scene.gripper && !scene.camera) fields.fail("gripper", "expected a camera that sees it");
  if (scene.gripper && !scene.setup.gripper) fields.fail("setup", "expected a setup with a gripper");
  std::set<std::string> names;
  for (const auto& shape : scene.shapes)
    if (!names.insert(shape.name).second)
      fields.fail("shapes", "expected each name once, '" + shape.name + "' is given twice");
}

}  // namespace

Eigen::Isometry3d pose_between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double share) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::Quaterniond(from.linear()).slerp(share, Eigen::Quaterniond(to.linear())).toRotationMatrix();
  pose.translation() = (1.0 - share) * from.translation() + share * to.translation();
  return pose;
}

std::optional<Eigen::Isometry3d> SceneGripper::at(double time) const {
  if (time < waypoints.front().time || time > waypoints.back().time) return std::nullopt;
  const auto after = std::find_if(waypoints.begin(), waypoints.end(),
                                  [&](const Waypoint& waypoint) { return waypoint.time >= time; });
  if (after->time == time) return after->map_from_tip;
  const Waypoint &from = *(after - 1), &to = *after;
  return pose_between(from.map_from_tip, to.map_from_tip, (time - from.time) / (to.time - from.time));
}

double duration_of_pictures(const Scene& scene) {
  const double stroke = scene.stroke ? ProbeMotion(*scene.stroke, *scene.setup.probe).duration() : 0.0;
  return std::max(stroke, scene.gripper ? scene.gripper->waypoints.back().time : 0.0);
}

SceneShape read_scene_shape(const YamlFields& fields) {
  SceneShape shape;
  shape.name = fields.text("name");
  const int kinds = fields.has("box") + fields.has("cylinder") + fields.has("sphere");
  if (kinds != 1) fields.fail("name", "expected exactly one of box, cylinder and sphere beside it");
  if (fields.has("box")) {
    shape.geometry = BoxShape{Eigen::Vector3d(fields.numbers("box", above_zero, 3).data())};
  } else if (fields.has("cylinder")) {
    const auto values = fields.numbers("cylinder", above_zero, 2);
    shape.geometry = CylinderShape{values[0], values[1]};
  } else {
    shape.geometry = SphereShape{fields.number("sphere", above_zero)};
  }
  shape.map_from_shape = fields.pose("pose", shape.map_from_shape);
  shape.grey = fields.number("grey", grey_levels, shape.grey);
  fields.finish();
  return shape;
}

Scene parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& folder) {
  const YamlFields fields(text, "scene " + quote_path(name));
  Scene scene;
  scene.name = name;
  const auto setup_file = expanded(fields.file("setup"), folder);
  const std::string kind = extension_of(setup_file);
  if (kind != ".yaml" && kind != ".yml")
    fields.fail("setup", "expected the name of a .yaml file, got " + quote(fields.file("setup")));
  scene.setup_text = read_text(setup_file, "setup");
  scene.setup = parse_setup(scene.setup_text, setup_file.string());
  if (scene.setup.detector.family != "tag36h11")
    throw std::invalid_argument(quote_path(setup_file.string()) +
                                ", detector.families: expected [tag36h11], whose tags are rendered");
  for (const auto& entry : fields.list_of_maps("shapes")) scene.shapes.push_back(read_scene_shape(entry));
  scene.seed = fields.seed("seed", 1);
  if (fields.has("camera")) scene.camera = read_scene_camera(fields.map("camera"), scene.seed);
  if (fields.has("stroke")) scene.stroke = read_stroke(fields.map("stroke"), scene.seed);
  if (fields.has("hands")) scene.hands = read_hands(fields.map("hands"), scene.setup);
  if (fields.has("gripper")) scene.gripper = read_gripper_motion(fields.map("gripper"));
  for (const auto& entry : fields.list_of_maps("include"))
    scene.includes.push_back(read_include(entry, folder));
  if (fields.has("depth")) scene.depth = read_depth(fields.map("depth"), scene.seed);
  scene.start_time = fields.number("start_time", {0, 1e10}, default_start_time);
  scene.background = fields.number("background", grey_levels, scene.background);
  check_parts_fit(fields, scene);
  check_sizes(fields, scene);
  check_stated_errors(fields, scene);
  if (scene.depth && scene.depth->beside_pictures)
    scene.depth->images_beside =
        static_cast<size_t>(duration_of_pictures(scene) / scene.depth->interval + 1e-9) + 1;
  fields.finish();
  return scene;
}

Scene load_scene(const std::filesystem::path& file) {
  return parse_scene(read_text(file, "scene"), file.string(), file.parent_path());
}

}  // namespace clearway
