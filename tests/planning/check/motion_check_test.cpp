#include "planning/check/motion_check.hpp"

#include <gtest/gtest.h>

#include <tuple>

#include "planning/path/smooth_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace motion_check_test {

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// The disc of 0.2 m goes round a corner; each test does something to its motion.
struct Corner {
  Robot robot = load_robot("point");
  std::vector<Configuration> stops{at(0, 0), at(1, 1)};
  ConfigurationSpace space = space_with({box_of(5, 5, -0.05, 5.1, 5.1, 0.05)});
  SmoothMotion made = smooth_motion(space, {{at(0, 0), at(1, 0), at(1, 1)}});
  Motion& motion = made.motion;
  RateLimits limits = rate_limits(robot);

  ConfigurationSpace space_with(const std::vector<Eigen::AlignedBox3d>& occupied) const {
    return ConfigurationSpace(robot, VoxelScene{0.05, occupied, {}, {}}.snapshot(),
                              {.parts = {}, .critical_by_default = false});
  }
  MotionVerdict verdict(const Snapshot& map) const {
    return check_motion(robot, map, space.policies(), 0.0, motion, made.leg_ends, stops, limits);
  }
  std::string fault() const {
    const MotionVerdict found = verdict(space.map());
    EXPECT_EQ(found.valid, found.fault.empty());
    return found.fault;
  }
};

TEST(MotionCheck, AcceptsASmoothMotionAndCountsItsSamples) {
  const Corner corner;
  const MotionVerdict verdict = corner.verdict(corner.space.map());
  EXPECT_TRUE(verdict.valid) << verdict.fault;
  EXPECT_GE(static_cast<double>(verdict.samples), 1000 * corner.motion.duration());
  EXPECT_GT(verdict.shares.velocity, 0.8);
  EXPECT_LE(verdict.shares.acceleration, 1.0 + 1e-6);
}

/// Of two cubics the first ends with the acceleration with which the second would have to begin backwards.
TEST(MotionCheck, AnAccelerationThatJumpsAtAKnotIsRefusedWhicheverSideTheFileSays) {
  Corner corner;
  const double h = corner.motion.period = 0.1, v = 0.1;
  corner.stops = {at(0, 0), at(v * h * 2.0 / 3.0, 0)};
  corner.made.leg_ends = {2};
  for (const double side : {-1.0, 1.0}) {
    corner.motion.positions = {at(0, 0), at(v * h / 3.0, 0), corner.stops[1]};
    corner.motion.velocities = {at(0, 0), at(v, 0), at(0, 0)};
    corner.motion.accelerations = {at(0, 0), at(side * 2.0 * v / h, 0), at(0, 0)};
    for (Eigen::VectorXd* limit : {&corner.limits.velocity, &corner.limits.acceleration, &corner.limits.jerk})
      limit->setConstant(1e4);
    EXPECT_NE(corner.fault().find("give of joint x is "), std::string::npos) << corner.fault();
  }
}

/// It swings to 0.15 m and back, at the top half way between two samples, which are 0.04 mm lower.
TEST(MotionCheck, LimitsOfJointsBindBetweenSamples) {
  Corner corner;
  constexpr int last = 101;
  constexpr double top = 0.15, seconds = 0.001 * last;
  corner.motion = {0.001, {}, {}, {}};
  for (int k = 0; k <= last; ++k) {
    const double s = static_cast<double>(k) / last, u = s * (1.0 - s), turn = 1.0 - 2.0 * s;
    corner.motion.positions.push_back(at(64.0 * top * u * u * u, 0.0));
    corner.motion.velocities.push_back(at(192.0 * top * u * u * turn / seconds, 0.0));
    corner.motion.accelerations.push_back(at(384.0 * top * u * (turn * turn - u) / (seconds * seconds), 0.0));
  }
  corner.made.leg_ends = {last};
  corner.stops = {at(0, 0), at(0, 0)};
  for (Eigen::VectorXd* limit : {&corner.limits.velocity, &corner.limits.acceleration, &corner.limits.jerk})
    limit->setConstant(1e7);
  corner.robot.source.clear();
  for (const double above : {5e-5, -2e-5}) {
    corner.robot.joints[0].upper = top + above;
    EXPECT_EQ(corner.fault().find("position of joint x is ") != std::string::npos, above < 0.0)
        << corner.fault();
  }
}

/// Every place of every cubic is within the tube about its chord: by evaluating the cubics.
TEST(MotionCheck, TubesHoldTheCubics) {
  Random random(3);
  for (int i = 0; i < 60; ++i) {
    Motion motion;
    motion.period = random.between(0.01, 0.5);
    const std::size_t knots = 2 + static_cast<std::size_t>(i % 4) * 3;
    for (std::size_t k = 0; k < knots; ++k) {
      motion.positions.emplace_back(random.point(0.05));
      motion.velocities.emplace_back(random.point(i % 3 == 0 ? 0.001 : 1.0));
      motion.accelerations.emplace_back(Eigen::Vector3d::Zero());
      if (i % 2 == 0 && k % 2 == static_cast<std::size_t>(i / 2 % 2)) motion.velocities.back().setZero();
    }
    for (const std::size_t most : {std::size_t{1}, std::size_t{8}}) {
      const MotionTubes tubes = tubes_of(motion, {0, knots - 1}, most);
      ASSERT_EQ(tubes.chords.size(), tubes.deviations.size() + 1);
      std::size_t tube = 0, begin = 0;
      for (std::size_t k = 0; k + 1 < knots; ++k) {
        for (double s = 0.0; s <= 1.0; s += 0.05) {
          // Hermite's cubic as a polynomial.
          const Eigen::VectorXd &p = motion.positions[k], &end = motion.positions[k + 1];
          const Eigen::VectorXd v = motion.period * motion.velocities[k],
                                w = motion.period * motion.velocities[k + 1];
          const Eigen::VectorXd place =
              p + s * v + s * s * (3.0 * (end - p) - 2.0 * v - w) + s * s * s * (2.0 * (p - end) + v + w);
          const Eigen::VectorXd chord = tubes.chords[tube + 1] - tubes.chords[tube];
          bool is_held = false;  // by the tube about some place of the chord
          for (double t = 0.0; t <= 1.0 && !is_held; t += 0.001)
            is_held = ((place - tubes.chords[tube] - t * chord).cwiseAbs().array() <=
                       tubes.deviations[tube].array() + 0.001 * chord.cwiseAbs().array() + 1e-12)
                          .all();
          EXPECT_TRUE(is_held) << i << " " << most << " " << k << " " << s;
        }
        if (motion.positions[k + 1] == tubes.chords[tube + 1]) ++tube, begin = k + 1;
      }
      EXPECT_EQ(begin, knots - 1);
    }
  }
}

TEST(MotionCheck, RefusesAMotionThatIsTooFast) {
  Corner corner;
  for (auto* limit : {&corner.limits.velocity, &corner.limits.acceleration, &corner.limits.jerk}) {
    const Eigen::VectorXd kept = *limit;
    *limit *= 0.6;
    EXPECT_NE(corner.fault().find("its limit"), std::string::npos) << corner.fault();
    *limit = kept;
  }
  EXPECT_EQ(corner.fault(), "");
  corner.motion.period *= 0.97;
  EXPECT_NE(corner.fault(), "");
}

TEST(MotionCheck, RefusesAKnotThatIsElsewhere) {
  for (const double off : {1e-4, 1e-2}) {
    Corner corner;
    corner.motion.positions[corner.motion.positions.size() / 2][1] += off;
    EXPECT_NE(corner.fault(), "") << off;
  }
}

TEST(MotionCheck, RefusesAccelerationsThatAreNotThoseOfTheCubics) {
  Corner corner;
  corner.motion.accelerations[20][0] += 0.01;
  EXPECT_NE(corner.fault().find(", but the motion says "), std::string::npos) << corner.fault();
}

TEST(MotionCheck, RefusesAMotionOfManyHours) {
  Corner corner;
  corner.motion.period = 1e4;
  EXPECT_EQ(corner.fault(), "motion: it lasts more than 43200 s");
}

TEST(MotionCheck, RefusesOtherEndsAndMissingRests) {
  Corner corner;
  corner.stops[1][0] += 1e-3;
  EXPECT_NE(corner.fault().find("not where"), std::string::npos);
  corner.stops[1] = at(1, 1);
  corner.made.leg_ends = {corner.motion.positions.size() - 2};
  EXPECT_NE(corner.fault(), "");
  corner.made.leg_ends = {corner.motion.positions.size()};
  EXPECT_NE(corner.fault(), "");
  corner.made.leg_ends = {};
  EXPECT_NE(corner.fault(), "");
}

TEST(MotionCheck, RefusesValuesThatAreNoNumbersAndSizesThatDoNotAgree) {
  for (int which = 0; which < 4; ++which) {
    Corner corner;
    if (which == 0) corner.motion.positions[5][0] = std::nan("");
    if (which == 1) corner.motion.velocities[5][1] = HUGE_VAL;
    if (which == 2) corner.motion.velocities.pop_back();
    if (which == 3) corner.motion.period = std::nan("");
    EXPECT_NE(corner.fault(), "") << which;
  }
}

/// Legs on which the same loads ride, here none, are proved to the last of them.
TEST(MotionCheck, EachLegOfSeveralIsProved) {
  const Corner corner;
  const std::vector<Configuration> stops{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
  const SmoothMotion made =
      smooth_motion(corner.space, {{stops[0], stops[1]}, {stops[1], stops[2]}, {stops[2], stops[3]}});
  const auto is_valid = [&](double x, double y) {
    const auto post = box_of(x - 0.04, y - 0.04, -0.05, x + 0.04, y + 0.04, 0.05);
    return check_motion(corner.robot, corner.space_with({post}).map(), corner.space.policies(), 0.0,
                        made.motion, made.leg_ends, stops, corner.limits)
        .valid;
  };
  EXPECT_TRUE(is_valid(0.5, 0.5));
  EXPECT_FALSE(is_valid(0.5, 0.1));
  EXPECT_FALSE(is_valid(0.9, 0.5));
  EXPECT_FALSE(is_valid(0.5, 0.9));
}

TEST(MotionCheck, RefusesAnObstacleInsideTheBlendAndOneInsideTheEdgesIsNoMatter) {
  const Corner corner;
  // The blend cuts the corner at (1, 0): the disc no longer covers what lies beyond it.
  const Configuration middle = corner.motion.at(corner.motion.duration() / 2).position;
  const auto post = [](double x, double y) {
    return box_of(x - 0.03, y - 0.03, -0.05, x + 0.03, y + 0.03, 0.05);
  };
  const auto in_way = corner.space_with({post(middle[0] - 0.15, middle[1] + 0.15)});
  EXPECT_FALSE(corner.verdict(in_way.map()).valid);
  const auto far = corner.space_with({post(middle[0] - 0.5, middle[1] + 0.5)});
  EXPECT_TRUE(corner.verdict(far.map()).valid);
}

/// Along a voxel's face at a distance that no step resolves: neither free nor blocked.
TEST(MotionCheck, SaysWhetherItIsUndecided) {
  const Corner corner;
  const Snapshot map = VoxelScene{0.05, {box_of(1.01, 1.01, -0.04, 1.04, 1.04, 0.04)}, {}, {}}.snapshot();
  for (const auto& [x, is_valid, is_undecided] :
       {std::tuple(0.7, true, false), {0.8 - 1e-9, false, true}, {0.9, false, false}}) {
    const std::vector<Configuration> stops{at(x, 0.5), at(x, 1.04)};
    const SmoothMotion made = smooth_motion(corner.space, {stops});
    const MotionVerdict verdict = check_motion(corner.robot, map, corner.space.policies(), 0.0, made.motion,
                                               made.leg_ends, stops, corner.limits);
    EXPECT_EQ(verdict.valid, is_valid) << x << verdict.fault;
    EXPECT_EQ(verdict.undecided, is_undecided) << x << verdict.fault;
    if (!verdict.valid) {
      EXPECT_EQ(verdict.min_clearance, 0.0);
    }
  }
}

/// A row of voxels along the first edge is 0.1 m from the disc, one along the second 0.15 m.
TEST(MotionCheck, TellsHowNearTheMotionComesToVoxels) {
  const Corner corner;
  const Eigen::AlignedBox3d below = box_of(0.2, -0.4, -0.05, 0.6, -0.3, 0.05),
                            beside = box_of(1.35, 0.5, -0.05, 1.45, 0.8, 0.05);
  const auto clearance = [&](const std::vector<Eigen::AlignedBox3d>& occupied) {
    const MotionVerdict verdict = corner.verdict(corner.space_with(occupied).map());
    EXPECT_TRUE(verdict.valid) << verdict.fault;
    return verdict.min_clearance;
  };
  for (const auto& [occupied, truth] :
       {std::pair{std::vector{below}, 0.1}, {std::vector{beside}, 0.15}, {std::vector{beside, below}, 0.1}}) {
    EXPECT_LE(clearance(occupied), truth + 1e-9);
    EXPECT_GE(clearance(occupied), 0.75 * truth);
  }
}

}  // namespace motion_check_test
}  // namespace clearway
