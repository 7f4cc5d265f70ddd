#include "planning/files/plan_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

namespace clearway {
namespace plan_file_test {

using Json = nlohmann::ordered_json;

PlanResult leg_between(double from, double to) {
  PlanResult leg;
  leg.status = PlanStatus::solved;
  leg.explanation = "Reached the goal box in 2 steps.";
  leg.waypoints = {Eigen::Vector2d(from, 1.0 / 3.0), Eigen::Vector2d(0.5 * (from + to), 0.1),
                   Eigen::Vector2d(to, 1.0 / 3.0)};
  leg.cost = 1.25 + from;
  leg.last_segment = true;
  leg.last_segment_cost = 0.125;
  leg.search_steps = 2;
  leg.configurations_checked = 17;
  leg.edges_checked = 5;
  leg.final_distance = 0.0075;
  leg.statistics = {{"heads", 20.0}};
  leg.solved_by = BoundaryPlusStage::plane;
  return leg;
}

Plan example() {
  Plan plan;
  plan.robot = "planar2";
  plan.robot_scale = 0.1;
  plan.map_from_base.translation() = Eigen::Vector3d(1.0, -2.0, 0.25);
  plan.map_from_base.linear() =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  plan.joints = {"shoulder", "el,bow \"2\""};
  plan.planner = "beam";
  plan.options = {{"width", "10"}, {"step", "auto"}};
  plan.seed = 42;
  plan.map_file = "map.ot";
  plan.map_sha256 = std::string(64, 'a');
  plan.map_resolution = 0.02;
  plan.policies = {{"forearm", Policy::painted}, {"upper", Policy::not_occupied}};
  plan.padding = 0.001;
  plan.payload = 1.5;
  plan.gravity = {0.1, 1.0 / 3.0, -9.7};
  plan.legs = {leg_between(0.0, 1.0), leg_between(1.0, 2.0)};
  plan.goals = {Eigen::Vector2d(1.0, 1.0 / 3.0), Eigen::Vector2d(2.0, 1.0 / 3.0)};
  plan.time_s = 0.03125;
  plan.validation.valid = true;
  plan.validation.min_clearance = 0.0123;
  plan.validation.clearance = {0.1, 0.2, 0.0123, 0.1, 0.2};
  return plan;
}

std::filesystem::path written(const std::string& text) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) /
      (std::string("clearway_plan_file_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
       ".json");
  std::ofstream(file) << text;
  return file;
}

std::string refusal(const std::string& text) {
  try {
    load_plan(written(text));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(PlanFile, HasTheKeysOfTheDesignPageInItsOrder) {
  const Json json = Json::parse(to_json(example()));
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  const std::vector<std::string> fixed = {
      "robot",        "joints", "planner",     "options",   "seed",        "map",
      "policy",       "status", "explanation", "waypoints", "cost_joules", "length_rad",
      "search_steps", "legs",   "time_s",      "checks",    "validation"};
  ASSERT_GE(keys.size(), fixed.size());
  EXPECT_TRUE(std::equal(fixed.begin(), fixed.end(), keys.begin()));
  EXPECT_EQ(json["waypoints"].size(), 5u);
  EXPECT_EQ(json["cost_joules"], 3.5);
  EXPECT_EQ(json["search_steps"], 4);
  EXPECT_EQ(json["checks"], 34);
  EXPECT_EQ(json["validation"]["verdict"], "valid");
  EXPECT_NEAR(json["length_rad"].get<double>(), 4.0 * std::hypot(0.5, 1.0 / 3.0 - 0.1), 1e-12);
}

TEST(PlanFile, ReadsBackWhatItWrote) {
  const Plan plan = example();
  const Plan read = load_plan(written(to_json(plan)));
  EXPECT_EQ(to_json(read), to_json(plan));
  EXPECT_EQ(read.waypoints(), plan.waypoints());
  EXPECT_EQ(read.legs[1].waypoints, plan.legs[1].waypoints);
  EXPECT_EQ(read.legs[1].statistics, plan.legs[1].statistics);
  Plan odd = plan;  // of somebody's own planner
  odd.legs[1].statistics["ratio"] = std::nan("");
  EXPECT_EQ(parse_plan(to_json(odd), "odd.json").legs[1].statistics, plan.legs[1].statistics);
  EXPECT_EQ(read.legs[1].solved_by, BoundaryPlusStage::plane);
  EXPECT_EQ(Json::parse(to_json(read))["legs"][1]["statistics"].dump(), R"({"heads":20.0,"solved_by":2.0})");
  EXPECT_EQ(read.policies, plan.policies);
  EXPECT_EQ(read.payload, plan.payload);
  EXPECT_EQ(read.gravity, plan.gravity);
  EXPECT_EQ(read.map_from_base.matrix(), plan.map_from_base.matrix());
}

TEST(PlanFile, KeepsHowThePlannerGotToEachWaypoint) {
  Plan plan = example();
  EXPECT_FALSE(Json::parse(to_json(plan))["legs"][0].contains("phases"));
  plan.legs[0].origins = {{}, {PathPhase::free_motion, {}, 1}, {PathPhase::boundary, "forearm near it", 4}};
  plan.legs[1].origins = {{}, {PathPhase::lattice}, {PathPhase::lattice}};
  const Json legs = Json::parse(to_json(plan))["legs"];
  EXPECT_EQ(legs[0]["phases"].dump(),
            R"([{"to":1,"phase":"free_motion"},{"to":2,"phase":"boundary","constraint":"forearm near it"}])");
  EXPECT_EQ(legs[0]["steps"].dump(), "[0,1,4]");
  EXPECT_EQ(legs[1]["phases"].dump(), R"([{"to":2,"phase":"lattice"}])");
  EXPECT_FALSE(legs[1].contains("steps"));
  const Plan read = load_plan(written(to_json(plan)));
  EXPECT_EQ(read.legs[0].origins, plan.legs[0].origins);
  EXPECT_EQ(read.legs[1].origins, plan.legs[1].origins);
  const std::vector<WaypointOrigin> whole = read.origins();
  ASSERT_EQ(whole.size(), read.waypoints().size());
  EXPECT_EQ(whole[2], plan.legs[0].origins[2]) << "where the legs join, how the first one got there";
  EXPECT_EQ(whole[3], plan.legs[1].origins[1]);
}

TEST(PlanFile, PhasesThatDoNotFitTheWaypointsAreLeftOutAndOthersRefused) {
  Plan plan = example();
  plan.legs[0].origins = {{}, {PathPhase::free_motion, {}, 1}, {PathPhase::boundary, {}, 4}};
  const auto changed = [&](const std::function<void(Json&)>& change) {
    Json json = Json::parse(to_json(plan));
    change(json["legs"][0]);
    return json.dump();
  };
  EXPECT_EQ(load_plan(written(changed([](Json&) {}))).legs[0].origins, plan.legs[0].origins);
  for (const auto& change : std::vector<std::function<void(Json&)>>{
           [](Json& leg) { leg["phases"][1]["to"] = 3; }, [](Json& leg) { leg["phases"][1]["to"] = 1; },
           [](Json& leg) { leg["phases"][0]["to"] = 0; }, [](Json& leg) { leg["phases"].erase(1); }}) {
    const Plan read = load_plan(written(changed(change)));
    EXPECT_TRUE(read.legs[0].origins.empty());
    EXPECT_EQ(read.waypoints(), plan.waypoints());
  }
  const auto expect_named = [&](const std::function<void(Json&)>& change, const std::string& field) {
    const std::string sentence = refusal(changed(change));
    EXPECT_NE(sentence.find(field), std::string::npos) << sentence;
  };
  expect_named([](Json& leg) { leg["phases"][0]["phase"] = "dreaming"; }, "phases[0].phase");
  expect_named([](Json& leg) { leg["phases"][0]["to"] = -1; }, "phases[0].to");
  expect_named([](Json& leg) { leg["steps"][0] = 0.5; }, "steps[0]");
}

TEST(PlanFile, KeepsEveryBitOfRandomWaypoints) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  Plan plan = example();
  plan.legs = {leg_between(0.0, 1.0)};
  plan.legs[0].waypoints.clear();
  for (int i = 0; i < 500; ++i)
    plan.legs[0].waypoints.push_back(Eigen::Vector2d(uniform(random), 1e-9 * uniform(random)));
  EXPECT_EQ(load_plan(written(to_json(plan))).waypoints(), plan.waypoints());
}

TEST(PlanFile, AFailedLegKeepsItsReasonAndWhatWasExplored) {
  Plan plan = example();
  plan.legs[1] = PlanResult{};
  plan.legs[1].explanation = "stalled after 30 steps.";
  plan.legs[1].explored = {Eigen::Vector2d(1.0, 2.0)};
  plan.validation = {};
  plan.paint = {{{Eigen::Vector3d(0.31, -0.12, 1.0 / 3.0), 0.04}, "tool"}};
  EXPECT_EQ(plan.status(), PlanStatus::no_path);
  EXPECT_EQ(plan.explanation(), "Leg 2: stalled after 30 steps.");
  const Plan read = load_plan(written(to_json(plan)));
  EXPECT_EQ(to_json(read), to_json(plan));
  EXPECT_EQ(read.waypoints().size(), 3u);
  EXPECT_EQ(read.legs[1].explored, plan.legs[1].explored);
  ASSERT_EQ(read.paint.size(), 1u);
  EXPECT_EQ(read.paint[0].part, "tool");
  EXPECT_EQ(read.paint[0].sphere.center, plan.paint[0].sphere.center);
  EXPECT_EQ(read.paint[0].sphere.radius, 0.04);
}

TEST(PlanFile, EveryMissingKeyIsNamed) {
  const Json whole = Json::parse(to_json(example()));
  for (const char* key : {"robot", "joints", "planner", "options", "seed", "map", "policy", "status",
                          "waypoints", "legs", "time_s", "validation"}) {
    Json cut = whole;
    cut.erase(key);
    EXPECT_NE(refusal(cut.dump()).find("field '" + std::string(key) + "'"), std::string::npos)
        << key << ": " << refusal(cut.dump());
  }
}

TEST(PlanFile, WrongValuesAreNamedWithTheirPlace) {
  const Json whole = Json::parse(to_json(example()));
  const auto with = [&](const char* pointer, const Json& value) {
    Json changed = whole;
    changed[Json::json_pointer(pointer)] = value;
    return refusal(changed.dump());
  };
  EXPECT_NE(with("/waypoints/2", {1.0}).find("field 'waypoints[2]': expected 2 numbers, found 1"),
            std::string::npos);
  EXPECT_NE(with("/waypoints/1/0", nullptr).find("field 'waypoints[1][0]': expected a finite number"),
            std::string::npos);
  EXPECT_NE(with("/waypoints/1/0", "x").find("waypoints[1][0]"), std::string::npos);
  EXPECT_NE(with("/status", "done").find("found 'done'"), std::string::npos);
  EXPECT_NE(with("/status", "no_path").find("status"), std::string::npos);
  EXPECT_NE(with("/policy/forearm", "maybe")
                .find("field 'policy.forearm': expected painted, known_free or not_occupied, found 'maybe'"),
            std::string::npos);
  EXPECT_NE(with("/scale", 1e300).find("field 'scale': expected a factor from 0.000001 to 1000"),
            std::string::npos);
  EXPECT_NE(with("/legs/0/waypoints", {0, 9}).find("legs[0].waypoints"), std::string::npos);
  EXPECT_NE(with("/legs/0/waypoints", nullptr).find("legs[0].waypoints"), std::string::npos);
  EXPECT_NE(with("/seed", -1).find("seed"), std::string::npos);
  EXPECT_NE(with("/map/resolution", "fine").find("map.resolution"), std::string::npos);
  EXPECT_NE(with("/scale", 0).find("scale"), std::string::npos);
  for (const double payload : {-1.0, 1e7, 1e308})
    EXPECT_NE(with("/payload_kg", payload).find("field 'payload_kg': expected kg"), std::string::npos);
  EXPECT_NE(with("/gravity", {0, 0, -1001}).find("field 'gravity': expected a vector"), std::string::npos);
  EXPECT_NE(with("/gravity", {0, 1e300, 0}).find("field 'gravity': expected a vector"), std::string::npos);
  EXPECT_NE(with("/joints", Json::array()).find("joints"), std::string::npos);
}

TEST(PlanFile, LegsThatLeaveOutAWaypointOfTheFileAreRefused) {
  Json json = Json::parse(to_json(example()));
  json["legs"][1]["waypoints"] = {0, 2};  // five waypoints again, but 3 and 4 are none of them
  json["waypoints"][0] = json["waypoints"][2];
  EXPECT_NE(refusal(json.dump()).find("field 'legs'"), std::string::npos) << refusal(json.dump());
}

TEST(PlanFile, NotJsonAndMissingFilesAreRefusedInOneSentence) {
  for (const char* text : {"", "[]", "{", "{\"robot\": NaN}", "\xff\xfe", "null", "3"})
    EXPECT_NE(refusal(text), "accepted") << text;
  EXPECT_THROW(load_plan("/nonexistent/plan.json"), std::invalid_argument);
  EXPECT_THROW(load_plan(testing::TempDir()), std::invalid_argument);
  std::mt19937_64 random(9);
  const std::string whole = to_json(example());
  for (int i = 0; i < 150; ++i) {  // damage: refused, or still a plan; never anything else
    std::string text = whole;
    text[random() % text.size()] = static_cast<char>(random() % 256);
    if (i % 2 == 0) text.resize(random() % text.size());
    refusal(text);
  }
}

TEST(PlanFile, CsvHasJointNamesAndOneRowPerWaypoint) {
  EXPECT_EQ(
      to_csv(example()),
      "shoulder,\"el,bow "
      "\"\"2\"\"\"\n0,0.3333333333333333\n0.5,0.1\n1,0.3333333333333333\n1.5,0.1\n2,0.3333333333333333\n");
}

}  // namespace plan_file_test
}  // namespace clearway
