// `plan --pick`, and plans edited so that they pick otherwise, as `check` sees them.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mapping/files/map_file.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/expect_words.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace pick_command_test {

using Json = nlohmann::json;

/// A can on a table, and where it goes.
class PickCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const VoxelScene scene{
        0.02,
        {box_of(0.24, -0.46, 0.04, 0.7, 0.46, 0.099), box_of(0.4, 0.14, 0.1, 0.44, 0.18, 0.22)},
        {},
        {}};
    save_map(scene.snapshot(), folder_->path() / "map");
    const std::string pick = folder_->write(
        "pick.yaml",
        "{name: can, cylinder: [0.03, 0.12], link: hand, pose: [0.42, 0.16, 0.16, 0, 0, 0], mass: 0.3, "
        "place: [0.42, -0.2, 0.16, 0, 0, 0], grasp_deg: [0, 0, 0.04, 180, 0, 0]}");
    plan_ = new CommandRun(
        run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6", "--policy", "not_occupied",
                     "--start=0,-1.9,1.7,-1.4,-1.57,0", "--pick", pick, "--out", folder_->file("plan.json"),
                     "--view", folder_->file("plan.html")}));
  }
  static void TearDownTestSuite() {
    delete plan_;
    delete folder_;
  }

  static CommandRun check(const Json& plan, std::vector<std::string> more) {
    std::vector<std::string> arguments{"check",   "--map", folder_->file("map"),
                                       "--robot", "arm6",  folder_->write("edited.json", plan.dump())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  static Json written() { return Json::parse(read_file(folder_->file("plan.json"))); }

  static TemporaryFolder* folder_;
  static CommandRun* plan_;
};
TemporaryFolder* PickCommand::folder_ = nullptr;
CommandRun* PickCommand::plan_ = nullptr;

TEST_F(PickCommand, takes_a_can_and_puts_it_down) {
  ASSERT_EQ(plan_->status, exit_done) << plan_->out << plan_->log;
  expect_words(plan_->out, {"can: approach, reach, lift, carry, lower, retreat", "6 of 6", "valid"});
  EXPECT_EQ(written()["loads"][0]["legs"], Json({3, 4, 5}));
  EXPECT_TRUE(std::filesystem::exists(folder_->file("plan.html")));
}

/// The trajectory has the fingers open on the way, closed while the can rides, and open at the end; a pick
/// that states other fingers is another one.
TEST_F(PickCommand, closes_the_fingers_of_a_hand_and_opens_them) {
  const worlds::UrdfRobot made = worlds::gripper();
  const std::string robot = made.robot().source.string(), out = folder_->file("fingers.json");
  const auto pick = [&](const std::string& grip) {
    return folder_->write(
        "fingers.yaml",
        "{name: can, cylinder: [0.015, 0.12], link: palm, touches: [left, right], pose: [0.42, "
        "0.16, 0.16, 0, 0, 0], place: [0.42, -0.2, 0.16], grasp: [0, 0, 0, 0, 0, 0]" +
            grip + "}");
  };
  const std::vector<std::string> terms{"--map", folder_->file("map"), "--robot",      robot,   "--tip",
                                       "tcp",   "--policy",           "not_occupied", "--pick"};
  const auto run = [&](std::vector<std::string> arguments, const std::string& file) {
    arguments.insert(arguments.begin() + 1, terms.begin(), terms.end());
    arguments.insert(arguments.begin() + 1 + static_cast<std::ptrdiff_t>(terms.size()), file);
    return run_command(arguments);
  };
  const std::string stated = ", grip: {grip: [0.03, 0.002]}", csv = folder_->file("fingers.csv");
  const CommandRun planned =
      run({"plan", "--start=-0.3,0,0.5,0.4,0.012", "--out", out, "--motion", "--trajectory", "csv", csv},
          pick(stated));
  ASSERT_EQ(planned.status, exit_done) << planned.out << planned.log;
  std::vector<double> values;
  std::istringstream lines(read_file(csv));
  std::string line, head;
  std::getline(lines, head);
  ASSERT_TRUE(head.starts_with("time_s,jx,jy,jz,turn,grip,")) << head;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (int i = 0; i < 6; ++i) std::getline(cells, head, ',');
    values.push_back(std::stod(head));
  }
  EXPECT_NEAR(values.front(), 0.012, 1e-6);
  EXPECT_NEAR(values.back(), 0.03, 1e-6);
  EXPECT_NEAR(*std::min_element(values.begin(), values.end()), 0.002, 1e-6);
  EXPECT_NEAR(*std::max_element(values.begin(), values.end()), 0.03, 1e-6);
  EXPECT_EQ(run({"check", out}, pick(stated)).status, exit_done) << run({"check", out}, pick(stated)).out;
  EXPECT_EQ(run({"check", out}, pick("")).status, exit_no);
  const CommandRun other = run({"check", out}, pick(", grip: {grip: [0.03, 0.001]}"));
  EXPECT_EQ(other.status, exit_no);
  expect_words(other.out, {"joint 'grip' not closed"});
  for (const char* nothing : {", grip:", ", grip: {}"}) {
    const CommandRun none = run({"check", out}, pick(nothing));
    EXPECT_EQ(none.status, exit_bad_input) << nothing;
    expect_words(none.log, {"fingers.yaml", "grip"});
  }
  const CommandRun tip = run({"check", out}, pick(", grip: {turn: [0.03, 0]}"));
  EXPECT_EQ(tip.status, exit_bad_input);
  expect_words(tip.log, {"joint 'turn': expected a joint of the hand"});
  const CommandRun wrong = run({"check", out}, pick(", grip: {grip: [0.03]}"));
  EXPECT_EQ(wrong.status, exit_bad_input);
  expect_words(wrong.log, {"fingers.yaml", "grip", "2 numbers"});
}

/// The robot's own tip is 0.13 m before the frame of link `hand`, which --tip names.
TEST_F(PickCommand, names_the_tip_and_takes_another_one) {
  EXPECT_EQ(written()["tip"], "own tip on hand");
  expect_words(plan_->out, {"tip", "own tip on hand"});
  EXPECT_EQ(plan_->out.find("nothing that the map knows"), std::string::npos);
  const std::string out = folder_->file("tip.json"),
                    deeper = folder_->write(
                        "deeper.yaml",
                        "{name: can, cylinder: [0.03, 0.12], link: hand, pose: [0.42, 0.16, 0.16, 0, 0, 0], "
                        "mass: 0.3, place: [0.42, -0.2, 0.16], grasp_deg: [0, 0, 0.17, 180, 0, 0]}");
  const auto plan = [&](const std::string& tip) {
    return run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6", "--policy", "not_occupied",
                        "--start=0,-1.9,1.7,-1.4,-1.57,0", "--pick", deeper, "--out", out, "--tip", tip});
  };
  const CommandRun by_frame = plan("hand");
  ASSERT_EQ(by_frame.status, exit_done) << by_frame.out << by_frame.log;
  const auto checked = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--policy", "not_occupied", "--pick", deeper});
    return check(Json::parse(read_file(out)), more);
  };
  EXPECT_EQ(checked({"--tip", "hand"}).status, exit_done) << checked({"--tip", "hand"}).out;
  expect_words(checked({"--tip", "hand"}).out, {"link hand (flag)"});
  const CommandRun by_plan =
      run_command({"check", out, "--map", folder_->file("map"), "--robot", "arm6", "--accept-load"});
  expect_words(by_plan.out, {"link hand (plan)"});
  const CommandRun by_default = checked({});
  EXPECT_EQ(by_default.status, exit_no);
  expect_words(by_default.out, {"own tip on hand (default)", "the tip takes the object 0.13 m",
                                "the plan was made for the tip 'hand'"});
  // The hand turns against the link before its last joint.
  const Robot robot = load_robot("arm6");
  auto moved = static_cast<std::size_t>(robot.tip_link);
  while (robot.links[moved].joint < 0) moved = static_cast<std::size_t>(robot.links[moved].parent);
  const std::string before = robot.links[static_cast<std::size_t>(robot.links[moved].parent)].name;
  const CommandRun refused = checked({"--tip", before});
  EXPECT_EQ(refused.status, exit_no);
  expect_words(refused.out, {"moves link 'hand'", "the plan was made for the tip 'hand'; it is judged for"});
  const CommandRun turning = plan(before);
  EXPECT_EQ(turning.status, exit_bad_input);
  expect_words(turning.log,
               {"moves link 'hand', which carries the object, against the tip, link '" + before});
}

TEST_F(PickCommand, notes_a_place_with_nothing_below) {
  const std::string out = folder_->file("floating.json");
  const CommandRun run = run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6", "--policy",
                                      "not_occupied", "--start=0,-1.9,1.7,-1.4,-1.57,0", "--pick",
                                      folder_->file("pick.yaml"), "--place", "0.42,-0.2,0.3", "--out", out});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const std::string words = "nothing that the map knows stands below the place of 'can'";
  expect_words(run.out, {words});
  const CommandRun checked =
      check(Json::parse(read_file(out)),
            {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml"), "--place", "0.42,-0.2,0.3"});
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  expect_words(checked.out, {words});
  EXPECT_EQ(
      check(written(), {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml")}).out.find(words),
      std::string::npos);
}

TEST_F(PickCommand, check_never_takes_the_pick_from_the_plan) {
  const CommandRun without = check(written(), {"--policy", "not_occupied"});
  EXPECT_EQ(without.status, exit_no);
  expect_words(without.out, {"expected --pick, because the plan takes the voxels of 'can' out of the map"});
  const CommandRun with =
      check(written(), {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml")});
  EXPECT_EQ(with.status, exit_done) << with.out << with.log;
  expect_words(with.out, {"can (flag)"});
  const CommandRun accepted = check(written(), {"--policy", "not_occupied", "--accept-load"});
  EXPECT_EQ(accepted.status, exit_done) << accepted.out;
  const CommandRun elsewhere = check(written(), {"--policy", "not_occupied", "--pick",
                                                 folder_->file("pick.yaml"), "--place", "0.42,-0.21,0.16"});
  EXPECT_EQ(elsewhere.status, exit_no);
  expect_words(elsewhere.out,
               {"the plan says another shape, pose, grasp, place, way or grip", "from its place"});
}

TEST_F(PickCommand, moves_smoothly_and_check_proves_the_motion_with_the_pick_that_is_stated) {
  const std::string pick = folder_->file("pick.yaml"), file = folder_->file("moving.json");
  const CommandRun run =
      run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6", "--policy", "not_occupied",
                   "--start=0,-1.9,1.7,-1.4,-1.57,0", "--pick", pick, "--out", file, "--grip-time", "0.4",
                   "--trajectory", "urscript", folder_->file("moving.script")});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  expect_words(run.out, {"corners", "motion check", "valid"});
  expect_words(read_file(folder_->file("moving.script")), {"attach(\"can\")", "detach(\"can\")"});
  const Json plan = Json::parse(read_file(file));
  const CommandRun checked = check(plan, {"--policy", "not_occupied", "--pick", pick});
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  expect_words(checked.out, {"valid: "});
  EXPECT_EQ(check(plan, {"--policy", "not_occupied"}).status, exit_no);
  const CommandRun lower =
      check(plan, {"--policy", "not_occupied", "--pick", pick, "--place", "0.42,-0.2,0.161"});
  EXPECT_EQ(lower.status, exit_no);
  Json hasty = plan;
  hasty["motion"]["grip_time_s"] = 0.8;
  const CommandRun refused = check(hasty, {"--policy", "not_occupied", "--pick", pick});
  EXPECT_EQ(refused.status, exit_no);
  expect_words(refused.out, {"after leg 2 it does not rest for 0.8 s"});
  const auto with_grip = [&](const Json& of, const std::string& seconds) {
    return check(of, {"--policy", "not_occupied", "--pick", pick, "--grip-time", seconds});
  };
  const CommandRun longer = with_grip(plan, "0.5"), shorter = with_grip(plan, "0.3");
  EXPECT_EQ(longer.status, exit_no);
  expect_words(longer.out, {"0.5 s of a motion (flag)", "after leg 2 it does not rest for 0.5 s"});
  EXPECT_EQ(shorter.status, exit_done) << shorter.out;
  Json hurried = plan;
  hurried["motion"]["grip_time_s"] = 0.1;
  EXPECT_EQ(with_grip(hurried, "0.5").status, exit_no);
  expect_words(checked.out, {"0.4 s of a motion (plan)"});
}

TEST_F(PickCommand, urscript_takes_steps_of_the_controller_alone) {
  for (const char* period : {"0.001", "0.003", "0.0025"}) {
    const CommandRun run = run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6",
                                        "--start=0,0,0,0,0,0", "--goal=1,0,0,0,0,0", "--period", period,
                                        "--trajectory", "urscript", folder_->file("odd.script")});
    EXPECT_EQ(run.status, exit_bad_input);
    expect_words(run.log, {std::string("a multiple of 0.002 s, the controller's step, got ") + period});
  }
}

TEST_F(PickCommand, nothing_rides_beside_what_is_picked) {
  const std::string bar = folder_->write("bar.yaml", "{name: bar, box: [0.6, 0.6, 0.01], link: hand}");
  const std::vector<std::string> both{
      "--policy", "not_occupied", "--pick", folder_->file("pick.yaml"), "--attach", bar};
  EXPECT_EQ(check(written(), both).status, exit_bad_input);
  Json plan = written();
  plan["loads"].push_back(plan["loads"][0]);
  plan["loads"][1]["name"] = "bar";
  plan["loads"][1]["shape"] = {{"box", {0.6, 0.6, 0.01}}};
  EXPECT_NE(check(plan, {both.begin(), both.begin() + 4}).status, exit_done);
  EXPECT_NE(check(plan, {"--policy", "not_occupied", "--accept-load"}).status, exit_done);
}

TEST_F(PickCommand, an_object_of_too_many_voxels_is_refused_at_once) {
  const std::string huge =
      folder_->write("huge.yaml",
                     "{name: can, box: [100, 100, 100], link: hand, pose: [0, 0, 50, 0, 0, 0], place: [1, 0, "
                     "50, 0, 0, 0], grasp_deg: [0, 0, 0.04, 180, 0, 0]}");
  const CommandRun run = run_command({"plan", "--map", folder_->file("map"), "--robot", "arm6", "--policy",
                                      "not_occupied", "--start=0,-1.9,1.7,-1.4,-1.57,0", "--pick", huge});
  EXPECT_EQ(run.status, exit_bad_input);
  expect_words(run.log, {"at most 10 million voxels"});
}

TEST_F(PickCommand, a_plan_that_loosens_its_pick_in_its_file_is_refused) {
  Json plan = written();
  plan["loads"][0]["pose"][2][3] = plan["loads"][0]["pose"][2][3].get<double>() - 0.02;
  const CommandRun moved = check(plan, {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml")});
  EXPECT_EQ(moved.status, exit_no);
  expect_words(moved.out, {"the load rides"});
  plan = written();
  plan.erase("loads");
  EXPECT_EQ(check(plan, {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml")}).status, exit_no);
  plan = written();
  plan.erase("pick");
  EXPECT_EQ(check(plan, {"--policy", "not_occupied", "--pick", folder_->file("pick.yaml")}).status, exit_no);
}

/// Points in every voxel of a table's top and of a can, seen from the origin.
std::string cloud_of_can() {
  std::ostringstream points;
  int count = 0;
  const auto add_box = [&](const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    for (double x = low.x(); x <= high.x(); x += 0.02)
      for (double y = low.y(); y <= high.y(); y += 0.02)
        for (double z = low.z(); z <= high.z(); z += 0.02, ++count)
          points << x << ' ' << y << ' ' << z << '\n';
  };
  add_box({0.25, -0.45, 0.05}, {0.69, 0.45, 0.1});
  add_box({0.41, 0.15, 0.11}, {0.44, 0.18, 0.22});
  const std::string size = std::to_string(count);
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + size +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + size + "\nDATA ascii\n" + points.str();
}

TEST(PickOfASetup, IsPlannedAndChecksByTheMapsRecord) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scans");
  folder.write("scans/100.pcd", cloud_of_can());
  folder.write(
      "s.yaml",
      "map: {resolution: 0.02}\nrobot: {name: arm6}\nqueries:\n  - {name: carry, start: [0, -1.9, 1.7, "
      "-1.4, -1.57, 0], planners: [rrtconnect], policies: {default: not_occupied}, allow_outside: "
      "[all], pick: {name: can, cylinder: [0.03, 0.12], link: hand, pose: [0.42, 0.16, 0.16, 0, 0, "
      "0], mass: 0.3, place: [0.42, -0.2, 0.16, 0, 0, 0], grasp_deg: [0, 0, 0.04, 180, 0, 0]}}\n");
  const CommandRun run = run_command(
      {"replay", folder.file("scans"), "--setup", folder.file("s.yaml"), "--out", folder.file("map")});
  ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  const std::string file = folder.file("map/plans/carry-rrtconnect.json");
  EXPECT_EQ(Json::parse(read_file(file))["pick"]["name"], "can");
  const CommandRun checked = run_command({"check", file, "--map", folder.file("map"), "--robot", "arm6"});
  EXPECT_EQ(checked.status, exit_done) << checked.out << checked.log;
  expect_words(checked.out, {"can (map)"});
  Json plan = Json::parse(read_file(file));
  plan["pick"]["place"][1][3] = -0.19;  // what the plan says of its pick does not count
  EXPECT_EQ(run_command({"check", folder.write("p.json", plan.dump()), "--map", folder.file("map"), "--robot",
                         "arm6"})
                .status,
            exit_no);
}

}  // namespace pick_command_test
}  // namespace clearway
