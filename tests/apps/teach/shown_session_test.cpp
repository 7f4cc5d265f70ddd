#include "apps/teach/shown_session.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace shown_session_test {

TEST(ShownSession, ALineSaysOnceWhichActionItIs) {
  TaughtEvent event;
  event.event.time = 1.5;
  event.event.action = TeachAction::start;
  event.state = TeachState::selecting;
  EXPECT_EQ(line_of(event), "1.5 s  start  [selecting]");
  event.remark = "0.1, 0.2";
  EXPECT_EQ(line_of(event), "1.5 s  start: 0.1, 0.2  [selecting]");
  event.refusal = "no robot is chosen; 'robot' chooses one";
  EXPECT_EQ(line_of(event), "1.5 s  start refused: no robot is chosen; 'robot' chooses one");
}

}  // namespace shown_session_test
}  // namespace clearway
