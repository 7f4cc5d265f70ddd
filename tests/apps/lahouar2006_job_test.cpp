// What Lahouar et al. 2006 show in Figs. 4, 5 and 11 to 14, in the committed experiments; see also
// tests/planning/team/team_test.cpp.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/compare/compare_run.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace lahouar2006_job_test {

/// The ladder asks for anticipation; the enclosed goal is not to be had.
bool is_to_arrive(const std::string& experiment, const ComparePlanner& who) {
  if (who.planner == "constraint" || experiment == "figure4") return false;
  return experiment != "figure12" || who.label.ends_with("anticipated");
}

/// An experiment of the suite, run whole, judged by the independent check.
CompareExperiment run_of(const std::string& name, const std::filesystem::path& out) {
  const Suite suite =
      load_suite(std::filesystem::path(CLEARWAY_SOURCE_DIR) / "datasets/suites/lahouar2006.yaml");
  for (const SuiteExperiment& experiment : suite.experiments) {
    if (experiment.name != name) continue;
    SuiteExperiment plain = experiment;
    plain.plots.clear();
    return run_experiment(suite, prepare(suite, plain, {}), {.seed = 1, .jobs = 2, .out = out});
  }
  throw std::logic_error("no experiment " + name);
}

class Lahouar2006 : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { std::filesystem::create_directories(out_); }
  void TearDown() override { std::filesystem::remove_all(out_); }
  const std::filesystem::path out_ =
      std::filesystem::path(testing::TempDir()) / (std::string("lahouar2006_") + GetParam());
};

TEST_P(Lahouar2006, BoundaryFollowingArrivesWhereTheLocalMethodAloneDoesNot) {
  const CompareExperiment experiment = run_of(GetParam(), out_);
  ASSERT_EQ(experiment.problems.size(), 1U);
  ASSERT_GE(experiment.problems[0].runs.size(), 3U);
  for (const CompareRun& run : experiment.problems[0].runs) {
    const ComparePlanner& who = experiment.planners[run.planner];
    SCOPED_TRACE(who.label + ": " + run.explanation);
    const bool arrives = is_to_arrive(GetParam(), who);
    if (arrives) {
      EXPECT_TRUE(run.is_valid()) << run.contact;
    } else {
      EXPECT_EQ(run.status, PlanStatus::no_path);
    }
    if (who.planner == "constraint") {
      EXPECT_NE(run.explanation.find(run.team ? "No robot moves any more" : "Deadlock"), std::string::npos);
    } else if (!arrives) {
      EXPECT_NE(run.explanation.find("came back to the deadlock point"), std::string::npos);
    }
  }
}

/// Where a robot of the team ended, placed as its file says.
LinkPoses last_poses(const nlohmann::json& trace) {
  Robot robot = load_robot(trace.at("robot").get<std::string>());
  const auto base = trace.at("base").get<std::vector<double>>();
  robot.map_from_base = Eigen::Translation3d(base[0], base[1], base[2]) *
                        Eigen::Quaterniond(base[3], base[4], base[5], base[6]);
  const auto last = trace.at("positions").back().get<std::vector<double>>();
  return forward_kinematics(robot, Eigen::Map<const Configuration>(last.data(), 5));
}

TEST(Lahouar2006Faces, TheLocalMethodAloneStandsStillWhereTwoFacesOfTheLoadsAreParallel) {
  const TemporaryFolder out;
  run_of("figure13_faces", out / "");
  const auto run =
      nlohmann::json::parse(read_file(out / "teams/figure13_faces/face_to_face/constraint.json"));
  const Robot arm = load_robot("arm5");
  const auto load = std::find_if(arm.bodies.begin(), arm.bodies.end(),
                                 [](const Body& body) { return body.part == "load"; });
  ASSERT_NE(load, arm.bodies.end());
  const auto place = [&](std::size_t i) {
    return last_poses(run.at("robots").at(i))[static_cast<std::size_t>(load->link)] * load->link_from_shape;
  };
  const Eigen::Isometry3d a = place(0), b = place(1);
  // Large faces, z of both boxes, are parallel, lie over each other, and are as near as allowed.
  EXPECT_GT(std::abs(a.linear().col(2).dot(b.linear().col(2))), std::cos(0.01));
  const Eigen::Vector3d between = a.linear().transpose() * (b.translation() - a.translation());
  const Eigen::Vector3d edges = load->shape.edges();
  EXPECT_LT(std::abs(between.x()), edges.x());
  EXPECT_LT(std::abs(between.y()), edges.y());
  EXPECT_NEAR(std::abs(between.z()) - edges.z(), run.at("security_distance_m").get<double>(), 5e-4);
  EXPECT_EQ(run.at("check").at("between"), "left/load and right/load");
}

INSTANTIATE_TEST_SUITE_P(Figures, Lahouar2006,
                         testing::Values("figure4", "figure5", "figure11", "figure12", "figure13",
                                         "figure13_faces", "figure14"));

}  // namespace lahouar2006_job_test
}  // namespace clearway
