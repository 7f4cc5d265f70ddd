// Record3D's and ScanNet++'s files of poses, by hand.
#include "datasets/cameras/phone_paths.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace phone_paths_test {

PathFields fields(const std::string& text) { return PathFields::parse(text, "poses 'f'"); }

/// The first camera is level and looks along -z of ARKit's world; the second is turned by 90 degrees to the
/// left, about y, and looks along -x.
const std::string record3d =
    R"({"w": 720, "h": 960, "K": [700, 0, 0, 0, 710, 0, 350, 470, 1], "fps": 60,
        "poses": [[0, 0, 0, 1, 1, 2, 3], [0, 0.70710678, 0, 0.70710678, 0, 0, 0]])";

TEST(Record3dPath, HasArkitsPosesAndTheCameraOfEachPicture) {
  ASSERT_TRUE(is_record3d(fields(record3d + "}")));
  const CameraPath path = read_record3d(fields(record3d + "}"));
  ASSERT_EQ(path.shots.size(), 2U);
  EXPECT_TRUE(path.is_named);
  EXPECT_EQ(path.shots[1].picture, "1");
  EXPECT_FALSE(path.shots[0].time);
  EXPECT_EQ(path.shots[0].camera, (CameraIntrinsics{720, 960, 700, 710, 350, 470, {}}));
  // 0.1 to the right, 0.2 down and 5 ahead.
  const Eigen::Vector3d seen(0.1, 0.2, 5);
  EXPECT_LT((*path.shots[0].world_from_camera * seen - Eigen::Vector3d(1.1, 1.8, -2)).norm(), 1e-12);
  EXPECT_LT((*path.shots[1].world_from_camera * seen - Eigen::Vector3d(-5, -0.2, -0.1)).norm(), 1e-7);
  EXPECT_NE(path.note.find("y of the map points up"), std::string::npos);
}

TEST(Record3dPath, CoefficientsAndTimesOfEachPictureCount) {
  const CameraPath path = read_record3d(
      fields(record3d + R"(, "perFrameIntrinsicCoeffs": [[701, 711, 351, 471], [702, 712, 352, 472]],
                           "frameTimestamps": [2000000.25, 2000000.75]})"));
  EXPECT_EQ(path.shots[1].camera, (CameraIntrinsics{720, 960, 702, 712, 352, 472, {}}));
  EXPECT_EQ(path.shots[1].time, 2000000.75);
  EXPECT_FALSE(read_record3d(fields(record3d + R"(, "perFrameIntrinsicCoeffs": [], "frameTimestamps": []})"))
                   .shots[0]
                   .time);
}

TEST(Record3dPath, WhatIsNoneIsRefusedByItsField) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    std::string text = record3d + "}";
    text.replace(text.find(from), from.size(), to);
    return complaint([&] { read_record3d(fields(text)); });
  };
  for (const auto& [from, to, expected] : std::vector<std::array<std::string, 3>>{
           {"[0, 0, 0, 1, 1, 2, 3]", "[0, 0, 0, 1, 1, 2]", "'poses'[0]: expected [qx, qy"},
           {"[0, 0, 0, 1, 1, 2, 3]", "[0, 0, 0, 2, 1, 2, 3]", "'poses'[0]: expected [qx, qy"},
           {"710, 0, 350", "710, 0.5, 350", "'K': expected [fx, 0, 0, 0, fy"},
           {"[700", "[-700", "'K': expected [fx, 0, 0, 0, fy"},
           {"\"w\": 720, ", "", "'w': expected it to be there"},
           {"\"fps\": 60", "\"frameTimestamps\": [1]", "expected one for each of `poses`"},
           {"\"fps\": 60", "\"frameTimestamps\": [1, -2]", "expected a time in seconds"}}) {
    const std::string said = refusal(from, to);
    EXPECT_NE(said.find(expected), std::string::npos) << said;
    EXPECT_NE(said.find("poses 'f'"), std::string::npos) << said;
  }
}

TEST(Record3dPath, OfTheFrontCameraHasCamerasAndTimesAlone) {
  const CameraPath path = read_record3d(
      fields(R"({"w": 480, "h": 640, "K": [400, 0, 0, 0, 400, 0, 240, 320, 1], "frameTimestamps": [1, 1.5],
                 "poses": [[0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0]]})"));
  EXPECT_FALSE(path.has_poses());
  EXPECT_TRUE(path.has_cameras());
  EXPECT_EQ(path.shots.at(1).time, 1.5);
  EXPECT_NE(path.lack.find("front camera"), std::string::npos);
}

/// At (1, 2, 3), looking along the world's x: right is -y there, down is -z.
const std::string scannetpp =
    R"({"frame_000000": {"timestamp": 64852.5, "pose": [[9]], "imu": {"rotate_rate": [1, 2, 3]},
        "aligned_pose": [[0, 0, 1, 1], [-1, 0, 0, 2], [0, -1, 0, 3], [0, 0, 0, 1]],
        "intrinsic": [[1440, 0, 959.5], [0, 1450, 719.5], [0, 0, 1]]},
        "frame_000010": {"intrinsic": [[1441, 0, 959.5], [0, 1451, 719.5], [0, 0, 1]]}})";

TEST(ScanNetPpPath, HasTheOpticalFramesPosesInTheMeshsWorld) {
  ASSERT_TRUE(is_scannetpp(fields(scannetpp)));
  const CameraPath path = read_scannetpp(fields(scannetpp));
  ASSERT_EQ(path.shots.size(), 2U);
  EXPECT_EQ(path.shots[0].picture, "frame_000000");
  EXPECT_EQ(path.shots[0].time, 64852.5);
  EXPECT_EQ(*path.shots[0].world_from_camera * Eigen::Vector3d(0.1, 0.2, 5), Eigen::Vector3d(6, 1.9, 2.8));
  EXPECT_EQ(path.shots[1].camera, (CameraIntrinsics{1920, 1440, 1441, 1451, 959.5, 719.5, {}}));
  EXPECT_FALSE(path.shots[1].world_from_camera);
  EXPECT_EQ(path.depth_scale, 0.001);
}

TEST(ScanNetPpPath, PosesThatAreNoneCostTheirShotAlone) {
  const std::string other = R"(, "frame_000020": {"aligned_pose": null,
                                  "intrinsic": [[1441, 0, 959.5], [0, 1451, 719.5], [0, 0, 1]]}})";
  const CameraPath path = read_scannetpp(fields(scannetpp.substr(0, scannetpp.size() - 1) + other));
  ASSERT_EQ(path.shots.size(), 3U);
  EXPECT_TRUE(path.shots[0].world_from_camera);
  EXPECT_FALSE(path.shots[2].world_from_camera);
  EXPECT_NE(path.note.find("mesh; 1 of 3 are no rigid transform"), std::string::npos) << path.note;
  EXPECT_EQ(path.lack, "");
  std::string bent = scannetpp;
  bent.replace(bent.find("[0, 0, 1, 1]"), 12, "[0, 0, 2, 1]");
  EXPECT_NE(read_scannetpp(fields(bent)).lack.find("`aligned_pose` of four rows"), std::string::npos);
}

TEST(ScanNetPpPath, WhatIsNoneIsRefusedByItsField) {
  for (const auto& [from, to, expected] :
       std::vector<std::array<std::string, 3>>{{"[1440, 0, 959.5]", "[192, 0, 128]", "1920 x 1440"},
                                               {"64852.5", "\"now\"", "expected a time in seconds"}}) {
    std::string text = scannetpp;
    text.replace(text.find(from), from.size(), to);
    const std::string said = complaint([&] { read_scannetpp(fields(text)); });
    EXPECT_NE(said.find(expected), std::string::npos) << said;
    EXPECT_NE(said.find("'frame_000000'"), std::string::npos) << said;
  }
}

TEST(Record3dPath, IsKnownByItsShape) {
  for (const auto& [from, to] : std::vector<std::array<std::string, 2>>{
           {"\"w\": 720, ", ""},
           {"[700, 0, 0, 0, 710, 0, 350, 470, 1]", "[700, 710, 350, 470]"},
           {"[700, 0, 0, 0, 710, 0, 350, 470, 1]", "\"camera.yaml\""},
           {"[0, 0, 0, 1, 1, 2, 3]", "[0, 0, 0, 1, 1, 2]"},
           {"[0, 0, 0, 1, 1, 2, 3]", "null"},
           {"[0, 0, 0, 1, 1, 2, 3], [0, 0.70710678, 0, 0.70710678, 0, 0, 0]", ""}}) {
    std::string text = record3d + "}";
    text.replace(text.find(from), from.size(), to);
    EXPECT_FALSE(is_record3d(fields(text))) << text;
  }
}

TEST(PhonePaths, AreFoundByWhatTheyHold) {
  const TemporaryFolder folder;
  EXPECT_TRUE(phone_path_file(folder.path()).empty());
  for (const char* other :
       {R"({"poses": "groundtruth.txt", "K": [50, 0, 32, 0, 50, 24, 0, 0, 1], "w": 64, "h": 48})",
        R"(["poses", "K"])", R"("poses" and "K")"}) {
    folder.write("metadata.json", other);
    EXPECT_TRUE(phone_path_file(folder.path()).empty()) << other;
  }
  folder.write("pose_intrinsic_imu.json", scannetpp);
  EXPECT_EQ(phone_path_file(folder.path()), folder / "pose_intrinsic_imu.json");
  folder.write("metadata.json", record3d + "}");
  EXPECT_EQ(phone_path_file(folder.path()), folder / "metadata.json");
  std::filesystem::remove(folder / "metadata.json");
  std::filesystem::create_directory(folder / "metadata.json");
  EXPECT_EQ(phone_path_file(folder.path()), folder / "pose_intrinsic_imu.json");
}

}  // namespace phone_paths_test
}  // namespace clearway
