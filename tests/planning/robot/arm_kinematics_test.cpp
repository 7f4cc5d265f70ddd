#include "planning/robot/arm_kinematics.hpp"

#include <gtest/gtest.h>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace arm_kinematics_test {

TEST(ArmKinematics, ASlidingLinkThatFollowsNoJointKeepsItsOffset) {
  Robot robot = load_robot("point");
  robot.links.back().multiplier = 0.0;
  robot.links.back().offset = 0.3;
  ArmKinematics kinematics(robot);
  const Configuration q = Eigen::Vector2d(0.1, 0.2);
  kinematics.place(q);
  EXPECT_NEAR(
      (forward_kinematics(robot, q).back().matrix() - kinematics.map_from_link().back().matrix()).norm(), 0.0,
      1e-13);
  ASSERT_GE(robot.links.back().joint, 0);
}

TEST(ArmKinematics, PlacesLinksAndMovesPointsAsTheGeneralFunctionsDo) {
  for (const char* name : {"puma560", "arm5", "arm6", "panda", "planar2", "point"}) {
    Robot robot = load_robot(name);
    robot.links.back().multiplier = -0.7;  // a joint that drives its link at another rate
    robot.links.back().offset = 0.3;
    ArmKinematics kinematics(robot);
    Random random(1);
    std::vector<double> gradient(robot.dof());
    for (int trial = 0; trial < 100; ++trial) {
      const Configuration q = random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      kinematics.place(q);
      const Eigen::Vector3d point = random.point(1.0), normal = random.point(1.0).normalized();
      for (std::size_t i = 0; i < poses.size(); ++i) {
        EXPECT_NEAR((poses[i].matrix() - kinematics.map_from_link()[i].matrix()).norm(), 0.0, 1e-13) << name;
        const Eigen::VectorXd expected =
            jacobian(robot, poses, static_cast<int>(i), point).topRows<3>().transpose() * normal;
        kinematics.rate(static_cast<int>(i), point, normal, gradient);
        for (std::size_t j = 0; j < gradient.size(); ++j)
          EXPECT_NEAR(gradient[j], expected[static_cast<Eigen::Index>(j)], 1e-13) << name;
      }
    }
  }
}

TEST(ArmKinematics, NoPointOfASphereMovesFartherThanItsBoundAndSomeMoveNearlySoFar) {
  for (const char* name : {"puma560", "arm5", "arm6", "panda", "planar2", "point"}) {
    Robot robot = load_robot(name);
    robot.links.back().multiplier = -0.7;
    ArmKinematics kinematics(robot);
    Random random(2);
    std::vector<double> gradient(robot.dof()), steps(robot.dof());
    double closest = 0.0;
    for (int trial = 0; trial < 400; ++trial) {
      kinematics.place(random.configuration(robot));
      for (double& step : steps) step = random.between(0.0, 0.1);
      const Sphere sphere{random.point(1.0), 0.05};
      const int link = trial % static_cast<int>(robot.links.size());
      const double most = kinematics.farthest_move(link, sphere, steps);
      for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d at = sphere.center + sphere.radius * random.point(1.0).normalized();
        kinematics.rate(link, at, random.point(1.0).normalized(), gradient);
        double move = 0.0;
        for (std::size_t j = 0; j < steps.size(); ++j) move += std::abs(gradient[j]) * steps[j];
        EXPECT_LE(move, most * (1.0 + 1e-12)) << name;
        if (most > 0.0) closest = std::max(closest, move / most);
      }
    }
    EXPECT_GT(closest, 0.8) << name;
  }
}

}  // namespace arm_kinematics_test
}  // namespace clearway
