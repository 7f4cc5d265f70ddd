// When the scans of bags were taken, with transforms that come late or of two runs; chunks of other programs.

#include "datasets/ros/bag_frames.hpp"

#include <gtest/gtest.h>

#include <lz4frame.h>

#include <cmath>
#include <cstring>

#include "tests/datasets/complaint.hpp"
#include "tests/datasets/ros/bag_frames_world.hpp"

namespace clearway {
namespace bag_frames_test {

using namespace bag_frames_world;

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

}  // namespace bag_frames_test
}  // namespace clearway
