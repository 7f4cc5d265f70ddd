// What `clearway check` says it checked, and plan files edited so that they ask for less.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace check_test {

using Json = nlohmann::json;

/// A painted sphere about the origin, which the point robot's disc fits into, and a plan inside it.
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

  /// The plan with its last waypoint, and its goal, outside the painted sphere.
  Json leaving() const {
    Json plan = plan_;
    plan["waypoints"].back() = plan["goals"].back() = {0.3, 1.5};
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

/// The terms of the refusals, as the flags that accept them are called.
std::vector<std::string> refused_terms(const CommandRun& run) {
  const Json json = Json::parse(run.out);
  std::vector<std::string> terms;
  for (const Json& deviation : json["deviations"]) {
    if (!deviation["accepted"].get<bool>()) terms.push_back(deviation["term"]);
  }
  return terms;
}

using Terms = std::vector<std::string>;

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

/// The same map with a record of the query, as `replay` leaves it.
class CheckRecorded : public Check {
 protected:
  void SetUp() override {
    Check::SetUp();
    plan_["query"] = "twice";
    plan_["padding_m"] = 0.01;
    const auto at = [](double x, double y) { return Configuration(Eigen::Vector2d(x, y)); };
    query_ = {.name = "twice",
              .robot = "point",
              .scale = 1.0,
              .map_from_base = Eigen::Isometry3d::Identity(),
              .policies = {{"base", Policy::painted}},
              .padding = 0.01,
              .start = at(-0.3, 0.0),
              .goals = {at(0.3, 0.0), at(0.3, 0.2)}};
    record(map_sha256(folder_.path() / "map"));
  }

  void record(const std::string& digest) const {
    folder_.write("map/queries.json", to_json(QueryRecord{digest, {query_}}));
  }

  QueryTerms query_;
};

TEST_F(CheckRecorded, the_maps_own_record_states_the_contract) {
  const Json json = Json::parse(check(plan_, {"--json"}).out);
  EXPECT_EQ(json["verdict"], "valid") << json;
  for (const char* term : {"scale", "base", "padding_m", "start", "goals"})
    EXPECT_EQ(json["contract"][term]["source"], "map") << term;
  EXPECT_EQ(json["contract"]["policy"]["base"]["source"], "map");
  EXPECT_EQ(json["contract"]["query"], "twice");
  EXPECT_EQ(
      Json::parse(check(plan_, {"--padding", "0.001", "--json"}).out)["contract"]["padding_m"]["source"],
      "flag");
}

TEST_F(CheckRecorded, a_smaller_payload_or_another_gravity_than_the_record_has_is_refused) {
  query_.payload = 2.0;
  query_.gravity = {0.0, 0.0, -1.62};
  record(map_sha256(folder_.path() / "map"));
  Json plan = plan_;
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), (Terms{"payload", "payload"}));
  for (const char* words : {"payload: expected 2 kg by the map's record, the plan says 0 kg",
                            "gravity: expected (0, 0, -1.62) m/s^2 by the map's record, the plan says (0, 0, "
                            "-9.81) m/s^2"})
    EXPECT_NE(run.out.find(words), std::string::npos) << run.out;
  const Json accepted = Json::parse(check(plan, {"--accept-payload", "--json"}).out);
  EXPECT_EQ(accepted["verdict"], "valid");
  EXPECT_EQ(accepted["contract"]["payload_kg"], Json({{"value", 0.0}, {"source", "plan"}}));
  EXPECT_EQ(accepted["contract"]["gravity"]["source"], "plan");
  plan["gravity"] = {0.0, 0.0, -1.62};
  plan["payload_kg"] = 3.0;  // more than is asked for
  const Json more = Json::parse(check(plan, {"--json"}).out);
  EXPECT_EQ(more["verdict"], "valid") << more;
  EXPECT_EQ(more["contract"]["payload_kg"], Json({{"value", 2.0}, {"source", "map"}}));
  EXPECT_EQ(refused_terms(check(plan, {"--payload", "4", "--json"})), Terms{"payload"});
}

TEST_F(CheckRecorded, a_plan_that_hides_its_query_is_found_by_start_and_goals) {
  Json plan = plan_;
  plan.erase("query");
  plan["padding_m"] = 0.0;
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), Terms{"padding"});
}

TEST_F(CheckRecorded, a_plan_that_hides_its_query_and_a_leg_of_it_is_held_to_the_whole) {
  Json plan = plan_;
  plan.erase("query");
  const std::size_t last = plan["legs"][0]["waypoints"][1];
  plan["legs"].erase(1);
  plan["waypoints"].erase(plan["waypoints"].begin() + static_cast<long>(last) + 1, plan["waypoints"].end());
  plan["goals"].erase(1);
  plan["policy"]["base"] = "not_occupied";
  plan["padding_m"] = 0.002;
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), (Terms{"policy", "padding", "goals", "goals"})) << run.out;
  EXPECT_NE(check(plan).out.find("a part of the map's query 'twice'"), std::string::npos);
  EXPECT_EQ(check(plan, {"--accept-policy", "--accept-padding", "--accept-goals"}).status, exit_done);
}

TEST_F(CheckRecorded, a_plan_of_another_query_is_held_to_the_loosest_of_the_maps_own) {
  Json plan = plan_;
  plan.erase("query");
  plan["waypoints"][0] = plan["start"] = {-0.31, 0.0};
  EXPECT_EQ(check(plan).status, exit_done) << check(plan).out;
  plan["policy"]["base"] = "known_free";
  plan["base"][0][3] = 0.01;
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), (Terms{"base", "policy"})) << run.out;
  for (const char* words : {"none of the map's own", "expected painted by the map's record"})
    EXPECT_NE(check(plan).out.find(words), std::string::npos) << check(plan).out;
  EXPECT_EQ(check(plan, {"--base", "0.01,0,0", "--policy", "known_free"}).status, exit_done);
  query_.policies["base"] = Policy::known_free;  // as it was asked, looser than usual
  record(map_sha256(folder_.path() / "map"));
  EXPECT_EQ(refused_terms(check(plan, {"--json"})), Terms{"base"});
}

TEST_F(CheckRecorded, a_record_of_another_map_or_robot_does_not_count_and_a_damaged_one_is_reported) {
  record(std::string(64, '0'));
  EXPECT_EQ(Json::parse(check(plan_, {"--json"}).out)["contract"]["goals"]["source"], "plan");
  EXPECT_NE(check(plan_).out.find("of another map"), std::string::npos);
  query_.robot = "planar2";
  record(map_sha256(folder_.path() / "map"));
  EXPECT_NE(check(plan_).out.find("is for robot 'planar2'"), std::string::npos) << check(plan_).out;
  std::string text = read_file(folder_.path() / "map/queries.json");
  text.replace(text.find("painted"), 7, "paintid");
  folder_.write("map/queries.json", text);
  EXPECT_EQ(check(plan_).status, exit_damaged);
  EXPECT_TRUE(check(plan_).complains_in_one_sentence());
  folder_.write("map/queries.json", std::string(1U << 20, '['));
  EXPECT_EQ(check(plan_).status, exit_damaged);
}

/// Alters one thing that the contract is about; says whether the plan now asks for more, or for less.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  bool tightens(Json& plan) {
    const std::size_t last = plan["waypoints"].size() - 1;
    switch (random_() % 10) {
      case 0:
        plan["policy"]["base"] = random_() % 2 == 0 ? "not_occupied" : "known_free";
        return false;
      case 1:
        plan["policy"] = Json::object();
        return false;
      case 2:
        plan["base"][random_() % 3][3] = size();
        return false;
      case 3:
        plan["scale"] = std::exp(0.5 * size());
        return false;
      case 4:
        plan["padding_m"] = 0.01 * std::exp(size());
        return plan["padding_m"] > 0.01;
      case 5:
        plan["map"]["sha256"].get_ref<std::string&>()[random_() % 64] = 'x';
        return false;
      case 6:
        plan["waypoints"][random_() % 2 == 0 ? 0 : last][random_() % 2] = 0.3 + 1e-2 * size();
        return false;
      case 7:
        plan["start"][random_() % 2] = 0.4 + 0.1 * std::abs(size());
        return false;
      case 8:
        plan["goals"][random_() % 2][random_() % 2] = 0.4 + 0.1 * std::abs(size());
        return false;
      default:
        plan["legs"].erase(1);
        plan["waypoints"].erase(plan["waypoints"].begin() + plan["legs"][0]["waypoints"][1].get<long>() + 1,
                                plan["waypoints"].end());
        return false;
    }
  }

 private:
  /// Of either sign, from 1e-3 to 10.
  double size() {
    std::uniform_real_distribution<double> exponent(-3.0, 1.0);
    return (random_() % 2 == 0 ? 1.0 : -1.0) * std::pow(10.0, exponent(random_));
  }

  std::mt19937_64 random_;
};

TEST_F(CheckRecorded, altered_plans_are_refused_unless_they_only_tighten) {
  Mutator mutator(3);
  int refused = 0, tightened = 0;
  for (int i = 0; i < 150; ++i) {
    Json plan = plan_;
    const bool tightens = mutator.tightens(plan);
    const CommandRun run = check(plan);
    EXPECT_EQ(run.status, tightens ? exit_done : exit_no) << plan << run.out << run.log;
    (tightens ? tightened : refused)++;
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(tightened, 3);
}

}  // namespace check_test
}  // namespace clearway
