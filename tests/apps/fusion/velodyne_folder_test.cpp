#include "apps/fusion/velodyne_folder.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "apps/fusion/fusion.hpp"
#include "apps/fusion/open_frames.hpp"
#include "datasets/descriptions/setup.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace velodyne_folder_test {

std::string scan_bytes(const std::vector<float>& numbers) {
  std::string bytes(numbers.size() * sizeof(float), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

/// Two scans of one point, 4 m ahead, 1 m to the left and 0.5 m up, beside what KITTI's odometry has.
class VelodyneFolders : public testing::Test {
 protected:
  VelodyneFolders() {
    std::filesystem::create_directory(folder_ / "velodyne");
    for (const char* name : {"velodyne/000000.bin", "velodyne/000001.bin"})
      folder_.write(name, scan_bytes({4, 1, 0.5F, 0.3F, 0, 0, 0, 0}));
  }
  /// The only point of each scan, in the map.
  std::vector<Eigen::Vector3d> points(const std::filesystem::path& recording,
                                      const SourceOptions& options = {}) {
    const auto source = open_frames(recording, options);
    std::vector<Eigen::Vector3d> seen;
    times_.clear();
    while (const auto frame = source->next()) {
      const auto& cloud = std::get<CloudFrame>(frame->content);
      EXPECT_EQ(cloud.kind, "velodyne");
      EXPECT_EQ(cloud.unusable, 1U);
      EXPECT_EQ(cloud.points.size(), 1U);
      seen.push_back(cloud.world_from_sensor * cloud.points.at(0).cast<double>());
      times_.push_back(frame->time);
    }
    told_ = source->warnings();
    damage_ = source->damage().value_or("");
    return seen;
  }
  TemporaryFolder folder_;
  std::vector<double> times_;
  std::vector<std::string> told_;
  std::string damage_;
};

const std::string poses = "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 2 0 1 0 0 -1 0 0 7\n";
/// KITTI's axes: the camera's x is the scanner's -y, y is -z, z is x; 8 cm above and 27 cm before it.
const std::string calibration =
    "P0: 700 0 600 0 0 700 180 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n";

TEST_F(VelodyneFolders, PosesOfKittisCameraPlaceTheScannerByTr) {
  folder_.write("poses.txt", poses);
  folder_.write("calib.txt", calibration);
  folder_.write("times.txt", "0.000000e+00\n1.036224e-01\n");
  // In the camera: (-1, -0.5 - 0.08, 4 - 0.27). The second pose turns (x, y, z) into (z + 2, y, 7 - x).
  const std::vector<Eigen::Vector3d> expected{{-1, -0.58, 3.73}, {3.73 + 2, -0.58, 7 + 1}};
  for (const auto& recording : {folder_.path(), folder_ / "velodyne"}) {
    const auto seen = points(recording);
    ASSERT_EQ(seen.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_LT((seen[i] - expected[i]).norm(), 1e-6) << seen[i].transpose();
    EXPECT_EQ(times_, (std::vector<double>{0.0, 0.1036224}));
    ASSERT_EQ(told_.size(), 1U);
    EXPECT_NE(told_[0].find("`Tr` of calib.txt"), std::string::npos);
  }
}

TEST_F(VelodyneFolders, TheScannerIsPlacedByTheKeysOfKittisOtherParts) {
  folder_.write("poses.txt", poses);
  // The scanner's point lies at (-1, -0.58, 3.73) in the camera; its rectified axes are turned by 90 degrees
  // about z: (x, y, z) becomes (-y, x, z).
  const std::string words = calibration.substr(calibration.find("Tr: ") + 4), turn = " 0 -1 0 1 0 0 0 0 1\n";
  const Eigen::Vector3d straight(-1, -0.58, 3.73), turned(0.58, -1, 3.73);
  for (const auto& [text, expected] :
       {std::pair<std::string, Eigen::Vector3d>{"Tr_velo_to_cam: " + words, straight},
        {"Tr_velo_cam " + words, straight},
        {"R0_rect:" + turn + "Tr_velo_to_cam: " + words + "Tr_imu_to_velo: 1 0 0 9 0 1 0 0 0 0 1 0\n",
         turned},
        {"R_rect" + turn + "Tr_velo_cam " + words, turned},
        {"R0_rect:" + turn + "Tr: " + words, straight}}) {
    folder_.write("calib.txt", text);
    EXPECT_LT((points(folder_.path()).at(0) - expected).norm(), 1e-6) << text;
  }
  folder_.write("calib.txt", "R0_rect: " + words + "Tr_velo_to_cam: " + words);
  EXPECT_NE(complaint([&] { points(folder_.path()); }).find("expected `R0_rect` and 9 numbers"),
            std::string::npos);
  std::filesystem::remove(folder_ / "calib.txt");
  folder_.write("calib_velo_to_cam.txt", "calib_time: 1\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.08 -0.27\n");
  EXPECT_LT((points(folder_.path()).at(0) - straight).norm(), 1e-6);
  folder_.write("calib_cam_to_cam.txt", "R_rect_00:" + turn + "R_rect_01: 1 0 0 0 1 0 0 0 1\n");
  EXPECT_LT((points(folder_.path()).at(0) - turned).norm(), 1e-6);
  folder_.write("calib.txt", "Tr_velo_to_cam: 1 2 3\n");
  EXPECT_NE(complaint([&] { points(folder_.path()); }).find("expected `Tr_velo_to_cam:` and 12 numbers"),
            std::string::npos);
}

TEST_F(VelodyneFolders, PosesLieWhereKittisOdometryHasThemOrWhereTheSetupSays) {
  const Eigen::Vector3d expected(5.73, -0.58, 8);
  std::filesystem::create_directories(folder_ / "d/sequences/07");
  std::filesystem::create_directories(folder_ / "d/poses");
  std::filesystem::rename(folder_ / "velodyne", folder_ / "d/sequences/07/velodyne");
  folder_.write("d/sequences/07/calib.txt", calibration);
  folder_.write("d/poses/07.txt", poses);
  for (const char* place : {"d/sequences/07", "d/sequences/07/velodyne"})
    EXPECT_LT((points(folder_ / place).at(1) - expected).norm(), 1e-6) << place;
  std::filesystem::rename(folder_ / "d/poses/07.txt", folder_ / "p.txt");
  const std::string setup = "sensors: [{name: velodyne, poses: p.txt";
  const SourceOptions stated = load_setup(folder_.write("s.yaml", setup + "}]\n")).source;
  EXPECT_LT((points(folder_ / "d/sequences/07", stated).at(1) - expected).norm(), 1e-6);
  folder_.write("s.yaml", setup + ", pose: [1, 0, 0, 0, 0, 0]}]\n");
  EXPECT_NE(complaint([&] { load_setup(folder_ / "s.yaml"); }).find("no `pose` beside it"),
            std::string::npos);
  folder_.write("c.pcd", "");
  EXPECT_NE(complaint([&] { open_frames(folder_ / "c.pcd", stated); }).find("is no folder of KITTI's scans"),
            std::string::npos);
}

TEST_F(VelodyneFolders, TumTextIsTheScannersOwnBesideACalibrationTooAndItIsTold) {
  folder_.write("calib.txt", calibration);
  folder_.write("poses.txt", "0 4 0 0 0 0 0 1\n1 5 0 0 0 0 0 1\n");
  EXPECT_LT((points(folder_.path()).at(1) - Eigen::Vector3d(9, 1, 0.5)).norm(), 1e-6);
  EXPECT_NE(told_.at(0).find("taken as the scanner's own, as they are TUM text"), std::string::npos);
}

TEST_F(VelodyneFolders, PosesWithoutACalibrationAreTheScannersAndItIsTold) {
  folder_.write("poses.txt", poses);
  const auto seen = points(folder_.path());
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_LT((seen[0] - Eigen::Vector3d(4, 1, 0.5)).norm(), 1e-6);
  EXPECT_LT((seen[1] - Eigen::Vector3d(2.5, 1, 3)).norm(), 1e-6);
  EXPECT_EQ(times_, (std::vector<double>{0, 1}));
  EXPECT_NE(told_.at(0).find("taken as the scanner's own"), std::string::npos);
  folder_.write("calib.txt", "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n");
  EXPECT_LT((points(folder_.path()).at(0) - Eigen::Vector3d(4, 1, 0.5)).norm(), 1e-6);
  folder_.write("poses.txt", "0 4 0 0 0 0 0 1\n1 5 0 0 0 0 0 1\n");  // TUM
  EXPECT_LT((points(folder_.path()).at(1) - Eigen::Vector3d(9, 1, 0.5)).norm(), 1e-6);
}

TEST_F(VelodyneFolders, ACutSequenceTakesThePosesOfItsNumbers) {
  folder_.write("poses.txt", poses + "1 0 0 40 0 1 0 0 0 0 1 0\nnan 0 0 40 0 1 0 0 0 0 1 0\n");
  std::filesystem::rename(folder_ / "velodyne/000000.bin", folder_ / "velodyne/000002.bin");
  auto seen = points(folder_.path());
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_NEAR(seen[0].x(), 2.5, 1e-6);  // 000001
  EXPECT_NEAR(seen[1].x(), 44.0, 1e-6);
  std::filesystem::rename(folder_ / "velodyne/000001.bin", folder_ / "velodyne/000003.bin");
  seen = points(folder_.path());
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_NE(told_.at(1).find("1 of 2 scans have no pose"), std::string::npos);
  std::filesystem::rename(folder_ / "velodyne/000003.bin", folder_ / "velodyne/000004.bin");
  const std::string sentence = complaint([&] { points(folder_.path()); });
  EXPECT_NE(sentence.find("has 4 lines for 2 scans"), std::string::npos) << sentence;
}

TEST_F(VelodyneFolders, WhatDoesNotSayWhereTheScannerWasIsRefused) {
  EXPECT_NE(
      complaint([&] { points(folder_.path()); }).find("has 2 scans and no poses of them: expected poses.txt"),
      std::string::npos);
  SourceOptions placed;
  placed.placed = {"velodyne"};
  EXPECT_EQ(points(folder_.path(), placed).size(), 2U);
  EXPECT_LT((points(folder_ / "velodyne/000000.bin").at(0) - Eigen::Vector3d(4, 1, 0.5)).norm(), 1e-6);
  folder_.write("poses.txt", poses);
  for (const char* tr :
       {"Tr: 1 2 3\n", "Tr: 2 0 0 0 0 1 0 0 0 0 1 0\n", "Tr: nan 0 0 0 0 1 0 0 0 0 1 0\n", "Tr:\n"}) {
    folder_.write("calib.txt", tr);
    const std::string sentence = complaint([&] { points(folder_.path()); });
    EXPECT_NE(sentence.find("calib.txt'"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("12 numbers"), std::string::npos) << sentence;
  }
  folder_.write("calib.txt", calibration);
  folder_.write("times.txt", "0.1\n0.1\n");
  EXPECT_NE(complaint([&] { points(folder_.path()); }).find("number 2: expected seconds, each later"),
            std::string::npos);
  folder_.write("times.txt", "1764441600123456789\n1764441600223456789\n");
  EXPECT_NE(complaint([&] { points(folder_.path()); }).find("are these nanoseconds or microseconds?"),
            std::string::npos);
}

TEST_F(VelodyneFolders, ADamagedScanIsNamedAndTheOthersAreFusedWithPointsAtTheOriginCounted) {
  folder_.write("poses.txt", poses);
  folder_.write("velodyne/000001.bin", "cut");
  EXPECT_EQ(points(folder_.path()).size(), 1U);
  EXPECT_NE(damage_.find("000001.bin' is damaged: its size, 3 bytes, is no multiple of 16"),
            std::string::npos)
      << damage_;
  folder_.write("velodyne/000001.bin", scan_bytes({4, 1, 0.5F, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 1, 1, 0}));
  const Fusion fusion = fuse(folder_.path(), {.resolution = 0.1}, [](double) {});
  EXPECT_EQ(fusion.counts.points.inserted, 3U);
  EXPECT_EQ(fusion.counts.points.dropped_invalid, 3U);
  EXPECT_EQ(fusion.map.snapshot().state({4, 1, 0.5}), VoxelState::occupied);
}

TEST_F(VelodyneFolders, OfKittisRawDataAreNamedWhereTheyLieDeeper) {
  const TemporaryFolder drive;
  std::filesystem::create_directories(drive / "velodyne_points/data");
  drive.write("velodyne_points/data/0000000000.bin", scan_bytes({4, 1, 0.5F, 0}));
  const std::string expected =
      " has its scans in a folder within: expected '" + drive.file("velodyne_points/data") + "'";
  for (const std::filesystem::path& folder : {drive.path(), drive / "velodyne_points"})
    EXPECT_EQ(complaint([&] { open_frames(folder, {}); }), "recording '" + folder.string() + "'" + expected);
  EXPECT_EQ(complaint([&] { open_frames(drive / "velodyne_points/data", {}); }), "");
}

TEST_F(VelodyneFolders, AMapsFolderIsNoRecording) {
  const TemporaryFolder map;
  map.write("provenance.bin", std::string(32, 'x'));
  EXPECT_NE(complaint([&] { open_frames(map.path(), {}); }).find("without pictures and clouds"),
            std::string::npos);
}

}  // namespace velodyne_folder_test
}  // namespace clearway
