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

}  // namespace teach_window_test
}  // namespace clearway
