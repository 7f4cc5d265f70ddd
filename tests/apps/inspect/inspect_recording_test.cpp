// inspect: what recordings hold.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>

#include "datasets/bags/mcap_writer.hpp"
#include "datasets/sources/recording.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/bytes/picture_bytes.hpp"
#include "tests/worlds/bytes/sens_bytes.hpp"

namespace clearway {
namespace inspect_recording_test {

using Json = nlohmann::json;

/// A camera's images, a laser and odometry, from 100 s on.
void write_rawlog(const std::filesystem::path& file) {
  RecordingWriter recording(file);
  recording.write({100.0, "", CommentFrame{"name: kitchen"}});
  for (int i = 0; i < 5; ++i) {
    const double time = 100.0 + 0.25 * i;
    recording.write({time, "base", OdometryFrame{}});
    recording.write({time, "eye",
                     ImageFrame{{4, 3, std::vector<std::uint8_t>(12, 7)},
                                {4, 3, 4, 4, 2, 1.5, {}},
                                Eigen::Isometry3d::Identity()}});
    if (i > 2)
      recording.write(
          {time, "laser", CloudFrame{{{1, 0, 0}, {2, 0, 0}}, Eigen::Isometry3d::Identity(), 0.0, "points"}});
  }
  recording.finish();
}

TEST(InspectRecording, ListsSensorsWithKindsFramesPointsAndTimes) {
  const TemporaryFolder folder;
  write_rawlog(folder.path() / "r.rawlog");
  const CommandRun run = run_command({"inspect", (folder.path() / "r.rawlog").string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  const Json sensors = Json::parse(run.out).at("sensors");
  ASSERT_EQ(sensors.size(), 4u);
  const auto expect = [&](std::size_t at, const std::string& sensor, const std::string& kind, int frames,
                          int points, double first, double last) {
    EXPECT_EQ(sensors[at], (Json{{"sensor", sensor},
                                 {"kind", kind},
                                 {"frames", frames},
                                 {"points", points},
                                 {"first_s", first},
                                 {"last_s", last}}));
  };
  expect(0, "", "comment", 1, 0, 100.0, 100.0);
  expect(1, "base", "odometry", 5, 0, 100.0, 101.0);
  expect(2, "eye", "image 4 x 3", 5, 0, 100.0, 101.0);
  expect(3, "laser", "points", 2, 4, 100.75, 101.0);
  const CommandRun text = run_command({"inspect", (folder.path() / "r.rawlog").string()});
  EXPECT_NE(text.out.find("laser"), std::string::npos) << text.out;
}

TEST(InspectRecording, ListsTheDepthOfASensAndSaysWhatOthersPack) {
  const TemporaryFolder folder;
  const SensPictures frame{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                           1500000,
                           picture_bytes(cv::Mat(72, 96, CV_8UC3, cv::Scalar(9, 9, 9)), ".jpg"),
                           std::vector<std::uint16_t>(48 * 36, 2000)};
  const CommandRun run = run_command({"inspect", folder.write("s.sens", sens_bytes({frame})), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  const Json sensors = Json::parse(run.out).at("sensors");
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_EQ(sensors[0].at("kind"), "image 96 x 72");
  EXPECT_EQ(sensors[1].at("points"), 48 * 36);
  const CommandRun packed = run_command({"inspect", folder.write("room.r3d", "PK")});
  EXPECT_EQ(packed.status, exit_bad_input);
  EXPECT_NE(packed.log.find("is Record3D's, whose depth is packed"), std::string::npos) << packed.log;
}

TEST(InspectRecording, ListsTheTopicsOfABag) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "b.mcap";
  McapWriter bag(file);
  const std::uint16_t tip = bag.add_topic("/tip", "std_msgs/msg/String", "string data\n");
  bag.add_topic("/idle", "std_msgs/msg/String", "string data\n");
  for (int i = 0; i < 3; ++i) bag.write(tip, 1.0 + i, std::string("\0\1\0\0\1\0\0\0\0", 9));
  bag.finish();
  const CommandRun run = run_command({"inspect", file.string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  EXPECT_EQ(Json::parse(run.out).at("topics"),
            (Json{{{"name", "/idle"}, {"type", "std_msgs/String"}, {"messages", 0}},
                  {{"name", "/tip"},
                   {"type", "std_msgs/String"},
                   {"messages", 3},
                   {"first_s", 1.0},
                   {"last_s", 3.0}}}));
}

TEST(InspectRecording, ListsFramesAndEncodingsOfABagsTopics) {
  const std::string bag = CLEARWAY_SOURCE_DIR "/tests/datasets/ros/bags/cdr_none.mcap";
  const CommandRun run = run_command({"inspect", bag, "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  std::set<std::string> frames, encodings;
  const Json json = Json::parse(run.out);
  for (const Json& topic : json.at("topics")) {
    frames.insert(topic.value("frame", ""));
    encodings.insert(topic.value("encoding", ""));
  }
  EXPECT_TRUE(frames.contains("camera")) << run.out;
  EXPECT_TRUE(encodings.contains("16UC1")) << run.out;
  const CommandRun text = run_command({"inspect", bag});
  EXPECT_NE(text.out.find("encoding"), std::string::npos) << text.out;
}

TEST(InspectRecording, TopicsByClocksThatDifferAreShown) {
  const TemporaryFolder folder;
  for (const double ahead : {0.0, -0.9, -37.0}) {
    worlds::ScanBag bag(folder / "b.mcap");
    bag.cloud("/a", 100.0, "a", {{1, 2, 3}});
    bag.cloud("/b", {100.0, 100.0 + ahead}, "b", {{1, 2, 3}});
    bag.write();
    const CommandRun run = run_command({"inspect", folder.file("b.mcap")});
    const bool is_far = ahead == -37.0;
    EXPECT_EQ(run.out.find("stamp - recording s") != std::string::npos, is_far) << run.out;
    EXPECT_EQ(run.log.find("topics '/b' and '/a' are of clocks that differ by 37 s") != std::string::npos,
              is_far)
        << run.log;
    const Json json = Json::parse(run_command({"inspect", folder.file("b.mcap"), "--json"}).out);
    EXPECT_NEAR(json.at("topics")[1].at("clock_offset_s").get<double>(), ahead, 1e-6);
  }
}

TEST(InspectRecording, AFolderOfDepthPicturesIsListedWithoutItsCamera) {
  const TemporaryFolder folder;
  for (const char* name : {"1.5", "2.5", "4.5"}) {
    std::filesystem::create_directories(folder / "depth");
    std::filesystem::create_directories(folder / "rgb");
    folder.write("depth/" + std::string(name) + ".png",
                 picture_bytes(cv::Mat_<std::uint16_t>(3, 4, 900), ".png"));
    folder.write("rgb/" + std::string(name) + ".png", picture_bytes(cv::Mat_<std::uint8_t>(6, 8, 9), ".png"));
  }
  folder.write("groundtruth.txt", "1.5 0 0 0 0 0 0 1\n");
  const CommandRun run = run_command({"inspect", folder.path().string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  const Json json = Json::parse(run.out), sensors = json.at("sensors");
  ASSERT_EQ(sensors.size(), 2U);
  EXPECT_EQ(
      sensors[0],
      (Json{{"sensor", "depth"}, {"kind", "depth 4 x 3"}, {"frames", 3}, {"first_s", 1.5}, {"last_s", 4.5}}));
  EXPECT_EQ(sensors[1].at("kind"), "colour 8 x 6");
  EXPECT_TRUE(json.at("poses").get<std::string>().ends_with("groundtruth.txt"));
}

TEST(InspectRecording, AFolderOfNeitherMapNorFramesIsAskedForItsMap) {
  const TemporaryFolder folder;
  const CommandRun run = run_command({"inspect", folder.path().string()});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.log.find("holds no map.ot"), std::string::npos) << run.log;
}

TEST(InspectRecording, ListsTheFramesOfABagWithTheirParents) {
  const std::string bag = CLEARWAY_SOURCE_DIR "/tests/datasets/ros/bags/cdr_none.mcap";
  const CommandRun run = run_command({"inspect", bag, "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  const Json frames = Json::parse(run.out).at("frames");
  ASSERT_GE(frames.size(), 2U);
  EXPECT_EQ(frames[0], (Json{{"name", "base"}, {"parent", "map"}, {"moves", true}}));
  EXPECT_EQ(frames[1], (Json{{"name", "camera"}, {"parent", "base"}, {"moves", false}}));
  const CommandRun text = run_command({"inspect", bag});
  EXPECT_NE(text.out.find("parent"), std::string::npos) << text.out;
}

TEST(InspectRecording, TheFolderOfARecorderIsListedAsABagIs) {
  const TemporaryFolder folder;
  folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 9\n");
  std::filesystem::copy_file(CLEARWAY_SOURCE_DIR "/tests/datasets/ros/bags/cdr_none.mcap",
                             folder / "r_0.mcap");
  const CommandRun run = run_command({"inspect", folder.path().string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.log;
  EXPECT_EQ(Json::parse(run.out).at("topics").size(), 8U);
  std::filesystem::remove(folder / "metadata.yaml");  // copied without it
  const CommandRun bare = run_command({"inspect", folder.path().string(), "--json"});
  ASSERT_EQ(bare.status, 0) << bare.log;
  EXPECT_EQ(Json::parse(bare.out).at("topics"), Json::parse(run.out).at("topics"));
}

TEST(InspectRecording, ACutBagIsListedAsFarAsItGoesAndSaysSo) {
  const TemporaryFolder folder;
  const std::string whole = read_file(CLEARWAY_SOURCE_DIR "/tests/datasets/ros/bags/cdr_none.mcap");
  const std::string file = folder.write("b.mcap", whole.substr(0, whole.size() * 2 / 3));
  const CommandRun run = run_command({"inspect", file, "--json"});
  EXPECT_EQ(run.status, 3) << run.log;
  EXPECT_FALSE(Json::parse(run.out).at("topics").empty());
  EXPECT_NE(Json::parse(run.out).at("damage").get<std::string>().find("b.mcap' is damaged: "),
            std::string::npos);
  EXPECT_NE(run.log.find("is damaged: "), std::string::npos) << run.log;
}

TEST(InspectRecording, ADamagedOneIsListedAsFarAsItGoesAndSaysSo) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "r.rawlog";
  write_rawlog(file);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) * 2 / 3);
  const CommandRun run = run_command({"inspect", file.string(), "--json"});
  EXPECT_EQ(run.status, 3);
  const Json json = Json::parse(run.out);
  EXPECT_GT(json.at("sensors").size(), 1u);
  EXPECT_NE(json.at("damage").get<std::string>().find("r.rawlog"), std::string::npos);
}

TEST(InspectRecording, WhatOnlyAMapAnswersIsRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"r.rawlog", "r.bag", "r.mp4"}) {
    const CommandRun run = run_command({"inspect", (folder.path() / name).string(), "--holes"});
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("not a map"), std::string::npos) << run.log;
  }
}

}  // namespace inspect_recording_test
}  // namespace clearway
