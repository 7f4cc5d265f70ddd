#include "apps/overlay/replay_pictures.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "datasets/pictures/video.hpp"
#include "datasets/simulation/simulate.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace replay_pictures_test {

/// A disc of 2 cm that slides above the table: from left to right, and from a place that nobody painted.
const std::string queries = R"(
map: {resolution: 0.005, min_range: 0.05, max_range: 2.0}
volumes: [{label: tool}]
robot: {name: point, scale: 0.1, base: [0, 0, 0.15, 0, 0, 0]}
queries:
  - {name: across, start: [-0.05, 0], goals: [[0.06, 0.03]], planners: [rrtconnect], policies: {default: not_occupied}}
  - {name: unpainted, start: [-0.05, 0], goals: [[0.06, 0.03]], planners: [rrtconnect], policies: {base: painted}}
)";

class ReplayPictures : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    folder_->write("setup.yaml", small_setup + queries);
    simulate(parse_scene(small_scene, "small scene", *folder_ / ""), *folder_ / "r.rawlog");
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }

  static CommandRun replay(const std::vector<std::string>& more, const std::string& recording = "r.rawlog") {
    std::vector<std::string> arguments{"replay", folder_->file(recording), "--out", folder_->file("map"),
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ReplayPictures::folder_ = nullptr;

TEST_F(ReplayPictures, stills_of_each_plan_are_written_and_are_the_same_each_time) {
  const std::vector<std::string> names{"across-rrtconnect-start.png", "across-rrtconnect-goal.png",
                                       "across-rrtconnect-tightest.png", "unpainted-rrtconnect-to_paint.png"};
  const CommandRun run = replay({"--overlay", folder_->file("stills")});
  EXPECT_EQ(run.status, exit_no) << run.log;  // one of the plans is not solved
  ASSERT_EQ(replay({"--overlay", folder_->file("again"), "--threads", "1"}).status, exit_no);
  std::vector<cv::Mat> pictures;
  for (const std::string& name : names) {
    const std::string bytes = read_file(*folder_ / "stills" / name);
    EXPECT_EQ(bytes, read_file(*folder_ / "again" / name)) << name;
    pictures.push_back(cv::imread(folder_->file("stills/" + name), cv::IMREAD_COLOR));
    EXPECT_EQ(pictures.back().size(), cv::Size(320, 240)) << name;
  }
  EXPECT_GT(cv::norm(pictures[0], pictures[1], cv::NORM_INF), 50.0);
  EXPECT_GT(cv::norm(pictures[0], pictures[3], cv::NORM_INF), 50.0);
}

TEST_F(ReplayPictures, without_plans_there_is_a_picture_of_the_paint) {
  ASSERT_EQ(replay({"--overlay", folder_->file("paint"), "--no-plan"}).status, exit_done);
  EXPECT_FALSE(cv::imread(folder_->file("paint/painted.png")).empty());
}

TEST_F(ReplayPictures, the_video_holds_the_recording_and_the_motion) {
  const CommandRun run = replay({"--video-out", folder_->file("film.mp4")});
  ASSERT_EQ(run.status, exit_no) << run.log;
  EXPECT_TRUE(run.log.empty()) << run.log;
  const auto pictures = open_video(*folder_ / "film.mp4", {});
  int count = 0;
  double second = 0.0;
  while (const auto frame = pictures->next()) {
    if (count == 1) second = frame->time;
    EXPECT_EQ(std::get<ImageFrame>(frame->content).image.width, 320);
    ++count;
  }
  EXPECT_NEAR(second, 0.1, 1e-3);  // the scene's camera has 10 pictures a second
  EXPECT_GT(count, 5 + 3);         // images of the recording, and some of the motion
}

TEST_F(ReplayPictures, without_images_there_is_one_sentence_and_the_map) {
  std::filesystem::create_directories(*folder_ / "scans");
  folder_->write(
      "scans/1.pcd",
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1.05 0.05 0.05\n");
  const CommandRun run = replay({"--overlay", folder_->file("none")}, "scans");
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_NE(run.log.find("holds none"), std::string::npos) << run.log;
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "none"));
  EXPECT_TRUE(std::filesystem::exists(*folder_ / "map" / "map.ot"));
}

TEST_F(ReplayPictures, what_cannot_be_written_or_read_twice_is_refused_before_the_work) {
  for (const auto& [flag, value, words] :
       {std::tuple{"--overlay", folder_->file("map"), "another folder than --out"},
        {"--video-out", folder_->file("film.mkv"), "--video-out: expected a file name that ends in .mp4"},
        {"--record", folder_->file("rec.txt"), "--record: expected a file name that ends in .mcap"},
        {"--video-out", folder_->file("no/such/folder/film.mp4"), "no/such/folder"}}) {
    const CommandRun run = replay({flag, value});
    EXPECT_EQ(run.status, exit_bad_input) << flag;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
  }
  EXPECT_THROW(require_pictures({"stills", ""}, "/dev/video0", "map"), std::invalid_argument);
  EXPECT_NO_THROW(require_pictures({}, "/dev/video0", "map"));
}

}  // namespace replay_pictures_test
}  // namespace clearway
