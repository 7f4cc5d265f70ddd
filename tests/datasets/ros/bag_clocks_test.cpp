// Bags whose clock was set back while they were recorded, or whose topics are
// stamped by several clocks.

#include "datasets/ros/bag_clocks.hpp"

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
        for (const int after : {1, 3}) {
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

}  // namespace bag_clocks_test
}  // namespace clearway
