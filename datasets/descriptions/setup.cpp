#include "datasets/descriptions/setup.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

#include "datasets/descriptions/query_fields.hpp"
#include "datasets/descriptions/setup_tracking.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double half_turn = 3.1416;  ///< rad, with what a person rounds

MapSetup read_map(const YamlFields& fields) {
  MapSetup map;
  map.resolution = fields.optional_number("resolution", {1e-4, 100});
  map.max_range = fields.optional_number("max_range", above_zero);
  map.min_range = fields.optional_number("min_range", not_negative);
  map.thin_to = fields.number("thin_to", not_negative, 0);
  if (fields.has("outliers")) {
    const YamlFields outliers = fields.map("outliers");
    map.outliers.emplace();
    map.outliers->neighbours = outliers.integer("neighbours", {1, 1000}, map.outliers->neighbours);
    map.outliers->deviations = outliers.number("deviations", not_negative, map.outliers->deviations);
    outliers.finish();
  }
  if (fields.has("discretize")) map.discretize = fields.boolean("discretize");
  if (fields.has("integration")) {
    map.integration = fields.text("integration");
    if (map.integration != "safe" && map.integration != "compatible")
      fields.fail("integration", "expected safe or compatible");
  }
  map.safe_band = fields.optional_number("safe_band", {0, 100});
  if (fields.has("crop")) {
    const auto values = fields.numbers("crop", within_reach, 6);
    map.crop.emplace(Eigen::Vector3d(values.data()), Eigen::Vector3d(values.data() + 3));
    if ((map.crop->sizes().array() <= 0).any())
      fields.fail("crop", "expected [xmin, ymin, zmin, xmax, ymax, zmax] with each min below its max");
  }
  // A scan takes some bytes for each voxel that its rays pass.
  constexpr double most_voxels = 10'000;
  if (map.resolution && map.max_range && *map.max_range / *map.resolution > most_voxels)
    fields.fail("max_range", "expected at most 10,000 voxels of 'resolution', got " +
                                 std::to_string(*map.max_range / *map.resolution));
  fields.finish();
  return map;
}

SensorSetup read_sensor(const YamlFields& fields, const Setup& setup, const std::filesystem::path& folder) {
  SensorSetup sensor;
  sensor.name = fields.text("name");
  sensor.mount = fields.pose("pose", sensor.mount);
  if (fields.has("poses")) sensor.poses = folder / fields.file("poses");
  sensor.board = fields.text("board", "");
  if (!sensor.board.empty()) {
    if (!setup.board(sensor.board))
      fields.fail("board", "expected the name of one of the boards, got '" + sensor.board + "'");
    if (setup.board(sensor.board)->map_from_board)
      fields.fail("board", "expected a board that moves; give the sensor's fixed place as its pose");
    if (!sensor.poses.empty()) fields.fail("poses", "expected either a board or a file of poses");
  }
  sensor.link = fields.text("link", "");
  if (!sensor.link.empty() && !(sensor.board.empty() && sensor.poses.empty()))
    fields.fail("link", "expected one of 'link', 'board' and 'poses'");
  sensor.max_gap = fields.number("max_gap", above_zero, sensor.max_gap);
  fields.finish();
  return sensor;
}

std::vector<SensorSetup> read_sensors(const YamlFields& fields, const Setup& setup,
                                      const std::filesystem::path& folder) {
  std::vector<SensorSetup> sensors;
  std::set<std::string> names;
  for (const auto& entry : fields.list_of_maps("sensors")) {
    sensors.push_back(read_sensor(entry, setup, folder));
    if (!names.insert(sensors.back().name).second) entry.fail("name", "this sensor is given twice");
  }
  return sensors;
}

/// Whether a file's first line with something in it has 12 numbers: KITTI's poses, which have no times.
bool has_numbered_poses(const std::filesystem::path& file) {
  if (!is_input_there(file)) return false;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    line.resize(std::min(line.find('#'), line.size()));
    std::istringstream words(line);
    const auto count = std::distance(std::istream_iterator<std::string>(words), {});
    if (count > 0) return count == 12;
  }
  return false;
}

/// Poses without times belong to scans by their numbers, and so to the source.
void take_numbered_poses(const YamlFields& fields, Setup& setup) {
  std::erase_if(setup.sensors, [&](const SensorSetup& sensor) {
    if (sensor.poses.empty() || !has_numbered_poses(sensor.poses)) return false;
    const bool is_depth = sensor.name == "depth";
    const std::filesystem::path& other = is_depth ? setup.source.depth.poses : setup.source.numbered_poses;
    if (!other.empty() || !sensor.mount.isApprox(Eigen::Isometry3d::Identity(), 1e-12))
      fields.fail("sensors", "sensor " + quote(sensor.name) +
                                 " has poses of 12 numbers a line, which are its own: expected one such file "
                                 "and no `pose` beside it");
    (is_depth ? setup.source.depth.poses : setup.source.numbered_poses) = sensor.poses;
    return true;
  });
}

std::vector<VolumeSetup> read_volumes(const YamlFields& fields) {
  std::vector<VolumeSetup> volumes;
  std::set<std::string> labels;
  for (const auto& entry : fields.list_of_maps("volumes")) {
    VolumeSetup volume;
    volume.label = entry.text("label");
    if (!labels.insert(volume.label).second) entry.fail("label", "this label is given twice");
    volume.critical_parts = entry.full_texts("critical_parts");
    volume.from = entry.number("from", not_negative, volume.from);
    volume.to = entry.number("to", not_negative, volume.to);
    if (volume.to <= volume.from) entry.fail("to", "expected a time after 'from'");
    entry.finish();
    volumes.push_back(volume);
  }
  if (volumes.size() > 15) fields.fail("volumes", "expected at most 15 of them");
  if (volumes.empty()) volumes.push_back({.label = "free", .critical_parts = {}});
  return volumes;
}

/// Whether depth is, in the bag (its first topic) or, where it names none, in the folder.
bool is_depth_rectified(const BagTopics& bag, const DepthOptions& depth) {
  return bag.depth.empty() ? depth.rectified : is_depth_rectified(bag, bag.depth.front());
}

DepthOptions read_depth(const YamlFields& fields, const std::filesystem::path& folder, const BagTopics& bag,
                        std::vector<std::string>& notes) {
  DepthOptions depth;
  depth.scale = fields.optional_number("scale", {1e-7, 10});
  depth.max_range = fields.number("max_range", not_negative, depth.max_range);
  if (fields.has("rectified")) depth.rectified = fields.boolean("rectified");
  if (fields.has("camera")) {
    const YamlFields camera = fields.map("camera");
    depth.camera = read_camera_of_setup(camera, folder, is_depth_rectified(bag, depth), notes,
                                        bag.depth.empty() ? CameraAxes::y_down_or_up : CameraAxes::y_down);
    if (camera.has("file")) depth.mount_file = depth.scale_file = folder / camera.file("file");
    if (camera.has("name")) depth.scale_camera = camera.text("name");
  }
  if (fields.has("poses")) depth.poses = folder / fields.file("poses");
  depth.tolerance = fields.number("tolerance", {1e-6, 1e3}, depth.tolerance);
  depth.pose_scale = fields.optional_number("pose_scale", {1e-6, 1e6});
  fields.finish();
  return depth;
}

/// One word, or a list of them.
std::vector<std::string> one_or_more(const YamlFields& fields, const std::string& key) {
  if (!fields.has(key)) return {};
  return fields.is_list(key) ? fields.full_texts(key) : std::vector<std::string>{fields.text(key)};
}

/// Topics of depth, each with its camera's, if these are named.
std::vector<DepthTopic> read_depth_topics(const YamlFields& fields) {
  const std::vector<std::string> names = one_or_more(fields, "depth"),
                                 cameras = one_or_more(fields, "depth_camera_info");
  if (!cameras.empty() && cameras.size() != names.size())
    fields.fail("depth_camera_info", "expected one topic for each of 'depth', " +
                                         std::to_string(names.size()) + ", got " +
                                         std::to_string(cameras.size()));
  std::vector<DepthTopic> topics;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      fields.fail("depth", "topic " + quote(names[i]) + " is given twice");
    topics.push_back({names[i], cameras.empty() ? "" : cameras[i]});
  }
  return topics;
}

/// `times` and `clock_offsets`.
void read_bag_times(const YamlFields& fields, BagTopics& bag) {
  const std::string times = fields.text("times", "");
  if (times == "stamps") bag.times = BagTimes::stamps;
  if (times == "recording") bag.times = BagTimes::recording;
  if (fields.has("times") && bag.times == BagTimes::agreeing_stamps)
    fields.fail("times", "expected 'stamps' or 'recording'");
  for (const YamlFields& entry : fields.list_of_maps("clock_offsets")) {
    const std::string topic = entry.text("topic");
    constexpr double most = 1e10;  // s
    if (!bag.clock_offsets.emplace(topic, entry.number("add", {-most, most})).second)
      entry.fail("topic", "topic " + quote(topic) + " is given twice");
    entry.finish();
  }
  if (bag.times == BagTimes::recording && !bag.clock_offsets.empty())
    fields.fail("clock_offsets", "expected no offsets of stamps beside 'times: recording'");
}

BagTopics read_bag(const YamlFields& fields) {
  BagTopics bag;
  const std::pair<const char*, std::string*> names[] = {{"images", &bag.images},
                                                        {"camera_info", &bag.camera_info},
                                                        {"sensor_frame", &bag.sensor_frame},
                                                        {"pose_frame", &bag.pose_frame},
                                                        {"fixed_frame", &bag.fixed_frame}};
  for (const auto& [key, name] : names)
    if (fields.has(key)) *name = fields.text(key);
  for (std::string* frame : {&bag.fixed_frame, &bag.sensor_frame, &bag.pose_frame})
    if (frame->starts_with('/')) frame->erase(0, 1);  // as of frames in messages
  if (!bag.sensor_frame.empty() && bag.fixed_frame.empty())
    fields.fail("sensor_frame", "expected 'fixed_frame' beside it, in which poses of the sensor are");
  if (fields.has("rectified")) bag.rectified = fields.boolean("rectified");
  if (fields.has("point_times")) bag.point_times = fields.boolean("point_times");
  if (fields.has("depth_rectified")) bag.depth_rectified = fields.boolean("depth_rectified");
  bag.from = fields.number("from", not_negative, bag.from);
  bag.to = fields.optional_number("to", not_negative);
  if (bag.to && *bag.to <= bag.from) fields.fail("to", "expected a time after 'from'");
  read_bag_times(fields, bag);
  bag.depth = read_depth_topics(fields);
  bag.clouds = fields.texts("clouds");
  bag.scans = fields.texts("scans");
  bag.poses = fields.texts("poses");
  for (const YamlFields& entry : fields.list_of_maps("frames")) {
    StatedFrame frame{entry.text("parent"), entry.text("child"), entry.pose("pose")};
    for (std::string* name : {&frame.parent, &frame.child})
      if (name->starts_with('/')) name->erase(0, 1);
    if (frame.parent == frame.child) entry.fail("child", "expected another frame than 'parent'");
    bag.frames.push_back(std::move(frame));
    entry.finish();
  }
  for (const char* key : {"poses", "frames"})
    if (fields.has(key) && bag.fixed_frame.empty())
      fields.fail(key, "expected 'fixed_frame' beside it, in which poses of sensors are");
  fields.finish();
  return bag;
}

SourceOptions read_source(const YamlFields& fields, const std::filesystem::path& folder) {
  SourceOptions source;
  source.rate = fields.optional_number("rate", {1e-3, 1e5});
  if (fields.has("bag")) source.bag = read_bag(fields.map("bag"));
  if (fields.has("clouds")) {
    const std::string frame = fields.text("clouds");
    if (frame != "map" && frame != "sensor")
      fields.fail("clouds", "expected map or sensor, got " + quote(frame));
    source.clouds = frame == "map" ? CloudFrameOf::map : CloudFrameOf::sensor;
  }
  if (fields.has("scans")) {
    const YamlFields scans = fields.map("scans");
    if (scans.has("clear_infinite")) source.clear_infinite = scans.boolean("clear_infinite");
    if (const auto range = scans.optional_number("no_return", {0.1, 1e4})) source.no_return = *range;
    scans.finish();
  }
  if (fields.has("depth")) source.depth = read_depth(fields.map("depth"), folder, source.bag, source.notes);
  fields.finish();
  return source;
}

/// The camera of the images, and of depth where it has no other. What a file says of a rectified camera is
/// taken for what is rectified. @pre setup.source
void read_cameras(const YamlFields& fields, const std::filesystem::path& folder, Setup& setup) {
  SourceOptions& source = setup.source;
  const BagTopics& bag = source.bag;
  const bool is_depth_alone = bag.images.empty() && !bag.depth.empty();
  const bool of_depth = is_depth_rectified(bag, source.depth);
  const bool of_images = is_depth_alone ? of_depth : !bag.images.empty() && are_images_rectified(bag);
  setup.camera = read_camera_of_setup(fields, folder, of_images, source.notes);
  const bool has_own = source.depth.camera.has_value();
  const bool has_depth = bag.images.empty() || !bag.depth.empty();
  const bool has_infos = !bag.depth.empty() && !bag.depth.front().camera_info.empty();
  if (has_depth && !source.depth.camera && !has_infos && of_depth != of_images)
    source.depth.camera = read_camera_of_setup(fields, folder, of_depth, source.notes);
  const bool is_of_depth = fields.has("file") && source.depth.scale_file.empty();
  if (is_of_depth) source.depth.scale_file = folder / fields.file("file");
  if (is_of_depth && !has_own) source.depth.mount_file = source.depth.scale_file;
  if (is_of_depth && fields.has("name")) source.depth.scale_camera = fields.text("name");
}

RobotSetup read_robot(const YamlFields& fields, const std::filesystem::path& folder) {
  RobotSetup robot;
  robot.name = fields.robot("name", folder);
  robot.map_from_base = fields.pose("base", robot.map_from_base);
  robot.scale = fields.optional_number("scale", robot_scales);
  robot.terms = read_robot_terms(fields, folder);
  if (fields.has_angles("joints")) robot.joints = fields.angles("joints");
  robot.payload = fields.number("payload", not_negative, robot.payload);
  if (fields.has("gravity")) robot.gravity = fields.vector("gravity");
  robot.self_margin = fields.number("self_margin", not_negative, robot.self_margin);
  if (fields.has("joint_file")) robot.joint_file = folder / fields.file("joint_file");
  if (fields.has("joint_topic")) robot.joint_topic = fields.text("joint_topic");
  if (fields.has("joint_file") + fields.has("joint_topic") + !robot.joints.empty() > 1)
    fields.fail("", "expected one of 'joints', 'joint_file' and 'joint_topic'");
  if (fields.has("joint_names")) {
    const YamlFields names = fields.map("joint_names");
    for (const std::string& joint : names.keys()) robot.joint_names[joint] = names.text(joint);
    names.finish();
  }
  robot.joint_prefix = fields.text("joint_prefix", "");
  robot.paints = fields.texts("paints");
  for (const char* key : {"joint_names", "joint_prefix", "paints"}) {
    const bool is_empty = key == std::string("paints") && robot.paints.empty();
    if (fields.has(key) && !is_empty && robot.joint_file.empty() && robot.joint_topic.empty())
      fields.fail(key, "expected joint_file or joint_topic beside it, which say where the joints were");
  }
  robot.latency = fields.number("latency", not_negative, robot.latency);
  robot.joint_error = fields.angle("joint_error", robot.joint_error);
  robot.place_error = fields.number("place_error", not_negative, robot.place_error);
  fields.finish();
  return robot;
}

/// A sensor on the robot is where its joints say.
void require_joints(const YamlFields& fields, const Setup& setup) {
  const bool has_joint_source =
      setup.robot && !(setup.robot->joint_file.empty() && setup.robot->joint_topic.empty());
  for (const SensorSetup& sensor : setup.sensors)
    if (!sensor.link.empty() && !has_joint_source)
      fields.fail("sensors", "sensor '" + sensor.name +
                                 "' is on a link: expected `robot` with joint_file or " + "joint_topic");
}

GoalPoseSetup read_goal_pose(const YamlFields& fields) {
  GoalPoseSetup goal;
  goal.map_from_tip = fields.pose("pose");
  goal.position_tolerance = fields.number("position_tolerance", {0.0, 10.0}, 0.0);
  goal.turn_tolerance = fields.angle("turn_tolerance", 0.0);
  if (!(goal.turn_tolerance <= half_turn))
    fields.fail("turn_tolerance", "expected an angle from 0 to a half turn");
  if (fields.has("free_axis")) {
    const std::string axis = fields.text("free_axis");
    if (axis != "x" && axis != "y" && axis != "z")
      fields.fail("free_axis", "expected x, y or z, got " + quote(axis));
    goal.free_axis = axis.front() - 'x';
  }
  fields.finish();
  return goal;
}

void read_ends(const YamlFields& fields, QuerySetup& query) {
  if (fields.has("goal_poses")) {
    if (fields.has_angles("goals")) fields.fail("goal_poses", "expected either goals or goal_poses");
    for (const YamlFields& goal : fields.list_of_maps("goal_poses"))
      query.goal_poses.push_back(read_goal_pose(goal));
    if (query.goal_poses.empty()) fields.fail("goal_poses", "expected at least one goal");
    query.tip = fields.text("tip", "");
  } else if (fields.has("tip")) {
    fields.fail("tip", "expected goal_poses beside it");
  } else if (fields.has_angles("goals") || !fields.has("pick")) {
    read_goals(fields, query);
    query.goal_states.resize(query.goals.size());
    if (query.goals.empty() && !fields.has("pick")) fields.fail("goals", "expected at least one goal");
  }
}

/// Start and goals; of a pick the goal afterwards may be left out.
void read_ways(const YamlFields& fields, const std::filesystem::path& folder, QuerySetup& query) {
  read_start(fields, query);
  read_ends(fields, query);
  if (!fields.has("pick")) return;
  query.pick = read_pick(fields.map("pick"), folder);
  if (query.goals.size() + query.goal_poses.size() > 1)
    fields.fail(query.goals.empty() ? "goal_poses" : "goals", "expected at most one with a pick");
  if (fields.has("loads")) fields.fail("loads", "expected none beside a pick");
  if (!query.pick->map_from_place)
    fields.fail("pick", "expected 'place', where " + query.pick->name + " goes");
}

QuerySetup read_query(const YamlFields& fields, const std::filesystem::path& folder) {
  QuerySetup query;
  query.name = fields.text("name");
  read_ways(fields, folder, query);
  for (std::size_t i = 0; i < query.goals.size(); ++i) {
    const std::size_t size = query.goals[i].size();
    if (size == query.start.size() || !query.start_state.empty() || !query.goal_states[i].empty()) continue;
    fields.fail("", "the start has " + counted(query.start.size(), "number") + " and goals[" +
                        std::to_string(i) + "] has " + std::to_string(size) +
                        ", expected as many numbers in both, one for each joint of the robot");
  }
  query.planners = fields.texts("planners");
  if (fields.has("policies")) query.policies = read_policies(fields.map("policies"));
  if (fields.has("options")) query.options = read_options(fields.map("options"));
  query.padding = read_padding(fields);
  query.allow_outside = fields.texts("allow_outside");
  query.seen_within = fields.number("seen_within", not_negative, 0);
  for (const auto& entry : fields.list_of_maps("loads")) query.loads.push_back(read_load(entry, folder));
  fields.finish();
  return query;
}

/// Those of no query: on which legs they ride is for the session to say.
std::vector<LoadSetup> read_loads(const YamlFields& fields, const std::filesystem::path& folder) {
  std::vector<LoadSetup> loads;
  for (const auto& entry : fields.list_of_maps("loads")) {
    LoadSetup load = read_load(entry, folder);
    if (!load.legs.empty()) entry.fail("legs", "expected none here: a session says when a load rides");
    for (const LoadSetup& known : loads)
      if (known.name == load.name) entry.fail("name", "expected a name that no other load has");
    loads.push_back(std::move(load));
  }
  return loads;
}

/// Files of other programs that are given for a setup, by a key that they have.
void refuse_files_of_others(const YamlFields& fields) {
  constexpr char boards[] =
      "a setup, whose `boards` give each tag's id, size and pose, as `clearway tags print` writes it";
  constexpr char cameras[] = "a setup, which may name this file: `camera: {file: …}`";
  const std::array<std::array<const char*, 3>, 5> others = {
      {{"standalone_tags", "apriltag_ros's list of tags", boards},
       {"tag_bundles", "apriltag_ros's list of tags", boards},
       {"target_type", "kalibr's target", boards},
       {"bodies", "TagSLAM's scene", boards},
       {"cam0", "kalibr's or TagSLAM's cameras", cameras}}};
  for (const auto& [key, whose, expected] : others)
    if (fields.has(key)) fields.fail(key, std::string("this file is ") + whose + ", expected " + expected);
}

}  // namespace

const BoardSetup* Setup::board(const std::string& name) const {
  const auto found =
      std::find_if(boards.begin(), boards.end(), [&](const BoardSetup& board) { return board.name == name; });
  return found == boards.end() ? nullptr : &*found;
}

const SensorSetup* Setup::sensor(const std::string& label, const std::string& kind) const {
  for (const std::string& name : {label, kind}) {
    for (const SensorSetup& sensor : sensors) {
      if (sensor.name == name) return &sensor;
    }
  }
  return nullptr;
}

const LoadSetup* Setup::load(const std::string& name) const {
  const auto find = [&](const std::vector<LoadSetup>& known) {
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const LoadSetup& load) { return load.name == name; });
    return found == known.end() ? nullptr : &*found;
  };
  const LoadSetup* found = find(loads);
  for (auto query = queries.begin(); query != queries.end() && found == nullptr; ++query)
    found = find(query->loads);
  return found;
}

Setup parse_setup(const std::string& text, const std::string& name) {
  const YamlFields fields(text, "setup " + quote_path(name));
  refuse_files_of_others(fields);
  Setup setup;
  setup.title = fields.prose("title", "");
  if (fields.has("map")) setup.map = read_map(fields.map("map"));
  if (fields.has("source"))
    setup.source = read_source(fields.map("source"), std::filesystem::path(name).parent_path());
  if (fields.has("camera"))
    read_cameras(fields.map("camera"), std::filesystem::path(name).parent_path(), setup);
  if (fields.has("errors")) setup.errors = read_errors(fields.map("errors"));
  if (fields.has("detector")) setup.detector = read_detector(fields.map("detector"));
  setup.boards = read_boards(fields, setup.errors.boards, tag_family_ids().at(setup.detector.family) - 1);
  setup.sensors = read_sensors(fields, setup, std::filesystem::path(name).parent_path());
  if (fields.has("probe")) setup.probe = read_probe(fields.map("probe"), setup);
  if (fields.has("gripper")) setup.gripper = read_gripper(fields.map("gripper"), setup);
  if (fields.has("hands")) setup.hands = read_hands_setup(fields.map("hands"));
  setup.volumes = read_volumes(fields);
  if (fields.has("acceptance")) setup.acceptance = read_acceptance(fields.map("acceptance"));
  setup.source.camera = setup.camera;
  take_numbered_poses(fields, setup);
  for (const SensorSetup& sensor : setup.sensors) setup.source.placed.push_back(sensor.name);
  setup.source.places_depth = setup.sensor("depth", "depth") != nullptr;
  if (fields.has("robot"))
    setup.robot = read_robot(fields.map("robot"), std::filesystem::path(name).parent_path());
  require_joints(fields, setup);
  setup.loads = read_loads(fields, std::filesystem::path(name).parent_path());
  for (const auto& entry : fields.list_of_maps("queries"))
    setup.queries.push_back(read_query(entry, std::filesystem::path(name).parent_path()));
  fields.finish();
  return setup;
}

Setup load_setup(const std::filesystem::path& file) {
  return parse_setup(read_text(file, "setup"), file.string());
}

}  // namespace clearway
