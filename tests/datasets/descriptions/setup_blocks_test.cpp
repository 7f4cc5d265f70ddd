#include "datasets/descriptions/setup_blocks.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace setup_blocks_test {

TEST(SetupBlocks, every_block_reads_back_to_what_was_written) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    clearway::Setup setup = parse_setup(small_setup, "small");
    setup.camera->fx *= 1.0 + 0.1 * unit(random);
    setup.camera->distortion[2] = 1e-4 * unit(random);
    setup.errors.camera = {0.001, std::abs(unit(random)) * 0.1, 2.0, 0.3};
    setup.errors.edge = std::abs(unit(random));
    for (BoardSetup& board : setup.boards) {
      board.errors = {0.001, 0.002, 0.0003, 0.004};
      for (TagSetup& tag : board.tags) {
        tag.size *= 1.0 + 0.01 * unit(random);
        tag.board_from_tag.translate(Eigen::Vector3d(unit(random), unit(random), unit(random)));
        tag.board_from_tag.rotate(Eigen::AngleAxisd(
            3.0 * unit(random), Eigen::Vector3d(unit(random), 0.3, unit(random)).normalized()));
      }
    }
    setup.probe->ball_center.x() = 0.01 * unit(random);
    std::string text = small_setup;
    for (const std::string& block : {boards_block(setup.boards), camera_block(*setup.camera),
                                     errors_block(setup.errors), probe_block(*setup.probe)})
      text = with_block(text, block);
    const clearway::Setup again = parse_setup(text, "again");
    EXPECT_NEAR(again.camera->fx, setup.camera->fx, 1e-5);
    EXPECT_NEAR(again.camera->distortion[2], setup.camera->distortion[2], 1e-12);
    EXPECT_NEAR(*again.errors.camera.aspect, *setup.errors.camera.aspect, 1e-9);
    EXPECT_NEAR(*again.errors.edge, *setup.errors.edge, 1e-8);
    EXPECT_LT((again.probe->ball_center - setup.probe->ball_center).norm(), 1e-9);
    for (std::size_t b = 0; b < setup.boards.size(); ++b)
      for (std::size_t t = 0; t < setup.boards[b].tags.size(); ++t) {
        const TagSetup &one = setup.boards[b].tags[t], &other = again.boards[b].tags[t];
        EXPECT_EQ(one.id, other.id);
        EXPECT_NEAR(one.size, other.size, 1e-9);
        EXPECT_TRUE(one.board_from_tag.isApprox(other.board_from_tag, 1e-7));
        EXPECT_EQ(again.boards[b].errors.place, 0.0003);
      }
  }
}

TEST(SetupBlocks, cameras_of_every_lens_read_back_to_what_was_written) {
  CameraIntrinsics camera{640, 480, 230.5, 231.25, 318, 243, {-0.0125, 0.5, -0.25, 0.0625}};
  camera.lens = LensModel::fisheye;
  EXPECT_EQ(parse_setup(camera_block(camera), "fisheye").camera, camera);
  camera.distortion = {-0.0125, 0.5, -0.25, 0.0625, 1, 2, 3, 4};
  camera.lens = LensModel::rational;
  EXPECT_EQ(parse_setup(camera_block(camera), "rational").camera, camera);
}

TEST(SetupBlocks, robots_and_sensors_read_back_to_what_was_written) {
  clearway::Setup setup = parse_setup(small_setup, "small");
  setup.robot.emplace();
  RobotSetup& robot = *setup.robot;
  robot.name = "puma560";
  robot.map_from_base = Eigen::Translation3d(0.1, -0.2, 0.3) *
                        Eigen::AngleAxisd(1.1, Eigen::Vector3d(0.3, -0.5, 0.7).normalized());
  robot.scale = 0.25;
  robot.payload = 0.5;
  robot.gravity = {1.0, 2.0, -9.0};
  robot.self_margin = 0.03;
  robot.joint_file = "joints \"of\" today.csv";
  robot.joint_names = {{"elbow", "left: elbow"}, {"joint 1", "shoulder"}};
  robot.joint_prefix = "arm/";
  robot.paints = {"tool", "left hand"};
  robot.terms = {"arm.srdf", "left arm", {{"grip", 0.025}}, {{"arm_description", "up"}}, {{"prefix", "l_"}}};
  robot.latency = 0.015;
  robot.joint_error = 0.002;
  robot.place_error = 0.0017;
  setup.sensors = {{"laser", "walk.txt", "", "", robot.map_from_base, 0.25},
                   {"depth", "", "", "tip", robot.map_from_base.inverse(), 0.5}};
  std::string text = small_setup;
  for (const std::string& block : {robot_block(robot), sensors_block(setup.sensors)})
    text = with_block(text, block);
  const clearway::Setup again = parse_setup(text, "again");
  EXPECT_TRUE(again.robot->map_from_base.isApprox(robot.map_from_base, 1e-8));
  EXPECT_EQ(again.robot->gravity, robot.gravity);
  EXPECT_EQ(again.robot->joint_file, robot.joint_file);
  EXPECT_EQ(again.robot->joint_names, robot.joint_names);
  EXPECT_EQ(again.robot->joint_prefix, robot.joint_prefix);
  EXPECT_EQ(again.robot->paints, robot.paints);
  EXPECT_EQ(std::tie(again.robot->terms.srdf, again.robot->terms.group, again.robot->terms.fixed,
                     again.robot->terms.packages, again.robot->terms.xacro),
            std::tie(robot.terms.srdf, robot.terms.group, robot.terms.fixed, robot.terms.packages,
                     robot.terms.xacro));
  EXPECT_EQ(std::tie(again.robot->name, again.robot->scale, again.robot->payload, again.robot->self_margin,
                     again.robot->latency, again.robot->joint_error, again.robot->place_error),
            std::tie(robot.name, robot.scale, robot.payload, robot.self_margin, robot.latency,
                     robot.joint_error, robot.place_error));
  ASSERT_EQ(again.sensors.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again.sensors[i].name, setup.sensors[i].name);
    EXPECT_EQ(again.sensors[i].poses, setup.sensors[i].poses);
    EXPECT_EQ(again.sensors[i].link, setup.sensors[i].link);
    EXPECT_EQ(again.sensors[i].max_gap, setup.sensors[i].max_gap);
    EXPECT_TRUE(again.sensors[i].mount.isApprox(setup.sensors[i].mount, 1e-8));
  }
}

TEST(SetupBlocks, all_other_lines_and_comments_stay) {
  const std::string text =
      "# mine\ntitle: a  # kept\ncamera:\n  width: 1\n  # gone\n# between\nqueries: []\n";
  const std::string camera = "camera: {width: 2}\n";
  EXPECT_EQ(with_block(text, camera),
            "# mine\ntitle: a  # kept\ncamera: {width: 2}\n# between\nqueries: []\n");
  EXPECT_EQ(with_block("title: a\n", camera), "title: a\n\ncamera: {width: 2}\n");
  EXPECT_THROW(with_block("{title: a}\n", camera), std::invalid_argument);
}

}  // namespace setup_blocks_test
}  // namespace clearway
