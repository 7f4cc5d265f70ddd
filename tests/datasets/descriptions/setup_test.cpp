#include "datasets/descriptions/setup.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace setup_test {

const std::string full = R"(
map: {resolution: 0.0025, min_range: 0.05, max_range: 1.5, crop: [-1, -2, -3, 1, 2, 3], discretize: true, integration: compatible, safe_band: 0.005}
camera: {width: 640, height: 480, fx: 700, fy: 702, cx: 322.5, cy: 238, distortion: [-0.1, 0.05, 0.001, 0, 0]}
boards:
  - name: base
    map_from_board: [0.1, 0.2, 0.3, 0, 0, 1.5]
    tags:
      - {id: 0, size: 0.03, pose: [0.5, 0, 0, 0, 0, 0]}
      - {id: 1, size: 0.03, pose_deg: [0, 0.5, 0, 90, 0, -90]}
  - name: probe
    tags: [{id: 7, size: 0.028}]
probe: {board: probe, ball_center: [0, 0, -0.085], ball_radius: 0.0225, robot_error: 0.0005,
        tracking_error: 0.0015, modelling_error: 0.0005}
volumes: [{label: left, critical_parts: [hand, tool], from: 1, to: 2.5}, {label: right}]
acceptance: {max_reprojection_px: 1.5, min_ambiguity: 2, min_tags: 3, max_speed: 0.2}
robot: {name: puma560, base_deg: [0, 0, 1, 0, 0, 180], scale: 0.1, payload: 2.5, gravity: [0, 9.81, 0]}
queries:
  - name: across
    start_deg: [0, 90]
    goals_deg: [[180, 0], [90, -90]]
    planners: [beam, boundary]
    policies: {default: not_occupied, hand: painted}
    options: {beam_width: 50, note: "two words"}
  - {name: slide, start: [1.5, 2], goals: [[3, 4]]}
)";

TEST(Setup, EveryKeyIsRead) {
  const auto setup = parse_setup(full, "full.yaml");
  EXPECT_EQ(setup.map.resolution, 0.0025);
  EXPECT_EQ(setup.map.crop->min(), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(setup.map.discretize, true);
  EXPECT_EQ(setup.map.integration, "compatible");
  EXPECT_EQ(setup.map.safe_band, 0.005);
  EXPECT_EQ(setup.camera->fy, 702);
  EXPECT_EQ(setup.camera->distortion[2], 0.001);
  ASSERT_EQ(setup.boards.size(), 2u);
  EXPECT_EQ(setup.board("probe")->tags[0].id, 7);
  EXPECT_EQ(setup.board("other"), nullptr);
  EXPECT_FALSE(setup.boards[1].map_from_board);
  EXPECT_NEAR(setup.probe->painted_radius(), 0.02, 1e-15);
  EXPECT_EQ(setup.volumes[0].critical_parts, (std::vector<std::string>{"hand", "tool"}));
  EXPECT_EQ(setup.volumes[0].to, 2.5);
  EXPECT_EQ(setup.acceptance.min_tags, 3);
  EXPECT_EQ(setup.robot->scale, 0.1);
  EXPECT_EQ(setup.robot->payload, 2.5);
  EXPECT_EQ(setup.robot->gravity, Eigen::Vector3d(0, 9.81, 0));
  EXPECT_EQ(setup.queries[0].policies.at("hand"), "painted");
  EXPECT_EQ(setup.queries[0].options.at("beam_width"), "50");
  EXPECT_EQ(setup.queries[1].goals, (std::vector<std::vector<double>>{{3, 4}}));
}

const std::string doubtful = R"(
errors:
  camera: {focal: 0.001, aspect: 0.0002, center_px: 1.5, distortion_px: 0.25}
  boards: {scale: 0.004, size: 0.006, place: 0.0003, turn_deg: 90}
  edge_px: 0.2
boards:
  - {name: base, map_from_board: [0, 0, 0, 0, 0, 0], tags: [{id: 0, size: 0.03}]}
  - {name: probe, errors: {place: 0.002, turn: 0.01}, tags: [{id: 5, size: 0.05}]}
probe: {board: probe, ball_center: [0, 0, -0.1], ball_radius: 0.02, tracking_error: 0.03}
acceptance: {max_noise: 2.5, max_turn_speed: 4, max_pause: 0.3}
)";

TEST(Setup, ErrorsAreReadAndABoardsOwnComeFirst) {
  const auto setup = parse_setup(doubtful, "d.yaml");
  EXPECT_EQ(setup.errors.camera.focal, 0.001);
  EXPECT_EQ(setup.errors.camera.aspect, 0.0002);
  EXPECT_EQ(setup.errors.camera.center, 1.5);
  EXPECT_EQ(setup.errors.camera.distortion, 0.25);
  EXPECT_EQ(setup.errors.edge, 0.2);
  EXPECT_EQ(setup.board("base")->errors.place, 0.0003);
  EXPECT_NEAR(*setup.board("base")->errors.turn, M_PI / 2, 1e-15);
  EXPECT_EQ(setup.board("probe")->errors.place, 0.002);
  EXPECT_EQ(setup.board("probe")->errors.turn, 0.01);
  EXPECT_EQ(setup.board("probe")->errors.scale, 0.004);
  EXPECT_EQ(setup.board("probe")->errors.size, 0.006);
  EXPECT_FALSE(setup.probe->constant_tracking);
  EXPECT_EQ(setup.acceptance.max_noise, 2.5);
  EXPECT_EQ(setup.acceptance.max_turn_speed, 4);
  EXPECT_EQ(setup.acceptance.max_pause, 0.3);
  const auto plain = parse_setup(full, "full.yaml");
  EXPECT_FALSE(plain.errors.camera.focal || plain.errors.edge || plain.boards[0].errors.place);
}

TEST(Setup, ErrorsWithMistakesAreRefused) {
  const auto refusal = [](const std::string& from, const std::string& to) -> std::string {
    std::string text = doubtful;
    text.replace(text.find(from), from.size(), to);
    try {
      parse_setup(text, "d.yaml");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("focal: 0.001", "focal: -0.001").find("focal"), std::string::npos);
  EXPECT_NE(refusal("center_px", "centre_px").find("center_px"), std::string::npos);
  EXPECT_NE(refusal("turn: 0.01", "turn: -0.01").find("turn"), std::string::npos);
  EXPECT_NE(refusal("place: 0.002", "place: wide").find("place"), std::string::npos);
  EXPECT_NE(refusal("max_noise: 2.5", "max_noise: 0.5").find("max_noise"), std::string::npos);
  EXPECT_NE(refusal("tracking_error: 0.03", "tracking: ours").find("expected bound"), std::string::npos);
  EXPECT_NE(refusal("tracking_error: 0.03", "tracking_error: 0.03, tracking: constant").find("ball_radius"),
            std::string::npos);
}

const std::string mounted = R"(
map: {outliers: {neighbours: 12, deviations: 1.5}}
boards:
  - {name: base, map_from_board: [0, 0, 0, 0, 0, 0], tags: [{id: 0, size: 0.03}]}
  - {name: rig, tags: [{id: 5, size: 0.05}]}
sensors:
  - {name: wall, pose: [1, 2, 3, 0, 0, 0]}
  - {name: walker, poses: walk.txt, pose: [0, 0, 0.1, 0, 0, 0], max_gap: 0.2}
  - {name: depth, board: rig, pose_deg: [0, 0, 0, 0, 90, 0]}
probe: {board: rig, ball_center: [0, 0, -0.1], ball_radius: 0.02,
        hand: [{from: [0, 0, 0], to: [0, 0, 0.1], radius: 0.06}]}
robot: {name: puma560, joints_deg: [0, -90, 0, 0, 0, 0], self_margin: 0.03}
)";

TEST(Setup, SensorsTheHandAndTheStandingRobotAreRead) {
  const auto setup = parse_setup(mounted, "folder/mounted.yaml");
  EXPECT_EQ(setup.map.outliers->neighbours, 12);
  EXPECT_EQ(setup.map.outliers->deviations, 1.5);
  ASSERT_EQ(setup.sensors.size(), 3u);
  EXPECT_EQ(setup.sensor("wall", "depth")->mount.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(setup.sensor("walker", "laser2d")->poses, "folder/walk.txt");
  EXPECT_EQ(setup.sensor("walker", "laser2d")->max_gap, 0.2);
  EXPECT_EQ(setup.sensor("kinect", "depth")->board, "rig");
  EXPECT_EQ(setup.sensor("kinect", "laser2d"), nullptr);
  EXPECT_EQ(setup.probe->hand.at(0).radius, 0.06);
  EXPECT_NEAR(setup.robot->joints.at(1), -M_PI / 2, 1e-15);
  EXPECT_EQ(setup.robot->self_margin, 0.03);
}

TEST(Setup, TheRobotsFileIsLookedForInItsFolder) {
  EXPECT_EQ(parse_setup("robot: {name: arm.urdf}", "some/where/s.yaml").robot->name, "some/where/arm.urdf");
  EXPECT_EQ(parse_setup("robot: {name: puma560}", "some/where/s.yaml").robot->name, "puma560");
}

TEST(Setup, TheRobotsGroupAndStatesStandAsInFlags) {
  const auto setup = parse_setup(
      "robot: {name: arm.urdf, srdf: arm.srdf, group: arm, fixed: {grip: 0.02}, packages: {p: ../p}, "
      "xacro: {prefix: left_}}\n"
      "queries:\n  - {name: a, start: home, goals: [[0, 1], ready]}\n"
      "  - {name: b, start: [0, 1], goals: [[0, 1]]}\n",
      "some/where/s.yaml");
  const RobotTermsSetup& terms = setup.robot->terms;
  EXPECT_EQ(terms.srdf, "some/where/arm.srdf");
  EXPECT_EQ(terms.group, "arm");
  EXPECT_EQ(terms.fixed, (std::map<std::string, double>{{"grip", 0.02}}));
  EXPECT_EQ(terms.packages.at("p"), "some/where/../p");
  EXPECT_EQ(terms.xacro.at("prefix"), "left_");
  EXPECT_EQ(setup.queries.at(0).start_state, "home");
  EXPECT_EQ(setup.queries.at(0).goal_states, (std::vector<std::string>{"", "ready"}));
  EXPECT_EQ(setup.queries.at(0).goals.at(0), (std::vector<double>{0, 1}));
  EXPECT_EQ(setup.queries.at(1).goal_states, (std::vector<std::string>{""}));
  EXPECT_THROW(parse_setup("queries: [{name: a, start: [0], goals: [[0, 1]]}]", "s.yaml"),
               std::invalid_argument);
}

TEST(Setup, ARobotsJointsMayHaveOtherNamesWhereTheyAreRecorded) {
  const auto robot = [](const std::string& keys) {
    return parse_setup("robot: {name: puma560, " + keys + "}", "s.yaml").robot;
  };
  const auto named =
      robot("joint_topic: /j, joint_prefix: arm_, joint_names: {j1: left_1}, joint_error_deg: 0.9");
  EXPECT_EQ(named->joint_prefix, "arm_");
  EXPECT_EQ(named->joint_names, (std::map<std::string, std::string>{{"j1", "left_1"}}));
  EXPECT_NEAR(named->joint_error, 0.9 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(robot("joint_error: 0.02")->joint_error, 0.02);
  for (const char* key : {"joint_names: {j1: left_1}", "joint_prefix: arm_", "paints: [hand]"}) {
    const std::string sentence = complaint([&] { robot(key); });
    EXPECT_NE(sentence.find("expected joint_file or joint_topic beside it"), std::string::npos) << sentence;
  }
  EXPECT_TRUE(robot("paints: []")->paints.empty());
  EXPECT_NE(complaint([&] { robot("joint_error_deg: -1"); }).find("joint_error_deg"), std::string::npos);
}

TEST(Setup, SensorsWithMistakesAreRefused) {
  const auto refusal = [](const std::string& from, const std::string& to) -> std::string {
    std::string text = mounted;
    text.replace(text.find(from), from.size(), to);
    try {
      parse_setup(text, "m.yaml");
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("board: rig, pose_deg", "board: nose, pose_deg").find("got 'nose'"), std::string::npos);
  EXPECT_NE(refusal("board: rig, pose_deg", "board: base, pose_deg").find("a board that moves"),
            std::string::npos);
  EXPECT_NE(refusal("board: rig, pose_deg", "board: rig, poses: a.txt, pose_deg").find("either"),
            std::string::npos);
  EXPECT_NE(refusal("name: walker", "name: wall").find("given twice"), std::string::npos);
  EXPECT_NE(refusal("max_gap: 0.2", "max_gap: 0").find("max_gap"), std::string::npos);
  EXPECT_NE(refusal("neighbours: 12", "neighbors: 12").find("neighbours"), std::string::npos);
}

TEST(Setup, DegreesAreDegreesAndRadiansRadians) {
  const auto setup = parse_setup(full, "full.yaml");
  EXPECT_NEAR(setup.queries[0].start[1], M_PI / 2, 1e-15);
  EXPECT_NEAR(setup.queries[0].goals[1][1], -M_PI / 2, 1e-15);
  EXPECT_EQ(setup.queries[1].start[0], 1.5);
  EXPECT_NEAR(Eigen::AngleAxisd(setup.boards[0].map_from_board->linear()).angle(), 1.5, 1e-12);
  EXPECT_TRUE(setup.robot->map_from_base.linear().isApprox(
      Eigen::Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix(), 1e-12));
}

TEST(Setup, RollPitchYawTurnAsRzRyRx) {
  // Roll 90, then yaw -90: the tag's x goes to -y, its y to z, its z to -x.
  const Eigen::Matrix3d turn = parse_setup(full, "").boards[0].tags[1].board_from_tag.linear();
  Eigen::Matrix3d expected;
  expected << 0, 0, -1, -1, 0, 0, 0, 1, 0;
  EXPECT_TRUE(turn.isApprox(expected, 1e-12)) << turn;
}

TEST(Setup, AnEmptySetupHasOneVolumeOverEverything) {
  const auto setup = parse_setup("", "empty.yaml");
  ASSERT_EQ(setup.volumes.size(), 1u);
  EXPECT_EQ(setup.volumes[0].from, 0);
  EXPECT_TRUE(std::isinf(setup.volumes[0].to));
  EXPECT_FALSE(setup.probe || setup.camera || setup.robot);
}

struct Mistake {
  const char *yaml, *file_and_line, *key, *expected;
};

TEST(Setup, EveryMistakeIsOneSentenceNamingFileLineKeyAndExpectation) {
  const Mistake mistakes[] = {
      {"mop: {}", "line 1", "mop", "did you mean 'map'"},
      {"\nmap: {resolutoin: 1}", "line 2", "map.resolutoin", "did you mean 'resolution'"},
      {"map: {resolution: .nan}", "line 1", "map.resolution", "expected a number"},
      {"camera: {width: 4, height: 4, fx: 1, fy: -1, cx: 2, cy: 2}", "line 1", "camera.fy",
       "that of depth alone: `source: {depth: {camera: …}}`"},
      {"camera: {width: 4, height: 4, fx: 1, fy: 0, cx: 2, cy: 2}", "line 1", "camera.fy", "not 0"},
      {"source: {depth: {camera: {width: 4, height: 4, fx: 1, fy: -1, cx: 2, cy: 2, distortion: [0.1, 0, 0, "
       "0, 0]}}}",
       "line 1", "fy", "expected a positive number beside a distortion"},
      {"source: {bag: {depth: /d}, depth: {camera: {width: 4, height: 4, fx: 1, fy: -1, cx: 2, cy: 2}}}",
       "line 1", "fy", "expected a positive number"},
      {"source: {bag: {depth: [/d, /e], depth_camera_info: /i}}", "line 1", "source.bag.depth_camera_info",
       "expected one topic for each of 'depth', 2, got 1"},
      {"source: {bag: {times: recorded}}", "line 1", "source.bag.times", "expected 'stamps' or 'recording'"},
      {"source: {bag: {times: recording, clock_offsets: [{topic: /a, add: 1}]}}", "line 1",
       "source.bag.clock_offsets", "beside 'times: recording'"},
      {"source: {bag: {clock_offsets: [{topic: /a, add: 1}, {topic: /a, add: 2}]}}", "line 1",
       "source.bag.clock_offsets[1].topic", "topic '/a' is given twice"},
      {"source: {bag: {depth: [/d, /d]}}", "line 1", "source.bag.depth", "topic '/d' is given twice"},
      {"map: {resolution: -0.1}", "line 1", "map.resolution", "got '-0.1'"},
      {"map: {resolution: 1e999}", "line 1", "map.resolution", "expected a number"},
      {"map: {resolution: 0,05}", "line 1", "map.resolution", "got '0'"},
      {"map: {resolution: '0,05'}", "line 1", "map.resolution", "got '0,05'"},
      {"map: {resolution: [1]}", "line 1", "map.resolution", "got a list"},
      {"map: {resolution: 1, resolution: 2}", "line 1", "resolution", "twice"},
      {"map: {crop: [0, 0, 0, 1, 1]}", "line 1", "map.crop", "expected 6 numbers, got 5"},
      {"map: {crop: [0, 0, 0, 1, -1, 1]}", "line 1", "map.crop", "min below its max"},
      {"map: {discretize: yes please}", "line 1", "map.discretize", "true or false"},
      {"map: {safe_band: -0.01}", "line 1", "map.safe_band", "expected a number from 0 to 100"},
      {"map: {integration: careful}", "line 1", "integration", "safe or compatible"},
      {"map: 3", "line 1", "map", "expected a map"},
      {"boards: 7", "line 1", "boards", "expected a list"},
      {"boards: [{name: a}]", "line 1", "boards[0].tags", "at least one tag"},
      {"boards: [{name: a, tags: [{id: 1}]}]", "line 1", "boards[0].tags[0].size", "missing"},
      {"camera: {width: 6, height: 4, f_x: 7, fy: 7, cx: 3, cy: 2}", "line 1", "camera.fx",
       "missing, is 'f_x' meant to be it?"},
      {"camera: {width: 6, height: 4, fy: 7, cx: 3, cy: 2}", "line 1", "camera.fx", "missing."},
      {"queries: [{name: q, stars: [1], goals: [[1]]}]", "line 1", "queries[0].start", "missing."},
      {"boards: [{name: a, tags: [{id: 1, siz: 1}]}]", "line 1", "boards[0].tags[0].size",
       "missing, is 'siz' meant to be it?"},
      {"boards: [{name: a, tags: [{id: 587, size: 1}]}]", "line 1", "boards[0].tags[0].id", "0 to 586"},
      {"boards: [{name: a, tags: [{id: 1.5, size: 1}]}]", "line 1", "boards[0].tags[0].id", "whole number"},
      {"boards: [{name: a, tags: [{id: 1, size: 60}]}]", "line 1", "boards[0].tags[0].size", "10"},
      {"boards: [{name: b, tags: [{id: 1, size: 1}]}]\nprobe: {board: b, ball_center: [0, 0, 0], "
       "ball_radius: 25}",
       "line 2", "probe.ball_radius", "2"},
      {"boards: [{name: a, tags: [{id: 1, size: 1}, {id: 1, size: 1}]}]", "line 1", "boards[0].tags",
       "used twice"},
      {"probe: {board: b, ball_center: [0, 0, 0], ball_radius: 1}", "line 1", "probe.board", "got 'b'"},
      {"boards: [{name: b, tags: [{id: 1, size: 1}]}]\n"
       "probe: {board: b, ball_center: [0, 0, 0], ball_radius: 1, robot_error: 1}",
       "line 2", "probe.ball_radius", "more than the sum"},
      {"volumes: [{label: a, from: 2, to: 1}]", "line 1", "volumes[0].to", "after 'from'"},
      {"volumes: [{label: a, critical_parts: [hand, \"\"]}]", "line 1", "volumes[0].critical_parts",
       "an empty one in it"},
      {"robot: {name: a, base: [0, 0, 0, 0, 0, 0], base_deg: [0, 0, 0, 0, 0, 0]}", "line 1", "robot.base",
       "expected one"},
      {"queries: [{name: q, start: [1, 2], goals: [[1]]}]", "line 1", "queries[0]",
       "the start has 2 numbers and goals[0] has 1, expected as many numbers in both"},
      {"queries: [{name: q, start: [1], goals: [[1]], goal_poses: [{pose: [0, 0, 0, 0, 0, 0]}]}]", "line 1",
       "queries[0].goal_poses", "expected either goals or goal_poses"},
      {"queries: [{name: q, start: [1], goals: [[1]], tip: hand}]", "line 1", "queries[0].tip",
       "expected goal_poses beside it"},
      {"queries: [{name: q, start: [1], goal_poses: []}]", "line 1", "queries[0].goal_poses", "at least one"},
      {"queries: [{name: q, start: [1], goal_poses: [{pose: [0, 0, 0, 0, 0, 0], free_axis: w}]}]", "line 1",
       "queries[0].goal_poses[0].free_axis", "expected x, y or z, got 'w'"},
      {"queries: [{name: q, start: [1], goal_poses: [{pose: [0, 0, 0, 0, 0, 0], turn_tolerance: 4}]}]",
       "line 1", "queries[0].goal_poses[0].turn_tolerance", "from 0 to a half turn"},
      {"queries: [{name: q, start: [1]}]", "line 1", "queries[0].goals", "missing"},
      {"queries: [{name: q, start: [1], goals: [[1]], padding: 1e9}]", "line 1", "queries[0].padding",
       "expected a number from 0 to 100, got '1e9'"},
      {"queries: [{name: q, start: [1], goals: [[1]], options: {step: [0.1, x]}}]", "line 1",
       "queries[0].options.step", "expected a finite number, got 'x'"},
      {"queries: [{name: q, start: [1], goals: [[1]], options: {step: []}}]", "line 1",
       "queries[0].options.step", "expected a word, a number or a list of numbers"},
      {"queries: [{name: q, start: [1], goals: [[1]], policies: {hand: maybe}}]", "line 1",
       "queries[0].policies.hand", "got 'maybe'"},
      {"map: {", "line", "", "not valid YAML"},
      {"- a", "line 1", "", "expected a map"},
  };
  for (const auto& mistake : mistakes) {
    const std::string message = complaint([&] { parse_setup(mistake.yaml, "s.yaml"); });
    for (const char* part : {"setup 's.yaml'", mistake.file_and_line, mistake.key, mistake.expected})
      EXPECT_NE(message.find(part), std::string::npos) << mistake.yaml << "\n"
                                                       << message << "\nwants " << part;
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0);
    EXPECT_TRUE(message.ends_with(".") ||
                (message.ends_with("?") && message.find(" mean") != std::string::npos))
        << message;
  }
}

TEST(Setup, TheBandOfSafeIntegrationMayBeTurnedOff) {
  EXPECT_EQ(parse_setup("map: {safe_band: 0}", "s.yaml").map.safe_band, 0.0);
}

TEST(Setup, GoalsMayBePosesOfALinkWithWhatMayDiffer) {
  const auto setup = parse_setup(
      "queries:\n  - {name: q, start: [1, 2], tip: hand, goal_poses: [{pose: [1, 2, 3, 0, 0, 0.5]}, "
      "{pose_deg: [0, 0, 0, 0, 90, 0], position_tolerance: 0.01, turn_tolerance_deg: 90, free_axis: z}]}\n",
      "s.yaml");
  const QuerySetup& query = setup.queries.at(0);
  EXPECT_TRUE(query.goals.empty());
  EXPECT_EQ(query.tip, "hand");
  ASSERT_EQ(query.goal_poses.size(), 2U);
  EXPECT_EQ(query.goal_poses[0].map_from_tip.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(query.goal_poses[0].map_from_tip.linear()(1, 0), std::sin(0.5), 1e-15);
  EXPECT_EQ(query.goal_poses[0].position_tolerance + query.goal_poses[0].turn_tolerance, 0.0);
  EXPECT_FALSE(query.goal_poses[0].free_axis);
  EXPECT_EQ(query.goal_poses[1].position_tolerance, 0.01);
  EXPECT_NEAR(query.goal_poses[1].turn_tolerance, M_PI / 2, 1e-15);
  EXPECT_EQ(query.goal_poses[1].free_axis, 2);
}

TEST(Setup, DeepAndRandomYamlNeverCrashes) {
  EXPECT_NE(complaint([] { parse_setup(std::string(100000, '['), "deep.yaml"); }), "");
  EXPECT_NE(complaint([] { parse_setup("a: " + std::string(100000, '{'), "deep.yaml"); }), "");
  uint32_t random = 1;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text = full;
    for (int i = 0; i < 3; ++i) {
      random = random * 1664525 + 1013904223;
      text[(random >> 8) % text.size()] = static_cast<char>("[]{}:,-'\"\n&*!|>%@ 09azZ\xff"[random % 25]);
    }
    (void)complaint([&] { parse_setup(text, "random.yaml"); });
  }
}

TEST(Setup, FilesThatCannotBeReadAreNamed) {
  const TemporaryFolder folder;
  EXPECT_NE(complaint([&] { load_setup(folder / "none.yaml"); }).find("none.yaml"), std::string::npos);
  EXPECT_NE(complaint([&] { load_setup(folder / "."); }).find("folder"), std::string::npos);
  write_file(folder / "big.yaml", std::string(5 << 20, '#'));
  EXPECT_NE(complaint([&] { load_setup(folder / "big.yaml"); }).find("4 MB"), std::string::npos);
}

TEST(Setup, NumbersMeanTheSameInACommaLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  const auto setup = parse_setup(full, "full.yaml");
  std::locale::global(before);
  EXPECT_EQ(setup.map.resolution, 0.0025);
}

TEST(SetupDetector, SaysHowImagesAreSearchedAndRefusesWhatTheDetectorDoesNotDo) {
  const auto setup = parse_setup(
      "detector: {decimate: 2, threads: 3, sigma: 0.8, sharpening: 0.5, max_hamming: 0, min_margin: 20,\n"
      "           families: [tag36h11]}\nsource: {rate: 15}\n",
      "s");
  EXPECT_EQ(setup.detector.decimate, 2);
  EXPECT_EQ(setup.detector.threads, 3);
  EXPECT_EQ(setup.detector.sigma, 0.8);
  EXPECT_EQ(setup.detector.sharpening, 0.5);
  EXPECT_EQ(setup.detector.max_hamming, 0);
  EXPECT_EQ(setup.detector.min_margin, 20);
  EXPECT_EQ(setup.source.rate, 15);
  EXPECT_FALSE(parse_setup("{}", "s").detector.decimate);
  EXPECT_EQ(parse_setup("{}", "s").detector.family, "tag36h11");
  for (const auto& [family, ids] : tag_family_ids()) {
    const std::string tag = "\nboards: [{name: a, tags: [{id: " + std::to_string(ids - 1) + ", size: 1}]}]";
    EXPECT_EQ(parse_setup("detector: {families: [" + family + "]}" + tag, "s").detector.family, family);
  }
  for (const char* wrong : {"detector: {decimate: 3}", "detector: {families: [tag16h6]}",
                            "detector: {families: [tag16h5, tag25h9]}",
                            "detector: {families: [tag16h5]}\nboards: [{name: a, tags: [{id: 30, size: 1}]}]",
                            "detector: {families: []}", "detector: {threads: 0}", "detector: {decimat: 2}",
                            "source: {rate: 0}", "source: {rates: 1}"})
    EXPECT_NE(complaint([&] { parse_setup(wrong, "s"); }), "") << wrong;
}

TEST(Setup, SaysHowLongAUnitOfColmapsPosesIs) {
  EXPECT_FALSE(parse_setup("source: {depth: {}}\n", "s").source.depth.pose_scale);
  EXPECT_EQ(parse_setup("source: {depth: {pose_scale: 0.35}}\n", "s").source.depth.pose_scale, 0.35);
}

TEST(Setup, SaysWhichPartOfABagIsReadAndWhatInfiniteBeamsDo) {
  const SourceOptions source =
      parse_setup("source: {bag: {from: 2.5, to: 60}, scans: {clear_infinite: true, no_return: 50}}\n", "s")
          .source;
  EXPECT_EQ(source.no_return, 50.0);
  EXPECT_EQ(source.bag.from, 2.5);
  for (const auto& [bag, infos] :
       {std::pair{"depth: /d, depth_camera_info: /i", std::vector{"/i"}},
        std::pair{"depth: [/d, /e], depth_camera_info: [/i, /j]", std::vector{"/i", "/j"}},
        std::pair{"depth: [/d, /e]", std::vector{"", ""}}}) {
    const std::vector<DepthTopic> depth =
        parse_setup("source: {bag: {" + std::string(bag) + "}}\n", "s").source.bag.depth;
    ASSERT_EQ(depth.size(), infos.size()) << bag;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      EXPECT_EQ(depth[i].name, i == 0 ? "/d" : "/e");
      EXPECT_EQ(depth[i].camera_info, infos[i]);
    }
  }
  EXPECT_EQ(source.bag.to, 60.0);
  EXPECT_TRUE(source.clear_infinite);
  const BagTopics posed =
      parse_setup("source: {bag: {fixed_frame: /map, sensor_frame: /lidar, point_times: false}}\n", "s")
          .source.bag;
  EXPECT_EQ(posed.sensor_frame, "lidar");
  EXPECT_FALSE(posed.point_times);
  EXPECT_EQ(posed.times, BagTimes::agreeing_stamps);
  const BagTopics clocks =
      parse_setup("source: {bag: {clouds: [/a], times: stamps, clock_offsets: [{topic: /a, add: -37.5}]}}\n",
                  "s")
          .source.bag;
  EXPECT_EQ(clocks.times, BagTimes::stamps);
  EXPECT_EQ(clocks.time_of("/a", 100.0, 7.0), 62.5);
  EXPECT_EQ(clocks.time_of("/b", 100.0, 7.0), 100.0);
  EXPECT_EQ(parse_setup("source: {bag: {times: recording}}\n", "s").source.bag.time_of("/a", 100.0, 7.0),
            7.0);
  const BagTopics moved = parse_setup(
                              "source: {bag: {fixed_frame: map, poses: [/odom], pose_frame: /base, frames: "
                              "[{parent: /base, child: lidar, pose_deg: [1, 2, 3, 0, 0, 90]}]}}\n",
                              "s")
                              .source.bag;
  EXPECT_EQ(moved.poses, std::vector<std::string>{"/odom"});
  EXPECT_EQ(moved.pose_frame, "base");
  ASSERT_EQ(moved.frames.size(), 1U);
  EXPECT_EQ(moved.frames[0].parent + " " + moved.frames[0].child, "base lidar");
  EXPECT_TRUE(
      (moved.frames[0].parent_from_child * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3)));
  const SourceOptions plain = parse_setup("source: {bag: {}, scans: {}}\n", "s").source;
  EXPECT_EQ(plain.bag.from, 0.0);
  EXPECT_FALSE(plain.bag.to);
  EXPECT_FALSE(plain.clear_infinite);
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"source: {bag: {from: 3, to: 3}}", "to: expected a time after 'from'"},
           {"source: {bag: {from: -1}}", "source.bag.from"},
           {"source: {bag: {sensor_frame: lidar}}", "sensor_frame: expected 'fixed_frame' beside it"},
           {"source: {bag: {poses: [/odom]}}", "poses: expected 'fixed_frame' beside it"},
           {"source: {bag: {frames: [{parent: a, child: b, pose: [0, 0, 0, 0, 0, 0]}]}}",
            "frames: expected 'fixed_frame'"},
           {"source: {bag: {fixed_frame: a, frames: [{parent: a, child: /a, pose: [0, 0, 0, 0, 0, 0]}]}}",
            "expected another frame than 'parent'"},
           {"source: {scans: {clear_infinite: 1}}", "expected true or false"},
           {"source: {scans: {no_return: 0}}", "no_return"},
           {"source: {depth: {pose_scale: 0}}", "pose_scale"},
           {"source: {scans: {clear: true}}", "unknown key"}}) {
    const std::string sentence = complaint([&text = text] { parse_setup(text, "s"); });
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
  }
}

TEST(Setup, FilesOfOtherProgramsAreNamedWithWhatIsExpected) {
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {"standalone_tags: [{id: 3, size: 0.1}]\ntag_bundles: []\n", "apriltag_ros's list of tags"},
           {"target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\n", "kalibr's target"},
           {"tagslam_config: {}\nbodies: [{board: {is_static: true}}]\n", "TagSLAM's scene"},
           {"cam0: {camera_model: pinhole, resolution: [640, 480]}\n",
            "cameras, expected a setup, which may"}}) {
    const std::string sentence = complaint([&text = text] { parse_setup(text, "s"); });
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("expected a setup"), std::string::npos) << sentence;
  }
}

}  // namespace setup_test
}  // namespace clearway
