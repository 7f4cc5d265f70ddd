// What `replay --record` writes, read again by the reader of bags, which shares nothing with the writer but
// the constants of the format. Others' code has read one too: tests/datasets/ros/bags/read_record.mjs.

#include "apps/fusion/replay_record.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "datasets/bags/bag_source.hpp"
#include "datasets/ros/ros_camera.hpp"
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

const Setup& setup() {
  static const Setup parsed = parse_setup(R"(
camera: {width: 320, height: 240, fx: 330, fy: 331, cx: 158, cy: 121, lens: fisheye, distortion: [0.1, 0.2, 0.3, 0.4]}
boards:
  - {name: base, map_from_board: [0, 3, 0, 0, 0, 0], tags: [{id: 7, size: 0.05, pose: [0.1, 0, 0, 0, 0, 0]},
                                                           {id: 8, size: 0.05, pose: [0.2, 0, 0, 0, 0, 0]}]}
  - {name: wand, tags: [{id: 9, size: 0.04, pose: [0, 0, 0.3, 0, 0, 0]}]}
probe: {board: wand, ball_center: [0, 0, -0.1], ball_radius: 0.02}
)",
                                          "record");
  return parsed;
}

/// A sample that sees tag 7 of the base, and the probe a quarter turn about z.
PaintingSample sample_at(double time) {
  PaintingSample sample;
  sample.time = time;
  sample.accepted = time < 30;
  sample.base.emplace();
  sample.base->camera_from_body.pose = Eigen::Translation3d(0, 0, 2) * Eigen::Quaterniond::Identity();
  sample.base->tags = {7};
  sample.probe.emplace();
  sample.probe->tags = {9};
  sample.base_from_probe.pose =
      Eigen::Translation3d(0.5, 0, 0) * Eigen::AngleAxisd(M_PI_2, Eigen::Vector3d::UnitZ());
  sample.base_from_probe.covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  sample.base_from_probe.covariance(0, 4) = sample.base_from_probe.covariance(4, 0) = 0.5;
  return sample;
}

void write(const std::filesystem::path& file) {
  ReplayRecord record(file);
  for (int i = 0; i < 30; ++i) {
    record.see(scan_of(i));
    const PaintingSample sample = sample_at(10.0 + i);
    record.see({sample, setup(), setup().boards[0], *setup().camera});
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
  EXPECT_EQ(points[1000], Eigen::Vector3f(1.0F, 1.0F, -2.0F)) << "as the sensor has it";
  const auto placed = frames_of(folder / "a.mcap", "/scans", "map");
  ASSERT_EQ(placed.size(), 30U);
  const auto& cloud = std::get<CloudFrame>(placed[7].content);
  EXPECT_TRUE(cloud.world_from_sensor.translation().isApprox(Eigen::Vector3d(0.7, 0, 1), 1e-12));
  EXPECT_TRUE(cloud.is_origin_known) << "rays free space when the record is replayed";

  const auto spheres = frames_of(folder / "a.mcap", "/spheres", "");
  EXPECT_EQ(std::get<CloudFrame>(spheres.at(0).content).points.at(0), Eigen::Vector3f(0.3F, 0.2F, 0.1F));

  // From the camera: 2 m over the base, which is 3 m along y.
  const auto seen = frames_of(folder / "a.mcap", "/scans", "camera");
  ASSERT_EQ(seen.size(), 30U);
  const Eigen::Isometry3d& camera_from_sensor = std::get<CloudFrame>(seen[7].content).world_from_sensor;
  EXPECT_TRUE(camera_from_sensor.translation().isApprox(Eigen::Vector3d(0.7, -3, 3), 1e-12));
}

/// The messages of a topic.
std::vector<std::string> messages_of(const std::filesystem::path& file, const std::string& topic) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const auto bag = open_mcap(descriptor, std::filesystem::file_size(file));
  std::vector<bool> wanted;
  for (const BagTopic& known : bag->topics()) wanted.push_back(known.name == topic);
  std::vector<std::string> messages;
  bag->visit(wanted, [&](const BagMessage& message) {
    messages.emplace_back(message.bytes.begin(), message.bytes.end());
    return true;
  });
  ::close(descriptor);
  return messages;
}
WireReader reader_of(const std::string& message) {
  return {{reinterpret_cast<const std::uint8_t*>(message.data()), message.size()}, RosWire::cdr};
}

/// As of rawlogs whose sensors have no labels, or the same one.
TEST(ReplayRecord, ScansOfSensorsOfOneLabelAreWhereTheyWere) {
  const TemporaryFolder folder;
  const auto scan_at = [](const char* label, double time, double x) {
    Scan scan;
    scan.sensor = label;
    scan.time = time;
    scan.map_from_sensor.translation() = Eigen::Vector3d(x, 0, 1);
    scan.points.emplace_back(1.0F, 2.0F, 3.0F);
    return scan;
  };
  std::vector<double> places;
  {
    ReplayRecord record(folder / "a.mcap");
    for (int i = 0; i < 20; ++i) {
      const double time = 10.0 + 0.1 * i, later = time + (i % 2 == 0 ? 0.0 : 0.03);
      for (const auto& [at, x] : {std::pair{time, 0.02 * i}, {later, 5.0 + 0.02 * i}}) {
        record.see(scan_at(i % 3 == 0 ? "" : "laser", at, x));
        places.push_back(x);
      }
    }
    record.finish();
  }
  const std::vector<Frame> frames = frames_of(folder / "a.mcap", "/scans", "map");
  ASSERT_EQ(frames.size(), places.size());
  std::vector<double> read;
  for (const Frame& frame : frames)
    read.push_back(std::get<CloudFrame>(frame.content).world_from_sensor.translation().x());
  for (std::size_t i = 0; i < read.size(); i += 2) {  // of one stamp, in any order
    if (read[i] > read[i + 1]) std::swap(read[i], read[i + 1]);
    EXPECT_NEAR(read[i], places[i], 1e-9) << i;
    EXPECT_NEAR(read[i + 1], places[i + 1], 1e-9) << i;
  }
}

TEST(ReplayRecord, HoldsTheTagsByWhichPosesWereFound) {
  const TemporaryFolder folder;
  write(folder / "a.mcap");
  const std::vector<std::string> messages = messages_of(folder / "a.mcap", "/tf");
  WireReader in = reader_of(messages.at(1));  // the first one places the scan
  std::map<std::string, Eigen::Vector3d> places;
  for (const RosTransform& transform : read_transforms(in)) {
    EXPECT_EQ(transform.header.frame, "map");
    places[transform.child] = transform.translation;
  }
  ASSERT_EQ(places.size(), 4U) << "tag 8 was not used";
  EXPECT_TRUE(places.at("tag36h11:7").isApprox(Eigen::Vector3d(0.1, 3, 0)));
  EXPECT_TRUE(places.at("tag36h11:9").isApprox(Eigen::Vector3d(0.5, 3, 0.3)));
  EXPECT_TRUE(places.at("probe").isApprox(Eigen::Vector3d(0.5, 3, 0)));
}

TEST(ReplayRecord, HoldsPosesOfAcceptedImagesWithTheirCovarianceInTheAxesOfTheMap) {
  const TemporaryFolder folder;
  write(folder / "a.mcap");
  EXPECT_EQ(messages_of(folder / "a.mcap", "/poses/camera").size(), 20U) << "10 s to 29 s";
  const std::vector<std::string> messages = messages_of(folder / "a.mcap", "/poses/probe");
  ASSERT_EQ(messages.size(), 20U);
  WireReader in = reader_of(messages[1]);
  EXPECT_EQ(in.number<std::int32_t>(), 11);
  in.number<std::uint32_t>();
  EXPECT_EQ(in.text(), "map");
  for (const double expected : {0.5, 3.0, 0.0, 0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)})
    EXPECT_NEAR(in.number<double>(), expected, 1e-12);
  Matrix6d covariance;
  for (int i = 0; i < 36; ++i) covariance(i / 6, i % 6) = in.number<double>();
  Matrix6d expected = Matrix6d::Zero();  // the probe's x is the map's y, its y the map's -x
  expected.diagonal() << 2, 1, 3, 5, 4, 6;
  expected(1, 3) = expected(3, 1) = -0.5;
  EXPECT_TRUE(covariance.isApprox(expected, 1e-12)) << covariance;
}

TEST(ReplayRecord, HoldsTheCameraAsItIsReadAgain) {
  const TemporaryFolder folder;
  write(folder / "a.mcap");
  const std::vector<std::string> messages = messages_of(folder / "a.mcap", "/camera/camera_info");
  ASSERT_EQ(messages.size(), 30U);
  WireReader in = reader_of(messages[3]);
  const RosCameraInfo info = read_camera_info(in);
  EXPECT_EQ(info.header.frame, "camera");
  EXPECT_DOUBLE_EQ(info.header.time, 13.0);
  EXPECT_EQ(raw_camera(info).intrinsics, *setup().camera);
  EXPECT_EQ(rectified_camera(info).intrinsics.fy, 331) << "P";
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
