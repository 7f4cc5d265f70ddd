// What `clearway check` says it checked, and plan files edited so that they ask for less.
#include <gtest/gtest.h>

#include "mapping/files/map_digest.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/check/check_command.hpp"

namespace clearway {
namespace check_test {

TEST_F(Check, says_under_which_policy_padding_scale_and_base_its_verdict_holds) {
  const CommandRun run = check(plan_, {"--json"});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["policy"], Json({{"base", "painted"}}));
  EXPECT_EQ(json["padding_m"], 0.001);  // the robot's position accuracy
  EXPECT_EQ(json["scale"], 1.0);
  EXPECT_EQ(json["base"], Json({0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(json["plan_status"], "solved");
  const std::string text = check(plan_).out;
  for (const char* words : {"1 mm (plan), the robot's position accuracy", "point at scale 1"})
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
  EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  for (const char* word : {"edited.json", "'policy'", "bsae", "base"})
    EXPECT_NE(run.log.find(word), std::string::npos) << run.log;
}

TEST_F(Check, a_policy_that_was_loosened_in_the_file_or_by_a_flag_is_reported_beside_the_verdict) {
  Json plan = leaving();
  const CommandRun flag = check(plan, {"--policy", "not_occupied", "--json"});
  EXPECT_EQ(flag.status, exit_done) << flag.out;
  EXPECT_EQ(Json::parse(flag.out)["contract"]["policy"]["base"],
            Json({{"value", "not_occupied"}, {"source", "flag"}}));
  plan["policy"]["base"] = "not_occupied";
  const CommandRun edited = check(plan, {"--json"});
  EXPECT_EQ(Json::parse(edited.out)["contract"]["policy"]["base"],
            Json({{"value", "not_occupied"}, {"source", "plan"}}));
  EXPECT_EQ(check(plan, {"--policy", "base=painted"}).status, exit_no);
  EXPECT_EQ(check(plan_, {"--padding", "0.9"}).status, exit_no);
}

TEST_F(Check, names_the_source_of_each_term) {
  const Json contract = Json::parse(check(plan_, {"--json", "--base", "0,0,0"}).out)["contract"];
  EXPECT_EQ(contract["robot"], Json({{"value", "point"}, {"source", "flag"}}));
  EXPECT_EQ(contract["scale"]["source"], "default");
  EXPECT_EQ(contract["base"]["source"], "flag");
  EXPECT_EQ(contract["policy"]["base"], Json({{"value", "painted"}, {"source", "plan"}}));
  EXPECT_EQ(contract["padding_m"]["source"], "plan");
  EXPECT_EQ(contract["map_sha256"]["source"], "flag");
  EXPECT_EQ(contract["start"], Json({{"value", {-0.3, 0.0}}, {"source", "plan"}}));
  EXPECT_EQ(contract["goals"]["value"], Json({{0.3, 0.0}, {0.3, 0.2}}));
  const std::string text = check(plan_, {"--start=-0.3,0", "--goal=0.3,0", "--goal=0.3,0.2"}).out;
  for (const char* row : {"(-0.3, 0) (flag)", "(0.3, 0.2) (flag)", "all parts painted (plan)", "1 mm (plan)"})
    EXPECT_NE(text.find(row), std::string::npos) << text;
}

TEST_F(Check, a_path_that_stands_still_reaches_no_goal) {
  Json plan = plan_;
  for (Json& waypoint : plan["waypoints"]) waypoint = plan_["waypoints"][0];
  const CommandRun run = check(plan);
  EXPECT_EQ(run.status, exit_no);
  for (const char* words : {"refused", "goal 1 of 2: expected (0.3, 0)", "ends its leg at (-0.3, 0)"})
    EXPECT_NE(run.out.find(words), std::string::npos) << run.out;
  EXPECT_EQ(check(plan, {"--accept-goals"}).status, exit_done);
}

TEST_F(Check, a_leg_that_is_missing_is_a_goal_that_is_not_reached) {
  Json plan = plan_;
  const std::size_t last = plan["legs"][0]["waypoints"][1];
  plan["legs"].erase(1);
  plan["waypoints"].erase(plan["waypoints"].begin() + static_cast<long>(last) + 1, plan["waypoints"].end());
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), Terms{"goals"}) << run.out;
  EXPECT_NE(run.out.find("goal 2 of 2: is not reached, the plan has no leg to it"), std::string::npos);
  // Without its goal the plan is one of another query: the flags say which is meant.
  plan["goals"].erase(1);
  EXPECT_EQ(check(plan).status, exit_done);
  EXPECT_EQ(check(plan, {"--goal=0.3,0", "--goal=0.3,0.2"}).status, exit_no);
}

TEST_F(Check, goals_reached_in_another_order_are_not_reached) {
  Json plan = plan_;
  std::swap(plan["goals"][0], plan["goals"][1]);
  EXPECT_EQ(check(plan).status, exit_no);
  EXPECT_EQ(check(plan_, {"--goal=0.3,0.2", "--goal=0.3,0"}).status, exit_no);
}

TEST_F(Check, a_plan_without_start_or_goals_is_refused_unless_a_flag_says_them) {
  for (const char* key : {"start", "goals"}) {
    Json plan = plan_;
    plan.erase(key);
    EXPECT_EQ(check(plan).status, exit_no) << key;
    EXPECT_EQ(check(plan, {"--start=-0.3,0", "--goal=0.3,0", "--goal=0.3,0.2"}).status, exit_done) << key;
  }
}

TEST_F(Check, a_plan_at_another_scale_is_refused_unless_it_is_asked_for) {
  Json plan = plan_;
  plan["scale"] = 0.1;
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), Terms{"scale"});
  EXPECT_NE(run.out.find("scale: expected 1 by default, the plan says 0.1"), std::string::npos) << run.out;
  EXPECT_EQ(check(plan, {"--scale", "0.1"}).status, exit_done);
  EXPECT_EQ(Json::parse(check(plan, {"--accept-scale", "--json"}).out)["scale"], 0.1);
}

TEST_F(Check, a_plan_made_on_another_map_is_refused_unless_it_is_asked_for) {
  Json plan = plan_;
  plan["map"]["sha256"] = std::string(64, '0');
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), Terms{"map"});
  EXPECT_EQ(check(plan, {"--accept-map"}).status, exit_done);
}

TEST_F(Check, a_plan_for_another_robot_is_refused_unless_it_is_asked_for) {
  Json plan = plan_;
  plan["robot"] = "planar2";
  EXPECT_EQ(check(plan).status, exit_no);
  EXPECT_EQ(check(plan, {"--accept-robot"}).status, exit_done);
  plan["robot"] = (datasets_folder() / "robots" / "point.urdf").string();  // the same by its file
  EXPECT_EQ(check(plan).status, exit_done);
}

TEST_F(Check, a_padding_that_is_no_length_is_bad_input) {
  for (const Json& padding : {Json(-1), Json(-1e-12), Json("0"), Json(nullptr)}) {
    Json plan = plan_;
    plan["padding_m"] = padding;
    const CommandRun run = check(plan);
    EXPECT_EQ(run.status, exit_bad_input) << padding;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("padding_m"), std::string::npos) << run.log;
  }
}

TEST_F(Check, flags_state_the_contract_and_the_plan_may_only_tighten_it) {
  EXPECT_EQ(check(plan_, {"--policy", "base=known_free"}).status, exit_done);
  Json plan = plan_;
  plan["policy"]["base"] = "not_occupied";
  const CommandRun policy = check(plan, {"--policy", "painted", "--json"});
  EXPECT_EQ(policy.status, exit_no);
  EXPECT_EQ(refused_terms(policy), Terms{"policy"});
  EXPECT_NE(policy.out.find("policy of base: expected painted, the plan says not_occupied"),
            std::string::npos);
  const CommandRun accepted = check(plan, {"--policy", "painted", "--accept-policy", "--json"});
  EXPECT_EQ(accepted.status, exit_done);
  EXPECT_EQ(Json::parse(accepted.out)["contract"]["policy"]["base"],
            Json({{"value", "not_occupied"}, {"source", "plan"}}));

  EXPECT_EQ(refused_terms(check(plan_, {"--padding", "0.01", "--json"})), Terms{"padding"});
  EXPECT_EQ(check(plan_, {"--padding", "0.01", "--accept-padding"}).status, exit_done);
  plan = plan_;
  plan["padding_m"] = 0.02;
  EXPECT_EQ(check(plan, {"--padding", "0.01"}).status, exit_done);

  plan = plan_;
  plan["base"][0][3] = 1e8;
  EXPECT_EQ(refused_terms(check(plan, {"--base", "0,0,0", "--json"})), Terms{"base"});
}

TEST_F(Check, what_the_plan_alone_says_is_shown_beside_what_is_usual) {
  Json plan = plan_;
  plan["policy"]["base"] = "not_occupied";
  plan["base"][0][3] = 0.01;
  const std::string text = check(plan).out;
  for (const char* words :
       {"the policy of base is the plan's, not_occupied; by default it is painted",
        "the base is the plan's; by its own settings 'point' stands at (0, 0, 0, 0, 0, 0)"})
    EXPECT_NE(text.find(words), std::string::npos) << text;
}

TEST_F(Check, poses_by_flag_go_before_those_of_the_maps_record) {
  const auto at = [](double x, double y) {
    return GoalPose{Eigen::Isometry3d(Eigen::Translation3d(x, y, 0.0))};
  };
  const QueryTerms query{.name = "twice",
                         .robot = "point",
                         .policies = {{"base", Policy::painted}},
                         .padding = 0.001,
                         .start = Eigen::Vector2d(-0.3, 0.0),
                         .goals = {Eigen::Vector2d(0.3, 0.0), Eigen::Vector2d(0.3, 0.2)},
                         .goal_poses = {at(0.3, 0.0), at(0.3, 0.2)}};
  folder_.write("map/queries.json", to_json(QueryRecord{map_sha256(folder_.path() / "map"), {query}}));
  const auto source = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> more{"--json"};
    more.insert(more.end(), flags.begin(), flags.end());
    return Json::parse(check(plan_, more).out)["contract"]["goals"]["source"];
  };
  EXPECT_EQ(source({}), "map");
  EXPECT_EQ(source({"--goal-pose=0.3,0,0", "--goal-pose=0.3,0.2,0"}), "flag");
  EXPECT_EQ(check(plan_).status, exit_done) << check(plan_).out;
  EXPECT_EQ(check(plan_, {"--goal-pose=0.3,0,0", "--goal-pose=0.3,0.2,0"}).status, exit_done);
  const CommandRun elsewhere = check(plan_, {"--goal-pose=0.3,0,0", "--goal-pose=0.3,0.25,0"});
  EXPECT_EQ(elsewhere.status, exit_no);
  EXPECT_NE(elsewhere.out.find("goal 2 of 2: expected the tip at (0.3, 0.25, 0"), std::string::npos)
      << elsewhere.out;
}

}  // namespace check_test
}  // namespace clearway
