#include "planning/problem/planner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace planner_test {

/// Every planner of the table, so that a newcomer faces the same tests.
class EveryPlanner : public testing::TestWithParam<std::string> {};

std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const PlannerEntry& entry : planner_table()) names.emplace_back(entry.name);
  return names;
}

/// The slow twin gets fewer and shorter problems, what improves its path fewer samples; what only looks at
/// edges here and there looks closely.
PlannerOptions brief(const std::string& planner) {
  if (planner == "bitstar_fcl") return {{"resolution", "0.0005"}, {"max_samples", "800"}};
  if (planner.ends_with("_fcl")) return {{"resolution", "0.0005"}};
  if (planner == "rrtstar") return {{"max_samples", "800"}};
  return planner == "beam_reference" ? PlannerOptions{{"width", "2"}, {"step", "0.08"}} : PlannerOptions{};
}

TEST_P(EveryPlanner, ReturnsPathsThatTheIndependentCheckAccepts) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Policies policies;
  policies.critical_by_default = false;
  int solved = 0, valid = 0;
  const auto& entry = *std::find_if(planner_table().begin(), planner_table().end(),
                                    [](const PlannerEntry& e) { return e.name == GetParam(); });
  for (const char* name : {"point", "planar2", "arm5"}) {
    const Robot robot = load_robot(name);
    const auto n = static_cast<Eigen::Index>(robot.dof());
    VoxelScene scene{
        0.05, {box_of(0.5, 0.3, -0.1, 0.8, 0.6, 0.5), box_of(-0.9, -0.7, -0.1, -0.6, -0.5, 0.4)}, {}, {}};
    const ConfigurationSpace space(robot, scene.snapshot(), policies);
    const PathCost cost(robot);
    const auto free_place = [&] {
      for (;;) {
        const Configuration q = Configuration::NullaryExpr(n, [&] { return 0.8 * uniform(random); });
        if (space.is_free(q)) return q;
      }
    };
    for (int query = 0; query < 3; ++query) {
      const Configuration start = free_place(), goal = free_place();
      const PlanResult result =
          make_planner(GetParam(), brief(GetParam()))->plan({space, cost, start, goal, 5});
      if (result.status != PlanStatus::solved) continue;
      ++solved;
      const PathVerdict verdict = check_path(robot, space.map(), space.policies(), 0.0, result.waypoints);
      valid += verdict.valid;
      EXPECT_TRUE(verdict.valid || !entry.certifies) << name << ": " << verdict.first_contact;
    }
  }
  EXPECT_GE(solved, 5);
  EXPECT_GE(3 * valid, 2 * solved) << "looks are close, but shortest paths graze";
}

TEST_P(EveryPlanner, RefusesInvalidEndsAndStartsAtAnEqualGoal) {
  Policies policies;
  policies.critical_by_default = false;
  const VoxelScene scene{0.05, {box_of(0.5, 0.3, -0.1, 0.8, 0.6, 0.5)}, {}, {}};
  const ConfigurationSpace space(load_robot("point"), scene.snapshot(), policies);
  const PathCost cost(space.robot());
  const auto planner = make_planner(GetParam());
  const Eigen::Vector2d free(0.0, 0.0), blocked(0.6, 0.4), outside(0.0, 1e6), broken(0.0, std::nan(""));
  for (const Eigen::Vector2d& bad : {blocked, outside, broken}) {
    const PlanResult start = planner->plan({space, cost, bad, free}),
                     goal = planner->plan({space, cost, free, bad});
    EXPECT_EQ(start.status, PlanStatus::start_invalid);
    EXPECT_EQ(goal.status, PlanStatus::goal_invalid);
    EXPECT_FALSE(start.explanation.empty() || goal.explanation.empty());
    EXPECT_TRUE(start.waypoints.empty() && goal.waypoints.empty());
  }
  const PlanResult nothing = planner->plan({space, cost, free, free});
  EXPECT_EQ(nothing.status, PlanStatus::solved) << nothing.explanation;
  EXPECT_EQ(nothing.waypoints.front(), free);
  EXPECT_EQ(nothing.waypoints.back(), free);
  EXPECT_EQ(nothing.cost, 0.0);
}

TEST_P(EveryPlanner, StopsWhenOutOfTime) {
  Policies policies;
  policies.critical_by_default = false;
  const VoxelScene scene{0.1,
                         {box_of(1, -1, -.05, 1.1, 1, .05), box_of(2.9, -1, -.05, 3, 1, .05),
                          box_of(1, -1, -.05, 3, -.9, .05), box_of(1, .9, -.05, 3, 1, .05)},
                         {},
                         {}};
  const ConfigurationSpace space(load_robot("point"), scene.snapshot(), policies);
  const PathCost cost(space.robot());
  int asked = 0;
  const PlanResult result =
      make_planner(GetParam())->plan({space, cost, Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 0), 1, [&] {
                                        return ++asked > 3;
                                      }});
  EXPECT_EQ(result.status, PlanStatus::timed_out) << result.explanation;
}

INSTANTIATE_TEST_SUITE_P(Table, EveryPlanner, testing::ValuesIn(planner_names()),
                         [](const auto& planner) { return planner.param; });

TEST(Planner, AnEndPastALimitIsReportedWithValueLimitAndTheUnitOfItsJoint) {
  Robot robot = load_robot("planar2");  // the second joint slides along the first link
  robot.joints[0].lower = -1.0, robot.joints[0].upper = 1.0;
  robot.joints[1].kind = JointKind::prismatic;
  robot.joints[1].axis = Eigen::Vector3d::UnitX();
  robot.joints[1].lower = -0.5, robot.joints[1].upper = 0.5;
  Policies policies;
  policies.critical_by_default = false;
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot(), policies);
  const PathCost cost(robot);
  const Eigen::Vector2d inside(0.0, 0.0), turned(2.0, 0.0), slid(0.0, -0.75);
  const std::string turn = robot.joints[0].name, slide = robot.joints[1].name;
  EXPECT_EQ(check_ends({space, cost, turned, inside}).explanation,
            "The start is not free: joint " + turn +
                " is at 2 rad (114.6 degrees), 1 rad (57.3 degrees) above its upper limit, 1 rad "
                "(57.3 degrees).");
  EXPECT_EQ(check_ends({space, cost, inside, slid}).explanation,
            "The goal is not free: joint " + slide + " is at -0.75 m, 0.25 m below its lower limit, -0.5 m.");
}

TEST(Planner, AbsurdLimitsOfASlidingJointAskForAScaleAgainstTheJointsThatTurn) {
  Robot robot = load_robot("planar2");
  robot.joints[1].kind = JointKind::prismatic;
  robot.joints[1].axis = Eigen::Vector3d::UnitX();
  robot.joints[1].lower = -1e9, robot.joints[1].upper = 1e9;
  Policies policies;
  policies.critical_by_default = false;
  VoxelScene scene{0.05, {box_of(2.0, 2.0, -0.1, 2.2, 2.2, 0.1)}, {}, {}};
  const ConfigurationSpace space(robot, scene.snapshot(), policies);
  const PathCost cost(robot);
  const PlanProblem problem{space, cost, Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.1, 0.1)};
  for (const char* planner : {"beam", "beam_guided", "boundary", "rrtconnect"}) {
    try {
      make_planner(planner)->plan(problem);
      ADD_FAILURE() << planner << " planned";
    } catch (const std::invalid_argument& error) {
      const std::string sentence = error.what();
      EXPECT_NE(sentence.find("joint '" + robot.joints[1].name + "' slides from -1e+09 to 1e+09 m"),
                std::string::npos)
          << sentence;
      EXPECT_NE(sentence.find("expected option 'prismatic_scale'"), std::string::npos) << sentence;
    }
  }
  const PlannerOptions given = {{"prismatic_scale", "1"}, {"step", "0.05"}, {"node_only", "true"}};
  EXPECT_EQ(make_planner("beam", given)->plan(problem).status, PlanStatus::solved);
}

/// Every planner refuses at once a way that nobody means, and names the same pose near the start.
TEST(Planner, AJointWithoutLimitsIsLedAHundredTurnsAtMost) {
  Robot robot = load_robot("planar2");
  robot.joints[0].lower = -HUGE_VAL, robot.joints[0].upper = HUGE_VAL;
  Policies policies;
  policies.critical_by_default = false;
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot(), policies);
  const PathCost cost(robot);
  const auto plan = [&](const std::string& planner, double start, double goal) {
    return make_planner(planner, brief(planner))
        ->plan({space, cost, Eigen::Vector2d(start, 0.1), Eigen::Vector2d(goal, 0.1), 5});
  };
  const double hundred = 200.0 * std::numbers::pi;
  for (const std::string& planner : planner_names()) {
    const PlanResult far = plan(planner, 0.5, 1.5 + hundred);
    EXPECT_EQ(far.status, PlanStatus::goal_invalid) << planner;
    EXPECT_NE(far.explanation.find("joint shoulder would make 100.159 turns from the start, expected at most "
                                   "100; the same pose is at 1.5 rad"),
              std::string::npos)
        << far.explanation;
    EXPECT_EQ(plan(planner, 0.0, -1e9).status, PlanStatus::goal_invalid) << planner;
    EXPECT_EQ(plan(planner, 1.5 + hundred, 0.5).status, PlanStatus::goal_invalid) << planner;
    EXPECT_EQ(plan(planner, 2e6, 2e6).status, PlanStatus::start_invalid) << planner;
  }
  EXPECT_EQ(plan("rrtconnect", 1e5, 1e5 + 6.0).status, PlanStatus::solved);
  EXPECT_EQ(plan("auto", 0.0, hundred - 1e-6).status, PlanStatus::solved);
}

TEST(Planner, UnknownNamesAreAnsweredWithTheNearest) {
  try {
    make_planner("bundary");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "unknown planner 'bundary': did you mean 'boundary'?");
  }
  EXPECT_THROW(make_planner("beam", {{"widht", "3"}}), std::invalid_argument);
}

TEST(Planner, PrintedOptionsMakeTheSamePlanner) {
  for (const PlannerEntry& entry : planner_table()) {
    const auto planner = entry.make({});
    EXPECT_FALSE(planner->options().empty()) << entry.name;
    EXPECT_EQ(make_planner(entry.name, planner->options())->options(), planner->options()) << entry.name;
  }
}

/// The user sees in another program that the parts are apart, and is told why they touch here.
TEST(CheckEnds, PartsThatTouchByTheHullOfAMeshAreSaidToDoSo) {
  Robot robot = worlds::whip().robot();
  const Snapshot map;
  const auto sentence = [&] {
    const ConfigurationSpace space(robot, map, {.critical_by_default = false});
    const PathCost cost(robot);
    for (double q = -1.5; q < 1.5; q += 0.01) {
      const Configuration at = Configuration::Constant(1, q);
      if (space.check(at).obstruction == Obstruction::self_collision)
        return check_ends({space, cost, at, at}).explanation;
    }
    return std::string("nothing touches");
  };
  const std::string clause = ", where a mesh counts as its convex hull";
  EXPECT_NE(sentence().find(" touches "), std::string::npos) << sentence();
  EXPECT_EQ(sentence().find(clause), std::string::npos) << sentence();
  const auto post = std::find_if(robot.bodies.begin(), robot.bodies.end(),
                                 [](const Body& body) { return body.part == "post"; });
  ASSERT_NE(post, robot.bodies.end());
  post->shape = Shape::convex({{-0.05, -0.05, -0.05}, {0.05, -0.05, -0.05}, {0, 0.05, -0.05}, {0, 0, 0.05}});
  post->cover = {{post->link_from_shape.translation(), 0.1}};
  EXPECT_NE(sentence().find(" touches "), std::string::npos) << sentence();
  EXPECT_NE(sentence().find(clause), std::string::npos) << sentence();
}

}  // namespace planner_test
}  // namespace clearway
