#include "planning/space/axisymmetric_joints.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace idle_turns_test {

/// How far the body reaches along a direction of the map.
double reach_along(const Robot& robot, std::size_t body, const LinkPoses& poses, const Eigen::Vector3d& n) {
  const Body& of = robot.bodies[body];
  const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(of.link)] * of.link_from_shape;
  return n.dot(pose * of.shape.support(pose.linear().transpose() * n));
}

TEST(AxisymmetricJoints, BodiesTakeUpTheSameSpaceInEveryConfiguration) {
  Random random(11);
  for (const char* name : {"puma560", "puma560_miniature", "panda", "arm5", "arm6", "planar2", "point"}) {
    const Robot robot = load_robot(name), carried = without_axisymmetric_joints(robot);
    ASSERT_EQ(carried.bodies.size(), robot.bodies.size());
    for (int i = 0; i < 200; ++i) {
      const Configuration q =
          robot.dof() == 2 ? Configuration(random.point(2.0).head<2>()) : random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
        const Eigen::Vector3d n = random.point(1.0).normalized();
        EXPECT_NEAR(reach_along(robot, body, poses, n), reach_along(carried, body, poses, n), 1e-13)
            << name << " " << robot.bodies[body].part;
        const Body& of = carried.bodies[body];  // its cover still holds it
        const Eigen::Vector3d point =
            of.link_from_shape * (random.between(0.0, 1.0) * of.shape.support(random.point(1.0)));
        EXPECT_TRUE(std::any_of(of.cover.begin(), of.cover.end(),
                                [&](const Sphere& sphere) {
                                  return (point - sphere.center).norm() <= sphere.radius * (1.0 + 1e-9);
                                }))
            << name << " " << of.part;
      }
    }
  }
}

TEST(AxisymmetricJoints, TheWristOfThePumaTurnsItsRoundToolForNothing) {
  const Robot robot = load_robot("puma560"), carried = without_axisymmetric_joints(robot);
  const auto carrier = [&](const char* part) {
    for (const Body& body : carried.bodies)
      if (body.part == part) return carried.links[static_cast<std::size_t>(body.link)].name;
    return std::string();
  };
  EXPECT_EQ(carrier("tool"), "link5");
  EXPECT_EQ(carrier("link6"), "link5");
  EXPECT_EQ(carrier("link5"), "link3");  // a sphere in the middle of the wrist
  EXPECT_EQ(carrier("link4"), "link3");
  EXPECT_EQ(carrier("link3"), "link3");
  EXPECT_EQ(carrier("link2"), "link2");
}

TEST(AxisymmetricJoints, WhatIsNotRoundAboutTheJointOrWouldNotBeMovedAnyMoreStaysWhereItIs) {
  Robot robot = load_robot("puma560");
  for (Body& body : robot.bodies) {
    if (body.part == "tool") body.link_from_shape.translation().x() = 1e-9;
    if (body.part == "link6") body.shape = Shape::box({0.02, 0.02, 0.02});
    if (body.part == "link1") body.link_from_shape.setIdentity();  // round about the first joint
  }
  const Robot carried = without_axisymmetric_joints(robot);
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const std::string& part = robot.bodies[i].part;
    if (part == "tool" || part == "link6" || part == "link1") {
      EXPECT_EQ(carried.bodies[i].link, robot.bodies[i].link) << part;
    }
  }
}

TEST(AxisymmetricJoints, AnAxisymmetricJointChangesNoAnswerOfTheSpace) {
  Random random(12);
  const Robot robot = load_robot("puma560");
  VoxelScene voxels{0.05, {}, {}, {}};
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector3d corner = random.point(1.0);
    voxels.occupied.emplace_back(corner, corner + Eigen::Vector3d::Constant(0.1));
  }
  Policies policies;
  policies.critical_by_default = false;
  const ConfigurationSpace space(robot, voxels.snapshot(), policies);
  int free = 0, blocked = 0, free_edges = 0, blocked_edges = 0;
  for (int i = 0; i < 3000; ++i) {
    const Configuration q = random.configuration(robot);
    Configuration turned = q, to = q + 0.05 * Configuration::Constant(6, random.between(-1.0, 1.0));
    turned[5] = random.between(-3.0, 3.0);
    ASSERT_EQ(space.is_free(q), space.is_free(turned));
    (space.is_free(q) ? free : blocked)++;
    to[5] = q[5];
    const bool edge = space.is_edge_free(q, to);
    (edge ? free_edges : blocked_edges)++;
    to[5] += random.between(-0.2, 0.2);
    if (std::abs(to[5]) < 4.6) {
      ASSERT_EQ(space.is_edge_free(q, to), edge) << i;
    }
    EXPECT_EQ(space.is_edge_free(q, turned), space.is_free(q));
  }
  EXPECT_GT(std::min({free, blocked, free_edges, blocked_edges}), 200);
}

bool fcl_apart(const Robot& robot, const std::pair<int, int>& pair, const Configuration& q) {
  const LinkPoses poses = forward_kinematics(robot, q);
  const auto pose = [&](const Body& body) {
    return poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
  };
  const Body& a = robot.bodies[static_cast<std::size_t>(pair.first)];
  const Body& b = robot.bodies[static_cast<std::size_t>(pair.second)];
  return !fcl_collide(fcl_geometry(a.shape).get(), pose(a), fcl_geometry(b.shape).get(), pose(b));
}

TEST(AxisymmetricJoints, BodiesThatAlwaysTouchAreRefusedAlsoWhenAxisymmetricJointsCarryThemOnOneLink) {
  Robot robot = load_robot("puma560");  // the spheres of link 5 and of the forearm's end both go to link 3
  int wrist = -1, forearm = -1;
  for (int i = 0; i < static_cast<int>(robot.bodies.size()); ++i) {
    const std::string& part = robot.bodies[static_cast<std::size_t>(i)].part;
    if (part == "link5") wrist = i;
    if (part == "link3") forearm = i;
  }
  ASSERT_TRUE(wrist >= 0 && forearm >= 0);
  const std::pair<int, int> pair = std::minmax(wrist, forearm);
  std::erase(robot.exempt, pair);
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b)
      if (std::pair(a, b) != pair) robot.exempt.emplace_back(a, b);  // nothing else to refuse for
  }
  Policies policies;
  policies.critical_by_default = false;
  const Snapshot empty = VoxelScene{0.05, {box_of(5, 5, 5, 5.1, 5.1, 5.1)}, {}, {}}.snapshot();
  Random random(13);
  for (const double radius : {0.01, 0.6}) {
    Body& sphere = robot.bodies[static_cast<std::size_t>(wrist)];
    sphere.shape = Shape::sphere(radius);
    sphere.cover = {{sphere.link_from_shape.translation(), radius}};
    ASSERT_EQ(without_axisymmetric_joints(robot).bodies[static_cast<std::size_t>(wrist)].link,
              robot.bodies[static_cast<std::size_t>(forearm)].link);
    const ConfigurationSpace space(robot, empty, policies);
    for (int i = 0; i < 50; ++i) {
      const Configuration q = random.configuration(robot), to = random.configuration(robot);
      const bool apart = fcl_apart(robot, pair, q);
      EXPECT_EQ(apart, radius < 0.1);
      EXPECT_EQ(space.is_free(q), apart);
      EXPECT_EQ(space.check(q).is_free(), apart);
      EXPECT_EQ(space.is_edge_free(q, to), apart);
      const std::string sentence = space.check(q).sentence();
      if (!apart) {
        EXPECT_NE(sentence.find("link3"), std::string::npos) << sentence;
        EXPECT_NE(sentence.find("link5"), std::string::npos) << sentence;
      }
    }
  }
}

}  // namespace idle_turns_test
}  // namespace clearway
