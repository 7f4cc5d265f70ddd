#include "planning/boundary/boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/walled_robot.hpp"

namespace clearway {
namespace boundary_test {

using Eigen::Vector2d;

using worlds::walls;

/// The point robot (a disc of 0.2 m) among walls, on the plane z = 0.
using Field = worlds::WalledRobot;

/// Every edge certified, and the separation kept: never below d_s by more than what one step can add to the
/// linearised damper.
void expect_contract(const Field& field, const PlanResult& result, const Configuration& goal) {
  ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
  EXPECT_EQ(result.waypoints.back(), goal);
  ASSERT_TRUE(field.is_certified(result.waypoints));
  EXPECT_NEAR(result.cost, field.cost(result.waypoints), 1e-9);
  const auto& figures = result.statistics;
  EXPECT_GE(figures.at("least_separation_m"),
            figures.at("security_distance_m") - 0.2 * figures.at("max_step"));
}

const PlannerOptions unanticipated = {{"enter_ratio", "0"}, {"leave_ratio", "1"}};    // section 3
const PlannerOptions anticipated = {{"enter_ratio", "0.3"}, {"leave_ratio", "0.8"}};  // section 4

PlannerOptions on_side(PlannerOptions options, const char* side) {
  options["side"] = side;
  return options;
}

TEST(Boundary, Figure5EitherSideLeadsRoundAnObstacle) {
  const Field field(load_robot("point"), walls({box_of(1, -0.6, -0.05, 1.1, 0.9, 0.05)}));
  const Vector2d start(0.0, 0.0), goal(2.5, 0.05);
  EXPECT_EQ(field.plan("constraint", start, goal).status, PlanStatus::no_path);
  for (const PlannerOptions& options : {unanticipated, anticipated}) {
    const PlanResult upper = field.plan("boundary", start, goal, on_side(options, "upper"));
    const PlanResult lower = field.plan("boundary", start, goal, on_side(options, "lower"));
    expect_contract(field, upper, goal);
    expect_contract(field, lower, goal);
    const auto highest = [](const PlanResult& result) {
      double y = -10.0;
      for (const Configuration& q : result.waypoints) y = std::max(y, q[1]);
      return y;
    };
    EXPECT_GT(highest(upper), 0.9);  // one goes over the wall's upper end, the other under its lower one
    EXPECT_LT(highest(lower), 0.2);
    EXPECT_EQ(upper.statistics.at("deadlocks"), 1.0);
    EXPECT_EQ(upper.statistics.at("constraint_switches"), 0.0);
  }
}

int count_of(const PlanResult& result, PathPhase phase) {
  return static_cast<int>(std::count_if(result.origins.begin(), result.origins.end(),
                                        [&](const WaypointOrigin& origin) { return origin.phase == phase; }));
}

/// The local method always comes nearer to the goal (section 3.3): what leads away is a step along a
/// boundary.
TEST(Boundary, MarksTheWaypointsWhereABoundaryWasFollowed) {
  const Field field(load_robot("point"), walls({box_of(1, -0.6, -0.05, 1.1, 0.9, 0.05)}));
  const Vector2d goal(2.5, 0.05);
  for (const PlannerOptions& options : {unanticipated, anticipated}) {
    const PlanResult result = field.plan("boundary", Vector2d(0.0, 0.0), goal, options);
    int away = 0;
    ASSERT_EQ(result.origins.size(), result.waypoints.size());
    EXPECT_EQ(result.origins.front(), WaypointOrigin{});
    EXPECT_EQ(count_of(result, PathPhase::free_motion), result.statistics.at("steps_local"));
    EXPECT_EQ(count_of(result, PathPhase::boundary), result.statistics.at("steps_boundary"));
    EXPECT_GT(result.statistics.at("steps_boundary"), 5.0);
    for (std::size_t i = 1; i < result.waypoints.size(); ++i) {
      const WaypointOrigin& origin = result.origins[i];
      EXPECT_EQ(origin.search_step, static_cast<int>(i));
      const double nearer = (goal - result.waypoints[i - 1]).norm() - (goal - result.waypoints[i]).norm();
      if (nearer < 0.0) {
        ++away;
        EXPECT_TRUE(origin.phase == PathPhase::boundary) << i;
      }
      EXPECT_EQ(origin.constraint.empty(), origin.phase != PathPhase::boundary) << i;
      if (!origin.constraint.empty()) {
        EXPECT_NE(origin.constraint.find("near what blocks it"), std::string::npos) << origin.constraint;
      }
    }
    EXPECT_GT(away, 5);
  }
  const PlanResult stuck = field.plan("constraint", Vector2d(0.0, 0.0), goal);
  EXPECT_EQ(stuck.origins.size(), stuck.explored.size());
}

TEST(Boundary, Figure4AnEnclosedGoalIsReportedAfterOneRound) {
  const Field field(load_robot("point"),
                    walls({box_of(1, -1, -.05, 1.1, 1, .05), box_of(2.9, -1, -.05, 3, 1, .05),
                           box_of(1, -1, -.05, 3, -.9, .05), box_of(1, .9, -.05, 3, 1, .05)}));
  for (const PlannerOptions& options : {unanticipated, anticipated}) {
    for (const char* side : {"upper", "lower"}) {
      const PlanResult result =
          field.plan("boundary", Vector2d(0.0, 0.0), Vector2d(2.0, 0.0), on_side(options, side));
      EXPECT_EQ(result.status, PlanStatus::no_path);
      EXPECT_NE(result.explanation.find("came back to the deadlock point"), std::string::npos)
          << result.explanation;
      EXPECT_LT(result.search_steps, 1000);
      EXPECT_TRUE(result.waypoints.empty());
      EXPECT_FALSE(result.explored.empty());
    }
  }
  const PlanResult all = field.plan("boundary_sides", Vector2d(0.0, 0.0), Vector2d(2.0, 0.0));
  EXPECT_EQ(all.status, PlanStatus::no_path);
  EXPECT_EQ(all.statistics.at("tries"), 4.0);
}

/// Fig. 11: a wall in the way; a second one that stops the robot on its way along the first (point B); a
/// third one before the goal.
VoxelScene figure_11() {
  return walls({box_of(1, -0.6, -.05, 1.1, 0.8, .05), box_of(-0.6, 0.7, -.05, 1.1, 0.8, .05),
                box_of(2.2, -0.8, -.05, 2.4, 0.8, .05)});
}

TEST(Boundary, Figure11TwoDeadlocksAndAConstraintSwitch) {
  const Field field(load_robot("point"), figure_11());
  const Vector2d start(0.0, 0.0), goal(3.5, 0.0);
  const PlanResult local = field.plan("constraint", start, goal);
  EXPECT_EQ(local.status, PlanStatus::no_path);
  EXPECT_NE(local.explanation.find("Deadlock"), std::string::npos);
  for (const PlannerOptions& options : {unanticipated, anticipated}) {
    const PlanResult result = field.plan("boundary", start, goal, on_side(options, "upper"));
    expect_contract(field, result, goal);
    EXPECT_EQ(result.statistics.at("deadlocks"), 2.0);
    EXPECT_GE(result.statistics.at("constraint_switches"), 1.0);
    EXPECT_GT(result.statistics.at("steps_boundary"), 20.0);
    EXPECT_GT(result.statistics.at("steps_local"), 20.0);
  }
}

TEST(Boundary, AnticipationSavesSteps) {
  const Field field(load_robot("point"), figure_11());
  const Vector2d start(0.0, 0.0), goal(3.5, 0.0);
  EXPECT_LT(field.plan("boundary", start, goal, anticipated).search_steps,
            field.plan("boundary", start, goal, unanticipated).search_steps);
}

TEST(Boundary, IsCompleteForThePointRobotAmongRandomRectangles) {
  // Walls far enough apart for the disc to pass between any two: a path exists, on either side.
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int deadlocks = 0;
  for (int trial = 0; trial < 12; ++trial) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (int i = 0; i < 3; ++i) {
      for (int k = -1; k <= 1; ++k) {
        const double x = 1.2 + 1.6 * i + 0.2 * uniform(random), y = 1.8 * k + 0.2 * uniform(random);
        boxes.push_back(box_of(x, y - 0.2 - 0.3 * uniform(random), -0.05, x + 0.1 + 0.4 * uniform(random),
                               y + 0.2 + 0.3 * uniform(random), 0.05));
      }
    }
    const Field field(load_robot("point"), walls(boxes));
    const Vector2d start(0.2, -0.5 + uniform(random)), goal(6.2, -0.5 + uniform(random));
    for (const char* side : {"upper", "lower"}) {
      for (const char* enter : {"0", "0.3"}) {
        const PlanResult result = field.plan("boundary", start, goal,
                                             {{"side", side}, {"enter_ratio", enter}, {"leave_ratio", "1"}});
        expect_contract(field, result, goal);
        deadlocks += static_cast<int>(result.statistics.at("deadlocks"));
      }
    }
  }
  EXPECT_GT(deadlocks, 10);
}

/// Which cells of a grid over two joints a walk through free cells can reach from `start`.
class FloodFill {
 public:
  FloodFill(const ConfigurationSpace& space, const Vector2d& start) : reached_(side * side, false) {
    std::vector<std::pair<int, int>> open = {cell(start)};
    std::vector<bool> seen(side * side, false);
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (i < 0 || j < 0 || i >= side || j >= side || seen[static_cast<std::size_t>(i * side + j)]) continue;
      seen[static_cast<std::size_t>(i * side + j)] = true;
      if (!space.is_free(Vector2d((i - side / 2) * step, (j - side / 2) * step))) continue;
      reached_[static_cast<std::size_t>(i * side + j)] = true;
      for (const auto& next : {std::pair{i + 1, j}, {i - 1, j}, {i, j + 1}, {i, j - 1}}) open.push_back(next);
    }
  }
  bool reaches(const Vector2d& q) const {
    const auto [i, j] = cell(q);
    return reached_[static_cast<std::size_t>(i * side + j)];
  }

 private:
  static constexpr int side = 167;
  static constexpr double step = 0.04;
  static std::pair<int, int> cell(const Vector2d& q) {
    return {static_cast<int>(std::lround(q[0] / step)) + side / 2,
            static_cast<int>(std::lround(q[1] / step)) + side / 2};
  }
  std::vector<bool> reached_;
};

TEST(Boundary, IsCompleteForTwoJointsWhereAFloodFillFindsAWay) {
  // Section 3 form. The flood fill keeps the security distance, as the method does.
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Robot robot = load_robot("planar2");
  int possible = 0, local = 0;
  for (int scene = 0; scene < 5; ++scene) {
    std::vector<Eigen::AlignedBox3d> boxes;
    while (boxes.size() < 8) {
      const double x = 1.8 * uniform(random), y = 1.8 * uniform(random);
      if (std::max(std::abs(x), std::abs(y)) < 0.6) continue;
      boxes.push_back(
          box_of(x, y, -0.1, x + 0.3 + 0.2 * uniform(random), y + 0.3 + 0.2 * uniform(random), 0.1));
    }
    const Field field(robot, walls(boxes));
    SpaceOptions padded;
    padded.padding = 0.025;
    const ConfigurationSpace apart(robot, walls(boxes).snapshot(), Field::policies(), padded);
    const auto free_place = [&] {
      for (;;) {
        const Vector2d q(2.8 * uniform(random), 2.5 * uniform(random));
        if (apart.is_free(q)) return q;
      }
    };
    for (int query = 0; query < 5; ++query) {
      const Vector2d start = free_place(), goal = free_place();
      if (!FloodFill(apart, start).reaches(goal)) continue;
      ++possible;
      local += field.plan("constraint", start, goal).status == PlanStatus::solved ? 1 : 0;
      for (const char* side : {"upper", "lower"}) {
        expect_contract(field, field.plan("boundary", start, goal, on_side(unanticipated, side)), goal);
      }
    }
  }
  EXPECT_GT(possible, 10);
  EXPECT_LT(local, possible);  // the local step alone is not
}

TEST(Boundary, TheLeaveRatioOfSection4GivesUpRoundAnObstacleFarFromTheGoal) {
  // 0.8 d_lock lies beyond the obstacle: the robot goes round it once and reports no path; 1.0 finds one.
  const Field field(load_robot("point"), walls({box_of(1, -0.5, -0.05, 1.3, 0.5, 0.05)}));
  const Vector2d start(0.0, 0.0), goal(9.0, 0.0);
  const PlanResult given_up = field.plan("boundary", start, goal, anticipated);
  EXPECT_EQ(given_up.status, PlanStatus::no_path);
  EXPECT_NE(given_up.explanation.find("leave_ratio 0.8"), std::string::npos) << given_up.explanation;
  expect_contract(field, field.plan("boundary", start, goal, {{"leave_ratio", "1"}}), goal);
  const PlanResult retried = field.plan("boundary_sides", start, goal);
  expect_contract(field, retried, goal);
  EXPECT_EQ(retried.statistics.at("tries"), 3.0);
}

TEST(Boundary, WithoutObstaclesItGoesStraight) {
  const Field field(load_robot("point"), walls({}));
  for (const char* planner : {"boundary", "constraint"}) {
    const Vector2d start(0.0, 0.0), goal(1.0, -0.5);
    const PlanResult result = field.plan(planner, start, goal, {{"max_step", "0.05"}});
    expect_contract(field, result, goal);
    EXPECT_EQ(result.search_steps, static_cast<int>(std::ceil(goal.norm() / 0.05)));
    for (const Configuration& q : result.waypoints) EXPECT_NEAR(q[0] * goal[1] - q[1] * goal[0], 0.0, 1e-12);
    const PlanResult nothing = field.plan(planner, goal, goal);
    EXPECT_EQ(nothing.status, PlanStatus::solved);
    EXPECT_EQ(nothing.waypoints.size(), 1u);
  }
}

TEST(Boundary, JointLimitsAreBoundariesToo) {
  Robot robot = load_robot("point");
  robot.joints[0].lower = robot.joints[1].lower = -3.0;
  robot.joints[0].upper = 3.0, robot.joints[1].upper = 0.9;  // no room above the wall's upper end
  const Field field(robot, walls({box_of(1, -0.6, -0.05, 1.1, 0.9, 0.05)}));
  const PlanResult result = field.plan("boundary", Vector2d(0.0, 0.0), Vector2d(2.5, 0.05));
  for (const Configuration& q : result.explored) EXPECT_LE(q[1], 0.9);
  // Turned back at the limit, it goes round the lower end: left-hand boundary following in a bounded plane.
  expect_contract(field, result, Vector2d(2.5, 0.05));
  EXPECT_GE(result.statistics.at("constraint_switches"), 1.0);
}

TEST(Boundary, OneJointHasNoWayRound) {
  Robot robot;
  Joint slide;
  slide.name = "x", slide.kind = JointKind::prismatic, slide.axis = Eigen::Vector3d::UnitX();
  slide.lower = -5.0, slide.upper = 5.0;
  robot.joints = {slide};
  Link root, link;
  root.name = "root", link.name = "link", link.parent = 0, link.joint = 0;
  robot.links = {root, link};
  robot.bodies = {
      {"ball", 1, Eigen::Isometry3d::Identity(), Shape::sphere(0.1), {{Eigen::Vector3d::Zero(), 0.1}}}};
  robot.tip_link = 1;
  const Field field(robot, walls({box_of(1, -0.2, -0.2, 1.1, 0.2, 0.2)}));
  const PlanResult result =
      field.plan("boundary", Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, 2.0));
  EXPECT_EQ(result.status, PlanStatus::no_path);
  EXPECT_NE(result.explanation.find("one joint"), std::string::npos) << result.explanation;
}

TEST(Boundary, SolvesForAnArmWhatTheLocalMethodCannot) {
  // A post before a planar arm of full size; both planners with their defaults.
  const Field field(load_robot("planar2"), walls({box_of(1.2, 0.5, -0.1, 1.3, 0.6, 0.1)}));
  const Vector2d start(0.0, 0.3), goal(1.2, 0.3);
  EXPECT_EQ(field.plan("constraint", start, goal).status, PlanStatus::no_path);
  int solved = 0;
  for (const char* side : {"upper", "lower"}) {
    const PlanResult result = field.plan("boundary", start, goal, {{"side", side}});
    if (result.status != PlanStatus::solved) continue;
    ++solved;
    expect_contract(field, result, goal);
  }
  EXPECT_GE(solved, 1);
}

TEST(Boundary, DefaultsWorkForAMiniatureAsForTheFullSize) {
  const Robot full = load_robot("puma560");
  const Eigen::VectorXd start = (Eigen::VectorXd(6) << -0.6, -0.8, 0.3, 0.0, 0.4, 0.0).finished();
  const Eigen::VectorXd goal = (Eigen::VectorXd(6) << 1.2, -0.9, 0.5, 0.3, 0.2, 0.4).finished();
  std::vector<double> steps;
  for (const double scale : {1.0, 0.1}) {
    VoxelScene scene;
    scene.resolution = 0.02 * scale;
    scene.occupied = {box_of(0.35 * scale, 0.15 * scale, 0.0, 0.5 * scale, 0.6 * scale, 0.5 * scale)};
    const Field field(scaled(full, scale), scene);
    const PlanResult result = field.plan("boundary", start, goal);
    expect_contract(field, result, goal);
    steps.push_back(result.search_steps);
  }
  EXPECT_NEAR(steps[0], steps[1], 2.0);
}

TEST(Boundary, IsDeterministic) {
  const Field field(load_robot("point"), figure_11());
  const Vector2d start(0.0, 0.0), goal(3.5, 0.0);
  const PlanResult first = field.plan("boundary", start, goal), second = field.plan("boundary", start, goal);
  EXPECT_EQ(first.waypoints, second.waypoints);
  EXPECT_EQ(first.statistics, second.statistics);
}

TEST(Boundary, StopsWhenOutOfTimeAndAtMaxSteps) {
  const Field field(load_robot("point"), walls({}));
  int asked = 0;
  const PlanProblem problem{field.space,     field.cost, Vector2d(0, 0),
                            Vector2d(50, 0), 1,          [&] { return ++asked > 7; }};
  for (const char* planner : {"boundary", "constraint"}) {
    asked = 0;
    const PlanResult result = make_planner(planner)->plan(problem);
    EXPECT_EQ(result.status, PlanStatus::timed_out);
    EXPECT_EQ(result.explored.size(), 8u);
    const PlanResult limited = field.plan(planner, Vector2d(0, 0), Vector2d(50, 0), {{"max_steps", "5"}});
    EXPECT_EQ(limited.status, PlanStatus::no_path);
    EXPECT_NE(limited.explanation.find("max_steps"), std::string::npos);
  }
}

TEST(Boundary, InvalidEndsAreReportedInASentence) {
  const Field field(load_robot("point"), figure_11());
  for (const char* planner : {"boundary", "boundary_sides", "constraint"}) {
    EXPECT_EQ(field.plan(planner, Vector2d(1.05, 0), Vector2d(0, 0)).status, PlanStatus::start_invalid);
    EXPECT_EQ(field.plan(planner, Vector2d(0, 0), Vector2d(1.05, 0)).status, PlanStatus::goal_invalid);
  }
}

}  // namespace boundary_test
}  // namespace clearway
