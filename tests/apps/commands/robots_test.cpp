// `clearway robots ROBOT`: what it says of a robot against numbers worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/apps/run_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace robots_test {

using Json = nlohmann::json;

class Robots : public ::testing::Test {
 protected:
  CommandRun describe(const std::string& file, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"robots", file};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(Robots, BodiesAndTipStandWhereTheFileAndTheJointsPutThem) {
  const std::string file = folder_.write("arm.urdf", worlds::arm_with_finger());
  const CommandRun run =
      describe(file, {"--json", "--fix", "grip=0.03", "--at=90,0", "--degrees", "--base=1,0,0"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json said = Json::parse(run.out);
  ASSERT_EQ(said["joints"].size(), 2U);
  EXPECT_EQ(said["held"], Json({{{"name", "grip"}, {"value", 0.03}, {"by", "--fix"}}}));
  ASSERT_EQ(said["bodies"].size(), 3U);
  // The arm points along y from x = 1; the finger's sphere, of radius 0.05, is 0.4 + 0.4 + 0.03 + 0.1 along.
  const Json& finger = said["bodies"][2];
  EXPECT_EQ(finger["part"], "finger");
  EXPECT_EQ(finger["sizes"], Json({0.05}));
  const double ends[2][3] = {{0.95, 0.88, -0.05}, {1.05, 0.98, 0.05}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(finger["map_from"][i].get<double>(), ends[0][i], 1e-12);
    EXPECT_NEAR(finger["map_to"][i].get<double>(), ends[1][i], 1e-12);
  }
  EXPECT_EQ(said["touching"], Json::array());
  EXPECT_NEAR(said["tip_pose"][5].get<double>(), std::numbers::pi / 2, 1e-12);
}

TEST_F(Robots, AMeshIsTheHullOfItsCornersAndSolidsHaveTheirVolume) {
  folder_.write("tetrahedron.obj",
                "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const std::string file = folder_.write(
      "hull.urdf",
      "<robot name='hull'><link name='base'><collision><geometry><box size='0.1 0.2 0.3'/>"
      "</geometry></collision></link>" +
          worlds::urdf_link("hull", "2 0 0", "<mesh filename='tetrahedron.obj'/>") +
          worlds::urdf_joint("turn", "continuous", "base", "hull", "0 0 0", "0 0 1", "") + "</robot>");
  const Json said = Json::parse(describe(file, {"--json"}).out);
  EXPECT_NEAR(said["bodies"][0]["volume_m3"].get<double>(), 0.006, 1e-15);
  EXPECT_NEAR(said["bodies"][1]["volume_m3"].get<double>(), 1.0 / 6.0, 1e-9);
  EXPECT_EQ(said["bodies"][1]["vertices"].size(), 4U);
  EXPECT_EQ(said["joints"][0]["upper"], Json());
  EXPECT_GT(said["joints"][0]["max_acceleration"], 0.0);  // what is used where nobody states one
  EXPECT_EQ(said["joints"][0]["usual"], Json({"max_velocity", "max_acceleration", "max_jerk"}));
  const CommandRun text = describe(file);
  EXPECT_NE(text.out.find("hull of 4 corners, in 1,1,1"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("box 0.1 0.2 0.3"), std::string::npos) << text.out;
}

TEST_F(Robots, APageShowsTheRobotAndNothingThatIsReadIsWrittenOver) {
  const std::string file = folder_.write("arm.urdf", worlds::arm_with_finger()),
                    page = folder_.file("arm.html");
  const CommandRun run = describe(file, {"--view", page});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find(page), std::string::npos) << run.out;
  EXPECT_NE(read_file(page).find("sphere 0.05"), std::string::npos);
  const CommandRun over = describe(file, {"--view", file});
  EXPECT_EQ(over.status, exit_bad_input);
  EXPECT_NE(over.log.find("ROBOT"), std::string::npos) << over.log;
  EXPECT_EQ(read_file(file), worlds::arm_with_finger());
}

TEST_F(Robots, WhatTouchesAndWhatIsBeyondALimitIsTold) {
  const std::string file = folder_.write("arm.urdf", worlds::arm_with_finger());
  const CommandRun folded = describe(file, {"--at=0,3.14159,-0.3"});
  EXPECT_EQ(folded.status, exit_done);
  EXPECT_NE(folded.out.find("joint elbow is 3.14159 rad, above"), std::string::npos) << folded.out;
  // Folded, with the finger drawn in, the finger's sphere lies where the upper arm's is.
  EXPECT_EQ(Json::parse(describe(file, {"--json", "--at=0,3.14159,-0.3"}).out)["touching"],
            Json({"upper and finger"}));
  EXPECT_EQ(Json::parse(describe(file, {"--json", "--at=0,3.14159,0"}).out)["touching"], Json::array());
}

TEST_F(Robots, FlagsOfARobotWithoutOneAreRefused) {
  const std::vector<std::vector<std::string>> without{{"robots", "--at", "0"}, {"robots", "--degrees"}};
  for (const std::vector<std::string>& arguments : without) {
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  }
  const CommandRun missing = run_command({"robots", folder_.file("none.urdf")});
  EXPECT_EQ(missing.status, exit_bad_input);
  EXPECT_TRUE(missing.complains_in_one_sentence()) << missing.log;
}

}  // namespace robots_test
}  // namespace clearway
