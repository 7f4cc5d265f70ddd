// Frames of scenes and requests: which are known, and that nothing is lost for one that is not.
#include "apps/problem_sets/scene_frames.hpp"

#include <numbers>

#include "datasets/descriptions/suite.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/problem_sets/import_fixture.hpp"

namespace clearway {
namespace import_test {

std::string object_in(const std::string& frame) {
  return "world: {collision_objects: [{id: box, header: {frame_id: " + frame +
         "}, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [0.05, 0.05, "
         "0.05]}]}]}\n";
}

std::string placed(const std::string& header, const std::string& child, double x) {
  return "{header: {frame_id: " + header + "}, child_frame_id: " + child + ", transform: {translation: [" +
         std::to_string(x) + ", 0, 0], rotation: [0, 0, 0, 1]}}";
}

std::string transforms(const std::string& list) { return "fixed_frame_transforms: [" + list + "]\n"; }

std::string state(double shoulder, double elbow) {
  return "{joint_state: {name: [shoulder, elbow, grip], position: [" + std::to_string(shoulder) + ", " +
         std::to_string(elbow) + ", 0]}}\n";
}

/// Where the one small object of a scene stands, or why it is refused.
class ImportFrames : public Import {
 protected:
  CommandRun import_scene(const std::string& text, const Arguments& more = {}) {
    std::filesystem::remove_all(folder_ / "out");
    return import("mbm", {folder_.write("s.yaml", text)}, more);
  }

  /// In the middle of its voxel, unless `count` says how many it may meet.
  void expect_at(const std::string& scene, const Eigen::Vector3d& at, std::size_t count = 1) {
    const CommandRun run = import_scene(scene);
    ASSERT_EQ(run.status, exit_done) << run.log << scene;
    EXPECT_LE(map("s").counts().occupied, count) << scene;
    EXPECT_EQ(map("s").state(at), VoxelState::occupied) << scene;
  }

  void expect_refused(const std::string& scene, const std::string& words) {
    const CommandRun run = import_scene(scene);
    EXPECT_EQ(run.status, exit_bad_input) << scene;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("s.yaml'"), std::string::npos) << run.log;
    EXPECT_NE(run.log.find(words), std::string::npos) << run.log;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
};

const Eigen::Vector3d near_origin(0.05, 0.05, 0.05);

/// The state of a robot whose base stands where `transforms` say, in `frame`.
std::string based(const std::string& transforms, const std::string& frame = "world") {
  return "multi_dof_joint_state: {header: {frame_id: " + frame + "}, joint_names: [v], transforms: [" +
         transforms + "]}";
}

/// 1 m along x, turned by a quarter about z: the world's y is the base's x.
const std::string turned_base =
    "{translation: [1, 0, 0], rotation: [0, 0, 0.70710678118654752, 0.70710678118654752]}";

TEST_F(ImportFrames, AWorldThatWouldLoseAnObjectForItsFrameIsRefusedUnlessAFlagAllowsIt) {
  expect_refused(
      object_in("kinect"),
      "object 'box' in frame 'kinect', which is unknown, expected one of map, odom, world, arm_base, "
      "base; --leave-out-unknown-frames imports the rest");
  const CommandRun run = import_scene(object_in("kinect"), {"--leave-out-unknown-frames", "--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  EXPECT_EQ(Json::parse(run.out)["left_out"],
            Json{"s.yaml: object 'box' in frame 'kinect', which is not the map's"});
  const std::string hand =
      "robot_state: {attached_collision_objects: [{link_name: lower, object: {id: mug, header: {frame_id: "
      "kinect}, primitives: [{type: sphere, dimensions: [0.01]}]}}]}\n";
  expect_refused(hand + "world: {}\n", "attached body 'mug' stands in frame 'kinect', which is unknown");
  EXPECT_EQ(import_scene(hand + "world: {}\n", {"--leave-out-unknown-frames"}).status, exit_done);
}

TEST_F(ImportFrames, TheRootAndFramesThatAScenePlacesInThemselvesAreTheMap) {
  expect_at(object_in("base"), near_origin);
  expect_at(transforms(placed("plan", "plan", 0)) + object_in("/plan"), near_origin);
  expect_refused(transforms(placed("plan", "plan", 1)) + object_in("plan"),
                 "expected none that moves frame 'plan' against itself");
  for (const char* usual : {"world", "map", "odom"}) expect_at(object_in(usual), near_origin);
}

/// A map is about the base, wherever the scene has that.
TEST_F(ImportFrames, ASceneThatMovesTheRobotsBaseIsSeenFromThere) {
  const auto with = [](const std::string& state, const std::string& frame, const std::string& more = "") {
    return "robot_state: {" + state + "}\n" + more + object_in(frame);
  };
  const Eigen::Vector3d from_base(0.05, 0.95, 0.05);
  for (const char* frame : {"world", "\"\"", "odom"})
    expect_at(with(based(turned_base, frame), "world"), from_base);
  expect_at(with(based(turned_base), "base"), near_origin);
  const std::string plan = transforms(placed("plan", "plan", 0) + ", " + placed("table", "plan", 1));
  expect_at(with(based(turned_base, "plan"), "plan", plan), from_base);
  expect_at(with(based(turned_base, "plan"), "table", plan), {0.05, -0.05, 0.05});
  const std::string still = "{translation: [0, 0, 0], rotation: [0, 0, 0, 1]}";
  expect_at(with(based(still + ", " + still, "kinect"), "world"), near_origin);
  expect_refused(with(based(turned_base + ", " + still), "world"),
                 "multi_dof_joint_state.transforms: expected one, of the robot's base");
  for (const char* frame : {"table", "base", "kinect"})
    expect_refused(with(based(turned_base, frame), "base", frame == std::string("table") ? plan : ""),
                   "expected the robot's base in the planning frame, got frame '" + std::string(frame) + "'");
}

/// Where a scene or the SRDF names the planning frame, and another frame is called `world`, MoveIt does not
/// know that one.
TEST_F(ImportFrames, WorldMapAndOdomAreNotTakenForTheMapWhereAStatementSaysOtherwise) {
  expect_refused(transforms(placed("plan", "plan", 0)) + object_in("world"),
                 "frame 'world', which is unknown");
  expect_at(transforms(placed("map", "base", 2)) + object_in("map"), {2.05, 0.05, 0.05});
  // Whatever their order: the map is 2 m from the base and the table 1 m from the map.
  expect_at(transforms(placed("table", "map", 1) + ", " + placed("map", "base", 2)) + object_in("table"),
            {3.05, 0.05, 0.05});
  folder_.write("arm.srdf",
                "<robot name='arm'><virtual_joint name='v' type='fixed' parent_frame='odom' "
                "child_link='base'/></robot>");
  expect_at(object_in("odom"), near_origin);
  expect_refused(object_in("map"), "expected one of odom, arm_base, base;");
}

TEST_F(ImportFrames, TransformsThatPlaceOneFrameTwiceAgreeOrAreRefused) {
  const std::string once = placed("world", "table", 1);
  expect_at(transforms(once + ", " + once) + object_in("table"), {1.05, 0.05, 0.05});
  expect_refused(transforms(once + ", " + placed("world", "table", 2)) + object_in("table"),
                 "expected one transform between frames 'world' and 'table', got two that differ");
  expect_refused(transforms(once + ", " + placed("map", "table", 2)) + object_in("table"),
                 "which is the map's own or stands elsewhere by another transform");
  expect_refused(transforms(once + ", " + placed("table", "world", 2)) + object_in("table"),
                 "expected none for frame 'table', which is the map's own or stands elsewhere");
}

/// The second link is 0.4 m out along the first, which the shoulder turns to +y.
TEST_F(ImportFrames, AnObjectInALinksFrameStandsWhereTheScenesStateHasTheLink) {
  const double quarter = 0.5 * std::numbers::pi;
  for (const char* frame : {"lower", "arm_lower"})
    expect_at("robot_state: " + state(quarter, 0) + object_in(frame), {-0.05, 0.45, 0.05});
  expect_refused(object_in("lower"), "frame 'lower', a link that moves, expected a state with values of all");
  // The joint of the hand has no value, those above the second link have.
  const std::string some = "robot_state: {joint_state: {name: [x_shoulder, x_elbow], position: [0, " +
                           std::to_string(quarter) + "]}}\n";
  expect_at(some + object_in("x_lower"), {0.35, 0.05, 0.05});
  expect_refused(some + object_in("x_finger"), "frame 'x_finger', a link that moves");
  expect_refused(some + object_in("kinect_lower"), "frame 'kinect_lower', which is unknown");
}

/// MoveIt knows the objects of the world, and what they call their parts, as frames. The tray is turned by a
/// quarter about z, so that its x is the map's y.
TEST_F(ImportFrames, AnObjectMayStandInTheFrameOfAnotherOrOfAPartOfIt) {
  const auto scene = [](const std::string& frame) {
    return "world: {collision_objects: [{id: tray, header: {frame_id: world}, pose: {position: [1, 2, 0], "
           "orientation: [0, 0, 0.70710678118654752, 0.70710678118654752]}, primitives: [{type: sphere, "
           "dimensions: [0.01]}], primitive_poses: [{position: [0.55, 0.05, 0.05]}], subframe_names: [rim], "
           "subframe_poses: [{position: [0.3, 0, 0]}]}, {id: cup, header: {frame_id: " +
           frame +
           "}, primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [0.05, 0.05, "
           "0.05]}]}]}\n";
  };
  expect_at(scene("tray"), {0.95, 2.05, 0.05}, 2);
  expect_at(scene("tray/rim"), {0.95, 2.35, 0.05}, 2);
  expect_at(scene("world"), near_origin, 2);
  expect_refused(scene("tray/handle"), "'tray/handle'");
  expect_refused(scene("cup"), "'cup'");  // not there yet
}

TEST_F(ImportFrames, OfShippedRobotsAreKnownByTheNamesThatOthersGiveThem) {
  robot_ = "panda";
  const Robot panda = load_robot("panda");
  const Eigen::Isometry3d hand = forward_kinematics(panda, Configuration::Constant(7, 0.3)).back();
  ASSERT_EQ(panda.links.back().name, "hand");
  std::string names, values;
  for (int j = 1; j <= 7; ++j) {
    names += "panda_joint" + std::to_string(j) + ", ";
    values += "0.3, ";
  }
  expect_at(object_in("panda_link0"), near_origin);
  expect_at("robot_state: {joint_state: {name: [" + names + "panda_finger_joint1], position: [" + values +
                "0.03]}}\n" + object_in("panda_hand"),
            hand * near_origin, 8);
}

/// The first link of the panda turns about the base's axis, 0.333 m up: its x axis is y at the start.
TEST_F(ImportFrames, GoalsStandInFramesOfTheScenesTransformsAndOfLinksAtTheStart) {
  robot_ = "panda";
  const auto state_of = [](double first) {
    std::string names, values;
    for (int j = 1; j <= 7; ++j) {
      names += "panda_joint" + std::to_string(j) + (j < 7 ? ", " : "");
      values += (j == 1   ? std::to_string(first)
                 : j == 4 ? "-2.2"
                 : j == 6 ? "2.0"
                          : "0") +
                (j < 7 ? ", " : "");
    }
    return "{joint_state: {name: [" + names + "], position: [" + values + "]}}\n";
  };
  std::string scene = folder_.write(
      "s.yaml", "robot_state: " + state_of(0) + transforms(placed("tray", "base", 0.1)) + "world: {}\n");
  const auto goal_in = [&](const std::string& frame, const std::string& at) {
    std::filesystem::remove_all(folder_ / "out");
    const std::string request = folder_.write(
        "r.yaml",
        "start_state: " + state_of(0.5 * std::numbers::pi) +
            "goal_constraints: [{position_constraints: [{link_name: panda_hand, header: {frame_id: " + frame +
            "}, constraint_region: {primitives: [{type: sphere, dimensions: [0.01]}], "
            "primitive_poses: [{position: " +
            at + "}]}}]}]");
    const CommandRun run = import("mbm", {scene, request});
    EXPECT_EQ(run.status, exit_done) << run.log;
    if (run.status != exit_done) return Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Json goal = Json::parse(read_file(folder_.file("out/import.json")))["problems"][0]["goal"];
    const std::vector<double> place = goal["position_m"];
    return Eigen::Vector3d(place[0], place[1], place[2]);
  };
  EXPECT_TRUE(goal_in("tray", "[0.3, 0.2, 0.4]").isApprox(Eigen::Vector3d(0.4, 0.2, 0.4), 1e-9));
  EXPECT_TRUE(goal_in("panda_link1", "[0.4, 0, 0.1]").isApprox(Eigen::Vector3d(0, 0.4, 0.433), 1e-6));
  scene = folder_.write("s.yaml", "robot_state: {" + based(turned_base) + "}\nworld: {}\n");
  EXPECT_TRUE(goal_in("world", "[1.2, 0.4, 0.5]").isApprox(Eigen::Vector3d(0.4, -0.2, 0.5), 1e-9));
  EXPECT_TRUE(goal_in("panda_link1", "[0.4, 0, 0.1]").isApprox(Eigen::Vector3d(0, 0.4, 0.433), 1e-6));
}

/// A mug that its message places in the planning frame, by name or without one, or whose object of the world
/// it is: 0.5 m before the base each time, which is along the second link.
TEST_F(ImportFrames, ABodyInTheHandStandsWhereTheSceneHasItAboutAMovedBase) {
  const std::string sphere =
      "primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: "
      "[1, 0.5, 0]}]";
  const auto at = [&](const std::string& header, const std::string& shape, const std::string& objects) {
    std::filesystem::remove_all(folder_ / "out");
    const std::string scene =
        folder_.write("s.yaml", "robot_state: {" + based(turned_base) +
                                    ", joint_state: {name: [shoulder, elbow, grip], position: [0, 0, 0]}, "
                                    "attached_collision_objects: [{link_name: lower, object: {id: mug" +
                                    header + shape + "}}]}\nworld: {collision_objects: [" + objects + "]}\n");
    const std::string request = folder_.write(
        "r.yaml",
        "start_state: {is_diff: true}\ngoal_constraints: [{joint_constraints: [{joint_name: shoulder, "
        "position: 0.4}, {joint_name: elbow, position: 0}]}]");
    const CommandRun run = import("mbm", {scene, request});
    EXPECT_EQ(run.status, exit_done) << run.log;
    if (run.status != exit_done) return Eigen::Vector3d(Eigen::Vector3d::Zero());
    const Suite suite = load_suite(folder_ / "out/suite.yaml");
    return Eigen::Vector3d(suite.experiments[0].problems[0].loads.at(0).link_from_load.translation());
  };
  const Eigen::Vector3d expected(0.1, 0, 0);  // the second link is 0.4 m out
  for (const char* header : {"", ", header: {frame_id: world}", ", header: {frame_id: ''}"})
    EXPECT_TRUE(at(header, ", " + sphere, "").isApprox(expected, 1e-6)) << header;
  EXPECT_TRUE(at("", "", "{id: mug, header: {frame_id: world}, " + sphere + "}").isApprox(expected, 1e-6));
}

TEST_F(ImportFrames, ARequestMayNotMoveTheBaseFromWhereItsSceneHasIt) {
  const std::string moved = "robot_state: {" + based(turned_base) + "}\nworld: {}\n";
  const auto run_of = [&](const std::string& scene, const std::string& base) {
    std::filesystem::remove_all(folder_ / "out");
    return import(
        "mbm",
        {folder_.write("s.yaml", scene),
         folder_.write("r.yaml",
                       "start_state: {joint_state: {name: [shoulder, elbow, grip], position: [0, 0, 0]}, " +
                           base +
                           "}\ngoal_constraints: [{joint_constraints: [{joint_name: "
                           "shoulder, position: 0.4}, {joint_name: elbow, "
                           "position: 0}]}]")});
  };
  EXPECT_EQ(run_of(moved, based(turned_base)).status, exit_done);
  EXPECT_EQ(run_of("world: {}\n", based("")).status, exit_done);
  for (const auto& [scene, base] :
       {std::pair(moved, std::string("{translation: [0, 0, 0], rotation: [0, 0, 0, 1]}")),
        std::pair(std::string("world: {}\n"), turned_base)}) {
    const CommandRun run = run_of(scene, based(base));
    EXPECT_EQ(run.status, exit_bad_input) << scene;
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_NE(run.log.find("r.yaml"), std::string::npos) << run.log;
    EXPECT_NE(run.log.find("expected the robot's base where the scene has it"), std::string::npos) << run.log;
  }
}

/// Of a diff that turns the arm the body goes on with its link, from where the scene's state had it.
TEST_F(ImportFrames, ABodyOfASceneRidesFromWhereTheScenesStateHadItsLink) {
  const std::string scene = folder_.write(
      "s.yaml",
      "robot_state: {joint_state: {name: [shoulder, elbow, grip], position: [0, 0, 0]}, "
      "attached_collision_objects: [{link_name: lower, object: {id: mug, header: {frame_id: base}, "
      "primitives: [{type: sphere, dimensions: [0.01]}], primitive_poses: [{position: [0.9, 0, 0]}]}}]}\n"
      "world: {}\n");
  const std::string request = folder_.write(
      "r.yaml",
      "start_state: {is_diff: true, joint_state: {name: [shoulder], position: [1]}}\n"
      "goal_constraints: [{joint_constraints: [{joint_name: shoulder, position: 0.4}, {joint_name: elbow, "
      "position: 0}]}]");
  const CommandRun run = import("mbm", {scene, request});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Suite suite = load_suite(folder_ / "out/suite.yaml");
  const Eigen::Vector3d at = suite.experiments[0].problems[0].loads.at(0).link_from_load.translation();
  EXPECT_TRUE(at.isApprox(Eigen::Vector3d(0.5, 0, 0), 1e-6)) << at.transpose();
}

}  // namespace import_test
}  // namespace clearway
