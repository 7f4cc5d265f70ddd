// What `replay --record` writes, read again by the reader of bags, which shares nothing with the writer but
// the constants of the format. Others' code has read one too: tests/datasets/ros/bags/read_record.mjs.

#include "apps/fusion/replay_record.hpp"

#include <gtest/gtest.h>

#include "datasets/ros/bag_source.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace replay_record_test {

Scan scan_of(int index) {
  Scan scan;
  scan.time = 10.0 + index;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.1 * index, 0, 1);
  for (int i = 0; i < 50'000; ++i) scan.points.emplace_back(0.001F * static_cast<float>(i), 1.0F, -2.0F);
  return scan;
}

/// A sample that sees base and probe.
PaintingSample sample_at(double time) {
  PaintingSample sample;
  sample.time = time;
  sample.base.emplace();
  sample.base->camera_from_body.pose = Eigen::Translation3d(0, 0, 2) * Eigen::Quaterniond::Identity();
  sample.probe.emplace();
  sample.base_from_probe.pose = Eigen::Translation3d(0.5, 0, 0) * Eigen::Quaterniond::Identity();
  return sample;
}

void write(const std::filesystem::path& file) {
  ReplayRecord record(file);
  const Eigen::Isometry3d map_from_base(Eigen::Translation3d(0, 3, 0));
  for (int i = 0; i < 30; ++i) {
    record.see(scan_of(i));
    record.see(sample_at(10.0 + i), map_from_base);
  }
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("tool", {"hand"});
  map.paint(volume, {{0.3, 0.2, 0.1}, 0.25}, 1.0);
  record.add_map(map.snapshot());
  const Robot robot = load_robot("planar2");
  record.add_plan("go", robot, time_parameterize(robot, {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.4, 0.2)}));
  record.finish();
}

std::vector<Frame> frames_of(const std::filesystem::path& file, const std::string& topic,
                             const std::string& fixed) {
  SourceOptions options;
  options.bag.clouds = {topic};
  options.bag.fixed_frame = fixed;
  const auto source = open_bag(file, options);
  std::vector<Frame> frames;
  while (auto frame = source->next()) frames.push_back(std::move(*frame));
  EXPECT_FALSE(source->damage()) << *source->damage();
  return frames;
}

TEST(ReplayRecord, HoldsScansSpheresVoxelsPosesAndPlans) {
  const TemporaryFolder folder;
  write(folder / "a.mcap");
  std::map<std::string, std::uint64_t> counts;
  for (const BagTopic& topic : list_bag(folder / "a.mcap")) counts[topic.name] = topic.count;
  EXPECT_EQ(counts.at("/scans"), 30U);
  EXPECT_EQ(counts.at("/spheres"), 1U);
  EXPECT_EQ(counts.at("/voxels/painted"), 1U);
  EXPECT_EQ(counts.at("/plans/go"), 1U);
  EXPECT_GT(counts.at("/joint_states"), 10U);
  EXPECT_GT(counts.at("/tf"), 32U);

  const std::vector<Frame> scans = frames_of(folder / "a.mcap", "/scans", "");
  ASSERT_EQ(scans.size(), 30U) << "over several chunks, 18 MB";
  EXPECT_DOUBLE_EQ(scans[7].time, 17.0);
  const auto& points = std::get<CloudFrame>(scans[7].content).points;
  ASSERT_EQ(points.size(), 50'000U);
  EXPECT_TRUE(points[1000].isApprox(Eigen::Vector3f(1.7F, 1.0F, -1.0F), 1e-6F)) << "in the map's frame";

  const auto spheres = frames_of(folder / "a.mcap", "/spheres", "");
  EXPECT_EQ(std::get<CloudFrame>(spheres.at(0).content).points.at(0), Eigen::Vector3f(0.3F, 0.2F, 0.1F));

  // From the camera: 2 m over the base, which is 3 m along y.
  const auto seen = frames_of(folder / "a.mcap", "/scans", "camera");
  ASSERT_EQ(seen.size(), 30U);
  const Eigen::Isometry3d& camera_from_map = std::get<CloudFrame>(seen[7].content).world_from_sensor;
  EXPECT_TRUE(camera_from_map.translation().isApprox(Eigen::Vector3d(0, -3, 2), 1e-12));
}

TEST(ReplayRecord, TheSameGivesTheSameBytes) {
  const TemporaryFolder folder;
  const auto bytes = [&](const char* name) {
    write(folder / name);
    return read_file(folder / name);
  };
  EXPECT_TRUE(bytes("a.mcap") == bytes("b.mcap"));
}

}  // namespace replay_record_test
}  // namespace clearway
