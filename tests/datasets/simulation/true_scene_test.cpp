#include "datasets/simulation/true_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "datasets/sources/lens.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace true_scene_test {

Scene parsed() {
  const TemporaryFolder folder;
  write_file(folder / "setup.yaml", person_setup);
  return parse_scene(person_scene, "scene.yaml", folder / "");
}

TEST(TrueScene, TheStatedCameraIsWrongByWhatTheErrorsSay) {
  Scene scene = parsed();
  scene.camera->errors = {};
  scene.camera->errors.focal_error = 0.01;
  scene.camera->errors.centre_error = 2;
  const CameraIntrinsics truth = *true_scene(scene).setup.camera, &stated = *scene.setup.camera;
  EXPECT_NEAR(stated.fx / truth.fx, 1.01, 1e-12);
  EXPECT_NEAR(stated.fy / truth.fy, 1.01, 1e-12);
  EXPECT_NEAR(stated.cx - truth.cx, 2, 1e-12);
  EXPECT_NEAR(stated.cy - truth.cy, 2, 1e-12);
  EXPECT_EQ(stated.distortion, truth.distortion);
}

TEST(TrueScene, TheDistortionIsOffByItsPixelsInTheCorner) {
  Scene scene = parsed();
  scene.camera->errors = {};
  scene.camera->errors.distortion_error = 0.7;
  CameraIntrinsics truth = *true_scene(scene).setup.camera, stated = *scene.setup.camera;
  stated.fy = truth.fy = stated.fx;  // so that the corner's distance is the same along both axes
  const Eigen::Vector3d corner(0.5 * stated.width / stated.fx, 0.5 * stated.height / 331.0, 1);
  EXPECT_NEAR((*Lens(stated).project(corner) - *Lens(truth).project(corner)).norm(), 0.7, 0.01);
}

TEST(TrueScene, TagsLieAsideByTheStatedSpreadAndNothingElseMoves) {
  Scene scene = parsed();
  scene.camera->errors = {};
  scene.camera->errors.tag_place = 0.0004;
  scene.camera->errors.tag_turn = 0.004;
  double places = 0, turns = 0;
  int count = 0;
  for (scene.seed = 0; scene.seed < 200; ++scene.seed) {
    const Scene truth = true_scene(scene);
    for (std::size_t b = 0; b < truth.setup.boards.size(); ++b) {
      EXPECT_TRUE(truth.setup.boards[b].map_from_board.has_value() ==
                  scene.setup.boards[b].map_from_board.has_value());
      for (std::size_t t = 0; t < truth.setup.boards[b].tags.size(); ++t, ++count) {
        const TagSetup &is = truth.setup.boards[b].tags[t], &stated = scene.setup.boards[b].tags[t];
        EXPECT_EQ(is.size, stated.size);
        const Eigen::Isometry3d off = stated.board_from_tag.inverse() * is.board_from_tag;
        places += off.translation().squaredNorm();
        turns += std::pow(Eigen::AngleAxisd(off.linear()).angle(), 2);
      }
    }
  }
  EXPECT_NEAR(std::sqrt(places / count / 3), 0.0004, 0.00002);
  EXPECT_NEAR(std::sqrt(turns / count / 3), 0.004, 0.0002);
}

TEST(TrueScene, FingersLieOnTagsForTheShareOfTheTimeThatIsAskedFor) {
  Scene scene = parsed();
  scene.stroke->waypoints.back().time = 400;
  scene.hands->covers.clear();
  scene.hands->cover_share = 0.3;
  double covered = 0, last = 0;
  std::set<int> tags;
  const Scene truth = true_scene(scene);
  for (const SceneHands::Cover& cover : truth.hands->covers) {
    EXPECT_GE(cover.from, last);
    EXPECT_GT(cover.to, cover.from);
    last = cover.to;
    if (cover.to <= 400) covered += cover.to - cover.from;
    tags.insert(cover.tag);
  }
  EXPECT_NEAR(covered / 400, 0.3, 0.05);
  EXPECT_EQ(tags, (std::set<int>{10, 11, 12}));
}

TEST(TrueScene, TheCameraIsAtItsPosesAtTheirTimesAndStraightBetween) {
  Scene scene = parsed();
  scene.camera->sway = {};
  const auto& path = scene.camera->path;
  for (const auto& waypoint : path)
    EXPECT_TRUE(camera_at(scene, waypoint.time).isApprox(waypoint.map_from_camera, 1e-9));
  const Eigen::Vector3d middle = camera_at(scene, 0.25).translation();
  EXPECT_TRUE(middle.isApprox(
      0.5 * (path[0].map_from_camera.translation() + path[1].map_from_camera.translation()), 1e-9));
  EXPECT_TRUE(camera_at(scene, 9).isApprox(path.back().map_from_camera, 1e-12));
  scene.camera->sway = {0.002, 0, 0.5, 3};
  double squares = 0;
  for (int i = 0; i < 3000; ++i)
    squares += (camera_at(scene, 2 + 0.01 * i).translation() - path.back().map_from_camera.translation())
                   .squaredNorm();
  EXPECT_NEAR(std::sqrt(squares / 3000 / 3), 0.002, 0.0003);
}

}  // namespace true_scene_test
}  // namespace clearway
