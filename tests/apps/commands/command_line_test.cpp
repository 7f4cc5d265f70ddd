// The command line as a user meets it: what each command prints, how it ends, and what it says of bad input.
#include "apps/commands/command_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/page_reader.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace command_line_test {

using Json = nlohmann::json;

/// A room for the point robot: a scan that sees walls around [-2, 2] x [-2, 2] in the plane z = 0, 5 cm
/// voxels, and a post at (0.5, 0).
void save_room(const std::filesystem::path& folder) {
  MapOptions options;
  options.resolution = 0.05;
  FreeSpaceMap map(options);
  Scan walls;
  walls.map_from_sensor.translation() = Eigen::Vector3d(-1.0, -1.0, 0.025);
  const Eigen::Vector3f origin = walls.map_from_sensor.translation().cast<float>();
  for (float t = -2.0f; t <= 2.0f; t += 0.01f) {
    for (const Eigen::Vector3f& p : {Eigen::Vector3f(t, -2.0f, 0.025f), Eigen::Vector3f(t, 2.0f, 0.025f),
                                     Eigen::Vector3f(-2.0f, t, 0.025f), Eigen::Vector3f(2.0f, t, 0.025f)}) {
      walls.points.push_back(p - origin);
    }
  }
  map.insert(walls);
  Scan post;
  post.map_from_sensor.translation() = Eigen::Vector3d(0.0, 0.0, 0.025);
  for (int i = 0; i < 5; ++i) post.points.emplace_back(0.525f, -0.1f + 0.05f * static_cast<float>(i), 0.0f);
  map.insert(post);
  save_map(map.snapshot(), folder);
}

class CommandLine : public ::testing::Test {
 protected:
  void SetUp() override { save_room(folder_.path() / "map"); }

  CommandRun plan(const std::string& start, const std::string& goal, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"plan",          "--map",    map_,           "--robot",
                                       "point",         "--policy", "not_occupied", "--start=" + start,
                                       "--goal=" + goal};
    if (std::find(more.begin(), more.end(), "--planner") == more.end()) {
      arguments.insert(arguments.end(), {"--planner", "boundary"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  void expect_refused(const CommandRun& run, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(run.status, status) << run.log;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_TRUE(run.out.empty()) << run.out;
    for (const std::string& word : words)
      EXPECT_NE(run.log.find(word), std::string::npos) << word << " in " << run.log;
  }

  TemporaryFolder folder_;
  std::string map_ = folder_.file("map");
};

TEST_F(CommandLine, help_documents_every_flag_and_ends_well) {
  EXPECT_EQ(run_command({"--help"}).status, exit_done);
  for (const char* command :
       {"replay", "plan", "check", "gate", "inspect", "simulate", "robots", "planners"}) {
    const CommandRun run = run_command({command, "--help"});
    EXPECT_EQ(run.status, exit_done);
    EXPECT_NE(run.out.find("--json"), std::string::npos) << command;
  }
}

TEST_F(CommandLine, a_misspelt_command_or_flag_is_answered_with_the_nearest_one) {
  const CommandRun helpless = run_command({"frobnicate", "--help"});
  EXPECT_EQ(helpless.status, exit_bad_input);
  EXPECT_NE(helpless.log.find("unknown command 'frobnicate'"), std::string::npos) << helpless.log;
  expect_refused(run_command({"inspcet", map_}), exit_bad_input, {"inspcet", "did you mean 'inspect'"});
  expect_refused(run_command({"inspect", map_, "--slcie", "z=0"}), exit_bad_input,
                 {"--slcie", "did you mean '--slice'?"});
  expect_refused(run_command({"plan", "--tolerance", "1"}), exit_bad_input,
                 {"did you mean '--turn-tolerance'?"});
  expect_refused(run_command({"plan", "--seen", "1"}), exit_bad_input, {"did you mean '--seen-within'?"});
  expect_refused(run_command({"inspect", map_, "--frobnicate"}), exit_bad_input,
                 {"unknown flag '--frobnicate' (see clearway inspect --help)"});
  EXPECT_EQ(run_command({}).status, exit_bad_input);
}

TEST_F(CommandLine, lists_are_json_when_asked) {
  const Json robots = Json::parse(run_command({"robots", "--json"}).out);
  std::set<std::string> names;
  for (const auto& robot : robots["robots"]) names.insert(robot["name"]);
  for (const char* name : {"puma560", "puma560_miniature", "panda", "arm5", "arm6", "planar2", "point"})
    EXPECT_TRUE(names.count(name)) << name;
  const Json planners = Json::parse(run_command({"planners", "--json"}).out);
  std::set<std::string> found;
  for (const auto& planner : planners["planners"]) found.insert(planner["name"]);
  for (const char* name : {"beam", "boundary", "constraint"}) EXPECT_TRUE(found.count(name)) << name;
}

TEST_F(CommandLine, inspect_counts_voxels_and_answers_points) {
  const CommandRun run = run_command(
      {"inspect", map_, "--json", "--at=0.5,0,0.025", "--at", "-1.5,-1.5,0.025", "--at", "0,0,1"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json json = Json::parse(run.out);
  EXPECT_EQ(json["resolution"], 0.05);
  EXPECT_GT(json["voxels"]["occupied"], 300);
  EXPECT_GT(json["voxels"]["seen_free"], 3000);
  EXPECT_EQ(json["at"][0]["state"], "occupied");
  EXPECT_EQ(json["at"][0]["clearance_m"]["not_occupied"], 0.0);
  EXPECT_EQ(json["at"][1]["state"], "seen_free");
  EXPECT_NEAR(json["at"][1]["clearance_m"]["not_occupied"].get<double>(), 0.45, 0.02);
  EXPECT_EQ(json["at"][2]["state"], "unknown");
  EXPECT_EQ(json["at"][2]["clearance_m"]["known_free"], 0.0);
}

TEST_F(CommandLine, inspect_draws_a_slice_and_exports_for_other_programs) {
  const CommandRun run =
      run_command({"inspect", map_, "--slice", "z=0.025", folder_.file("slice.png"), "--export",
                   folder_.file("map.bt"), "--export", folder_.file("cloud.pcd")});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(read_file(folder_.file("slice.png")).substr(1, 3), "PNG");
  const Json exported = Json::parse(run_command({"inspect", folder_.file("map.bt"), "--json"}).out);
  const Json original = Json::parse(run_command({"inspect", map_, "--json"}).out);
  EXPECT_EQ(exported["voxels"]["occupied"], original["voxels"]["occupied"]);
  EXPECT_EQ(run_command({"inspect", folder_.file("cloud.pcd")}).status, exit_done);
}

TEST_F(CommandLine, inspect_refuses_what_it_cannot_read_or_write) {
  expect_refused(run_command({"inspect", folder_.file("no.ot")}), exit_bad_input, {"no.ot"});
  expect_refused(run_command({"inspect", folder_.write("map.txt", "x")}), exit_bad_input, {"map.txt"});
  expect_refused(run_command({"inspect", map_, "--at", "1,2"}), exit_bad_input, {"--at", "X,Y,Z"});
  expect_refused(run_command({"inspect", map_, "--at", "1,2,nan"}), exit_bad_input, {"--at", "nan"});
  expect_refused(run_command({"inspect", map_, "--slice", "w=1", folder_.file("s.png")}), exit_bad_input,
                 {"--slice", "z="});
  expect_refused(run_command({"inspect", map_, "--slice", "z=9", folder_.file("s.png")}), exit_bad_input,
                 {"misses the map"});
  expect_refused(run_command({"inspect", map_, "--export", "/nowhere/map.bt"}), exit_bad_input,
                 {"/nowhere/map.bt"});
  const std::string whole = read_file(folder_.path() / "map" / "map.ot");
  const std::string cut = folder_.write("cut.ot", whole.substr(0, whole.size() / 2));
  expect_refused(run_command({"inspect", cut}), exit_damaged, {"cut.ot"});
}

TEST_F(CommandLine, a_plan_is_found_written_and_confirmed_by_the_check) {
  const std::string file = folder_.file("plan.json");
  const CommandRun run = plan("-1,0", "1.4,0.1", {"--out", file, "--csv", folder_.file("plan.csv")});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const Json json = Json::parse(read_file(file));
  for (const char* key :
       {"robot", "joints", "planner", "options", "seed", "map", "policy", "status", "explanation",
        "waypoints", "cost_joules", "length_rad", "search_steps", "legs", "time_s", "checks", "validation"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["status"], "solved");
  EXPECT_EQ(json["validation"]["verdict"], "valid");
  const CommandRun check = run_command({"check", "--map", map_, "--robot", "point", file, "--json"});
  EXPECT_EQ(check.status, exit_done) << check.out << check.log;
  EXPECT_EQ(Json::parse(check.out)["verdict"], "valid");
}

TEST_F(CommandLine, the_check_refuses_a_plan_when_an_obstacle_is_dropped_on_it) {
  const std::string file = folder_.file("plan.json");
  ASSERT_EQ(plan("-1,0", "-1,1.2", {"--out", file}).status, exit_done);
  MapOptions options;
  options.resolution = 0.05;
  FreeSpaceMap blocked(options);
  Scan drop;
  drop.map_from_sensor.translation() = Eigen::Vector3d(-1.0, 0.6, 1.0);
  drop.points.emplace_back(0.0f, 0.0f, -0.975f);
  blocked.insert(drop);
  save_map(blocked.snapshot(), folder_.path() / "blocked");
  const CommandRun check =
      run_command({"check", "--map", folder_.file("blocked"), "--robot", "point", file, "--json"});
  EXPECT_EQ(check.status, exit_no) << check.out;
  const Json json = Json::parse(check.out);
  EXPECT_EQ(json["verdict"], "refused");
  EXPECT_FALSE(json["same_map"]);
  EXPECT_NE(json["first_contact"].get<std::string>().find("occupied"), std::string::npos) << check.out;
}

TEST_F(CommandLine, a_start_or_goal_that_is_not_free_is_said_to_be_so) {
  const CommandRun in_post = plan("0.5,0", "1,1", {"--json"});
  EXPECT_EQ(in_post.status, exit_no);
  Json json = Json::parse(in_post.out);
  EXPECT_EQ(json["status"], "start_invalid");
  EXPECT_NE(json["explanation"].get<std::string>().find("occupied"), std::string::npos)
      << json["explanation"];
  json = Json::parse(plan("1,1", "0.5,0", {"--json"}).out);
  EXPECT_EQ(json["status"], "goal_invalid");
  json = Json::parse(plan("1000,0", "1,1", {"--json"}).out);
  EXPECT_EQ(json["status"], "start_invalid");
  EXPECT_NE(json["explanation"].get<std::string>().find("limit"), std::string::npos) << json["explanation"];
}

TEST_F(CommandLine, plan_refuses_mistakes_in_one_sentence_and_writes_nothing) {
  const auto before = folder_.files();
  const std::string file = folder_.file("plan.json");
  expect_refused(plan("0,0", "1,1", {"--planner", "beem", "--out", file}), exit_bad_input, {"beem", "beam"});
  expect_refused(plan("0,0,0", "1,1", {"--out", file}), exit_bad_input, {"--start", "3 values", "2"});
  expect_refused(plan("0,x", "1,1", {"--out", file}), exit_bad_input, {"--start", "'x'"});
  expect_refused(plan("0,0", "1,1", {"--set", "widht=3", "--planner", "beam"}), exit_bad_input,
                 {"widht", "width"});
  expect_refused(plan("0,0", "1,1", {"--policy", "bse=painted"}), exit_bad_input, {"bse", "base"});
  expect_refused(plan("0,0", "1,1", {"--policy", "free"}), exit_bad_input, {"free", "known_free"});
  expect_refused(plan("-1,0", "-1,1", {"--out", "/nowhere/plan.json"}), exit_bad_input,
                 {"/nowhere/plan.json"});
  expect_refused(run_command({"plan", "--map", folder_.file("none"), "--robot", "point", "--start", "0,0",
                              "--goal", "1,1", "--planner", "beam"}),
                 exit_bad_input, {"none"});
  expect_refused(run_command({"plan", "--map", map_, "--robot", "pont", "--start", "0,0", "--goal", "1,1",
                              "--planner", "beam"}),
                 exit_bad_input, {"pont"});
  EXPECT_EQ(folder_.files(), before);
}

TEST_F(CommandLine, a_solved_plan_is_written_as_a_trajectory_of_its_waypoints) {
  const std::string file = folder_.file("motion.yaml"), again = folder_.file("again.yaml");
  const CommandRun run = plan("-1,0", "1.4,0.1", {"--trajectory", "ros", file, "--trajectory", "ros", again});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_NE(run.out.find(file), std::string::npos) << run.out;
  const std::string text = read_file(file);
  EXPECT_NE(text.find("joint_names:\n  - \"x\"\n  - \"y\"\npoints:\n  - positions: [-1.0, 0.0]\n"),
            std::string::npos)
      << text.substr(0, 600);
  EXPECT_LT(text.rfind("positions: [1.4, 0.1]\n    velocities: [0.0, 0.0]\n"), text.size());
  EXPECT_EQ(read_file(again), text);
}

TEST_F(CommandLine, a_plan_is_shown_on_a_page_in_the_time_of_its_trajectory) {
  const std::string page = folder_.file("plan.html"), file = folder_.file("shown.json");
  const CommandRun run = plan("-1,0", "1.4,0.1", {"--view", page, "--out", file, "--motion"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("page: " + page), std::string::npos);
  const PageReader reader(read_file(page));
  const auto& shown = reader.page.at("plans").at(0);
  EXPECT_EQ(shown.at("status"), "solved");
  const auto motion = load_plan(file).motion;
  ASSERT_TRUE(motion);
  const auto points = trajectory_of(motion->motion).points;
  ASSERT_EQ(shown.at("waypoints"), points.size());
  EXPECT_EQ(shown.at("maxJerk"), nlohmann::json({100.0, 100.0}));
  const auto values = reader.array<float>(shown.at("values")),
             speeds = reader.array<float>(shown.at("speeds"));
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (std::size_t j = 0; j < 2; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      EXPECT_EQ(values[j * points.size() + k], static_cast<float>(points[k].position[joint]));
      EXPECT_EQ(speeds[j * points.size() + k], static_cast<float>(points[k].velocity[joint]));
    }
  }
  EXPECT_EQ(reader.page.at("isoAzimuth"), 35.0) << "the robot's base is amid the walls: the view stays";
  expect_refused(plan("-1,0", "1,1", {"--view", page, "--out", page}), exit_bad_input, {"--view", "--out"});
  expect_refused(plan("-1,0", "1,1", {"--view", page, "--trajectory", "ros", folder_.file("./plan.html")}),
                 exit_bad_input, {"--view", "--trajectory"});
  EXPECT_EQ(plan("0.5,0", "1,1", {"--view", page}).status, exit_no) << "a plan that fails is shown, too";
}

TEST_F(CommandLine, check_refuses_a_motion_that_was_altered_and_accepts_the_one_that_was_written) {
  const std::string file = folder_.file("plan.json"), csv = folder_.file("motion.csv");
  const CommandRun run = plan("-1,0", "1.4,0.1", {"--export", "csv", csv, "--out", file, "--speed", "0.5"});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  EXPECT_EQ(read_file(csv).substr(0, 12), "time_s,x,y,x");
  const auto check = [&] {
    return run_command({"check", file, "--map", map_, "--robot", "point", "--json"});
  };
  CommandRun checked = check();
  ASSERT_EQ(checked.status, exit_done) << checked.out << checked.log;
  EXPECT_EQ(nlohmann::json::parse(checked.out)["motion"]["verdict"], "valid");
  const auto written = nlohmann::ordered_json::parse(read_file(file));
  const auto refused_after = [&](const auto& alter) {
    auto altered = written;
    alter(altered["motion"]);
    folder_.write("plan.json", altered.dump());
    checked = check();
    EXPECT_EQ(checked.status, exit_no) << checked.out << checked.log;
    return nlohmann::json::parse(checked.out)["motion"]["fault"].template get<std::string>();
  };
  EXPECT_NE(refused_after([](auto& motion) { motion["speed"] = 0.25; }).find("velocity"), std::string::npos);
  EXPECT_NE(refused_after([](auto& motion) { motion["period_s"] = 0.001; }), "");
  EXPECT_NE(refused_after([](auto& motion) { motion["positions"][40][1] = 0.5; }), "");
  EXPECT_NE(refused_after([](auto& motion) { motion["leg_ends"][0] = 3; }), "");
  for (const double speed : {0.0, 1.5}) {
    auto altered = written;
    altered["motion"]["speed"] = speed;
    folder_.write("plan.json", altered.dump());
    expect_refused(check(), exit_bad_input, {"motion.speed", "above 0"});
  }
  expect_refused(plan("-1,0", "1,1", {"--jerk", "0"}), exit_bad_input,
                 {"--jerk", "a share from 0.000001 to 1"});
}

TEST_F(CommandLine, no_trajectory_is_written_without_a_valid_plan_or_for_a_robot_it_does_not_fit) {
  const auto before = folder_.files();
  const std::string file = folder_.file("motion.script");
  const CommandRun in_post = plan("0.5,0", "1,1", {"--trajectory", "ros", file});
  EXPECT_EQ(in_post.status, exit_no);
  EXPECT_TRUE(in_post.complains_in_one_sentence()) << in_post.log;
  EXPECT_NE(in_post.log.find("no trajectory was written"), std::string::npos) << in_post.log;
  expect_refused(plan("-1,0", "1,1", {"--trajectory", "urscript", file}), exit_bad_input,
                 {"urscript", "six revolute", "2 joints"});
  expect_refused(plan("-1,0", "1,1", {"--trajectory", "rso", file}), exit_bad_input, {"rso", "'ros'"});
  expect_refused(plan("-1,0", "1,1", {"--trajectory", "ros"}), exit_bad_input, {"--trajectory"});
  expect_refused(plan("-1,0", "1,1", {"--trajectory", "ros", "/nowhere/motion.yaml", "--json"}),
                 exit_bad_input, {"/nowhere/motion.yaml"});
  EXPECT_EQ(folder_.files(), before);
}

TEST_F(CommandLine, plan_says_no_when_the_trajectory_it_was_asked_for_was_not_written) {
  const std::string csv = folder_.write("motion.csv", "old"), file = folder_.file("plan.json");
  const CommandRun run = plan("-1,0", "1.4,0.1", {"--export", "csv", csv, "--out", file, "--speed", "1e-6"});
  EXPECT_EQ(run.status, exit_no) << run.log;
  EXPECT_NE(run.log.find("no trajectory was written: "), std::string::npos) << run.log;
  EXPECT_NE(run.log.find("motion.csv' stays as it was"), std::string::npos) << run.log;
  EXPECT_EQ(read_file(csv), "old");
  EXPECT_EQ(nlohmann::json::parse(read_file(file))["validation"]["verdict"], "valid");
  EXPECT_EQ(plan("-1,0", "1.4,0.1", {"--motion", "--speed", "1e-6"}).status, exit_no);
  EXPECT_EQ(plan("-1,0", "1.4,0.1", {"--speed", "1e-6", "--view", folder_.file("plan.html")}).status,
            exit_done);
}

TEST_F(CommandLine, a_number_out_of_range_or_not_a_number_is_refused_in_one_short_sentence) {
  const std::string file = folder_.write("log.rawlog", "x");
  for (const char* text : {"nan", "inf", "-1", "0", "1e-9", "1e9", "abc"}) {
    const CommandRun run =
        run_command({"replay", file, "--out", folder_.file("out"), "--resolution=" + std::string(text)});
    expect_refused(run, exit_bad_input, {"--resolution", "0.0001", "'" + std::string(text) + "'"});
    EXPECT_LT(run.log.size(), 200u) << run.log;
  }
  for (const char* flag :
       {"--time-limit=nan", "--time-limit=0", "--seed=-1", "--seed=1.5", "--seed=99999999999999999999999",
        "--scale=nan", "--scale=0", "--padding=nan", "--padding=-1", "--base=nan,0,0"}) {
    const std::string name(flag, std::string_view(flag).find('='));
    const CommandRun run = plan("-1,0", "-1,1", {flag});
    expect_refused(run, exit_bad_input, {name, "expected"});
    EXPECT_LT(run.log.size(), 200u) << run.log;
  }
  for (const auto& [flag, expected] :
       {std::pair{"--time-limit=1e300", "expected a positive number up to 1000000000, got '1e300'"},
        std::pair{"--padding=1e9", "expected a length from 0 to 100 (metres), got '1e9'"},
        std::pair{"--seed=-1", "expected a whole number from 0 to 18446744073709551615, got '-1'"},
        std::pair{"--base=1e300,0,0", "expected numbers from -1000000000 to 1000000000, got '1e300'"}}) {
    const std::string name(flag, std::string_view(flag).find('='));
    expect_refused(plan("-1,0", "-1,1", {flag}), exit_bad_input, {name, expected});
  }
  expect_refused(plan("-1,0", "-1,1", {"--padding=100"}), exit_bad_input,
                 {"with --padding 100 (metres): region of", "more than the limit"});
  expect_refused(plan("-1,0", "-1,1", {"--out", ""}), exit_bad_input, {"--out", "expected a file name"});
  expect_refused(run_command({"inspect", map_, "--at", "1e300,0,0"}), exit_bad_input, {"--at", "beyond"});
}

TEST_F(CommandLine, a_flag_that_may_be_repeated_does_not_swallow_the_file_behind_it) {
  const std::string file = folder_.file("plan.json");
  ASSERT_EQ(plan("-1,0", "1.4,0.1", {"--out", file}).status, exit_done);
  const CommandRun run =
      run_command({"check", "--map", map_, "--robot", "point", "--policy", "not_occupied", file});
  EXPECT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("all parts not_occupied"), std::string::npos) << run.out;
  EXPECT_EQ(
      run_command({"inspect", "--at", "0,0,0", "--slice", "z=0.025", folder_.file("s.png"), map_}).status,
      exit_done);
}

TEST_F(CommandLine, an_output_that_would_replace_a_device_a_folder_or_a_picture_of_another_kind_is_refused) {
  const auto before = folder_.files();
  expect_refused(plan("-1,0", "-1,1", {"--out", "/dev/null"}), exit_bad_input, {"/dev/null"});
  expect_refused(plan("-1,0", "-1,1", {"--out", map_}), exit_bad_input, {map_});
  expect_refused(plan("-1,0", "-1,1", {"--out", folder_.file("a"), "--csv", folder_.file("a")}),
                 exit_bad_input, {"--csv", "--out"});
  expect_refused(run_command({"inspect", map_, "--slice", "z=0.025", folder_.file("s.jpg")}), exit_bad_input,
                 {"s.jpg", ".png"});
  expect_refused(run_command({"inspect", map_, "--slice", "z=0.025"}), exit_bad_input, {"--slice"});
  EXPECT_EQ(folder_.files(), before);
}

TEST_F(CommandLine, a_urdf_without_joints_or_with_nan_is_refused) {
  const std::string empty = folder_.write("stone.urdf", "<robot name='stone'><link name='stone'/></robot>");
  const std::string nan =
      folder_.write("nan.urdf",
                    "<robot name='r'><link name='a'/><link name='b'><collision><geometry><sphere "
                    "radius='nan'/></geometry></collision>"
                    "</link><joint name='j' type='continuous'><parent link='a'/><child link='b'/><axis "
                    "xyz='0 0 1'/></joint></robot>");
  for (const std::string& file : {empty, nan, folder_.file("missing.urdf")}) {
    const CommandRun run = run_command(
        {"plan", "--map", map_, "--robot", file, "--start", "0", "--goal", "1", "--planner", "beam"});
    expect_refused(run, exit_bad_input, {std::filesystem::path(file).filename().string()});
  }
}

TEST_F(CommandLine, check_refuses_a_plan_file_that_is_not_one) {
  const std::string text = folder_.write("plan.json", "{\"robot\": \"point\"}");
  expect_refused(run_command({"check", "--map", map_, "--robot", "point", text}), exit_bad_input,
                 {"plan.json"});
  expect_refused(run_command({"check", "--map", map_, "--robot", "point", folder_.write("p.json", "{")}),
                 exit_bad_input, {"p.json"});
}

}  // namespace command_line_test
}  // namespace clearway
