// `plan --attach`, and plans edited so that they carry less, as `check` sees them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "planning/files/query_record.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/expect_words.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace attach_test {

using Json = nlohmann::json;

/// Two posts 0.7 m apart: the point robot's disc of 0.2 m passes between them, a rod of 1 m does not.
class Attach : public ::testing::Test {
 protected:
  void SetUp() override {
    const VoxelScene scene{
        0.05, {box_of(0.9, 0.35, -0.1, 1.0, 0.45, 0.1), box_of(0.9, -0.45, -0.1, 1.0, -0.35, 0.1)}, {}, {}};
    save_map(scene.snapshot(), folder_.path() / "map");
    rod_ = folder_.write("rod.yaml", "{name: rod, box: [0.05, 1.0, 0.05], link: base, mass: 2}");
  }

  CommandRun plan(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"plan",      "--start=0,0", "--goal=2,0", "--goal=0,0",
                                       "--planner", "rrtconnect",  "--out",      folder_.file("plan.json")};
    return run(std::move(arguments), more);
  }
  Json written() const { return Json::parse(read_file(folder_.file("plan.json"))); }

  CommandRun check(const Json& plan, const std::vector<std::string>& more = {}) const {
    return run({"check", folder_.write("edited.json", plan.dump())}, more);
  }

  /// On the map, for the point robot; unknown counts as free.
  CommandRun run(std::vector<std::string> arguments, const std::vector<std::string>& more) const {
    for (const std::string& word :
         {std::string("--map"), folder_.file("map"), std::string("--robot"), std::string("point"),
          std::string("--policy"), std::string("not_occupied"), std::string("--allow-outside"),
          std::string("all")})
      arguments.push_back(word);
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  TemporaryFolder folder_;
  std::string rod_;
};

TEST_F(Attach, a_load_leads_the_robot_round_and_is_in_the_plan) {
  ASSERT_EQ(plan({}).status, exit_done);
  EXPECT_EQ(written()["waypoints"].size(), 3U);  // straight through, and back
  EXPECT_FALSE(written().contains("loads"));
  const CommandRun run = plan({"--attach", rod_});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  expect_words(run.out, {"rod on base"});
  EXPECT_GT(written()["waypoints"].size(), 4U);
  EXPECT_EQ(written()["loads"][0]["shape"], Json({{"box", {0.05, 1.0, 0.05}}}));
  EXPECT_EQ(written()["policy"]["rod"], "not_occupied");
  const CommandRun checked = check(written());
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  expect_words(checked.out, {"rod on base (plan)", "is what the plan says"});
  expect_words(check(written(), {"--attach", rod_}).out, {"rod on base (flag)", "valid"});
}

TEST_F(Attach, a_load_may_ride_on_one_leg_alone) {
  const std::string back =
      folder_.write("back.yaml", "{name: rod, box: [0.05, 1, 0.05], link: base, legs: [2]}");
  const CommandRun run = plan({"--attach", back});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_EQ(written()["legs"][0]["waypoints"], Json({0, 1}));
  EXPECT_GT(written()["legs"][1]["waypoints"][1].get<int>(), 2);
  EXPECT_EQ(written()["loads"][0]["legs"], Json({2}));
  EXPECT_EQ(check(written(), {"--attach", back, "--goal=2,0", "--goal=0,0"}).status, exit_done);
  expect_words(check(written(), {"--attach", back}).out, {"--goal for each leg", "refused"});
  const CommandRun both = check(written(), {"--attach", rod_});
  EXPECT_EQ(both.status, exit_no);
  expect_words(both.out, {"leaves it off on leg 1", "--accept-load"});
}

TEST_F(Attach, check_refuses_a_plan_that_drops_or_shrinks_its_load) {
  ASSERT_EQ(plan({}).status, exit_done);
  const CommandRun dropped = check(written(), {"--attach", rod_});
  EXPECT_EQ(dropped.status, exit_no);
  expect_words(dropped.out,
               {"load: expected rod on base, the plan says nothing of it", "rod comes too near to a voxel"});
  EXPECT_EQ(check(written(), {"--attach", rod_, "--accept-load"}).status, exit_done);

  Json shrunk = written();
  shrunk["policy"]["rod"] = "not_occupied";
  shrunk["loads"] = {{{"name", "rod"},
                      {"link", "base"},
                      {"pose", {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}},
                      {"shape", {{"box", {0.05, 0.05, 0.05}}}},
                      {"mass_kg", 2.0},
                      {"touches", Json::array()}}};
  const CommandRun small = check(shrunk, {"--attach", rod_});
  EXPECT_EQ(small.status, exit_no);
  expect_words(small.out, {"says another shape", "rod comes too near to a voxel"});
}

/// Smooth and blended, at rest where the rod is taken; check proves it with the rod, whatever the plan says.
TEST_F(Attach, a_motion_with_a_load_is_written_and_checked_with_it) {
  const std::string rod =
      folder_.write("back.yaml", "{name: rod, box: [0.05, 1, 0.05], link: base, mass: 2, legs: [2]}");
  const std::string file = folder_.file("motion.json"), slower = folder_.file("slower.json");
  const std::vector<std::string> goals{"--attach", rod, "--goal=2,0", "--goal=0,0"};
  ASSERT_EQ(plan({"--attach", rod, "--trajectory", "json", slower, "--grip-time", "0"}).status, exit_done);
  const CommandRun run = plan({"--attach", rod, "--trajectory", "json", file, "--grip-time", "0.4"});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  expect_words(run.out, {"motion", "blended", "trajectory: " + file});
  const Json motion = Json::parse(read_file(file)), plan_with = written();
  EXPECT_EQ(motion["events"].size(), 1U);
  EXPECT_EQ(plan_with["motion"]["grip_time_s"], 0.4);
  EXPECT_EQ(motion["positions"].size(), plan_with["motion"]["positions"].size());
  EXPECT_EQ(motion["positions"].size(), Json::parse(read_file(slower))["positions"].size() + 50);
  const CommandRun checked = check(plan_with, goals);
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  expect_words(checked.out, {"motion", "valid: ", "jerk limits"});

  const auto refused = [&](const Json& changed, const std::string& why) {
    const CommandRun found = check(changed, goals);
    EXPECT_EQ(found.status, exit_no) << why;
    expect_words(found.out, {"refused", why});
  };
  Json longer = plan_with;
  longer["motion"]["grip_time_s"] = 0.5;
  refused(longer, "after leg 1 it does not rest for 0.5 s");
  ASSERT_EQ(plan({"--motion"}).status, exit_done);  // without the rod, straight through
  Json through = plan_with;
  through["motion"] = written()["motion"];
  EXPECT_FALSE(through["motion"].contains("grip_time_s"));
  refused(through, "motion: ");
  Json dropped = written();
  EXPECT_EQ(check(dropped, goals).status, exit_no);
  for (const Json& time : {Json(-1.0), Json(61.0), Json("long")}) {
    Json wrong = plan_with;
    wrong["motion"]["grip_time_s"] = time;
    const CommandRun bad = check(wrong, goals);
    EXPECT_EQ(bad.status, exit_bad_input) << time;
    expect_words(bad.log, {"grip_time_s"});
  }
}

TEST_F(Attach, a_load_on_a_leg_that_the_plan_does_not_have_is_missed) {
  const std::string back =
      folder_.write("back.yaml", "{name: rod, box: [0.05, 1, 0.05], link: base, legs: [2]}");
  ASSERT_EQ(plan({"--attach", back}).status, exit_done);
  const Json loads = written()["loads"];
  ASSERT_EQ(run({"plan", "--start=0,0", "--goal=2,0", "--out", folder_.file("plan.json")}, {}).status,
            exit_done);
  Json one = written();
  one["loads"] = loads;
  one["policy"]["rod"] = "not_occupied";
  const CommandRun run = check(one, {"--attach", back, "--goal=2,0"});
  EXPECT_EQ(run.status, exit_no);
  expect_words(run.out, {"the plan has no leg 2"});
}

TEST_F(Attach, what_a_plan_carries_beyond_the_flags_is_checked_too) {
  ASSERT_EQ(plan({"--attach", rod_}).status, exit_done);
  Json through = written(), straight = (plan({}), written());
  straight["loads"] = through["loads"];
  straight["policy"]["rod"] = "not_occupied";
  const std::string peg = folder_.write("peg.yaml", "{name: peg, box: [0.05, 0.05, 0.05], link: base}");
  const CommandRun run = check(straight, {"--attach", peg, "--accept-load"});
  EXPECT_EQ(run.status, exit_no);
  expect_words(run.out, {"rod comes too near to a voxel"});
}

TEST_F(Attach, a_load_of_any_size_in_a_plan_is_refused_and_never_valid) {
  ASSERT_EQ(plan({"--attach", rod_}).status, exit_done);
  const Json good = written();
  for (const char* shape :
       {R"({"box": [1e9, 1e9, 1e9]})", R"({"box": [0.05, 1e9, 0.05]})", R"({"sphere": 1e200})",
        R"({"capsule": [0.01, 1e9]})", R"({"box": [1e5, 1e5, 1e5]})", R"({"sphere": 0.01, "box": [1, 1, 1]})",
        R"({"hull": [[0, 0, 0], [1e300, 0, 0], [0, 1, 0], [0, 0, 1]]})"}) {
    Json large = good;
    large["loads"][0]["shape"] = Json::parse(shape);
    CommandRun run = check(large);
    EXPECT_NE(run.status, exit_done) << shape << run.out;
    if (run.log.starts_with("note: load 'rod' is "))
      run.log.erase(0, run.log.find('\n') + 1);  // asks about mm
    EXPECT_TRUE(run.status == exit_no || run.complains_in_one_sentence()) << shape << run.log;
  }
}

/// The map folder's record knows the load: a plan of that query that forgets it is refused without a flag.
TEST_F(Attach, check_takes_the_load_from_the_maps_record) {
  ASSERT_EQ(plan({}).status, exit_done);
  QueryTerms terms;
  terms.name = "there and back";
  terms.robot = "point";
  terms.policies = {{"base", Policy::not_occupied}, {"rod", Policy::not_occupied}};
  terms.padding = 0.001;
  terms.start = Eigen::Vector2d(0.0, 0.0);
  terms.goals = {Eigen::Vector2d(2.0, 0.0), Eigen::Vector2d(0.0, 0.0)};
  Load rod;
  rod.name = "rod", rod.link = "base", rod.shape = Shape::box({0.05, 1.0, 0.05}), rod.mass = 2.0;
  terms.loads = {{rod, {}}};
  write_file(folder_.path() / "map" / "queries.json", to_json({map_sha256(folder_.path() / "map"), {terms}}));
  const CommandRun forgotten = check(written());
  EXPECT_EQ(forgotten.status, exit_no);
  expect_words(forgotten.out,
               {"load: expected rod on base by the map's record", "rod comes too near to a voxel"});
  ASSERT_EQ(plan({"--attach", rod_}).status, exit_done);
  const CommandRun kept = check(written());
  EXPECT_EQ(kept.status, exit_done) << kept.out;
  expect_words(kept.out, {"rod on base (map)"});
}

TEST_F(Attach, what_no_robot_can_carry_is_refused_in_one_sentence) {
  const auto refused = [&](const std::string& text, const std::string& word) {
    const CommandRun run = plan({"--attach", folder_.write("bad.yaml", text)});
    EXPECT_EQ(run.status, exit_bad_input) << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    expect_words(run.log, {word});
  };
  refused("{name: rod, box: [1, 1, 1], link: bse}", "did you mean 'base'?");
  refused("{name: rod, box: [1, 1], link: base}", "box");
  refused("{name: rod, mesh: no.stl, link: base}", "no.stl");
  refused("{name: rod, box: [1, 1, 1], link: base, legs: [3]}", "leg 3");
  EXPECT_EQ(plan({"--attach", folder_.file("none.yaml")}).status, exit_bad_input);
  EXPECT_EQ(plan({"--place", "0,0,0"}).status, exit_bad_input);
}

}  // namespace attach_test
}  // namespace clearway
