#include "datasets/simulation/simulate.hpp"

#include <apriltag.h>
#include <gtest/gtest.h>
#include <tag36h11.h>
#include <zlib.h>

#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/sample_frames.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace simulate_test {

using Json = nlohmann::json;

Scene prepared(const TemporaryFolder& folder, const std::string& scene = small_scene) {
  write_file(folder / "setup.yaml", small_setup);
  return parse_scene(scene, "scene.yaml", folder / "");
}

Eigen::Isometry3d pose_of(const Json& json) {
  Eigen::Isometry3d pose(Eigen::Translation3d(json[0], json[1], json[2]));
  pose.rotate(Eigen::Quaterniond(json[3], json[4], json[5], json[6]));
  return pose;
}

/// The truth of a scene whose recording and truth are the same with each of these numbers of threads.
std::string truth_on_any_threads(const Scene& scene, const TemporaryFolder& folder,
                                 const std::vector<const char*>& numbers) {
  std::string recording, truth;
  for (const char* threads : numbers) {
    setenv("CLEARWAY_THREADS", threads, 1);
    simulate(scene, folder / "out.rawlog");
    if (recording.empty()) {
      recording = read_file(folder / "out.rawlog");
      truth = read_file(folder / "truth.json");
    }
    EXPECT_EQ(read_file(folder / "out.rawlog"), recording) << threads;
    EXPECT_EQ(read_file(folder / "truth.json"), truth) << threads;
  }
  unsetenv("CLEARWAY_THREADS");
  return truth;
}

TEST(Simulate, TheSameSceneGivesTheSameBytesOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Scene scene = prepared(folder);
  truth_on_any_threads(scene, folder, {"1", "2", "5"});
  const std::string recording = read_file(folder / "out.rawlog");
  Scene other = scene;
  other.seed = 6;
  simulate(other, folder / "out.rawlog");
  EXPECT_NE(read_file(folder / "out.rawlog"), recording);
}

TEST(Simulate, TheRecordingHoldsSetupDepthAndPicturesInOrder) {
  const TemporaryFolder folder;
  const Scene scene = prepared(folder);
  double last = 0;
  const auto result = simulate(scene, folder / "out.rawlog", [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_EQ(last, 1);
  EXPECT_EQ(result.images, 6u);
  RecordingReader reader(folder / "out.rawlog");
  const auto frames = read_all(reader);
  EXPECT_FALSE(reader.damage());
  ASSERT_EQ(frames.size(), 1u + 2 + 6);
  EXPECT_EQ(std::get<CommentFrame>(frames[0].content).text, small_setup);
  EXPECT_EQ(std::get<CloudFrame>(frames[1].content).kind, "depth");
  for (size_t i = 1; i < frames.size(); ++i) EXPECT_GE(frames[i].time, frames[i - 1].time);
  const auto& image = std::get<ImageFrame>(frames[3].content);
  EXPECT_EQ(image.intrinsics, *scene.setup.camera);
  EXPECT_TRUE(image.world_from_sensor.isApprox(Eigen::Isometry3d::Identity()));
  const Json truth = Json::parse(read_file(folder / "truth.json"));
  ASSERT_EQ(truth["frames"].size(), 6u);
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(truth["frames"][i]["time"], frames[3 + i].time, 1e-6);
}

TEST(Simulate, TheTruthNamesTheFileThatItIsOf) {
  const TemporaryFolder folder;
  simulate(prepared(folder), folder / "out.rawlog");
  const std::string recording = read_file(folder / "out.rawlog");
  const auto sum = [&] {
    return ::crc32(0, reinterpret_cast<const Bytef*>(recording.data()), static_cast<uInt>(recording.size()));
  };
  const Json of_first = Json::parse(read_file(folder / "truth.json"))["recording"];
  EXPECT_EQ(of_first, (Json{{"bytes", recording.size()}, {"crc32", sum()}}));
  Scene other = prepared(folder);
  other.seed = 6;
  simulate(other, folder / "out.rawlog");
  EXPECT_NE(Json::parse(read_file(folder / "truth.json"))["recording"], of_first);
}

TEST(Simulate, TruthCornersAreWhatOpenCvProjects) {
  const TemporaryFolder folder;
  const Scene scene = prepared(folder);
  simulate(scene, folder / "out.rawlog");
  const auto& camera = *scene.setup.camera;
  const Json truth = Json::parse(read_file(folder / "truth.json"));
  size_t compared = 0;
  for (const auto& frame : truth["frames"]) {
    const Eigen::Isometry3d camera_from_map = pose_of(frame["map_from_camera"]).inverse();
    const Eigen::Isometry3d map_from_probe = pose_of(frame["map_from_probe"]);
    const Eigen::Vector3d ball = map_from_probe * scene.setup.probe->ball_center;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(frame["ball"][static_cast<size_t>(i)], ball[i], 1e-9);
    for (const auto& seen : frame["tags"]) {
      const BoardSetup& board = *scene.setup.board(seen["board"]);
      const auto tag = std::find_if(board.tags.begin(), board.tags.end(),
                                    [&](const TagSetup& candidate) { return candidate.id == seen["id"]; });
      const Eigen::Isometry3d camera_from_tag =
          camera_from_map * board.map_from_board.value_or(map_from_probe) * tag->board_from_tag;
      const double h = tag->size / 2;
      std::vector<cv::Point3d> corners;
      for (const Eigen::Vector3d& p : {Eigen::Vector3d(-h, h, 0), {h, h, 0}, {h, -h, 0}, {-h, -h, 0}}) {
        const Eigen::Vector3d q = camera_from_tag * p;
        corners.emplace_back(q.x(), q.y(), q.z());
      }
      std::vector<cv::Point2d> pixels;
      cv::projectPoints(corners, cv::Vec3d(), cv::Vec3d(),
                        cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1),
                        camera.distortion, pixels);
      for (size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(seen["corners"][i][0], pixels[i].x, 1e-6);
        EXPECT_NEAR(seen["corners"][i][1], pixels[i].y, 1e-6);
        ++compared;
      }
    }
  }
  EXPECT_EQ(compared, 6u * 5 * 4);
}

/// Tags by AprilTag, corners in the order and convention of truth.json.
std::map<int, std::vector<Eigen::Vector2d>> detected(const GrayImage& image) {
  apriltag_family_t* family = tag36h11_create();
  apriltag_detector_t* detector = apriltag_detector_create();
  apriltag_detector_add_family_bits(detector, family, 1);
  detector->quad_decimate = 1;
  std::vector<uint8_t> pixels = image.pixels;
  image_u8_t view{image.width, image.height, image.width, pixels.data()};
  zarray_t* found = apriltag_detector_detect(detector, &view);
  std::map<int, std::vector<Eigen::Vector2d>> tags;
  for (int i = 0; i < zarray_size(found); ++i) {
    apriltag_detection_t* detection;
    zarray_get(found, i, &detection);
    for (int corner : {3, 2, 1, 0})
      tags[detection->id].emplace_back(detection->p[corner][0] - 0.5, detection->p[corner][1] - 0.5);
  }
  apriltag_detections_destroy(found);
  apriltag_detector_destroy(detector);
  tag36h11_destroy(family);
  return tags;
}

TEST(Simulate, ADetectorFindsTheTagsWhereTheTruthPutsThem) {
  const TemporaryFolder folder;
  simulate(prepared(folder), folder / "out.rawlog");
  RecordingReader reader(folder / "out.rawlog");
  const Json truth = Json::parse(read_file(folder / "truth.json"));
  size_t index = 0, compared = 0;
  double squares = 0;
  for (const auto& frame : read_all(reader)) {
    const auto* image = std::get_if<ImageFrame>(&frame.content);
    if (!image) continue;
    auto found = detected(image->image);
    for (const auto& tag : truth["frames"][index++]["tags"]) {
      if (!tag["fully_visible"] || !found.contains(tag["id"])) continue;
      for (size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d corner(tag["corners"][i][0], tag["corners"][i][1]);
        const double error = (found[tag["id"]][i] - corner).norm();
        EXPECT_LT(error, 1) << "tag " << tag["id"] << " corner " << i;
        squares += error * error;
        ++compared;
      }
      found.erase(tag["id"]);
    }
  }
  EXPECT_GE(compared, 4u * 6 * 3);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(compared)), 0.2);
}

Scene person(const TemporaryFolder& folder) {
  write_file(folder / "setup.yaml", person_setup);
  return parse_scene(person_scene, "scene.yaml", folder / "");
}

TEST(Simulate, APersonWhoWalksGivesTheSameBytesOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  Scene scene = person(folder);
  scene.camera->exposure = 0.01;
  scene.hands->cover_share = 0.3;
  const std::string truth = truth_on_any_threads(scene, folder, {"1", "3"});
  const Json json = Json::parse(truth);
  const Json& drawn = json["drawn"];
  EXPECT_EQ(drawn["person"]["name"], "usual");
  EXPECT_EQ(drawn["camera"]["family"], "worn");
  EXPECT_EQ(drawn["camera"]["errors"]["dropped"], 0.1);
  EXPECT_EQ(drawn["depth"]["family"], "stereo");
  EXPECT_GT(drawn["covers"].size(), 0u);
  EXPECT_EQ(json["tags"].size(), 5u);
}

TEST(Simulate, AFingerHidesItsTagAndThePictureShowsTheRestWhereTheTruthSays) {
  const TemporaryFolder folder;
  const Scene scene = person(folder);
  simulate(scene, folder / "out.rawlog");
  RecordingReader reader(folder / "out.rawlog");
  const Json truth = Json::parse(read_file(folder / "truth.json"));
  std::size_t index = 0, covered = 0, seen_while_free = 0, compared = 0;
  double worst = 0;
  for (const auto& frame : read_all(reader)) {
    const auto* image = std::get_if<ImageFrame>(&frame.content);
    if (!image) continue;
    EXPECT_EQ(image->intrinsics, *scene.setup.camera);  // as stated, not as it is
    const Json& expected = truth["frames"][index++];
    EXPECT_NEAR(expected["time"], frame.time, 1e-6);
    auto found = detected(image->image);
    const bool is_covered = expected.contains("covered");
    if (is_covered) {
      EXPECT_EQ(expected["covered"], Json::array({11}));
      EXPECT_FALSE(found.contains(11));
      ++covered;
    } else {
      seen_while_free += found.contains(11);
    }
    for (const auto& tag : expected["tags"]) {
      if (is_covered && tag["id"] == 11) {
        EXPECT_FALSE(tag["fully_visible"]);
      }
      if (!tag["fully_visible"] || !found.contains(tag["id"])) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d corner(tag["corners"][i][0], tag["corners"][i][1]);
        worst = std::max(worst, (found[tag["id"]][i] - corner).norm());
        ++compared;
      }
    }
  }
  EXPECT_GT(covered, 2u);
  EXPECT_GT(seen_while_free, 2u);
  EXPECT_GT(compared, 80u);
  EXPECT_LT(worst, 1.0);
}

TEST(Simulate, DepthBesideThePicturesSeesTheProbeAndTheHandWhereTheyWereByTheOtherClock) {
  const TemporaryFolder folder;
  Scene scene = person(folder);
  scene.camera->errors = {};
  scene.depth->noise.reset();
  scene.depth->errors = {};
  scene.depth->errors.clock_offset = 0.05;
  simulate(scene, folder / "out.rawlog");
  const ProbeMotion motion(*scene.stroke, *scene.setup.probe);
  RecordingReader reader(folder / "out.rawlog");
  std::size_t clouds = 0, on_hand = 0, on_ball = 0;
  double last = 0;
  for (const auto& frame : read_all(reader)) {
    if (std::holds_alternative<CommentFrame>(frame.content)) continue;
    EXPECT_GE(frame.time, last - 1e-6);
    last = frame.time;
    const auto* cloud = std::get_if<CloudFrame>(&frame.content);
    if (!cloud) continue;
    ++clouds;
    const auto then = motion.at(frame.time - scene.start_time - 0.05);
    for (const auto& point : cloud->points) {
      const Eigen::Vector3d p = cloud->world_from_sensor * point.cast<double>();
      const double ball = std::abs((p - then.map_ball).norm() - scene.setup.probe->ball_radius);
      const Eigen::Vector3d q = then.map_from_probe.inverse() * p;
      const Eigen::Vector3d a(0, 0, 0.04), b(0.03, 0, 0.1);
      const double along = std::clamp((q - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      const double hand = std::abs((q - a - along * (b - a)).norm() - 0.025);
      on_ball += ball < 3e-4;
      on_hand += hand < 3e-4;
    }
  }
  EXPECT_EQ(clouds, 11u);
  EXPECT_GT(on_hand, 11u * 20);
  EXPECT_GT(on_ball, 11u * 5);
}

TEST(Simulate, BrightnessChangesThePicturesAndDetectionSuffers) {
  const TemporaryFolder folder;
  Scene scene = person(folder);
  scene.depth.reset();
  std::size_t tags[2] = {0, 0};
  const unsigned recordings = static_cast<unsigned>(trials(2, 4));
  for (scene.seed = 1; scene.seed <= recordings; ++scene.seed) {
    for (const int run : {0, 1}) {
      scene.camera->errors = {};
      scene.camera->errors.brightness = run == 0 ? 0.0 : 4.0;
      scene.camera->errors.noise = run == 0 ? 0.0 : 4.0;
      simulate(scene, folder / "out.rawlog");
      RecordingReader reader(folder / "out.rawlog");
      for (const auto& frame : read_all(reader))
        if (const auto* image = std::get_if<ImageFrame>(&frame.content))
          tags[run] += detected(image->image).size();
    }
  }
  EXPECT_GT(tags[0], 20u * recordings);
  EXPECT_LT(tags[1], tags[0] * 9 / 10);
}

TEST(Simulate, CloudsLieOnTheShapes) {
  const TemporaryFolder folder;
  Scene scene = prepared(folder);
  scene.depth->noise_constant = scene.depth->noise_quadratic = 0;
  simulate(scene, folder / "out.rawlog");
  RecordingReader reader(folder / "out.rawlog");
  for (const auto& frame : read_all(reader)) {
    const auto* cloud = std::get_if<CloudFrame>(&frame.content);
    if (!cloud) continue;
    EXPECT_GT(cloud->points.size(), 2000u);
    for (const auto& point : cloud->points) {
      const Eigen::Vector3d p = cloud->world_from_sensor * point.cast<double>();
      const double ball = std::abs((p - Eigen::Vector3d(-0.02, 0, 0.03)).norm() - 0.03);
      const double table = std::abs(p.z());
      const double side = std::abs(std::hypot(p.x() - 0.1, p.y()) - 0.02), lid = std::abs(p.z() - 0.06);
      EXPECT_LT(std::min({ball, table, side, lid}), 1e-4);
    }
  }
}

TEST(Simulate, IncludedFramesKeepTheirPlaceInTheOtherWorld) {
  const TemporaryFolder folder;
  RecordingWriter writer(folder / "other.rawlog");
  std::mt19937 random(3);
  const CloudFrame cloud = sample_cloud(random, 12);
  writer.write({50, "lidar", cloud});
  writer.write({51, "other", sample_cloud(random, 3)});
  writer.write({52, "camera", sample_image(random, 8, 6)});
  writer.finish();
  const std::string include =
      "setup: setup.yaml\ninclude: [{recording: other.rawlog, world_from_map: [1, 2, 3, 0, 0, 0.5], "
      "sensors: [lidar]}]";
  const auto result = simulate(prepared(folder, include), folder / "out.rawlog");
  EXPECT_EQ(result.included_frames, 1u);
  RecordingReader reader(folder / "out.rawlog");
  const auto frames = read_all(reader);
  ASSERT_EQ(frames.size(), 2u);
  const auto& copied = std::get<CloudFrame>(frames[1].content);
  EXPECT_EQ(copied.points, cloud.points);
  const Eigen::Isometry3d world_from_map =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE((world_from_map * copied.world_from_sensor).isApprox(cloud.world_from_sensor, 1e-9));
}

TEST(Simulate, UnusableIncludesAndOutputsLeaveNothingBehind) {
  const TemporaryFolder folder;
  write_file(folder / "bad.rawlog", "not a log");
  const std::string include = "setup: setup.yaml\ninclude: [{recording: bad.rawlog}]";
  EXPECT_NE(complaint([&] { simulate(prepared(folder, include), folder / "out.rawlog"); }).find("bad.rawlog"),
            std::string::npos);
  for (const auto& entry : std::filesystem::directory_iterator(folder / "")) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "bad.rawlog" || name.ends_with(".yaml")) << name;
  }
  EXPECT_THROW(simulate(prepared(folder), folder / "no/folder/out.rawlog"), std::runtime_error);
}

TEST(Simulate, NoDeviceFolderOrTruthIsReplacedByTheRecording) {
  const TemporaryFolder folder;
  EXPECT_THROW(simulate(prepared(folder), "/dev/null"), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
  std::filesystem::create_directory(folder / "out.rawlog");
  EXPECT_THROW(simulate(prepared(folder), folder / "out.rawlog"), std::runtime_error);
  EXPECT_NE(complaint([&] { simulate(prepared(folder), folder / "truth.json"); }).find("truth"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "truth.json"));
}

TEST(Simulate, ATruthOfOthersIsKeptAndItsOwnIsReplaced) {
  const TemporaryFolder folder;
  write_file(folder / "truth.json", "{\"mine\": true}");
  EXPECT_NE(complaint([&] { simulate(prepared(folder), folder / "out.rawlog"); }).find("truth.json"),
            std::string::npos);
  EXPECT_EQ(read_file(folder / "truth.json"), "{\"mine\": true}");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.rawlog"));
  std::filesystem::remove(folder / "truth.json");
  simulate(prepared(folder), folder / "out.rawlog");
  EXPECT_EQ(complaint([&] { simulate(prepared(folder), folder / "out.rawlog"); }), "");
  const std::string truth = read_file(folder / "truth.json");
  EXPECT_NE(
      complaint([&] { simulate(prepared(folder), folder / "second.rawlog"); }).find("another recording"),
      std::string::npos);
  EXPECT_EQ(read_file(folder / "truth.json"), truth);
  EXPECT_FALSE(std::filesystem::exists(folder / "second.rawlog"));
}

TEST(Simulate, ANameThatSaysAnotherFormatIsRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"out.bag", "out.mcap", "out", "out.rawlog.gz"})
    EXPECT_NE(complaint([&] { simulate(prepared(folder), folder / name); }).find("ends in .rawlog"),
              std::string::npos);
}

}  // namespace simulate_test
}  // namespace clearway
