#include "planning/robot/self_collision.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace self_contact_test {

TEST(SelfContact, TheQuickBoundOfAPairIsNeverTooLargeAndAsLargeAsWasAskedFor) {
  // Two long rods side by side: the spheres that hold them overlap long before they touch.
  constexpr double radius = 0.03, length = 1.0;
  Robot robot;
  robot.links.resize(2);
  robot.bodies.resize(2);
  for (int i = 0; i < 2; ++i) {
    robot.bodies[static_cast<std::size_t>(i)].link = i;
    robot.bodies[static_cast<std::size_t>(i)].shape = Shape::capsule(radius, length);
  }
  const BodyPair pair{0, 1, {}};
  Random random(1);
  int near = 0, far = 0;
  for (int i = 0; i < 2'000; ++i) {
    const Eigen::Vector3d apart = random.point(2.0);
    const double along = std::max(std::abs(apart.z()) - length, 0.0);
    const double truth = std::hypot(apart.x(), apart.y(), along) - 2.0 * radius;
    if (truth <= 0.0) continue;
    const Eigen::Isometry3d first = random.pose(1.0);
    const LinkPoses poses{first, first * Eigen::Translation3d(apart)};
    const double enough = random.between(0.0, 1.5);
    const double bound = pair_distance_bound(robot, pair, poses, enough);
    ASSERT_LE(bound, truth + 1e-12);
    ASSERT_GE(bound, std::min(truth, enough) - 1e-9);
    (truth < enough ? near : far)++;
  }
  EXPECT_GT(near, 100);
  EXPECT_GT(far, 500);
}

}  // namespace self_contact_test
}  // namespace clearway
