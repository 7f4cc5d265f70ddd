// Bags that others' code wrote (bags/README.md), and ROS 1 bags that rosbag_storage writes here.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/calib3d.hpp>

#include "datasets/bags/bag_source.hpp"
#include "datasets/ros/transform_tree.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bag_topics.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/bags/ros1_bag_writer.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace bag_test {

namespace fs = std::filesystem;
using worlds::all_topics;

fs::path bag(const std::string& name) {
  return fs::path(CLEARWAY_SOURCE_DIR) / "tests/datasets/ros/bags" / name;
}

struct Reading {
  std::vector<Frame> frames;
  std::optional<std::string> damage;
  std::vector<std::string> warnings;

  std::vector<Frame> of(const std::string& sensor) const {
    std::vector<Frame> found;
    for (const Frame& frame : frames)
      if (frame.sensor == sensor) found.push_back(frame);
    return found;
  }
};

Reading read(const fs::path& file, const SourceOptions& options) {
  const auto source = open_bag(file, options);
  Reading reading;
  while (auto frame = source->next()) reading.frames.push_back(std::move(*frame));
  reading.damage = source->damage();
  reading.warnings = source->warnings();
  return reading;
}

Eigen::Isometry3d pose(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

/// What write_bag.mjs puts in.
void expect_the_written(const Reading& reading) {
  EXPECT_FALSE(reading.damage) << *reading.damage;
  EXPECT_TRUE(reading.warnings.empty()) << reading.warnings.front();
  ASSERT_EQ(reading.frames.size(), 16U);
  for (int i = 0; i < 4; ++i) {
    const double time = 100.25 + i;
    const Frame image = reading.of("/camera/image").at(static_cast<std::size_t>(i));
    EXPECT_DOUBLE_EQ(image.time, time);
    const auto& picture = std::get<ImageFrame>(image.content);
    EXPECT_EQ(picture.image.width, 4);
    EXPECT_EQ(picture.image.height, 3);
    for (int k = 0; k < 12; ++k)
      EXPECT_EQ(picture.image.pixels[static_cast<std::size_t>(k)], 10 * i + k / 4 * 6 + k % 4);
    EXPECT_EQ(picture.intrinsics,
              (CameraIntrinsics{4, 3, 100, 110, 1.5, 1, {0.1, -0.2, 0.001, 0.002, 0.03}}));
    const Eigen::Isometry3d& camera = picture.world_from_sensor;
    EXPECT_TRUE(camera.translation().isApprox(Eigen::Vector3d(0.25 + i + 0.1, 0.2, 0.5), 1e-9));
    EXPECT_TRUE(camera.linear().col(2).isApprox(Eigen::Vector3d::UnitX(), 1e-9)) << "it looks along x";
    EXPECT_TRUE(camera.linear().col(0).isApprox(-Eigen::Vector3d::UnitY(), 1e-9));

    const auto depth =
        std::get<CloudFrame>(reading.of("/camera/depth").at(static_cast<std::size_t>(i)).content);
    EXPECT_EQ(depth.kind, "depth");
    ASSERT_EQ(depth.points.size(), 11U) << "a pixel of 0 is no return";
    const double z = 1.0 + 0.001 * i;  // of the first pixel
    const Eigen::Vector3d first = depth.world_from_sensor * depth.points[0].cast<double>();
    std::vector<cv::Point2d> ray;
    cv::undistortPoints(std::vector<cv::Point2d>{{0, 0}}, ray, cv::Matx33d(100, 0, 1.5, 0, 110, 1, 0, 0, 1),
                        std::vector<double>{0.1, -0.2, 0.001, 0.002, 0.03});
    const Eigen::Vector3d seen = camera * Eigen::Vector3d(z * ray[0].x, z * ray[0].y, z);
    EXPECT_TRUE(first.isApprox(seen, 1e-6)) << first.transpose();

    const auto cloud = std::get<CloudFrame>(reading.of("/points").at(static_cast<std::size_t>(i)).content);
    ASSERT_EQ(cloud.points.size(), 3U) << "neither NaN nor the origin";
    EXPECT_EQ(cloud.points[2], Eigen::Vector3f(-1, -2, static_cast<float>(i)));
    EXPECT_TRUE(cloud.world_from_sensor.isApprox(pose(0.25 + i, 0, 0.3), 1e-9));

    const auto scan = std::get<CloudFrame>(reading.of("/scan").at(static_cast<std::size_t>(i)).content);
    EXPECT_EQ(scan.kind, "laser2d");
    EXPECT_NEAR(scan.max_range, 30, 1e-6);
    ASSERT_EQ(scan.points.size(), 2U) << "an infinite range is no return";
    EXPECT_TRUE(scan.points[0].isApprox(Eigen::Vector3f(2 * std::cos(-0.5F), 2 * std::sin(-0.5F), 0), 1e-6F));
    EXPECT_TRUE(scan.points[1].isApprox(Eigen::Vector3f(4 * std::cos(0.5F), 4 * std::sin(0.5F), 0), 1e-6F));
  }
  // In the order of their recording: a scan was recorded before the image of its time, a cloud after it.
  EXPECT_EQ(reading.frames[0].sensor, "/scan");
  EXPECT_EQ(reading.frames[3].sensor, "/points");
}

TEST(Bag, ReadsMcapFilesOfBothWiresAndEveryCompression) {
  for (const char* name : {"cdr_none.mcap", "cdr_lz4.mcap", "cdr_zstd.mcap", "ros1_none.mcap"}) {
    SCOPED_TRACE(name);
    expect_the_written(read(bag(name), all_topics()));
  }
}

TEST(Bag, ReadsARos1BagThatRosbagWrote) {
  const TemporaryFolder folder;
  for (const char* packed : {"none", "lz4", "bz2"}) {
    worlds::write_ros1_bag(folder / "a.bag", bag("ros1_none.mcap"), packed);
    expect_the_written(read(folder / "a.bag", all_topics()));
    EXPECT_EQ(list_bag(folder / "a.bag").size(), 8U);
  }
}

/// A record of a ROS 1 bag: its head, fields of which one says what it is, and its data.
struct Ros1Record {
  std::size_t at = 0, data = 0, end = 0;
  char op = 0;
};

std::vector<Ros1Record> ros1_records(const std::string& bag) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &bag.at(at), sizeof value);
    return value;
  };
  std::vector<Ros1Record> records;
  for (std::size_t at = bag.find('\n') + 1; at < bag.size(); at = records.back().end) {
    const std::size_t head = number(at), data = at + 8 + head;
    const std::size_t op = bag.find("op=", at + 4);
    records.push_back({at, data, data + number(data - 4), bag.at(op + 3)});
  }
  return records;
}

TEST(Bag, ARos1BagWhoseRecorderWasEndedIsReadByItsRecords) {
  const TemporaryFolder folder;
  for (const char* packed : {"none", "lz4", "bz2"}) {
    SCOPED_TRACE(packed);
    worlds::write_ros1_bag(folder / "a.bag", bag("ros1_none.mcap"), packed);
    const std::string whole = read_file(folder / "a.bag");
    const std::vector<Ros1Record> records = ros1_records(whole);
    constexpr char head = 3, chunk = 5;
    ASSERT_EQ(records.at(0).op, head);
    ASSERT_EQ(records.at(1).op, chunk);
    // Without an index, as the head says then, and without what lies behind the chunk.
    std::string killed = whole.substr(0, records[1].end);
    const std::size_t place = killed.find("index_pos=") + 10;
    std::fill_n(killed.begin() + static_cast<std::ptrdiff_t>(place), 8, '\0');
    folder.write("a.bag", killed);
    Reading reading = read(folder / "a.bag", all_topics());
    ASSERT_TRUE(reading.damage);
    EXPECT_NE(reading.damage->find("it has no whole index, as its recorder was ended"), std::string::npos)
        << *reading.damage;
    reading.damage.reset();
    expect_the_written(reading);
    EXPECT_EQ(list_bag(folder / "a.bag").size(), 8U);
    folder.write("a.bag", whole.substr(0, records[1].end));  // cut: the head names an index beyond the end
    Reading cut = read(folder / "a.bag", all_topics());
    EXPECT_TRUE(cut.damage);
    cut.damage.reset();
    expect_the_written(cut);
    folder.write("a.bag.active", killed);
    EXPECT_TRUE(is_bag_file(folder / "a.bag.active"));
    EXPECT_EQ(read(folder / "a.bag.active", all_topics()).frames.size(), 16U);
    folder.write("a.bag", whole.substr(0, records[1].data - 1));
    const std::string sentence = complaint([&] { list_bag(folder / "a.bag"); });
    EXPECT_NE(sentence.find("expected it after `rosbag reindex`"), std::string::npos) << sentence;
  }
}

/// rosbag_storage follows the head's index_pos wherever it leads, and ends the process where that is no
/// record.
TEST(Bag, AHeadThatNamesAnotherPlaceForTheIndexCostsNothing) {
  const TemporaryFolder folder;
  worlds::write_ros1_bag(folder / "a.bag", bag("ros1_none.mcap"), "none");
  const std::string whole = read_file(folder / "a.bag");
  const std::size_t place = whole.find("index_pos=") + 10;
  std::uint64_t said = 0;
  std::memcpy(&said, &whole[place], sizeof said);
  for (const std::uint64_t index :
       {said - 1, said + 1, said + 4, said / 2, std::uint64_t{13}, std::uint64_t{1}, whole.size() - 5,
        whole.size() + 100, std::uint64_t{1} << 62U}) {
    SCOPED_TRACE(index);
    std::string wrong = whole;
    std::memcpy(&wrong[place], &index, sizeof index);
    folder.write("a.bag", wrong);
    Reading reading = read(folder / "a.bag", all_topics());
    EXPECT_TRUE(reading.damage);
    reading.damage.reset();
    expect_the_written(reading);
  }
}

TEST(Bag, AChunkThatARos1RecorderHadNotEndedIsReadUpToItsLastWholeMessage) {
  const TemporaryFolder folder;
  worlds::write_ros1_bag(folder / "a.bag", bag("ros1_none.mcap"), "none");
  const std::string whole = read_file(folder / "a.bag");
  const Ros1Record chunk = ros1_records(whole).at(1);
  std::string killed = whole.substr(0, chunk.end);
  const std::size_t place = killed.find("size=", chunk.at) + 5;
  std::fill_n(killed.begin() + static_cast<std::ptrdiff_t>(place), 4, '\0');
  std::fill_n(killed.begin() + static_cast<std::ptrdiff_t>(chunk.data) - 4, 4, '\0');
  std::size_t last = 16;
  for (std::size_t size = killed.size(); size > chunk.data + 3000; size -= 301) {
    folder.write("a.bag", killed.substr(0, size));
    const Reading reading = read(folder / "a.bag", all_topics());
    EXPECT_TRUE(reading.damage);
    EXPECT_LE(reading.frames.size(), last);
    last = reading.frames.size();
    if (size == killed.size()) {
      EXPECT_EQ(last, 16U);
    }
  }
  EXPECT_LT(last, 16U);
  EXPECT_GT(last, 0U);
}

TEST(Bag, TheFolderOfARecorderIsReadFileByFileInTheOrderOfTimes) {
  const TemporaryFolder folder;
  folder.write("metadata.yaml", "rosbag2_bagfile_information:\n  version: 9\n");
  fs::copy_file(bag("cdr_none.mcap"), folder / "r_2.mcap");
  EXPECT_TRUE(is_bag_folder(folder.path()));
  expect_the_written(read(folder.path(), all_topics()));
  fs::copy_file(bag("cdr_zstd_unended.mcap"), folder / "r_10.mcap");
  const Reading twice = read(folder.path(), all_topics());
  EXPECT_TRUE(twice.frames.empty());
  ASSERT_TRUE(twice.damage);
  EXPECT_NE(twice.damage->find("holds more than one run of its clock"), std::string::npos) << *twice.damage;
  fs::remove(folder / "r_2.mcap");
  worlds::ScanBag before(folder / "r_11.mcap");
  for (const double time : {51.0, 52.0}) before.cloud("/points", time, "map", {{1, 2, 3}});
  before.transform(51.0, "map", "base", pose(0, 0, 0));
  before.write();
  const Reading both = read(folder.path(), all_topics());
  ASSERT_EQ(both.frames.size(), 18U);
  EXPECT_EQ(both.frames[0].time, 51.0);
  ASSERT_TRUE(both.damage);
  EXPECT_NE(both.damage->find("of its 'r_10.mcap': "), std::string::npos) << *both.damage;
  const std::vector<BagTopic> topics = list_bag(folder.path());
  ASSERT_EQ(topics.size(), 8U);
  EXPECT_EQ(topics[6].count, 10U);
  folder.write("r_1.mcap", "no bag");
  const Reading without = read(folder.path(), all_topics());
  EXPECT_EQ(without.frames.size(), 18U);  // as if it was not there
  ASSERT_TRUE(without.damage);
  EXPECT_NE(without.damage->find("of its 'r_1.mcap': "), std::string::npos) << *without.damage;
  for (const char* name : {"r_10.mcap", "r_11.mcap"}) folder.write(name, "no bag");
  EXPECT_NE(complaint([&] { list_bag(folder.path()); }).find("of its 'r_1.mcap': "), std::string::npos);
}

TEST(Bag, ListsTopicsTypesAndMessages) {
  for (const char* name : {"cdr_zstd.mcap", "ros1_none.mcap", "cdr_zstd_unended.mcap"}) {
    SCOPED_TRACE(name);
    const std::vector<BagTopic> topics = list_bag(bag(name));
    ASSERT_EQ(topics.size(), 8U);
    EXPECT_EQ(topics[0].name, "/camera/camera_info");
    EXPECT_EQ(topics[0].type, "sensor_msgs/CameraInfo");
    EXPECT_EQ(topics[0].count, 1U);
    EXPECT_EQ(topics[6].name, "/tf");
    EXPECT_EQ(topics[6].count, 9U);
  }
}

TEST(Bag, AFileWithoutAnEndIsReadUpToThere) {
  const Reading reading = read(bag("cdr_zstd_unended.mcap"), all_topics());
  EXPECT_EQ(reading.frames.size(), 16U);
  ASSERT_TRUE(reading.damage);
  EXPECT_NE(reading.damage->find("ends early"), std::string::npos) << *reading.damage;
}

TEST(Bag, AFlippedByteOfAChunkCostsThatChunkAndIsReported) {
  const TemporaryFolder folder;
  const std::string whole = read_file(bag("cdr_zstd.mcap"));
  int damaged = 0;
  for (std::size_t at = 100; at < whole.size(); at += 61) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    folder.write("a.mcap", bytes);
    Reading reading;
    if (!complaint([&] { reading = read(folder / "a.mcap", all_topics()); }).empty()) continue;
    EXPECT_LE(reading.frames.size(), 16U);
    EXPECT_TRUE(reading.damage || !reading.warnings.empty() || reading.frames.size() == 16U) << at;
    damaged += reading.damage.has_value();
  }
  EXPECT_GT(damaged, 10);
}

TEST(Bag, SaysWhatItHasWhereATopicIsMissingOrOfAnotherType) {
  const auto refused = [](auto change) {
    SourceOptions options = all_topics();
    change(options);
    return complaint([&] { open_bag(bag("cdr_none.mcap"), options); });
  };
  const std::string missing = refused([](SourceOptions& o) { o.bag.images = "/kamera"; });
  EXPECT_NE(missing.find("has no topic '/kamera'"), std::string::npos) << missing;
  EXPECT_NE(missing.find("'/camera/image' ('sensor_msgs/Image')"), std::string::npos) << missing;
  const std::string other = refused([](SourceOptions& o) { o.bag.scans = {"/points"}; });
  EXPECT_NE(other.find("expected sensor_msgs/LaserScan"), std::string::npos) << other;
  const std::string none = refused([](SourceOptions& o) { o.bag = {}; });
  EXPECT_NE(none.find("the setup names none"), std::string::npos) << none;
  const std::string camera = refused([](SourceOptions& o) { o.bag.camera_info.clear(); });
  EXPECT_NE(camera.find("expected 'camera_info'"), std::string::npos) << camera;
  EXPECT_NE(complaint([&] { list_bag(fs::path(CLEARWAY_SOURCE_DIR) / "README.md"); }).find("MCAP"),
            std::string::npos);
}

TEST(Bag, RectifiedImagesAndACameraOfTheSetupWithADistortionAreRefused) {
  const TemporaryFolder folder;
  worlds::CameraBag bag(folder / "a.mcap");
  const std::vector<std::uint8_t> pixels(48 * 36);
  for (const char* topic : {"/image_rect", "/image"}) bag.image(topic, 5, "lens", "mono8", 48, pixels);
  bag.write();
  CameraIntrinsics bent{48, 36, 50, 52, 24, 18, {0.1}};
  const auto refusal = [&](auto change) {
    SourceOptions options;
    change(options);
    return complaint([&] { open_bag(folder / "a.mcap", options); });
  };
  const std::string named = refusal([&](SourceOptions& o) {
    o.bag.images = "/image_rect";
    o.camera = bent;
  });
  EXPECT_NE(named.find("has rectified images in topic '/image_rect', by its name or 'rectified', and the "
                       "setup's camera has a distortion; expected"),
            std::string::npos)
      << named;
  const std::string depth = refusal([&](SourceOptions& o) {
    o.bag.depth = {{"/image", ""}};
    o.bag.depth_rectified = true;
    o.depth.camera = bent;
  });
  EXPECT_NE(depth.find("by its name or 'depth_rectified'"), std::string::npos) << depth;
  for (const bool is_pinhole : {false, true}) {
    SourceOptions options;
    options.bag.images = "/image_rect";
    if (is_pinhole) bent.distortion = {};
    if (!is_pinhole) options.bag.rectified = false;
    options.camera = bent;
    const Reading reading = read(folder / "a.mcap", options);
    ASSERT_EQ(reading.frames.size(), 1U);
    EXPECT_EQ(std::get<ImageFrame>(reading.frames[0].content).intrinsics.is_rectified, is_pinhole);
  }
}

TEST(Bag, FramesWithoutAPoseAreLeftOutAndReported) {
  SourceOptions options = all_topics();
  options.bag.fixed_frame = "moon";
  const Reading reading = read(bag("cdr_none.mcap"), options);
  EXPECT_TRUE(reading.frames.empty());
  ASSERT_EQ(reading.warnings.size(), 4U);
  EXPECT_NE(reading.warnings[0].find("frame 'camera' is not known in 'moon': no transform has 'moon'; frames "
                                     "of the bag: 'base', 'camera', "),
            std::string::npos)
      << reading.warnings[0];
}

TEST(Bag, SensorsThatAreTakenToStandStillAlthoughThereAreFramesAreReported) {
  SourceOptions options;
  options.bag.scans = {"/scan"};
  const Reading reading = read(bag("cdr_none.mcap"), options);
  EXPECT_EQ(reading.frames.size(), 4U);
  ASSERT_EQ(reading.warnings.size(), 1U);
  EXPECT_NE(
      reading.warnings[0].find("are taken to stand still: the setup names no 'source: bag: fixed_frame'; "
                               "frames of the bag: 'base', 'camera', 'laser', 'map'"),
      std::string::npos)
      << reading.warnings[0];
  options.placed = {"laser2d"};
  EXPECT_TRUE(read(bag("cdr_none.mcap"), options).warnings.empty()) << "the setup says where it is";
}

}  // namespace bag_test
}  // namespace clearway
