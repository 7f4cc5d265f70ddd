#include "planning/constraint/broad_phase.hpp"

#include <gtest/gtest.h>

#include "planning/constraint/near_pairs.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace near_spheres_test {

constexpr double edge = 0.03, reach = 0.1, close_to = 0.05;

TEST(BroadPhase, AreAllThatAreWithinReachAndNoneThatTheFieldProvesToBeFar) {
  const Robot robot = load_robot("puma560");
  Random random(2);
  FreeSpaceMap map({.resolution = edge});
  for (int i = 0; i < 300; ++i) occupy(map, ((random.point(0.9) / edge).array().floor() + 0.5) * edge);
  for (const double field_ends : {0.12, 0.5}) {  // the first field proves no sphere out of reach
    const auto space = map.snapshot().blocked_space(
        {Policy::not_occupied}, {Eigen::Vector3d::Constant(-1.5), Eigen::Vector3d::Constant(1.5)},
        field_ends);
    BroadPhase spheres(*space);
    const std::vector<SphereReach> reaches(robot.bodies.size(), {reach, close_to});
    for (const Body& body : robot.bodies) spheres.add(body.link, sphere_around(body), body.cover);
    int near = 0, far = 0;
    for (int trial = 0; trial < 200; ++trial) {
      const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
      const std::span<const NearSphere> found = spheres.look(poses, reaches);
      std::size_t next = 0;
      for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        const Body& body = robot.bodies[b];
        for (const Sphere& sphere : body.cover) {
          const Eigen::Vector3d center = poses[static_cast<std::size_t>(body.link)] * sphere.center;
          const bool is_listed = next < found.size() && found[next].body == static_cast<int>(b) &&
                                 (found[next].center - center).norm() < 1e-12;
          const double proved = space->clearance(center) - sphere.radius;
          const NearestBlocked nearest = space->nearest(center, space->max_distance());
          if (nearest.found && nearest.distance < sphere.radius + reach) {
            ++near;
            EXPECT_TRUE(is_listed);
          }
          if (!is_listed) {
            ++far;
            continue;
          }
          EXPECT_LT(proved, reach + 1e-9);
          EXPECT_EQ(found[next].is_close, proved < close_to);
          EXPECT_EQ(found[next++].radius, sphere.radius);
        }
      }
      EXPECT_EQ(next, found.size());
    }
    EXPECT_GT(near, 200);
    EXPECT_EQ(far > 2000, field_ends > 0.2);
  }
}

}  // namespace near_spheres_test
}  // namespace clearway
