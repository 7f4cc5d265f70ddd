#include "planning/gate/motion_chunk.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace motion_chunk_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The disc robot: joints x and y, metres.
class Chunk : public ::testing::Test {
 protected:
  GateReason reason(const MotionChunk& chunk) const { return find_fault(chunk, robot_, limits_).reason; }
  std::string sentence(const MotionChunk& chunk) const { return find_fault(chunk, robot_, limits_).sentence; }

  Robot robot_ = load_robot("point");
  JointLimits limits_ = joint_limits(robot_, {.max_velocity = {1.0}});
  MotionChunk good_{{0.0, 0.1, 0.3},
                    {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.05, 0), Eigen::Vector2d(0.1, 0.1)}};
};

TEST_F(Chunk, WithNothingWrongHasNoFault) {
  EXPECT_EQ(reason(good_), GateReason::none);
  EXPECT_EQ(sentence(good_), "");
}

TEST_F(Chunk, NeedsTwoToSixtyFourConfigurationsWithATimeAndAValueForEachJoint) {
  for (const std::size_t count : {0U, 1U, 2U, 64U, 65U}) {
    MotionChunk chunk;
    for (std::size_t i = 0; i < count; ++i) {
      chunk.times.push_back(static_cast<double>(i));
      chunk.positions.push_back(Eigen::Vector2d(0, 0));
    }
    const GateReason expected = count < 2    ? GateReason::too_short
                                : count > 64 ? GateReason::too_long
                                             : GateReason::none;
    limits_.max_duration = 100.0;
    EXPECT_EQ(reason(chunk), expected) << count;
  }
  MotionChunk chunk = good_;
  chunk.times.pop_back();
  EXPECT_EQ(sentence(chunk), "the chunk has 2 times for 3 configurations, expected one for each");
  EXPECT_EQ(reason(chunk), GateReason::wrong_size);
  chunk = good_;
  chunk.positions[1] = Eigen::Vector3d(0, 0, 0);
  EXPECT_EQ(sentence(chunk), "positions[1] has 3 values, expected 2, one for each joint of point");
  EXPECT_EQ(reason(chunk), GateReason::wrong_size);
}

TEST_F(Chunk, OfValuesThatAreNotFiniteIsRefusedWhereverTheyStand) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), infinity, -infinity}) {
    for (std::size_t i = 0; i < 3; ++i) {
      MotionChunk chunk = good_;
      chunk.times[i] = bad;
      EXPECT_EQ(reason(chunk), GateReason::not_finite);
      chunk = good_;
      chunk.positions[i][1] = bad;
      EXPECT_EQ(reason(chunk), GateReason::not_finite);
      EXPECT_EQ(sentence(chunk), "positions[" + std::to_string(i) + "][1] is not finite, expected a number");
    }
  }
}

TEST_F(Chunk, WhoseTimesRepeatOrGoBackOrLastTooLongIsRefused) {
  MotionChunk chunk = good_;
  chunk.times[2] = chunk.times[1];
  EXPECT_EQ(reason(chunk), GateReason::time_order);
  EXPECT_EQ(sentence(chunk), "times[2] is 0.1 s, not after times[1], which is 0.1 s");
  chunk.times = {0.3, 0.1, 0.0};
  EXPECT_EQ(reason(chunk), GateReason::time_order);
  chunk.times = {-1e308, 0.0, 1e308};
  EXPECT_EQ(reason(chunk), GateReason::lasts_too_long);
  chunk.times = {0.0, 1.0, 60.0};
  EXPECT_EQ(reason(chunk), GateReason::none);
  chunk.times.back() = 60.001;
  EXPECT_EQ(reason(chunk), GateReason::lasts_too_long);
}

TEST_F(Chunk, PastAJointLimitOrFasterThanAJointIsRefusedAndTheJointIsNamed) {
  robot_.joints[1].upper = 0.1;
  EXPECT_EQ(reason(good_), GateReason::none);
  robot_.joints[1].upper = 0.0999;
  EXPECT_EQ(reason(good_), GateReason::joint_limit);
  EXPECT_NE(sentence(good_).find("positions[2]: joint " + robot_.joints[1].name), std::string::npos)
      << sentence(good_);
  robot_.joints[1].upper = infinity;
  MotionChunk far = good_;
  far.times = {0.0, 1.0, 2.0};
  for (Configuration& q : far.positions) q[1] = 1e7;
  EXPECT_EQ(reason(far), GateReason::joint_limit);
  MotionChunk fast = good_;
  fast.times[1] = 0.05;  // 1 m/s, its limit, but for what rounding adds
  EXPECT_EQ(reason(fast), GateReason::none);
  fast.times[1] = 0.0499;
  EXPECT_EQ(reason(fast), GateReason::velocity_limit);
  EXPECT_NE(sentence(fast).find("joint " + robot_.joints[0].name + " moves at 1.002 m/s"), std::string::npos)
      << sentence(fast);
  MotionChunk rounded = good_;
  Random random(7);
  for (int k = 0; k < 200; ++k) {
    const double dt = random.between(0.02, 0.1), begin = k % 2 == 0 ? 1764300000.0 : 0.0;
    for (std::size_t i = 0; i < rounded.times.size(); ++i) {
      const double at = static_cast<double>(i) * dt;
      rounded.times[i] = begin + at;
      rounded.positions[i] = Eigen::Vector2d(at, 0.0);  // 1 m/s
      if (k % 2 != 0) rounded.positions[i] = rounded.positions[i].cast<float>().cast<double>();
    }
    ASSERT_EQ(reason(rounded), GateReason::none) << sentence(rounded);
    rounded.positions.back()[0] += 0.0015 * dt;
    ASSERT_EQ(reason(rounded), GateReason::velocity_limit) << dt;
  }
  fast.times = {0.0, 1e-320, 0.3};
  EXPECT_EQ(reason(fast), GateReason::velocity_limit);
}

TEST_F(Chunk, KeepsTheSmallerOfTheRobotsVelocityAndTheOneAskedFor) {
  robot_.joints[0].max_velocity = 0.5;
  robot_.joints[1].max_velocity = 0.0;  // its file gives none
  EXPECT_EQ(joint_limits(robot_, {}).max_velocity, Eigen::Vector2d(0.5, 1.0));
  EXPECT_EQ(joint_limits(robot_, {.max_velocity = {2.0}}).max_velocity, Eigen::Vector2d(0.5, 2.0));
  EXPECT_EQ(joint_limits(robot_, {.max_velocity = {0.25, 0.75}}).max_velocity, Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(joint_limits(robot_, {.deceleration = {2.0, 3.0}}).deceleration, Eigen::Vector2d(2.0, 3.0));
}

TEST_F(Chunk, BrakesNoHarderThanTheRobotCan) {
  robot_.joints[0].max_acceleration = 0.5;
  robot_.joints[1].max_acceleration = 0.0;  // its file gives none
  EXPECT_EQ(joint_limits(robot_, {}).deceleration, Eigen::Vector2d(0.5, 5.0));
  EXPECT_EQ(joint_limits(robot_, {.deceleration = {0.25, 0.75}}).deceleration, Eigen::Vector2d(0.25, 0.75));
  EXPECT_EQ(joint_limits(robot_, {.deceleration = {9.0}}).deceleration, Eigen::Vector2d(0.5, 9.0));
}

TEST_F(Chunk, PositionsOfSinglePrecisionAtALimitAreDrawnToIt) {
  Random random(5);
  for (int i = 0; i < 300; ++i) {
    const double limit = random.between(0.01, 7.0) * (i % 2 == 0 ? 1.0 : -1.0);
    (limit > 0.0 ? robot_.joints[0].upper : robot_.joints[0].lower) = limit;
    MotionChunk chunk = good_;
    for (Configuration& q : chunk.positions) q[0] = static_cast<double>(static_cast<float>(limit));
    const std::optional<MotionChunk> drawn = drawn_to_limits(chunk, robot_);
    ASSERT_EQ(drawn.has_value(), std::abs(chunk.positions[0][0]) > std::abs(limit)) << limit;
    if (drawn) {
      EXPECT_EQ(drawn->positions[1][0], limit);
      EXPECT_EQ(find_fault(*drawn, robot_, limits_).reason, GateReason::none);
    }
    chunk.positions[1][0] = limit * (1.0 + 3e-7);
    EXPECT_NE(find_fault(drawn_to_limits(chunk, robot_).value_or(chunk), robot_, limits_).reason,
              GateReason::none);
    (limit > 0.0 ? robot_.joints[0].upper : robot_.joints[0].lower) = limit > 0.0 ? 10.0 : -10.0;
  }
  MotionChunk odd = good_;
  odd.positions[1] = Eigen::Vector3d(1, 2, 3);
  EXPECT_FALSE(drawn_to_limits(odd, robot_));
}

TEST_F(Chunk, LimitsOutOfRangeAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<MotionLimits> wrong = {
      {.deceleration = {}},         {.deceleration = {0.0}},  {.deceleration = {1.0, 2.0, 3.0}},
      {.deceleration = {infinity}}, {.max_velocity = {-1.0}}, {.max_velocity = {nan}},
      {.reaction = -1.0},           {.reaction = infinity},   {.max_duration = 0.0},
      {.max_duration = infinity}};
  for (const MotionLimits& limits : wrong) EXPECT_THROW(joint_limits(robot_, limits), std::invalid_argument);
}

TEST_F(Chunk, AStopIsWhereSteppedBrakingEnds) {
  limits_.deceleration = Eigen::Vector2d(2.0, 0.5);
  limits_.reaction = 0.1;
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d from(random.unit(), random.unit());
    const Eigen::Vector2d velocity(random.between(-1, 1), random.between(-1, 1));
    // As a drive does it, in small steps: one joint slows at its limit, the other in proportion.
    Eigen::Vector2d q = from + 0.1 * velocity, rate = velocity;
    const double share = std::min(2.0 / std::abs(velocity[0]), 0.5 / std::abs(velocity[1]));
    constexpr double step = 1e-4;
    for (double left = 1.0; left > 0.0; left -= share * step) {
      rate = left * velocity;
      q += rate * step;
    }
    EXPECT_LT((stop_from(from, velocity, limits_) - q).norm(), 2e-4);
  }
  EXPECT_EQ(stop_from(Eigen::Vector2d(1, 2), Eigen::Vector2d(0, 0), limits_), Eigen::Vector2d(1, 2));
}

TEST_F(Chunk, ACornerIsSharpWhereARateChangesByMoreThanTheJointMakesInTheShorterEdge) {
  limits_.deceleration = Eigen::Vector2d(5.0, 5.0);
  MotionChunk chunk{{0.0, 1.0, 1.1},
                    {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.9, 0), Eigen::Vector2d(0.95, 0)}};
  EXPECT_FALSE(is_sharp(chunk, 1, limits_));  // 0.9 to 0.5 m/s in 0.1 s
  chunk.positions[2][0] = 0.93;
  EXPECT_TRUE(is_sharp(chunk, 1, limits_));
  chunk.positions[2] = chunk.positions[1];
  chunk.times[2] = 1.0 + 1e-6;  // stands at once, says the chunk
  EXPECT_TRUE(is_sharp(chunk, 1, limits_));
  for (const Eigen::Vector2d& along : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
    chunk = {{0.0, 0.1, 1.1}, {0.0 * along, 0.03 * along, 0.93 * along}};
    EXPECT_TRUE(is_sharp(chunk, 1, limits_));  // 0.3 to 0.9 m/s in 0.1 s
    chunk.positions[1] = 0.05 * along, chunk.positions[2] = 0.95 * along;
    EXPECT_FALSE(is_sharp(chunk, 1, limits_));
  }
}

}  // namespace motion_chunk_test
}  // namespace clearway
