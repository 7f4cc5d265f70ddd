#include "apps/check/robot_terms.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "apps/check/trajectory_plan.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace robot_terms_test {

/// An arm whose group "arm" leaves its finger's joint "grip" out.
class RobotTerms : public ::testing::Test {
 protected:
  RobotTerms() {
    options_.robot.robot = folder_.write("arm.urdf", worlds::arm_with_finger());
    folder_.write("arm.srdf",
                  "<robot name='arm'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
                  "<group name='hand'><joint name='grip'/></group><group_state name='open' group='hand'>"
                  "<joint name='grip' value='0.04'/></group_state></robot>");
  }

  Contract contract_for(const std::string& group, const std::map<std::string, double>& held) const {
    Plan plan;
    plan.group = group;
    plan.held = held;
    Contract contract;
    state_robot(options_, plan, robot_to_check(options_, plan), contract);
    return contract;
  }

  TemporaryFolder folder_;
  CheckOptions options_;
};

TEST_F(RobotTerms, AJointThatThePlanAloneHoldsElsewhereIsNoted) {
  using Notes = std::vector<std::string>;
  const Contract held = contract_for("arm", {{"grip", 0.03}});
  EXPECT_EQ(held.group.source, TermSource::plan);
  EXPECT_EQ(held.held.at("grip").source, TermSource::plan);
  EXPECT_EQ(held.notes, Notes{"joint grip stands at 0.03 by the plan; by default at 0"});
  EXPECT_EQ(contract_for("arm", {{"grip", 0.0}}).notes, Notes{});
  EXPECT_EQ(contract_for("", {{"grip", 0.03}}).notes,
            Notes{"joint grip stands at 0.03 by the plan; by default it moves"});
  options_.robot.group = "arm";
  options_.robot.fixed = {"grip=0.03"};
  const Contract by_flag = contract_for("arm", {{"grip", 0.03}});
  EXPECT_EQ(by_flag.group.source, TermSource::flag);
  EXPECT_EQ(by_flag.held.at("grip").source, TermSource::flag);
  EXPECT_EQ(by_flag.notes, Notes{});
  options_.robot.fixed = {"open"};  // by a state
  EXPECT_EQ(contract_for("arm", {{"grip", 0.04}}).held.at("grip").source, TermSource::flag);
  options_.robot.fixed.clear();  // by nobody's word
  const Contract by_nobody = contract_for("arm", {});
  EXPECT_EQ(by_nobody.held.at("grip").value, 0.0);
  EXPECT_EQ(by_nobody.held.at("grip").source, TermSource::by_default);
  EXPECT_EQ(by_nobody.notes, Notes{});
}

TEST_F(RobotTerms, OneOfSeveralJointsThatThePlanHoldsElsewhereIsNoted) {
  options_.robot.fixed = {"elbow=0.2"};
  const Contract contract = contract_for("", {{"elbow", 0.2}, {"grip", 0.03}});
  EXPECT_EQ(contract.held.at("elbow").source, TermSource::flag);
  EXPECT_EQ(contract.held.at("grip").source, TermSource::plan);
  EXPECT_EQ(contract.notes.size(), 1U);
}

TEST_F(RobotTerms, WhatThePlanHoldsStandsUnlessTheUserSaysThatItMovesOrStandsElsewhere) {
  Plan plan;
  plan.group = "arm";
  plan.held = {{"grip", 0.03}};
  const auto robot = [&] { return robot_to_check(options_, plan); };
  const auto value = [&] { return held_joint(robot(), "grip")->value; };
  using Names = std::vector<std::string>;
  EXPECT_EQ(joint_names(robot()), (Names{"shoulder", "elbow"}));
  EXPECT_EQ(robot().group, "arm");
  EXPECT_EQ(value(), 0.03);
  options_.robot.standing = {"base"};
  EXPECT_EQ(robot().standing, Names{"base"});
  options_.robot.standing.clear();
  plan.group.clear();
  EXPECT_EQ(joint_names(robot()), (Names{"shoulder", "elbow"}));
  EXPECT_EQ(robot().group, "");
  options_.robot.fixed = {"grip=0.02"};
  EXPECT_EQ(value(), 0.02);
  options_.robot.fixed.clear();
  options_.robot.group = "arm";
  EXPECT_EQ(value(), 0.03);
  options_.robot.group = "hand";
  EXPECT_EQ(joint_names(robot()), Names{"grip"});
  plan.held.clear();
  options_.robot.group.clear();
  plan.group = "arm";  // which counts where something is held
  EXPECT_EQ(robot().dof(), 3U);
}

TEST_F(RobotTerms, APlanOfOtherJointsOrInAnotherOrderIsRefused) {
  const Robot robot = load_robot(options_.robot.robot);
  Plan plan;
  plan.joints = joint_names(robot);
  EXPECT_NO_THROW(require_same_joints(robot, plan, "plan.json"));
  const auto sentence = [&]() -> std::string {
    try {
      require_same_joints(robot, plan, "plan.json");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  plan.joints.pop_back();
  EXPECT_NE(sentence().find("plan.json: field 'joints': the plan is for 2 joints"), std::string::npos);
  EXPECT_EQ(sentence().find("none is"), std::string::npos) << sentence();
  plan.joints.push_back("wrist");
  EXPECT_NE(sentence().find("of which none is 'wrist'"), std::string::npos) << sentence();
}

TEST_F(RobotTerms, OtherXacroArgumentsThanTheRobotsAreNoted) {
  const auto notes = [&](const std::map<std::string, std::string>& of_plan,
                         const std::map<std::string, std::string>& of_robot) {
    Plan plan;
    plan.xacro = of_plan;
    Robot robot = load_robot(options_.robot.robot);
    robot.xacro = of_robot;
    Contract contract;
    state_robot(options_, plan, robot, contract);
    return contract.notes;
  };
  EXPECT_TRUE(notes({}, {}).empty());
  EXPECT_TRUE(notes({{"side", "left"}}, {{"side", "left"}}).empty());
  const std::vector<std::string> found = notes({{"long", "1"}, {"side", "left"}}, {});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("(long:=1 side:=left) than those of the robot that is checked (none)"),
            std::string::npos)
      << found[0];
}

}  // namespace robot_terms_test
}  // namespace clearway
