#include "planning/robot/self_collision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/worlds/batch_worlds.hpp"

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

/// Whether a link hangs below the joint or the held joint above another.
bool hangs_below(const Robot& robot, int link, int upper) {
  while (link >= 0 && link != upper) link = robot.links[static_cast<std::size_t>(link)].parent;
  return link >= 0;
}

/// By what the links do: those whose poses against each other change, or that a held joint is between.
TEST(SelfContact, PairsAreOfBodiesThatMoveAgainstEachOtherOrWouldIfNoJointWereHeld) {
  std::size_t found = 0, left_out = 0, held_apart = 0;
  for (Robot robot : worlds::robots_of_all_kinds()) {
    for (const bool is_held : {false, true}) {
      const int holder = static_cast<int>(robot.links.size()) / 2;
      if (is_held) {
        robot.links[static_cast<std::size_t>(holder)].joint = -1;
        robot.links[static_cast<std::size_t>(holder)].is_held = true;
        robot.exempt.clear();
      }
      Random random(9);
      std::vector<LinkPoses> samples;
      for (int i = 0; i < 3; ++i) samples.push_back(forward_kinematics(robot, random.configuration(robot)));
      std::set<std::pair<int, int>> expected, pairs;
      for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
        for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) {
          const int one = robot.bodies[static_cast<std::size_t>(a)].link,
                    other = robot.bodies[static_cast<std::size_t>(b)].link;
          const auto apart = [&](const LinkPoses& poses) {
            return Eigen::Isometry3d(poses[static_cast<std::size_t>(one)].inverse() *
                                     poses[static_cast<std::size_t>(other)]);
          };
          const bool moves = !apart(samples[0]).isApprox(apart(samples[1]), 1e-9) ||
                             !apart(samples[0]).isApprox(apart(samples[2]), 1e-9);
          const bool is_between =
              is_held && hangs_below(robot, one, holder) != hangs_below(robot, other, holder);
          const bool is_exempt =
              std::find(robot.exempt.begin(), robot.exempt.end(), std::pair(a, b)) != robot.exempt.end();
          if ((moves || is_between) && !is_exempt) expected.emplace(a, b);
          held_apart += is_between && !moves && !is_exempt;
          left_out += is_exempt || !(moves || is_between);
        }
      }
      for (const BodyPair& pair : self_collision_pairs(robot)) {
        EXPECT_TRUE(pairs.emplace(pair.first, pair.second).second);
        for (const LinkPoses& poses : samples) {
          const double lower = pair_distance(robot, pair, poses).lower;
          for (const double margin : {0.0, 0.9 * lower, 1.1 * lower + 1e-9})
            EXPECT_EQ(is_apart(robot, pair, poses, margin), lower > margin) << robot.name << margin;
        }
      }
      EXPECT_EQ(pairs, expected) << robot.name << is_held;
      found += pairs.size();
    }
  }
  EXPECT_GT(found, 50U);
  EXPECT_GT(left_out, 50U);
  EXPECT_GT(held_apart, 0U);
}

}  // namespace self_contact_test
}  // namespace clearway
