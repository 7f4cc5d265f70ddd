#include "apps/check/robot_terms.hpp"

#include <gtest/gtest.h>

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
}

TEST_F(RobotTerms, OneOfSeveralJointsThatThePlanHoldsElsewhereIsNoted) {
  options_.robot.fixed = {"elbow=0.2"};
  const Contract contract = contract_for("", {{"elbow", 0.2}, {"grip", 0.03}});
  EXPECT_EQ(contract.held.at("elbow").source, TermSource::flag);
  EXPECT_EQ(contract.held.at("grip").source, TermSource::plan);
  EXPECT_EQ(contract.notes.size(), 1U);
}

}  // namespace robot_terms_test
}  // namespace clearway
