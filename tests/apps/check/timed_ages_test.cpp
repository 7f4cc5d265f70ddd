// Of a trajectory with times also what lies before its first point and beside its curve is asked when it was
// seen; and where the robot is before counts by whole turns.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "apps/check/timed_trajectory.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/map_of_looks.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace timed_ages_test {

constexpr double middle = worlds::looked_at_edge / 2, too_short = 12.0, long_enough = 13.0;  // s, of ages

Configuration at(double x) { return Eigen::Vector2d(x, middle); }

/// The disc where all was seen at 2.5 s, and what lies on the right once more at 15 s: right of `border` it
/// stands in what was seen lately alone, by check_path.
class TimedAges : public ::testing::Test {
 protected:
  TimedAges() {
    double old = 0.0, fresh = 0.4;
    while (fresh - old > 1e-4) {
      const double x = (old + fresh) / 2;
      (check_path(disc_, map_, policies_, 0.0, {at(x)}, 0.0, too_short).valid ? fresh : old) = x;
    }
    border_ = fresh;
  }
  bool is_valid(const TimedTrajectory& trajectory, double age) const {
    return check_timed(trajectory, disc_, map_, policies_, 0.0, age).is_valid();
  }

  const Robot disc_ = load_robot("point");
  const std::map<std::string, Policy> policies_{{"base", Policy::known_free}};
  const Snapshot map_ = worlds::map_of_looks({{Eigen::Vector3d(middle, middle, middle), 2.5},
                                              {Eigen::Vector3d(0.4 + middle, middle, middle), 15.0}});
  double border_ = 0.0;
};

TEST_F(TimedAges, OfTheWayToTheFirstPoint) {
  ASSERT_GT(border_, 0.01);
  ASSERT_LT(border_, 0.35);
  TimedTrajectory trajectory;
  trajectory.points = {{0.0, at(border_ + 0.001)}, {1.0, at(border_ + 0.05)}};
  EXPECT_TRUE(is_valid(trajectory, too_short));
  trajectory.before = at(border_ + 0.005);
  EXPECT_TRUE(is_valid(trajectory, too_short));
  trajectory.before = at(border_ - 0.005);
  EXPECT_TRUE(is_valid(trajectory, long_enough));
  EXPECT_FALSE(is_valid(trajectory, too_short));
}

/// From rest to v in 6 s, at the same place: the cubic swings back by 8 v / 9, the quintic that ends with an
/// acceleration by less.
TEST_F(TimedAges, OfEachCurveThatAControllerMayTake) {
  constexpr double speed = 0.09, time = 6.0, change = 4.0 / 3.0 * speed;
  double quintic = 0.0;
  for (double s = 0.0; s <= 1.0; s += 1e-4) {
    const double back = s * s * s * (4.0 - 7.0 * s + 3.0 * s * s),
                 forth = s * s * s * (0.5 - s + 0.5 * s * s);
    quintic = std::max(quintic, time * speed * back - time * time * change * forth);
  }
  const double cubic = 8.0 / 9.0 * speed;
  ASSERT_LT(quintic, cubic - 0.01);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(2), forth = Eigen::Vector2d(speed, 0.0),
                        faster = Eigen::Vector2d(change, 0.0);
  for (const double beyond : {quintic - 0.005, (quintic + cubic) / 2, cubic + 0.005}) {
    const Configuration place = at(border_ + beyond);
    TimedTrajectory trajectory;
    trajectory.points = {{0.0, place, rest, rest}, {time, place, forth, faster}};
    const bool is_fresh = beyond > quintic;
    EXPECT_EQ(is_valid(trajectory, too_short), is_fresh) << beyond;
    trajectory.has_start = true;  // of which the controller may know less
    EXPECT_EQ(is_valid(trajectory, too_short), beyond > cubic) << beyond;
    EXPECT_TRUE(is_valid(trajectory, long_enough)) << beyond;
  }
}

bool is_fault_free(const TimedTrajectory& trajectory, double acceleration) {
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_acceleration = acceleration;
  return check_timed(trajectory, robot, Snapshot(), {{"base", Policy::not_occupied}}, 0.0, 0.0).fault.empty();
}

/// From rest to rest the quintic asks for 5.77 of way / time^2, the cubic of who knows no acceleration for 6.
TEST(TimedStart, LimitsBindOnEachCurveFromItTheLongWayToo) {
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(2);
  for (const double way : {0.1, 0.4}) {
    TimedTrajectory trajectory;
    trajectory.points = {{0.0, at(0.0), rest, rest}, {1.0, at(0.1), rest, rest}};
    EXPECT_TRUE(is_fault_free(trajectory, 0.59));
    trajectory.has_start = true;
    if (way > 0.1) trajectory.stated_start = at(0.1 + way);
    EXPECT_FALSE(is_fault_free(trajectory, 5.9 * way)) << way;
    EXPECT_TRUE(is_fault_free(trajectory, 6.1 * way)) << way;
  }
}

/// Beside the straight way, 0.14 m from it, is a post that the disc of 0.2 m passes on both curves.
TEST(TimedStart, IsLeftStraightWhereTheControllerKnowsNoVelocity) {
  const Snapshot map =
      VoxelScene{0.05, {box_of(0.101, 0.351, 0.001, 0.149, 0.399, 0.049)}, {}, {}}.snapshot();
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(2);
  TimedTrajectory trajectory;
  trajectory.points = {
      {0.0, rest, rest, rest},
      {2.0, Eigen::Vector2d(0.4, 0.4), Eigen::Vector2d(0.0, 0.9), Eigen::Vector2d(-0.6, 1.2)}};
  const auto check = [&] {
    return check_timed(trajectory, load_robot("point"), map, {{"base", Policy::not_occupied}}, 0.0, 0.0).path;
  };
  EXPECT_TRUE(check().valid) << check().first_contact;
  trajectory.has_start = true;
  EXPECT_NE(check().first_contact.find("base touches a voxel"), std::string::npos) << check().first_contact;
}

TEST(TimedStart, IsTheSameAfterWholeTurnsOfAJointWithoutLimits) {
  Robot robot = load_robot("planar2");
  const ForeignTrajectory foreign{.joints = {robot.joints[0].name, robot.joints[1].name},
                                  .points = {{0.1, 0.2}, {0.3, 0.4}},
                                  .start = {{robot.joints[0].name, 0.1 - 4.0 * std::numbers::pi}},
                                  .times = {0.0, 1.0},
                                  .velocities = {{}, {}},
                                  .accelerations = {{}, {}}};
  EXPECT_NE(timed_trajectory(foreign, robot, "t.json")->fault, "");
  robot.joints[0].lower = -HUGE_VAL, robot.joints[0].upper = HUGE_VAL;
  const auto timed = timed_trajectory(foreign, robot, "t.json");
  EXPECT_EQ(timed->fault, "");
}

/// Two points of the arm at rest, and of a third joint that is none of its.
ForeignTrajectory beside_another(const Robot& robot, double first_time) {
  return {.joints = {robot.joints[0].name, "door", robot.joints[1].name},
          .points = {{0.1, 0.0, 0.2}, {0.3, 0.0, 0.4}},
          .times = {first_time, first_time + 2.0},
          .velocities = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}},
          .accelerations = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}}};
}

/// Whatever its rates are at either point, over the longest time between two points or before the first.
TEST(TimedStart, AJointThatStandsStillMaySwingByATenthOfAMillimetre) {
  const Robot robot = load_robot("planar2");
  for (const double first_time : {0.0, 5.0}) {
    const double longest = std::max(2.0, first_time);
    for (const std::size_t point : {0U, 1U}) {
      for (const double sign : {1.0, -1.0}) {
        for (const double swing : {0.95e-4, 1.05e-4}) {
          const auto is_refused = [&](double by_velocity) {
            ForeignTrajectory foreign = beside_another(robot, first_time);
            foreign.velocities[point][1] = sign * by_velocity * swing / (0.4 * longest);
            foreign.accelerations[point][1] = (1.0 - by_velocity) * swing * 20.0 / (longest * longest);
            try {
              timed_trajectory(foreign, robot, "t.json");
            } catch (const std::invalid_argument&) {
              return true;
            }
            return false;
          };
          for (const double by_velocity : {0.0, 0.5, 1.0}) EXPECT_EQ(is_refused(by_velocity), swing > 1e-4);
        }
      }
    }
  }
}

TEST(TimedStart, MayBeAsFarFromTheFirstPointAsMoveItLetsItBeAndTheEndIsAtRest) {
  const Robot robot = load_robot("planar2");
  for (const double sign : {1.0, -1.0}) {
    for (const double away : {0.5e-9, 2e-9, 0.0099, 0.0101}) {
      ForeignTrajectory foreign = beside_another(robot, 0.0);
      foreign.start = {{robot.joints[1].name, 0.2 + sign * away}};
      const auto timed = timed_trajectory(foreign, robot, "t.json");
      EXPECT_EQ(timed->before.size() > 0, away > 1e-9) << away;
      EXPECT_EQ(timed->fault.empty(), away < 0.01) << timed->fault;
      EXPECT_FALSE(timed->has_start);
      foreign = beside_another(robot, 0.5);  // then it has time to go there
      foreign.start = {{robot.joints[1].name, 0.2 + sign * away}};
      const auto later = timed_trajectory(foreign, robot, "t.json");
      EXPECT_TRUE(later->has_start && later->fault.empty()) << later->fault;
      EXPECT_EQ(later->points.size(), 3U);
      EXPECT_EQ(later->points.front().position, Configuration(Eigen::Vector2d(0.1, 0.2 + sign * away)));
    }
    for (const double speed : {0.9e-6, 1.1e-6}) {
      ForeignTrajectory foreign = beside_another(robot, 0.0);
      foreign.velocities[1][2] = sign * speed;
      EXPECT_EQ(timed_trajectory(foreign, robot, "t.json")->moving_end.empty(), speed < 1e-6);
      std::swap(foreign.velocities[0], foreign.velocities[1]);
      EXPECT_EQ(timed_trajectory(foreign, robot, "t.json")->moving_start.empty(), speed < 1e-6);
    }
  }
}

}  // namespace timed_ages_test
}  // namespace clearway
