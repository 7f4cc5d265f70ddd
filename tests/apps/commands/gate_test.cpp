// `clearway gate` as another program meets it: lines in, lines out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "apps/query/loads.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/history/provenance.hpp"
#include "planning/check/path_check.hpp"
#include "planning/gate/motion_chunk.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace gate_command_test {

using Json = nlohmann::json;

/// A wall at x = 1 m before the disc robot (radius 0.2 m), seen at 5 s; unknown elsewhere.
class GateCommand : public ::testing::Test {
 protected:
  void SetUp() override {
    FreeSpaceMap map({.resolution = 0.05});
    map.keep_scans();
    Scan scan;
    scan.sensor = "lidar";
    scan.time = 5.0;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.0, 0.0, 0.025);
    for (float y = -1.0F; y < 1.0F; y += 0.01F) scan.points.emplace_back(1.025F, y, 0.0F);
    map.insert(scan);
    save_map(map.snapshot(), folder_.path() / "map");
    save_provenance(map.provenance(), folder_.path() / "map");
  }

  CommandRun gate(const std::string& lines, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"gate",  "--map",    folder_.file("map"), "--robot",
                                       "point", "--policy", "not_occupied"};
    if (std::find(more.begin(), more.end(), "--padding") == more.end())
      arguments.insert(arguments.end(), {"--padding", "0"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    std::istringstream in(lines);
    std::ostringstream out, log;
    Console console(out, log, false, &in);
    CommandRun run;
    run.status = run_command_line(arguments, console);
    run.out = out.str();
    run.log = log.str();
    return run;
  }

  /// Warnings alone.
  std::string warnings(const std::vector<std::string>& more) const {
    std::vector<std::string> quiet = more;
    quiet.emplace_back("--quiet");
    return gate("", quiet).log;
  }

  static std::vector<Json> verdicts(const CommandRun& run) {
    std::vector<Json> lines;
    std::istringstream text(run.out);
    for (std::string line; std::getline(text, line);) lines.push_back(Json::parse(line));
    return lines;
  }

  TemporaryFolder folder_;
};

const std::string pass = R"({"id":"a","times":[0,0.1,0.2],"positions":[[0,0],[0.1,0],[0.2,0]]})";
const std::string blocked = R"({"id":2,"times":[0.2,0.4,0.9],"positions":[[0.2,0],[0.4,0],[0.9,0]]})";

TEST_F(GateCommand, AStartThatIsNotFreeIsReported) {
  const std::string blocked = warnings({"--start", "0.9,0"});
  EXPECT_NE(blocked.find("warning: --start is not free, so no chunk passes: "), std::string::npos) << blocked;
  EXPECT_NE(blocked.find("base"), std::string::npos) << blocked;
  EXPECT_EQ(warnings({"--start", "0.5,0"}).find("--start"), std::string::npos);
  EXPECT_NE(warnings({"--start", "200,0"}).find("--start is not free"), std::string::npos);
}

TEST_F(GateCommand, AnswersEachLineWithOneAndGoesOnAfterBadOnes) {
  const std::string wide = R"({"id":"w","times":[0],"positions":[[)" + std::string(5000, ' ') + "]]}";
  const CommandRun run = gate(pass + "\nnonsense\n\n" + blocked + "\n" + wide + "\n" + pass + "\n" +
                                  R"({"id":"n","times":[0,1],"positions":[[0.2,0],[NaN,0]]})" + "\r\n" +
                                  R"({"id":"l","times":[0,1],"positions":[[0.2,0],[0.3,0]]})",
                              {"--max-line", "4096"});
  EXPECT_EQ(run.status, exit_no) << run.log;
  EXPECT_EQ(run.log,
            "policy: all parts not_occupied; padding: 0 mm, less than the robot's position accuracy of 1 mm\n"
            "joints: x, y\n"
            "note: unknown space counts as free for base (policy not_occupied)\n"
            "8 chunks: 2 passed, 6 refused\n");
  const std::vector<Json> lines = verdicts(run);
  const std::vector<std::string> reasons = {"none",          "not_a_chunk", "not_a_chunk", "blocked",
                                            "line_too_long", "jump",        "not_finite",  "none"};
  ASSERT_EQ(lines.size(), reasons.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i]["reason"], reasons[i]) << i << ": " << lines[i];
    EXPECT_EQ(lines[i]["line"], i + 1);
    EXPECT_EQ(lines[i]["passed"], reasons[i] == "none");
    EXPECT_EQ(lines[i].contains("sentence"), reasons[i] != "none");
  }
  EXPECT_EQ(lines[0]["id"], "a");
  EXPECT_EQ(lines[1]["id"], nullptr);
  EXPECT_EQ(lines[3]["id"], 2);
  EXPECT_EQ(gate(pass + "\n").status, exit_done);
  EXPECT_EQ(gate("").status, exit_done);
}

TEST_F(GateCommand, ARefusalNamesTheScanThatMadeTheVoxel) {
  const Json json = verdicts(gate(pass + "\n" + blocked + "\n")).at(1);
  EXPECT_EQ(json["piece"]["kind"], "edge");
  EXPECT_EQ(json["piece"]["from"], 1);
  EXPECT_EQ(json["body"], "base");
  EXPECT_EQ(json["voxel"]["state"], "occupied");
  EXPECT_EQ(json["voxel"]["last_seen_s"], 5.0);
  EXPECT_EQ(json["voxel"]["history"]["hit_by_scans"][0]["sensor"], "lidar");
  EXPECT_NE(json["sentence"].get<std::string>().find("scan 0 of 'lidar' at 5 s"), std::string::npos) << json;
  EXPECT_GT(json["may_go"]["until_s"].get<double>(), 0.3);
}

/// Chunks here and there before the wall, each from rest anywhere: what a gate passes the independent check
/// proves with the load, way to stop included; what it refuses for the load alone touches something there.
TEST_F(GateCommand, JudgesChunksWithWhatIsAttached) {
  const std::string rod = folder_.write(
      "rod.yaml", "{name: rod, box: [0.1, 1.2, 0.1], link: base, pose: [0.4, 0, 0, 0, 0, 0.3], mass: 1}");
  const Robot robot = load_robot("point");
  const Robot loaded = with_all_loads(robot, choose_loads({rod}, robot));
  const Snapshot map = load_map(folder_.path() / "map");
  const auto is_valid = [&](const Robot& judged, const std::vector<Configuration>& path) {
    return check_path(judged, map, {}, 0.0, path).valid;
  };
  std::mt19937_64 random(11);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  };
  int passed = 0, refused_for_load = 0;
  for (int i = 0; i < 60; ++i) {
    const Configuration from = Eigen::Vector2d(draw(0.0, 0.8), draw(-2.0, 2.0));
    const Configuration to = from + Eigen::Vector2d(draw(-0.2, 0.2), draw(-0.2, 0.2));
    const Json line{{"times", {0.0, 0.5}}, {"positions", {{from[0], from[1]}, {to[0], to[1]}}}};
    const auto judged = [&](std::vector<std::string> more) {
      more.insert(more.end(), {"--allow-outside", "all"});
      return verdicts(gate(line.dump() + "\n", more)).at(0);
    };
    const JointLimits limits = joint_limits(loaded, {});
    const std::vector<Configuration> path = {from, to, stop_from(to, (to - from) / 0.5, limits)};
    const Json with = judged({"--attach", rod}), without = judged({});
    if (with["passed"]) {
      ++passed;
      EXPECT_TRUE(is_valid(loaded, path)) << line;
      EXPECT_TRUE(without["passed"]);
    } else if (without["passed"]) {
      ++refused_for_load;
      EXPECT_FALSE(is_valid(loaded, path)) << line << with;
      EXPECT_TRUE(is_valid(robot, path)) << line;
      EXPECT_EQ(with["body"], "rod") << with;
    }
  }
  EXPECT_GT(passed, 5);
  EXPECT_GT(refused_for_load, 5);
  EXPECT_NE(gate("", {"--attach", rod}).log.find("load: rod on base"), std::string::npos);
  const CommandRun legs = gate(
      "", {"--attach", folder_.write("legs.yaml", "{name: rod, box: [1, 1, 1], link: base, legs: [2]}")});
  EXPECT_EQ(legs.status, exit_bad_input);
  EXPECT_TRUE(legs.complains_in_one_sentence()) << legs.log;
}

TEST_F(GateCommand, RefusesAPartThatLeavesTheMapUnlessItIsAllowedByName) {
  const std::string leaves = R"({"times":[0,0.5],"positions":[[0.1,-1.0],[0.1,-1.3]]})";
  const CommandRun run = gate(leaves + "\n");
  EXPECT_EQ(run.status, exit_no);
  const Json json = verdicts(run).at(0);
  EXPECT_EQ(json["reason"], "outside_map");
  EXPECT_EQ(json["body"], "base");
  EXPECT_EQ(json["piece"]["kind"], "edge");
  EXPECT_NE(json["sentence"].get<std::string>().find("--allow-outside base"), std::string::npos) << json;
  EXPECT_GT(json["may_go"]["stands_at"][1].get<double>(), -1.2);
  for (const char* part : {"base", "all"})
    EXPECT_EQ(gate(leaves + "\n", {"--allow-outside", part}).status, exit_done) << part;
  const CommandRun unknown = gate(leaves + "\n", {"--allow-outside", "elbow"});
  EXPECT_EQ(unknown.status, exit_bad_input);
  EXPECT_TRUE(unknown.complains_in_one_sentence()) << unknown.log;
}

TEST_F(GateCommand, SaysAtTheStartWhatItsVerdictsRestOn) {
  FreeSpaceMap map({.resolution = 0.05, .integration = Integration::compatible});
  Scan scan;
  scan.points.emplace_back(1.0F, 0.0F, 0.0F);
  map.insert(scan);
  save_map(map.snapshot(), folder_.path() / "map");
  const std::string log = gate("").log;
  EXPECT_NE(log.find("note: unknown space counts as free for base"), std::string::npos) << log;
  EXPECT_NE(log.find("note: the map was made by compatible integration"), std::string::npos) << log;
  EXPECT_EQ(gate("", {"--policy", "known_free"}).log.find("unknown space"), std::string::npos);
}

TEST_F(GateCommand, AStreamWithARecedingHorizonGoesOnAndRestarts) {
  const CommandRun run = gate(pass + "\n" +
                              R"({"id":1,"leaves_at":1,"times":[0,0.1],"positions":[[0.1,0],[0.15,0]]})"
                              "\n"
                              R"({"id":2,"restart":[0.3,0]})"
                              "\n"
                              R"({"id":3,"joints":["y","x"],"times":[0,0.1],"positions":[[0,0.3],[0,0.35]]})"
                              "\n"
                              R"({"id":4,"restart":[1e9,0]})"
                              "\n"
                              R"({"id":5,"restart":null})"
                              "\n" +
                              pass + "\n");
  EXPECT_EQ(run.status, exit_no) << run.log;
  EXPECT_NE(run.log.find("5 chunks: 4 passed, 1 refused"), std::string::npos) << run.log;
  const std::vector<Json> lines = verdicts(run);
  ASSERT_EQ(lines.size(), 7U);
  for (const std::size_t i : {0, 1, 3, 6}) EXPECT_EQ(lines[i]["passed"], true) << lines[i];
  EXPECT_EQ(lines[2], (Json{{"line", 3}, {"id", 2}, {"restarted", true}}));
  EXPECT_EQ(lines[4]["restarted"], false);
  EXPECT_EQ(lines[4]["sentence"].get<std::string>().find("restart: joint"), 0U) << lines[4];
  EXPECT_EQ(lines[5]["restarted"], true);

  // Who said that the robot is elsewhere, but not where, is asked again.
  const std::string on = R"({"times":[0.2,0.3],"positions":[[0.2,0],[0.25,0]]})"
                         "\n";
  for (const char* bad : {R"({"restart":[1e9,0]})", R"({"restart":[0.2,NaN]})", R"({"restart":[0.2]})"}) {
    const std::vector<Json> lost = verdicts(gate(pass + "\n" + bad + "\n" + on +
                                                 R"({"restart":[0.2,0]})"
                                                 "\n" +
                                                 on));
    ASSERT_EQ(lost.size(), 5U);
    EXPECT_EQ(lost[1]["restarted"], false) << lost[1];
    EXPECT_EQ(lost[2]["reason"], "jump") << lost[2];
    EXPECT_NE(lost[2]["sentence"].get<std::string>().find("restart of line 2"), std::string::npos) << lost[2];
    EXPECT_EQ(lost[4]["passed"], true) << lost[4];
  }
}

TEST_F(GateCommand, TheSameChunksGiveTheSameBytes) {
  const std::string lines = pass + "\n" + blocked + "\n{}\n";
  EXPECT_EQ(gate(lines).out, gate(lines).out);
}

TEST_F(GateCommand, KeepsWhatItsFlagsState) {
  const auto reason = [&](const std::string& line, const std::vector<std::string>& more) {
    const std::vector<Json> lines = verdicts(gate(line + "\n", more));
    return lines.empty() ? std::string("nothing") : lines[0]["reason"].get<std::string>();
  };
  EXPECT_EQ(reason(pass, {}), "none");
  EXPECT_EQ(reason(pass, {"--start", "0,0"}), "none");
  EXPECT_EQ(reason(pass, {"--start", "0.1,0"}), "jump");
  EXPECT_EQ(reason(pass, {"--start", "0.1,0", "--tolerance", "0.2"}), "none");
  EXPECT_EQ(reason(pass, {"--deceleration", "0.5"}), "blocked");   // stands 1 m farther
  EXPECT_EQ(reason(pass, {"--deceleration", "0.9,0.1"}), "none");  // 0.55 m
  EXPECT_EQ(reason(pass, {"--reaction", "0.6"}), "blocked");
  EXPECT_EQ(reason(pass, {"--padding", "0.55"}), "blocked");
  EXPECT_EQ(reason(pass, {"--max-age", "4"}), "stale_map");  // seen at 5 s
  EXPECT_EQ(reason(pass, {"--max-age", "6"}), "none");
  EXPECT_EQ(reason(pass, {"--policy", "known_free"}), "blocked");
  EXPECT_EQ(reason(pass, {"--max-duration", "0.1"}), "lasts_too_long");
}

TEST_F(GateCommand, RefusesFlagsThatFitNothingInOneSentence) {
  const std::vector<std::vector<std::string>> wrong = {
      {"--max-velocity", "0"}, {"--deceleration", "1,2,3"}, {"--deceleration", "nan"}, {"--start", "0"},
      {"--tolerance", "-1"},   {"--max-line", "1"},         {"--max-age", "0"}};
  for (const auto& flags : wrong) {
    const CommandRun run = gate(pass + "\n", flags);
    EXPECT_EQ(run.status, exit_bad_input) << flags[0];
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_TRUE(run.out.empty()) << run.out;
  }
}

/// The program itself, whose reader goes away after the first line.
TEST_F(GateCommand, EndsInOneSentenceWhenNobodyReadsItsVerdicts) {
  std::string lines;
  for (int i = 0; i < 20000; ++i) lines += "{}\n";
  const std::string in = folder_.write("chunks.jsonl", lines);
  const std::string log = folder_.file("log"), status = folder_.file("status");
  const std::string script =
      folder_.write("pipe.sh", "( '" CLEARWAY_BINARY "' gate --quiet --map '" + folder_.file("map") +
                                   "' --robot point < '" + in + "' 2> '" + log + "'; echo $? > '" + status +
                                   "' ) | head -n 1 > '" + folder_.file("first") + "'\n");
  ASSERT_EQ(std::system(("bash '" + script + "'").c_str()), 0);
  EXPECT_EQ(read_file(folder_.file("status")), "2\n");
  EXPECT_EQ(read_file(log), "clearway: the result could not be written to standard output\n");
  EXPECT_EQ(Json::parse(read_file(folder_.file("first")))["reason"], "not_a_chunk");
}

/// A program that waits for each verdict before it sends the next chunk gets it.
TEST_F(GateCommand, AnswersBeforeItsInputEnds) {
  const std::string script =
      "coproc GATE { '" CLEARWAY_BINARY "' gate --quiet --map '" + folder_.file("map") +
      "' --robot point; }\n"
      "for i in 1 2 3; do echo '{}' >&${GATE[1]}; read -t 60 -u ${GATE[0]} line || exit 7; "
      "echo \"$line\"; done > '" +
      folder_.file("answers") + "'\n";
  const std::string file = folder_.write("ask.sh", script);
  ASSERT_EQ(std::system(("bash '" + file + "'").c_str()), 0);
  std::istringstream answers(read_file(folder_.file("answers")));
  int count = 0;
  for (std::string line; std::getline(answers, line); ++count)
    EXPECT_EQ(Json::parse(line)["line"], count + 1);
  EXPECT_EQ(count, 3);
}

}  // namespace gate_command_test
}  // namespace clearway
