// What `replay --record` writes of a robot that moves, replayed again.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>

#include "apps/fusion/fusion.hpp"
#include "apps/fusion/replay_record.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace record_of_robot_test {

void write_text(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

Fusion fused(const std::filesystem::path& recording, const std::filesystem::path& setup,
             FusionObserver* observer = nullptr) {
  return fuse(recording, {.setup_file = setup, .resolution = 0.02, .observer = observer}, [](double) {});
}

/// A wall 1.5 m ahead, and before it a robot: points on its bodies.
std::vector<Eigen::Vector3f> robot_before_wall(const Robot& robot, const Configuration& q) {
  std::vector<Eigen::Vector3f> points;
  for (int i = -30; i <= 30; ++i)
    for (int j = 0; j <= 60; ++j)
      points.emplace_back(1.5F, 0.02F * static_cast<float>(i), 0.02F * static_cast<float>(j));
  const LinkPoses poses = forward_kinematics(robot, q);
  for (const Body& body : robot.bodies) {
    const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    for (int i = 0; i < 200; ++i)
      points.push_back((pose * body.shape.support({std::cos(0.7 * i), std::sin(0.7 * i), std::sin(1.3 * i)}))
                           .cast<float>());
  }
  return points;
}

/// Voxels by state and place.
std::map<std::array<double, 3>, VoxelState> voxels_of(const Fusion& fusion) {
  std::map<std::array<double, 3>, VoxelState> voxels;
  fusion.map.snapshot().visit_leaves([&](const Voxel& leaf) {
    voxels[{leaf.center.x(), leaf.center.y(), leaf.center.z()}] = leaf.state;
  });
  return voxels;
}

TEST(RecordOfRobot, MakesItsMapAgainWithTheSameRobot) {
  const TemporaryFolder folder;
  const Robot robot = load_robot("puma560");
  std::string joints = "time";
  for (const Joint& joint : robot.joints) joints += "," + joint.name;
  const auto place = [](double time) {
    Configuration q(6);
    q << 0.4 * std::sin(time), -1.0, 0.5 + 0.2 * std::sin(2.0 * time), 0.1, 0.3, 0.0;
    return q;
  };
  for (int i = 0; i <= 400; ++i) {
    joints += "\n" + to_text(100.0 + 0.01 * i);
    for (const double value : place(0.01 * i)) joints += "," + to_text(value);
  }
  write_text(folder / "joints.csv", joints + "\n");
  RecordingWriter writer(folder / "r.rawlog");
  const Eigen::Isometry3d eye(Eigen::Translation3d(-1.5, 0.0, 0.6));
  for (int i = 1; i <= 8; ++i) {
    std::vector<Eigen::Vector3f> points = robot_before_wall(robot, place(0.4 * i));
    for (Eigen::Vector3f& point : points) point -= eye.translation().cast<float>();
    CloudFrame cloud;
    cloud.points = points;
    cloud.world_from_sensor = eye;
    cloud.kind = "points";
    writer.write({100.0 + 0.4 * i, "lidar", cloud});
  }
  writer.finish();
  const std::string of_robot = "robot: {name: puma560, joint_file: joints.csv}\n",
                    of_record = "source: {bag: {clouds: [/scans], fixed_frame: map}}\n";
  write_text(folder / "s.yaml", of_robot);
  write_text(folder / "record.yaml", of_record);
  write_text(folder / "both.yaml", of_robot + of_record);
  ReplayRecord record(folder / "record.mcap");
  const Fusion first = fused(folder / "r.rawlog", folder / "s.yaml", &record);
  record.finish();
  EXPECT_GT(first.counts.points.dropped_filter, 1000U);
  EXPECT_EQ(voxels_of(fused(folder / "record.mcap", folder / "both.yaml")), voxels_of(first));
  EXPECT_NE(voxels_of(fused(folder / "record.mcap", folder / "record.yaml")), voxels_of(first));
}

}  // namespace record_of_robot_test
}  // namespace clearway
