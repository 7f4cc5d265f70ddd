// Poses along a path, as dense as asked for and no denser than it takes.
#include "planning/survey/path_poses.hpp"

#include <gtest/gtest.h>

#include <random>

#include "planning/check/path_check_model.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace path_poses_test {

struct Visited {
  Eigen::Isometry3d pose;
  PathPlace place;
};

TEST(PathPoses, NoPointOfABodyMovesFartherThanTheSpacingFromOneToTheNext) {
  const Robot robot = without_file(load_robot("puma560"));
  const check::KdlArm arm(robot);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (const double length : {0.02, 0.3, 2.0}) {  // edges much shorter and much longer than the spacing
    std::vector<Configuration> path{Configuration::Zero(static_cast<Eigen::Index>(robot.dof()))};
    for (int i = 0; i < 12; ++i)
      path.push_back(path.back() + length * Configuration::NullaryExpr(path.back().size(), [&](Eigen::Index) {
                                     return value(random);
                                   }));
    for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
      constexpr double spacing = 0.05;
      std::vector<Visited> visited;
      visit_body_poses(arm, body, path, spacing, [&](const Eigen::Isometry3d& pose, const PathPlace& place) {
        visited.push_back({pose, place});
      });
      ASSERT_FALSE(visited.empty());
      EXPECT_EQ(visited.front().place.edge, 0);
      EXPECT_EQ(visited.front().place.parameter, 0.0);
      EXPECT_EQ(visited.back().place.edge, 11);
      EXPECT_EQ(visited.back().place.parameter, 1.0);
      double way = 0.0;
      for (std::size_t i = 1; i < path.size(); ++i)
        way += arm.motion(body, (path[i] - path[i - 1]).cwiseAbs());
      EXPECT_LE(static_cast<double>(visited.size()), way / spacing + 3.0);
      const Shape& shape = robot.bodies[body].shape;
      for (std::size_t i = 1; i < visited.size(); ++i) {
        const PathPlace &a = visited[i - 1].place, &b = visited[i].place;
        EXPECT_LE(a.edge + a.parameter, b.edge + b.parameter);
        for (int k = 0; k < 20; ++k) {
          const Eigen::Vector3d point = shape.support({value(random), value(random), value(random)});
          EXPECT_LE((visited[i].pose * point - visited[i - 1].pose * point).norm(), spacing * (1.0 + 1e-6));
        }
      }
    }
  }
}

TEST(PathPoses, AWaypointAloneIsOnePoseAndAWayOfAMillionIsRefused) {
  const Robot robot = without_file(load_robot("point"));
  const check::KdlArm arm(robot);
  int poses = 0;
  const auto count = [&](const Eigen::Isometry3d&, const PathPlace&) { ++poses; };
  visit_body_poses(arm, 0, {Configuration::Zero(2)}, 0.1, count);
  EXPECT_EQ(poses, 1);
  visit_body_poses(arm, 0, {}, 0.1, count);
  EXPECT_EQ(poses, 1);
  EXPECT_THROW(visit_body_poses(arm, 0, {Configuration::Zero(2), Configuration::Ones(2)}, 1e-7, count),
               std::invalid_argument);
}

}  // namespace path_poses_test
}  // namespace clearway
