#include "planning/problem/path_cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <numbers>
#include <random>

#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace path_cost_test {

constexpr double kGravity = 9.81;

/// A joint on a link of `mass` with its centre of mass at `center`, on a massless root.
Robot one_joint(JointKind kind, const Eigen::Vector3d& axis, double mass, const Eigen::Vector3d& center,
                double friction) {
  Robot robot;
  Joint joint;
  joint.name = "joint";
  joint.kind = kind;
  joint.axis = axis.normalized();
  joint.lower = -10.0, joint.upper = 10.0;
  joint.friction = friction;
  robot.joints = {joint};
  Link root, link;
  root.name = "root", link.name = "link";
  link.parent = 0, link.joint = 0;
  link.mass = mass, link.center_of_mass = center;
  robot.links = {root, link};
  robot.tip_link = 1;
  return robot;
}

double force(const Robot& robot, double q, const CostOptions& options = {}) {
  return PathCost(robot, options).generalized_forces(Eigen::VectorXd::Constant(1, q))[0];
}

Eigen::VectorXd random_configuration(const Robot& robot, std::mt19937_64& random) {
  Eigen::VectorXd q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    std::uniform_real_distribution<double> uniform(robot.joints[j].lower, robot.joints[j].upper);
    q[static_cast<Eigen::Index>(j)] = uniform(random);
  }
  return q;
}

TEST(PathCost, GravityPartEqualsTheRigidBodyTorquesOfKdl) {
  const Robot robot = load_robot("puma560");
  KDL::Tree tree;
  ASSERT_TRUE(kdl_parser::treeFromFile((datasets_folder() / "robots/puma560.urdf").string(), tree));
  KDL::Chain chain;
  ASSERT_TRUE(tree.getChain(robot.links.front().name,
                            robot.links[static_cast<std::size_t>(robot.tip_link)].name, chain));
  ASSERT_EQ(chain.getNrOfJoints(), 6u);
  KDL::ChainDynParam dynamics(chain, KDL::Vector(0, 0, -kGravity));
  const PathCost cost(robot);
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    KDL::JntArray angles(6), torques(6);
    angles.data = q;
    ASSERT_EQ(dynamics.JntToGravity(angles, torques), 0);
    ASSERT_LE((cost.gravity_torques(q) - torques.data).cwiseAbs().maxCoeff(), 1e-9) << q.transpose();
  }
}

TEST(PathCost, WithoutFrictionTheForcesAreTheMagnitudesOfGravity) {
  Robot robot = load_robot("puma560");
  for (Joint& joint : robot.joints) joint.friction = 0.0;
  const PathCost cost(robot);
  std::mt19937_64 random(2);
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    EXPECT_EQ(cost.generalized_forces(q), cost.gravity_torques(q).cwiseAbs());
  }
}

TEST(PathCost, HorizontalHingeCarriesWeightTimesArm) {
  const Robot robot = one_joint(JointKind::revolute, Eigen::Vector3d::UnitY(), 2.0, {0.5, 0.3, 0.0}, 0.1);
  EXPECT_NEAR(force(robot, 0.0), 2.0 * kGravity * 0.5, 1e-12);  // W is across the axis: no normal force
  EXPECT_NEAR(force(robot, std::numbers::pi / 3.0), 2.0 * kGravity * 0.5 * std::cos(std::numbers::pi / 3.0),
              1e-12);
  EXPECT_NEAR(force(robot, std::numbers::pi / 2.0), 0.0, 1e-12);
}

TEST(PathCost, VerticalHingeCarriesFrictionOnly) {
  const Robot robot = one_joint(JointKind::revolute, Eigen::Vector3d::UnitZ(), 2.0, {0.3, 0.4, 5.0}, 0.1);
  EXPECT_NEAR(force(robot, 0.7), 0.1 * 2.0 * kGravity * 0.5, 1e-12);  // mu F_N r with r = |(0.3, 0.4)|
}

TEST(PathCost, TiltedHingeHasBothParts) {
  const double tilt = 0.4;
  const Eigen::Vector3d z(std::sin(tilt), 0.0, std::cos(tilt));
  const Robot robot = one_joint(JointKind::revolute, z, 3.0, {0.0, 0.2, 0.0}, 0.25);
  const double weight = 3.0 * kGravity;
  // W.z = -weight cos(tilt); z x rho = 0.2 (-cos(tilt), 0, sin(tilt)).
  EXPECT_NEAR(force(robot, 0.0), 0.25 * weight * std::cos(tilt) * 0.2 + weight * 0.2 * std::sin(tilt), 1e-12);
}

TEST(PathCost, PrismaticJointLiftsAndRubs) {
  EXPECT_NEAR(force(one_joint(JointKind::prismatic, Eigen::Vector3d::UnitZ(), 2.0, {1, 1, 1}, 0.1), 0.3),
              2.0 * kGravity, 1e-12);
  EXPECT_NEAR(force(one_joint(JointKind::prismatic, Eigen::Vector3d::UnitX(), 2.0, {1, 1, 1}, 0.1), 0.3),
              0.1 * 2.0 * kGravity, 1e-12);
  const Robot slope =
      one_joint(JointKind::prismatic, {std::cos(0.5), 0.0, std::sin(0.5)}, 2.0, {0, 0, 0}, 0.1);
  EXPECT_NEAR(force(slope, 0.0), 2.0 * kGravity * (std::sin(0.5) + 0.1 * std::cos(0.5)), 1e-12);
}

TEST(PathCost, LoadHangsAtTheTip) {
  Robot robot = one_joint(JointKind::revolute, Eigen::Vector3d::UnitY(), 2.0, {0.5, 0.0, 0.0}, 0.0);
  robot.link_from_tip.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  CostOptions options;
  options.payload_mass = 4.0;
  EXPECT_NEAR(force(robot, 0.0, options), kGravity * (2.0 * 0.5 + 4.0 * 1.0), 1e-12);
}

TEST(PathCost, OneLiftCostsWeightTimesHeight) {
  const Robot robot = one_joint(JointKind::prismatic, Eigen::Vector3d::UnitZ(), 2.0, {0, 0, 0}, 0.1);
  const PathCost cost(robot);
  EXPECT_NEAR(cost({Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Constant(1, 0.6)}),
              2.0 * kGravity * 0.5, 1e-12);
}

TEST(PathCost, IsAdditiveAndNeverNegativeAndTheSameBackwards) {
  const Robot robot = load_robot("puma560");
  const PathCost cost(robot);
  std::mt19937_64 random(3);
  for (int i = 0; i < 50; ++i) {
    std::vector<Configuration> path;
    for (int k = 0; k < 8; ++k) path.push_back(random_configuration(robot, random));
    const double whole = cost(path);
    const double parts = cost({path.begin(), path.begin() + 4}) + cost({path.begin() + 3, path.end()});
    EXPECT_NEAR(whole, parts, 1e-9 * whole);
    EXPECT_GT(whole, 0.0);
    EXPECT_NEAR(cost({path.rbegin(), path.rend()}), whole, 1e-9 * whole);
    EXPECT_GE(cost.generalized_forces(path[0]).minCoeff(), 0.0);
  }
  EXPECT_EQ(cost({}), 0.0);
  EXPECT_EQ(cost({random_configuration(robot, random)}), 0.0);
}

TEST(PathCost, AMiniatureIsCostedAtFullSize) {
  const Robot full = load_robot("puma560"), miniature = scaled(full, 0.1);
  std::mt19937_64 random(4);
  std::vector<Configuration> path;
  for (int k = 0; k < 5; ++k) path.push_back(random_configuration(full, random));
  EXPECT_NEAR(PathCost(miniature)(path), PathCost(full)(path), 1e-9 * PathCost(full)(path));

  const Robot lift = one_joint(JointKind::prismatic, Eigen::Vector3d::UnitZ(), 2.0, {0, 0, 0}, 0.1);
  const std::vector<Configuration> small = {Eigen::VectorXd::Constant(1, 0.01),
                                            Eigen::VectorXd::Constant(1, 0.06)};
  EXPECT_NEAR(PathCost(scaled(lift, 0.1))(small), 2.0 * kGravity * 0.5, 1e-9);
}

TEST(PathCost, GravityIsInTheBaseFrameWhereverTheBaseStands) {
  Robot robot = load_robot("puma560");
  std::mt19937_64 random(5);
  const Eigen::VectorXd q = random_configuration(robot, random);
  const Eigen::VectorXd before = PathCost(robot).gravity_torques(q);
  robot.map_from_base.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  robot.map_from_base.translation() = Eigen::Vector3d(3.0, 2.0, 1.0);
  EXPECT_LE((PathCost(robot).gravity_torques(q) - before).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(PathCost, RefusesANegativeLoad) {
  CostOptions options;
  options.payload_mass = -1.0;
  EXPECT_THROW(PathCost(one_joint(JointKind::revolute, Eigen::Vector3d::UnitZ(), 1, {1, 0, 0}, 0), options),
               std::invalid_argument);
}

}  // namespace path_cost_test
}  // namespace clearway
