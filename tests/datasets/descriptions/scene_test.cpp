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
      {"setup: setup.yaml\ncamera: {rate_hz: 15}", "look_at"},
      {"setup: setup.yaml\ncamera: {look_at: {eye: [1, 0, 1], target: [0, 0, 0]}}", "camera and stroke"},
      {"setup: setup.yaml\nstroke: {speed: 1, duration: 1, waypoints: [{ball: [0, 0, 0]}, {ball: [1, 0, "
       "0]}]}",
       "either speed or duration"},
      {"setup: setup.yaml\nstroke: {speed: 1, waypoints: [{ball: [0, 0, 0]}, {ball: [0, 0, 0]}]}",
       "away from"},
      {"setup: setup.yaml\nstroke: {speed: 1, waypoints: [{ball: [0, 0, 0]}]}", "at least two"},
      {"setup: setup.yaml\nshaps: []", "did you mean 'shapes'"},
  };
  for (const auto& [text, expected] : mistakes) {
    const std::string message = complaint([&] { parse(folder, text); });
    EXPECT_NE(message.find(expected), std::string::npos) << text << "\n" << message;
  }
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
