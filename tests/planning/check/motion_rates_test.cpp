// Rates, rests and legs of motions whose every number is known by arithmetic, on either side of each bound.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>
#include <tuple>

#include "planning/check/motion_check.hpp"
#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/slide_robot.hpp"

namespace clearway {
namespace motion_rates_test {

/// Along each joint jerks of J, -J, -J and J for a period each: from rest to rest, and by arithmetic
/// everywhere. There and back in two legs when `is_back`, with so many knots of rest between them.
struct Wave {
  explicit Wave(const Eigen::VectorXd& jerk, double period, bool is_back = false, std::size_t standing = 0) {
    motion.period = period;
    const double h = period;
    const auto add = [&](double p, double v, double a) {
      motion.positions.push_back(p * h * h * h * jerk);
      motion.velocities.push_back(v * h * h * jerk);
      motion.accelerations.push_back(a * h * jerk);
    };
    const double place[] = {0.0, 1.0 / 6, 1.0, 11.0 / 6, 2.0}, speed[] = {0.0, 0.5, 1.0, 0.5, 0.0},
                 change[] = {0.0, 1.0, 0.0, -1.0, 0.0};
    for (int k = 0; k < 5; ++k) add(place[k], speed[k], change[k]);
    rests.push_back(4);
    for (std::size_t k = 0; k < standing; ++k) add(2.0, 0.0, 0.0);
    for (int k = 1; is_back && k < 5; ++k) add(2.0 - place[k], -speed[k], -change[k]);
    if (is_back) rests.push_back(8 + standing);
    stops = {motion.positions[0], motion.positions[4]};
    if (is_back) stops.push_back(motion.positions.back());
    limits = {2.0 * h * h * jerk.cwiseAbs(), 2.0 * h * jerk.cwiseAbs(), 2.0 * jerk.cwiseAbs()};
    robot = worlds::slide_robot();
    robot.joints.resize(static_cast<std::size_t>(jerk.size()), robot.joints[0]);
    for (std::size_t j = 0; j < robot.joints.size(); ++j) {
      robot.joints[j].name = "j" + std::to_string(j);
      robot.joints[j].lower = -100.0;
      robot.joints[j].upper = 100.0;
    }
  }

  MotionVerdict verdict(const std::vector<std::size_t>& grips = {}) const {
    return check_rates(robot, {motion, rests, stops, limits, grip_time}, grips);
  }
  std::string fault(const std::vector<std::size_t>& grips = {}) const {
    const MotionVerdict found = verdict(grips);
    EXPECT_EQ(found.valid, found.fault.empty());
    return found.fault;
  }

  Robot robot;
  Motion motion;
  std::vector<std::size_t> rests;
  std::vector<Configuration> stops;
  RateLimits limits;
  double grip_time = 0.0;
};

TEST(MotionRates, LimitsBindToAMillionthOnEachJoint) {
  const double h = 0.25;
  const Eigen::Vector3d jerk(2.0, -3.0, 0.5);
  const Wave wave(jerk, h);
  const MotionVerdict half = wave.verdict();
  EXPECT_TRUE(half.valid) << half.fault;
  EXPECT_NEAR(half.shares.velocity, 0.5, 1e-12);
  EXPECT_NEAR(half.shares.acceleration, 0.5, 1e-12);
  EXPECT_NEAR(half.shares.jerk, 0.5, 1e-9);
  EXPECT_EQ(half.samples, 4U * 251U);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const double most[] = {h * h * std::abs(jerk[j]), h * std::abs(jerk[j]), std::abs(jerk[j])};
    for (int which = 0; which < 3; ++which) {
      const std::string name = which == 0 ? "velocity" : which == 1 ? "acceleration" : "jerk";
      const auto fault_at = [&](double share) {
        Wave tight = wave;
        auto& limit = which == 0   ? tight.limits.velocity
                      : which == 1 ? tight.limits.acceleration
                                   : tight.limits.jerk;
        limit[j] = most[which] / share;
        return tight.fault();
      };
      EXPECT_EQ(fault_at(1.0 + 0.8e-6), "") << name << j;
      const std::string fault = fault_at(1.0 + 1.2e-6);
      EXPECT_NE(fault.find("the " + name + " of joint j" + std::to_string(j) + " is "), std::string::npos)
          << fault;
      // The speed is reached at the end of the second period, the acceleration at that of the first.
      const std::string when = which == 0 ? "after 0.25 s" : "after 0 s";
      EXPECT_NE(fault.find(when), std::string::npos) << fault;
      EXPECT_NE(fault.find(", its limit "), std::string::npos) << fault;
    }
  }
}

TEST(MotionRates, ItsSentencesAreTheSameInEveryLocale) {
  Wave fast(Eigen::Vector2d(1.0, 3.0), 0.25), restless(Eigen::Vector2d(1.0, 3.0), 0.25, true, 1);
  fast.limits.jerk[1] = 2.5;
  restless.grip_time = 1.25;
  expect_same_in_every_locale([&] { return fast.fault(); }, "jerk of joint j1 is 3, its limit 2.5");
  expect_same_in_every_locale([&] { return restless.fault({12}); }, "rest for 1.25 s for each of 12 loads");
}

TEST(MotionRates, EachCubicIsSampledEveryMillisecondAtLeast) {
  for (const auto& [period, samples] : {std::pair(0.0004, 2U), std::pair(0.001, 2U), std::pair(0.0011, 3U),
                                        std::pair(0.003, 4U), std::pair(0.0031, 5U), std::pair(0.1, 101U)}) {
    const MotionVerdict verdict = Wave(Eigen::VectorXd::Constant(1, 1.0), period).verdict();
    EXPECT_TRUE(verdict.valid) << verdict.fault;
    EXPECT_EQ(verdict.samples, 4U * samples) << period;
  }
}

TEST(MotionRates, JointLimitsBindOnEachSide) {
  for (const double sign : {1.0, -1.0}) {
    Wave wave(Eigen::Vector2d(0.5, sign * 2.0), 0.5);
    const double end = wave.stops[1][1];
    for (const double beyond : {0.5e-9, 2e-9}) {
      Joint& joint = wave.robot.joints[1];
      joint.lower = -100.0, joint.upper = 100.0;
      (sign > 0.0 ? joint.upper : joint.lower) = end - sign * beyond;
      EXPECT_EQ(wave.fault().empty(), beyond < 1e-9) << wave.fault();
      joint.lower = -100.0, joint.upper = 100.0;
      (sign > 0.0 ? joint.lower : joint.upper) = sign * beyond;  // where it begins
      EXPECT_EQ(wave.fault().empty(), beyond < 1e-9) << wave.fault();
      EXPECT_EQ(wave.fault().find("position of joint j1 is ") == std::string::npos, beyond < 1e-9);
    }
  }
}

TEST(MotionRates, AccelerationsAreThoseOfTheCubicsToAMillionthOfTheirLimit) {
  for (const double limit : {0.6, 5.0}) {  // of accelerations up to 0.5
    const double tolerance = 1e-6 * std::max(1.0, limit);
    for (std::size_t k = 1; k < 4; ++k) {
      for (const double sign : {-1.0, 1.0}) {
        for (const double share : {0.9, 1.1}) {
          Wave wave(Eigen::Vector2d(1.0, 1.0), 0.5);
          wave.limits.acceleration.setConstant(limit);
          wave.motion.accelerations[k][1] += sign * share * tolerance;
          const std::string fault = wave.fault();
          EXPECT_EQ(fault.empty(), share < 1.0) << limit << ' ' << k << ' ' << fault;
          if (share < 1.0) continue;
          std::ostringstream when;
          when << "after " << 0.5 * static_cast<double>(k) << " s the acceleration that positions";
          EXPECT_NE(fault.find(when.str()), std::string::npos) << fault;
          EXPECT_NE(fault.find(" of joint j1 is "), std::string::npos) << fault;
        }
      }
    }
  }
}

RateLimits wide(double jerk) {
  return {Eigen::Vector2d(1.0, 1.0), Eigen::Vector2d(100.0, 100.0), Eigen::Vector2d(jerk, jerk)};
}

/// Velocity and acceleration at a stop up to a millionth of their limits, and the place as a contract has it.
TEST(MotionRates, ItRestsWhereItStops) {
  for (const std::size_t knot : {0U, 4U, 8U}) {
    for (Eigen::Index j = 0; j < 2; ++j) {
      for (const double share : {-1.1, -0.9, 0.9, 1.1}) {
        Wave wave(Eigen::Vector2d(1.0, 1.0), 0.5, true);
        wave.limits = wide(1e3);
        Wave turning = wave, elsewhere = wave;
        wave.motion.velocities[knot][j] = share * 1e-6;
        EXPECT_EQ(wave.fault().empty(), std::abs(share) < 1.0) << knot << ' ' << share << wave.fault();
        turning.motion.accelerations[knot][j] = share * 1e-4;
        EXPECT_EQ(turning.fault().find("it does not rest") == std::string::npos, std::abs(share) < 1.0)
            << knot << ' ' << share << turning.fault();
        elsewhere.stops[knot / 4][j] += share * 1e-6;
        EXPECT_EQ(elsewhere.fault().empty(), std::abs(share) < 1.0) << knot << ' ' << elsewhere.fault();
        if (std::abs(share) < 1.0) continue;
        const std::string at = "at knot " + std::to_string(knot);
        EXPECT_NE(wave.fault().find(at + " it does not rest"), std::string::npos) << wave.fault();
        EXPECT_NE(elsewhere.fault().find(at + " it is not where"), std::string::npos) << elsewhere.fault();
      }
    }
  }
}

/// Ten knots of rest are enough for a load that takes a second at periods of 0.1 s, 20 for two, and no fewer.
TEST(MotionRates, RestsForEachLoadThatIsTakenOrLeft) {
  const Eigen::Vector2d jerk(1.0, -2.0);
  for (const std::size_t loads : {1U, 2U}) {
    for (const double grip_time : {0.95, 1.0}) {
      for (const std::size_t standing : {10 * loads - 1, 10 * loads, 10 * loads + 1}) {
        Wave wave(jerk, 0.1, true, standing);
        wave.grip_time = grip_time;
        const bool is_enough = standing >= 10 * loads;
        const std::string fault = wave.fault({loads});
        EXPECT_EQ(fault.find("after leg 1 it does not rest for ") == std::string::npos, is_enough) << fault;
        // What stands longer has to say when it goes on.
        EXPECT_EQ(fault.empty(), is_enough) << fault;
        const std::string what = loads == 1 ? " of 1 load that begins" : " of 2 loads that begin";
        EXPECT_EQ(fault.find(what) == std::string::npos, is_enough) << fault;
      }
    }
    for (std::size_t k = 4; k <= 4 + 10 * loads; ++k) {
      for (const double off : {-2e-9, -0.5e-9, 0.5e-9, 2e-9}) {
        Wave wave(jerk, 0.1, true, 10 * loads);
        wave.grip_time = 1.0;
        wave.limits = wide(1e6);
        const Eigen::Vector2d moved = wave.motion.positions[k] + Eigen::Vector2d(0.0, off);
        wave.motion.positions[k] = moved;
        EXPECT_EQ(wave.fault({loads}).empty(), std::abs(off) < 1e-9) << k << wave.fault({loads});
      }
    }
  }
}

/// A leg that goes nowhere ends no sooner than the load before it is taken.
TEST(MotionRates, TheNextLegBeginsWhereTheRestForALoadEnds) {
  Wave wave(Eigen::Vector2d(1.0, -2.0), 0.1, true, 10);
  wave.grip_time = 1.0;
  wave.stops = {wave.stops[0], wave.stops[1], wave.stops[1], wave.stops[2]};
  for (const std::size_t end : {4U, 9U, 13U, 14U}) {
    wave.rests = {4, end, 18};
    EXPECT_EQ(wave.fault({1, 0}), end < 14 ? "motion: its legs do not end one after the other" : "") << end;
    EXPECT_EQ(wave.fault({0, 0}), "") << end;
  }
}

TEST(MotionRates, ItHasALegForEachOfThePathAndNoMoreAfterTheLast) {
  const Wave good(Eigen::Vector2d(1.0, 1.0), 0.5, true);
  EXPECT_EQ(good.fault(), "");
  Wave wave = good;
  wave.rests = {8, 4};
  EXPECT_NE(wave.fault(), "");
  wave = good;
  wave.stops.pop_back();
  EXPECT_EQ(wave.fault(), "motion: it has 2 legs, the path 1");
  wave.stops.clear();
  EXPECT_EQ(wave.fault(), "motion: it has 2 legs, the path 0");
  wave = good;
  wave.rests.pop_back();
  wave.stops.pop_back();
  EXPECT_EQ(wave.fault(), "motion: it goes on after its last leg");
  wave = good;
  wave.rests[1] = 9;
  EXPECT_EQ(wave.fault(), "motion: its legs do not end one after the other");
  for (const double none : {-1e-3, std::nan(""), HUGE_VAL, 43'201.0}) {
    wave = good;
    wave.grip_time = none;
    EXPECT_NE(wave.fault().find("the time in which a load is taken"), std::string::npos) << none;
  }
  wave = good;
  wave.grip_time = 43'200.0;
  EXPECT_EQ(wave.fault(), "");
  wave.stops.clear();  // which is looked at after how long it lasts
  for (const double period : {5400.0, 5400.1}) {
    wave.motion.period = period;
    EXPECT_EQ(wave.fault() == "motion: it lasts more than 43200 s", period > 5400.0) << wave.fault();
  }
}

/// Loads that ride on some legs: how many are taken or left after each, and the knots that this takes.
TEST(MotionRates, CountsTheLoadsThatAreTakenOrLeftAfterEachLeg) {
  std::vector<LegLoad> loads(4);
  loads[0].legs = {1};
  loads[1].legs = {1, 2};
  loads[2].legs = {0};
  using Counts = std::vector<std::size_t>;
  EXPECT_EQ(grips_between(loads, 4), (Counts{3, 1, 1}));  // the last one rides on all of them
  EXPECT_EQ(grips_between(loads, 2), (Counts{3}));
  EXPECT_EQ(grips_between(loads, 1), Counts{});
  EXPECT_EQ(grips_between(loads, 0), Counts{});
  const Wave wave(Eigen::VectorXd::Constant(1, 1.0), 0.1, true, 25);
  const MotionToCheck motion{wave.motion, wave.rests, wave.stops, wave.limits, 0.25};
  const std::vector<KnotRange> knots = knots_of_legs(motion, {2});
  ASSERT_EQ(knots.size(), 2U);
  EXPECT_EQ(knots[0].first, 0U);
  EXPECT_EQ(knots[0].last, 4U + 2 * 3);
  EXPECT_EQ(knots[1].first, 4U);
  EXPECT_EQ(knots[1].last, 33U);
}

/// Each list at its first, a middle and its last knot.
TEST(MotionRates, EachKnotIsOfAFiniteNumberForEachJoint) {
  const Wave good(Eigen::Vector2d(1.0, 1.0), 0.5);
  using Lists = std::vector<Eigen::VectorXd>;
  const auto with = [&](int list, const std::function<void(Lists&)>& change) {
    Wave wave = good;
    change(list == 0   ? wave.motion.positions
           : list == 1 ? wave.motion.velocities
                       : wave.motion.accelerations);
    return wave.fault();
  };
  for (int list = 0; list < 3; ++list) {
    for (const std::size_t knot : {0U, 2U, 4U}) {
      const std::string expected = "motion: knot " + std::to_string(knot) + " is not of 2 finite values";
      for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL})
        EXPECT_EQ(with(list, [&](Lists& values) { values[knot][1] = bad; }), expected) << list;
      for (const Eigen::Index size : {0, 1, 3})
        EXPECT_EQ(with(list, [&](Lists& values) { values[knot] = Eigen::VectorXd::Zero(size); }), expected)
            << list << ' ' << size;
    }
    EXPECT_EQ(with(list, [&](Lists& values) { values.pop_back(); }),
              "motion: it has not as many positions, velocities and accelerations")
        << list;
  }
  Wave none = good;
  none.motion = {0.5, {}, {}, {}};
  EXPECT_EQ(none.fault(), "motion: it has not as many positions, velocities and accelerations");
  for (const double period : {0.0, -0.5, std::nan(""), HUGE_VAL}) {
    Wave wave = good;
    wave.motion.period = period;
    EXPECT_EQ(wave.fault(), "motion: its period is no time") << period;
  }
}

TEST(MotionRates, LimitsAreFiniteNumbersAboveZeroForEachJoint) {
  const Wave good(Eigen::Vector2d(1.0, 1.0), 0.5);
  for (int which = 0; which < 3; ++which) {
    const auto with = [&](const Eigen::VectorXd& values) {
      Wave wave = good;
      (which == 0 ? wave.limits.velocity : which == 1 ? wave.limits.acceleration : wave.limits.jerk) = values;
      return wave;
    };
    EXPECT_TRUE(with(Eigen::Vector2d(9.0, 9.0)).verdict().valid) << which;
    for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL})
      for (const Eigen::Vector2d& values : {Eigen::Vector2d(9.0, bad), Eigen::Vector2d(bad, 9.0)})
        EXPECT_THROW(with(values).verdict(), std::invalid_argument) << which << ' ' << bad;
    for (const Eigen::Index size : {0, 1, 3})
      EXPECT_THROW(with(Eigen::VectorXd::Constant(size, 9.0)).verdict(), std::invalid_argument) << which;
  }
}

/// Knots along a line, one of them aside by so much: how many chords there are, and how wide about them.
TEST(MotionRates, AChordStandsForAsManyCubicsAsAskedWhereTheyAreNearIt) {
  const auto tubes = [](KnotRange range, std::size_t most, double aside = 0.0) {
    Motion motion;
    motion.period = 0.5;
    for (int k = 0; k < 9; ++k) {
      motion.positions.emplace_back(Eigen::Vector2d(0.1 * k, k == 1 ? aside : 0.0));
      motion.velocities.emplace_back(Eigen::Vector2d(0.2, 0.0));
      motion.accelerations.emplace_back(Eigen::Vector2d::Zero());
    }
    return tubes_of(motion, range, most);
  };
  for (const auto& [last, most, chords] :
       {std::tuple(8U, 1U, 8U), std::tuple(8U, 2U, 4U), std::tuple(8U, 3U, 4U), std::tuple(8U, 4U, 2U),
        std::tuple(8U, 7U, 2U), std::tuple(8U, 8U, 1U), std::tuple(8U, 4096U, 1U), std::tuple(7U, 8U, 3U),
        std::tuple(3U, 8U, 2U), std::tuple(1U, 8U, 1U)}) {
    const MotionTubes found = tubes({0, last}, most);
    EXPECT_EQ(found.deviations.size(), chords) << last << ' ' << most;
    ASSERT_EQ(found.chords.size(), chords + 1) << last << ' ' << most;
    EXPECT_NEAR(found.chords.front()[0], 0.0, 1e-12);
    EXPECT_NEAR(found.chords.back()[0], 0.1 * last, 1e-12);
    for (const Eigen::VectorXd& deviation : found.deviations) EXPECT_LT(deviation.maxCoeff(), 1e-12);
  }
  for (const double aside : {-5.1e-4, -4.9e-4, 4.9e-4, 5.1e-4}) {
    const MotionTubes found = tubes({0, 2}, 2, aside);
    ASSERT_EQ(found.deviations.size(), std::abs(aside) < 5e-4 ? 1U : 2U) << aside;
    if (found.deviations.size() > 1) continue;
    EXPECT_NEAR(found.deviations[0][1], std::abs(aside), 2e-9 * std::abs(aside));
  }
  const MotionTubes standing = tubes({3, 3}, 8);
  ASSERT_EQ(standing.chords.size(), 1U);
  EXPECT_NEAR(standing.chords[0][0], 0.3, 1e-12);
  ASSERT_EQ(standing.deviations.size(), 1U);
  EXPECT_EQ(standing.deviations[0], Eigen::VectorXd(Eigen::Vector2d::Zero()));
}

}  // namespace motion_rates_test
}  // namespace clearway
