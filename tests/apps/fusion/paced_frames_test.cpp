#include "apps/fusion/paced_frames.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/worlds/memory_frames.hpp"

namespace clearway {
namespace paced_frames_test {

using Clock = std::chrono::steady_clock;

std::vector<Frame> images(int count, double period) {
  std::vector<Frame> frames{{0.0, "", CommentFrame{"a setup"}}};
  for (int i = 0; i < count; ++i) frames.push_back({100.0 + i * period, "camera", ImageFrame{}});
  return frames;
}

TEST(PacedFrames, NoFrameComesBeforeItsTimeAndScansWait) {
  std::vector<Frame> frames = images(4, 0.02);
  frames.push_back({100.07, "lidar", CloudFrame{}});
  PacedFrames paced(std::make_unique<MemoryFrames>(frames));
  EXPECT_TRUE(paced.is_live());
  ASSERT_TRUE(paced.next());  // the comment: at once
  std::optional<Clock::time_point> begin;
  std::size_t scans = 0;
  while (const auto frame = paced.next()) {
    if (!begin) begin = Clock::now();
    const double since = std::chrono::duration<double>(Clock::now() - *begin).count();
    EXPECT_GE(since, frame->time - 100.0 - 0.002);
    scans += std::holds_alternative<CloudFrame>(frame->content);
  }
  EXPECT_EQ(scans, 1u);
}

TEST(PacedFrames, ImagesThatComeWhileOneIsWorkedOnAreLeftOutAndCounted) {
  PacedFrames paced(std::make_unique<MemoryFrames>(images(10, 0.01)));
  ASSERT_TRUE(paced.next());
  ASSERT_TRUE(paced.next());  // the first image, at 0
  std::this_thread::sleep_for(std::chrono::milliseconds(55));
  const auto next = paced.next();
  ASSERT_TRUE(next);
  EXPECT_GE(next->time, 100.05);  // those of 10, 20, 30 and 40 ms are gone
  std::size_t left = 0;
  while (paced.next()) ++left;
  EXPECT_LE(left, 4u);
  ASSERT_EQ(paced.warnings().size(), 1u);
  EXPECT_NE(paced.warnings()[0].find("images came while one before them was worked on"), std::string::npos);
}

}  // namespace paced_frames_test
}  // namespace clearway
