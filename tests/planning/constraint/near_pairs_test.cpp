#include "planning/constraint/near_pairs.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace near_pairs_test {

TEST(NearPairs, AreThoseWhoseDistanceIsWithinTheReachOfEach) {
  for (const char* name : {"puma560", "panda", "arm5", "planar2"}) {
    const Robot robot = load_robot(name);
    const std::vector<BodyPair> all = self_collision_pairs(robot);
    const auto reach = [](const BodyPair& pair) { return pair.second % 3 == 0 ? -1.0 : 0.06 * pair.second; };
    NearPairs pairs(robot, reach);
    Random random(3);
    int near = 0, far = 0;
    for (int trial = 0; trial < 400; ++trial) {
      const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
      const std::span<const NearPair> found = pairs.look(poses);
      std::size_t next = 0;
      for (const BodyPair& pair : all) {
        const DistanceBounds truth = pair_distance(robot, pair, poses);
        const bool is_listed =
            next < found.size() && found[next].first == pair.first && found[next].second == pair.second;
        if (truth.lower < reach(pair) - 1e-9) {
          ++near;
          EXPECT_TRUE(is_listed) << name << ' ' << pair.first << ' ' << pair.second;
        }
        if (!is_listed) {
          ++far;
          continue;
        }
        const NearPair& listed = found[next++];
        EXPECT_LT(listed.distance, reach(pair));
        EXPECT_NEAR(listed.distance, truth.lower, 1e-7);
        EXPECT_NEAR(listed.direction.norm(), 1.0, 1e-9);
        EXPECT_EQ(listed.first_link, robot.bodies[static_cast<std::size_t>(pair.first)].link);
        EXPECT_EQ(listed.second_link, robot.bodies[static_cast<std::size_t>(pair.second)].link);
        if (truth.upper > 1e-6) {
          EXPECT_LT((listed.first_point - truth.point_a).norm(), 1e-3);
          EXPECT_LT((listed.second_point - truth.point_b).norm(), 1e-3);
        }
      }
      EXPECT_EQ(next, found.size());
    }
    if (all.empty()) continue;
    EXPECT_GT(near, 20) << name;
    EXPECT_GT(far, 100) << name;
  }
}

TEST(NearPairs, JudgesBoxesAndHullsByTheirSpheresAlone) {
  Robot robot = load_robot("puma560");
  robot.bodies[4].shape = Shape::box({0.08, 0.06, 0.12});
  robot.bodies[7].shape = Shape::convex({{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0.02, 0.02, 0.15}});
  NearPairs pairs(robot, [](const BodyPair&) { return 0.1; });
  Random random(4);
  int near = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
    std::size_t expected = 0;
    for (const BodyPair& pair : self_collision_pairs(robot)) {
      const DistanceBounds truth = pair_distance(robot, pair, poses);
      expected += truth.lower < 0.1 ? 1 : 0;
    }
    EXPECT_EQ(pairs.look(poses).size(), expected) << trial;
    near += static_cast<int>(expected);
  }
  EXPECT_GT(near, 100);
}

}  // namespace near_pairs_test
}  // namespace clearway
