// Where and when the scans of bags were taken, with transforms that come late, twice, or of two runs.

#include "datasets/ros/bag_frames.hpp"

#include <gtest/gtest.h>

#include <lz4frame.h>

#include <cmath>
#include <cstring>

#include "datasets/ros/bag_source.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/bags/scan_bag.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace bag_frames_test {

using worlds::BagTime;
using worlds::ScanBag;

/// Where the base is: on a line, turning.
Eigen::Isometry3d base_at(double time) {
  return Eigen::Translation3d(0.1 * time, -0.4, 0.3) *
         Eigen::AngleAxisd(0.3 * time, Eigen::Vector3d::UnitZ());
}
Eigen::Isometry3d elsewhere_at(double time) { return Eigen::Translation3d(0, 1, 0) * base_at(time); }
Eigen::Isometry3d mount() {
  return Eigen::Translation3d(0.1, 0.05, 0.5) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
}

class BagFramesTest : public ::testing::Test {
 protected:
  struct Reading {
    std::vector<Frame> frames;
    std::string damage, warnings;
  };
  Reading read(const ScanBag& bag, const std::string& name, bool clear_infinite = false,
               const BagTopics& part = {}) {
    bag.write();
    SourceOptions options;
    options.bag = part;
    options.clear_infinite = clear_infinite;
    (name.starts_with("sweep") ? options.bag.scans
                               : options.bag.clouds) = {name.starts_with("sweep") ? "/scan" : "/points"};
    options.bag.fixed_frame = "map";
    options.resolution = 0.05;
    const auto source = open_bag(folder_ / name, options);
    Reading reading;
    while (auto frame = source->next()) reading.frames.push_back(std::move(*frame));
    reading.damage = source->damage().value_or("");
    for (const std::string& warning : source->warnings()) reading.warnings += warning + "\n";
    return reading;
  }
  static void expect_pose(const Frame& frame, const Eigen::Isometry3d& expected) {
    const auto& cloud = std::get<CloudFrame>(frame.content);
    EXPECT_TRUE(cloud.world_from_sensor.isApprox(expected, 1e-5)) << frame.time << '\n'
                                                                  << cloud.world_from_sensor.matrix();
  }
  TemporaryFolder folder_;
};

/// Scans at these times, and the base's poses between 10 and 13 s, recorded `delay` s later.
void add_run(ScanBag& bag, double later, double delay = 0.0) {
  bag.transform(later + 10, "base", "sensor", mount(), true);
  for (double time = 10; time < 13.001; time += 0.05)
    bag.transform({later + time + delay, time}, "map", "base", base_at(time));
  for (const double time : {10.53, 11.11, 11.97, 12.41})
    bag.cloud("/points", {later + time + 0.01, time}, "sensor", {{1, 2, 3}});
}

TEST_F(BagFramesTest, TransformsThatAreRecordedLatePlaceScansAsThoseInTime) {
  for (const char* name : {"late.mcap", "late.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0, 0.4);
    const Reading reading = read(bag, name);
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 4U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  }
}

TEST_F(BagFramesTest, MessagesThatLieInAnyOrderAreTakenByTheirTimes) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    ScanBag bag(folder_ / "a.mcap");
    add_run(bag, 0, 0.4);
    bag.shuffle(seed);
    const Reading reading = read(bag, "a.mcap");
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 4U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  }
}

TEST_F(BagFramesTest, AFolderOfASplitBagIsReadAsTheWholeOne) {
  ScanBag first(folder_ / "run_2021_0.bag"), second(folder_ / "run_2021_1.bag");
  first.transform(10, "base", "sensor", mount(), true);
  for (double time = 10; time < 13.001; time += 0.05)
    (time < 11.5 ? first : second).transform(time, "map", "base", base_at(time));
  for (const double time : {10.53, 11.11, 11.97, 12.41})
    (time < 11.5 ? first : second).cloud("/points", time, "sensor", {{1, 2, 3}});
  for (ScanBag* bag : {&first, &second}) {
    bag->sort();
    bag->write();
  }
  EXPECT_TRUE(is_bag_folder(folder_.path()));
  const Reading reading = read(first, "");
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 4U);
  for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  folder_.write("notes.txt", "of the run");
  EXPECT_FALSE(is_bag_folder(folder_.path()));
}

TEST_F(BagFramesTest, ARunAfterTheClockWasResetIsRefused) {
  for (const char* name : {"runs.mcap", "runs.bag"}) {
    ScanBag bag(folder_ / name);
    for (const double later : {0.0, 10.0}) add_run(bag, later);
    const Reading reading = read(bag, name);
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(
        reading.damage.find("holds more than one run of its clock: the stamps of '/tf', frame 'base', jump "
                            "back by 3 s at message 62 of 122"),
        std::string::npos)
        << reading.damage;
  }
}

TEST_F(BagFramesTest, TheTimeThatTheRefusalNamesPartsTheRuns) {
  for (const char* name : {"runs.mcap", "runs.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    for (double time = 10; time < 13.001; time += 0.05)  // the mount is that of tf_static in the first run
      bag.transform({20 + time, time}, "map", "base", elsewhere_at(time));
    for (const double time : {10.51, 11.13, 12.33})
      bag.cloud("/points", {20.01 + time, time}, "sensor", {{1, 2, 3}});
    const std::string sentence = read(bag, name).damage;
    const std::size_t at = sentence.find("`to: ");
    ASSERT_NE(at, std::string::npos) << sentence;
    BagTopics part;
    part.to = std::stod(sentence.substr(at + 5));
    EXPECT_NE(sentence.find("`from: " + sentence.substr(at + 5, sentence.find('`', at + 5) - at - 4)),
              std::string::npos);
    Reading reading = read(bag, name, false, part);
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 4U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
    part.from = std::exchange(part.to, std::nullopt).value();
    reading = read(bag, name, false, part);
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 3U);
    for (const Frame& frame : reading.frames) expect_pose(frame, elsewhere_at(frame.time) * mount());
  }
}

TEST_F(BagFramesTest, PosesShortlyBesideAPartPlaceWhatIsSeenInIt) {
  for (const char* name : {"a.mcap", "a.bag"}) {
    ScanBag bag(folder_ / name);
    bag.transform(10, "base", "sensor", mount(), true);
    for (double time = 10; time < 13.3; time += 0.8) bag.transform(time, "map", "base", base_at(time));
    for (const double time : {10.3, 11.3, 12.0, 12.7}) bag.cloud("/points", time, "sensor", {{1, 2, 3}});
    bag.sort();
    BagTopics part;
    part.from = 1.2;
    part.to = 2.1;
    const Reading reading = read(bag, name, false, part);
    EXPECT_EQ(reading.damage + reading.warnings, "");
    ASSERT_EQ(reading.frames.size(), 2U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  }
}

TEST_F(BagFramesTest, PosesOfTheRunBesideAPartDoNot) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (double time = 10; time < 13.001; time += 0.05)
    bag.transform({3.3 + time, time}, "map", "base", elsewhere_at(time));
  for (const double time : {10.02, 11.13, 12.33})
    bag.cloud("/points", {3.31 + time, time}, "sensor", {{1, 2, 3}});
  BagTopics part;
  part.from = 3.2;
  Reading reading = read(bag, "a.mcap", false, part);
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 3U);
  for (const Frame& frame : reading.frames) expect_pose(frame, elsewhere_at(frame.time) * mount());
  part.to = std::exchange(part.from, 0.0);
  reading = read(bag, "a.mcap", false, part);
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 4U);
  for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
}

TEST_F(BagFramesTest, ScansWithoutAStampAreToldAndOnesBefore1970Refused) {
  for (const char* name : {"a.mcap", "a.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    for (const double time : {10.9, 11.9}) bag.cloud("/points", {time, 0}, "sensor", {{1, 2, 3}});
    bag.sort();
    const Reading reading = read(bag, name);
    EXPECT_EQ(reading.damage, "");
    EXPECT_NE(reading.warnings.find("holds 2 of 6 messages of '/points' without a stamp; the times of "
                                    "recording are taken"),
              std::string::npos)
        << reading.warnings;
    ASSERT_EQ(reading.frames.size(), 6U);
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  }
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  bag.cloud("/points", {12.9, -4.5}, "sensor", {{1, 2, 3}});
  const Reading reading = read(bag, "a.mcap");
  EXPECT_TRUE(reading.frames.empty());
  EXPECT_NE(reading.damage.find("has a message in topic '/points' whose stamp is -4.5 s"), std::string::npos)
      << reading.damage;
}

/// A record's length and the record of a ROS 1 bag at `at`: its head and its data.
std::pair<std::string, std::string> record_at(const std::string& bag, std::size_t& at) {
  const auto part = [&] {
    std::uint32_t length = 0;
    std::memcpy(&length, bag.data() + at, sizeof length);
    at += sizeof length + length;
    return bag.substr(at - length, length);
  };
  const std::string head = part();
  return {head, part()};
}

std::string behind_length(const std::string& text) {
  const auto length = static_cast<std::uint32_t>(text.size());
  return std::string(reinterpret_cast<const char*>(&length), sizeof length) + text;
}

/// The same bag with chunks that liblz4 packs, and an index that is wrong now.
std::string packed_bag(const std::string& bag, const LZ4F_frameInfo_t& form) {
  std::size_t at = bag.find('\n') + 1;
  std::string packed = bag.substr(0, at);
  while (at < bag.size()) {
    auto [head, data] = record_at(bag, at);
    if (const std::size_t none = head.find("compression=none"); none != std::string::npos) {
      head.replace(none - 4, 20, behind_length("compression=lz4"));
      LZ4F_preferences_t preferences{};
      preferences.frameInfo = form;
      if (form.contentSize != 0) preferences.frameInfo.contentSize = data.size();
      std::string frame(LZ4F_compressFrameBound(data.size(), &preferences), '\0');
      frame.resize(LZ4F_compressFrame(frame.data(), frame.size(), data.data(), data.size(), &preferences));
      data = frame;
    }
    packed += behind_length(head) + behind_length(data);
  }
  return packed;
}

TEST_F(BagFramesTest, ChunksThatOtherProgramsPackedWithLz4AreRead) {
  ScanBag bag(folder_ / "a.bag");
  add_run(bag, 0);
  bag.cloud("/others", 12.5, "sensor", std::vector<Eigen::Vector3f>(30'000, {1, 2, 3}));  // several blocks
  bag.shuffle(3);
  bag.write();
  const std::string whole = read_file(folder_ / "a.bag");
  SourceOptions options;
  options.bag.clouds = {"/points"};
  options.bag.fixed_frame = "map";
  for (const bool has_size : {false, true})
    for (const auto blocks : {LZ4F_blockIndependent, LZ4F_blockLinked})
      for (const auto checksum : {LZ4F_noContentChecksum, LZ4F_contentChecksumEnabled}) {
        LZ4F_frameInfo_t form{};
        form.blockMode = blocks;
        form.contentChecksumFlag = checksum;
        form.contentSize = has_size ? 1 : 0;
        const std::string packed = packed_bag(whole, form);
        const std::size_t frame_at = packed.find("\x04\x22\x4d\x18");
        ASSERT_NE(frame_at, std::string::npos);
        if (packed[frame_at + 4] == 0x64) continue;  // rosbag's own form, which it reads by the index
        folder_.write("p.bag", packed);
        const auto source = open_bag(folder_ / "p.bag", options);
        std::size_t frames = 0;
        for (; const auto frame = source->next(); ++frames)
          expect_pose(*frame, base_at(frame->time) * mount());
        EXPECT_EQ(frames, 4U);
        EXPECT_EQ(source->damage().value_or(""), "");
        const auto topics = list_bag(folder_ / "p.bag");
        ASSERT_EQ(topics.size(), 4U);
        EXPECT_EQ(topics[1].name, "/points");
        EXPECT_EQ(topics[1].count, 4U);
        std::string damaged = packed;  // within the data of the only chunk
        const std::size_t middle = packed.find("compression=lz4") + 200;
        for (std::size_t i = middle; i < middle + 100; ++i) damaged[i] = static_cast<char>(~damaged[i]);
        folder_.write("p.bag", damaged);
        std::string damage;
        const std::string refusal = complaint([&] {
          const auto hurt = open_bag(folder_ / "p.bag", options);
          while (hurt->next()) {
          }
          damage = hurt->damage().value_or("");
        });
        EXPECT_TRUE(checksum == LZ4F_noContentChecksum || !(refusal + damage).empty());
      }
}

/// Bytes that this process has read so far, of files and of what else it reads.
std::size_t bytes_read() {
  std::ifstream io("/proc/self/io");
  std::string key;
  std::size_t count = 0;
  io >> key >> count;  // rchar
  return count;
}

TEST_F(BagFramesTest, ChunksOfManySourcesAtOneTimeAreUnpackedOnce) {
  constexpr std::size_t count = 60;
  ScanBag bag(folder_ / "a.bag");
  add_run(bag, 0);
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Eigen::Vector3f> points;
    for (std::size_t k = 0; k < 10'000; ++k)
      points.push_back(Eigen::Vector3f::Constant(std::sin(static_cast<float>(1000 * i + k))));
    bag.cloud("/many", 12.1 + 0.01 * static_cast<double>(i), "sensor", points);
  }
  bag.shuffle(3);
  bag.write();
  LZ4F_frameInfo_t form{};
  form.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  const std::string packed = packed_bag(read_file(folder_ / "a.bag"), form);
  folder_.write("p.bag", packed);
  SourceOptions options;
  options.bag.clouds = {"/many"};
  options.bag.fixed_frame = "map";
  const std::size_t before = bytes_read();
  const auto source = open_bag(folder_ / "p.bag", options);
  std::size_t frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, count);
  EXPECT_LT(bytes_read() - before, 3 * packed.size());
}

TEST_F(BagFramesTest, AMessageThatEndsEarlyIsDamage) {
  for (const char* name : {"a.mcap", "a.bag"})
    for (const std::size_t bytes : {4U, 60U}) {
      ScanBag bag(folder_ / name);
      add_run(bag, 0);
      bag.cloud("/points", 12.9, "sensor", {{1, 2, 3}});
      bag.cut_last(bytes);
      const Reading reading = read(bag, name);
      EXPECT_EQ(reading.frames.size(), 4U);
      EXPECT_EQ(reading.warnings, "");
      EXPECT_NE(
          reading.damage.find("is damaged: it holds 1 message in topic '/points' that cannot be used: the "
                              "message ends early"),
          std::string::npos)
          << reading.damage;
    }
}

TEST_F(BagFramesTest, ARunOfWhichOnlyTransformsStartAgainIsRefused) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (double time = 10; time < 13; time += 0.05)
    bag.transform({10 + time, time + 0.02}, "map", "base", elsewhere_at(time));
  const Reading reading = read(bag, "a.mcap");
  EXPECT_TRUE(reading.frames.empty());
  EXPECT_NE(reading.damage.find("the stamps of '/tf', frame 'base', jump back by 2.98 s"), std::string::npos)
      << reading.damage;
}

TEST_F(BagFramesTest, ARunThatWasRecordedByTheClockThatWasResetIsRefused) {
  ScanBag bag(folder_ / "a.mcap");
  for (int run = 0; run < 2; ++run) add_run(bag, 0);
  const Reading reading = read(bag, "a.mcap");
  EXPECT_TRUE(reading.frames.empty());
  EXPECT_NE(reading.damage.find("the times of recording of '/points' jump back by 1.88 s"), std::string::npos)
      << reading.damage;
}

TEST_F(BagFramesTest, TwoPublishersOfOneFrameAreRefusedWhereTheyAlternate) {
  for (const char* name : {"two.mcap", "two.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    for (double time = 10.02; time < 13; time += 0.05) bag.transform(time, "map", "base", elsewhere_at(time));
    bag.sort();
    const Reading reading = read(bag, name);
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find("poses of frame 'base' are up to 1"), std::string::npos) << reading.damage;
  }
}

/// A second parent of the base, which says that it is elsewhere.
void add_second_parent(ScanBag& bag, bool in_map, bool is_first) {
  if (is_first) bag.transform(9.8, "vodom", "base", elsewhere_at(10));
  for (double time = 10.02; time < 13; time += 0.05) bag.transform(time, "vodom", "base", elsewhere_at(time));
  if (in_map) bag.transform(9.9, "map", "vodom", Eigen::Isometry3d::Identity(), true);
  bag.sort();
}

TEST_F(BagFramesTest, AFrameOfWhichTwoParentsLeadToTheMapIsRefused) {
  for (const bool is_first : {false, true}) {
    ScanBag bag(folder_ / "two.mcap");
    add_run(bag, 0);
    add_second_parent(bag, true, is_first);
    const Reading reading = read(bag, "two.mcap");
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find(is_first ? "gives frame 'base' two parents, 'vodom' (61 transforms) and "
                                             "'map' (61 transforms), and both lead to 'map'"
                                           : "gives frame 'base' two parents, 'map' (61 transforms) and "
                                             "'vodom' (60 transforms), and both lead to 'map'"),
              std::string::npos)
        << reading.damage;
  }
}

TEST_F(BagFramesTest, OfTwoParentsTheOneThatLeadsToTheMapCounts) {
  for (const bool is_first : {false, true}) {
    ScanBag bag(folder_ / "two.mcap");
    add_run(bag, 0);
    add_second_parent(bag, false, is_first);
    const Reading reading = read(bag, "two.mcap");
    ASSERT_EQ(reading.frames.size(), 4U) << reading.damage;
    for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
    EXPECT_NE(reading.warnings.find("gives frame 'base' two parents, 'map' (61 transforms) and 'vodom'"),
              std::string::npos)
        << reading.warnings;
  }
}

TEST_F(BagFramesTest, AFrameBesideTheWayMayHaveTwoParents) {
  ScanBag bag(folder_ / "two.mcap");
  add_run(bag, 0);
  bag.transform(10, "map", "cup", mount());
  bag.transform(11, "base", "cup", mount());
  bag.transform(9, "earth", "map", mount(), true);  // above the frame in which sensors are placed
  bag.transform(9, "utm", "map", mount(), true);
  bag.sort();
  const Reading reading = read(bag, "two.mcap");
  ASSERT_EQ(reading.frames.size(), 4U) << reading.damage;
  for (const Frame& frame : reading.frames) expect_pose(frame, base_at(frame.time) * mount());
  EXPECT_NE(reading.warnings.find("frame 'cup' two parents, 'map' (1 transforms) and 'base' (1 transforms)"),
            std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, TransformsInALoopAreRefused) {
  for (const bool is_last : {false, true}) {  // whichever of the two a bag holds first
    ScanBag bag(folder_ / "loop.mcap");
    const auto back = [&] { bag.transform(9, "base", "map", base_at(10), true); };
    if (!is_last) back();
    add_run(bag, 0);
    if (is_last) back();
    bag.sort();
    const Reading reading = read(bag, "loop.mcap");
    EXPECT_TRUE(reading.frames.empty());
    EXPECT_NE(reading.damage.find("transforms in a loop: 'base' in 'map' in 'base', as of two publishers"),
              std::string::npos)
        << reading.damage;
  }
}

TEST_F(BagFramesTest, SinglePosesThatContradictOthersOfTheirTimeAreReported) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (const double time : {10.4, 10.9}) {
    bag.transform(time, "map", "base", elsewhere_at(time));
    bag.transform({time + 0.01, time}, "map", "base", base_at(time));
    bag.transform({time + 0.01, time}, "map", "base", base_at(time));  // the same again
  }
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  ASSERT_EQ(reading.frames.size(), 4U);
  expect_pose(reading.frames[0], base_at(10.53) * mount());
  EXPECT_NE(
      reading.warnings.find("poses of frame 'base' that contradict others of the same time, by up to 1 m"),
      std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, AFixedFrameThatIsMovedIsInItsNewPlaceFromThenOn) {
  const Eigen::Isometry3d moved = mount() * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  for (const char* name : {"moved.mcap", "moved.bag"}) {
    ScanBag bag(folder_ / name);
    add_run(bag, 0);
    bag.transform(11.2, "base", "sensor", mount(), true);  // said again
    bag.transform(11.5, "base", "sensor", moved, true);
    bag.sort();
    const Reading reading = read(bag, name);
    ASSERT_EQ(reading.frames.size(), 4U);
    for (const Frame& frame : reading.frames)
      expect_pose(frame, base_at(frame.time) * (frame.time < 11.5 ? mount() : moved));
    EXPECT_NE(
        reading.warnings.find("moves the fixed frame 'sensor' 1 time in /tf_static; each pose holds from "
                              "its recording on"),
        std::string::npos)
        << reading.warnings;
  }
}

TEST_F(BagFramesTest, AFixedFrameThatIsRecordedLateHoldsBeforeToo) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  bag.transform(12.9, "sensor", "tip", mount(), true);
  bag.cloud("/points", 12.2, "tip", {{1, 2, 3}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 5U);
  expect_pose(reading.frames[3], base_at(12.2) * mount() * mount());
}

TEST_F(BagFramesTest, AFrameThatLeadsToNoSensorMayAlternate) {
  ScanBag bag(folder_ / "a.mcap");
  add_run(bag, 0);
  for (int i = 0; i < 50; ++i)
    bag.transform(10 + 0.05 * i, "map", "goal", Eigen::Isometry3d(Eigen::Translation3d(0, i % 2, 0)));
  EXPECT_EQ(read(bag, "a.mcap").frames.size(), 4U);
}

/// A base that drives and turns fast.
Eigen::Isometry3d driving_at(double time) {
  return Eigen::Translation3d(1.5 * time - 15, 0.2, 0.3) * Eigen::AngleAxisd(time, Eigen::Vector3d::UnitZ());
}

/// How far a wall at x = 8 m or y = 3 m is along a ray, cast here; 0: there is none.
float range_to_walls(const Eigen::Isometry3d& map_from_laser, double angle) {
  const Eigen::Vector3d origin = map_from_laser.translation();
  const Eigen::Vector3d ray = map_from_laser.linear() * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
  double nearest = HUGE_VAL;
  if (ray.x() > 0) nearest = std::min(nearest, (8 - origin.x()) / ray.x());
  if (ray.y() > 0) nearest = std::min(nearest, (3 - origin.y()) / ray.y());
  return nearest < 25 ? static_cast<float>(nearest) : std::numeric_limits<float>::infinity();
}

Eigen::Isometry3d mount_flat() { return Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0.25)); }

constexpr int rays = 360;
const worlds::BagSweep turn{-3.0F, 6.0F / rays, 0.1F / rays};

/// Sweeps from 10 s on, every second one beginning at the last ray, with the base's poses until `end`.
void add_sweeps(ScanBag& bag, double end, const std::vector<double>& times, float direction) {
  const Eigen::Isometry3d laser(Eigen::Translation3d(0.1, 0, 0.25));
  bag.transform(9, "base", "laser", laser, true);
  for (double time = 9.5; time < end; time += 0.02) bag.transform(time, "map", "base", driving_at(time));
  worlds::BagSweep sweep = turn;
  sweep.time_increment *= direction;
  for (const double time : times) {
    std::vector<float> ranges;
    for (int ray = 0; ray < rays; ++ray) {
      const double at = time + ray * double{sweep.time_increment};
      ranges.push_back(range_to_walls(driving_at(at) * laser,
                                      double{turn.angle_min} + ray * double{turn.angle_increment}));
    }
    bag.sweep("/scan", time, "laser", sweep, ranges);
  }
  bag.sort();
}

TEST_F(BagFramesTest, EachRayOfASweepIsWhereTheLaserWasThen) {
  for (const float direction : {1.0F, -1.0F}) {
    for (const char* name : {"sweep.mcap", "sweep.bag"}) {
      ScanBag bag(folder_ / name);
      add_sweeps(bag, 12, {10.0, 10.5, 11.0}, direction);
      const Reading reading = read(bag, name);
      EXPECT_EQ(reading.damage + reading.warnings, "");
      std::size_t points = 0;
      double before = 0.0;
      for (const Frame& frame : reading.frames) {
        const auto& cloud = std::get<CloudFrame>(frame.content);
        EXPECT_GE(frame.time, before);
        before = frame.time;
        const Eigen::Vector3d origin = cloud.world_from_sensor.translation();
        const Eigen::Vector3d then =
            driving_at(frame.time) * Eigen::Vector3d(0.1, 0, 0.25);  // at its first ray
        EXPECT_LT((origin - then).norm(), 0.0126 + 1e-3) << "within a quarter voxel";
        for (const Eigen::Vector3f& point : cloud.points) {
          const Eigen::Vector3d place = cloud.world_from_sensor * point.cast<double>();
          EXPECT_LT(std::min(std::abs(place.x() - 8), std::abs(place.y() - 3)), 1e-3) << place.transpose();
          ++points;
        }
      }
      EXPECT_GT(reading.frames.size(), 20U) << "15 cm of way each, a third of it without a wall";
      EXPECT_GT(points, 500U);
    }
  }
}

TEST_F(BagFramesTest, BeamsThatMetNothingReachTheRangeFromWhereTheLaserWasThen) {
  for (const float direction : {1.0F, -1.0F}) {
    ScanBag bag(folder_ / "sweep.mcap");
    add_sweeps(bag, 12, {10.0, 10.5}, direction);
    const Reading plain = read(bag, "sweep.mcap"), clear = read(bag, "sweep.mcap", true);
    std::size_t beams = 0, points = 0, ends = 0, hits = 0, unclear = 0;
    for (const Frame& frame : plain.frames) {
      const auto& cloud = std::get<CloudFrame>(frame.content);
      points += cloud.points.size();
      beams += cloud.infinite;
      unclear += cloud.clear_to.size();
    }
    EXPECT_EQ(unclear, 0U);
    EXPECT_EQ(points + beams, 2U * rays);
    EXPECT_GT(beams, 100U);
    std::size_t counted = 0;
    for (const Frame& frame : clear.frames) {
      const auto& cloud = std::get<CloudFrame>(frame.content);
      hits += cloud.points.size();
      ends += cloud.clear_to.size();
      counted += cloud.infinite;
      for (const Eigen::Vector3f& end : cloud.clear_to)  // within a quarter voxel of that place
        EXPECT_NEAR(double{end.norm()}, 30.0, 0.0126 + 1e-3);
    }
    EXPECT_EQ(hits, points);
    EXPECT_EQ(ends, beams);
    EXPECT_EQ(counted, beams);
  }
}

TEST_F(BagFramesTest, ASweepOfALaserThatStandsIsOneFrame) {
  for (const float increment : {0.0F, turn.time_increment}) {
    ScanBag bag(folder_ / "sweep.mcap");
    bag.transform(9, "map", "laser", mount(), true);
    worlds::BagSweep sweep = turn;
    sweep.time_increment = increment;
    bag.sweep("/scan", 10, "laser", sweep, std::vector<float>(rays, 2.5F));
    const Reading reading = read(bag, "sweep.mcap");
    ASSERT_EQ(reading.frames.size(), 1U);
    EXPECT_EQ(reading.frames[0].time, 10);
    const auto& cloud = std::get<CloudFrame>(reading.frames[0].content);
    ASSERT_EQ(cloud.points.size(), static_cast<std::size_t>(rays));
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const double angle = double{turn.angle_min} + static_cast<double>(i) * double{turn.angle_increment};
      EXPECT_EQ(cloud.points[i], Eigen::Vector3f(static_cast<float>(2.5 * std::cos(angle)),
                                                 static_cast<float>(2.5 * std::sin(angle)), 0));
    }
  }
}

TEST_F(BagFramesTest, ASweepWhoseEndHasNoPoseIsLeftOutAndCounted) {
  ScanBag bag(folder_ / "sweep.mcap");
  add_sweeps(bag, 10.57, {10.0, 10.5}, 1.0F);
  const Reading reading = read(bag, "sweep.mcap");
  ASSERT_FALSE(reading.frames.empty());
  EXPECT_LT(reading.frames.back().time, 10.2);
  EXPECT_NE(
      reading.warnings.find("holds 1 message in topic '/scan' that cannot be used: frame 'laser' is not "
                            "known in 'map' at its time"),
      std::string::npos)
      << reading.warnings;
}

TEST_F(BagFramesTest, WhileAPoseJumpsScansAreLeftOutAndOnlyThen) {
  const Eigen::Isometry3d jump =
      Eigen::Translation3d(0.8, -0.5, 0) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ());
  ScanBag bag(folder_ / "a.mcap");
  for (double time = 9.9; time < 13.001; time += 0.025) bag.transform(time, "odom", "base", driving_at(time));
  const auto map_from_odom = [&](double time) { return time < 11.49 ? Eigen::Isometry3d::Identity() : jump; };
  for (double time = 9.75; time < 13.3; time += 0.25) bag.transform(time, "map", "odom", map_from_odom(time));
  std::size_t outside = 0;
  for (double time = 10.01; time < 13; time += 0.04) {
    bag.cloud("/points", time, "base", {{1, 2, 3}});
    outside += time < 11.25 || time > 11.5 ? 1 : 0;
  }
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage, "");
  ASSERT_EQ(reading.frames.size(), outside);
  for (const Frame& frame : reading.frames)
    EXPECT_LT((std::get<CloudFrame>(frame.content).world_from_sensor.translation() -
               (map_from_odom(frame.time) * driving_at(frame.time)).translation())
                  .norm(),
              2e-3);
  EXPECT_NE(reading.warnings.find("holds 6 messages in topic '/points' at times at which a pose jumps, which "
                                  "were left out; of the first, frame 'odom' jumps by 0.943"),
            std::string::npos)
      << reading.warnings;
  EXPECT_NE(reading.warnings.find("between 11.250 and 11.500 s"), std::string::npos) << reading.warnings;
}

TEST_F(BagFramesTest, ARobotThatStartsStopsAndTurnsHardDoesNotJump) {
  const auto place = [](double time) {  // to 4 m/s within 0.5 s, and back; turns of up to 6 rad/s
    const double since = std::clamp(time - 11, 0.0, 1.0);  // at 8 m/s^2
    const double way = since < 0.5 ? 4 * since * since : 2 - 4 * (1 - since) * (1 - since);
    return Eigen::Translation3d(way, 0, 0) *
           Eigen::AngleAxisd(3.0 * std::sin(2.0 * time), Eigen::Vector3d::UnitZ());
  };
  for (const double step : {0.02, 0.1, 0.25}) {
    ScanBag bag(folder_ / "a.mcap");
    for (double time = 10; time < 13.001; time += step)
      bag.transform(time, "map", "base", Eigen::Isometry3d(place(time)));
    std::size_t scans = 0;
    for (double time = 10.01; time < 12.7; time += 0.07, ++scans)
      bag.cloud("/points", time, "base", {{1, 2, 3}});
    bag.sort();
    const Reading reading = read(bag, "a.mcap");
    EXPECT_EQ(reading.frames.size(), scans) << step << reading.warnings;
  }
}

/// Scans of a sensor on a base that drives, put into another frame; `odom` is where odometry begins.
void add_registered(ScanBag& bag, const std::string& frame) {
  const Eigen::Isometry3d map_from_odom(Eigen::Translation3d(3, -2, 0));
  bag.transform(9, "base", "sensor", mount(), true);
  for (double time = 9.9; time < 12.001; time += 0.1) {
    bag.transform(time, "odom", "base", map_from_odom.inverse() * driving_at(time));
    bag.transform(time, "map", "odom", map_from_odom);
    bag.transform(time, "base", "wheel",
                  Eigen::Isometry3d(Eigen::AngleAxisd(time, Eigen::Vector3d::UnitY())));
  }
  const Eigen::Isometry3d frame_from_map =
      frame == "odom" ? map_from_odom.inverse() : Eigen::Isometry3d::Identity();
  for (const double time : {10.0, 10.5, 11.0})
    bag.cloud("/points", time, frame, {(frame_from_map * Eigen::Vector3d(4, 2.5, 1)).cast<float>()});
  bag.sort();
}

TEST_F(BagFramesTest, CloudsInAFrameInWhichTheSensorDrivesHaveNoOriginUntilItIsNamed) {
  for (const char* frame : {"map", "odom"}) {
    ScanBag bag(folder_ / "a.mcap");
    add_registered(bag, frame);
    const Reading unknown = read(bag, "a.mcap");
    BagTopics named;
    named.sensor_frame = "sensor";
    const Reading known = read(bag, "a.mcap", false, named);
    ASSERT_EQ(unknown.frames.size(), 3U) << unknown.damage;
    ASSERT_EQ(known.frames.size(), 3U) << known.damage;
    EXPECT_EQ(known.damage + known.warnings, "");
    EXPECT_NE(unknown.warnings.find(std::string("holds 3 clouds in topic '/points' in frame '") + frame +
                                    "', in which others drive: they mark what is occupied and free nothing"),
              std::string::npos)
        << unknown.warnings;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& without = std::get<CloudFrame>(unknown.frames[i].content);
      const auto& with = std::get<CloudFrame>(known.frames[i].content);
      EXPECT_FALSE(without.is_origin_known);
      EXPECT_TRUE(with.is_origin_known);
      expect_pose(known.frames[i], driving_at(known.frames[i].time) * mount());
      for (const CloudFrame* cloud : {&without, &with})
        EXPECT_LT((cloud->world_from_sensor * cloud->points.at(0).cast<double>() - Eigen::Vector3d(4, 2.5, 1))
                      .norm(),
                  1e-5);
    }
  }
}

TEST_F(BagFramesTest, CloudsOfASensorThatStandsOrIsDrivenHaveTheOriginOfTheirFrame) {
  ScanBag bag(folder_ / "a.mcap");
  add_registered(bag, "base");  // below it a wheel turns
  bag.transform(9, "map", "pole", mount(), true);
  bag.cloud("/points", 11.2, "pole", {{1, 2, 3}});
  bag.sort();
  const Reading reading = read(bag, "a.mcap");
  EXPECT_EQ(reading.damage + reading.warnings, "");
  ASSERT_EQ(reading.frames.size(), 4U);
  for (const Frame& frame : reading.frames) EXPECT_TRUE(std::get<CloudFrame>(frame.content).is_origin_known);
}

/// A cloud of rays that go out one after the other while the base drives, in steps of `unit` s before the
/// stamp or after it; how far the walls are is cast here.
void add_timed_cloud(ScanBag& bag, double stamp, double begin, double unit) {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> times;
  for (int ray = 0; ray < 2 * rays; ++ray) {
    const double angle = 6.0 * (ray / 2) / rays - 3.0, since = begin + 0.1 * (ray / 2) / rays;
    const float range = range_to_walls(driving_at(stamp + since) * mount_flat(), angle);
    if (!std::isfinite(range)) continue;
    points.emplace_back(range * static_cast<float>(std::cos(angle)),
                        range * static_cast<float>(std::sin(angle)), ray % 2 == 0 ? 0.0F : 0.5F);
    times.push_back(static_cast<float>(since / unit));
  }
  bag.cloud("/points", stamp, "sensor", points, "time", times);
}

TEST_F(BagFramesTest, EachPointOfACloudIsWhereTheSensorWasThenInAnyUnit) {
  for (const double unit : {1.0, 1e-3, 1e-6, 1e-9})
    for (const double begin : {0.0, -0.1, -0.05}) {
      ScanBag bag(folder_ / "a.mcap");
      bag.transform(9, "base", "sensor", mount_flat(), true);
      for (double time = 9; time < 12; time += 0.02) bag.transform(time, "map", "base", driving_at(time));
      for (const double stamp : {10.0, 10.5}) add_timed_cloud(bag, stamp, begin, unit);
      bag.sort();
      const Reading reading = read(bag, "a.mcap");
      EXPECT_EQ(reading.damage, "");
      EXPECT_NE(reading.warnings.find("holds 2 clouds in topic '/points' during which the sensor moved"),
                std::string::npos)
          << reading.warnings;
      EXPECT_NE(reading.warnings.find("by the field 'time'"), std::string::npos) << reading.warnings;
      std::size_t points = 0;
      for (const Frame& frame : reading.frames) {
        const auto& cloud = std::get<CloudFrame>(frame.content);
        EXPECT_LT(
            (cloud.world_from_sensor.translation() - (driving_at(frame.time) * mount_flat()).translation())
                .norm(),
            0.0126 + 1e-3)
            << "within a quarter voxel";
        for (const Eigen::Vector3f& point : cloud.points) {
          const Eigen::Vector3d place = cloud.world_from_sensor * point.cast<double>();
          EXPECT_LT(std::min(std::abs(place.x() - 8), std::abs(place.y() - 3)), 2e-3) << place.transpose();
          ++points;
        }
      }
      EXPECT_GT(points, 700U);
      BagTopics stamped;
      stamped.point_times = false;
      const Reading plain = read(bag, "a.mcap", false, stamped);
      EXPECT_EQ(plain.frames.size(), 2U);
      EXPECT_NE(plain.warnings.find("each is placed by one pose, at its stamp"), std::string::npos);
    }
}

TEST_F(BagFramesTest, CloudsOfASensorThatStandsAreOneFrameAndOddTimesAreTold) {
  const std::vector<Eigen::Vector3f> points{{1, 0, 0}, {0, 2, 0}, {3, 0, 0}};
  for (const bool are_odd : {false, true}) {
    ScanBag bag(folder_ / "a.mcap");
    for (double time = 9; time < 12; time += 0.02)
      bag.transform(time, "map", "base", are_odd ? driving_at(time) : base_at(0));
    const float scale = are_odd ? 3e4F : 1.0F;  // 3000 s, or 3 s in thousandths: no sweep in any unit
    bag.cloud("/points", 10, "base", points, "time", {-0.1F * scale, -0.05F * scale, 0.0F});
    bag.cloud("/points", 11, "base", points);
    bag.sort();
    const Reading reading = read(bag, "a.mcap");
    ASSERT_EQ(reading.frames.size(), 2U) << reading.damage;
    EXPECT_EQ(std::get<CloudFrame>(reading.frames[0].content).points, points);
    const bool is_told = reading.warnings.find(
                             "holds 1 clouds in topic '/points' whose points' times make no "
                             "sense in s, ms, us or ns since the stamp or 1970 (of the "
                             "first, 'time' spans 3000)") != std::string::npos;
    EXPECT_EQ(is_told, are_odd) << reading.warnings;
  }
}

}  // namespace bag_frames_test
}  // namespace clearway
