#include "apps/teach/teach_window.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace clearway {
namespace teach_window_test {

TEST(TeachWindow, ADisplayThatDoesNotAnswerIsNone) {
  ::unsetenv("WAYLAND_DISPLAY");
  ::unsetenv("DISPLAY");
  EXPECT_FALSE(has_display());
  ::setenv("DISPLAY", ":6173", 1);
  EXPECT_FALSE(has_display());
  ::setenv("WAYLAND_DISPLAY", "no_such_socket", 1);
  EXPECT_FALSE(has_display());
  ::setenv("QT_QPA_PLATFORM", "offscreen", 1);  // a platform of Qt's that needs no server
  EXPECT_TRUE(has_display());
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}) ::unsetenv(name);
}

TEST(TeachWindow, APictureIsShownWholeAndNeverLarger) {
  EXPECT_EQ(shown_size({752, 480}, {1920, 1080}), cv::Size(752, 480));
  for (const cv::Size picture : {cv::Size(3840, 2160), cv::Size(1280, 1024), cv::Size(1024, 4000)})
    for (const cv::Size screen : {cv::Size(1024, 768), cv::Size(1920, 1080), cv::Size(100, 100)}) {
      const cv::Size shown = shown_size(picture, screen);
      EXPECT_GE(shown.width, 1);
      EXPECT_GE(shown.height, 1);
      if (screen.width <= 100) continue;  // no room beside the bars
      EXPECT_LT(shown.width, screen.width);
      EXPECT_LT(shown.height, screen.height);
      EXPECT_NEAR(static_cast<double>(shown.width) / shown.height,
                  static_cast<double>(picture.width) / picture.height, 0.01 * picture.width / picture.height);
    }
}

}  // namespace teach_window_test
}  // namespace clearway
