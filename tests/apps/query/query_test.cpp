#include "apps/query/query.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <numbers>
#include <stdexcept>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace query_test {

/// Forces at q of a robot whose base is turned by `map_from_base`, under gravity (map frame) and a load.
Eigen::VectorXd forces(const Eigen::Matrix3d& map_from_base, const Eigen::Vector3d& gravity, double payload,
                       const Configuration& q) {
  Robot robot = load_robot("puma560");
  robot.map_from_base.linear() = map_from_base;
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot());
  Query query{space, "puma560", {}, {}, q, {q}, "beam", {}};
  query.gravity = gravity;
  query.payload = payload;
  return path_cost(query).generalized_forces(q);
}

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Query, AnOptionIsGivenOnceAndWithAValue) {
  EXPECT_EQ(choose_planner_options({"width=5", "step=0.1,0.2"}),
            (PlannerOptions{{"width", "5"}, {"step", "0.1,0.2"}}));
  EXPECT_EQ(complaint([] { choose_planner_options({"width="}); }),
            "--set width=: no value is given, expected width=value");
  EXPECT_EQ(complaint([] {
              choose_planner_options({"width=5", "step=1", "width=6"});
            }),
            "--set: option 'width' is given twice, as '5' and as '6', expected it once");
}

TEST(Query, AWrongPolicyIsToldWithItsFlagItsPartAndThoseThatThereAre) {
  const Robot robot = load_robot("point");
  EXPECT_EQ(complaint([&] { choose_policies({"base=free"}, robot); }),
            "--policy base=free: unknown policy 'free': expected painted, known_free or not_occupied");
  EXPECT_EQ(complaint([&] { choose_policies({"free"}, robot); }),
            "--policy free: unknown policy 'free': expected painted, known_free or not_occupied");
}

TEST(Query, AStepLargerThanTheWayIsTold) {
  Policies policies;
  policies.critical_by_default = false;
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot(), policies);
  const Eigen::Vector2d start(0.0, 0.0), goal(0.6, 0.3);
  const auto explained = [&](const Eigen::Vector2d& to, const PlannerOptions& options) {
    return solve({space, "planar2", {}, {}, start, {to}, "beam", options}).explanation();
  };
  const std::string told = "The step (option 'step' or 'step_deg') is larger than the way, 0.671: ";
  EXPECT_EQ(explained(goal, {{"step_deg", "180"}}),
            "Reached the goal box in 0 steps. " + told + "all of it is the last segment.");
  EXPECT_EQ(explained(goal, {{"step_deg", "180"}, {"last_segment", "false"}}),
            "Reached the goal box in 0 steps. " + told + "the path ends where it starts.");
  EXPECT_EQ(explained(goal, {{"step_deg", "5"}}).find("larger than the way"), std::string::npos);
  EXPECT_EQ(explained(start, {{"step_deg", "180"}}), "Reached the goal box in 0 steps.");
}

TEST(Query, AGoalThatABeamComesNearAndDoesNotReachIsToldBesideTheVerdict) {
  Policies policies;
  policies.critical_by_default = false;
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.1}).snapshot(), policies);
  const auto goal_row = [&](const char* last_segment) {
    const Plan plan = solve({space,
                             "planar2",
                             {},
                             {},
                             Eigen::Vector2d(0.0, 0.0),
                             {Eigen::Vector2d(0.6, 0.31)},
                             "beam",
                             {{"step", "0.1"}, {"last_segment", last_segment}}});
    for (const auto& [name, text] : plan_figures(plan)) {
      if (name == "goal 1") return text;
    }
    return std::string();
  };
  EXPECT_EQ(goal_row("true"), "");
  EXPECT_NE(goal_row("false").find("check refuses the plan without --accept-goals"), std::string::npos);
}

const Eigen::Matrix3d upright = Eigen::Matrix3d::Identity();
const Eigen::Matrix3d on_the_wall =
    Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix();

Configuration pose() {
  Configuration q(6);
  q << 0.3, -0.6, 0.4, 0.2, 0.5, 0.1;
  return q;
}

TEST(Query, TurningTheBaseAndGravityAlikeChangesNoForce) {
  const Eigen::Vector3d down(0, 0, -9.81);
  const Eigen::VectorXd floor = forces(upright, down, 1.0, pose());
  EXPECT_TRUE(forces(on_the_wall, on_the_wall * down, 1.0, pose()).isApprox(floor, 1e-9));
}

TEST(Query, GravityIsThatOfTheMapSoThatAnArmOnTheWallHasToHoldItselfAboutItsFirstAxis) {
  Robot robot = load_robot("puma560");
  for (Joint& joint : robot.joints) joint.friction = 0.0;
  const Eigen::Vector3d down(0, 0, -9.81);
  const PathCost upright_cost(robot, {.gravity = down});
  const PathCost wall_cost(robot, {.gravity = on_the_wall.transpose() * down});
  EXPECT_NEAR(upright_cost.generalized_forces(pose())[0], 0.0, 1e-9);
  EXPECT_GT(wall_cost.generalized_forces(pose())[0], 1.0);
  EXPECT_GT(forces(on_the_wall, down, 0.0, pose())[0], forces(upright, down, 0.0, pose())[0] + 1.0);
}

TEST(Query, APayloadCostsAndNoGravityCostsNothing) {
  const Eigen::Vector3d down(0, 0, -9.81);
  EXPECT_GT(forces(upright, down, 2.0, pose())[1], forces(upright, down, 0.0, pose())[1]);
  EXPECT_NEAR(forces(upright, Eigen::Vector3d::Zero(), 2.0, pose()).norm(), 0.0, 1e-12);
}

}  // namespace query_test
}  // namespace clearway
