// `clearway check` where the map's folder has a record of the query, and plan files that ask for less than
// it.
#include <fcntl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <thread>

#include "mapping/files/map_digest.hpp"
#include "planning/files/query_record.hpp"
#include "tests/apps/check/check_command.hpp"

namespace clearway {
namespace check_test {

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
  plan["padding_m"] = 0.004;
  EXPECT_NE(check(plan).out.find("padding: expected 10 mm by the map's record, the plan says 4 mm"),
            std::string::npos)
      << check(plan).out;
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

TEST_F(CheckRecorded, it_counts_for_the_file_in_the_folder_and_for_maps_made_of_it) {
  Json plan = plan_;
  plan["policy"]["base"] = "not_occupied";
  plan["base"][0][3] = 0.01;
  const std::string file = folder_.write("edited.json", plan.dump()), saved = folder_.file("saved");
  const auto on = [&](const std::string& map) {
    return run_command({"check", "--map", map, "--robot", "point", file, "--json"});
  };
  EXPECT_EQ(refused_terms(on(folder_.file("map/map.ot"))), (Terms{"base", "policy"}));
  ASSERT_EQ(
      run_command({"inspect", folder_.file("map"), "--occupy", "sphere:0,0.9,0,0.1", "--save", saved}).status,
      exit_done);
  EXPECT_EQ(refused_terms(on(saved)), (Terms{"base", "policy", "map"}));
  EXPECT_NE(on(saved).out.find("made for the map of which `inspect` made this one"), std::string::npos);
  folder_.write("map/queries.json", "{}");  // damaged: nothing is written
  EXPECT_EQ(run_command({"inspect", folder_.file("map"), "--coarsen", "0.1", "--save", folder_.file("none"),
                         "--export", folder_.file("none.ply")})
                .status,
            exit_damaged);
  EXPECT_FALSE(std::filesystem::exists(folder_.file("none.ply")));
  record(std::string(64, '0'));  // of another map: nothing to keep
  ASSERT_EQ(run_command({"inspect", folder_.file("map"), "--coarsen", "0.1", "--save", saved}).status,
            exit_done);
  EXPECT_FALSE(std::filesystem::exists(saved + "/queries.json"));
}

TEST_F(CheckRecorded, it_counts_for_a_map_merged_with_one_that_has_none_whichever_comes_first) {
  const std::string map = folder_.file("map"), bare = folder_.file("bare");
  ASSERT_EQ(run_command({"inspect", map, "--occupy", "sphere:0,0.9,0,0.1", "--save", bare}).status,
            exit_done);
  std::filesystem::remove(bare + "/queries.json");
  const auto merged = [&](const std::string& first, const std::string& second) {
    const std::string out = folder_.file("merged");
    std::filesystem::remove_all(out);
    const CommandRun run = run_command({"inspect", first, "--merge", second, "--save", out});
    EXPECT_EQ(run.status, exit_done) << run.log;
    return std::pair(load_query_record(out), run.log);
  };
  const auto forth = merged(map, bare), back = merged(bare, map);
  ASSERT_TRUE(forth.first && back.first);
  EXPECT_EQ(to_json(*forth.first), to_json(*back.first));
  EXPECT_EQ(forth.second.find("record of their queries"), std::string::npos) << forth.second;
  query_.padding = 0.02;
  folder_.write("bare/queries.json", to_json(QueryRecord{map_sha256(bare), {query_}}));
  const auto both = merged(map, bare);
  EXPECT_EQ(both.first->queries.at(0).padding, 0.01);
  EXPECT_NE(both.second.find("both maps have a record of their queries: that of '" + map + "' is kept"),
            std::string::npos)
      << both.second;
  folder_.write("bare/queries.json", "{}");  // damaged: that of the first is kept, that of the second wanted
  const auto damaged = merged(map, bare);
  EXPECT_TRUE(damaged.first);
  EXPECT_NE(damaged.second.find("it is damaged"), std::string::npos) << damaged.second;
  std::filesystem::remove_all(folder_.file("merged"));
  EXPECT_EQ(run_command({"inspect", bare, "--merge", map, "--save", folder_.file("merged")}).status,
            exit_damaged);
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

/// As `replay --out` does: a map with an obstacle in the way, and a record of its own, takes the place of a
/// free one, or is replaced by it. Whichever was read, all of it was.
TEST_F(CheckRecorded, a_folder_that_is_exchanged_while_it_is_read_is_judged_as_one) {
  const std::filesystem::path map = folder_.path() / "map", other = folder_.path() / "other";
  ASSERT_EQ(
      run_command({"inspect", map.string(), "--occupy", "sphere:0,0,0,0.1", "--save", other.string()}).status,
      exit_done);
  const std::string free = map_sha256(map), blocked = map_sha256(other);
  query_.name = "newer";
  folder_.write("other/queries.json", to_json(QueryRecord{blocked, {query_}}));
  Json plan = plan_;
  plan.erase("query");
  std::atomic<bool> ends{false};
  std::thread exchanging([&] {
    while (!ends) {
      EXPECT_EQ(::renameat2(AT_FDCWD, map.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE), 0);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  int judgements = 0;
  for (int i = 0; i < 60; ++i) {
    plan["map"]["sha256"] = i % 2 == 0 ? blocked : free;
    const CommandRun run = check(plan, {"--json"});
    if (run.log.find("was replaced each of the 5 times") != std::string::npos) continue;
    ++judgements;
    const Json json = Json::parse(run.out), &judged = json["contract"];
    const bool is_free = judged["map_sha256"]["value"] == free;
    EXPECT_EQ(judged["query"], is_free ? "twice" : "newer");
    EXPECT_EQ(json["first_contact"] == "", is_free) << run.out;
    EXPECT_EQ(run.status, is_free && i % 2 == 1 ? exit_done : exit_no) << run.out;
  }
  ends = true;
  exchanging.join();
  EXPECT_GT(judgements, 10);
}

TEST_F(CheckRecorded, a_plan_that_holds_a_joint_is_held_to_the_record_all_the_same) {
  const std::string file = folder_.file("held.json");
  const auto planned = [&](const std::string& start, const std::string& y) {
    const CommandRun run = run_command({"plan", "--map", folder_.file("map"), "--robot", "point", "--fix",
                                        "y=" + y, "--start=" + start, "--goal=0.3", "--policy",
                                        "not_occupied", "--padding", "0.005", "--out", file});
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    return Json::parse(read_file(file));
  };
  for (const bool names_joints : {true, false}) {
    query_.joints = names_joints ? std::vector<std::string>{"x", "y"} : std::vector<std::string>();
    record(map_sha256(folder_.path() / "map"));
    const Json another = planned("-0.31", "0.05");
    EXPECT_EQ(refused_terms(check(another, {"--json"})), Terms{"policy"});
    EXPECT_EQ(check(another, {"--policy", "not_occupied"}).status, exit_done);
    const CommandRun part = check(planned("-0.3", "0"), {"--json"});
    EXPECT_NE(part.out.find("a part of the map's query 'twice'"), std::string::npos) << part.out;
    EXPECT_EQ(part.out.find("is for robot"), std::string::npos);
    EXPECT_EQ(refused_terms(part), (Terms{"held", "policy", "padding", "goals", "goals"}));
    EXPECT_NE(part.out.find("joint y: expected to come to 0.2 by the map's query 'twice', it stands at 0"),
              std::string::npos)
        << part.out;
  }
  query_.goals.pop_back();  // which the plan reaches, although it holds y
  record(map_sha256(folder_.path() / "map"));
  EXPECT_EQ(refused_terms(check(planned("-0.3", "0"), {"--json"})), (Terms{"policy", "padding"}));
}

TEST_F(CheckRecorded, what_all_its_queries_carry_a_plan_of_another_query_carries) {
  LegLoad beam;
  beam.load.name = "beam";
  beam.load.link = "base";
  beam.load.shape = Shape::box({0.05, 0.3, 0.05});
  query_.loads = {beam};
  query_.policies = {{"base", Policy::known_free}, {"beam", Policy::painted}};
  query_.payload = 3.0;
  query_.gravity = Eigen::Vector3d(0.0, 0.0, -9.81);
  record(map_sha256(folder_.path() / "map"));
  Json plan = plan_;
  plan.erase("query");
  plan["waypoints"][0] = plan["start"] = {-0.3, 2e-6};
  plan["policy"]["base"] = "known_free";
  const CommandRun run = check(plan, {"--json"});
  EXPECT_EQ(run.status, exit_no);
  EXPECT_EQ(refused_terms(run), (Terms{"load", "payload"})) << run.out;
  const Json contract = Json::parse(run.out)["contract"];
  EXPECT_EQ(contract["loads"]["source"], "map");
  EXPECT_EQ(contract["policy"]["beam"], Json({{"value", "painted"}, {"source", "map"}}));
  EXPECT_EQ(contract["payload_kg"], Json({{"value", 3.0}, {"source", "map"}}));
  EXPECT_EQ(check(plan, {"--accept-load", "--accept-payload"}).status, exit_done);
  plan["gravity"] = {0.0, 0.0, -1.62};
  EXPECT_EQ(refused_terms(check(plan, {"--json"})), (Terms{"load", "payload", "payload"}));
}

TEST_F(CheckRecorded, a_link_does_not_hide_it) {
  std::filesystem::create_directory(folder_.path() / "linked");
  std::filesystem::create_symlink(folder_.path() / "map/map.ot", folder_.path() / "linked/map.ot");
  const std::string file = folder_.write("edited.json", plan_.dump());
  const auto on = [&](const std::string& map) {
    return run_command({"check", "--map", folder_.file(map), "--robot", "point", file});
  };
  EXPECT_NE(on("linked").out.find("has a record of queries that does not count here"), std::string::npos)
      << on("linked").out;
  EXPECT_NE(on("linked/map.ot").out.find("has a record of queries that does not"), std::string::npos);
  EXPECT_EQ(on("map").out.find("has a record of queries that does not"), std::string::npos);
  std::filesystem::create_symlink("/nowhere", folder_.path() / "linked/queries.json");
  const CommandRun run = on("linked");
  EXPECT_EQ(run.status, exit_bad_input) << run.out;
  EXPECT_NE(run.log.find("queries.json' cannot be read: No such file"), std::string::npos) << run.log;
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
