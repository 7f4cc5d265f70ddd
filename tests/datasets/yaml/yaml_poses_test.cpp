#include <gtest/gtest.h>

#include <numbers>

#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {
namespace yaml_poses_test {

using std::numbers::pi;

Eigen::Isometry3d pose_of(const std::string& text) { return YamlFields(text, "file").pose("pose"); }

std::string refusal(const std::string& text) {
  try {
    pose_of(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(YamlPoses, AnglesAreRadiansOrAsDegDegreesOfAnySize) {
  const Eigen::Isometry3d quarter = pose_of("pose: [1, 2, 3, 0, 0, 1.5707963267948966]");
  EXPECT_LT((quarter * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
  for (const double turns : {0.0, 1.0, -3.0}) {
    const std::string degrees = std::to_string(90.0 + 360.0 * turns);
    EXPECT_TRUE(pose_of("pose_deg: [1, 2, 3, 0, 0, " + degrees + "]").isApprox(quarter, 1e-9)) << turns;
  }
  EXPECT_EQ(refusal("pose: [0, 0, 0, 6.2831, -6.2831, 6.2832]"), "");
}

/// An angle in radians beyond a whole turn was meant in degrees.
TEST(YamlPoses, DegreesThatAreGivenAsRadiansAreRefused) {
  for (int i = 3; i < 6; ++i) {
    for (const double value : {90.0, -45.0, 6.3}) {
      std::string text = "pose: [0, 0, 1";
      for (int k = 3; k < 6; ++k) text += ", " + std::to_string(k == i ? value : 0.1);
      EXPECT_NE(refusal(text + "]").find("expected angles in radians, each within a whole turn"),
                std::string::npos)
          << text;
    }
  }
  EXPECT_NE(refusal("pose: [0, 0, 1, 0, 0, 90]").find("got 90; pose_deg takes degrees"), std::string::npos);
  EXPECT_EQ(refusal("pose: [900, 90, -90, 0, 0, 0]"), "");  // metres
  EXPECT_THROW(YamlFields("turn: [0, 0, 90]", "file").rotation("turn"), std::invalid_argument);
  EXPECT_NEAR(YamlFields("turn_deg: [0, 0, 450]", "file").rotation("turn")(1, 0), 1.0, 1e-12);
}

}  // namespace yaml_poses_test
}  // namespace clearway
