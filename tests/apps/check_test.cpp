// What `clearway check` says it checked, and plan files edited so that they ask for less.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapping/free_space_map.hpp"
#include "mapping/map_file.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace {

using Json = nlohmann::json;

/// A painted ball about the origin, which the point robot's disc fits into, and a plan inside it.
class Check : public ::testing::Test {
 protected:
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.05});
    map.paint(map.add_volume("free", {"base"}), {Eigen::Vector3d::Zero(), 1.0});
    save_map(map.snapshot(), folder_.path() / "map");
    const CommandRun plan = run_command({"plan", "--map", folder_.file("map"), "--robot", "point",
                                         "--start=-0.3,0", "--goal=0.3,0", "--goal=0.3,0.2", "--planner",
                                         "rrtconnect", "--out", folder_.file("plan.json")});
    ASSERT_EQ(plan.status, exit_done) << plan.out << plan.log;
    plan_ = Json::parse(read_file(folder_.file("plan.json")));
  }

  CommandRun check(const Json& plan, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"check",   "--map", folder_.file("map"),
                                       "--robot", "point", folder_.write("edited.json", plan.dump())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  /// The plan with its last waypoint outside the painted ball.
  Json leaving() const {
    Json plan = plan_;
    plan["waypoints"].back() = {0.3, 1.5};
    return plan;
  }

  TemporaryFolder folder_;
  Json plan_;
};

TEST_F(Check, says_under_which_policy_padding_scale_and_base_its_verdict_holds) {
  const CommandRun run = check(plan_, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["policy"], Json({{"base", "painted"}}));
  EXPECT_EQ(json["padding_m"], 0.0);
  EXPECT_EQ(json["scale"], 1.0);
  EXPECT_EQ(json["base"], Json({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(json["plan_status"], "solved");
  const std::string text = check(plan_).out;
  for (const char* words : {"0 mm", "point at scale 1"})
    EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST_F(Check, a_policy_left_out_of_the_plan_is_the_default_one_not_the_loosest) {
  Json plan = leaving();
  EXPECT_EQ(check(plan).status, exit_no);
  plan["policy"] = Json::object();
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no) << run.out;
  EXPECT_EQ(Json::parse(run.out)["policy"]["base"], "painted");
}

TEST_F(Check, a_policy_for_a_part_that_the_robot_does_not_have_is_refused) {
  Json plan = leaving();
  plan["policy"] = {{"bsae", "painted"}};
  const CommandRun run = check(plan);
  EXPECT_EQ(run.status, exit_bad_input) << run.out;
  EXPECT_TRUE(run.told_in_one_sentence()) << run.log;
  for (const char* word : {"edited.json", "'policy'", "bsae", "base"})
    EXPECT_NE(run.log.find(word), std::string::npos) << run.log;
}

TEST_F(Check, a_policy_that_was_loosened_in_the_file_or_by_a_flag_is_told_beside_the_verdict) {
  Json plan = leaving();
  const CommandRun flag = check(plan, {"--policy", "not_occupied", "--json"});
  EXPECT_EQ(flag.status, exit_done) << flag.out;
  EXPECT_EQ(Json::parse(flag.out)["policy"]["base"], "not_occupied");
  plan["policy"]["base"] = "not_occupied";
  const CommandRun edited = check(plan, {"--json"});
  EXPECT_EQ(Json::parse(edited.out)["policy"]["base"], "not_occupied");
  EXPECT_EQ(check(plan, {"--policy", "base=painted"}).status, exit_no);
  EXPECT_EQ(check(plan_, {"--padding", "0.9"}).status, exit_no);
}

}  // namespace
}  // namespace clearway
