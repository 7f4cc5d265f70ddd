#include "planning/team/rigid_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace clearway {
namespace rigid_motion_test {

Eigen::Isometry3d pose_of(const Eigen::Vector3d& place, double angle, const Eigen::Vector3d& axis) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = place;
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return pose;
}

RigidMotion there_and_back(bool repeats) {
  return RigidMotion({{1.0, pose_of({0, 0, 0}, 0.0, {1, 0, 0})},
                      {3.0, pose_of({2, 0, 1}, 1.5, {1, 2, 3})},
                      {4.0, pose_of({0, 0, 0}, 0.0, {1, 0, 0})}},
                     repeats);
}

TEST(RigidMotion, GoesEvenlyFromPoseToPose) {
  const RigidMotion motion = there_and_back(false);
  const Eigen::Isometry3d middle = motion.pose(2.0);
  EXPECT_LT((middle.translation() - Eigen::Vector3d(1, 0, 0.5)).norm(), 1e-12);
  const Eigen::AngleAxisd turn(middle.linear());
  EXPECT_NEAR(turn.angle(), 0.75, 1e-9);
  EXPECT_LT((turn.axis() - Eigen::Vector3d(1, 2, 3).normalized()).norm(), 1e-9);
}

TEST(RigidMotion, StandsStillBeforeAndAfterUnlessItRepeats) {
  EXPECT_TRUE(there_and_back(false).pose(-5.0).isApprox(there_and_back(false).pose(1.0)));
  EXPECT_TRUE(there_and_back(false).pose(50.0).isApprox(there_and_back(false).pose(4.0)));
  for (const double time : {1.2, 2.9, 3.7})
    EXPECT_TRUE(there_and_back(true).pose(time + 6.0).isApprox(there_and_back(true).pose(time), 1e-9))
        << time;
}

TEST(RigidMotion, VelocitiesLeadToWhereItIsOnePeriodLater) {
  const MovingObstacle obstacle{"box", Shape::box({0.2, 0.4, 0.6}), there_and_back(true)};
  const double period = 1e-4;
  for (double time = 1.05; time < 9.0; time += 0.37) {
    const PlacedShape now = obstacle.placed(time, period), later = obstacle.placed(time + period, period);
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(0.1, 0.2, 0.3), Eigen::Vector3d(-0.1, 0.2, -0.3)}) {
      const Eigen::Vector3d moved = later.pose * corner - now.pose * corner;
      EXPECT_LT((now.velocity_at(now.pose * corner) - moved / period).norm(), 1e-3) << time;
    }
  }
}

TEST(RigidMotion, NoPointIsFasterThanTheGreatestSpeed) {
  const MovingObstacle obstacle{"box", Shape::box({0.2, 0.4, 0.6}), there_and_back(true)};
  const double most = obstacle.greatest_speed();
  double seen = 0.0;
  for (double time = 1.0; time < 7.0; time += 0.01) {
    const PlacedShape now = obstacle.placed(time, 0.002);
    for (const double x : {-0.1, 0.1})
      for (const double y : {-0.2, 0.2})
        for (const double z : {-0.3, 0.3})
          seen = std::max(seen, now.velocity_at(now.pose * Eigen::Vector3d(x, y, z)).norm());
  }
  EXPECT_LE(seen, most * (1.0 + 1e-9));
  EXPECT_GT(seen, 0.8 * most);
}

TEST(RigidMotion, RefusesWhatIsNoMotion) {
  EXPECT_THROW(RigidMotion({}), std::invalid_argument);
  EXPECT_THROW(RigidMotion({{1.0, Eigen::Isometry3d::Identity()}, {1.0, Eigen::Isometry3d::Identity()}}),
               std::invalid_argument);
  Eigen::Isometry3d elsewhere = Eigen::Isometry3d::Identity();
  elsewhere.translation().x() = 1.0;
  EXPECT_THROW(RigidMotion({{0.0, Eigen::Isometry3d::Identity()}, {1.0, elsewhere}}, true),
               std::invalid_argument);
  EXPECT_THROW(RigidMotion({{std::nan(""), Eigen::Isometry3d::Identity()}}), std::invalid_argument);
}

}  // namespace rigid_motion_test
}  // namespace clearway
