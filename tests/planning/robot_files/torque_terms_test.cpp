#include "planning/robot_files/torque_terms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace torque_terms_test {

constexpr double turn = 0.3;  // rad

/// A link on a turntable and one that slides on it, each with moments 1, 2 and 4 about axes that are turned
/// about one axis of the link.
Robot loaded(const TemporaryFolder& folder, const std::string& rpy) {
  const std::string parts =
      "<inertial><origin xyz='0.1 0 0' rpy='" + rpy +
      "'/><mass value='2'/><inertia ixx='1' iyy='2' izz='4' ixy='0' ixz='0' iyz='0'/></inertial>"
      "<collision><geometry><sphere radius='0.05'/></geometry></collision></link>";
  const auto joint = [](const std::string& name, const std::string& type, const std::string& from,
                        const std::string& to, const std::string& effort) {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + from + "'/><child link='" + to +
           "'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='1' effort='" + effort + "'/></joint>";
  };
  return load_robot(folder.write("t.urdf", "<robot name='t'><link name='base'/><link name='a'>" + parts +
                                               "<link name='b'>" + parts + "<link name='c'>" + parts +
                                               joint("turning", "revolute", "base", "a", "3") +
                                               joint("sliding", "prismatic", "a", "b", "5") +
                                               joint("unlimited", "revolute", "b", "c", "0") + "</robot>"));
}

/// By hand: of moments p and q about axes turned by t the product is (p - q) sin t cos t.
TEST(TorqueTerms, InertiasAreTurnedIntoTheLinksAxesAndGrowWithTheFifthPower) {
  const TemporaryFolder folder;
  const double s = std::sin(turn), c = std::cos(turn);
  const auto turned = [&](int i, int j) {  // from axis i to axis j
    Eigen::Matrix3d inertia = Eigen::Vector3d(1.0, 2.0, 4.0).asDiagonal();
    const double p = inertia(i, i), q = inertia(j, j);
    inertia(i, i) = p * c * c + q * s * s;
    inertia(j, j) = p * s * s + q * c * c;
    inertia(i, j) = inertia(j, i) = (p - q) * s * c;
    return inertia;
  };
  for (const auto& [rpy, expected] : {std::pair("0.3 0 0", turned(1, 2)), std::pair("0 0.3 0", turned(2, 0)),
                                      std::pair("0 0 0.3", turned(0, 1))}) {
    const Robot robot = loaded(folder, rpy);
    for (const double scale : {1.0, 0.5, 2.0}) {
      const TorqueTerms terms = torque_terms(scaled(robot, scale));
      EXPECT_EQ(terms.inertia[0], Eigen::Matrix3d::Zero());
      for (const std::size_t link : {1U, 2U, 3U})
        EXPECT_LT((terms.inertia[link] - std::pow(scale, 5) * expected).cwiseAbs().maxCoeff(),
                  1e-12 * std::pow(scale, 5))
            << rpy << ' ' << scale << '\n'
            << terms.inertia[link];
    }
  }
}

/// As weights' torques do; of slides as weights do.
TEST(TorqueTerms, LimitsGrowWithTheFourthPowerAndOfSlidesWithTheThird) {
  const TemporaryFolder folder;
  const Robot robot = loaded(folder, "0 0 0");
  for (const double scale : {1.0, 0.5, 2.0}) {
    const TorqueTerms terms = torque_terms(scaled(robot, scale));
    ASSERT_EQ(terms.limits.size(), 3);
    EXPECT_NEAR(terms.limits[0], 3.0 * std::pow(scale, 4), 1e-12);
    EXPECT_NEAR(terms.limits[1], 5.0 * std::pow(scale, 3), 1e-12);
    EXPECT_EQ(terms.limits[2], HUGE_VAL);
  }
}

}  // namespace torque_terms_test
}  // namespace clearway
