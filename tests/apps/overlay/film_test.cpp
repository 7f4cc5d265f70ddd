#include "apps/overlay/film.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "datasets/pictures/video.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace film_test {

struct Shown {
  double time;
  int grey;
};

/// What a film shows whose pictures have these times; the i-th is as bright as 20 + 8 i.
std::vector<Shown> film_of(const std::vector<double>& times, int more = 0) {
  const TemporaryFolder folder;
  Film film(folder / "film.mp4");
  const auto picture = [](std::size_t i) {
    return cv::Mat(96, 160, CV_8UC3, cv::Scalar::all(20.0 + 8.0 * static_cast<double>(i)));
  };
  for (std::size_t i = 0; i < times.size(); ++i) film.add(times[i], picture(i));
  for (int i = 0; i < more; ++i) film.add(picture(times.size()));
  film.finish();
  std::vector<Shown> shown;
  const auto source = open_video(folder / "film.mp4", {});
  while (const auto frame = source->next()) {
    const int grey = std::get<ImageFrame>(frame->content).image.pixels[160 * 48 + 80];
    shown.push_back({frame->time, static_cast<int>(std::lround((grey - 20) / 8.0))});
  }
  EXPECT_FALSE(source->damage()) << *source->damage();
  return shown;
}

TEST(Film, LastsAsLongAsARecordingAtUnevenTimesAndShowsEachPictureAtItsTime) {
  // A burst, a pause of two seconds, and slow pictures; from a clock that does not begin at 0.
  std::vector<double> times{100.0};
  for (int i = 0; i < 8; ++i) times.push_back(times.back() + 0.05);
  times.push_back(times.back() + 2.0);
  for (int i = 0; i < 12; ++i) times.push_back(times.back() + 0.3);
  const std::vector<Shown> shown = film_of(times);
  ASSERT_FALSE(shown.empty());
  EXPECT_NEAR(shown.back().time, times.back() - times.front(), 0.06);
  for (const Shown& one : shown) {
    std::size_t latest = 0;
    while (latest + 1 < times.size() && times[latest + 1] - times[0] <= one.time + 0.001) ++latest;
    EXPECT_NEAR(one.grey, static_cast<double>(latest), 1.0) << one.time;
    EXPECT_LT(std::abs(one.time - (times[static_cast<std::size_t>(one.grey)] - times[0])), 2.05) << one.time;
  }
  EXPECT_NEAR(shown[20].grey, 8, 0);  // a second into the pause
}

TEST(Film, PicturesAtEvenTimesAreEachShownOnceAlsoWhenTheirClockShakes) {
  std::vector<double> times;
  for (int i = 0; i < 25; ++i) times.push_back(0.1 * i + (i % 3 - 1) * 0.015);
  const std::vector<Shown> shown = film_of(times, 2);
  ASSERT_EQ(shown.size(), 27U);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(shown[i].grey, static_cast<int>(i));
  EXPECT_NEAR(shown.back().time, 2.6, 1e-3);
}

TEST(Film, AClockThatIsSetMakesNoPause) {
  EXPECT_EQ(film_of({0.0, 0.1, 0.2, 1.7e9, 1.7e9 + 0.1}).size(), 5U);
  EXPECT_EQ(film_of({5.0, 5.1, 5.2, 1.0, 1.1}).size(), 5U);
}

}  // namespace film_test
}  // namespace clearway
