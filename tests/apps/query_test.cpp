#include "apps/query.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "mapping/free_space_map.hpp"

namespace clearway {
namespace {

/// Forces at q of a robot whose base is turned by `map_from_base`, under gravity (map frame) and a load.
Eigen::VectorXd forces(const Eigen::Matrix3d& map_from_base, const Eigen::Vector3d& gravity, double payload,
                       const Configuration& q) {
  Robot robot = load_robot("puma560");
  robot.map_from_base.linear() = map_from_base;
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot());
  Query query{space, "puma560", {}, {}, q, {q}, "beam", {}};
  query.gravity = gravity;
  query.payload = payload;
  return path_cost(query).generalized_forces(q);
}

const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
const Eigen::Matrix3d on_the_wall =
    Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();

Configuration pose() {
  Configuration q(6);
  q << 0.3, -0.6, 0.4, 0.2, 0.5, 0.1;
  return q;
}

TEST(Query, TurningTheBaseAndGravityAlikeChangesNoForce) {
  const Eigen::Vector3d down(0, 0, -9.81);
  const Eigen::VectorXd floor = forces(upright, down, 1.0, pose());
  EXPECT_TRUE(forces(on_the_wall, on_the_wall * down, 1.0, pose()).isApprox(floor, 1e-9));
}

TEST(Query, GravityIsThatOfTheMapSoThatAnArmOnTheWallHasToHoldItselfAboutItsFirstAxis) {
  Robot robot = load_robot("puma560");
  for (Joint& joint : robot.joints) joint.friction = 0.0;
  const Eigen::Vector3d down(0, 0, -9.81);
  const PathCost upright_cost(robot, {.gravity = down});
  const PathCost wall_cost(robot, {.gravity = on_the_wall.transpose() * down});
  EXPECT_NEAR(upright_cost.generalized_forces(pose())[0], 0.0, 1e-9);
  EXPECT_GT(wall_cost.generalized_forces(pose())[0], 1.0);
  EXPECT_GT(forces(on_the_wall, down, 0.0, pose())[0], forces(upright, down, 0.0, pose())[0] + 1.0);
}

TEST(Query, APayloadCostsAndNoGravityCostsNothing) {
  const Eigen::Vector3d down(0, 0, -9.81);
  EXPECT_GT(forces(upright, down, 2.0, pose())[1], forces(upright, down, 0.0, pose())[1]);
  EXPECT_NEAR(forces(upright, Eigen::Vector3d::Zero(), 2.0, pose()).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace clearway
