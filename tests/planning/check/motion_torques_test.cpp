#include "planning/check/motion_torques.hpp"

#include <gtest/gtest.h>

#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {
namespace motion_torques_test {

/// Gravity comes from aside, so that the first joint has something to hold, too.
TEST(GreatestTorques, EachJointThatGravityAloneOverloadsIsNamedByItself) {
  for (const char* name : {"panda", "puma560"}) {
    const Robot robot = load_robot(name);
    TorqueTerms terms = torque_terms(robot, {.payload = 2.0, .gravity = {6.0, 5.0, -6.0}});
    Configuration q(robot.dof());
    for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = 0.3 + 0.2 * static_cast<double>(j);
    const Eigen::VectorXd rest = Eigen::VectorXd::Zero(q.size());
    const Motion still{1.0, {q, q}, {rest, rest}, {rest, rest}};
    const Eigen::VectorXd held = joint_torques(robot, q, rest, rest, terms).cwiseAbs();
    ASSERT_GT(held[0], 1.0) << name;
    int tried = 0;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      if (held[j] < 1e-3) continue;
      ++tried;
      terms.limits = 100.0 * held + Eigen::VectorXd::Ones(q.size());
      const auto found_at = [&](double share) {
        terms.limits[j] = held[j] / share;
        return greatest_torques(robot, still, terms);
      };
      EXPECT_TRUE(found_at(0.94).overloaded.empty()) << name << ' ' << j;
      const TorqueFinding found = found_at(0.96);
      const std::vector<std::string> alone{robot.joints[static_cast<std::size_t>(j)].name};
      EXPECT_EQ(found.overloaded, alone) << name;
      EXPECT_EQ(found.joint, j) << name;
      EXPECT_NEAR(found.share, 0.96, 1e-9) << name << ' ' << j;
      EXPECT_EQ(torque_fault(robot, still.period, terms, found), "");
      // A motion at its limit is one that may be.
      for (const double share : {1.0 - 2e-7, 1.0 + 8e-7})
        EXPECT_EQ(torque_fault(robot, still.period, terms, found_at(share)), "") << name << ' ' << j;
      EXPECT_NE(torque_fault(robot, still.period, terms, found_at(1.0 + 2e-6)), "") << name << ' ' << j;
      const TorqueFinding beyond = found_at(1.1);
      EXPECT_NE(torque_fault(robot, still.period, terms, beyond), "") << name << ' ' << j;
    }
    EXPECT_GE(tried, 5) << name;
  }
}

}  // namespace motion_torques_test
}  // namespace clearway
