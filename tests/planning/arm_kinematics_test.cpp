#include "planning/arm_kinematics.hpp"

#include <gtest/gtest.h>

#include "tests/planning/random_world.hpp"

namespace clearway {
namespace {

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
  for (const char* name : {"puma560", "arm5", "panda", "planar2", "point"}) {
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

}  // namespace
}  // namespace clearway
