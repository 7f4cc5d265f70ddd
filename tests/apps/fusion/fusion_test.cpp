// Where scans come from and what is taken out of them, against places that are known exactly.
#include "apps/fusion/fusion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/system/number_text.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace fusion_test {

const Eigen::Vector3f ahead(1.0F, 0.0F, 0.0F);  ///< the one point of the scans here, sensor frame

void write_text(const std::filesystem::path& file, const std::string& text) { std::ofstream(file) << text; }

Frame scan_frame(double time, const std::string& sensor, const std::vector<Eigen::Vector3f>& points,
                 const Eigen::Isometry3d& world_from_sensor = Eigen::Isometry3d::Identity()) {
  CloudFrame cloud;
  cloud.points = points;
  cloud.world_from_sensor = world_from_sensor;
  cloud.kind = "points";
  return {time, sensor, cloud};
}

Fusion fused(const std::filesystem::path& recording, const std::filesystem::path& setup = {},
             double resolution = 0.02) {
  return fuse(recording, {.setup_file = setup, .resolution = resolution}, [](double) {});
}

VoxelState state_at(const Fusion& fusion, const Eigen::Vector3d& point) {
  return fusion.map.snapshot().state(point);
}

TEST(Fusion, AFolderOfCloudsIsARecordingSeenFromItsViewpoints) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "clouds");
  const std::vector<Eigen::Vector3f> points{{1.01F, 0.01F, 0.01F}, {1.01F, 0.31F, 0.01F}};
  std::string bytes = format_pcd(points);
  const std::string none = "VIEWPOINT 0 0 0 1 0 0 0";
  bytes.replace(bytes.find(none), none.size(), "VIEWPOINT 1.01 0.01 -0.99 0.8 0 0.6 0");
  write_text(folder / "clouds/1.5.pcd", bytes);
  write_text(folder / "clouds/10.ply", format_ply({{-0.49F, 0.01F, 0.01F}}));
  write_text(folder / "clouds/notes.txt", "no cloud");
  const Fusion fusion = fused(folder / "clouds");
  EXPECT_EQ(fusion.counts.scans, 2U);
  EXPECT_NEAR(fusion.counts.duration, 8.5, 1e-9);
  EXPECT_EQ(fusion.counts.points.inserted, 3U);
  for (const Eigen::Vector3f& point : points) {
    EXPECT_EQ(state_at(fusion, point.cast<double>()), VoxelState::occupied);
  }
  EXPECT_EQ(state_at(fusion, {1.01, 0.01, -0.5}), VoxelState::seen_free);  // from the viewpoint upwards
  EXPECT_EQ(state_at(fusion, {0.5, 0.01, 0.01}), VoxelState::unknown);     // not from the origin
  EXPECT_EQ(state_at(fusion, {-0.49, 0.01, 0.01}), VoxelState::occupied);
  EXPECT_EQ(state_at(fusion, {-0.25, 0.01, 0.01}),
            VoxelState::unknown);  // nobody says from where it was seen
  EXPECT_EQ(state_at(fused(folder / "clouds/10.ply"), {-0.25, 0.01, 0.01}), VoxelState::seen_free);
  EXPECT_EQ(fused(folder / "clouds/10.ply").counts.points.inserted, 1U);
}

TEST(Fusion, ADamagedCloudAmongOthersIsReportedAndTheOthersKept) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "clouds");
  write_text(folder / "clouds/a.pcd", format_pcd({ahead}));
  write_text(folder / "clouds/b.pcd", format_pcd({ahead}).substr(0, 150));
  write_text(folder / "clouds/c.pcd", format_pcd({ahead}));
  const Fusion fusion = fused(folder / "clouds");
  EXPECT_EQ(fusion.counts.scans, 2U);
  ASSERT_TRUE(fusion.damage);
  EXPECT_NE(fusion.damage->find("b.pcd"), std::string::npos);
  std::filesystem::create_directory(folder / "empty");
  EXPECT_THROW(fused(folder / "empty"), std::invalid_argument);
}

TEST(Fusion, AFixedSensorIsWhereTheSetupSaysAndOthersWhereTheRecordingDoes) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "r.rawlog");
  Eigen::Isometry3d recorded(Eigen::Translation3d(0.0, 0.0, 0.51));
  writer.write(scan_frame(1.0, "wall", {ahead}, recorded));
  writer.write(scan_frame(2.0, "other", {ahead}, recorded));
  writer.finish();
  write_text(folder / "s.yaml", "sensors: [{name: wall, pose_deg: [0.01, 0.01, 2.01, 0, 0, 90]}]\n");
  const Fusion fusion = fused(folder / "r.rawlog", folder / "s.yaml");
  EXPECT_EQ(state_at(fusion, {0.01, 1.01, 2.01}), VoxelState::occupied);
  EXPECT_EQ(state_at(fusion, {1.0, 0.0, 0.51}), VoxelState::occupied);
  EXPECT_EQ(state_at(fusion, {1.0, 0.0, 2.01}), VoxelState::unknown);
}

TEST(Fusion, FreesLessInSafeIntegrationWhichIsTheDefaultAndTheSameOnAnyThreads) {
  const TemporaryFolder folder;
  std::vector<Eigen::Vector3f> wall;  // seen at a slant
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j)
      wall.emplace_back(1.0F + 0.02F * static_cast<float>(i), 0.01F * static_cast<float>(i),
                        0.01F * static_cast<float>(j - 30));
  RecordingWriter writer(folder / "r.rawlog");
  writer.write(scan_frame(1.0, "wall", wall));
  writer.finish();
  write_text(folder / "compatible.yaml", "map: {integration: compatible}\n");
  const auto counts = [&](const FusionOptions& options) {
    const VoxelCounts voxels = fuse(folder / "r.rawlog", options, [](double) {}).map.snapshot().counts();
    return std::pair(voxels.seen_free, voxels.occupied);
  };
  const auto safe = counts({});
  const auto compatible = counts({.integration = "compatible"});
  EXPECT_LT(safe.first, compatible.first);
  EXPECT_GT(safe.first, compatible.first / 2);
  EXPECT_EQ(safe.second, compatible.second);
  EXPECT_EQ(counts({.integration = "safe"}), safe);
  EXPECT_EQ(counts({.setup_file = folder / "compatible.yaml"}), compatible);
  EXPECT_EQ(counts({.setup_file = folder / "compatible.yaml", .integration = "safe"}), safe);  // flag first
  EXPECT_EQ(counts({.threads = 1}), safe);
  EXPECT_EQ(counts({.threads = 3}), safe);
}

TEST(Fusion, ASensorOnTheRobotIsWhereItsJointsSayAndScansOfFastMotionAreCounted) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "r.rawlog");
  for (int i = 0; i <= 8; ++i) writer.write(scan_frame(100.0 + 0.25 * i, "laser", {ahead}));
  writer.finish();
  const Robot robot = load_robot("puma560");
  std::string joints = "time";
  for (const Joint& joint : robot.joints) joints += "," + joint.name;
  // It stands until 100.6 s, goes fast until 101.4 s, and stands again; nothing is known of 102 s.
  Eigen::VectorXd first(6), second(6);
  first << 0.1, -0.6, 0.3, 0.2, 0.5, -0.3;
  second << 0.9, -0.9, 0.5, -0.2, 0.4, 0.3;
  for (int i = 0; i <= 95; ++i) {
    const double time = 99.9 + 0.02 * i, share = std::clamp((time - 100.6) / 0.8, 0.0, 1.0);
    joints += "\n" + to_text(time);
    for (const double value : (1.0 - share) * first + share * second) joints += "," + to_text(value);
  }
  write_text(folder / "joints.csv", joints + "\n");
  write_text(folder / "s.yaml",
             "robot: {name: puma560, base: [0.5, 0.2, 0.1, 0, 0, 0.3], joint_file: joints.csv}\n"
             "sensors: [{name: laser, link: tip, pose: [0.02, 0.01, 0.05, 0.1, 0.2, 0.3]}]\n");
  const Fusion fusion = fused(folder / "r.rawlog", folder / "s.yaml");
  EXPECT_EQ(fusion.counts.scans_without_pose, 4U);  // 100.75, 101.0, 101.25 in motion, 102.0
  const clearway::Setup setup = load_setup(folder / "s.yaml");
  Robot placed = robot;
  placed.map_from_base = setup.robot->map_from_base;
  for (const Eigen::VectorXd& q : {first, second})
    EXPECT_EQ(state_at(fusion, tip_pose(placed, q) * setup.sensors[0].mount * ahead.cast<double>()),
              VoxelState::occupied);
  write_text(folder / "link.yaml",
             "robot: {name: puma560, joint_file: joints.csv}\n"
             "sensors: [{name: laser, link: nobody}]\n");
  EXPECT_NE(complaint([&] { fused(folder / "r.rawlog", folder / "link.yaml"); }).find("no link 'nobody'"),
            std::string::npos);
  write_text(folder / "still.yaml", "robot: {name: puma560}\nsensors: [{name: laser, link: tip}]\n");
  EXPECT_NE(complaint([&] { load_setup(folder / "still.yaml"); }).find("expected `robot` with joint_file"),
            std::string::npos);
}

/// It may have turned and come back meanwhile.
TEST(Fusion, ScansOfASensorOnTheRobotAreLeftOutWhileReadingsOfItsJointsAreMissing) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "r.rawlog");
  for (int i = 0; i <= 18; ++i) writer.write(scan_frame(100.05 + 0.1 * i, "laser", {ahead}));
  writer.finish();
  std::string joints = "time";
  for (const Joint& joint : load_robot("puma560").joints) joints += "," + joint.name;
  for (int i = 0; i <= 100; ++i)
    if (i <= 40 || i >= 62) joints += "\n" + to_text(100.0 + 0.02 * i) + ",0.1,-0.6,0.3,0.2,0.5,-0.3";
  write_text(folder / "joints.csv", joints + "\n");
  write_text(folder / "s.yaml",
             "robot: {name: puma560, joint_file: joints.csv}\nsensors: [{name: laser, link: tip}]\n");
  const Fusion fusion = fused(folder / "r.rawlog", folder / "s.yaml");
  EXPECT_EQ(fusion.counts.scans_without_pose, 5U);  // 100.85 to 101.25
  EXPECT_EQ(fusion.counts.scans_inserted, 14U);
}

TEST(Fusion, ABagInWhichTheBaseOfTheRobotMovesIsTold) {
  const TemporaryFolder folder;
  const Robot robot = load_robot("puma560");
  worlds::ScanBag bag(folder / "a.mcap");
  bag.transform(9.0, "map", "lidar", Eigen::Isometry3d::Identity(), true);
  std::string joints = "time";
  for (const Joint& joint : robot.joints) joints += "," + joint.name;
  for (int i = 0; i <= 20; ++i) {
    const double time = 10.0 + 0.1 * i;
    bag.transform(time, "map", robot.links.front().name,
                  Eigen::Isometry3d(Eigen::Translation3d(0.02 * i, 5.0, 0.0)));
    bag.cloud("/points", time, "lidar", {{1, 0, 0}});
    joints += "\n" + to_text(time) + ",0,0,0,0,0,0";
  }
  bag.write();
  write_text(folder / "joints.csv", joints + "\n");
  write_text(folder / "s.yaml",
             "robot: {name: puma560, base: [0, 5, 0, 0, 0, 0], joint_file: joints.csv}\n"
             "source: {bag: {clouds: [/points], fixed_frame: map}}\n");
  const Fusion fusion = fused(folder / "a.mcap", folder / "s.yaml");
  ASSERT_EQ(fusion.warnings.size(), 1U);
  EXPECT_NE(fusion.warnings[0].find("moves the base of the robot"), std::string::npos) << fusion.warnings[0];
}

TEST(Fusion, AFileOfPosesCarriesASensorAndScansBeyondItsTimeAreCounted) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "r.rawlog");
  for (int i = 0; i <= 8; ++i) writer.write(scan_frame(100.0 + 0.25 * i, "laser", {ahead}));
  writer.finish();
  // From 100.5 to 101.5 s it goes 1 m along y; a second later it is seen again.
  write_text(folder / "walk.txt",
             "100.5 0 0 0.01 0 0 0 1\n101.0 0 0.5 0.01 0 0 0 1\n101.5 0 1 0.01 0 0 0 1\n");
  write_text(folder / "s.yaml",
             "sensors: [{name: laser, poses: walk.txt, pose: [0.01, 0.013, 0, 0, 0, 0]}]\n");
  const Fusion fusion = fused(folder / "r.rawlog", folder / "s.yaml");
  EXPECT_EQ(fusion.counts.scans, 9U);
  EXPECT_EQ(fusion.counts.scans_without_pose, 4U);  // 100.0, 100.25, 101.75, 102.0
  EXPECT_EQ(fusion.counts.points.inserted, 5U);
  for (const double y : {0.013, 0.263, 0.513, 0.763, 1.013}) {
    EXPECT_EQ(state_at(fusion, {1.01, y, 0.01}), VoxelState::occupied) << y;
  }
  ASSERT_EQ(fusion.warnings.size(), 1U);
  EXPECT_NE(fusion.warnings[0].find("4 scans"), std::string::npos);
  write_text(folder / "bad.yaml", "sensors: [{name: laser, poses: nowhere.txt}]\n");
  EXPECT_THROW(fused(folder / "r.rawlog", folder / "bad.yaml"), std::invalid_argument);
}

TEST(Fusion, AFileOfPosesInMillimetresIsTold) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "r.rawlog");
  writer.write(scan_frame(100.25, "laser", {ahead}));
  writer.finish();
  std::string walk;
  for (int i = 0; i < 10; ++i)  // 0.2 m/s
    walk += std::to_string(100 + 0.1 * i) + " " + std::to_string(20 * i) + " 0 0.01 0 0 0 1\n";
  write_text(folder / "walk.txt", walk);
  write_text(folder / "s.yaml", "sensors: [{name: laser, poses: walk.txt}]\n");
  const Fusion fusion = fused(folder / "r.rawlog", folder / "s.yaml");
  ASSERT_EQ(fusion.warnings.size(), 1U);
  EXPECT_NE(fusion.warnings[0].find("usually move at 200 m/s"), std::string::npos) << fusion.warnings[0];
}

TEST(Fusion, TheStandingRobotDoesNotSeeItself) {
  const TemporaryFolder folder;
  Robot robot = load_robot("puma560");
  robot.map_from_base.translation() = Eigen::Vector3d(0.1, -0.2, 0.3);
  Configuration q(6);
  q << 0.3, -1.2, 0.4, 0.1, -0.5, 0.2;
  const LinkPoses poses = forward_kinematics(robot, q);
  std::vector<Eigen::Vector3f> own;
  const Eigen::Vector3f eye(3.0F, 0.5F, 1.0F);
  for (const Body& body : robot.bodies) {
    const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d way(std::cos(0.7 * i), std::sin(0.7 * i), std::sin(1.3 * i));
      own.push_back((pose * body.shape.support(way)).cast<float>() - eye);
    }
  }
  const Eigen::Vector3f wall(-4.0F, 0.0F, 0.0F);
  own.push_back(wall);
  RecordingWriter writer(folder / "r.rawlog");
  const Eigen::Isometry3d place(Eigen::Translation3d{eye.cast<double>()});
  writer.write(scan_frame(1.0, "depth", own, place));
  writer.finish();
  const std::string standing = "robot: {name: puma560, base: [0.1, -0.2, 0.3, 0, 0, 0]";
  write_text(folder / "seen.yaml", standing + "}\n");
  write_text(folder / "self.yaml", standing + ", joints: [0.3, -1.2, 0.4, 0.1, -0.5, 0.2]}\n");
  write_text(folder / "bad.yaml", standing + ", joints: [1, 2]}\n");
  EXPECT_EQ(fused(folder / "r.rawlog", folder / "seen.yaml").counts.points.inserted, own.size());
  const Fusion fusion = fused(folder / "r.rawlog", folder / "self.yaml");
  EXPECT_EQ(fusion.counts.points.inserted, 1U);
  EXPECT_EQ(fusion.counts.points.dropped_filter, own.size() - 1);
  EXPECT_EQ(state_at(fusion, (eye + wall).cast<double>()), VoxelState::occupied);
  EXPECT_THROW(fused(folder / "r.rawlog", folder / "bad.yaml"), std::invalid_argument);
}

/// Half a second of a stroke before tags, with scans of our own among its images: a sensor on the
/// probe's board that sees one point, and one fixed in the room that sees the probe.
class FusionWithTags : public testing::Test {
 protected:
  void SetUp() override {
    write_text(folder_ / "setup.yaml", small_setup);
    Scene scene = parse_scene(small_scene, "small scene", folder_ / "");
    scene.depth.reset();
    simulate(scene, folder_ / "stroke.rawlog");
    std::ifstream(folder_ / "truth.json") >> truth_;
    RecordingReader reader(folder_ / "stroke.rawlog");
    RecordingWriter writer(folder_ / "r.rawlog");
    while (auto frame = reader.next()) {
      if (std::holds_alternative<ImageFrame>(frame->content)) {
        const double time = frame->time;
        writer.write(scan_frame(time, "carried", {Eigen::Vector3f(0.2F, 0.0F, 0.0F)}));
        times_.push_back(time);
      }
      if (!std::holds_alternative<CommentFrame>(frame->content)) writer.write(*frame);
    }
    writer.write(scan_frame(times_.back() + 60.0, "carried", {Eigen::Vector3f(0.2F, 0.0F, 0.0F)}));
    writer.finish();
    setup_text_ = small_setup;
  }

  Eigen::Isometry3d map_from_probe(std::size_t image) const {
    const auto v = truth_["frames"][image]["map_from_probe"].get<std::vector<double>>();
    Eigen::Isometry3d pose(Eigen::Quaterniond(v[3], v[4], v[5], v[6]));
    pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
    return pose;
  }

  const TemporaryFolder folder_;
  nlohmann::json truth_;
  std::string setup_text_;
  std::vector<double> times_;
};

TEST_F(FusionWithTags, ASensorOnATaggedBoardIsWhereTheCameraSeesTheBoard) {
  write_text(folder_ / "s.yaml",
             setup_text_ + "sensors: [{name: carried, board: probe, pose: [0, 0, 0.05, 0, 0, 0]}]\n");
  const Fusion fusion = fused(folder_ / "r.rawlog", folder_ / "s.yaml", 0.01);
  EXPECT_EQ(fusion.counts.scans, times_.size() + 1);
  EXPECT_GE(fusion.counts.scans_without_pose, 1U);  // the last, a minute after the last image
  EXPECT_LT(fusion.counts.scans_without_pose, times_.size());
  const Snapshot map = fusion.map.snapshot();
  std::size_t near = 0;
  for (std::size_t i = 0; i < times_.size(); ++i) {
    const Eigen::Vector3d expected = map_from_probe(i) * Eigen::Vector3d(0.2, 0.0, 0.05);
    bool hit = false;
    for (int corner = 0; corner < 27; ++corner) {  // within a voxel
      const Eigen::Vector3d step(corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1);
      const VoxelState state = map.state(expected + 0.01 * step);
      hit = hit || state == VoxelState::occupied || state == VoxelState::conflict;
    }
    near += hit;
  }
  EXPECT_GE(near + fusion.counts.scans_without_pose, times_.size());
}

TEST_F(FusionWithTags, TheProbeAndTheHandAreNoObstacles) {
  RecordingReader reader(folder_ / "stroke.rawlog");
  RecordingWriter writer(folder_ / "seen.rawlog");
  std::size_t image = 0;
  const Eigen::Isometry3d place(Eigen::Translation3d(-0.4, 0.0, 0.5));
  const Eigen::Vector3d ball(0.0, 0.0, -0.08), hand(0.0, 0.0, 0.06), elsewhere(0.1, 0.0, 0.05);
  while (auto frame = reader.next()) {
    if (std::holds_alternative<CommentFrame>(frame->content)) continue;
    if (std::holds_alternative<ImageFrame>(frame->content)) {
      std::vector<Eigen::Vector3f> points;
      for (const Eigen::Vector3d& on_probe : {ball, hand, elsewhere}) {
        points.push_back((place.inverse() * map_from_probe(image) * on_probe).cast<float>());
      }
      writer.write(scan_frame(frame->time + 1e-3, "room", points, place));
      ++image;
    }
    writer.write(*frame);
  }
  writer.finish();
  std::string with_hand = setup_text_;
  const auto at = with_hand.rfind("ball_radius");
  ASSERT_NE(at, std::string::npos);
  with_hand.insert(at, "hand: [{from: [0, 0, 0.02], to: [0, 0, 0.1], radius: 0.03}], ");
  write_text(folder_ / "s.yaml", with_hand);
  const Fusion fusion = fused(folder_ / "seen.rawlog", folder_ / "s.yaml", 0.005);
  const std::size_t unseen = fusion.counts.scans_without_probe;
  EXPECT_LT(unseen, image);
  EXPECT_EQ(fusion.counts.points.inserted, (image - unseen) + 3 * unseen);
}

}  // namespace fusion_test
}  // namespace clearway
