// What `plan` and `check` say of the ground that a verdict stands on, and what they refuse for it: policies
// that nobody chose, parts outside of the map, bodies that stand in obstacles, padding that nobody asked for.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace survey_test {

using Json = nlohmann::json;

/// A column with a boom of 0.5 m that turns about it; no settings beside it.
constexpr const char* crane = R"(<?xml version="1.0"?>
<robot name="crane">
  <link name="column"><collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.1" length="0.3"/></geometry></collision></link>
  <link name="boom"><collision><origin xyz="0.35 0 0"/><geometry><box size="0.5 0.06 0.06"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="column"/><child link="boom"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-1.5" upper="1.5" effort="1" velocity="1"/></joint>
</robot>
)";

/// Points a voxel's edge apart in a box, as a .pcd file.
std::string cloud(const Eigen::AlignedBox3d& box, double spacing) {
  std::string points;
  int count = 0;
  for (double x = box.min().x(); x <= box.max().x(); x += spacing) {
    for (double y = box.min().y(); y <= box.max().y(); y += spacing) {
      for (double z = box.min().z(); z <= box.max().z(); z += spacing, ++count)
        points += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
    }
  }
  const std::string number = std::to_string(count);
  return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + number +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA ascii\n" + points;
}

class Survey : public ::testing::Test {
 protected:
  void SetUp() override {
    crane_ = folder_.write("crane.urdf", crane);
    wall_ = folder_.write("wall.pcd",
                          cloud({Eigen::Vector3d(1.0, -0.5, 0.0), Eigen::Vector3d(1.0, 0.5, 1.0)}, 0.05));
  }

  /// A room that a sensor in its middle saw: voxels free up to `reach`.
  std::string seen_room(double reach, int looks) {
    FreeSpaceMap map({.resolution = 0.05});
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.01, 0.01, 0.51);
    const auto range = static_cast<float>(reach);
    for (float a = -range; a <= range; a += 0.02f) {
      for (float b = -range; b <= range; b += 0.02f) {
        for (const float side : {-range, range}) {
          scan.points.emplace_back(side, a, b);
          scan.points.emplace_back(a, side, b);
          scan.points.emplace_back(a, b, side);
        }
      }
    }
    for (int i = 0; i < looks; ++i) map.insert(scan);
    save_map(map.snapshot(), folder_.path() / "room");
    return folder_.file("room");
  }

  CommandRun plan(const std::string& map, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"plan",       "--map",        map,          "--robot",
                                       crane_,       "--start=-0.8", "--goal=0.8", "--planner",
                                       "rrtconnect", "--json",       "--out",      folder_.file("plan.json")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  TemporaryFolder folder_;
  std::string crane_, wall_;
};

TEST_F(Survey, a_robot_without_settings_plans_in_known_space_where_the_map_has_some) {
  const CommandRun run = plan(seen_room(1.0, 1));
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["policy"]["boom"], "known_free");
  const Json& validation = json["validation"];
  EXPECT_EQ(validation["verdict"], "valid");
  EXPECT_EQ(validation["swept"]["unknown"]["voxels"], 0);
  EXPECT_EQ(validation["swept"]["seen_free"]["share"], 1.0);
  EXPECT_TRUE(validation["unknown_counts_as_free_for"].empty());
  EXPECT_FALSE(validation.contains("note"));
}

TEST_F(Survey, its_boom_does_not_go_where_nobody_looked_unless_the_user_says_so) {
  const std::string map = seen_room(0.4, 1);  // the boom stands out of the room
  const CommandRun known = plan(map);
  EXPECT_EQ(known.status, exit_no);
  EXPECT_EQ(Json::parse(known.out)["status"], "start_invalid");
  const CommandRun asked = plan(map, {"--policy", "not_occupied"});
  EXPECT_EQ(asked.status, exit_no) << "the room's walls are in the way";
  EXPECT_EQ(Json::parse(asked.out)["policy"]["boom"], "not_occupied");
}

TEST_F(Survey, in_a_map_of_obstacles_alone_it_says_that_unknown_counts_as_free) {
  const CommandRun run = plan(wall_);
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["policy"]["boom"], "not_occupied");
  EXPECT_EQ(json["validation"]["swept"]["unknown"]["share"], 1.0);
  EXPECT_EQ(json["validation"]["unknown_counts_as_free_for"], Json({"boom"}));
  const std::string note = json["validation"]["note"];
  EXPECT_NE(note.find("unknown space counts as free for boom"), std::string::npos) << note;
  EXPECT_EQ(plan(wall_, {"--policy", "known_free"}).status, exit_no);
}

TEST_F(Survey, what_was_seen_once_is_distinguished_from_what_was_seen_more_often) {
  for (const int looks : {1, 3}) {
    const Json json = Json::parse(plan(seen_room(1.0, looks)).out);
    const Json& swept = json["validation"]["swept"];
    EXPECT_EQ(swept["seen_once"]["share"], looks == 1 ? 1.0 : 0.0) << swept;
  }
}

TEST_F(Survey, a_robot_that_left_the_map_is_refused_unless_allowed_by_name) {
  for (const char* base : {"--base=1e8,0,0", "--base=20,0,0"}) {
    const CommandRun away = plan(wall_, {base});
    EXPECT_EQ(away.status, exit_no) << away.out;
    const Json json = Json::parse(away.out);
    EXPECT_EQ(json["validation"]["verdict"], "refused");
    EXPECT_EQ(json["validation"]["outside_map"][0]["part"], "boom");
    const std::string sentence = json["validation"]["first_contact"];
    for (const char* words : {"boom leaves the map's bounds", "--allow-outside boom"})
      EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_EQ(plan(wall_, {base, "--allow-outside", "boom"}).status, exit_done);
    EXPECT_EQ(plan(wall_, {base, "--allow-outside", "all"}).status, exit_done);
    const CommandRun misspelt = plan(wall_, {base, "--allow-outside", "bom"});
    EXPECT_EQ(misspelt.status, exit_bad_input);
    EXPECT_TRUE(misspelt.complains_in_one_sentence()) << misspelt.log;
  }
}

TEST_F(Survey, check_refuses_what_leaves_the_map_too) {
  ASSERT_EQ(plan(wall_, {"--base=20,0,0", "--allow-outside", "all"}).status, exit_done);
  const std::vector<std::string> arguments{
      "check", "--map", wall_, "--robot", crane_, "--base=20,0,0", folder_.file("plan.json"), "--json"};
  const CommandRun refused = run_command(arguments);
  EXPECT_EQ(refused.status, exit_no) << refused.out << refused.log;
  EXPECT_EQ(Json::parse(refused.out)["outside_map"][0]["part"], "boom");
  std::vector<std::string> allowing = arguments;
  allowing.insert(allowing.end(), {"--allow-outside", "boom"});
  EXPECT_EQ(run_command(allowing).status, exit_done);
}

TEST_F(Survey, bodies_that_stand_in_obstacles_are_counted_and_refused_only_with_strict) {
  const std::string floor = folder_.write(
      "floor.pcd", cloud({Eigen::Vector3d(-0.3, -0.3, 0.12), Eigen::Vector3d(0.3, 0.3, 0.12)}, 0.05));
  const CommandRun run = plan(floor);
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json standing = Json::parse(run.out)["validation"]["standing_in_occupied"];
  ASSERT_EQ(standing.size(), 1u);
  EXPECT_EQ(standing[0]["part"], "column");
  EXPECT_GT(standing[0]["voxels"], 4);
  const CommandRun strict = plan(floor, {"--strict"});
  EXPECT_EQ(strict.status, exit_no);
  const std::string sentence = Json::parse(strict.out)["validation"]["first_contact"];
  EXPECT_NE(sentence.find("column touches"), std::string::npos) << sentence;
  ASSERT_EQ(plan(floor).status, exit_done);
  for (const bool is_strict : {false, true}) {
    std::vector<std::string> arguments{"check", "--map", floor, "--robot", crane_, folder_.file("plan.json")};
    if (is_strict) arguments.emplace_back("--strict");
    const CommandRun check = run_command(arguments);
    EXPECT_EQ(check.status, is_strict ? exit_no : exit_done) << check.out << check.log;
    EXPECT_NE(check.out.find("column touches"), std::string::npos) << check.out;
  }
  EXPECT_EQ(plan(wall_, {"--strict"}).status, exit_done);
}

TEST_F(Survey, padding_is_the_robots_position_accuracy_unless_it_is_asked_for) {
  const auto padding = [&](std::vector<std::string> more) {
    const CommandRun run = plan(wall_, std::move(more));
    EXPECT_EQ(run.status, exit_done) << run.log;
    return Json::parse(run.out)["padding_m"].get<double>();
  };
  EXPECT_EQ(padding({}), 0.001);
  EXPECT_EQ(padding({"--padding", "auto"}), 0.001);
  EXPECT_EQ(padding({"--padding", "0"}), 0.0);
  EXPECT_EQ(padding({"--padding", "0.02"}), 0.02);
  EXPECT_DOUBLE_EQ(padding({"--scale", "0.5"}), 0.0005);
  folder_.write("crane.yaml", "position_accuracy: 0.0005\n");
  EXPECT_EQ(padding({}), 0.0005);
  folder_.write("crane.yaml", "position_accuracy: -0.1\n");
  const CommandRun refused = plan(wall_);
  EXPECT_EQ(refused.status, exit_bad_input);
  for (const char* words : {"crane.yaml", "position_accuracy"})
    EXPECT_NE(refused.log.find(words), std::string::npos) << refused.log;
}

/// The crane with a hook that is drawn and never collides.
TEST_F(Survey, links_without_a_collision_shape_are_named_and_refused_with_strict) {
  std::string hooked = crane;
  hooked.insert(hooked.find("</robot>"),
                "<link name='hook'><visual><geometry><sphere radius='0.1'/></geometry></visual></link>"
                "<joint name='rope' type='fixed'><parent link='boom'/><child link='hook'/></joint>");
  crane_ = folder_.write("hooked.urdf", hooked);
  const std::string note = "link hook has a visual shape but no collision shape: nothing of it is checked";
  const CommandRun planned = plan(wall_);
  EXPECT_EQ(planned.status, exit_done) << planned.log;
  EXPECT_EQ(Json::parse(planned.out)["validation"]["links_without_collision_shape"], Json({"hook"}));
  EXPECT_EQ(plan(wall_, {"--strict"}).status, exit_no);
  plan(wall_);
  std::vector<std::string> check{
      "check", folder_.file("plan.json"), "--map", wall_, "--robot", crane_, "--goal", "0.8"};
  const CommandRun checked = run_command(check);
  EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
  EXPECT_NE(checked.out.find(note), std::string::npos) << checked.out;
  check.emplace_back("--strict");
  const CommandRun refused = run_command(check);
  EXPECT_EQ(refused.status, exit_no);
  EXPECT_NE(refused.out.find(note + ", which --strict refuses"), std::string::npos) << refused.out;
  std::istringstream no_chunks;
  std::ostringstream out, log;
  Console console(out, log, false, &no_chunks);
  run_command_line({"gate", "--map", wall_, "--robot", crane_}, console);
  EXPECT_NE(log.str().find(note), std::string::npos) << log.str();
}

TEST_F(Survey, padding_is_shown_beside_the_position_accuracy) {
  const auto text = [&](const std::string& padding) {
    return run_command({"plan", "--map", wall_, "--robot", crane_, "--start=-0.8", "--goal=0.8", "--planner",
                        "rrtconnect", "--padding", padding})
        .out;
  };
  EXPECT_NE(text("auto").find("1 mm, the robot's position accuracy"), std::string::npos) << text("auto");
  EXPECT_NE(text("0").find("0 mm, less than the robot's position accuracy of 1 mm"), std::string::npos);
  for (const char* words : {"swept volume", "100 % unknown", "unknown space counts as free for boom"})
    EXPECT_NE(text("auto").find(words), std::string::npos) << words << " in " << text("auto");
}

}  // namespace survey_test
}  // namespace clearway
