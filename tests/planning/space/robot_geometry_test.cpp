#include "planning/space/robot_geometry.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace robot_geometry_test {

TEST(RobotGeometry, IsMadeOnceForARobotAndAnewWhereItsBodiesDifferOrStandElsewhere) {
  const Robot arm = load_robot("puma560");
  const auto known = robot_geometry(arm);
  Robot renamed = arm;
  renamed.name = "another";
  EXPECT_EQ(robot_geometry(renamed), known);
  Robot moved = arm;
  moved.map_from_base.translation().x() += 1.0;
  const auto elsewhere = robot_geometry(moved);
  ASSERT_NE(elsewhere, known);
  for (std::size_t i = 0; i < known->policed.size(); ++i)
    EXPECT_NEAR(elsewhere->policed[i].reach.min().x(), known->policed[i].reach.min().x() + 1.0, 1e-9);
  Robot larger = arm;
  Body& tool = larger.bodies.back();
  tool.shape = Shape::sphere(0.5);
  EXPECT_THROW(robot_geometry(larger), std::invalid_argument);  // the cover is of what it was
  tool.cover = {{tool.link_from_shape.translation(), 0.5}};
  EXPECT_NE(robot_geometry(larger), known);
  for (const double radius : {0.49, -0.5}) {
    tool.cover[0].radius = radius;
    EXPECT_THROW(robot_geometry(larger), std::invalid_argument) << radius;
  }
  tool.cover = {{tool.link_from_shape.translation() + Eigen::Vector3d(0.01, 0, 0), 0.5}};
  EXPECT_THROW(robot_geometry(larger), std::invalid_argument);
}

TEST(RobotGeometry, KnowsOfEachBodyWhatTheRobotSays) {
  for (const char* name : {"puma560", "panda"}) {
    const Robot arm = load_robot(name);
    const auto geometry = robot_geometry(arm);
    ASSERT_EQ(geometry->robot.bodies.size(), arm.bodies.size());
    for (const RobotGeometry::Policed& policed : geometry->policed) {
      const Body& body = geometry->robot.bodies[static_cast<std::size_t>(policed.index)];
      EXPECT_TRUE(is_policed(geometry->robot, body.link));
      EXPECT_EQ(policed.geometry->body.part, body.part);
      EXPECT_EQ(policed.levers, body_levers(geometry->robot, body));
      EXPECT_TRUE(policed.reach.isApprox(reach_box(geometry->robot, body)));
      for (const Sphere& sphere : body.cover)
        EXPECT_LE((sphere.center - policed.geometry->bound.center).norm(), policed.geometry->spread);
      for (const Eigen::Vector3d& witness : policed.geometry->witnesses)
        EXPECT_LE(body.shape.signed_distance(body.link_from_shape.inverse() * witness), 1e-12);
    }
    for (Eigen::Index j = 0; j < geometry->matters.size(); ++j) {
      const bool moves = std::any_of(geometry->policed.begin(), geometry->policed.end(),
                                     [j](const auto& policed) { return policed.levers[j] > 0.0; });
      EXPECT_EQ(geometry->matters[j], moves ? 1.0 : 0.0) << name << " joint " << j;
    }
    EXPECT_GE(geometry->matters.sum(), 5.0) << name;  // the flange of one is round
  }
}

}  // namespace robot_geometry_test
}  // namespace clearway
