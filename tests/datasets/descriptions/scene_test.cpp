#include "datasets/descriptions/scene.hpp"

#include <gtest/gtest.h>

#include "tests/datasets/complaint.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace scene_test {

Scene parse(const TemporaryFolder& folder, const std::string& text, const std::string& setup = small_setup) {
  write_file(folder / "setup.yaml", setup);
  return parse_scene(text, "scene.yaml", folder / "");
}

TEST(Scene, EveryKeyIsRead) {
  const TemporaryFolder folder;
  const Scene scene = parse(folder, small_scene);
  EXPECT_EQ(scene.setup_text, small_setup);
  ASSERT_EQ(scene.shapes.size(), 3u);
  EXPECT_EQ(std::get<BoxShape>(scene.shapes[0].geometry).size, Eigen::Vector3d(1, 1, 0.02));
  EXPECT_EQ(std::get<CylinderShape>(scene.shapes[1].geometry).length, 0.06);
  EXPECT_EQ(std::get<SphereShape>(scene.shapes[2].geometry).radius, 0.03);
  EXPECT_EQ(scene.shapes[2].grey, 90);
  EXPECT_EQ(scene.stroke->waypoints.size(), 3u);
  EXPECT_EQ(scene.depth->map_from_sensor.size(), 2u);
  EXPECT_EQ(scene.seed, 5u);
}

TEST(Scene, LookingAtAPointPutsItInTheMiddle) {
  const TemporaryFolder folder;
  const Scene scene = parse(folder, small_scene);
  const Eigen::Vector3d target(0.05, 0, 0.05);
  const Eigen::Vector3d in_camera = scene.camera->map_from_camera.inverse() * target;
  EXPECT_NEAR(in_camera.head<2>().norm(), 0, 1e-12);
  EXPECT_GT(in_camera.z(), 0);
  const Eigen::Vector3d in_depth = scene.depth->map_from_sensor[0].inverse() * Eigen::Vector3d(0, 0, 0);
  EXPECT_NEAR(in_depth.tail<2>().norm(), 0, 1e-12);
  EXPECT_GT(in_depth.x(), 0);
  // Up is up: the camera's y points down, the depth sensor's z up; both frames are right-handed.
  EXPECT_LT(scene.camera->map_from_camera.linear()(2, 1), 0);
  EXPECT_GT(scene.depth->map_from_sensor[0].linear()(2, 2), 0);
  for (const auto& pose : {scene.camera->map_from_camera, scene.depth->map_from_sensor[0]}) {
    EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
    EXPECT_TRUE((pose.linear() * pose.linear().transpose()).isIdentity(1e-12));
  }
}

TEST(Scene, MistakesAreNamed) {
  const TemporaryFolder folder;
  const std::pair<std::string, std::string> mistakes[] = {
      {"shapes: []", "setup"},
      {"setup: none.yaml", "none.yaml"},
      {"setup: setup.yaml\nshapes: [{name: a}]", "exactly one of box, cylinder and sphere"},
      {"setup: setup.yaml\nshapes: [{name: a, box: [1, 1, 0]}]", "positive"},
      {"setup: setup.yaml\nshapes: [{name: a, sphere: 1}, {name: a, sphere: 1}]", "'a' is given twice"},
      {"setup: setup.yaml\ncamera: {look_at: {eye: [0, 0, 1], target: [0, 0, 0]}}", "along 'up'"},
      {"setup: setup.yaml\ncamera: {rate_hz: 15}",
       "expected either 'map_from_camera' or 'look_at: {eye, target}', or 'path' with one of them at each of "
       "its times"},
      {"setup: setup.yaml\ncamera: {look_at: {eye: [1, 0, 1], target: [0, 0, 0]}, path: [{time: 0, look_at: "
       "{eye: [1, 0, 1], target: [0, 0, 0]}}]}",
       "camera.path: expected neither 'map_from_camera' nor 'look_at' beside it"},
      {"setup: setup.yaml\nstroke: {tremor: {turn_deg: -2}, speed: 1, waypoints: [{ball: [0, 0, 0]}, {ball: "
       "[1, 0, 0]}]}",
       "turn_deg: expected an angle of 0 or more, got -2"},
      {"setup: setup.yaml\ncamera: {errors: {tag_turn: -0.1}, look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}",
       "camera.errors.tag_turn: expected an angle of 0 or more, got -0.1"},
      {"setup: setup.yaml\ncamera: {look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}", "camera and stroke"},
      {"setup: setup.yaml\nstroke: {speed: 1, duration: 1, waypoints: [{ball: [0, 0, 0]}, {ball: [1, 0, "
       "0]}]}",
       "either speed or duration"},
      {"setup: setup.yaml\nstroke: {speed: 1, waypoints: [{ball: [0, 0, 0]}, {ball: [0, 0, 0]}]}",
       "away from"},
      {"setup: setup.yaml\nstroke: {speed: 1, waypoints: [{ball: [0, 0, 0]}]}", "at least two"},
      {"setup: setup.yaml\nshaps: []", "did you mean 'shapes'"},
      {"setup: setup.yaml\nhands: {}", "a camera that sees them"},
      {"setup: setup.yaml\nhands: {covers: [{from: 0, to: 1, tag: 0}]}", "a tag of the probe's board, got 0"},
      {"setup: setup.yaml\nhands: {covers: [{from: 1, to: 1, tag: 10}]}", "a time after 'from'"},
      {"setup: setup.yaml\nhands: {cover_share: 1}", "0.9"},
      {"setup: setup.yaml\nstroke: {person: robot, speed: 1, waypoints: [{ball: [0, 0, 0]}, {ball: [1, 0, "
       "0]}]}",
       "calm, usual, shaky or any"},
      {"setup: setup.yaml\nstroke: {tremor: {low_hz: 9, high_hz: 9}, speed: 1, waypoints: [{ball: [0, 0, "
       "0]}, {ball: [1, 0, 0]}]}",
       "more than low_hz"},
      {"setup: setup.yaml\nstroke: {waypoints: [{time: 0, ball: [0, 0, 0]}, {ball: [1, 0, 0]}]}",
       "a time of every waypoint"},
      {"setup: setup.yaml\nstroke: {waypoints: [{time: 1, ball: [0, 0, 0]}, {time: 1, ball: [1, 0, 0]}]}",
       "a time after"},
      {"setup: setup.yaml\nstroke: {speed: 1, waypoints: [{time: 0, ball: [0, 0, 0]}, {time: 1, ball: [1, "
       "0, 0]}]}",
       "either speed or duration, or times"},
      {"setup: setup.yaml\ncamera: {family: pinhole, look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}",
       "webcam, industrial, worn or any"},
      {"setup: setup.yaml\ncamera: {path: [{time: 1, look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}, {time: "
       "0, look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}]}",
       "a time after"},
  };
  for (const auto& [text, expected] : mistakes) {
    const std::string message = complaint([&] { parse(folder, text); });
    EXPECT_NE(message.find(expected), std::string::npos) << text << "\n" << message;
  }
}

TEST(Scene, WhatAPersonDoesIsRead) {
  const TemporaryFolder folder;
  const Scene scene = parse(folder, person_scene, person_setup);
  EXPECT_EQ(scene.camera->path.size(), 3u);
  EXPECT_EQ(scene.camera->errors.dropped, 0.1);
  EXPECT_EQ(scene.camera->family, "worn");
  EXPECT_EQ(scene.stroke->person, "usual");
  EXPECT_EQ(scene.stroke->tremor.shift, 0.0003);
  EXPECT_EQ(scene.stroke->seed, 5u);
  EXPECT_EQ(scene.hands->probe.size(), 1u);
  EXPECT_EQ(scene.hands->probe[0].radius, scene.setup.probe->hand[0].radius);
  EXPECT_EQ(scene.hands->covers.size(), 1u);
  EXPECT_TRUE(scene.depth->beside_pictures);
  EXPECT_EQ(scene.depth->images(), 11u);
  EXPECT_NE(complaint([&] { parse(folder, person_scene + "  passes: 2\n", person_setup); }).find("passes"),
            std::string::npos);
}

TEST(Scene, ASetupThatIsTakenAsExactCannotBeWrong) {
  const TemporaryFolder folder;
  const std::string message = complaint([&] { parse(folder, person_scene, small_setup); });
  EXPECT_NE(message.find("states all `errors`"), std::string::npos) << message;
}

TEST(Scene, TheDatasetsFolderOfMrptCanBeChosen) {
  const TemporaryFolder folder;
  const std::string text = "setup: setup.yaml\ninclude: [{recording: '${MRPT_DATASETS}/a.rawlog'}]";
  unsetenv("CLEARWAY_MRPT_DATASETS");
  EXPECT_EQ(parse(folder, text).includes[0].recording, "/usr/share/mrpt/datasets/a.rawlog");
  setenv("CLEARWAY_MRPT_DATASETS", "/elsewhere", 1);
  EXPECT_EQ(parse(folder, text).includes[0].recording, "/elsewhere/a.rawlog");
  unsetenv("CLEARWAY_MRPT_DATASETS");
}

}  // namespace scene_test
}  // namespace clearway
