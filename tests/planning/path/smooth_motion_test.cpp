#include "planning/path/smooth_motion.hpp"

#include <gtest/gtest.h>

#include "mapping/system/thread_time.hpp"
#include "planning/check/motion_check.hpp"
#include "planning/check/motion_torques.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace smooth_motion_test {

using Eigen::Vector2d;
using Path = std::vector<Configuration>;

Configuration at(double x, double y) { return Vector2d(x, y); }

ConfigurationSpace space_of(const Robot& robot, const std::vector<Eigen::AlignedBox3d>& occupied,
                            double padding = 0.0) {
  return ConfigurationSpace(robot, VoxelScene{0.05, occupied, {}, {}}.snapshot(),
                            {.parts = {}, .critical_by_default = false}, {.padding = padding});
}

/// Every configuration a millisecond apart is free, and no limit is exceeded by differences of positions.
void expect_sound(const ConfigurationSpace& space, const SmoothMotion& made, const RateLimits& limits) {
  constexpr double h = 1e-3;
  const Motion& motion = made.motion;
  const auto position = [&](double t) { return motion.at(t).position; };
  for (double t = 0.0; t <= motion.duration() + 4 * h; t += h) {
    ASSERT_TRUE(space.is_free(position(t))) << t;
    const Eigen::VectorXd velocity = (position(t) - position(t - h)) / h;
    const Eigen::VectorXd acceleration = (position(t) - 2 * position(t - h) + position(t - 2 * h)) / (h * h);
    ASSERT_LE(velocity.cwiseAbs().cwiseQuotient(limits.velocity).maxCoeff(), 1 + 1e-6) << t;
    ASSERT_LE(acceleration.cwiseAbs().cwiseQuotient(limits.acceleration).maxCoeff(), 1 + 1e-6) << t;
    if (t < 2 * h || t > motion.duration()) continue;  // at() clamps times before the motion
    const Eigen::VectorXd jerk =
        (position(t + h) - 3 * position(t) + 3 * position(t - h) - position(t - 2 * h)) / (h * h * h);
    ASSERT_LE(jerk.cwiseAbs().cwiseQuotient(limits.jerk).maxCoeff(), 1 + 1e-3) << t;
  }
}

TEST(SmoothMotion, OfOneEdgeIsNearlyTheLeastTimeUnderVelocityAccelerationAndJerk) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const RateLimits limits = rate_limits(robot);
  for (const double length : {0.002, 0.02, 0.1, 0.5, 2.0}) {
    const SmoothMotion made = smooth_motion(space, {{at(0, 0), at(length, 0)}});
    expect_sound(space, made, limits);
    const double v = limits.velocity[0], a = limits.acceleration[0], j = limits.jerk[0];
    // The double-S profile from rest to rest (Biagiotti and Melchiorri 2008, section 3.4).
    double least = 0.0;
    if (length >= 2 * a * a * a / (j * j)) {
      const double reached =
          std::min(v, 0.5 * (-a * a / j + std::sqrt(std::pow(a * a / j, 2) + 4 * a * length)));
      least = length / reached + reached / a + a / j;
    } else {
      least = 4 * std::cbrt(length / (2 * j));
    }
    EXPECT_GE(made.motion.duration(), least - 1e-9) << length;
    EXPECT_LE(made.motion.duration(), 1.25 * least + 0.06) << length;
  }
}

TEST(SmoothMotion, WithAlmostNoJerkTakesItsTime) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const SmoothMotion made = smooth_motion(space, {{at(0, 0), at(1, 0)}}, {.scales = {.jerk = 1e-5}});
  const double least = 4 * std::cbrt(1.0 / (2 * 1e-5 * rate_limits(robot).jerk[0]));
  EXPECT_GE(made.motion.duration(), least - 1e-9);
  EXPECT_LE(made.motion.duration(), 1.35 * least);
}

TEST(SmoothMotion, BlendsACornerInTheOpenAndIsFasterThanStoppingThere) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const Path path{at(0, 0), at(1, 0), at(1, 1)};
  const SmoothMotion made = smooth_motion(space, {path});
  expect_sound(space, made, rate_limits(robot));
  EXPECT_EQ(made.blended, 1U);
  EXPECT_EQ(made.stops, 0U);
  EXPECT_EQ(made.motion.positions.front(), path.front());
  EXPECT_EQ(made.motion.positions.back(), path.back());
  const SmoothMotion stopping = smooth_motion(space, {path}, {.reach = 0.0});
  expect_sound(space, stopping, rate_limits(robot));
  EXPECT_EQ(stopping.stops, 1U);
  EXPECT_LT(made.motion.duration(), 0.8 * stopping.motion.duration());
}

TEST(SmoothMotion, KeepsNearACornerThatIsTightAndStopsWhereNoBlendIsProved) {
  const Robot robot = load_robot("point");  // a disc of 0.2 m
  const Path path{at(0, 0), at(1, 0), at(1, 1)};
  // Posts at the inner side of the corner, ever nearer: the disc's edge passes 0.2 m from its path.
  double before = 0.0;
  std::size_t stops = 0;
  for (const double gap : {0.35, 0.2, 0.1, 0.05, 0.0}) {
    const double wall = 1.0 - 0.2 - 0.05 - gap;
    const ConfigurationSpace space =
        space_of(robot, {box_of(wall - 0.3, 0.25 + gap, -0.05, wall + 0.05, 1.2, 0.05)}, 0.0);
    if (!space.is_edge_free(path[0], path[1]) || !space.is_edge_free(path[1], path[2])) continue;
    const SmoothMotion made = smooth_motion(space, {path});
    expect_sound(space, made, rate_limits(robot));
    EXPECT_GE(made.motion.duration(), before - 0.05) << gap;
    before = made.motion.duration();
    stops += made.stops;
    const MotionVerdict verdict =
        check_motion(robot, space.map(), space.policies(), 0.0, made.motion, made.leg_ends,
                     {path.front(), path.back()}, rate_limits(robot));
    EXPECT_TRUE(verdict.valid) << gap << ": " << verdict.fault;
  }
  EXPECT_GT(before, 0.0);
}

TEST(SmoothMotion, OfRandomPathsAmongObstaclesIsSoundAndTheIndependentCheckAgrees) {
  for (const char* name : {"arm6", "panda", "arm5", "planar2"}) {
    const Robot robot = load_robot(name);
    Random random(7);
    FreeSpaceMap builder({.resolution = 0.05});
    for (int i = 0; i < 20;) {
      const Eigen::Vector3d at_tip = tip_pose(robot, random.configuration(robot)).translation();
      if (at_tip.head<2>().norm() < 0.4) continue;  // where the base stands
      occupy(builder, ((at_tip / 0.05).array().floor() + 0.5) * 0.05);
      ++i;
    }
    const ConfigurationSpace space(robot, builder.snapshot(), {.critical_by_default = false});
    for (int trial = 0; trial < 4; ++trial) {
      Path path;
      while (path.size() < 7) {
        Configuration next = random.configuration(robot);
        if (!path.empty()) next = path.back() + 0.15 * (next - path.back());
        if (path.empty() ? space.is_free(next) : space.is_edge_free(path.back(), next)) path.push_back(next);
      }
      const std::vector<Path> legs{{path.begin(), path.begin() + 4}, {path.begin() + 3, path.end()}};
      const SmoothMotionOptions options{.scales = {.speed = trial == 1 ? 0.3 : 1.0}};
      const SmoothMotion made = smooth_motion(space, legs, options);
      const RateLimits limits = rate_limits(robot, options.scales);
      expect_sound(space, made, limits);
      ASSERT_EQ(made.leg_ends.size(), 2U);
      EXPECT_EQ(made.motion.positions[made.leg_ends[0]], path[3]);
      EXPECT_EQ(made.motion.velocities[made.leg_ends[0]], Eigen::VectorXd::Zero(path[3].size()));
      const MotionVerdict verdict = check_motion(robot, space.map(), space.policies(), 0.0, made.motion,
                                                 made.leg_ends, {path[0], path[3], path.back()}, limits);
      EXPECT_TRUE(verdict.valid) << name << ": " << verdict.fault;
      EXPECT_LE(verdict.shares.jerk, 1 + 1e-6);
      const SmoothMotion again = smooth_motion(space, legs, options);
      EXPECT_EQ(again.motion.positions, made.motion.positions);
    }
  }
}

TEST(SmoothMotion, StraightensAStaircaseOnlyWhereTheEdgeIsCertified) {
  const Robot robot = load_robot("point");
  Path stairs;
  for (int i = 0; i <= 40; ++i) stairs.push_back(at(0.025 * ((i + 1) / 2), 0.025 * (i / 2)));
  const ConfigurationSpace open = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const SmoothMotion made = smooth_motion(open, {stairs});
  EXPECT_GT(made.straightened, 30U);
  EXPECT_LT(made.motion.duration(), 1.3);  // 0.5 m at 1 m/s and 5 m/s^2 in each joint takes 0.7 s
  EXPECT_EQ(smooth_motion(open, {stairs}, {.straighten = 0.0}).straightened, 0U);
}

TEST(SmoothMotion, TorquesStayWithinTheirLimitsByKdlToo) {
  const Robot robot = load_robot("panda");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  Configuration from(7), to(7);
  from << 0, -0.5, 0, -2.0, 0, 1.6, 0;
  to << 1.2, 0.2, 0.3, -1.2, 0.4, 2.2, 0.5;
  ASSERT_TRUE(space.is_edge_free(from, to));
  const SmoothMotion free = smooth_motion(space, {{from, to}});
  TorqueTerms terms = torque_terms(robot);
  const TorqueFinding all = greatest_torques(robot, free.motion, terms);
  ASSERT_GT(all.share, 0.05);
  EXPECT_LT(all.share, 1.0);
  // Limits that gravity leaves little of: the arm has to go slower.
  Eigen::VectorXd held = Eigen::VectorXd::Zero(7);
  const Eigen::VectorXd rest = held;
  for (const Configuration& q : free.motion.positions)
    held = held.cwiseMax(joint_torques(robot, q, rest, rest, terms).cwiseAbs());
  terms.limits = held * 1.1 + Eigen::VectorXd::Constant(7, 0.3);
  ASSERT_GT(greatest_torques(robot, free.motion, terms).share, 1.0);
  const SmoothMotion kept =
      smooth_motion(space, {{from, to}}, {.torques = std::make_shared<const TorqueTerms>(terms)});
  EXPECT_LE(greatest_torques(robot, kept.motion, terms).share, 1.0 + 1e-9);
  EXPECT_GT(kept.motion.duration(), free.motion.duration());
  // A joint that cannot even hold the arm is named, and refused by its limit.
  terms.limits[1] = 0.9 * held[1];
  const SmoothMotion weak =
      smooth_motion(space, {{from, to}}, {.torques = std::make_shared<const TorqueTerms>(terms)});
  const TorqueFinding found = greatest_torques(robot, weak.motion, terms);
  EXPECT_EQ(found.overloaded, std::vector<std::string>{robot.joints[1].name});
  EXPECT_GT(found.share, 1.0);
  EXPECT_EQ(found.joint, 1);
  const auto sentence = [&](double share) {
    terms.limits.setConstant(1e6);
    terms.limits[1] = held[1] / share;
    return torque_fault(robot, weak.motion.period, terms, greatest_torques(robot, free.motion, terms));
  };
  EXPECT_NE(sentence(1.1).find("gravity alone takes more than all of it: no slower"), std::string::npos);
  EXPECT_NE(sentence(0.995).find("gravity alone takes 99.5 % at its worst: motions are not slowed"),
            std::string::npos)
      << sentence(0.995);
  EXPECT_EQ(sentence(0.97).find("gravity"), std::string::npos) << sentence(0.97);
}

TEST(SmoothMotion, LoadsThatTheArmCannotHoldAndTorquesThatAreNoNumbersAreRefused) {
  const Robot robot = load_robot("panda");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  Configuration from(7), to(7);
  from << 0, -0.5, 0, -2.0, 0, 1.6, 0;
  to << 1.2, 0.2, 0.3, -1.2, 0.4, 2.2, 0.5;
  for (const double payload : {1.0, 50.0, 500.0, 1e308}) {
    const auto terms = std::make_shared<const TorqueTerms>(torque_terms(robot, {.payload = payload}));
    const SmoothMotion made = smooth_motion(space, {{from, to}}, {.torques = terms});
    const TorqueFinding found = greatest_torques(robot, made.motion, *terms);
    EXPECT_EQ(torque_fault(robot, made.motion.period, *terms, found).empty(), payload == 1.0) << payload;
    EXPECT_EQ(found.overloaded.empty(), payload == 1.0) << payload;
  }
}

/// One cubic of 4 s that leaves the upright arm and comes back: torques are small at both knots.
TEST(SmoothMotion, TorquesAreJudgedBetweenKnotsThatAreFarApart) {
  const Robot robot = load_robot("panda");
  Configuration upright(7), aside(7);
  upright << 0, 0, 0, -0.1, 0, 1.6, 0;
  aside = upright;
  aside[1] = 1.5;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(7), leaves = 1.5 * Eigen::VectorXd::Unit(7, 1);
  Motion motion{4.0, {upright, upright}, {leaves, -leaves}, {}};
  motion.accelerations = hermite_accelerations(motion);
  ASSERT_TRUE(motion.at(2.0).position.isApprox(aside, 1e-12));
  TorqueTerms terms = torque_terms(robot);
  const double held = std::abs(joint_torques(robot, aside, rest, rest, terms)[1]);
  terms.limits = Eigen::VectorXd::Constant(7, 1e6);
  terms.limits[1] = 0.9 * held;
  const auto share = [&](std::size_t k) {
    return std::abs(kdl_torques(robot, motion.positions[k], motion.velocities[k], motion.accelerations[k],
                                terms)[1]) /
           terms.limits[1];
  };
  ASSERT_LT(std::max(share(0), share(1)), 0.9);
  const TorqueFinding found = greatest_torques(robot, motion, terms);
  EXPECT_GT(found.share, 1.1);
  EXPECT_NEAR(found.place, 0.5, 0.25);
  EXPECT_EQ(found.overloaded, std::vector<std::string>{robot.joints[1].name});
  EXPECT_NE(torque_fault(robot, motion.period, terms, found), "");
}

TEST(SmoothMotion, EdgesTooShortForTheirSquaresAreNone) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  EXPECT_EQ(smooth_motion(space, {{at(0, 0), at(1e-170, 0)}}).motion.positions.size(), 1U);
  for (const double e : {1e-170, 1e-162, 2e-162, 1e-161, 1e-155, 1e-120, 1e-60, 1e-17, 1e-12, 1e-9, 1e-6}) {
    for (const Path& path : {Path{at(0, 0), at(e, 0)}, Path{at(0, 0), at(e, 0), at(e, e)},
                             Path{at(0, 0), at(1, 0), at(1, e)}, Path{at(e, 0), at(0, 0), at(0, 1)}}) {
      const Motion motion = smooth_motion(space, {path}, {.straighten = 0.0}).motion;
      for (std::size_t k = 0; k < motion.positions.size(); ++k)
        ASSERT_TRUE(motion.positions[k].allFinite() && motion.accelerations[k].allFinite()) << e;
      EXPECT_LT((motion.positions.back() - path.back()).norm(), 1e-12) << e;
    }
  }
}

TEST(SmoothMotion, APathThatGoesNowhereRests) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const SmoothMotion made = smooth_motion(space, {{at(1, 1)}, {at(1, 1), at(1, 1)}});
  EXPECT_EQ(made.motion.positions.size(), 1U);
  EXPECT_EQ(made.leg_ends, (std::vector<std::size_t>{0, 0}));
}

TEST(SmoothMotion, RefusesWhatIsNoPath) {
  const Robot robot = load_robot("point");
  const ConfigurationSpace space = space_of(robot, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  const Configuration bad = at(std::nan(""), 0.0), three = Eigen::Vector3d(0, 0, 0);
  const std::vector<std::vector<Path>> refused{{},
                                               {{}},
                                               {{at(0, 0), at(1e300, 0)}},
                                               {{at(0, 0), at(9e5, 0)}},
                                               {{at(0, 0), at(0, -1e7)}},
                                               {{at(0, 0), bad}},
                                               {{three}},
                                               {{at(0, 0), at(1, 0)}, {at(0, 0), at(1, 0)}}};
  for (const auto& legs : refused) EXPECT_THROW(smooth_motion(space, legs), std::invalid_argument);
  const std::vector<Path> path{{at(0, 0), at(1, 0)}};
  EXPECT_THROW(smooth_motion(space, path, {.period = 0.0}), std::invalid_argument);
  EXPECT_THROW(smooth_motion(space, path, {.reach = 0.6}), std::invalid_argument);
  EXPECT_THROW(smooth_motion(space, path, {.scales = {.speed = 2.0}}), std::invalid_argument);
  EXPECT_THROW(smooth_motion(space, path, {.scales = {.speed = 1e-6}}), std::invalid_argument);
  for (const double jerk : {1e-6, 1e-7, 1e-20, 1e-200, 1e-308}) {
    const double begin = thread_cpu_seconds();
    EXPECT_THROW(smooth_motion(space, path, {.scales = {.jerk = jerk}}), std::invalid_argument) << jerk;
    EXPECT_LT(thread_cpu_seconds() - begin, 0.1) << jerk;
  }
}

/// The least scale that the sentence names is one that works; limits of the robot's own name their joint.
TEST(SmoothMotion, OfTooLittleJerkNamesWhatIsEnough) {
  Robot robot = load_robot("point");
  const std::vector<Eigen::AlignedBox3d> far{box_of(5, 5, -0.05, 5.1, 5.1, 0.05)};
  const std::vector<Path> path{{at(0, 0), at(1, 0)}};
  const auto refusal = [&](double jerk) -> std::string {
    try {
      smooth_motion(space_of(robot, far), path, {.scales = {.jerk = jerk}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::string said = refusal(1e-6);
  const std::string words =
      "motion: with the jerk scale 1e-06 a leg takes more than 62.1 s, expected at least ";
  ASSERT_EQ(said.substr(0, words.size()), words);
  EXPECT_EQ(refusal(std::stod(said.substr(words.size()))), "") << said;
  for (Joint& joint : robot.joints) joint.max_jerk = 1e-5;
  EXPECT_EQ(
      refusal(1.0),
      "motion: the jerk limit of joint 'x', 1e-05, is so low that a leg takes more than 134 s, expected "
      "60 s at most");
}

}  // namespace smooth_motion_test
}  // namespace clearway
