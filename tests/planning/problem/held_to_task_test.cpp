// When a leg may end beside its goal. What else is asked of planners: ../plan_and_check_test.cpp.
#include "planning/problem/held_to_task.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace held_to_task_test {

/// Of a beam alone, that says it ended short and made no last segment, and no farther off than it says.
TEST(HeldToTask, ABeamWithoutALastSegmentMayEndAsFarFromItsGoalAsItSays) {
  const Configuration goal = Eigen::Vector2d(1.0, 2.0);
  PlanResult leg;
  leg.waypoints = {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.3, 2.4)};  // 0.5 from there
  leg.final_distance = 0.5;
  for (const char* beam : {"beam", "beam_reference"}) EXPECT_TRUE(ends_in_goal_box(beam, leg, goal)) << beam;
  for (const char* other : {"auto", "beam_guided", "rrtconnect", ""})
    EXPECT_FALSE(ends_in_goal_box(other, leg, goal)) << other;
  PlanResult farther = leg, led = leg;
  farther.final_distance = 0.49;
  led.last_segment = true;
  EXPECT_FALSE(ends_in_goal_box("beam", farther, goal));
  EXPECT_FALSE(ends_in_goal_box("beam", led, goal));
}

}  // namespace held_to_task_test
}  // namespace clearway
