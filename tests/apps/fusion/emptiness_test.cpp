// A recording of which nothing gets into the map is refused with the reason, and nothing is written.
#include "apps/fusion/emptiness.hpp"

#include <gtest/gtest.h>

#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace emptiness_test {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class Emptiness : public testing::Test {
 protected:
  /// The sentence with which replay refuses; "" when it does not.
  std::string refusal(const std::string& recording, const std::string& setup) {
    folder_.write("s.yaml", setup);
    const CommandRun run = run_command({"replay", folder_.file(recording), "--setup", folder_.file("s.yaml"),
                                        "--out", folder_.file("out"), "--no-plan"});
    if (run.status == exit_done) return "";
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    return run.log;
  }
  void write_scan(const std::string& name, const std::vector<Eigen::Vector3f>& points) {
    RecordingWriter writer(folder_ / name);
    CloudFrame cloud;
    cloud.points = points;
    writer.write(Frame{10.0, "laser", cloud});
    writer.finish();
  }
  /// A stroke before tags, without scans.
  void write_stroke() {
    folder_.write("setup.yaml", small_setup);
    Scene scene = parse_scene(small_scene, "small scene", folder_ / "");
    scene.depth.reset();
    simulate(scene, folder_ / "r.rawlog");
  }
  TemporaryFolder folder_;
};

TEST_F(Emptiness, ACropThatTakesEveryPointIsReported) {
  write_scan("r.rawlog", {{1.0F, 0.0F, 0.0F}, {1.0F, 0.5F, 0.0F}});
  EXPECT_NE(refusal("r.rawlog", "map: {crop: [5, 5, 5, 6, 6, 6]}\n")
                .find("nothing of its 1 scan got into the map: 2 points were taken out by `crop`\n"),
            std::string::npos);
  EXPECT_NE(refusal("r.rawlog", "map: {min_range: 3, crop: [5, 5, 5, 6, 6, 6], thin_to: 0.01}\n")
                .find("2 points were taken out by `min_range` or by `crop`\n"),
            std::string::npos);
  EXPECT_EQ(refusal("r.rawlog", "map: {crop: [0, -1, -1, 2, 2, 2]}\n"), "");
}

TEST_F(Emptiness, BallsTooSmallToHoldAVoxelAreReportedWithTheResolutionThatTheyTake) {
  write_stroke();
  const std::string sentence = refusal("r.rawlog", small_setup + "map: {resolution: 0.2}\n");
  EXPECT_NE(sentence.find("holds a whole voxel of 200 mm; expected `resolution` (--resolution) of at most "),
            std::string::npos)
      << sentence;
  EXPECT_EQ(refusal("r.rawlog", small_setup + "map: {resolution: 0.001}\n"), "");
}

/// What was painted and erased, or undone, was not too small.
TEST(UnpaintedReason, IsGivenOnlyOfBallsThatAreTooSmallForTheVoxels) {
  Fusion fusion{{}, "none", FreeSpaceMap({.resolution = 0.01}), {}, {}, {}, {}, {}};
  fusion.counts.spheres = 10;
  fusion.counts.painted_radius = 0.0172;  // sqrt(3) voxels are 17.3 mm
  EXPECT_NE(unpainted_reason(fusion).find("at most 9.9 mm"), std::string::npos) << unpainted_reason(fusion);
  fusion.counts.painted_radius = 0.0174;
  EXPECT_EQ(unpainted_reason(fusion), "");
}

TEST_F(Emptiness, ImagesOfABagThatCannotBeUsedAreReportedWithTheReason) {
  worlds::CameraBag bag(folder_ / "r.mcap");
  bag.image("/image", 5, "lens", "mono12", 48, std::vector<std::uint8_t>(48 * 36));
  bag.write();
  const std::string sentence = refusal("r.mcap", small_setup + "source: {bag: {images: /image}}\n");
  EXPECT_NE(sentence.find("no camera image of it can be used: "), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("its encoding 'mono12' is not known here"), std::string::npos) << sentence;
}

TEST_F(Emptiness, PointsThatAllLieBeyondTheRangeAreReported) {
  write_scan("r.rawlog", {{1.0F, 0.0F, 0.0F}, {1.0F, 0.5F, 0.0F}});
  EXPECT_NE(refusal("r.rawlog", "map: {max_range: 0.8}\n").find("2 points lie beyond max_range"),
            std::string::npos);
  EXPECT_EQ(refusal("r.rawlog", "map: {max_range: 1.05}\n"), "");
}

TEST_F(Emptiness, PointsInMillimetresAreToldFromMetres) {
  write_scan("r.rawlog", {{1000.0F, 0.0F, 0.0F}, {1200.0F, 500.0F, 0.0F}, {50.0F, 0.0F, 0.0F}});
  EXPECT_NE(refusal("r.rawlog", "{}\n")
                .find("2 of its 3 points lie farther away than 300 m, expected metres, or map.max_range in "
                      "the setup"),
            std::string::npos)
      << refusal("r.rawlog", "{}\n");
  EXPECT_EQ(refusal("r.rawlog", "map: {max_range: 60}\n"), "");
  write_scan("far.rawlog", {{310.0F, 0.0F, 0.0F}, {50.0F, 0.0F, 0.0F}});  // half is not more than half
  EXPECT_EQ(refusal("far.rawlog", "map: {resolution: 0.5}\n"), "");
}

TEST_F(Emptiness, ScansWithoutPointsOrWithoutAPoseAreReported) {
  write_scan("bare.rawlog", {});
  EXPECT_NE(refusal("bare.rawlog", "{}\n").find("1 scan got into the map: there is no point in it"),
            std::string::npos);
  write_scan("r.rawlog", {{1.0F, 0.0F, 0.0F}});
  folder_.write("walk.txt", "1000 0 0 0 0 0 0 1\n1001 0 0 0 0 0 0 1\n");
  EXPECT_NE(refusal("r.rawlog", "sensors: [{name: laser, poses: walk.txt}]\n")
                .find("1 scan has no pose at its time"),
            std::string::npos);
}

/// Else scans of which the setup states the place are where their own file has them, or at the origin.
TEST_F(Emptiness, ASensorOfTheSetupThatNoScanIsOfIsRefusedOrTold) {
  write_scan("r.rawlog", {{1.0F, 0.0F, 0.0F}});
  const std::string sentence = refusal("r.rawlog", "sensors: [{name: lazer, pose: [0, 0, 1, 0, 0, 0]}]\n");
  EXPECT_NE(sentence.find("none that was used is of sensor 'lazer'"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("are of 'laser' (kind '"), std::string::npos) << sentence;
  EXPECT_EQ(refusal("r.rawlog", "{}\n"), "");
  const auto expect_told = [&](const std::string& recording, const std::string& sensors) {
    folder_.write("s.yaml", "sensors: [" + sensors + "{name: camera, pose: [0, 0, 1, 0, 0, 0]}]\n");
    const CommandRun run = run_command({"replay", folder_.file(recording), "--setup", folder_.file("s.yaml"),
                                        "--out", folder_.file("both"), "--no-plan"});
    EXPECT_EQ(run.status, exit_done) << run.log;
    EXPECT_NE((run.out + run.log).find("the setup's sensor 'camera' placed nothing"), std::string::npos)
        << run.out << run.log;
  };
  expect_told("r.rawlog", "{name: laser}, ");
  RecordingWriter writer(folder_ / "placed.rawlog");  // a recording that says itself where its laser was
  CloudFrame cloud;
  cloud.points = {{1.0F, 0.0F, 0.0F}};
  cloud.world_from_sensor.translation() = Eigen::Vector3d(0, 0, 0.5);
  writer.write(Frame{10.0, "laser", cloud});
  writer.finish();
  expect_told("placed.rawlog", "");
}

/// A hand of 45 mm, of which the error that is left open takes nearly all.
TEST_F(Emptiness, BodiesThatPaintNoVoxelAreReported) {
  write_scan("r.rawlog", {});
  std::string joints = "time, joint1, joint2, joint3, joint4, joint5, joint6\n";
  for (const char* time : {"10", "10.1", "10.2"}) joints += std::string(time) + ", 0, 0, 0, 0, 0, 0\n";
  folder_.write("j.csv", joints);
  const auto setup = [](const std::string& joint_error, const std::string& resolution) {
    return "robot: {name: arm6, joint_file: j.csv, paints: [hand], joint_error: " + joint_error +
           ", place_error: 0}\nmap: {resolution: " + resolution + "}\n";
  };
  const std::string sentence = refusal("r.rawlog", setup("0.003", "0.2"));
  EXPECT_NE(sentence.find("balls of the robot's bodies, of radius "), std::string::npos) << sentence;
  EXPECT_EQ(refusal("r.rawlog", setup("0.0001", "0.01")), "");
}

TEST_F(Emptiness, AWrongFixedFrameOfABagIsReportedWithTheFramesThatItHas) {
  std::filesystem::copy_file(
      std::filesystem::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/ros/bags/cdr_none.mcap",
      folder_ / "b.mcap");
  const std::string sentence = refusal("b.mcap", "source: {bag: {scans: [/scan], fixed_frame: nope}}\n");
  EXPECT_NE(sentence.find("no image and no scan of it can be used"), std::string::npos) << sentence;
  EXPECT_NE(sentence.find("no transform has 'nope'; frames of the bag: 'base'"), std::string::npos)
      << sentence;
  EXPECT_EQ(refusal("b.mcap", "source: {bag: {scans: [/scan], fixed_frame: /map}}\n"), "");
}

TEST_F(Emptiness, TheFolderOfARecorderIsReplayedUnlessItHoldsTwoKinds) {
  std::filesystem::create_directory(folder_ / "r");
  folder_.write("r/metadata.yaml", "rosbag2_bagfile_information:\n  version: 9\n");
  std::filesystem::copy_file(
      std::filesystem::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/ros/bags/cdr_none.mcap",
      folder_ / "r/r_0.mcap");
  const std::string setup = "source: {bag: {scans: [/scan], fixed_frame: map}}\n";
  EXPECT_EQ(refusal("r", setup), "");
  std::filesystem::remove_all(folder_ / "out");
  folder_.write("r/r_0.db3", "SQLite format 3");
  EXPECT_NE(refusal("r", setup).find("expected one kind"), std::string::npos);
}

TEST_F(Emptiness, DepthPicturesOfAnotherTimeThanTheirPosesAreReported) {
  std::filesystem::create_directories(folder_ / "d/depth");
  std::filesystem::create_directories(folder_ / "d/rgb");
  for (const char* time : {"10.0", "11.0"}) {
    folder_.write(std::string("d/depth/") + time + ".png",
                  picture_bytes(cv::Mat(12, 16, CV_16UC1, cv::Scalar(1000)), ".png"));
    folder_.write(std::string("d/rgb/") + time + ".png",
                  picture_bytes(cv::Mat(12, 16, CV_8UC1, cv::Scalar(9)), ".png"));
  }
  folder_.write("d/groundtruth.txt", "500 0 0 0 0 0 0 1\n501.5 0 0 0 0 0 0 1\n");
  const std::string sentence =
      refusal("d", "camera: {width: 16, height: 12, fx: 16, fy: 16, cx: 8, cy: 6}\n");
  EXPECT_NE(
      sentence.find("no depth picture has a pose within 0.02 s: pictures from 10 to 11 s, poses from 500 "
                    "to 501.5 s; its 2 images put nothing"),
      std::string::npos)
      << sentence;
}

TEST_F(Emptiness, JointsWhoseReadingsLieTooFarApartAreReported) {
  write_scan("r.rawlog", {{1.0F, 0.0F, 0.0F}});
  folder_.write("joints.csv", "time,shoulder,elbow\n9.5,0,0\n11.5,0,0\n");
  EXPECT_NE(refusal("r.rawlog", "robot: {name: planar2, joint_file: joints.csv}\n")
                .find("1 scan has no joints of the robot at its time (readings of joint 'shoulder' lie 2 s "
                      "apart, expected at most 0.5 s)"),
            std::string::npos);
}

TEST_F(Emptiness, ImagesWithoutAProbeAreReported) {
  write_stroke();
  const std::string without = small_setup.substr(0, small_setup.find("probe: {board"));
  EXPECT_NE(refusal("r.rawlog", without).find("6 images put nothing into a map without a probe"),
            std::string::npos);
}

TEST_F(Emptiness, TagsOfOtherBoardsAreReportedByTheirIds) {
  write_stroke();
  std::string other = small_setup;
  for (const char* id : {"id: 0,", "id: 1,", "id: 10,", "id: 11,", "id: 12,"})
    other = replaced(other, id, "id: 5" + std::string(id).substr(4));
  const std::string sentence = refusal("r.rawlog", other);
  EXPECT_NE(sentence.find("none of the tags in its 6 images (ids 0, 1, 10"), std::string::npos) << sentence;
}

TEST_F(Emptiness, SamplesThatAreAllRefusedAreReportedWithTheFirstReason) {
  write_stroke();
  const std::string wrong = replaced(small_setup, "width: 320, height: 240", "width: 640, height: 240");
  const std::string sentence = refusal("r.rawlog", wrong);
  EXPECT_NE(sentence.find("no ball was painted (image_refused 6; the first: the image has 320 x 240 pixels"),
            std::string::npos)
      << sentence;
}

TEST(Refusals, OfAProbeThatIsSeenExplainMoreThanThatItIsOutOfSightNowAndThen) {
  FusionCounts counts;
  counts.samples = {{"probe_not_seen", 152}, {"reprojection_error", 117}};
  counts.first_refusals = {{"probe_not_seen", "probe 'p' is not seen"},
                           {"reprojection_error", "its corners err"}};
  EXPECT_EQ(refusals_of(counts),
            "probe_not_seen 152, reprojection_error 117; the first reprojection_error: its corners err");
  counts.samples.erase("reprojection_error");
  EXPECT_EQ(refusals_of(counts), "probe_not_seen 152; the first: probe 'p' is not seen");
}

}  // namespace emptiness_test
}  // namespace clearway
