#include "datasets/bags/sens_file.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/bytes/sens_bytes.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace sens_file_test {

/// A wall 2 m ahead whose last pixel is 1 m away, and whose first two hold none; seen from (1, 2, 3), looking
/// along the world's x: right is -y there, down is -z.
std::vector<std::uint16_t> wall() {
  std::vector<std::uint16_t> steps(48 * 36, 2000);
  steps.front() = 0;
  steps[1] = 65535;
  steps.back() = 1000;
  return steps;
}

SensPictures frame_at(float x, std::uint64_t time) {
  return {{0, 0, 1, x, -1, 0, 0, 2, 0, -1, 0, 3, 0, 0, 0, 1},
          time,
          picture_bytes(cv::Mat(72, 96, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"),
          wall()};
}

SensPictures lost_at(std::uint64_t time) {
  SensPictures frame = frame_at(0, time);
  frame.world_from_camera.fill(-INFINITY);
  return frame;
}

class SensFiles : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& bytes, const SourceOptions& options = {}) {
    return open_sens(folder_.write("scene.sens", bytes), options);
  }
  /// "depth 1.5" and "colour 1.5" of each frame.
  static std::vector<std::string> all_of(FrameSource& source) {
    std::vector<std::string> frames;
    while (const auto frame = source.next())
      frames.push_back(frame->sensor + " " + std::to_string(frame->time).substr(0, 4));
    return frames;
  }
  TemporaryFolder folder_;
};

TEST_F(SensFiles, WallsLandAheadRightAndBelow) {
  for (const std::int32_t kind : {0, 1}) {
    const auto source = open(sens_bytes({frame_at(1, 1500000), frame_at(5, 1750000)}, kind));
    for (const double x : {1.0, 5.0}) {
      const auto depth = source->next(), colour = source->next();
      ASSERT_TRUE(depth && colour);
      EXPECT_EQ(depth->sensor, "depth");
      EXPECT_EQ(depth->time, x == 1.0 ? 1.5 : 1.75);
      const auto& cloud = std::get<CloudFrame>(depth->content);
      EXPECT_EQ(cloud.kind, "depth");
      EXPECT_EQ(cloud.points.size(), 48U * 36U - 2U);
      const Eigen::Vector3d last = cloud.world_from_sensor * cloud.points.back().cast<double>();
      EXPECT_LT((last - Eigen::Vector3d(x + 1, 2 - 23.0 / 50, 3 - 17.0 / 52)).norm(), 1e-5) << last;
      EXPECT_EQ(colour->sensor, "colour");
      const auto& image = std::get<ImageFrame>(colour->content);
      EXPECT_EQ(image.image.width, 96);
      EXPECT_EQ(image.intrinsics.fx, 100.0);
    }
    EXPECT_FALSE(source->next());
    EXPECT_FALSE(source->damage());
    EXPECT_EQ(source->time_caveat(), "");
    EXPECT_NE(source->warnings().at(0).find("are those in the file"), std::string::npos);
  }
}

TEST_F(SensFiles, FramesWithoutAPoseKeepTheirColoursAlone) {
  const auto source = open(sens_bytes({frame_at(1, 0), lost_at(0)}));
  EXPECT_NE(source->time_caveat().find("one a second"), std::string::npos);
  EXPECT_EQ(all_of(*source), (std::vector<std::string>{"depth 0.00", "colour 0.00", "colour 1.00"}));
  EXPECT_NE(source->warnings().back().find("1 of 2 frames have no pose"), std::string::npos);
  SourceOptions placed;
  placed.places_depth = true;
  placed.rate = 2.0;
  const auto elsewhere = open(sens_bytes({frame_at(1, 0), lost_at(0)}), placed);
  EXPECT_EQ(elsewhere->time_caveat(), "");
  const auto first = elsewhere->next();
  EXPECT_TRUE(
      std::get<CloudFrame>(first.value().content).world_from_sensor.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(all_of(*elsewhere), (std::vector<std::string>{"colour 0.00", "depth 0.50", "colour 0.50"}));
}

TEST_F(SensFiles, RecordingsThatWereNeverTrackedHaveNoPoses) {
  SensPictures first = frame_at(1, 0), second = frame_at(2, 1);
  for (SensPictures* frame : {&first, &second})
    frame->world_from_camera = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const auto source = open(sens_bytes({first, lost_at(1), second}));
  const std::vector<std::string> notes = source->warnings();
  EXPECT_NE(notes.at(notes.size() - 2).find("as of a recording that was never tracked"), std::string::npos);
  EXPECT_NE(notes.back().find("3 of 3 frames have no pose"), std::string::npos) << notes.back();
  EXPECT_EQ(all_of(*source).size(), 3U) << "colours alone";
  EXPECT_EQ(all_of(*open(sens_bytes({first, frame_at(2, 1)}))).size(), 4U) << "it begins there";
  EXPECT_EQ(all_of(*open(sens_bytes({first}))).size(), 2U) << "one picture may be anywhere";
}

TEST_F(SensFiles, PosesThatAreNotRigidAreCountedApart) {
  SensPictures bent = frame_at(2, 1), inverted = frame_at(3, 2);
  bent.world_from_camera[0] = 0.5F;
  inverted.world_from_camera[14] = 1e-9F;
  const auto source = open(sens_bytes({frame_at(1, 0), bent, inverted, lost_at(3)}));
  const std::vector<std::string> notes = source->warnings();
  EXPECT_EQ(notes.at(notes.size() - 2),
            "1 of 4 frames have a pose that is no rigid transform, and their depth was left out");
  EXPECT_EQ(notes.back(), "1 of 4 frames have no pose, and their depth was left out");
}

TEST_F(SensFiles, DepthThatIsMovedIsPlacedByTheSetup) {
  constexpr std::size_t extrinsic = 4 + 8 + 15 + 3 * 64;
  std::string bytes = sens_bytes({frame_at(1, 1), frame_at(2, 2)});
  bytes.replace(extrinsic + 12, 4, std::string("\0\0\0\x3f", 4));  // half a metre aside
  EXPECT_NE(complaint([&] { open(bytes); }).find("extrinsic of its depth camera is not the identity"),
            std::string::npos);
  SourceOptions placed;
  placed.places_depth = true;
  EXPECT_EQ(all_of(*open(bytes, placed)).size(), 4U);
  bytes.replace(extrinsic, 64, std::string(64, '\0'));  // not stated
  EXPECT_EQ(all_of(*open(bytes)).size(), 4U);
}

TEST_F(SensFiles, DamageCostsItsFrame) {
  SensPictures broken = frame_at(1, 1000000);
  broken.colour = "no JPEG";
  SensPictures narrow = frame_at(1, 2000000);
  narrow.depth.pop_back();
  const std::string bytes = sens_bytes({broken, narrow, frame_at(1, 3000000)});
  const auto source = open(bytes);
  EXPECT_EQ(all_of(*source), (std::vector<std::string>{"depth 1.00", "depth 3.00", "colour 3.00"}));
  EXPECT_NE(source->damage().value().find("scene.sens': frame 0 is damaged: "), std::string::npos);
  EXPECT_NE(source->damage().value().find("1 more of 3 frames is damaged, too"), std::string::npos);
  const auto cut = open(bytes.substr(0, bytes.size() - 9));
  all_of(*cut);
  EXPECT_NE(cut->damage().value().find("2 more of 2 frames"), std::string::npos) << *cut->damage();
}

TEST_F(SensFiles, TheSetupsCameraAndScaleComeFirstAndPosesAreRefused) {
  SourceOptions stated;
  stated.depth.camera = CameraIntrinsics{48, 36, 100, 104, 24, 18, {}};
  stated.depth.scale = 0.002;
  const auto frame = open(sens_bytes({frame_at(1, 1)}), stated)->next();
  const auto& cloud = std::get<CloudFrame>(frame.value().content);
  EXPECT_LT((cloud.points.back() - Eigen::Vector3f(2, -2.0F * 23 / 100, -2.0F * 17 / 104)).norm(), 1e-5F);
  stated.depth.poses = "poses.txt";
  EXPECT_NE(complaint([&] { open(sens_bytes({frame_at(1, 1)}), stated); }).find("has poses of its own"),
            std::string::npos);
  EXPECT_NE(complaint([&] { open(sens_bytes({})); }).find("expected at least one frame"), std::string::npos);
  EXPECT_NE(complaint([&] { open("no recording"); }).find("no .sens of ScanNet"), std::string::npos);
  EXPECT_TRUE(is_sens_file("a/SCENE.SENS"));
  EXPECT_FALSE(is_sens_file("a.bag"));
}

}  // namespace sens_file_test
}  // namespace clearway
