#include "planning/files/gate_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace gate_line_test {

using Json = nlohmann::json;

const std::string good = R"({"id": "a", "times": [0, 0.5], "positions": [[1, 2], [1.5, -2e-1]]})";

TEST(GateLine, ReadsWhatIsWrittenDownToTheBit) {
  const ChunkLine line = parse_chunk_line(good);
  ASSERT_TRUE(line.is_read()) << line.fault.sentence;
  EXPECT_EQ(line.id, "\"a\"");
  EXPECT_EQ(line.chunk.times, (std::vector<double>{0.0, 0.5}));
  ASSERT_EQ(line.chunk.positions.size(), 2U);
  EXPECT_EQ(line.chunk.positions[1], Eigen::Vector2d(1.5, -0.2));
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const double a = random.between(-7, 7), b = std::exp(random.between(-300, 300));
    const Json json{{"positions", {{a, b}}}, {"times", {b}}, {"id", i}};
    const ChunkLine drawn = parse_chunk_line(json.dump());
    ASSERT_TRUE(drawn.is_read()) << drawn.fault.sentence;
    EXPECT_EQ(drawn.id, std::to_string(i));
    EXPECT_EQ(drawn.chunk.positions[0], Eigen::Vector2d(a, b));
    EXPECT_EQ(drawn.chunk.times[0], b);
  }
  EXPECT_EQ(parse_chunk_line(R"({"times":[],"positions":[[]]})").id, "null");
}

TEST(GateLine, WhatIsNotAChunkIsAFaultWithASentence) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {"", "expected a value"},
      {"{", "a key in quotes"},
      {"[]", "expected an object"},
      {"7", "expected an object"},
      {good + "x", "expected nothing more"},
      {R"({"times": [0]})", "no field 'positions'"},
      {R"({"positions": []})", "no field 'times'"},
      {R"({"times": [0], "times": [1], "positions": []})", "'times' twice"},
      {R"({"velocities": [0]})", "field 'velocities'"},
      {R"({"times": [[0]]})", "times[0]: expected a number"},
      {R"({"times": 3})", "times: expected a list of numbers"},
      {R"({"times": [true]})", "times[0]: expected a number"},
      {R"({"times": [0, "1"]})", "times[1]: expected a number"},
      {R"({"positions": [[0, 1], 2]})", "positions[1]: expected a list of numbers"},
      {R"({"positions": [[0, [1]]]})", "positions[0][1]: expected a number"},
      {R"({"positions": {}})", "positions: expected a list of configurations"},
      {R"({"id": 1.5})", "id: expected a text or a whole number"},
      {R"({"id": ["a"]})", "id: expected a text or a whole number"},
      {R"({"times": [0,]})", "expected a value"},
      {std::string(100000, '['), "expected an object"},
      {"\xff", "expected text in UTF-8"},
      {std::string("{\"id\": \"\xff\"}"), "not valid JSON"}};
  for (const auto& [text, words] : faults) {
    const ChunkLine line = parse_chunk_line(text);
    EXPECT_EQ(line.fault.reason, GateReason::not_a_chunk) << text;
    EXPECT_NE(line.fault.sentence.find(words), std::string::npos) << text << ": " << line.fault.sentence;
  }
}

TEST(GateLine, ReadsNamesOfJointsAndWhereTheRobotLeavesOrRestarts) {
  ChunkLine line = parse_chunk_line(
      R"({"joints": ["y", "x"], "leaves_at": 8, "times": [0, 1], "positions": [[1, 2], [3, 4]]})");
  ASSERT_TRUE(line.is_read()) << line.fault.sentence;
  EXPECT_EQ(line.leaves_at, 8U);
  EXPECT_FALSE(line.restarts);
  const Robot robot = load_robot("point");
  ASSERT_EQ(robot.joints[0].name, "x");
  take_order_of(robot, line);
  EXPECT_EQ(line.chunk.positions[1], Eigen::Vector2d(4, 3));
  line = parse_chunk_line(R"({"id": "r", "joints": ["y", "x"], "restart": [1, 2]})");
  ASSERT_TRUE(line.is_read()) << line.fault.sentence;
  EXPECT_TRUE(line.restarts);
  take_order_of(robot, line);
  EXPECT_EQ(line.restart, Configuration(Eigen::Vector2d(2, 1)));
  line = parse_chunk_line(R"({"restart": null})");
  EXPECT_TRUE(line.is_read() && line.restarts && !line.restart);
  for (const char* names : {"[]", R"(["x"])", R"(["x", "x"])", R"(["x", "z"])", R"(["x", "y", "y"])"}) {
    line = parse_chunk_line(R"({"times": [0, 1], "positions": [[1, 2], [3, 4]], "joints": )" +
                            std::string(names) + "}");
    take_order_of(robot, line);
    EXPECT_EQ(line.fault.reason, GateReason::not_a_chunk) << names;
    EXPECT_NE(line.fault.sentence.find("expected each of x, y once"), std::string::npos)
        << line.fault.sentence;
  }
  for (const auto& [text, words] :
       {std::pair{R"({"restart": [0], "times": [1]})", "restarts, expected no field 'times'"},
        {R"({"restart": [0], "leaves_at": 1})", "no field 'leaves_at'"},
        {R"({"restart": 1})", "restart: expected a list of numbers, or null"},
        {R"({"restart": [[1]]})", "restart[0]: expected a number"},
        {R"({"leaves_at": -1})", "leaves_at: expected a whole number from 0"},
        {R"({"leaves_at": 1.5})", "leaves_at: expected a whole number from 0"},
        {R"({"leaves_at": null})", "leaves_at: expected a whole number from 0"},
        {R"({"joints": "x"})", "joints: expected a list of names"},
        {R"({"joints": ["x", 1]})", "joints[1]: expected a name"}}) {
    const ChunkLine wrong = parse_chunk_line(text);
    EXPECT_EQ(wrong.fault.reason, GateReason::not_a_chunk) << text;
    EXPECT_NE(wrong.fault.sentence.find(words), std::string::npos) << text << ": " << wrong.fault.sentence;
  }
  EXPECT_EQ(parse_chunk_line(R"({"restart": [0, NaN]})").fault.reason, GateReason::not_finite);
}

TEST(GateLine, NumbersThatAreNoneAreNotFinite) {
  const std::vector<std::pair<std::string, std::string>> faults = {
      {R"({"times": [0, NaN]})", "times[1] is not finite"},
      {R"({"times": [Infinity]})", "times[0] is not finite"},
      {R"({"times": [1, 2, -Infinity]})", "times[2] is not finite"},
      {R"({"positions": [[0], [1, nan]]})", "positions[1][1] is not finite"},
      {R"({"positions": [[0, 1e999]]})", "positions[0][1] is not finite"},
      {R"({"positions": [[0, -inf]]})", "positions[0][1] is not finite"}};
  for (const auto& [text, words] : faults) {
    const ChunkLine line = parse_chunk_line(text);
    EXPECT_EQ(line.fault.reason, GateReason::not_finite) << text;
    EXPECT_NE(line.fault.sentence.find(words), std::string::npos) << text << ": " << line.fault.sentence;
  }
  const ChunkLine null = parse_chunk_line(R"({"times": [0, null], "positions": [[0], [null]]})");
  ASSERT_TRUE(null.is_read());  // the gate refuses it
  EXPECT_TRUE(std::isnan(null.chunk.times[1]) && std::isnan(null.chunk.positions[1][0]));
}

TEST(GateLine, KeepsTheIdOfABadLineAndLetsNoneCommandATerminal) {
  EXPECT_EQ(parse_chunk_line(R"({"id": 12, "times": [)").id, "12");
  const ChunkLine line = parse_chunk_line("{\"id\": \"\\u001b[2J\xc2\x9b \x7f\", \"times\": 1}");
  const std::string text = verdict_line(3, line.id, {.reason = GateReason::not_a_chunk, .sentence = "no"});
  for (const char c : text) EXPECT_TRUE(c >= ' ' && c < 0x7f) << static_cast<int>(c);
  EXPECT_EQ(Json::parse(text)["id"], "\x1b[2J\xc2\x9b \x7f");
  EXPECT_EQ(Json::parse(text)["line"], 3);
  EXPECT_EQ(Json::parse(text)["may_go"], nullptr);
}

TEST(GateLine, MutatedLinesAreReadOrRefusedAndNeverThrow) {
  Random random(4);
  int read = 0, refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = good;
    for (int k = 1 + random.below(4); k > 0; --k) {
      const auto at = static_cast<std::size_t>(random.below(static_cast<int>(text.size())));
      const int how = random.below(3);
      if (how == 0) text[at] = static_cast<char>(random.below(256));
      if (how == 1) text.erase(at, 1);
      if (how == 2) text.insert(at, 1, "[]{},:\"0eN-"[random.below(11)]);
    }
    const ChunkLine line = parse_chunk_line(text);
    ++(line.is_read() ? read : refused);
    EXPECT_EQ(line.is_read(), line.fault.sentence.empty()) << text;
    ASSERT_NO_THROW(Json::parse(verdict_line(1, line.id, {.reason = line.fault.reason}))) << text;
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(refused, 5000);
}

TEST(GateLine, ARefusalHoldsPieceBodyVoxelAndHowFarTheArmMayGo) {
  VoxelScene scene;
  scene.occupied = {box_of(1.0, -1.0, 0.0, 1.05, 1.0, 0.05)};
  Gate gate({.limits = {.max_velocity = {10.0}}});
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_velocity = 0.0;  // then the gate's 10 m/s count
  gate.publish({robot, scene.snapshot(), {.critical_by_default = false}});
  const ChunkLine line = parse_chunk_line(
      R"({"id":"x","times":[0,0.1,0.2,0.3,0.5],"positions":[[0.4,0],[0.5,0],[0.6,0],[0.7,0],[0.9,0]]})");
  const Json json = Json::parse(verdict_line(1, line.id, gate.judge(line.chunk)));
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["reason"], "blocked");
  EXPECT_EQ(json["piece"]["kind"], "edge");
  EXPECT_EQ(json["piece"]["from"], 3);
  EXPECT_EQ(json["piece"]["to"], 4);
  EXPECT_NEAR(json["piece"]["proved_share"].get<double>(), 0.5, 1e-3);
  EXPECT_EQ(json["body"], "base");
  EXPECT_EQ(json["voxel"]["state"], "occupied");
  EXPECT_EQ(json["voxel"]["blocks_as"], "occupied");
  EXPECT_NEAR(json["voxel"]["center"][0].get<double>(), 1.025, 1e-9);
  EXPECT_NEAR(json["may_go"]["until_s"].get<double>(), 0.3, 0.1 / 32);  // stands after 0.1 m, before 0.8 m
  EXPECT_EQ(json["may_go"]["position"].size(), 2U);
  gate.restart();
  const Json passed = Json::parse(verdict_line(
      2, "7", gate.judge(parse_chunk_line(R"({"times":[0,1],"positions":[[0,0],[0.1,0]]})").chunk)));
  EXPECT_EQ(passed["passed"], true);
  EXPECT_EQ(passed["reason"], "none");
  EXPECT_EQ(passed["id"], 7);
  EXPECT_FALSE(passed.contains("sentence"));
  EXPECT_EQ(passed["may_go"]["until_s"], 1.0);
  const Json jump = Json::parse(verdict_line(
      3, "8", gate.judge(parse_chunk_line(R"({"times":[1,2],"positions":[[0.5,0],[0.6,0]]})").chunk)));
  EXPECT_EQ(jump["passed"], false);  // before anything is proved
  EXPECT_EQ(jump["reason"], "jump");
  EXPECT_FALSE(jump.contains("piece"));
  EXPECT_TRUE(jump["may_go"].is_null());
}

}  // namespace gate_line_test
}  // namespace clearway
