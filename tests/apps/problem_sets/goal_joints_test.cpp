#include "apps/problem_sets/goal_joints.hpp"

#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

/// The arm's shoulder and elbow turn from -2 to 2, its finger slides.
class ImportGoals : public Import {
 protected:
  std::string goal(const std::string& joints) const { return "{joint_constraints: [" + joints + "]}"; }
  static std::string joint(const std::string& name, double position, double below = 0.0, double above = 0.0) {
    return "{joint_name: " + name + ", position: " + std::to_string(position) +
           ", tolerance_below: " + std::to_string(below) + ", tolerance_above: " + std::to_string(above) +
           "}";
  }

  CommandRun run(const std::string& goals, const Arguments& more = {}) {
    std::filesystem::remove_all(folder_ / "out");
    const std::string scene = folder_.write("scene.yaml", "world: {collision_objects: []}");
    const std::string request =
        folder_.write("request.yaml",
                      "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [-1, 0, 0.02]}}\n"
                      "group_name: arm\ngoal_constraints: [" +
                          goals + "]");
    return import("mbm", {scene, request}, more);
  }
  std::vector<std::vector<double>> goals_of_suite() const {
    return load_problem()["goals"].get<std::vector<std::vector<double>>>();
  }
  /// The only problem's line in its file, which is JSON.
  Json load_problem() const {
    const std::string text = read_file(folder_.file("out/problems/arm.yaml"));
    return Json::parse(text.substr(text.find('{')));
  }
  void expect_left_out(const std::string& goals, const std::string& why) {
    const CommandRun left = run(goals);
    EXPECT_EQ(left.status, exit_bad_input) << goals << left.out;
    EXPECT_TRUE(left.complains_in_one_sentence()) << left.log;
    EXPECT_NE(left.log.find(why), std::string::npos) << left.log;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
};

TEST_F(ImportGoals, ConstraintsOnOneJointHoldTogetherOrTheGoalIsLeftOut) {
  const std::string elbow = joint("elbow", 0.1);
  ASSERT_EQ(
      run(goal(joint("shoulder", 0.5, 0.2, 0.2) + ", " + elbow + ", " + joint("shoulder", 0.8, 0.2, 0.2)))
          .status,
      exit_done);
  EXPECT_NEAR(goals_of_suite()[0][0], 0.6, 1e-9) << "of 0.6 to 0.7 the nearest to 0.5";
  expect_left_out(goal(joint("shoulder", 0.5, 0.1, 0.1) + ", " + elbow + ", " + joint("shoulder", 0.8)),
                  "its goal has constraints on joint 'shoulder' that contradict each other: from 0.4 to 0.6, "
                  "and from 0.8 to 0.8");
}

TEST_F(ImportGoals, BeyondALimitAreWithinTheirToleranceAtItAndElseLeftOut) {
  ASSERT_EQ(run(goal(joint("shoulder", 2.3, 0.5, 0.5) + ", " + joint("elbow", 0.1))).status, exit_done);
  EXPECT_EQ(goals_of_suite(), (std::vector<std::vector<double>>{{2.0, 0.1}}));
  ASSERT_EQ(run(goal(joint("shoulder", -2.0000004) + ", " + joint("elbow", 0.1))).status, exit_done);
  EXPECT_EQ(goals_of_suite(), (std::vector<std::vector<double>>{{-2.0, 0.1}})) << "rounded by the file";
  expect_left_out(
      goal(joint("shoulder", 9.0, 0.001, 0.001) + ", " + joint("elbow", 0.1)),
      "problem 'request': its goal has joint 'shoulder' at 9, expected a value within its limits, "
      "from -2 to 2");
  const CommandRun other = run(goal(joint("shoulder", 9.0) + ", " + joint("elbow", 0.1)) + ", " +
                               goal(joint("shoulder", 0.3) + ", " + joint("elbow", 0.1)));
  ASSERT_EQ(other.status, exit_done) << other.log;
  EXPECT_NE(other.out.find("joint 'shoulder' at 9"), std::string::npos) << other.out;
  EXPECT_EQ(goals_of_suite(), (std::vector<std::vector<double>>{{0.3, 0.1}}));
}

/// MoveIt plans for the group alone, and a goal of another joint holds at the end nevertheless.
TEST_F(ImportGoals, OfAJointThatTheGroupDoesNotMoveCountAsWell) {
  folder_.write("arm.srdf",
                "<robot name='arm'><group name='arm'><joint name='shoulder'/><joint name='elbow'/></group>"
                "</robot>");
  const std::string arm = joint("shoulder", 0.5) + ", " + joint("elbow", 0.1);
  const CommandRun kept = run(goal(arm + ", " + joint("grip", 0.03, 0.01, 0.01)));
  EXPECT_EQ(kept.status, exit_done) << kept.log;
  EXPECT_NE(kept.out.find("left out  0"), std::string::npos) << kept.out;
  EXPECT_EQ(goals_of_suite(), (std::vector<std::vector<double>>{{0.5, 0.1}}));
  expect_left_out(goal(arm + ", " + joint("grip", 0.05, 0.01, 0.01)),
                  "problem 'request': its goal has joint 'grip' at 0.05, which group 'arm' does not move and "
                  "stands at 0.02");
}

/// Two joints without limits; a finger follows the second by `multiplier`.
std::string spinner(const std::string& multiplier) {
  const std::string sphere = "<sphere radius='0.05'/>";
  return "<robot name='spinner'><link name='base'/>" + worlds::urdf_link("upper", "0.2 0 0", sphere) +
         worlds::urdf_link("lower", "0.2 0 0", sphere) + worlds::urdf_link("finger", "0.2 0 0", sphere) +
         worlds::urdf_joint("shoulder", "continuous", "base", "upper", "0 0 0", "0 0 1", "") +
         worlds::urdf_joint("elbow", "continuous", "upper", "lower", "0.4 0 0", "0 0 1", "") +
         worlds::urdf_joint("follow", "continuous", "lower", "finger", "0.4 0 0", "0 0 1",
                            "<mimic joint='elbow' multiplier='" + multiplier + "'/>") +
         "</robot>";
}

/// MoveIt compares angles of such joints, and OMPL goes the shorter way; within tolerances as well.
TEST_F(ImportGoals, OfJointsWithoutLimitsAreTheWholeTurnNearestToTheStart) {
  const auto goal_from = [&](double start, const std::string& constraint, const std::string& multiplier) {
    std::filesystem::remove_all(folder_ / "out");
    robot_ = folder_.write("spinner.urdf", spinner(multiplier));
    const CommandRun run = import(
        "mbm",
        {folder_.write("scene.yaml", "world: {collision_objects: []}"),
         folder_.write("request.yaml", "start_state: {joint_state: {name: [shoulder, elbow], position: [0, " +
                                           std::to_string(start) + "]}}\ngoal_constraints: [" +
                                           goal(joint("shoulder", 0.0) + ", " + constraint) + "]")});
    EXPECT_EQ(run.status, exit_done) << run.log;
    const std::string file = std::filesystem::directory_iterator(folder_ / "out/problems")->path();
    const std::string text = read_file(file);
    return Json::parse(text.substr(text.find('{')))["goals"][0][1].get<double>();
  };
  const double turn = 2.0 * std::acos(-1.0);
  EXPECT_NEAR(goal_from(3.1, joint("elbow", -3.1), "1"), 3.1832, 1e-4) << "0.083 rad from the start";
  EXPECT_NEAR(goal_from(-3.1, joint("elbow", 3.1), "1"), -3.1832, 1e-4);
  EXPECT_NEAR(goal_from(7.0, joint("elbow", 0.5), "1"), 0.5 + turn, 1e-6);
  EXPECT_NEAR(goal_from(0.2, joint("elbow", 12.0), "1"), 12.0 - 2.0 * turn, 1e-6);
  EXPECT_NEAR(goal_from(3.1, joint("elbow", -3.1, 0.2, 0.2) + ", " + joint("elbow", -2.8, 0.1, 0.1), "1"),
              -2.9 + turn, 1e-6)
      << "of -2.9 to -2.9 the nearest to -3.1, a turn on";
  EXPECT_NEAR(goal_from(3.1, joint("elbow", -3.1), "0.5"), -3.1, 1e-6) << "a turn would move the finger";
}

std::string at_region(const std::string& link, const std::vector<Eigen::Vector3d>& places) {
  std::string primitives, poses;
  for (const Eigen::Vector3d& at : places) {
    primitives += (primitives.empty() ? "" : ", ") + std::string("{type: sphere, dimensions: [0.02]}");
    poses += (poses.empty() ? "" : ", ") + ("{position: [" + std::to_string(at.x()) + ", " +
                                            std::to_string(at.y()) + ", " + std::to_string(at.z()) + "]}");
  }
  return "position_constraints: [{link_name: " + link + ", constraint_region: {primitives: [" + primitives +
         "], primitive_poses: [" + poses + "]}}]";
}

/// Where the arm's second link stands at values of the goal, by the robot's own kinematics.
TEST_F(ImportGoals, OfJointValuesAndAPoseAtOnceHoldBothOrAreLeftOut) {
  const Robot arm = load_robot(robot_);
  Configuration q(3);
  q << 0.5, 0.1, 0.02;
  const auto lower =
      std::find_if(arm.links.begin(), arm.links.end(), [](const Link& link) { return link.name == "lower"; });
  const Eigen::Vector3d at =
      forward_kinematics(arm, q)[static_cast<std::size_t>(lower - arm.links.begin())].translation();
  const std::string values =
      "joint_constraints: [" + joint("shoulder", 0.5) + ", " + joint("elbow", 0.1) + "]";
  const CommandRun kept = run("{" + values + ", " + at_region("lower", {at}) + "}");
  ASSERT_EQ(kept.status, exit_done) << kept.log;
  EXPECT_EQ(goals_of_suite(), (std::vector<std::vector<double>>{{0.5, 0.1}}));
  EXPECT_NE(kept.out.find("problems  1\n"), std::string::npos) << "values, no pose: " << kept.out;
  const Eigen::Vector3d beside = at + Eigen::Vector3d(0.0, 0.1, 0.0);
  expect_left_out(
      "{" + values + ", " + at_region("lower", {beside}) + "}",
      "its goal asks for joint values and for a pose of link 'lower', which these values miss: they "
      "are 0.1 m and");
  EXPECT_EQ(run("{" + values + ", " + at_region("lower", {beside, at}) + "}").status, exit_done)
      << "any of several regions";
  expect_left_out(
      "{joint_constraints: [" + joint("shoulder", 0.5) + "], " + at_region("finger", {at}) + "}",
      "its goal asks for joint values and for a pose of link 'finger' at once, expected one of them "
      "or values of all joints");
  expect_left_out("{" + values + ", orientation_constraints: [{link_name: lower}]}",
                  "a goal of an orientation and of joint values");
}

/// moveit_msgs/PositionConstraint: the union of its regions.
TEST_F(ImportGoals, InAnyOfSeveralRegionsTakeTheFirstThatCanBeReached) {
  const Robot arm = load_robot(robot_);
  Configuration q(3);
  q << 0.4, 0.3, 0.02;
  const auto lower =
      std::find_if(arm.links.begin(), arm.links.end(), [](const Link& link) { return link.name == "lower"; });
  const Eigen::Vector3d at =
      forward_kinematics(arm, q)[static_cast<std::size_t>(lower - arm.links.begin())].translation();
  const CommandRun taken = run("{" + at_region("lower", {{9.0, 0.0, 0.0}, at}) + "}");
  ASSERT_EQ(taken.status, exit_done) << taken.log;
  const Json record = Json::parse(read_file(folder_.file("out/import.json")))["problems"][0]["goal"];
  EXPECT_EQ(record["number"], 2);
  EXPECT_EQ(record["of"], 2);
  const auto found = goals_of_suite()[0];
  q.head(static_cast<Eigen::Index>(found.size())) =
      Eigen::Map<const Configuration>(found.data(), static_cast<Eigen::Index>(found.size()));
  const Eigen::Vector3d reached =
      forward_kinematics(arm, q)[static_cast<std::size_t>(lower - arm.links.begin())].translation();
  EXPECT_LE((reached - at).norm(), 0.02 + 1e-5);
}

}  // namespace import_test
}  // namespace clearway
