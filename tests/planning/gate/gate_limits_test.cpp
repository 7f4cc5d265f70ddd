// Where a gate begins to refuse, to the last bit, and what its sentences name.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "planning/gate/gate.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace gate_limits_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

double above(double value) { return std::nextafter(value, infinity); }

/// The disc robot, whose radius is 0.2 m, as fast as a gate's options let it be.
Robot disc() {
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_velocity = 0.0;
  return robot;
}

/// A wall at x = 1 m before the disc.
ConfigurationSpace before_wall(const SpaceOptions& options = {.padding = 0.0}) {
  VoxelScene scene;
  scene.occupied = {box_of(1.0, -1.0, 0.0, 1.05, 1.0, 0.05)};
  return {disc(), scene.snapshot(), {.critical_by_default = false}, options};
}

/// It waits at each place for a second, then goes on to the next.
MotionChunk through(const std::vector<Eigen::Vector2d>& places, double begin = 0.0) {
  MotionChunk chunk;
  for (const Eigen::Vector2d& place : places) {
    chunk.times.push_back(begin + static_cast<double>(chunk.times.size()));
    chunk.positions.push_back(place);
  }
  return chunk;
}

GateOptions usual() { return {.limits = {.max_velocity = {10.0}, .deceleration = {5.0}}}; }

void expect_says(const std::string& sentence, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    EXPECT_NE(sentence.find(part), std::string::npos) << "'" << part << "' in: " << sentence;
}

TEST(GateLimits, OptionsBeginWhereTheirWordsSay) {
  for (const double bad : {-1.0, 0.0, infinity, std::nan("")}) {
    EXPECT_THROW(Gate({.limits = {.max_velocity = {1.0, bad}}}), std::invalid_argument) << bad;
    EXPECT_THROW(Gate({.limits = {.deceleration = {bad}}}), std::invalid_argument) << bad;
    EXPECT_THROW(Gate({.limits = {.max_duration = bad}}), std::invalid_argument) << bad;
  }
  for (const double bad : {-1.0, infinity, std::nan("")})
    EXPECT_THROW(Gate({.limits = {.reaction = bad}}), std::invalid_argument) << bad;
  for (const double bad : {infinity, std::nan("")})
    EXPECT_THROW(Gate({.start = Configuration(Configuration::Constant(2, bad))}), std::invalid_argument)
        << bad;
  EXPECT_THROW(Gate({.limits = {.deceleration = {}}}), std::invalid_argument);
  for (const double good : {0.0, 0.5, 1e-9}) EXPECT_NO_THROW(Gate({.tolerance = good})) << good;
  for (const double bad : {-1e-9, infinity, -infinity, std::nan("")}) {
    try {
      const Gate gate({.tolerance = bad});
      ADD_FAILURE() << bad;
    } catch (const std::invalid_argument& error) {
      expect_says(error.what(), {"tolerance is ", "expected a finite number not below 0"});
    }
  }
  for (const double good : {1e-9, 0.5, infinity}) EXPECT_NO_THROW(Gate({.max_age = good})) << good;
  for (const double bad : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(Gate({.max_age = bad}), std::invalid_argument) << bad;
}

TEST(GateLimits, AStartOutOfTheRobotsLimitsIsRefusedWithTheMap) {
  GateOptions options = usual();
  for (const double x : {0.0, 100.0, 100.5}) {
    options.start = Eigen::Vector2d(x, 0.0);
    Gate gate(options);
    if (x <= 100.0) {
      EXPECT_EQ(gate.publish(before_wall()), 1U);
      continue;
    }
    try {
      gate.publish(before_wall());
      ADD_FAILURE();
    } catch (const std::invalid_argument& error) {
      expect_says(error.what(), {"gate: start: ", "x"});
    }
    EXPECT_EQ(gate.judge(through({{0.0, 0.0}, {0.0, 0.0}})).reason, GateReason::no_map);
  }
}

TEST(GateLimits, AChunkMayStartAsFarAsTheToleranceFromWhereTheRobotStands) {
  for (const double tolerance : {0.0, 0.25}) {
    for (const Eigen::Vector2d& way :
         {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, -1)}) {
      GateOptions options = usual();
      options.tolerance = tolerance;
      options.start = Eigen::Vector2d(0.0, 0.0);
      const auto judged = [&](double away) {
        Gate gate(options);
        gate.publish(before_wall());
        return gate.judge(through({away * way, away * way}));
      };
      EXPECT_TRUE(judged(tolerance).is_passed()) << tolerance;
      EXPECT_EQ(judged(above(tolerance)).reason, GateReason::jump) << tolerance;
    }
  }
}

/// A passed chunk leaves two places: where it ends, at x = 0, and where the robot stands after it, at 0.1.
TEST(GateLimits, AJumpNamesTheJointThatIsFarthestAndTheNearestPlace) {
  const auto sentence = [](const Eigen::Vector2d& first) {
    Gate gate(usual());
    gate.publish(before_wall());
    MotionChunk before;
    before.times = {0.0, 0.25};
    before.positions = {Eigen::Vector2d(-0.25, 0.0), Eigen::Vector2d(0.0, 0.0)};
    EXPECT_TRUE(gate.judge(before).is_passed());  // 1 m/s: stands 0.1 m farther
    const GateVerdict verdict = gate.judge(through({first, first}));
    EXPECT_EQ(verdict.reason, GateReason::jump);
    return verdict.sentence;
  };
  expect_says(sentence({0.1512345678, 0.03}),
              {"joint x is 0.151235, ", "ends it is 0.1, expected within 0.001"});
  expect_says(sentence({-0.1512345678, 0.03}), {"joint x is -0.151235, ", "ends it is 0, expected"});
  expect_says(sentence({0.03, 0.2}), {"joint y is 0.2, ", "ends it is 0, expected"});
  expect_says(sentence({0.03, -0.2}), {"joint y is -0.2, "});
}

TEST(GateLimits, AMapIsAsOldAsMaxAgeOrAsYoungAndNoMore) {
  GateOptions options = usual();
  options.max_age = 0.25;
  const auto judged = [&](double time) {
    Gate gate(options);
    gate.publish(before_wall(), 10.0);
    return gate.judge(through({{0.0, 0.0}, {0.0, 0.0}}, time));
  };
  for (const double time : {9.75, 10.0, 10.25}) EXPECT_TRUE(judged(time).is_passed()) << time;
  const GateVerdict older = judged(10.75), younger = judged(9.5);
  EXPECT_EQ(older.reason, GateReason::stale_map);
  EXPECT_EQ(older.map, 1U);
  EXPECT_EQ(older.sentence, "the newest map is 0.75 s older than the chunk, expected at most 0.25 s");
  EXPECT_EQ(younger.sentence,
            "the newest map is 0.5 s younger than the chunk, expected at most 0.25 s: are their clocks one?");
  EXPECT_EQ(judged(above(10.25)).reason, GateReason::stale_map);
  options.max_age = infinity;  // nobody asks
  Gate any(options);
  any.publish(before_wall(), std::nan(""));
  EXPECT_TRUE(any.judge(through({{0.0, 0.0}, {0.0, 0.0}}, 1e6)).is_passed());
}

/// Beside the wall by less than half the length at which an edge is given up: nothing touches, and nothing
/// is proved.
TEST(GateLimits, WhatIsTooNearToBeProvedNamesTheVoxel) {
  for (const double padding : {0.0, 0.06}) {
    Gate gate(usual());
    gate.publish(before_wall({.padding = padding, .edge_resolution = 0.02}));
    const double near = 0.799 - padding, free = 0.78 - padding;
    const GateVerdict verdict = gate.judge(through({{near, -0.5}, {near, 0.5}}));
    EXPECT_EQ(verdict.reason, GateReason::not_proved);
    expect_says(
        verdict.sentence,
        {"from positions[0] to positions[1]: base comes too near to a blocked voxel to be proved free; "});
    ASSERT_TRUE(verdict.evidence);
    EXPECT_EQ(verdict.evidence->voxel.state, VoxelState::occupied);
    EXPECT_TRUE(gate.judge(through({{free, -0.5}, {free, 0.5}})).is_passed());
  }
}

/// Two balls that pass each other: parts of the robot, so that no voxel is to blame.
TEST(GateLimits, PartsThatTouchOrComeTooNearHaveNoVoxelToBlame) {
  const auto judged = [](double beside) {
    const std::string sphere = "<sphere radius='0.05'/>";
    const worlds::UrdfRobot slider(
        "slider", worlds::urdf_link("base", "1 " + std::to_string(beside) + " 0", sphere) +
                      "<link name='turntable'/>" + worlds::urdf_link("hand", "0 0 0", sphere) +
                      worlds::urdf_joint("turn", "revolute", "base", "turntable", "0 0 0", "0 0 1",
                                         worlds::urdf_limit(-1, 1)) +
                      worlds::urdf_joint("slide", "prismatic", "turntable", "hand", "0 0 0", "1 0 0",
                                         worlds::urdf_limit(-10, 2)));
    GateOptions options = usual();
    options.allow_outside = {"all"};
    Gate gate(options);
    Robot robot = slider.robot();
    for (Joint& joint : robot.joints) joint.max_velocity = 0.0;
    gate.publish(
        {robot, Snapshot(), {.critical_by_default = false}, {.padding = 0.0, .edge_resolution = 0.02}});
    return gate.judge(through({{0.0, 0.5}, {0.0, 1.5}}));
  };
  EXPECT_TRUE(judged(0.15).is_passed()) << judged(0.15).sentence;
  const GateVerdict touching = judged(0.05), near = judged(0.101);
  EXPECT_EQ(touching.reason, GateReason::self_collision);
  EXPECT_FALSE(touching.evidence);
  expect_says(touching.sentence, {"base", " touches ", "hand"});
  EXPECT_EQ(near.reason, GateReason::not_proved);
  EXPECT_FALSE(near.evidence);
  expect_says(near.sentence, {"comes too near to something or to another part to be proved free"});
}

/// Within the tolerance of where it held the load first, however many chunks there were, and either way.
TEST(GateLimits, AGripIsThatOfTheStatedStartBitByBitAndEitherWay) {
  const worlds::UrdfRobot gripper = worlds::gripper();
  Load can;
  can.name = "can";
  can.link = "palm";
  can.shape = Shape::sphere(0.01);
  can.link_from_load.translation().z() = -0.08;
  can.touches = {"left", "right"};
  const auto standing = [](double begin, double grip) {
    const Configuration q = (Configuration(5) << 0, 0, 0.5, 0, grip).finished();
    return MotionChunk{{begin, begin + 0.1}, {q, q}};
  };
  GateOptions options = usual();
  options.allow_outside = {"all"};
  for (const double sign : {1.0, -1.0}) {
    Gate gate(options);
    gate.publish({with_load(gripper.robot(), can), VoxelScene{}.snapshot(), {.critical_by_default = false}});
    const auto passes = [&](double moved) {
      return gate.judge(standing(0.0, 0.02 + sign * moved)).is_passed();
    };
    gate.restart(standing(0.0, 0.02).positions[0]);
    EXPECT_TRUE(passes(0.0007));
    EXPECT_FALSE(passes(0.0014));
    EXPECT_TRUE(passes(0.0));
    gate.restart();  // anywhere: as wide as it is now
    EXPECT_TRUE(passes(0.0014));
    EXPECT_TRUE(passes(0.0014 + 0.0007));
  }
}

}  // namespace gate_limits_test
}  // namespace clearway
