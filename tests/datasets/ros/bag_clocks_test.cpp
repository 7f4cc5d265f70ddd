// Bags whose clock was set back while they were recorded, or whose topics are
// stamped by several clocks.

#include "datasets/ros/bag_clocks.hpp"

#include <cmath>

#include "tests/datasets/ros/bag_frames_world.hpp"

namespace clearway {
namespace bag_clocks_test {

using namespace bag_frames_world;

constexpr double start = 1'764'500'000.0;  // s since 1970

class BagClocksTest : public BagFramesTest {
 protected:
  /// Sensors that stand, at the places that the setup states.
  Reading read_standing(const ScanBag& bag, const std::string& name, BagTopics options = {}) {
    std::filesystem::remove(folder_ / name);
    bag.write();
    SourceOptions source;
    source.bag = std::move(options);
    if (source.bag.clouds.empty()) source.bag.clouds = {"/points"};
    source.placed = source.bag.clouds;
    const auto frames = open_bag(folder_ / name, source);
    Reading reading;
    while (auto frame = frames->next()) reading.frames.push_back(std::move(*frame));
    reading.damage = frames->damage().value_or("");
    for (const std::string& warning : frames->warnings()) reading.warnings += warning + "\n";
    return reading;
  }
};

/// 40 scans, whose clock is set back before the last `after`. @param recorder
/// it is set back, too
void add_set_back(ScanBag& bag, double back, int after, bool recorder) {
  for (int i = 0; i < 40; ++i) {
    const double time = start + 0.1 * i, stamp = time - (i < 40 - after ? 0.0 : back);
    bag.cloud("/points", {recorder ? stamp : time, stamp}, "sensor", {{1, 2, static_cast<float>(i)}});
  }
}

TEST_F(BagClocksTest, AClockThatWasSetBackIsRefused) {
  for (const char* name : {"a.mcap", "a.bag", "a.db3"})
    for (const bool recorder : {false, true})
      for (const double back : {2.0, 4.0, 37.0, 3600.0})
        for (const int after : {3, 5}) {
          if (recorder && std::string(name) == "a.bag") continue;  // its messages are in no stated order
          ScanBag bag(folder_ / name);
          add_set_back(bag, back, after, recorder);
          const Reading reading = read_standing(bag, name);
          EXPECT_TRUE(reading.frames.empty());
          const std::string sentence = std::string(recorder ? "the times of recording" : "the stamps") +
                                       " of '/points' jump back by " + (back == 37.0 ? "36.9 s" : "");
          EXPECT_NE(reading.damage.find(sentence), std::string::npos)
              << name << ' ' << recorder << ' ' << back << ' ' << after << reading.damage;
        }
}

/// As of drivers that stamp once in a while wrongly, and of what has no stamp before a simulated clock
/// begins.
TEST_F(BagClocksTest, OneWrongStampIsNoClock) {
  for (const int wrong : {0, 1, 20, 38, 39})
    for (const double back : {2.0, 3600.0}) {
      ScanBag bag(folder_ / "a.mcap");
      for (int i = 0; i < 40; ++i)
        bag.cloud("/points", {start + 0.1 * i, start + 0.1 * i - (i == wrong ? back : 0.0)}, "sensor",
                  {{1, 2, static_cast<float>(i)}});
      EXPECT_EQ(read_standing(bag, "a.mcap").damage, "") << wrong << ' ' << back;
    }
}

/// As converters write them: all at once, or in batches of some seconds.
TEST_F(BagClocksTest, TimesOfRecordingThatSayNothingAreNoClocks) {
  BagTopics options;
  options.clouds = {"/a", "/b"};
  for (const double batch : {2.0, 5.0, 1000.0}) {
    ScanBag bag(folder_ / "a.mcap");
    for (int i = 0; i < 200; ++i) {
      const double time = start + 0.1 * i, recorded = start + batch * std::floor(0.1 * i / batch);
      bag.cloud("/a", {recorded, time}, "a", {{1, 2, 3}});
      bag.cloud("/b", {recorded, time + 0.05}, "b", {{1, 2, 3}});
    }
    const Reading reading = read_standing(bag, "a.mcap", options);
    EXPECT_EQ(reading.damage, "") << batch;
    EXPECT_EQ(reading.warnings.find("clocks that differ"), std::string::npos) << reading.warnings;
  }
}

TEST_F(BagClocksTest, TheWaysOutOfARefusalAreOnes) {
  for (const bool recorder : {false, true}) {
    ScanBag bag(folder_ / "a.mcap");
    add_set_back(bag, 37, 3, recorder);
    const std::string sentence = read_standing(bag, "a.mcap").damage;
    for (const bool is_after : {false, true}) {
      const std::string key = recorder == is_after ? "`to: " : "`from: ";
      ASSERT_NE(sentence.find(key), std::string::npos) << sentence;
      const double cut = std::stod(sentence.substr(sentence.find(key) + key.size()));
      BagTopics part;
      (recorder == is_after ? part.to.emplace() : part.from) = cut;
      const Reading reading = read_standing(bag, "a.mcap", part);
      EXPECT_EQ(reading.damage, "") << sentence;
      EXPECT_EQ(reading.frames.size(), is_after ? 3U : 37U) << recorder << is_after;
    }
  }
}

TEST_F(BagClocksTest, TheTimesThatCountCanBeStated) {
  ScanBag bag(folder_ / "a.mcap");
  add_set_back(bag, 37, 3, false);
  BagTopics options;
  options.times = BagTimes::recording;
  Reading reading = read_standing(bag, "a.mcap", options);
  EXPECT_EQ(reading.damage, "");
  ASSERT_EQ(reading.frames.size(), 40U);
  EXPECT_EQ(std::get<CloudFrame>(reading.frames.back().content).points.at(0).z(), 39.0F);
  EXPECT_NEAR(reading.frames.back().time, start + 3.9, 1e-6);
  options.times = BagTimes::stamps;
  reading = read_standing(bag, "a.mcap", options);
  ASSERT_EQ(reading.frames.size(), 40U);
  EXPECT_EQ(std::get<CloudFrame>(reading.frames.back().content).points.at(0).z(), 36.0F);
}

TEST_F(BagClocksTest, ARecordersClockThatWasSetBackHurtsNoStamps) {
  ScanBag bag(folder_ / "a.mcap");
  for (int i = 0; i < 40; ++i)
    bag.cloud("/points", {start + 0.1 * i - (i < 37 ? 0 : 37), start + 0.1 * i}, "sensor",
              {{1, 2, static_cast<float>(i)}});
  const Reading reading = read_standing(bag, "a.mcap");
  EXPECT_EQ(reading.damage, "");
  ASSERT_EQ(reading.frames.size(), 40U);
  EXPECT_EQ(std::get<CloudFrame>(reading.frames.back().content).points.at(0).z(), 39.0F);
}

TEST_F(BagClocksTest, ShuffledReversedBufferedAndLateBagsAreReadAsBefore) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> latency(0.0, 0.9);
  for (const char* name : {"a.mcap", "a.bag", "a.db3"})
    for (unsigned seed = 0; seed < 8; ++seed) {
      ScanBag bag(folder_ / name);
      for (int i = 0; i < 40; ++i) {
        const double time = start + 0.1 * i, late = seed < 4 && i % 13 == 5 ? 2.5 : 0.0;
        const double recorded =
            seed == 0 ? start + 100 - 0.1 * i : time + late + (seed < 4 ? 0 : latency(random));
        bag.cloud("/points", {recorded, time}, "sensor", {{1, 2, static_cast<float>(i)}});
      }
      if (seed > 1) bag.shuffle(seed);
      if (seed == 1) bag.sort();
      const Reading reading = read_standing(bag, name);
      EXPECT_EQ(reading.damage, "") << name << ' ' << seed;
      ASSERT_EQ(reading.frames.size(), 40U);
      for (int i = 0; i < 40; ++i)
        EXPECT_EQ(std::get<CloudFrame>(reading.frames[static_cast<std::size_t>(i)].content).points.at(0).z(),
                  static_cast<float>(i));
    }
}

/// Two sensors, of which the second is stamped `ahead` s later. @param latency
/// of its recording, s
void add_two(ScanBag& bag, double ahead, double latency = 0.0, double jitter = 0.0) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    const double time = start + 0.1 * i;
    bag.cloud("/a", time, "a", {{1, 2, 3}});
    bag.cloud("/b", {time + 0.05 + latency + jitter * part(random), time + 0.05 + ahead}, "b", {{1, 2, 3}});
  }
}

TEST_F(BagClocksTest, TwoSensorsByClocksThatDifferAreRefusedUntilTheSetupSaysHow) {
  for (const char* name : {"a.mcap", "a.bag", "a.db3"})
    for (const double ahead : {-start + 100, -37.0, -6.0, -1.5, 1.5, 37.0}) {
      ScanBag bag(folder_ / name);
      add_two(bag, ahead);
      BagTopics options;
      options.clouds = {"/a", "/b"};
      const Reading reading = read_standing(bag, name, options);
      const bool is_refused = std::abs(ahead) > 5.0;
      EXPECT_EQ(reading.frames.size(), is_refused ? 0U : 80U) << ahead;
      const std::string said = is_refused ? reading.damage : reading.warnings;
      for (const std::string part :
           {"stamped by clocks that differ: by their times of recording, the stamps of '/b' are ",
            ahead < 0 ? " s behind those of '/a'" : " s ahead of those of '/a'"})
        EXPECT_NE(said.find(part), std::string::npos) << name << ahead << said;
      const std::string way = "`clock_offsets: [{topic: /b, add: ";
      ASSERT_NE(said.find(way), std::string::npos) << said;
      EXPECT_NEAR(std::stod(said.substr(said.find(way) + way.size())), -ahead, 1e-3);
      options.clock_offsets["/b"] = -ahead;
      const Reading moved = read_standing(bag, name, options);
      EXPECT_EQ(moved.damage, "");
      ASSERT_EQ(moved.frames.size(), 80U);
      EXPECT_EQ(moved.frames.back().sensor, "/b");
      EXPECT_NEAR(moved.frames.back().time, start + 3.95, 1e-5);
      options.clock_offsets.clear();
      options.times = BagTimes::recording;
      EXPECT_EQ(read_standing(bag, name, options).frames.size(), 80U);
      options.times = BagTimes::stamps;
      EXPECT_EQ(read_standing(bag, name, options).frames.size(), 80U);
    }
}

TEST_F(BagClocksTest, SensorsThatAreRecordedLateOrAtAnotherPaceAreReadAsBefore) {
  BagTopics options;
  options.clouds = {"/a", "/b"};
  for (const double jitter : {0.0, 0.4}) {
    ScanBag bag(folder_ / "a.mcap");
    add_two(bag, 0, 0.55, jitter);
    EXPECT_EQ(read_standing(bag, "a.mcap", options).damage, "");
  }
  ScanBag paced(folder_ / "a.mcap"), by_topic(folder_ / "b.mcap");
  for (int i = 0; i < 40; ++i) {  // played at half the speed, and written topic by topic
    paced.cloud("/a", {start + 500 + i, start + 0.5 * i}, "a", {{1, 2, 3}});
    paced.cloud("/b", {start + 500.1 + i, start + 0.5 * i + 0.05}, "b", {{1, 2, 3}});
    by_topic.cloud("/a", {start + 500 + 0.001 * i, start + 0.5 * i}, "a", {{1, 2, 3}});
    by_topic.cloud("/b", {start + 600 + 0.001 * i, start + 0.5 * i + 90}, "b", {{1, 2, 3}});
  }
  EXPECT_EQ(read_standing(paced, "a.mcap", options).damage, "");
  EXPECT_EQ(read_standing(by_topic, "b.mcap", options).damage, "");
}

TEST_F(BagClocksTest, JointsByAnotherClockThanTheSensorsAreRefused) {
  for (const double ahead : {0.0, 0.9, -6.0, 6.0}) {
    std::vector<worlds::BagRecord> records;
    for (int i = 0; i < 40; ++i) {
      const double time = start + 0.1 * i;
      worlds::MessageBytes scan(false), joints(false);
      scan.header(time, "sensor").all(std::vector<std::uint32_t>{1, 0, 0}).add(std::uint8_t{0});
      scan.all(std::vector<std::uint32_t>{12, 0, 0}).add(std::uint8_t{1});
      joints.header(time + ahead, "").add(std::uint32_t{1}).text("lift").list(std::vector<double>{0.1});
      joints.add(std::uint32_t{0}).add(std::uint32_t{0});
      records.push_back({"/points", "sensor_msgs/msg/PointCloud2", time, scan.bytes()});
      records.push_back({"/joint_states", "sensor_msgs/msg/JointState", time + 0.01, joints.bytes()});
    }
    worlds::write_bag(folder_ / "a.mcap", records, false);
    SourceOptions options;
    options.bag.clouds = options.placed = {"/points"};
    options.bag.joint_topic = "/joint_states";
    const auto frames = open_bag(folder_ / "a.mcap", options);
    while (frames->next()) {
    }
    const bool is_refused =
        frames->damage().value_or("").find("the stamps of '/points' are ") != std::string::npos;
    EXPECT_EQ(is_refused, std::abs(ahead) > 1.0) << ahead << frames->damage().value_or("");
  }
}

TEST_F(BagClocksTest, PosesByAnotherClockAreRefusedAndThoseThatComeLateAreTold) {
  const auto read_with = [&](double ahead) {
    ScanBag bag(folder_ / "a.mcap");
    bag.transform(start, "base", "sensor", mount(), true);
    for (int i = 0; i < 1000; ++i) {
      const double time = start + 0.05 * i;
      bag.transform({time, time + ahead}, "map", "base", base_at(0.05 * i));
      if (i % 10 == 5) bag.cloud("/points", {time + 0.01, time}, "sensor", {{1, 2, 3}});
    }
    return read(bag, "a.mcap");
  };
  EXPECT_EQ(read_with(0).warnings, "");
  EXPECT_EQ(read_with(0.9).damage, "");
  for (const double ahead : {-37.0, 37.0})
    EXPECT_NE(read_with(ahead).damage.find("the stamps of '/tf', frame 'base', are "), std::string::npos)
        << ahead;
  const Reading dated_ahead = read_with(1.5);  // as AMCL dates its transforms
  EXPECT_EQ(dated_ahead.damage, "");
  EXPECT_NE(dated_ahead.warnings.find("s ahead of those of '/points'"), std::string::npos);
  const Reading late = read_with(-3);
  EXPECT_EQ(late.damage, "");
  EXPECT_NE(late.warnings.find("the stamps of '/tf', frame 'base', are 2.99 s "
                               "behind those of '/points'"),
            std::string::npos)
      << late.warnings;
}

}  // namespace bag_clocks_test
}  // namespace clearway
