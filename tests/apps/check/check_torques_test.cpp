// `clearway check --payload --gravity`: torques of a motion under what flags and plan state.
#include <gtest/gtest.h>

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/console/parse.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace check_torques_test {

using Json = nlohmann::json;

/// A Panda's motion in the open, planned with 2 kg in its hand.
class CheckTorques : public ::testing::Test {
 protected:
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.05});
    map.paint(map.add_volume("far", {}), {Eigen::Vector3d(3.0, 0.0, 0.0), 0.3});
    save_map(map.snapshot(), folder_.path() / "map");
    const CommandRun run = run_command({"plan", "--map", folder_.file("map"), "--robot", "panda", "--policy",
                                        "not_occupied", "--allow-outside", "all",
                                        "--start=0,-0.5,0,-2,0,1.6,0", "--goal=1.2,0.2,0.3,-1.2,0.4,2.2,0.5",
                                        "--payload", "2", "--motion", "--out", folder_.file("plan.json")});
    ASSERT_EQ(run.status, exit_done) << run.out << run.log;
    plan_ = Json::parse(read_file(folder_.file("plan.json")));
  }

  CommandRun check(const Json& plan, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"check",   "--map",  folder_.file("map"),
                                       "--robot", "panda",  "--allow-outside",
                                       "all",     "--json", folder_.write("edited.json", plan.dump())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  /// By the planners' own recursion: the greatest share of a limit at any knot.
  double share(const JointLoad& load) const {
    const Robot robot = load_robot("panda");
    const TorqueTerms terms = torque_terms(robot, load);
    const Motion motion = load_plan(folder_.file("plan.json")).motion->motion;
    double greatest = 0.0;
    for (std::size_t k = 0; k < motion.positions.size(); ++k)
      greatest = std::max(greatest, joint_torques(robot, motion.positions[k], motion.velocities[k],
                                                  motion.accelerations[k], terms)
                                        .cwiseAbs()
                                        .cwiseQuotient(terms.limits)
                                        .maxCoeff());
    return greatest;
  }

  TemporaryFolder folder_;
  Json plan_;
};

double torque_share(const CommandRun& run) { return Json::parse(run.out)["motion"]["torque_share"]; }

TEST_F(CheckTorques, AreThoseUnderTheStatedPayloadAndGravity) {
  const double own = share({.payload = 2.0}), light = share({.payload = 0.5}),
               aside = share({.payload = 2.0, .gravity = {0.0, -9.81, 0.0}});
  ASSERT_GT(own, 1.02 * light);
  EXPECT_NEAR(torque_share(check(plan_)), own, 1e-9);
  EXPECT_NEAR(torque_share(check(plan_, {"--payload", "2"})), own, 1e-9);
  const CommandRun less = check(plan_, {"--payload", "0.5"});
  EXPECT_EQ(less.status, exit_done) << less.out << less.log;
  EXPECT_NEAR(torque_share(less), light, 1e-9);
  Json plan = plan_;
  plan["gravity"] = {0.0, -9.81, 0.0};
  EXPECT_NEAR(torque_share(check(plan, {"--gravity=0,-9.81,0"})), aside, 1e-9);
  const Json contract = Json::parse(check(plan, {"--gravity=0,-9.81,0"}).out)["contract"];
  EXPECT_EQ(contract["payload_kg"], Json({{"value", 2.0}, {"source", "plan"}}));
  EXPECT_EQ(contract["gravity"], Json({{"value", {0.0, -9.81, 0.0}}, {"source", "flag"}}));
}

/// The payload hangs at the robot's own tip.
TEST_F(CheckTorques, DoNotDependOnTheLinkThatGoalPosesAreOf) {
  const Robot robot = load_robot("panda");
  const std::vector<double> goal = plan_["waypoints"].back();
  const LinkPoses map_from =
      forward_kinematics(robot, Eigen::Map<const Configuration>(goal.data(), static_cast<Eigen::Index>(7)));
  ASSERT_EQ(robot.links[5].name, "link5");
  std::string pose;
  for (const double number : numbers_from_pose(map_from[5])) {
    std::ostringstream text;
    text << std::setprecision(17) << number;
    pose += (pose.empty() ? "" : ",") + text.str();
  }
  const CommandRun run = check(plan_, {"--goal-pose=" + pose, "--tip", "link5", "--payload", "2"});
  EXPECT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_NEAR(torque_share(run), share({.payload = 2.0}), 1e-9);
}

TEST_F(CheckTorques, UnderAGravityThatOnlyThePlanStatesAreMarkedAsSuch) {
  const std::string words = "the gravity is the plan's, (0, 0, 0) m/s^2";
  Json plan = plan_;
  plan["gravity"] = {0.0, 0.0, 0.0};
  EXPECT_NE(check(plan).out.find(words), std::string::npos) << check(plan).out;
  EXPECT_EQ(check(plan_).out.find("the gravity is the plan's"), std::string::npos);
}

TEST_F(CheckTorques, OfAPlanThatStatesLessAreRefusedUnlessAccepted) {
  Json plan = plan_;
  plan["payload_kg"] = 0.5;
  const CommandRun run = check(plan, {"--payload", "2"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_NE(run.out.find("payload: expected 2 kg, the plan says 0.5 kg"), std::string::npos) << run.out;
  EXPECT_NEAR(torque_share(run), share({.payload = 2.0}), 1e-9);
  const CommandRun accepted = check(plan, {"--payload", "2", "--accept-payload"});
  EXPECT_EQ(accepted.status, exit_done) << accepted.out;
  EXPECT_NEAR(torque_share(accepted), share({.payload = 0.5}), 1e-9);
  const CommandRun gravity = check(plan, {"--gravity=0,0,-1.62"});
  EXPECT_EQ(gravity.status, exit_no);
  EXPECT_NE(gravity.out.find("gravity: expected (0, 0, -1.62) m/s^2, the plan says (0, 0, -9.81) m/s^2"),
            std::string::npos)
      << gravity.out;
}

TEST_F(CheckTorques, BeyondALimitAreRefused) {
  Json plan = plan_;
  plan["payload_kg"] = 500.0;
  const CommandRun run = check(plan, {"--payload", "500"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_NE(run.out.find("the torque of joint"), std::string::npos) << run.out;
  for (const auto& flag : {std::vector<std::string>{"--payload", "-1"},
                           {"--payload", "2e6"},
                           {"--gravity=0,0"},
                           {"--gravity=0,0,nan"}})
    EXPECT_EQ(check(plan, flag).status, exit_bad_input) << flag.front();
}

TEST_F(CheckTorques, WithoutAMotionAreReportedAsUnknown) {
  Json plan = plan_;
  plan.erase("motion");
  const CommandRun run = check(plan, {"--payload", "2"});
  EXPECT_EQ(run.status, exit_done) << run.out;
  EXPECT_NE(run.out.find("torques belong to a motion"), std::string::npos) << run.out;
  EXPECT_EQ(check(plan).out.find("torques belong to a motion"), std::string::npos);
}

/// Of the robot's limits, as for its export, however slowly the motion was asked to go.
TEST_F(CheckTorques, SharesOfASlowMotionAreOfTheRobotsLimits) {
  const std::string slow = folder_.file("slow.json"), ros = folder_.file("slow.yaml");
  ASSERT_EQ(run_command({"plan", "--map", folder_.file("map"), "--robot", "panda", "--policy", "not_occupied",
                         "--allow-outside", "all", "--start=0,-0.5,0,-2,0,1.6,0",
                         "--goal=0.2,-0.4,0,-1.9,0,1.6,0.1", "--speed", "0.05", "--motion", "--out", slow,
                         "--trajectory", "ros", ros})
                .status,
            exit_done);
  const Json motion = Json::parse(check(Json::parse(read_file(slow))).out)["motion"];
  EXPECT_LE(motion["velocity_share"].get<double>(), 0.05 * (1.0 + 1e-6));
  EXPECT_GT(motion["velocity_share"].get<double>(), 0.04);
  const CommandRun exported = run_command({"check", ros, "--map", folder_.file("map"), "--robot", "panda",
                                           "--policy", "not_occupied", "--allow-outside", "all", "--json"});
  ASSERT_EQ(exported.status, exit_done) << exported.out << exported.log;
  EXPECT_NEAR(Json::parse(exported.out)["motion"]["velocity_share"].get<double>(),
              motion["velocity_share"].get<double>(), 1e-3);
}

}  // namespace check_torques_test
}  // namespace clearway
