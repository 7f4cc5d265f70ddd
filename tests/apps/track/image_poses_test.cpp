#include "apps/track/image_poses.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "datasets/descriptions/scene.hpp"
#include "datasets/poses/tum_poses.hpp"
#include "datasets/simulation/simulate.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace image_poses_test {

using Json = nlohmann::json;

Eigen::Isometry3d pose_of(const Json& v) {
  Eigen::Isometry3d pose(Eigen::Quaterniond(v[3].get<double>(), v[4], v[5], v[6]));
  pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

Eigen::Matrix<double, 6, 6> covariance_of(const Json& rows) {
  Eigen::Matrix<double, 6, 6> covariance;
  for (int i = 0; i < 36; ++i)
    covariance(i / 6, i % 6) = rows[static_cast<std::size_t>(i / 6)][static_cast<std::size_t>(i % 6)];
  return covariance;
}

/// A rendered stroke before tags, with exact truth.
class ImagePosesOfAStroke : public testing::Test {
 protected:
  void SetUp() override {
    setup_ = small_setup;
    setup_.replace(setup_.find("ball_radius: 0.02"), 17, "ball_radius: 0.02, tracking_error: 0.012");
    folder_.write("setup.yaml", setup_);
    Scene scene = parse_scene(small_scene, "small scene", folder_ / "");
    scene.depth.reset();
    simulate(scene, folder_ / "r.rawlog");
    truth_ = Json::parse(read_file(folder_ / "truth.json"));
  }
  CommandRun track(std::vector<std::string> flags) {
    std::vector<std::string> arguments{"track", folder_.file("r.rawlog")};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return run_command(arguments);
  }
  /// The pose of an image of the JSON form; null when it is not there.
  static const Json* find(const Json& image, const std::string& kind, const std::string& name,
                          const std::string& frame) {
    for (const Json& pose : image["poses"])
      if (pose["kind"] == kind && pose["name"] == name && pose["frame"] == frame) return &pose;
    return nullptr;
  }
  Eigen::Isometry3d map_from_ball(const Json& frame) const {
    Eigen::Isometry3d probe_from_ball = Eigen::Isometry3d::Identity();
    probe_from_ball.translation() = Eigen::Vector3d(0, 0, -0.08);
    return pose_of(frame["map_from_probe"]) * probe_from_ball;
  }
  TemporaryFolder folder_;
  std::string setup_;
  Json truth_;
};

TEST_F(ImagePosesOfAStroke, CameraProbeAndBallAreWhereTheTruthHasThemWithinTheirCovariance) {
  const CommandRun run = track({"--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json json = Json::parse(run.out);
  ASSERT_EQ(json["images"].size(), truth_["frames"].size());
  double worst = 0.0;
  int poses = 0;
  for (std::size_t i = 0; i < json["images"].size(); ++i) {
    const Json &image = json["images"][i], &frame = truth_["frames"][i];
    EXPECT_NEAR(image["time"].get<double>(), frame["time"].get<double>(), 1e-6);
    const std::map<std::string, Eigen::Isometry3d> expected = {{"camera", pose_of(frame["map_from_camera"])},
                                                               {"body", pose_of(frame["map_from_probe"])},
                                                               {"ball", map_from_ball(frame)}};
    for (const auto& [kind, pose] : expected) {
      const Json* found = find(image, kind, kind == "body" ? "probe" : kind, "map");
      if (found == nullptr || (*found)["status"] != "accepted") continue;
      ++poses;
      const auto covariance = covariance_of((*found)["covariance"]);
      EXPECT_TRUE(covariance.isApprox(covariance.transpose()));
      const Eigen::Isometry3d off = pose_of((*found)["pose"]).inverse() * pose;
      const Eigen::AngleAxisd turn(off.linear());
      Eigen::Matrix<double, 6, 1> error;  // (v, w): true pose = pose * [Exp(w), v]
      error << off.translation(), turn.angle() * turn.axis();
      const Json& by = (*found)["bound_by"];
      EXPECT_LE(off.translation().norm(), (*found)["bound"].get<double>()) << kind;
      EXPECT_GE((*found)["bound"].get<double>(),
                0.99 * std::max(by["noise"].get<double>(), by["tilt"].get<double>()))
          << kind;
      worst = std::max(worst, Cholesky(covariance).squared(error));
    }
  }
  EXPECT_GE(poses, 9);
  EXPECT_LT(worst, 40.0);  // chi-square of six: 22.5 in one of a thousand
}

TEST_F(ImagePosesOfAStroke, ATagAloneHasThePoseThatItsBoardGivesIt) {
  const Json json = Json::parse(track({"--json"}).out);
  Eigen::Isometry3d base_from_tag(Eigen::AngleAxisd(-1.5, Eigen::Vector3d::UnitZ()));
  base_from_tag.translation() = Eigen::Vector3d(0.06, 0.09, 0);
  int seen = 0;
  for (const Json& image : json["images"]) {
    const Json *tag = find(image, "tag", "0", "camera"), *base = find(image, "body", "base", "camera");
    if (tag == nullptr || !tag->contains("pose") || !base->contains("pose")) continue;
    ++seen;
    EXPECT_LT(
        (pose_of((*tag)["pose"]).translation() - (pose_of((*base)["pose"]) * base_from_tag).translation())
            .norm(),
        0.005);
    EXPECT_EQ((*tag)["tags"], Json::array({0}));
  }
  EXPECT_GT(seen, 3);
}

/// As of the sheet of another setup.
TEST_F(ImagePosesOfAStroke, WhereABoardIsNotSeenTheTagsThatAreSeenAreNamed) {
  const auto renamed = [this](std::string text, const std::vector<std::string>& ids) {
    for (const std::string& id : ids)
      text.replace(text.find("{id: " + id + ", "), 5 + id.size(),
                   "{id: 3" + (id.size() == 1 ? "0" + id : id));
    return folder_.write("other.yaml", text);
  };
  const CommandRun one = track({"--json", "--setup", renamed(setup_, {"0", "1"})});
  ASSERT_EQ(one.status, exit_done) << one.log;
  const Json image = Json::parse(one.out)["images"][0];
  EXPECT_EQ((*find(image, "body", "base", "camera"))["reason"].get<std::string>().find(
                "none of its tags is seen, but tags 0, 1, 1"),
            0U)
      << image;
  EXPECT_EQ((*find(image, "ball", "ball", "map"))["reason"].get<std::string>().find(
                "base 'base' is not seen, but tags 0, 1, 1"),
            0U);
  const CommandRun none = track({"--setup", renamed(setup_, {"0", "1", "10", "11", "12"})});
  EXPECT_NE(none.log.find("none of the tags in its 6 images (ids 0, 1, 10"), std::string::npos) << none.log;
  EXPECT_NE(none.log.find(") is on a board of the setup"), std::string::npos) << none.log;
}

TEST_F(ImagePosesOfAStroke, CsvJsonAndTumHoldTheSamePosesOnAnyThreads) {
  const CommandRun run = track({"--csv", folder_.file("p.csv"), "--json", folder_.file("p.json"),
                                "--tum-probe", folder_.file("probe.txt"), "--tum-camera",
                                folder_.file("camera.txt"), "--draw", folder_.file("drawn")});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("probe in the map"), std::string::npos);
  const Json json = Json::parse(read_file(folder_ / "p.json"));
  std::istringstream lines(read_file(folder_ / "p.csv"));
  std::string line;
  std::getline(lines, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  EXPECT_EQ(columns, 16 + 21 + 7);
  const PoseStream probe = load_tum_poses(folder_ / "probe.txt", 0.5);
  load_tum_poses(folder_ / "camera.txt", 0.5);
  std::size_t accepted = 0;
  for (const Json& image : json["images"]) {
    for (const Json& pose : image["poses"]) {
      ASSERT_TRUE(std::getline(lines, line));
      EXPECT_EQ(std::count(line.begin(), line.end(), ',') >= columns, true) << line;
      EXPECT_NE(line.find("," + pose["status"].get<std::string>() + ","), std::string::npos) << line;
      if (pose["kind"] != "body" || pose["name"] != "probe" || pose["frame"] != "map" ||
          pose["status"] != "accepted")
        continue;
      ++accepted;
      const auto pose_then = probe.nearest(image["time"]);
      ASSERT_TRUE(pose_then);
      EXPECT_LT((pose_then->translation() - pose_of(pose["pose"]).translation()).norm(), 1e-9);
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
  EXPECT_EQ(probe.size(), accepted);
  EXPECT_EQ(track({"--threads", "3"}).out, read_file(folder_ / "p.csv"));
  EXPECT_EQ(track({"--threads", "1"}).out, read_file(folder_ / "p.csv"));
}

TEST_F(ImagePosesOfAStroke, DrawnPicturesAreTheImagesWithColouredMarks) {
  ASSERT_EQ(track({"--csv", folder_.file("p.csv"), "--draw", folder_.file("drawn")}).status, exit_done);
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "drawn")) {
    if (entry.path().extension() != ".png") continue;
    ++pictures;
    const cv::Mat picture = cv::imread(entry.path().string());
    ASSERT_EQ(picture.cols, 320);
    int coloured = 0;
    for (int i = 0; i < picture.rows * picture.cols; ++i) {
      const cv::Vec3b& pixel = picture.at<cv::Vec3b>(i / picture.cols, i % picture.cols);
      coloured += pixel[0] != pixel[1] || pixel[1] != pixel[2] ? 1 : 0;
    }
    EXPECT_GT(coloured, 100);
    EXPECT_LT(coloured, 320 * 240 / 4);
  }
  EXPECT_EQ(pictures, 6);
  ASSERT_EQ(track({"--csv", folder_.file("p.csv"), "--draw", folder_.file("drawn")}).status,
            exit_done);  // again
}

TEST_F(ImagePosesOfAStroke, ATagThatIsNotOnItsBoardIsNamedAsLeftOut) {
  std::string other = setup_;
  const std::size_t tag = other.find("- {id: 10,");
  other.erase(tag, other.find("- {id: 11,") - tag);
  other.insert(other.find("- {id: 1,"), "- {id: 10, size: 0.04}\n      ");
  folder_.write("other.yaml", other);
  const CommandRun run = track({"--setup", folder_.file("other.yaml"), "--json"});
  const Json json = Json::parse(run.out);
  int named = 0;
  for (const Json& image : json["images"]) {
    const Json* base = find(image, "body", "base", "camera");
    if (base == nullptr || !base->contains("left_out")) continue;
    for (const Json& left : (*base)["left_out"])
      named += left["id"] == 10 && left["reason"] == "contradicted";
  }
  EXPECT_GE(named, 4);
  EXPECT_NE(track({"--setup", folder_.file("other.yaml")}).out.find("10:contradicted"), std::string::npos);
}

// No camera is on build machines; see video_test for how its pictures are read.
TEST_F(ImagePosesOfAStroke, ACameraThatIsNotThereIsOneSentence) {
  const CommandRun run =
      run_command({"track", "--camera", "217", "--seconds", "1", "--setup", folder_.file("setup.yaml")});
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("camera '/dev/video217': there is no such camera"), std::string::npos) << run.log;
  const CommandRun bare = run_command({"track", "--camera", "217"});
  EXPECT_EQ(bare.status, exit_bad_input);
  EXPECT_NE(bare.log.find("a camera has no setup; expected --setup"), std::string::npos) << bare.log;
  const CommandRun both = run_command({"track", folder_.file("r.rawlog"), "--camera", "0"});
  EXPECT_EQ(both.status, exit_bad_input) << both.out;
  EXPECT_EQ(run_command({"track"}).status, exit_bad_input);
}

TEST_F(ImagePosesOfAStroke, WhatIsRefusedSaysWhy) {
  std::string other = setup_;
  other.replace(other.find("id: 10,"), 7, "id: 99,");  // the probe's tag 10 is on no board
  folder_.write("other.yaml", other + "acceptance: {max_reprojection_px: 0.000001}\n");
  const CommandRun run = track({"--setup", folder_.file("other.yaml"), "--json"});
  EXPECT_EQ(run.status, exit_done);  // poses are there, with the reason why they are not trusted
  const Json image = Json::parse(run.out)["images"][0];
  const Json* base = find(image, "body", "base", "camera");
  EXPECT_EQ((*base)["status"], "reprojection_error");
  EXPECT_NE((*base)["reason"].get<std::string>().find("more than the errors that are stated explain"),
            std::string::npos);
  EXPECT_EQ((*find(image, "tag", "10", "camera"))["status"], "unknown_tag");
  folder_.write("strange.yaml", setup_.substr(0, setup_.find("boards:")) +
                                    "boards: [{name: far, tags: [{id: 500, size: 0.05}]}]\n");
  const CommandRun strange = track({"--setup", folder_.file("strange.yaml"), "--json"});
  EXPECT_EQ(strange.status, exit_no);
  EXPECT_NE(strange.log.find("none of the tags in its 6 images (ids 0, 1, 10, 11) is on a board"),
            std::string::npos)
      << strange.log;
}

TEST_F(ImagePosesOfAStroke, BadInputIsOneSentenceAndWritesNothing) {
  folder_.write("bare.yaml", "title: none\n");
  folder_.write("small.yaml", "camera: {width: 64, height: 48, fx: 60, fy: 60, cx: 32, cy: 24}\n" +
                                  setup_.substr(setup_.find("boards:")));
  for (const auto& [flags, words] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--setup", folder_.file("bare.yaml")}, "expected `boards`"},
           {{"--csv", folder_.file("r.rawlog")}, "is read by SOURCE"},
           {{"--csv", folder_.file("no/where.csv")}, "no/where.csv"},
           {{"--setup", folder_.file("nowhere.yaml")}, "nowhere.yaml"}}) {
    const CommandRun run = track(flags);
    EXPECT_EQ(run.status, exit_bad_input) << words;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
  }
  const CommandRun run = track({"--setup", folder_.file("small.yaml")});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_NE(run.log.find("none of its 6 images is the camera's: the image has 320 x 240 pixels"),
            std::string::npos)
      << run.log;
}

/// The photographs of AprilTag's repository: tags of one size on the ground and on boxes, their true corners
/// beside them.
TEST(ImagePosesOfPhotographs, EachTagOfThePhotographsGetsAPose) {
  const char* shared = std::getenv("CLEARWAY_SHARED_DATA");
  const std::filesystem::path photographs =
      std::filesystem::path(shared != nullptr ? shared : "/work/shared/data") / "apriltag_repo";
  if (!std::filesystem::exists(photographs)) GTEST_SKIP() << "no photographs in " << photographs;
  const TemporaryFolder folder;
  int photographs_seen = 0;
  for (const auto& entry : std::filesystem::directory_iterator(photographs)) {
    if (entry.path().extension() != ".jpg") continue;
    ++photographs_seen;
    const cv::Mat picture = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    const std::string width = std::to_string(picture.cols), height = std::to_string(picture.rows);
    folder.write("setup.yaml", "camera: {width: " + width + ", height: " + height +
                                   ", fx: 800, fy: 800, cx: " + std::to_string(picture.cols / 2) +
                                   ", cy: " + std::to_string(picture.rows / 2) +
                                   "}\nboards: [{name: box, tags: [{id: 0, size: 0.05}, {id: 1, size: "
                                   "0.05}]}]\ndetector: {max_hamming: 2, min_margin: 0}\n");
    std::istringstream truth(read_file(std::filesystem::path(entry.path()).replace_extension(".txt")));
    std::map<int, int> true_tags, tags;
    for (std::string line; std::getline(truth, line);)
      if (!line.empty()) ++true_tags[std::stoi(line)];
    const CommandRun run =
        run_command({"track", entry.path().string(), "--setup", folder.file("setup.yaml"), "--json"});
    const Json image = Json::parse(run.out)["images"].at(0);
    EXPECT_EQ(image["file"], entry.path().filename().string());
    for (const Json& pose : image["poses"]) {
      if (pose["kind"] != "tag") continue;
      ++tags[std::stoi(pose["name"].get<std::string>())];
      if (pose["status"] == "unknown_tag") continue;
      ASSERT_TRUE(pose.contains("pose")) << pose;
      EXPECT_GT(pose["pose"][2].get<double>(), 0.1);
      EXPECT_LT(pose["pose"][2].get<double>(), 20.0);
    }
    EXPECT_LE(tags[0], true_tags[0]) << entry.path();
    EXPECT_GE(tags[0], true_tags[0] - 3) << entry.path();  // tags that touch the border are left out
  }
  EXPECT_EQ(photographs_seen, 3);
}

}  // namespace image_poses_test
}  // namespace clearway
