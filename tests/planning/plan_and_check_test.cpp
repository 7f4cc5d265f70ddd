#include "planning/plan_and_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "mapping/free_space_map.hpp"
#include "planning/auto_planner.hpp"
#include "planning/beam/beam.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "tests/worlds/beam_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace plan_and_check_test {

/// A disc of 0.2 m radius before a wall with a way round it.
ConfigurationSpace walled_space(double padding = 0.0) {
  const VoxelScene scene{0.05, {box_of(0.9, -0.5, -0.1, 1.1, 0.5, 0.1)}, {}, {}};
  return {load_robot("point"), scene.snapshot(), anywhere_but_occupied(), {.padding = padding}};
}

const Configuration left = Eigen::Vector2d(0.0, 0.0), right = Eigen::Vector2d(2.0, 0.0),
                    above = Eigen::Vector2d(1.0, 1.0), in_the_wall = Eigen::Vector2d(1.0, 0.0);

TEST(PlanAndCheck, NeedsASpaceAStartAndAGoalAndReportsTheWholeStory) {
  const ConfigurationSpace space = walled_space(0.01);
  const Plan plan = plan_and_check({.space = space, .start = left, .goals = {right}});
  EXPECT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  EXPECT_EQ(plan.status(), PlanStatus::solved);
  EXPECT_EQ(plan.waypoints().front(), left);
  EXPECT_EQ(plan.waypoints().back(), right);
  EXPECT_EQ(plan.planner, "auto");
  EXPECT_EQ(plan.options, AutoPlanner().options());
  EXPECT_EQ(plan.robot, "point");
  EXPECT_EQ(plan.joints, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(plan.map_resolution, 0.05);
  EXPECT_EQ(plan.policies, space.policies());
  EXPECT_EQ(plan.padding, 0.01);
  EXPECT_EQ(plan.start, left);
  EXPECT_EQ(plan.goals, std::vector{right});
  EXPECT_GT(plan.validation.min_clearance, 0.0);
  EXPECT_EQ(plan.validation.clearance.size(), plan.waypoints().size());
  ASSERT_TRUE(plan.survey.has_value());
  EXPECT_GT(plan.survey->swept->total(), 0U);
  EXPECT_TRUE(plan.paint.empty());
}

TEST(PlanAndCheck, AgreesWithItsPartsCalledByHand) {
  const ConfigurationSpace space = walled_space();
  const auto planner = std::make_shared<const Beam>(BeamOptions{.width = 5, .last_segment = false});
  const Plan plan = plan_and_check(
      {.space = space, .start = left, .goals = {above, right, left}, .planner = planner, .seed = 3});

  const PathCost cost(space.robot());
  std::vector<Configuration> path{left};
  ASSERT_EQ(plan.legs.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const PlanResult leg = planner->plan({space, cost, path.back(), plan.goals[i], 3});
    expect_equal(leg, plan.legs[i], "leg " + std::to_string(i + 1));
    path.insert(path.end(), leg.waypoints.begin() + 1, leg.waypoints.end());
  }
  EXPECT_EQ(plan.waypoints(), path);
  EXPECT_NE(path.back(), left);  // in reach of one step: the legs begin where the ones before really ended
  const PathVerdict verdict = check_path(space.robot(), space.map(), space.policies(), 0.0, path);
  EXPECT_TRUE(verdict.valid);
  EXPECT_EQ(plan.validation.valid, verdict.valid);
  EXPECT_EQ(plan.validation.min_clearance, verdict.min_clearance);
  EXPECT_EQ(plan.validation.clearance, verdict.clearance);
  EXPECT_EQ(to_json(*plan.survey), to_json(survey_path(space.robot(), space.map(), space.policies(), path)));
}

TEST(PlanAndCheck, TakesPlannersOfTypedAndOfTextOptionsAlike) {
  const ConfigurationSpace space = walled_space();
  const auto path_of = [&](std::shared_ptr<const Planner> planner) {
    const Plan plan = plan_and_check({.space = space, .start = left, .goals = {right}, .planner = planner});
    EXPECT_TRUE(plan.is_proved());
    EXPECT_EQ(plan.planner, "rrtconnect");
    EXPECT_EQ(plan.options, planner->options());
    return plan.waypoints();
  };
  EXPECT_EQ(path_of(std::make_shared<RrtConnect>(RrtConnectOptions{.shortcuts = 7})),
            path_of(make_planner("rrtconnect", {{"shortcuts", "7"}})));
}

std::string refused_query(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing refused";
}

TEST(PlanAndCheck, RefusesEachFieldThatIsWrongInASentence) {
  const ConfigurationSpace space = walled_space();
  const auto refusal = [&](const std::function<void(PlanQuery&)>& spoil) {
    PlanQuery query{.space = space, .start = left, .goals = {above, right}};
    spoil(query);
    return refused_query([&] { plan_and_check(query); });
  };
  const double nan = std::nan("");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.start = Eigen::Vector3d::Zero(); }),
            "plan query: start has 3 values: expected 2, one for each joint of robot 'point'");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.start = {}; }),
            "plan query: start has 0 values: expected 2, one for each joint of robot 'point'");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.goals[1] = Eigen::VectorXd::Zero(1); }),
            "plan query: goal 2 has 1 value: expected 2, one for each joint of robot 'point'");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.goals.clear(); }),
            "plan query: goals are none: expected at least one");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.time_limit = 0.0; }),
            "plan query: time_limit is 0 s: expected a number above 0");
  EXPECT_EQ(refusal([=](PlanQuery& query) { query.time_limit = nan; }),
            "plan query: time_limit is nan s: expected a number above 0");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.advice_time = -1.0; }),
            "plan query: advice_time is -1 s: expected a number from 0");
  EXPECT_EQ(refusal([](PlanQuery& query) { query.payload = -2.0; }),
            "plan query: payload is -2 kg: expected a number from 0 to 1000000");
  EXPECT_EQ(refusal([=](PlanQuery& query) { query.gravity.z() = nan; }),
            "plan query: gravity is 0,0,nan m/s^2: expected finite numbers, at most 1000 m/s^2 together");
  EXPECT_EQ(refusal([](PlanQuery& query) {
              query.load_policies = {{"Cup", Policy::painted}};
            }),
            "plan query: load_policies names 'Cup': expected a load of the query");
  EXPECT_NE(refusal([](PlanQuery& query) { query.survey->allow_outside = {"tool"}; }).find("allow_outside"),
            std::string::npos);
}

TEST(PlanAndCheck, WhatTheMapOrTheTimeForbidsIsAnOutcome) {
  const ConfigurationSpace space = walled_space();
  const auto outcome = [&](const Configuration& start, const Configuration& goal, double time_limit) {
    const Plan plan = plan_and_check({.space = space,
                                      .start = start,
                                      .goals = {goal},
                                      .planner = make_planner("beam"),
                                      .time_limit = time_limit,
                                      .advice_time = 0.0});
    EXPECT_FALSE(plan.is_proved());
    EXPECT_FALSE(plan.validation.valid);
    EXPECT_TRUE(plan.waypoints().empty());
    EXPECT_FALSE(plan.explanation().empty());
    return plan.status();
  };
  const Configuration not_finite = Eigen::Vector2d(0.0, std::nan("")), far = Eigen::Vector2d(0.0, 1e3);
  for (const Configuration& bad : {in_the_wall, not_finite, far}) {
    EXPECT_EQ(outcome(bad, right, 60.0), PlanStatus::start_invalid);
    EXPECT_EQ(outcome(left, bad, 60.0), PlanStatus::goal_invalid);
  }
  EXPECT_EQ(outcome(left, right, 1e-9), PlanStatus::timed_out);
  EXPECT_TRUE(plan_and_check({.space = space,
                              .start = left,
                              .goals = {right},
                              .time_limit = std::numeric_limits<double>::infinity()})
                  .is_proved());
}

TEST(PlanAndCheck, TheFirstLegThatFailsEndsThePlanAndTheCheckCoversTheLegsBefore) {
  const ConfigurationSpace space = walled_space();
  const Plan plan = plan_and_check({.space = space, .start = left, .goals = {above, in_the_wall, right}});
  EXPECT_EQ(plan.status(), PlanStatus::goal_invalid);
  EXPECT_FALSE(plan.is_proved());
  EXPECT_EQ(plan.legs.size(), 2U);
  EXPECT_EQ(plan.waypoints().back(), above);
  EXPECT_TRUE(plan.validation.valid);
  EXPECT_EQ(plan.goals.size(), 3U);
}

/// Round a post, with a can between the fingers: whatever the planner, they stay as they are; who opens them
/// is refused. On a leg without the load they move.
TEST(PlanAndCheck, FingersStandStillWhileTheyHoldALoad) {
  const worlds::UrdfRobot gripper = worlds::gripper();
  const VoxelScene scene{0.05, {box_of(-0.1, -0.3, 0.0, 0.1, 0.3, 0.5)}, {}, {}};
  const ConfigurationSpace space(gripper.robot(), scene.snapshot(), anywhere_but_occupied());
  Load can;
  can.name = "can";
  can.link = "tcp";
  can.shape = Shape::cylinder(0.02, 0.1);
  can.touches = {"left", "right", "palm"};
  const auto at = [](double x, double grip) {
    return (Configuration(5) << x, 0.0, 0.3, 0.0, grip).finished();
  };
  int solved = 0;
  for (const PlannerEntry& entry : planner_table()) {
    const Plan plan = plan_and_check({.space = space,
                                      .start = at(-0.5, 0.01),
                                      .goals = {at(0.5, 0.01), at(0.7, 0.03)},
                                      .planner = make_planner(entry.name),
                                      .time_limit = 1.0,
                                      .loads = {{can, {0}}},
                                      .survey = std::nullopt,
                                      .advice_time = 0.0});
    if (plan.status() != PlanStatus::solved) continue;
    ++solved;
    EXPECT_TRUE(plan.is_proved() || !entry.certifies) << entry.name << plan.validation.first_contact;
    for (const Configuration& q : plan.legs[0].waypoints) EXPECT_EQ(q[4], 0.01) << entry.name;
    EXPECT_NEAR(plan.legs[1].waypoints.back()[4], 0.03, 0.011) << entry.name;
    Plan opened = plan;
    ASSERT_GT(opened.legs[0].waypoints.size(), 2U);
    opened.legs[0].waypoints[1][4] += 0.005;
    const PathVerdict verdict = check_legs(legs_of(opened, space.robot(), space.map()), opened.policies, 0.0);
    EXPECT_FALSE(verdict.valid) << entry.name;
    EXPECT_NE(verdict.first_contact.find("joint 'grip' moves by"), std::string::npos)
        << verdict.first_contact;
  }
  EXPECT_GE(solved, 4);
  const Plan refused = plan_and_check({.space = space,
                                       .start = at(-0.5, 0.01),
                                       .goals = {at(0.5, 0.02)},
                                       .loads = {{can, {}}},
                                       .survey = std::nullopt});
  EXPECT_EQ(refused.status(), PlanStatus::goal_invalid);
  EXPECT_NE(refused.explanation().find("holds load 'can' and cannot move"), std::string::npos)
      << refused.explanation();
}

TEST(PlanAndCheck, SaysWherePaintingWouldConnectStartAndGoalUnlessNoTimeIsGivenForIt) {
  const VoxelScene scene{
      0.05, {}, {{Eigen::Vector3d(0, 0, 0), 0.5}, {Eigen::Vector3d(2, 0, 0), 0.5}}, {"base"}};
  const ConfigurationSpace space(load_robot("point"), scene.snapshot());
  PlanQuery query{.space = space,
                  .start = left,
                  .goals = {right},
                  .planner = make_planner("rrtconnect", {{"max_samples", "2000"}})};
  const Plan advised = plan_and_check(query);
  EXPECT_EQ(advised.status(), PlanStatus::no_path);
  ASSERT_FALSE(advised.paint.empty());
  EXPECT_EQ(advised.paint.front().part, "base");
  EXPECT_NE(advised.explanation().find("Painting would connect"), std::string::npos) << advised.explanation();
  query.advice_time = 1e-9;
  EXPECT_NE(plan_and_check(query).explanation().find("Where painting would help was not found in 1e-09 s."),
            std::string::npos);
  query.advice_time = 0.0;
  const Plan plain = plan_and_check(query);
  EXPECT_EQ(plain.status(), PlanStatus::no_path);
  EXPECT_TRUE(plain.paint.empty());
  EXPECT_EQ(plain.explanation().find("Painting would connect"), std::string::npos);
}

/// An arm whose elbow meets a post of its own on the way round, and on the other way its joint's limit.
TEST(PlanAndCheck, SaysWhenTheRobotItselfKeepsStartAndGoalApart) {
  using namespace worlds;
  const std::string ball = "<sphere radius='0.05'/>";
  const UrdfRobot arm(
      "posted", urdf_link("base", "0 0.4 0", ball) + "<link name='upper'/>" +
                    urdf_link("elbow", "0 0 0", ball) +
                    urdf_joint("swing", "revolute", "base", "upper", "0 0 0", "0 0 1", urdf_limit(-3, 3)) +
                    urdf_joint("bend", "revolute", "upper", "elbow", "0.4 0 0", "0 0 1", urdf_limit(-3, 3)));
  const auto planned = [&](const std::vector<Eigen::AlignedBox3d>& walls, double from, double to) {
    const VoxelScene scene{0.05, walls, {}, {}};
    const ConfigurationSpace space(arm.robot(), scene.snapshot(), anywhere_but_occupied());
    return plan_and_check({.space = space,
                           .start = Eigen::Vector2d(from, 0.0),
                           .goals = {Eigen::Vector2d(to, 0.5)},
                           .planner = make_planner("rrtconnect", {{"max_samples", "2000"}})});
  };
  const std::string by_itself = "the robot itself seems to keep start and goal apart";
  const Plan apart = planned({box_of(1, 1, 1, 1.2, 1.2, 1.2)}, 0.0, 2.5);
  EXPECT_EQ(apart.status(), PlanStatus::no_path);
  EXPECT_NE(apart.explanation().find(by_itself), std::string::npos) << apart.explanation();
  const Plan walled = planned({box_of(0.2, -0.5, -0.1, 0.3, -0.2, 0.1)}, 0.0, -2.5);
  EXPECT_EQ(walled.status(), PlanStatus::no_path);
  EXPECT_EQ(walled.explanation().find(by_itself), std::string::npos) << walled.explanation();
}

TEST(PlanAndCheck, RefusesForWhatIsSurveyedUnlessThatIsAllowedOrNoSurveyIsAskedFor) {
  FreeSpaceMap map({.resolution = 0.05});
  Scan scan;
  scan.points = {{1.0f, 0.0f, 0.0f}};  // sees free what lies before it
  map.insert(scan);
  const ConfigurationSpace space(load_robot("point"), map.snapshot(), anywhere_but_occupied());
  PlanQuery query{.space = space,
                  .start = left,
                  .goals = {Eigen::Vector2d(0.0, 5.0)},
                  .planner = make_planner("rrtconnect")};
  const Plan refused = plan_and_check(query);
  EXPECT_EQ(refused.status(), PlanStatus::solved);
  EXPECT_FALSE(refused.is_proved());
  EXPECT_EQ(refused.survey->leaving.front().part, "base");
  query.survey->allow_outside = {"base"};
  EXPECT_TRUE(plan_and_check(query).is_proved());
  query.survey = std::nullopt;
  const Plan plain = plan_and_check(query);
  EXPECT_TRUE(plain.is_proved());
  EXPECT_FALSE(plain.survey.has_value());
}

TEST(PlanAndCheck, AStepLargerThanTheWayIsReported) {
  const ConfigurationSpace space(load_robot("planar2"), FreeSpaceMap({.resolution = 0.1}).snapshot(),
                                 anywhere_but_occupied());
  const Eigen::Vector2d start(0.0, 0.0), goal(0.6, 0.3);
  const auto explained = [&](const Eigen::Vector2d& to, const BeamOptions& options) {
    return plan_and_check(
               {.space = space, .start = start, .goals = {to}, .planner = std::make_shared<Beam>(options)})
        .explanation();
  };
  const std::string warning = "The step (option 'step' or 'step_deg') is larger than the way, 0.671: ";
  EXPECT_EQ(explained(goal, {.step_deg = {180.0}}),
            "Reached the goal box in 0 steps. " + warning + "all of it is the last segment.");
  EXPECT_EQ(explained(goal, {.step_deg = {180.0}, .last_segment = false}),
            "Reached the goal box in 0 steps. " + warning + "the path ends where it starts.");
  EXPECT_EQ(explained(goal, {.step_deg = {5.0}}).find("larger than the way"), std::string::npos);
  EXPECT_EQ(explained(start, {.step_deg = {180.0}}), "Reached the goal box in 0 steps.");
}

/// A planner of a user's own, which gives what it is made with.
class Given : public Planner {
 public:
  explicit Given(std::vector<Configuration> path, PlanStatus status = PlanStatus::solved)
      : Planner("given", {}), path_(std::move(path)), status_(status) {}
  PlanResult plan(const PlanProblem& /*problem*/) const override {
    PlanResult result;
    result.status = status_;
    result.waypoints = path_;
    result.cost = std::nan("");
    return result;
  }

 private:
  std::vector<Configuration> path_;
  PlanStatus status_;
};

TEST(PlanAndCheck, APlannerThatDoesNotReachWhatItWasAskedIsNotBelieved) {
  const ConfigurationSpace space = walled_space();
  const auto planned = [&](const std::vector<Configuration>& path, PlanStatus status = PlanStatus::solved) {
    return plan_and_check({.space = space,
                           .start = left,
                           .goals = {right},
                           .planner = std::make_shared<Given>(path, status),
                           .survey = {},
                           .advice_time = 0.0});
  };
  const Plan sound = planned({left, above, right});
  EXPECT_TRUE(sound.is_proved()) << sound.explanation() << sound.validation.first_contact;
  EXPECT_EQ(sound.legs[0].cost,
            path_cost({.space = space, .start = left, .goals = {right}})({left, above, right}));
  EXPECT_FALSE(planned({left, above, right}, PlanStatus::no_path).is_proved());
  const VoxelScene two{
      0.05, {}, {{Eigen::Vector3d(0, 0, 0), 0.5}, {Eigen::Vector3d(2, 0, 0), 0.5}}, {"base"}};
  const ConfigurationSpace gap(load_robot("point"), two.snapshot());
  const double nan = std::nan("");
  const Configuration aside = right + Eigen::Vector2d(0.0, 1e-3), lost = Eigen::Vector2d(nan, 1.0);
  const std::vector<std::vector<Configuration>> wrong = {
      {},
      {left},
      {right, right},
      {left, left},
      {right, above, left},
      {left, above, aside},
      {aside, right},
      {left, Configuration(Eigen::Vector3d::Zero()), right},
      {left, lost, right},
      {Configuration(), right}};
  for (const std::vector<Configuration>& path : wrong) {
    const Plan plan = planned(path);
    EXPECT_EQ(plan.status(), PlanStatus::no_path);
    EXPECT_FALSE(plan.is_proved());
    EXPECT_EQ(plan.explanation().find("Planner 'given' gave a path that is none: "), 0U)
        << plan.explanation();
    EXPECT_TRUE(plan.waypoints().empty());
    const Plan advised = plan_and_check(  // which asks the planner once more
        {.space = gap, .start = left, .goals = {right}, .planner = std::make_shared<Given>(path)});
    EXPECT_EQ(advised.status(), PlanStatus::no_path) << advised.explanation();
  }
}

/// Whose answer is read and costed here, which is none of its time.
class InAProcess : public Planner {
 public:
  explicit InAProcess(ProcessTime took) : Planner("external", {}), took_(took) {}
  PlanResult plan(const PlanProblem& problem) const override {
    PlanResult result;
    result.status = PlanStatus::solved;
    result.waypoints = {problem.start, problem.goal};
    for (int i = 0; i < 20'000; ++i) result.cost = problem.cost(result.waypoints);
    result.process_time = took_;
    return result;
  }

 private:
  ProcessTime took_;
};

TEST(PlanAndCheck, TimesOfAPlannerInAProcessOfItsOwnAreThatProcesss) {
  const ConfigurationSpace space = walled_space();
  const auto planned = [&](const ProcessTime& took) {
    return plan_and_check({.space = space,
                           .start = left,
                           .goals = {above, right},
                           .planner = std::make_shared<InAProcess>(took),
                           .survey = {},
                           .advice_time = 0.0});
  };
  const Plan plan = planned({1e-6, 2e-6});
  EXPECT_EQ(plan.legs.size(), 2U);
  EXPECT_DOUBLE_EQ(plan.time_s, 2e-6);
  EXPECT_DOUBLE_EQ(plan.cpu_s, 4e-6);
  EXPECT_GT(planned({std::nan(""), 1e-6}).time_s, 1e-5);
}

double total(const WorkTimes& work) {
  return work.search.value_or(0.0) + work.shortcuts.value_or(0.0) + work.proofs.value_or(0.0);
}

TEST(PlanAndCheck, SplitsTheCpuOfALegByTheWorkThatAPlannerHas) {
  const ConfigurationSpace space = walled_space();
  struct Expected {
    const char* planner;
    bool has_shortcuts, has_proofs;
  };
  for (const auto& [name, has_shortcuts, has_proofs] :
       {Expected{"auto", true, true}, Expected{"rrtconnect", true, true},
        Expected{"boundary_plus", true, true}, Expected{"beam_guided", true, true},
        Expected{"est", true, true}, Expected{"rrtconnect_ompl", true, true}, Expected{"beam", false, true},
        Expected{"beam_reference", false, true}, Expected{"boundary", false, true},
        Expected{"constraint", false, true}, Expected{"rrtconnect_fcl", true, false}}) {
    SCOPED_TRACE(name);
    PlanQuery query{
        .space = space, .start = left, .goals = {above, right}, .planner = make_planner(name, {})};
    query.advice_time = 0.0;
    const Plan without = plan_and_check(query);
    query.splits_cpu = true;
    const Plan plan = plan_and_check(query);
    EXPECT_EQ(plan.waypoints(), without.waypoints());
    double cpu = 0.0;
    for (const PlanResult& leg : plan.legs) {
      cpu += total(leg.work);
      EXPECT_TRUE(leg.work.search.has_value());
      EXPECT_EQ(leg.work.shortcuts.has_value(), has_shortcuts && leg.status == PlanStatus::solved);
      EXPECT_EQ(leg.work.proofs.has_value(), has_proofs);
    }
    EXPECT_NEAR(cpu, plan.cpu_s, 1e-9 * plan.cpu_s);
    for (const PlanResult& leg : without.legs) EXPECT_EQ(leg.work.search, std::nullopt);
  }
}

TEST(PlanAndCheck, KnowsNothingOfWhatAProcessOfItsOwnWorksOn) {
  const ConfigurationSpace space = walled_space();
  const Plan plan = plan_and_check({.space = space,
                                    .start = left,
                                    .goals = {above},
                                    .planner = std::make_shared<InAProcess>(ProcessTime{1.0, 2.0}),
                                    .splits_cpu = true});
  EXPECT_EQ(plan.cpu_s, 2.0);
  EXPECT_EQ(plan.legs[0].work.search, std::nullopt);
}

/// The step to the exact goal is not free: the search ends in the goal's box, as the paper has it, which the
/// plan says and `check` refuses.
TEST(PlanAndCheck, ABeamMayEndInTheBoxOfItsGoal) {
  const VoxelScene scene{0.05, {box_of(0.9, -0.5, -0.1, 1.1, 0.5, 0.1)}, {}, {}};
  const ConfigurationSpace space{load_robot("point"), scene.snapshot(), anywhere_but_occupied(), {}};
  const Plan plan =
      plan_and_check({.space = space,
                      .start = left,
                      .goals = {right},
                      .planner = std::make_shared<Beam>(BeamOptions{.step = {0.3}, .last_segment = false})});
  ASSERT_EQ(plan.status(), PlanStatus::solved) << plan.explanation();
  ASSERT_GT(plan.legs[0].final_distance, 0.01);
  EXPECT_TRUE(plan.is_proved());
  EXPECT_EQ(plan.end_violation(true), "");
  EXPECT_NE(plan.end_violation().find("goal 1 of 1: the path ends its leg"), std::string::npos);
  Plan other = plan;
  other.planner = "auto";
  EXPECT_FALSE(other.is_proved());
  other = plan;
  other.goals[0].y() += 0.3;  // farther than the search says
  EXPECT_FALSE(other.is_proved());
}

TEST(PlanAndCheck, APlanWhosePathMissesItsOwnWordsIsNotProved) {
  const ConfigurationSpace space = walled_space();
  const Plan plan = plan_and_check({.space = space, .start = left, .goals = {above, right}});
  ASSERT_TRUE(plan.is_proved()) << plan.explanation();
  EXPECT_EQ(plan.end_violation(), "");
  Plan cut = plan;
  cut.legs.pop_back();
  EXPECT_FALSE(cut.is_proved());
  EXPECT_EQ(cut.end_violation(), "goals: expected a leg to each of 2, the path has 1");
  Plan elsewhere = plan;
  elsewhere.start.x() -= 0.5;
  EXPECT_EQ(elsewhere.end_violation(), "start: the path begins 0.5 (rad or m) from it");
  elsewhere = plan;
  elsewhere.goals[0].y() += 0.25;
  EXPECT_EQ(elsewhere.end_violation(), "goal 1 of 2: the path ends its leg 0.25 (rad or m) from it");
  elsewhere.goals.clear();  // a path whose file says no goal claims none
  EXPECT_EQ(elsewhere.end_violation(), "");
}

/// Forces at q of a robot whose base is turned by `map_from_base`, under gravity (map frame) and a load.
Eigen::VectorXd forces(const Eigen::Matrix3d& map_from_base, const Eigen::Vector3d& gravity, double payload,
                       const Configuration& q) {
  Robot robot = load_robot("puma560");
  robot.map_from_base.linear() = map_from_base;
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot());
  return path_cost({.space = space, .start = q, .goals = {q}, .payload = payload, .gravity = gravity})
      .generalized_forces(q);
}

const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
const Eigen::Matrix3d on_the_wall =
    Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();

Configuration pose() {
  Configuration q(6);
  q << 0.3, -0.6, 0.4, 0.2, 0.5, 0.1;
  return q;
}

TEST(PlanAndCheck, TurningTheBaseAndGravityAlikeChangesNoForce) {
  const Eigen::Vector3d down(0, 0, -9.81);
  const Eigen::VectorXd floor = forces(upright, down, 1.0, pose());
  EXPECT_TRUE(forces(on_the_wall, on_the_wall * down, 1.0, pose()).isApprox(floor, 1e-9));
}

TEST(PlanAndCheck, GravityIsThatOfTheMapSoThatAnArmOnTheWallHasToHoldItselfAboutItsFirstAxis) {
  Robot robot = load_robot("puma560");
  for (Joint& joint : robot.joints) joint.friction = 0.0;
  const Eigen::Vector3d down(0, 0, -9.81);
  const PathCost upright_cost(robot, {.gravity = down});
  const PathCost wall_cost(robot, {.gravity = on_the_wall.transpose() * down});
  EXPECT_NEAR(upright_cost.generalized_forces(pose())[0], 0.0, 1e-9);
  EXPECT_GT(wall_cost.generalized_forces(pose())[0], 1.0);
  EXPECT_GT(forces(on_the_wall, down, 0.0, pose())[0], forces(upright, down, 0.0, pose())[0] + 1.0);
}

TEST(PlanAndCheck, APayloadCostsAndNoGravityCostsNothing) {
  const Eigen::Vector3d down(0, 0, -9.81);
  EXPECT_GT(forces(upright, down, 2.0, pose())[1], forces(upright, down, 0.0, pose())[1]);
  EXPECT_NEAR(forces(upright, Eigen::Vector3d::Zero(), 2.0, pose()).norm(), 0.0, 1e-12);
}

}  // namespace plan_and_check_test
}  // namespace clearway
