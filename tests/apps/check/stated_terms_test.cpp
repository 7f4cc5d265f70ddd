// What exported trajectories say of robot, base, group, held joints and map, at `clearway check`.
#include "apps/check/stated_terms.hpp"

#include <filesystem>

#include "planning/files/trajectory_file.hpp"
#include "tests/apps/check/check_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace check_test {

/// Exports of an arm of two joints with a finger at 3 cm, its base 5 cm up, in a map of one voxel far away.
class CheckExports : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("arm.urdf", worlds::arm_with_finger());
    folder_.write("arm.srdf",
                  "<robot name='arm'><group name='arm'><chain base_link='base' tip_link='lower'/></group>"
                  "<group name='same'><joint name='shoulder'/><joint name='elbow'/></group></robot>");
    save_map_of({3.0F, 3.0F, 3.0F}, "map");
    const CommandRun run = plan(
        {"--trajectory", "ros", folder_.file("way.yaml"), "--trajectory", "json", folder_.file("way.json")});
    ASSERT_EQ(run.status, exit_done) << run.out << run.log;
  }

  CommandRun plan(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"plan",
                                       "--map",
                                       folder_.file("map"),
                                       "--robot",
                                       folder_.file("arm.urdf"),
                                       "--policy",
                                       "not_occupied",
                                       "--group",
                                       "arm",
                                       "--fix",
                                       "grip=0.03",
                                       "--base=0,0,0.05",
                                       "--start=0,0.1",
                                       "--goal=0.5,-0.1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }

  CommandRun check(const std::string& file, std::vector<std::string> more = {},
                   const std::string& robot = "arm.urdf", const std::string& map = "map") const {
    more.insert(more.begin(), {"check", folder_.file(file), "--map", folder_.file(map), "--robot",
                               folder_.file(robot), "--policy", "not_occupied", "--json"});
    return run_command(more);
  }

  void save_map_of(const Eigen::Vector3f& point, const std::string& name) const {
    FreeSpaceMap map({.resolution = 0.05});
    Scan scan;
    scan.points = {point};
    map.insert(scan);
    save_map(map.snapshot(), folder_.path() / name);
  }

  TemporaryFolder folder_;
};

TEST_F(CheckExports, TheyAreJudgedForTheRobotThatTheyState) {
  for (const char* file : {"way.yaml", "way.json"}) {
    const CommandRun run = check(file);
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    const Json contract = Json::parse(run.out)["contract"];
    EXPECT_EQ(contract["group"], Json({{"value", "arm"}, {"source", "plan"}}));
    EXPECT_EQ(contract["held"]["grip"], Json({{"value", 0.03}, {"source", "plan"}}));
    EXPECT_EQ(contract["base"]["source"], "plan");
    EXPECT_EQ(contract["base"]["value"][2], 0.05);
    EXPECT_EQ(check(file, {"--group", "arm", "--fix", "grip=0.03", "--base=0,0,0.05"}).status, exit_done);
  }
}

TEST_F(CheckExports, WhatDiffersIsRefusedUnlessItIsAccepted) {
  folder_.write("other.urdf", worlds::arm_with_finger());
  folder_.write("other.srdf", read_file(folder_.file("arm.srdf")));
  save_map_of({3.0F, 3.2F, 3.0F}, "later");
  for (const char* file : {"way.yaml", "way.json"}) {
    const auto expect_refused = [&](const std::vector<std::string>& flags, const std::string& term,
                                    const std::string& words, const std::string& robot = "arm.urdf",
                                    const std::string& in = "map") {
      const CommandRun run = check(file, flags, robot, in);
      EXPECT_EQ(run.status, exit_no) << file << words << run.log;
      EXPECT_EQ(refused_terms(run), Terms{term}) << file;
      EXPECT_NE(run.out.find(words), std::string::npos) << run.out;
      std::vector<std::string> accepting = flags;
      accepting.push_back("--accept-" + term);
      const CommandRun accepted = check(file, accepting, robot, in);
      EXPECT_EQ(accepted.status, exit_done) << file << words << accepted.out;
    };
    expect_refused({"--fix", "grip=0.05"}, "held",
                   "joint grip: expected to stand at 0.05, the plan says 0.03");
    expect_refused({"--base=0.5,0,0"}, "base", "base: expected ");
    expect_refused({"--group", "same"}, "held", "group: expected 'same', the trajectory says 'arm'");
    expect_refused({"--scale", "2"}, "scale", "scale: expected 2, the plan says 1");
    expect_refused({}, "robot", "robot: expected '", "other.urdf");
    expect_refused({}, "map", "the plan was made on another", "arm.urdf", "later");
  }
}

/// A bar that reaches across to a voxel that the arm alone never comes near.
TEST_F(CheckExports, ALoadThatRidesAllTheWayDoesSoAtTheCheckToo) {
  folder_.write("bar.yaml", "{name: bar, link: lower, box: [0.04, 0.6, 0.04], pose: [0.2, 0.3, 0, 0, 0, 0]}");
  const CommandRun planned =
      plan({"--attach", folder_.file("bar.yaml"), "--payload", "0.5", "--trajectory", "ros",
            folder_.file("carries.yaml"), "--trajectory", "json", folder_.file("carries.json")});
  ASSERT_EQ(planned.status, exit_done) << planned.out << planned.log;
  save_map_of({0.32F, 0.8F, 0.05F}, "beside");
  for (const char* file : {"carries.yaml", "carries.json"}) {
    const CommandRun run = check(file);
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    const Json said = Json::parse(run.out);
    EXPECT_NE(said["contract"]["loads"].dump().find("\"bar\""), std::string::npos) << run.out;
    const CommandRun hit = check(file, {"--accept-map", "--allow-outside", "all"}, "arm.urdf", "beside");
    EXPECT_EQ(hit.status, exit_no) << hit.out;
    EXPECT_NE(hit.out.find("bar comes too near"), std::string::npos) << hit.out;
    EXPECT_EQ(check(file, {"--attach", folder_.file("bar.yaml")}).status, exit_done);
    folder_.write("long.yaml",
                  "{name: bar, link: lower, box: [0.04, 0.7, 0.04], pose: [0.2, 0.3, 0, 0, 0, 0]}");
    EXPECT_EQ(refused_terms(check(file, {"--attach", folder_.file("long.yaml")})), Terms{"load"});
    EXPECT_EQ(refused_terms(check(file, {"--payload", "0.6"})), Terms{"payload"});
  }
  const CommandRun bare = check("way.yaml", {"--accept-map", "--allow-outside", "all"}, "arm.urdf", "beside");
  EXPECT_EQ(bare.status, exit_done) << bare.out;
}

/// As a plan's own JSON: what flags state is judged, and what the file says beside it is told.
TEST_F(CheckExports, TheGravityThatTheyWerePlannedUnderIsJudged) {
  const CommandRun planned =
      plan({"--payload", "0.5", "--gravity=0,0,-1.62", "--trajectory", "ros", folder_.file("moon.yaml"),
            "--trajectory", "json", folder_.file("moon.json"), "--trajectory", "ros-json",
            folder_.file("moon.ros.json")});
  ASSERT_EQ(planned.status, exit_done) << planned.out << planned.log;
  EXPECT_NE(planned.log.find("a trajectory as ros-json does not say what the robot carries and its gravity: "
                             "clearway check needs --payload, --gravity for it"),
            std::string::npos)
      << planned.log;
  for (const char* file : {"moon.yaml", "moon.json"}) {
    const Json contract = Json::parse(check(file).out)["contract"];
    EXPECT_EQ(contract["gravity"], Json({{"value", {0.0, 0.0, -1.62}}, {"source", "plan"}})) << file;
    EXPECT_NE(contract["notes"].dump().find("the gravity is the plan's"), std::string::npos) << file;
    const CommandRun flag = check(file, {"--gravity=0,0,-9.81"});
    EXPECT_EQ(refused_terms(flag), Terms{"payload"}) << file;
    EXPECT_EQ(Json::parse(flag.out)["contract"]["gravity"]["source"], "flag");
    EXPECT_EQ(check(file, {"--gravity=0,0,-1.62"}).status, exit_done) << file;
  }
  EXPECT_EQ(read_file(folder_.file("way.yaml")).find("gravity"), std::string::npos);
  const CommandRun foreign = check("way.yaml", {"--gravity=0,0,-1.62"});
  EXPECT_EQ(foreign.status, exit_done) << foreign.out;
}

/// As exports of JSON were until they named it.
TEST_F(CheckExports, AScaleThatIsNotStatedIsNotCompared) {
  Json json = Json::parse(read_file(folder_.file("way.json")));
  json.erase("scale");
  folder_.write("older.json", json.dump());
  folder_.write("half.yaml", "urdf: arm.urdf\nscale: 0.5\nsrdf: arm.srdf\n");
  const CommandRun run = check("older.json", {}, "half.yaml");
  for (const std::string& term : refused_terms(run)) EXPECT_NE(term, "scale") << run.out;
  EXPECT_EQ(Json::parse(run.out)["contract"]["scale"]["value"], 0.5);
}

/// Then the joints that it holds, and flags, say what stands still.
TEST_F(CheckExports, AStatedGroupThatTheRobotHasNotSaysNothing) {
  std::filesystem::remove(folder_.path() / "arm.srdf");
  for (const char* file : {"way.yaml", "way.json"})
    EXPECT_EQ(check(file, {"--fix", "grip=0.03"}).status, exit_done)
        << check(file, {"--fix", "grip=0.03"}).log;
}

/// Of other programs: comments that are none of ours, and none at all.
TEST_F(CheckExports, AFileThatStatesNothingIsJudgedAsBefore) {
  const std::string text = read_file(folder_.file("way.yaml"));
  const std::string points = text.substr(text.find("header:"));
  const std::vector<std::string> flags{"--group", "arm", "--fix", "grip=0.05", "--base=0.5,0,0"};
  for (const char* comment :
       {"", "# base: link0, group: hand\n", "# trajectory_msgs/JointTrajectory\n# base: mine\n"}) {
    folder_.write("foreign.yaml", comment + points);
    const CommandRun run = check("foreign.yaml", flags);
    EXPECT_EQ(run.status, exit_done) << run.out << run.log;
    EXPECT_EQ(Json::parse(run.out)["deviations"], Json::array());
  }
  Json json = Json::parse(read_file(folder_.file("way.json")));
  json.erase("base");
  folder_.write("foreign.json", json.dump());
  EXPECT_EQ(check("foreign.json", flags).status, exit_done);
}

TEST_F(CheckExports, CommentsThatWereEditedWronglyAreNamed) {
  const std::string text = read_file(folder_.file("way.yaml"));
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string edited = text;
    const std::size_t at = edited.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    folder_.write("edited.yaml", edited.replace(at, edited.find('\n', at) - at, to));
    const CommandRun run = check("edited.yaml");
    EXPECT_EQ(run.status, exit_bad_input) << run.out;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    return run.log;
  };
  for (const char* base : {"# base: at 1, 2 m, quaternion x y z w 0, 0, 0, 1", "# base: at 0, 0, 0",
                           "# base: at 0, 0, nan m, quaternion x y z w 0, 0, 0, 1",
                           "# base: at 0, 0, 0 m, quaternion x y z w 0, 0, 0, 0"})
    EXPECT_NE(refusal("# base: ", base).find("expected 'at X, Y, Z m, quaternion"), std::string::npos)
        << base;
  EXPECT_NE(refusal("# held: ", "# held: grip at 0.03").find("expected a name in quotes, then ' at …'"),
            std::string::npos);
  EXPECT_NE(refusal("# held: ", "# held: \"grip\" at closed").find("expected a finite number"),
            std::string::npos);
  EXPECT_NE(refusal("# group: ", "# group: \"arm").find("expected a name in quotes"), std::string::npos);
  EXPECT_NE(
      refusal("# points: ", "# at 1.5 s: attach \"can\", at rest for 1 s").find("is in the plan's JSON"),
      std::string::npos);
  EXPECT_NE(refusal("# points: ", "# payload: -3").find("expected a mass of 0 to 1e6 kg"), std::string::npos);
  for (const char* gravity : {"# gravity: 0, -9.81", "# gravity: 0, 0, down", "# gravity: 0, 0, -2000"})
    EXPECT_NE(refusal("# points: ", gravity).find("expected 'X, Y, Z' of at most 1000 m/s^2"),
              std::string::npos)
        << gravity;
  EXPECT_NE(refusal("# points: ", "# carries: [{\"name\":").find("expected loads as JSON"),
            std::string::npos);
  EXPECT_NE(
      refusal("# points: ",
              "# carries: [{\"name\":\"can\",\"link\":\"lower\",\"pose\":[[1,0,0,0],[0,1,0,0],[0,0,1,0],"
              "[0,0,0,1]],\"shape\":{\"sphere\":0.1},\"mass_kg\":1,\"touches\":[],\"legs\":[5]}]")
          .find("ride all the way, without 'legs'"),
      std::string::npos);
  Json json = Json::parse(read_file(folder_.file("way.json")));
  json["base"]["quaternion_xyzw"] = {0, 0, 0, 0};
  folder_.write("edited.json", json.dump());
  EXPECT_TRUE(check("edited.json").complains_in_one_sentence());
  folder_.write("way.script", "def clearway_path():\nend\n");
  EXPECT_NE(check("way.script").log.find("a program is for its controller, expected a plan's JSON"),
            std::string::npos);
}

/// Whatever names there are.
TEST(StatedTerms, AreReadBackAsTheyWereWritten) {
  Robot robot;
  robot.links.push_back({});
  robot.joints.push_back({});
  robot.joints[0].name = "j";
  Plan plan;
  plan.robot = "a \"b\", scale 3\n# base: at";
  plan.robot_scale = 1.0 / 3.0;
  plan.group = "# held: \"x\" at 1";
  plan.held = {{"a\" at 7", -0.1}, {"", 1e-17}, {"wheel, left", 1e5}};
  plan.map_file = "m\", sha256 \"0";
  plan.map_sha256 = std::string(64, 'e');
  plan.map_from_base =
      Eigen::Translation3d(0.1, -2e-9, 3.0) * Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, -2, 3).normalized());
  Load can;
  can.name = "can \"1\"\n";
  can.link = "hand";
  can.link_from_load = plan.map_from_base;
  can.shape = Shape::cylinder(0.03, 1.0 / 7.0);
  can.mass = 0.3;
  can.touches = {"finger, left"};
  plan.loads = {{can, {}}};
  plan.payload = 1.0 / 3.0;
  plan.gravity = {1e-17, -1.0 / 3.0, 1.62};
  Trajectory trajectory;
  trajectory.sampling_period = 0.008;
  trajectory.points.push_back({0.0, Configuration::Zero(1), Configuration::Zero(1), {}});
  const auto written = [&](const char* format) {
    return trajectory_format(format, robot).write(robot, plan, trajectory);
  };
  const auto yaml = stated_in_comments(written("ros"), "t.yaml"),
             json = stated_in_json(YamlFields(written("json"), "t.json"), written("json"), "t.json");
  for (const auto& stated : {yaml, json}) {
    ASSERT_TRUE(stated);
    Plan read;
    state_terms(*stated, read);
    EXPECT_EQ(read.robot, plan.robot);
    EXPECT_EQ(read.robot_scale, plan.robot_scale);
    EXPECT_EQ(read.group, plan.group);
    EXPECT_EQ(read.held, plan.held);
    EXPECT_EQ(read.map_sha256, plan.map_sha256);
    EXPECT_TRUE(read.map_from_base.isApprox(plan.map_from_base, 1e-12));
    ASSERT_EQ(read.loads.size(), 1U);
    EXPECT_TRUE(is_same(read.loads[0].load, can));
    EXPECT_EQ(read.payload, plan.payload);
    EXPECT_EQ(read.gravity, plan.gravity);
  }
}

}  // namespace check_test
}  // namespace clearway
