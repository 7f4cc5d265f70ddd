#include "datasets/sources/ordered_frames.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/memory_frames.hpp"

namespace clearway {
namespace ordered_frames_test {

Frame scan(double time) { return {time, "s", CloudFrame{}}; }
Frame image(double time) { return {time, "c", ImageFrame{}}; }

OrderedFrames ordered(std::vector<Frame> frames) {
  return {std::make_unique<MemoryFrames>(std::move(frames)), "r.rawlog"};
}

std::vector<double> times_of(OrderedFrames& frames) {
  std::vector<double> times;
  while (const auto frame = frames.next()) times.push_back(frame->time);
  return times;
}

TEST(OrderedFrames, FramesThatComeALittleLateAreGivenInOrder) {
  std::mt19937 random(3);
  std::vector<double> times(1000);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<double>(i / 2);
  std::vector<Frame> shuffled;
  for (std::size_t begin = 0; begin < times.size(); begin += 50) {
    std::vector<double> part(times.begin() + static_cast<long>(begin),
                             times.begin() + static_cast<long>(begin) + 50);
    std::shuffle(part.begin(), part.end(), random);
    for (const double time : part) shuffled.push_back(random() % 3 == 0 ? image(time) : scan(time));
  }
  OrderedFrames frames = ordered(shuffled);
  EXPECT_EQ(times_of(frames), times);
  EXPECT_FALSE(frames.damage());
}

TEST(OrderedFrames, ScansThatComeTooLateAreLeftOutAndReportedAndImagesAreNot) {
  std::vector<Frame> late;
  for (int i = 0; i < 200; ++i) late.push_back(scan(100 + i));
  for (const double time : {50.5, 60.25}) late.push_back(scan(time));
  late.push_back(image(70));
  late.push_back(scan(300));
  OrderedFrames frames = ordered(late);
  const std::vector<double> times = times_of(frames);
  EXPECT_EQ(times.size(), 202U);
  EXPECT_EQ(std::count(times.begin(), times.end(), 70.0), 1);
  EXPECT_LT(*std::max_element(times.begin(), std::find(times.begin(), times.end(), 70.0)), 300.0);
  ASSERT_TRUE(frames.damage());
  EXPECT_NE(frames.damage()->find("'r.rawlog' is not in the order of its times: 2 scans that are older than "
                                  "scans before, by up to "),
            std::string::npos)
      << *frames.damage();
  EXPECT_TRUE(frames.damage()->ends_with("are not used."));
}

TEST(OrderedFrames, RunsThatPassTheSameTimesAreNamedAsSuch) {
  std::vector<Frame> runs;
  for (int i = 0; i < 400; ++i) runs.push_back(scan(100 + i % 200));
  OrderedFrames frames = ordered(runs);
  EXPECT_LT(times_of(frames).size(), 300U);
  ASSERT_TRUE(frames.damage());
  EXPECT_TRUE(frames.damage()->ends_with("as of several runs in one recording: expected one for each run."))
      << *frames.damage();
}

TEST(OrderedFrames, ScansOfAClockThatWasSetBackAreRefusedAndLateOnesAreNot) {
  for (const double back : {5.0, 37.0, 3600.0}) {
    std::vector<Frame> frames;
    for (int i = 0; i < 40; ++i) frames.push_back(scan(1000 + 0.1 * i - (i < 37 ? 0 : back)));
    OrderedFrames set_back = ordered(frames);
    times_of(set_back);
    EXPECT_NE(complaint([&] { set_back.refuse_set_back(); })
                  .find("recording 'r.rawlog' holds more than one run of its clock: the times of sensor 's' "
                        "jump back by "),
              std::string::npos)
        << back;
    frames.push_back(scan(1005));
    OrderedFrames late = ordered(frames);
    times_of(late);
    EXPECT_EQ(complaint([&] { late.refuse_set_back(); }), "");
  }
}

TEST(OrderedFrames, ACommentAtTheBeginningIsGivenBeforeAnythingElseIsRead) {
  auto memory =
      std::make_unique<MemoryFrames>(std::vector<Frame>{{5.0, "", CommentFrame{"setup"}}, image(7), scan(6)});
  MemoryFrames& source = *memory;
  OrderedFrames frames(std::move(memory), "r");
  EXPECT_TRUE(std::holds_alternative<CommentFrame>(frames.next()->content));
  EXPECT_EQ(source.given, 1U);
  EXPECT_EQ(times_of(frames), (std::vector<double>{6, 7}));
}

}  // namespace ordered_frames_test
}  // namespace clearway
