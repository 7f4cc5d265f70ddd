// What the beam search refuses, and how it says so.

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/beam_world.hpp"

namespace clearway {
namespace beam_refusals_test {

/// It moves with the last edge, to the goal.
TEST(Beam, TakesAJointThatMovesLessThanItsStep) {
  Robot robot = load_robot("point");
  robot.joints[1].lower = -0.04, robot.joints[1].upper = 0.04;
  const BeamWorld world(robot, VoxelScene{});
  for (const char* planner : {"beam", "beam_reference"})
    for (const char* step : {"0.08", "0.1"}) {
      const PlanResult plan =
          world.plan(planner, vector_of({0.0, -0.03}), vector_of({1.0, 0.04}), {{"step", step}});
      EXPECT_EQ(plan.status, PlanStatus::solved) << planner << step << plan.explanation;
      EXPECT_EQ(plan.waypoints.back(), vector_of({1.0, 0.04}));
    }
}

/// The sentence that a user reads; empty when nothing is refused.
std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

TEST(Beam, RefusesBadOptionsInOneSentenceThatNamesThem) {
  const BeamWorld world(load_robot("point"), VoxelScene{});
  const auto refusal_of = [&](const PlannerOptions& options) {
    return refusal([&] { world.plan("beam", vector_of({0.0, 0.0}), vector_of({1.0, 0.0}), options); });
  };
  EXPECT_EQ(refusal_of({{"step", "0.1"}}), "");
  for (const auto& [option, value] :
       std::vector<std::pair<std::string, std::string>>{{"width", "0"},
                                                        {"width", "-3"},
                                                        {"step", "0"},
                                                        {"step", "-0.1"},
                                                        {"step", "0.1,0"},
                                                        {"step_deg", "0"},
                                                        {"step_deg", "-1"},
                                                        {"step", "0.1,0.1,0.1"},
                                                        {"max_steps", "0"},
                                                        {"prismatic_scale", "-1"}}) {
    const std::string sentence = refusal_of({{option, value}});
    EXPECT_NE(sentence.find("beam"), std::string::npos) << option << " " << value << ": " << sentence;
    EXPECT_NE(sentence.find("'" + option + "'"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("expected"), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
  }
}

TEST(Beam, StartAndGoalPastALimitAreReportedWithTheJoint) {
  Robot robot = load_robot("point");
  robot.joints[0].lower = -1.0, robot.joints[0].upper = 1.0;
  const BeamWorld world(robot, VoxelScene{});
  const Configuration inside = vector_of({0.0, 0.0}), outside = vector_of({1.25, 0.0});
  const PlanResult start = world.plan("beam", outside, inside, {}),
                   goal = world.plan("beam", inside, outside, {});
  EXPECT_EQ(start.status, PlanStatus::start_invalid);
  EXPECT_EQ(goal.status, PlanStatus::goal_invalid);
  for (const std::string& sentence : {start.explanation, goal.explanation}) {
    EXPECT_NE(sentence.find("joint " + robot.joints[0].name), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("0.25"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("limit"), std::string::npos) << sentence;
  }
}

}  // namespace beam_refusals_test
}  // namespace clearway
