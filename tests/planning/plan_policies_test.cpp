// What plan_and_check holds legs with loads to, and what its own check asks of a planner's path.
#include <gtest/gtest.h>

#include <cmath>

#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/map_of_looks.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace plan_policies_test {

/// A planner of a user's own, which goes straight whatever is in the way.
class Straight : public Planner {
 public:
  Straight() : Planner("straight", {}) {}
  PlanResult plan(const PlanProblem& problem) const override {
    PlanResult result;
    result.status = PlanStatus::solved;
    result.waypoints = {problem.start, problem.goal};
    return result;
  }
};

/// Seen at 2.5 s; the newest look is of 15 s.
TEST(PlanPolicies, APathThroughWhatWasSeenTooLongAgoIsNotProved) {
  constexpr double edge = worlds::looked_at_edge;
  const Snapshot map = worlds::map_of_looks({{Eigen::Vector3d::Constant(edge / 2), 2.5}});
  for (const double seen_within : {0.0, 12.0, 13.0}) {
    const ConfigurationSpace space(load_robot("point"), map, {.parts = {{"base", Policy::known_free}}},
                                   {.seen_within = seen_within});
    const Configuration start = Eigen::Vector2d::Constant(edge / 2),
                        goal = start + Configuration::Unit(2, 0) * edge;
    const Plan plan = plan_and_check({.space = space,
                                      .start = start,
                                      .goals = {goal},
                                      .planner = std::make_shared<Straight>(),
                                      .survey = std::nullopt,
                                      .advice_time = 0.0});
    EXPECT_EQ(plan.status(), PlanStatus::solved);
    EXPECT_EQ(plan.seen_within, seen_within);
    EXPECT_EQ(plan.is_proved(), seen_within != 12.0) << plan.validation.first_contact;
    EXPECT_EQ(plan.validation.first_contact.find("it was last seen 12.5 s before") != std::string::npos,
              seen_within == 12.0)
        << plan.validation.first_contact;
  }
}

Configuration at(double x, double grip) { return (Configuration(5) << x, 0.0, 0.3, 0.0, grip).finished(); }

Load can() {
  Load load;
  load.name = "can";
  load.link = "tcp";
  load.shape = Shape::cylinder(0.02, 0.1);
  load.touches = {"left", "right", "palm"};
  return load;
}

Policies anywhere() { return {.parts = {}, .critical_by_default = false}; }

/// Nothing is known of the map: who asks for a load in known space gets no plan for the legs on which it
/// rides.
TEST(PlanPolicies, ALoadIsHeldToThePolicyThatIsStatedForIt) {
  const worlds::UrdfRobot gripper = worlds::gripper();
  const ConfigurationSpace space(gripper.robot(), Snapshot(), anywhere());
  const auto plan = [&](const std::map<std::string, Policy>& policies, std::vector<int> legs) {
    return plan_and_check({.space = space,
                           .start = at(-0.2, 0.01),
                           .goals = {at(0.0, 0.01), at(0.2, 0.01)},
                           .loads = {{can(), std::move(legs)}},
                           .load_policies = policies,
                           .survey = std::nullopt,
                           .advice_time = 0.0});
  };
  const Plan usual = plan({}, {});
  EXPECT_TRUE(usual.is_proved()) << usual.explanation();
  EXPECT_EQ(usual.policies.at("can"), Policy::not_occupied);
  for (const Policy policy : {Policy::known_free, Policy::painted}) {
    const Plan refused = plan({{"can", policy}}, {});
    EXPECT_EQ(refused.policies.at("can"), policy);
    EXPECT_EQ(refused.status(), PlanStatus::start_invalid) << refused.explanation();
    const Plan later = plan({{"can", policy}}, {1});
    EXPECT_EQ(later.legs.size(), 2U);
    EXPECT_EQ(later.legs[0].status, PlanStatus::solved);
    EXPECT_EQ(later.legs.back().status, PlanStatus::start_invalid) << later.explanation();
  }
}

/// Between two legs with a load the hand may close farther: each stands still as its own start has it.
TEST(PlanPolicies, EachLegWithALoadKeepsTheGripOfItsOwnStart) {
  const worlds::UrdfRobot gripper = worlds::gripper();
  const ConfigurationSpace space(gripper.robot(), Snapshot(), anywhere());
  const Plan plan = plan_and_check({.space = space,
                                    .start = at(-0.2, 0.01),
                                    .goals = {at(0.0, 0.01), at(0.0, 0.03), at(0.2, 0.03)},
                                    .loads = {{can(), {0, 2}}},
                                    .survey = std::nullopt,
                                    .advice_time = 0.0});
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  for (const Configuration& q : plan.legs[0].waypoints) EXPECT_EQ(q[4], 0.01);
  for (const Configuration& q : plan.legs[2].waypoints) EXPECT_EQ(q[4], 0.03);
}

}  // namespace plan_policies_test
}  // namespace clearway
