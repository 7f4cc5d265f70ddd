// The laws that Chong et al. 2008 show in Figs. 12 to 19, in the committed experiments.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "apps/compare/compare_run.hpp"
#include "apps/query/query.hpp"
#include "apps/suites/suite_stages.hpp"
#include "planning/check/path_check.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planner_table.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace chong2008_job_test {

constexpr double step = 0.5 * 3.14159265358979323846 / 180.0;

const Suite& all_figures() {
  static const Suite suite =
      load_suite(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites/chong2008.yaml");
  return suite;
}

/// An experiment of the suite, ready to be searched.
class Experiment {
 public:
  explicit Experiment(const std::string& name) : experiment_(find(name)) {
    RobotChoice choice;
    choice.robot = experiment_.robot;
    choice.scale = experiment_.scale;
    robot_ = choose_robot(choice);
    stage_ = SuiteStages(all_figures(), experiment_, robot_).make(0);
    space_ = std::make_unique<ConfigurationSpace>(robot_, stage_.map,
                                                  suite_policies(all_figures(), experiment_, robot_));
  }

  const ConfigurationSpace& space() const { return *space_; }
  const StageProblem& problem(std::size_t i = 0) const { return stage_.problems.at(i); }
  bool has_width(int width) const {
    return std::any_of(
        experiment_.planners.begin(), experiment_.planners.end(), [&](const SuitePlanner& planner) {
          return planner.planner == "beam" && planner.options.at("width") == std::to_string(width);
        });
  }

  /// The legs of problem `i` in turn, without a deadline; ends with the first that fails.
  std::vector<PlanResult> plan(int width, std::size_t i = 0) const {
    EXPECT_TRUE(has_width(width)) << experiment_.name << " has no beam of width " << width;
    const auto beam = make_planner("beam", {{"width", std::to_string(width)}});
    std::vector<PlanResult> legs;
    Configuration from = problem(i).start;
    for (const Configuration& goal : problem(i).goals) {
      const Robot held = robot_of_leg(robot_, problem(i).loads, static_cast<int>(legs.size()));
      const ConfigurationSpace loaded(held, stage_.map, suite_policies(all_figures(), experiment_, held));
      legs.push_back(beam->plan({loaded, PathCost(held), from, goal}));
      if (legs.back().status != PlanStatus::solved) break;
      from = legs.back().waypoints.back();
    }
    return legs;
  }

  /// The independent check's word.
  bool is_valid(const PlanResult& leg) const {
    return check_path(robot_, stage_.map, space_->policies(), 0.0, leg.waypoints, 0.05 * robot_.scale).valid;
  }

 private:
  static const SuiteExperiment& find(const std::string& name) {
    for (const SuiteExperiment& experiment : all_figures().experiments)
      if (experiment.name == name) return experiment;
    throw std::logic_error("no experiment " + name);
  }

  const SuiteExperiment& experiment_;
  Robot robot_;
  SuiteStage stage_;
  std::unique_ptr<ConfigurationSpace> space_;
};

/// Whether joint `j` moves by one step at a time in one direction and then stands still.
bool is_ramp(const PlanResult& leg, Eigen::Index j) {
  const std::size_t lattice = leg.waypoints.size() - (leg.last_segment ? 1 : 0);
  double direction = 0.0;
  bool still = false;
  for (std::size_t i = 1; i < lattice; ++i) {
    const double moved = leg.waypoints[i][j] - leg.waypoints[i - 1][j];
    if (std::abs(moved) < 1e-9) {
      still = true;
      continue;
    }
    if (still || std::abs(std::abs(moved) - step) > 1e-9 || moved * direction < 0.0) return false;
    direction = moved;
  }
  return true;
}

TEST(Chong2008, Fig12InACompactVolumeTheGreedySearchTakesTheLargestMoveOverTheStepAndEveryJointIsARamp) {
  for (const char* name : {"fig12_compact", "fig12_miniature"}) {
    const Experiment experiment(name);
    const PlanResult greedy = experiment.plan(1).at(0), wide = experiment.plan(20).at(0);
    ASSERT_EQ(greedy.status, PlanStatus::solved) << name;
    const Eigen::VectorXd move = experiment.problem().goals[0] - experiment.problem().start;
    // 43 degrees are 86 steps, of which the goal box (Chong 2008, eq. 11) leaves out the last one.
    EXPECT_EQ(std::lround(move.cwiseAbs().maxCoeff() / step), 86) << name;
    EXPECT_EQ(greedy.search_steps, 85) << name;
    for (Eigen::Index j = 0; j < 6; ++j) EXPECT_TRUE(is_ramp(greedy, j)) << name << ", joint " << j + 1;
    ASSERT_EQ(wide.status, PlanStatus::solved);
    EXPECT_EQ(wide.search_steps, greedy.search_steps);
    EXPECT_LE(wide.cost, greedy.cost);
    EXPECT_GE(wide.cost, 0.98 * greedy.cost);
    EXPECT_TRUE(experiment.is_valid(greedy) && experiment.is_valid(wide)) << name;
  }
}

TEST(Chong2008, Fig12AMiniatureIsCostedAsTheFullSizeRobot) {
  const PlanResult full = Experiment("fig12_compact").plan(1).at(0);
  const PlanResult small = Experiment("fig12_miniature").plan(1).at(0);
  EXPECT_EQ(small.search_steps, full.search_steps);
  EXPECT_NEAR(small.cost, full.cost, 1e-9 * full.cost);
}

TEST(Chong2008, Fig16AtTheBoundaryCostFallsWithTheWidthAndLevelsOff) {
  for (const char* name : {"fig16_example_1", "fig16_example_2"}) {
    const Experiment experiment(name);
    EXPECT_FALSE(experiment.space().is_edge_free(experiment.problem().start, experiment.problem().goals[0]));
    std::map<int, double> cost;
    for (const int width : {1, 5, 10, 20, 50, 100}) {
      const PlanResult leg = experiment.plan(width).at(0);
      ASSERT_EQ(leg.status, PlanStatus::solved) << name << ", k = " << width;
      EXPECT_TRUE(width != 50 || experiment.is_valid(leg)) << name;
      cost[width] = leg.cost;
    }
    EXPECT_LE(cost[50], cost[1]) << name;
    EXPECT_LE(std::abs(cost[50] - cost[20]), 0.02 * cost[20]) << name;
  }
}

TEST(Chong2008, Fig17AHoleStallsNarrowBeamsAndWideOnesPass) {
  const Experiment experiment("fig17");
  for (const int width : {1, 5, 10}) {
    const PlanResult leg = experiment.plan(width).at(0);
    EXPECT_EQ(leg.status, PlanStatus::no_path) << "k = " << width;
    EXPECT_EQ(leg.explanation.rfind("stalled", 0), 0u) << leg.explanation;
  }
  for (const int width : {20, 50, 100}) {
    const PlanResult leg = experiment.plan(width).at(0);
    ASSERT_EQ(leg.status, PlanStatus::solved) << "k = " << width;
    EXPECT_TRUE(width != 100 || experiment.is_valid(leg));
  }
}

TEST(Chong2008, Fig18AWindingTaskFailsInOneQuery) {
  const Experiment experiment("fig18_miniature");
  ASSERT_EQ(experiment.problem(0).goals.back(), experiment.problem(1).goals.back());
  EXPECT_EQ(experiment.plan(10, 0).at(0).status, PlanStatus::no_path);
}

/// Four volumes of the family of Fig. 17: two stall the greedy search, one of these k = 10 as well.
TEST(Chong2008, Fig17OfVolumesWithALargeHoleAWiderBeamPassesMoreButNotAll) {
  const Suite family =
      load_suite(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites/chong2008_holes.yaml");
  const SuiteExperiment& experiment = family.experiments.at(1);
  EXPECT_GE(experiment.generate->count, 30);
  const Robot robot = load_robot(experiment.robot);
  const SuiteStages stages(family, experiment, robot);
  const PathCost cost(robot);
  std::map<int, std::size_t> passed;
  for (std::size_t i = 8; i < 12; ++i) {
    const SuiteStage stage = stages.make(i);
    const ConfigurationSpace space(robot, stage.map, suite_policies(family, experiment, robot));
    const StageProblem& problem = stage.problems.at(0);
    for (const int width : {1, 10}) {
      const auto beam = make_planner("beam", {{"width", std::to_string(width)}});
      const PlanResult leg = beam->plan({space, cost, problem.start, problem.goals[0]});
      if (leg.status != PlanStatus::solved) continue;
      ++passed[width];
      EXPECT_TRUE(check_path(robot, stage.map, space.policies(), 0.0, leg.waypoints, 0.05).valid) << i;
    }
  }
  EXPECT_EQ(passed[1], 2U);
  EXPECT_EQ(passed[10], 3U);
}

TEST(Chong2008, Figs18And19TheSameTaskPassesLegByLegAtBothSizes) {
  for (const char* name : {"fig18_miniature", "fig19_full_size"}) {
    const Experiment experiment(name);
    const auto legs = experiment.plan(10, 1);
    ASSERT_EQ(legs.size(), 2u) << name;
    for (const PlanResult& leg : legs) {
      EXPECT_EQ(leg.status, PlanStatus::solved) << name;
      EXPECT_TRUE(experiment.is_valid(leg)) << name;
    }
  }
}

TEST(Chong2008, EachFigureHasAnAnimationThatSaysWhatIsToBeSeen) {
  for (const SuiteExperiment& experiment : all_figures().experiments) {
    EXPECT_NE(std::find(experiment.plots.begin(), experiment.plots.end(), "animation"),
              experiment.plots.end())
        << experiment.name;
    EXPECT_EQ(experiment.title.rfind("Fig", 0), 0U) << experiment.title;
    for (const SuiteProblem& problem : experiment.problems)
      EXPECT_FALSE(problem.view.caption.empty()) << experiment.name << ": " << problem.name;
  }
}

/// The runs of the task of Fig. 18 in turn: in one query, pick then place.
CompareExperiment run_of_fig18(bool with_ball, const std::filesystem::path& out) {
  for (const SuiteExperiment& each : all_figures().experiments) {
    if (each.name != "fig18_miniature") continue;
    SuiteExperiment experiment = each;
    if (!with_ball) experiment.plots.clear();
    for (SuiteProblem& problem : experiment.problems)
      if (!with_ball) problem.loads.clear();
    return run_experiment(all_figures(), prepare(all_figures(), experiment, {}),
                          {.seed = 1, .jobs = 1, .out = out});
  }
  throw std::logic_error("no experiment fig18_miniature");
}

TEST(Chong2008, Fig18TheBallRidesOnTheSecondLegAloneAndCostsWork) {
  const TemporaryFolder with, without;
  const CompareProblem loaded = run_of_fig18(true, with / "").problems.at(1);
  const CompareProblem bare = run_of_fig18(false, without / "").problems.at(1);
  ASSERT_TRUE(loaded.runs.at(0).is_valid()) << loaded.runs[0].contact;
  ASSERT_TRUE(bare.runs.at(0).is_valid());
  const Plan plan = load_plan(with / loaded.runs[0].plan_file);
  ASSERT_EQ(plan.loads.size(), 1U);
  EXPECT_EQ(plan.loads[0].load.name, "ball");
  EXPECT_EQ(plan.loads[0].legs, std::vector<int>{1});
  // Of the same 313 steps; 0.2 kg at up to 1 m, moved by a radian or so: less than 2 J.
  EXPECT_EQ(loaded.runs[0].steps, bare.runs.at(0).steps);
  EXPECT_GT(loaded.runs[0].cost, bare.runs[0].cost + 0.1);
  EXPECT_LT(loaded.runs[0].cost, bare.runs[0].cost + 2.0);
  const std::string page = read_file(with / loaded.page);
  EXPECT_NE(page.find("\"part\":\"ball\""), std::string::npos) << "is drawn";
}

}  // namespace chong2008_job_test
}  // namespace clearway
