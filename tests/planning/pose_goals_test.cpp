#include "planning/pose_goals.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "mapping/free_space_map.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "tests/worlds/beam_world.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace pose_goals_test {

/// Some voxels round an arm, none near its base.
Snapshot clutter(Random& random, int voxels) {
  FreeSpaceMap map({.resolution = 0.05});
  for (int placed = 0; placed < voxels;) {
    const Eigen::Vector3d at = random.point(0.9);
    if (at.head<2>().norm() < 0.25) continue;
    occupy(map, at);
    ++placed;
  }
  return map.snapshot();
}

ConfigurationSpace space_of(const char* robot, const Snapshot& map) {
  return {load_robot(robot), map, anywhere_but_occupied()};
}

Configuration free_configuration(Random& random, const ConfigurationSpace& space) {
  for (;;) {
    const Configuration q = random.configuration(space.robot());
    if (space.is_free(q)) return q;
  }
}

TEST(PoseGoals, ChooseFreeConfigurationsThatReachThem) {
  Random random(12);
  int turned = 0, elsewhere = 0, blocked = 0;
  for (int round = 0; round < 60; ++round) {
    const ConfigurationSpace space = space_of(round % 2 == 0 ? "arm6" : "puma560", clutter(random, 60));
    const Configuration start = free_configuration(random, space),
                        there = random.configuration(space.robot());
    const GoalPose exact{tip_pose(space.robot(), there)};
    GoalPose loose = exact;
    if (round % 3 > 0) loose.free_axis = round % 3;
    if (round % 4 > 1) loose.position_tolerance = 0.05, loose.turn_tolerance = 0.2;
    const PoseGoals goals(space, "", {{loose, "a"}, {exact, "b"}}, start);
    const std::vector<Configuration> chosen = goals.goals();
    ASSERT_EQ(chosen.size(), 2U);
    EXPECT_TRUE(reaches(loose, tip_pose(space.robot(), chosen[0])));
    EXPECT_TRUE(reaches(exact, tip_pose(space.robot(), chosen[1])));
    // Whatever is free and exact is preferred, and the nearest of it.
    double nearest = std::numeric_limits<double>::infinity();
    for (const Configuration& q : goal_configurations(space.robot(), exact.map_from_tip, start))
      if (space.is_free(q)) nearest = std::min(nearest, (q - start).lpNorm<Eigen::Infinity>());
    const bool is_exact = reaches(exact, tip_pose(space.robot(), chosen[0]));
    if (std::isfinite(nearest)) {
      EXPECT_TRUE(space.is_free(chosen[0]));
      EXPECT_LE((chosen[0] - start).lpNorm<Eigen::Infinity>(), nearest + 1e-9);
    } else if (space.is_free(chosen[0])) {
      EXPECT_FALSE(is_exact);
      elsewhere += !loose.free_axis.has_value();
      turned += loose.free_axis.has_value();
    } else {
      ++blocked;
    }
  }
  EXPECT_GT(turned, 0);
  EXPECT_GT(elsewhere, 0);
  EXPECT_GT(blocked, 0);
}

/// A planar arm of two bars that hangs beside another: joints and links begin with `side`.
std::string bars(const std::string& side, double y) {
  const std::string turn = worlds::urdf_limit(-2, 2), at = "0 " + std::to_string(y) + " 0";
  return worlds::urdf_link(side + "1", "0.15 0 0", "<box size='0.05 0.05 0.3'/>") +
         worlds::urdf_link(side + "2", "0.12 0 0", "<box size='0.04 0.04 0.24'/>") + "<link name='" + side +
         "tip'/>" + worlds::urdf_joint(side + "j1", "revolute", "base", side + "1", at, "0 0 1", turn) +
         worlds::urdf_joint(side + "j2", "revolute", side + "1", side + "2", "0.34 0 0", "0 0 1", turn) +
         worlds::urdf_joint(side + "f", "fixed", side + "2", side + "tip", "0.25 0 0", "0 0 1", "");
}

/// Where the other arm is in the way, it goes aside.
TEST(PoseGoals, OfOneArmMoveAnotherThatIsInTheWay) {
  const RobotFolder folder;
  const Robot robot =
      load_robot(RobotRequest{folder.write("dual.urdf", "<robot name='dual'><link name='base'/>" +
                                                            bars("l", 0.2) + bars("r", -0.2) + "</robot>")});
  const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = 0.05}).snapshot(),
                                 anywhere_but_occupied());
  const Configuration start = Configuration::Zero(4);
  Configuration crossed = start;
  const auto at = [&](const std::string& name) {
    const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                    [&](const Joint& joint) { return joint.name == name; });
    return static_cast<Eigen::Index>(found - robot.joints.begin());
  };
  const auto right = [&](const Configuration& q) { return Eigen::Vector2d(q[at("rj1")], q[at("rj2")]); };
  crossed[at("lj1")] = -0.7, crossed[at("lj2")] = -0.2;
  ASSERT_TRUE(space.is_free(start));
  ASSERT_FALSE(space.is_free(crossed));
  const Robot left = with_tip(robot, "ltip");
  const GoalPose pose{tip_pose(left, crossed)};
  const PoseGoals goals(space, "ltip", {{pose, "a"}}, start);
  const Configuration goal = goals.goals().at(0);
  EXPECT_TRUE(space.is_free(goal)) << goal.transpose();
  EXPECT_TRUE(reaches(pose, tip_pose(left, goal)));
  EXPECT_NE(right(goal), right(start));
  EXPECT_EQ(PoseGoals(space, "ltip", {{pose, "a"}}, start).goals().at(0), goal);
  Configuration away = start;  // the other stays where it can
  away[at("lj1")] = 0.7, away[at("lj2")] = 0.2;
  const PoseGoals beside(space, "ltip", {{GoalPose{tip_pose(left, away)}, "b"}}, start);
  EXPECT_EQ(right(beside.goals().at(0)), right(start));
}

TEST(PoseGoals, AreOfAnyLinkAndNamedWhenOutOfReach) {
  const ConfigurationSpace space = space_of("panda", FreeSpaceMap({.resolution = 0.05}).snapshot());
  Random random(3);
  const Configuration q = free_configuration(random, space);
  const Eigen::Isometry3d there = tip_pose(with_tip(space.robot(), "link5"), q);
  const PoseGoals goals(space, "link5", {{{there}, "a"}}, Configuration::Zero(7));
  EXPECT_TRUE(tip_pose(with_tip(space.robot(), "link5"), goals.goals()[0]).isApprox(there, 1e-4));
  Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
  far.translation().z() = 9.0;
  try {
    PoseGoals(space, "", {{{there}, "--goal-pose 1"}, {{far}, "--goal-pose 2"}}, q);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("--goal-pose 2: no configuration of robot 'panda'"),
              std::string::npos)
        << error.what();
  }
}

TEST(PoseGoals, ThatAreNoPosesOrWhoseTolerancesAreNoneAreRefusedByName) {
  const ConfigurationSpace space = space_of("panda", FreeSpaceMap({.resolution = 0.05}).snapshot());
  Random random(3);
  const Configuration q = free_configuration(random, space);
  const auto sentence = [&](const std::function<void(GoalPose&)>& spoil) {
    GoalPose goal{tip_pose(space.robot(), q)};
    spoil(goal);
    try {
      PoseGoals(space, "", {{goal, "cup"}}, q);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(sentence([](GoalPose&) {}), "");
  for (const double scale : {1.0001, 2.0, -1.0})
    EXPECT_NE(sentence([&](GoalPose& goal) {
                goal.map_from_tip.linear() *= scale;
              }).find("goal pose 'cup': map_from_tip is no rigid pose"),
              std::string::npos)
        << scale;
  for (const double length : {-1e-3, std::nan(""), HUGE_VAL})
    EXPECT_NE(
        sentence([&](GoalPose& goal) { goal.position_tolerance = length; }).find("position_tolerance is"),
        std::string::npos)
        << length;
  for (const double angle : {-9.0, 4.0, std::nan("")})
    EXPECT_NE(sentence([&](GoalPose& goal) { goal.turn_tolerance = angle; }).find("turn_tolerance is"),
              std::string::npos)
        << angle;
  EXPECT_NE(sentence([](GoalPose& goal) { goal.free_axis = 7; }).find("free_axis is 7"), std::string::npos);
}

/// A branch that is free and that no path reaches, which the next one does.
TEST(PlanToPoses, GoesToAnotherBranchWhenNoPathLeadsToTheNearest) {
  Random random(17);
  const auto planner = std::make_shared<const RrtConnect>(RrtConnectOptions{.max_samples = 3000});
  int others = 0, failed = 0;
  for (int round = 0; round < 80 && others < 2; ++round) {
    const ConfigurationSpace space = space_of("arm6", clutter(random, 240));
    const Configuration start = free_configuration(random, space), there = free_configuration(random, space);
    const GoalPose pose{tip_pose(space.robot(), there)};
    const PoseGoals goals(space, "", {{pose, "a"}}, start);
    const PlanQuery query{
        .space = space, .start = start, .goals = {}, .planner = planner, .advice_time = 0.0};
    const Plan plan = plan_to_poses(query, goals);
    PlanQuery nearest = query;
    nearest.goals = goals.goals();
    const Plan alone = plan_and_check(nearest);
    ASSERT_EQ(plan.goals.size(), 1U);
    EXPECT_TRUE(reaches(pose, tip_pose(space.robot(), plan.goals[0])));
    if (alone.status() == PlanStatus::solved) {
      EXPECT_EQ(plan.waypoints(), alone.waypoints());
    } else if (plan.status() == PlanStatus::solved) {
      EXPECT_TRUE(plan.is_proved());
      EXPECT_EQ(plan.waypoints().back(), plan.goals[0]);
      EXPECT_NE(plan.goals[0], nearest.goals[0]);
      ++others;
    } else {
      EXPECT_EQ(plan.goals, nearest.goals);
      ++failed;
    }
  }
  EXPECT_GE(others, 2) << failed;
}

/// The clock, not the arm, ends the search.
TEST(PlanToPoses, SaysThatTheTimeLimitLeftConfigurationsUntried) {
  Random random(17);
  const auto planner = std::make_shared<const RrtConnect>(RrtConnectOptions{.max_samples = 1});
  int left = 0;
  for (int round = 0; round < 80 && left < 2; ++round) {
    const ConfigurationSpace space = space_of("arm6", clutter(random, 240));
    const Configuration start = free_configuration(random, space), there = free_configuration(random, space);
    PoseGoals goals(space, "", {{GoalPose{tip_pose(space.robot(), there)}, "a"}}, start);
    PlanQuery query{.space = space,
                    .start = start,
                    .goals = {},
                    .planner = planner,
                    .time_limit = 1e-9,
                    .advice_time = 0.0};
    const bool has_others = goals.has_next(0);
    const Plan plan = plan_to_poses(query, goals);
    if (plan.status() == PlanStatus::solved) continue;
    const std::string said = plan.explanation();
    EXPECT_EQ(
        said.find("left untried at the time limit of 1e-09 s (--time-limit gives more)") != std::string::npos,
        has_others)
        << said;
    if (!has_others) continue;
    EXPECT_EQ(plan.status(), PlanStatus::timed_out);
    ++left;
    query.time_limit = 10.0;
    const Plan patient = plan_to_poses(query, goals);
    EXPECT_EQ(patient.explanation().find("untried"), std::string::npos) << patient.explanation();
  }
  EXPECT_EQ(left, 2);
}

}  // namespace pose_goals_test
}  // namespace clearway
