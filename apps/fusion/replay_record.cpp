#include "apps/fusion/replay_record.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "datasets/ros/ros_encoders.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {
namespace {

const std::string map_frame = "map";

std::uint16_t added(McapWriter& mcap, const std::string& name, const RosType& type) {
  return mcap.add_topic(name, type.name, type.definition);
}

/// ROS's covariance of a pose: its small motion belongs to the axes of the parent frame, ours to the pose's.
Matrix6d in_parent_axes(const UncertainPose& pose) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = pose.pose.linear();
  return turn * pose.covariance * turn.transpose();
}

/// The tags of a board by which an image gave its pose.
void add_tags(const std::string& family, const BoardSetup& board, const std::vector<int>& seen,
              const Eigen::Isometry3d& map_from_board, std::vector<PlacedFrame>& frames) {
  for (const TagSetup& tag : board.tags)
    if (std::find(seen.begin(), seen.end(), tag.id) != seen.end())
      frames.push_back({family + ":" + std::to_string(tag.id), map_from_board * tag.board_from_tag});
}

struct Marks {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> numbers;
};

}  // namespace

ReplayRecord::ReplayRecord(const std::filesystem::path& file)
    : mcap_(file),
      transforms_(added(mcap_, "/tf", transforms_type())),
      camera_pose_(added(mcap_, "/poses/camera", pose_type())),
      probe_pose_(added(mcap_, "/poses/probe", pose_type())),
      camera_info_(added(mcap_, "/camera/camera_info", camera_info_type())),
      scans_(added(mcap_, "/scans", point_cloud_type())),
      spheres_(added(mcap_, "/spheres", point_cloud_type())),
      joints_(added(mcap_, "/joint_states", joint_state_type())) {}

void ReplayRecord::see(const Sighting& sighting) {
  const PaintingSample& sample = sighting.sample;
  time_ = std::max(time_, sample.time);
  if (!sample.base) return;
  const Eigen::Isometry3d& map_from_base = *sighting.base.map_from_board;
  const std::string& family = sighting.setup.detector.family;
  UncertainPose camera = inverse(sample.base->camera_from_body), probe = sample.base_from_probe;
  camera.pose = map_from_base * camera.pose;  // the map's frame has no error of its own
  probe.pose = map_from_base * probe.pose;
  std::vector<PlacedFrame> frames{{"camera", camera.pose}};
  add_tags(family, sighting.base, sample.base->tags, map_from_base, frames);
  if (sample.probe) {
    frames.push_back({"probe", probe.pose});
    add_tags(family, *sighting.setup.board(sighting.setup.probe->board), sample.probe->tags, probe.pose,
             frames);
  }
  mcap_.write(transforms_, sample.time, encode_transforms(sample.time, map_frame, frames));
  mcap_.write(camera_info_, sample.time, encode_camera_info(sample.time, "camera", sighting.camera));
  if (!sample.accepted) return;
  const auto write_pose = [&](std::uint16_t topic, const UncertainPose& pose) {
    mcap_.write(topic, sample.time, encode_pose(sample.time, map_frame, pose.pose, in_parent_axes(pose)));
  };
  write_pose(camera_pose_, camera);
  write_pose(probe_pose_, probe);
}

/// Scans of one label may be of several sensors: one that is elsewhere than the last of a frame could have
/// moved belongs to another frame.
std::string ReplayRecord::frame_of(const Scan& scan) {
  constexpr double way = 0.1, speed = 2.0;  // m, m/s
  std::vector<ScanFrame>& frames = scan_frames_[scan.sensor];
  const auto is_near = [&](const ScanFrame& last) {
    const double since = std::abs(scan.time - last.time);
    return since > 0.0 && (last.map_from_sensor.translation() - scan.map_from_sensor.translation()).norm() <=
                              way + speed * since;
  };
  constexpr std::ptrdiff_t most =
      16;  // of the last ones: a sensor that drives fast has a frame for each scan
  const auto count = static_cast<std::ptrdiff_t>(frames.size());
  auto found = std::find_if(frames.end() - std::min(count, most), frames.end(), is_near);
  if (found == frames.end()) {
    const bool is_apart = scan.sensor.empty() || scan.sensor.starts_with('/');
    const std::string name = (is_apart ? "scan" : "scan/") + scan.sensor;
    const std::string number = frames.empty() ? "" : "/" + std::to_string(frames.size() + 1);
    found = frames.insert(frames.end(), {name + number, scan.time, scan.map_from_sensor});
  }
  found->time = scan.time;
  found->map_from_sensor = scan.map_from_sensor;
  return found->name;
}

void ReplayRecord::see(const Scan& scan) {
  time_ = std::max(time_, scan.time);
  if (!scan.has_hits_only) {
    const std::string frame = frame_of(scan);
    const std::vector<PlacedFrame> placed{{frame, scan.map_from_sensor}};
    mcap_.write(transforms_, scan.time, encode_transforms(scan.time, map_frame, placed));
    mcap_.write(scans_, scan.time, encode_points(scan.time, frame, scan.points));
    return;
  }
  const Eigen::Isometry3f map_from_sensor = scan.map_from_sensor.cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) points.push_back(map_from_sensor * point);
  mcap_.write(scans_, scan.time, encode_points(scan.time, map_frame, points));
}

void ReplayRecord::add_map(const Snapshot& map) {
  Marks painted;
  for (const PaintedVolume& volume : map.volumes()) {
    for (const Sphere& sphere : volume.spheres) {
      painted.points.push_back(sphere.center.cast<float>());
      painted.numbers.push_back(static_cast<float>(sphere.radius));
    }
  }
  mcap_.write(spheres_, time_, encode_points(time_, map_frame, painted.points, "radius", painted.numbers));
  std::map<VoxelState, Marks> voxels;
  map.visit_leaves([&](const Voxel& leaf) {
    Marks& marks = voxels[leaf.state];
    marks.points.push_back(leaf.center.cast<float>());
    marks.numbers.push_back(static_cast<float>(leaf.size));
  });
  for (const auto& [state, marks] : voxels) {
    const auto topic = added(mcap_, "/voxels/" + std::string(to_string(state)), point_cloud_type());
    mcap_.write(topic, time_, encode_points(time_, map_frame, marks.points, "size", marks.numbers));
  }
}

void ReplayRecord::add_plan(const std::string& name, const Robot& robot, const Trajectory& trajectory) {
  std::vector<std::string> joints;
  for (const Joint& joint : robot.joints) joints.push_back(joint.name);
  std::vector<TimedPosition> points;
  for (const TrajectoryPoint& point : trajectory.points)
    points.push_back({point.time, point.position, point.velocity});
  const auto topic = added(mcap_, "/plans/" + name, joint_trajectory_type());
  mcap_.write(topic, time_, encode_trajectory(time_, joints, points));
  const double begin = time_;
  constexpr std::size_t drawn = 4;  // every fourth sample is drawn
  for (std::size_t i = 0; i < points.size(); ++i) {
    time_ = begin + points[i].time;
    mcap_.write(joints_, time_, encode_joints(time_, joints, points[i].position));
    if (i % drawn != 0 && i + 1 != points.size()) continue;
    const LinkPoses map_from_link = forward_kinematics(robot, points[i].position);
    std::vector<PlacedFrame> frames;
    for (std::size_t link = 0; link < robot.links.size(); ++link)
      frames.push_back({robot.links[link].name, map_from_link[link]});
    mcap_.write(transforms_, time_, encode_transforms(time_, map_frame, frames));
  }
}

}  // namespace clearway
