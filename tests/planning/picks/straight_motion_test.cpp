#include "planning/picks/straight_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace straight_motion_test {

TEST(StraightMotion, LeadsTheTipStraightOnOrNotAtAll) {
  Random random(1);
  int led = 0;
  for (const char* name : {"puma560", "arm6", "panda"}) {
    const Robot robot = load_robot(name);
    for (int i = 0; i < 30; ++i) {
      const Configuration from = random.configuration(robot);
      const Eigen::Vector3d way = random.point(0.1);
      const auto path = straight_motion(robot, from, way, 0.01);
      if (!path) continue;
      ++led;
      EXPECT_EQ(path->front(), from);
      const Eigen::Isometry3d begin = tip_pose(robot, from);
      for (std::size_t k = 0; k < path->size(); ++k) {
        const Eigen::Isometry3d tip = tip_pose(robot, (*path)[k]);
        const double share = static_cast<double>(k) / static_cast<double>(path->size() - 1);
        EXPECT_LT((tip.translation() - begin.translation() - share * way).norm(), 2e-6);
        EXPECT_TRUE(tip.linear().isApprox(begin.linear(), 1e-5));
        EXPECT_TRUE(limit_violation(robot, (*path)[k]).empty());
      }
    }
  }
  EXPECT_GT(led, 30);
  const Robot robot = load_robot("arm6");
  EXPECT_FALSE(straight_motion(robot, Configuration::Zero(6), {0.0, 0.0, 5.0}, 0.01).has_value());
}

/// The height of a body is kept only where it is: against the truth at many places.
TEST(StraightMotion, ProvesHeightsThatAreKept) {
  Random random(5);
  const Robot robot = load_robot("arm6");
  const std::size_t body = robot.bodies.size() - 1;
  int proved = 0, refused = 0;
  for (int i = 0; i < 200; ++i) {
    const Configuration from = random.configuration(robot),
                        to = from + 0.05 * (random.configuration(robot) - from);
    const double slack = random.between(-0.02, 0.02);
    double low = 1e9, high = -1e9;
    for (int k = 0; k <= 200; ++k) {
      const LinkPoses poses = forward_kinematics(robot, from + k / 200.0 * (to - from));
      const Body& known = robot.bodies[body];
      const auto box =
          known.shape.bounds(poses[static_cast<std::size_t>(known.link)] * known.link_from_shape);
      low = std::min(low, box.min().z()), high = std::max(high, box.min().z());
    }
    const bool is_kept = keeps_height(robot, body, {from, to}, low - slack, high + slack);
    EXPECT_TRUE(slack > -1e-5 || !is_kept);
    EXPECT_TRUE(slack < 1e-3 || is_kept);
    proved += is_kept, refused += !is_kept;
  }
  EXPECT_GT(proved, 50);
  EXPECT_GT(refused, 50);
  const Configuration nan = Configuration::Constant(6, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(keeps_height(robot, body, {nan, nan}, -10.0, 10.0));
}

}  // namespace straight_motion_test
}  // namespace clearway
