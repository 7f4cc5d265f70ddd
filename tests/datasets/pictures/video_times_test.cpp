#include "datasets/pictures/video_times.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace video_times_test {

TEST(PictureClock, AMissingPictureTakesNoTimeFromThoseBehindItWhereDecodingTellsTheTimes) {
  const VideoTimes video{{0.0, 0.1, 0.3, 0.4, 0.9}, 5, 5, false, true};
  PictureClock clock(video, 10.0);
  EXPECT_EQ(clock.next(0.0), 0.0);
  EXPECT_EQ(clock.next(0.1), 0.1);
  EXPECT_EQ(clock.next(0.4), 0.4);  // that of 0.3 could not be decoded
  EXPECT_EQ(clock.next(0.0), 0.9);  // the decoder is empty: nothing is reported
  EXPECT_EQ(clock.next(0.0), std::nullopt);
}

TEST(PictureClock, TimesOfDecodingThatAreNoTimesOfShowingAreNotHeard) {
  VideoTimes video{{0.0, 0.1, 0.3}, 3, 3, false, false};
  PictureClock unlike(video, 10.0);
  EXPECT_EQ(unlike.next(0.1), 0.0);
  EXPECT_EQ(unlike.next(0.3), 0.1);
  video.is_time_reported = true;
  PictureClock late(video, 10.0);  // by one picture
  EXPECT_EQ(late.next(0.1), 0.0);
  EXPECT_EQ(late.next(0.3), 0.1);
  EXPECT_EQ(late.next(0.0), 0.3);
}

TEST(PictureClock, WithoutAnyTimesTheRateCounts) {
  PictureClock clock({{}, 3, 3, false, false}, 4.0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(clock.next(7.0), 0.25 * i);
}

}  // namespace video_times_test
}  // namespace clearway
