#include "planning/robot/inverse_dynamics.hpp"

#include <gtest/gtest.h>

#include "planning/check/motion_torques.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace inverse_dynamics_test {

Eigen::VectorXd random_vector(Random& random, std::size_t n, double half) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(n));
  for (double& value : values) value = random.between(-half, half);
  return values;
}

/// Masses and inertias that no maker would build, so that no term is hidden.
void weigh(Robot& robot, TorqueTerms& terms, Random& random) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    Link& link = robot.links[i];
    link.mass = random.between(0.1, 5.0);
    link.center_of_mass = random.point(0.3);
    Eigen::Matrix3d root;
    for (double& value : root.reshaped()) value = random.between(-0.3, 0.3);
    terms.inertia[i] = root * root.transpose();
  }
}

TEST(InverseDynamics, AgreesWithKdlForShippedAndOddRobots) {
  Random random(1);
  std::vector<Robot> robots;
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "point"})
    robots.push_back(load_robot(name));
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  robots.push_back(whip.robot());       // a mimic joint
  robots.push_back(telescope.robot());  // slides
  robots.push_back(rack.robot());       // mimic joints of another kind
  for (Robot& robot : robots) {
    TorqueTerms terms = torque_terms(robot);
    for (int trial = 0; trial < 20; ++trial) {
      if (trial > 0) weigh(robot, terms, random);
      robot.map_from_base = random.pose(1.0);
      terms.load = {.payload = trial % 3 == 0 ? 0.0 : random.between(0.1, 4.0),
                    .gravity = random.point(10.0)};
      const Configuration q = random.configuration(robot);
      const Eigen::VectorXd v = random_vector(random, robot.dof(), 3.0),
                            a = random_vector(random, robot.dof(), 8.0);
      const Eigen::VectorXd ours = joint_torques(robot, q, v, a, terms),
                            kdl = kdl_torques(robot, q, v, a, terms);
      EXPECT_LT((ours - kdl).norm(), 1e-9 * (1.0 + kdl.norm())) << robot.name << " " << trial;
    }
  }
}

/// A point mass on a rod of length r: m r^2 a + m g r cos q about a level axis.
TEST(InverseDynamics, OfAPendulumIsTheTextbooks) {
  Robot robot;
  robot.links.resize(2);
  robot.joints.resize(1);
  robot.joints[0].axis = Eigen::Vector3d::UnitY();
  robot.links[1].parent = 0;
  robot.links[1].joint = 0;
  robot.links[1].mass = 2.0;
  robot.links[1].center_of_mass = {0.5, 0, 0};
  const TorqueTerms terms = torque_terms(robot);
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value).eval(); };
  for (const double q : {0.0, 0.7, -2.0})
    EXPECT_NEAR(joint_torques(robot, one(q), one(3.0), one(4.0), terms)[0],
                2.0 * 0.25 * 4.0 - 2.0 * 9.81 * 0.5 * std::cos(q), 1e-12);
}

TEST(InverseDynamics, MassesOfShippedRobotsAreKnownAsFarAsGravityPullsThem) {
  for (const auto& [name, description] : available_robots())
    EXPECT_TRUE(links_without_mass(load_robot(name)).empty()) << name;
  Robot robot = load_robot("puma560");  // whose first link has none, and turns about the upright axis
  EXPECT_LT(torque_terms(robot).limits[0], HUGE_VAL);
  EXPECT_EQ(links_without_mass(robot, {9.81, 0.0, 0.0}), std::vector<std::string>{"link1"});
  robot.map_from_base.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).matrix();
  EXPECT_EQ(links_without_mass(robot), std::vector<std::string>{"link1"});
}

TEST(InverseDynamics, LimitsAreKnownWhereEffortAndMassAre) {
  Robot robot = load_robot("panda");
  EXPECT_EQ(torque_terms(robot).limits[0], 87.0);
  EXPECT_EQ(torque_terms(robot).limits[6], 12.0);
  EXPECT_EQ(torque_terms(robot).inertia[2], 0.01 * Eigen::Matrix3d::Identity());
  EXPECT_NEAR(torque_terms(scaled(robot, 0.5)).limits[0], 87.0 / 16, 1e-12);
  EXPECT_TRUE(links_without_mass(robot).empty());
  for (Link& link : robot.links)
    if (link.name == "link4") link.mass = 0.0;
  EXPECT_EQ(links_without_mass(robot), std::vector<std::string>{"link4"});
  EXPECT_EQ(torque_terms(robot).limits[0], 87.0);  // of what is known
  EXPECT_EQ(missing_masses(robot, {0.0, 0.0, -9.81}),
            "The robot's file gives link 'link4' no mass (<inertial>)");
  for (Link& link : robot.links) link.mass = 0.0;
  EXPECT_EQ(torque_terms(robot).limits.minCoeff(), HUGE_VAL);
  EXPECT_EQ(torque_terms(robot, {.payload = 1.0}).limits[6], 12.0);
  robot.source.clear();
  EXPECT_EQ(torque_terms(robot, {.payload = 1.0}).limits.minCoeff(), HUGE_VAL);
}

}  // namespace inverse_dynamics_test
}  // namespace clearway
