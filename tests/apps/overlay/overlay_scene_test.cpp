#include "apps/overlay/overlay_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "mapping/free_space_map.hpp"

namespace overlay_scene_test {

using namespace clearway;
using Eigen::Isometry3d;
using Eigen::Vector3d;

const Camera camera{320, 240, 250.0, 250.0, 159.5, 119.5, {-0.1, 0.02, 0.0, 0.0, 0.0}};

/// A painted ball and a scanned wall; the camera looks along x from the origin.
FreeSpaceMap map_of(const std::vector<Sphere>& balls, const std::vector<Vector3d>& hits) {
  MapOptions options;
  options.resolution = 0.02;
  options.integration = Integration::compatible;
  FreeSpaceMap map(options);
  map.add_volume("tool", {});
  for (const Sphere& ball : balls) map.paint(0, ball);
  Scan scan;
  for (const Vector3d& hit : hits) scan.points.push_back(hit.cast<float>());
  if (!hits.empty()) map.insert(scan);
  return map;
}

Isometry3d camera_from_map() {
  Isometry3d map_from_camera = Isometry3d::Identity();
  map_from_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  map_from_camera.translation() = Vector3d(-0.5, 0.0, 0.0);
  return map_from_camera.inverse();
}

cv::Mat image(int grey = 120) { return cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(grey)); }

cv::Mat drawn(const OverlayScene& scene, int grey = 120) {
  return draw_overlay(image(grey), camera, camera_from_map(), scene);
}

cv::Vec3b pixel_at(const cv::Mat& picture, const Vector3d& point) {
  const auto pixel = camera.project(camera_from_map() * point);
  return picture.at<cv::Vec3b>(static_cast<int>(std::lround(pixel->y())),
                               static_cast<int>(std::lround(pixel->x())));
}

bool shows_image(const cv::Vec3b& bgr) { return bgr == cv::Vec3b(120, 120, 120); }

/// A sheet of hits at distance x, large enough to hide all.
std::vector<Vector3d> wall_at(double x) {
  std::vector<Vector3d> hits;
  for (double y = -0.4; y <= 0.4; y += 0.01)
    for (double z = -0.4; z <= 0.4; z += 0.01) hits.emplace_back(x, y, z);
  return hits;
}

TEST(OverlayScene, nothing_to_draw_leaves_the_image) {
  cv::Mat grey;
  cv::extractChannel(drawn({}), grey, 0);
  EXPECT_EQ(cv::norm(grey, image(), cv::NORM_INF), 0.0);
}

TEST(OverlayScene, a_volume_is_seen_through_and_only_where_it_is) {
  const FreeSpaceMap map = map_of({{{0.5, 0.0, 0.0}, 0.12}}, {});
  const OverlayMap shown = overlay_map(map.snapshot());
  OverlayScene scene;
  scene.map = &shown;
  const cv::Mat dark = drawn(scene, 20), bright = drawn(scene, 220);
  const cv::Vec3b on_dark = pixel_at(dark, {0.5, 0.0, 0.0}), on_bright = pixel_at(bright, {0.5, 0.0, 0.0});
  EXPECT_NE(on_dark, cv::Vec3b(20, 20, 20));
  EXPECT_NE(on_bright, cv::Vec3b(220, 220, 220));
  EXPECT_GT(on_bright[0], on_dark[0] + 80);  // the image shines through
  EXPECT_EQ(pixel_at(dark, {0.5, 0.0, 0.14}), cv::Vec3b(20, 20, 20));
}

TEST(OverlayScene, occupied_voxels_before_a_volume_hide_it_and_those_behind_do_not) {
  const Sphere ball{{0.5, 0.0, 0.0}, 0.12};
  const FreeSpaceMap before = map_of({ball}, wall_at(0.3)), behind = map_of({ball}, wall_at(0.8));
  for (const bool is_before : {true, false}) {
    const OverlayMap shown = overlay_map((is_before ? before : behind).snapshot());
    OverlayScene scene;
    scene.map = &shown;
    EXPECT_EQ(shows_image(pixel_at(drawn(scene), {0.5, 0.0, 0.0})), is_before);
  }
}

TEST(OverlayScene, conflicts_are_red) {
  const FreeSpaceMap map = map_of({{{0.5, 0.0, 0.0}, 0.12}}, wall_at(0.5));
  ASSERT_GT(map.snapshot().counts().conflict, 0U);
  const OverlayMap shown = overlay_map(map.snapshot());
  OverlayScene scene;
  scene.map = &shown;
  cv::Mat picture = drawn(scene);
  int red = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const auto bgr = picture.at<cv::Vec3b>(y, x);
      red += bgr[2] > 2 * bgr[0] + 20 && bgr[2] > 2 * bgr[1] + 20 ? 1 : 0;
    }
  EXPECT_GT(red, 50);
}

/// A box of 0.2 m before the camera: what shines through, and in which colour.
TEST(OverlayScene, a_load_is_solid_in_the_hand_red_where_refused_and_clear_with_a_ghost) {
  OverlayScene scene;
  scene.loads = {{mesh_of(Shape::box({0.1, 0.2, 0.2})), Isometry3d::Identity()}};
  scene.loads[0].map_from_load.translation() = Vector3d(0.5, 0.0, 0.0);
  const auto seen = [&](int grey) { return pixel_at(drawn(scene, grey), {0.45, 0.0, 0.0}); };
  const auto is_red = [](const cv::Vec3b& bgr) { return bgr[2] > 2 * bgr[0] && bgr[2] > 2 * bgr[1]; };
  EXPECT_EQ(seen(20), seen(220));
  EXPECT_FALSE(is_red(seen(120)));
  EXPECT_TRUE(shows_image(pixel_at(drawn(scene), {0.5, 0.2, 0.0})));  // beside it
  scene.loads[0].is_refused = true;
  EXPECT_EQ(seen(20), seen(220));
  EXPECT_TRUE(is_red(seen(120)));
  scene.loads[0].is_refused = false;
  for (const auto holder :
       {OverlayLoad::Holder::start, OverlayLoad::Holder::goal, OverlayLoad::Holder::none}) {
    scene.loads[0].holder = holder;
    EXPECT_GT(seen(220)[1], seen(20)[1] + 20);
    EXPECT_NE(seen(20), cv::Vec3b(20, 20, 20));
  }
}

TEST(OverlayScene, volumes_of_two_labels_have_two_colours) {
  MapOptions options;
  options.resolution = 0.02;
  FreeSpaceMap map(options);
  map.paint(map.add_volume("tool", {}), {{0.5, 0.2, 0.0}, 0.1});
  map.paint(map.add_volume("load", {}), {{0.5, -0.2, 0.0}, 0.1});
  const OverlayMap shown = overlay_map(map.snapshot());
  ASSERT_EQ(shown.volumes.size(), 2U);
  EXPECT_EQ(shown.volumes[1].label, "load");
  OverlayScene scene;
  scene.map = &shown;
  const cv::Mat picture = drawn(scene);
  EXPECT_GT(cv::norm(pixel_at(picture, {0.5, 0.2, 0.0}), pixel_at(picture, {0.5, -0.2, 0.0})), 30.0);
}

/// One box on one joint.
Robot one_box() {
  Robot robot;
  robot.name = "box";
  robot.links.resize(1);
  Body& body = robot.bodies.emplace_back();
  body.part = "base";
  body.shape = Shape::box({0.1, 0.1, 0.1});
  return robot;
}

LinkPoses at(const Vector3d& place) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = place;
  return {pose};
}

TEST(OverlayScene, dots_stand_for_a_volume_and_are_red_outside_of_it) {
  const FreeSpaceMap map = map_of({{{0.5, 0.0, 0.0}, 0.12}}, {});
  const OverlayMap shown = overlay_map(map.snapshot());
  OverlayScene scene;
  scene.map = &shown;
  scene.dots = {{0.5, 0.0, 0.0}};
  const cv::Vec3b inside = pixel_at(drawn(scene), scene.dots[0]);
  EXPECT_TRUE(shows_image(pixel_at(drawn(scene), {0.5, 0.05, 0.0})));  // of the volume nothing else is seen
  EXPECT_FALSE(shows_image(inside));
  scene.is_outside = true;
  const cv::Vec3b outside = pixel_at(drawn(scene), scene.dots[0]);
  EXPECT_GT(outside[2], 180);  // red
  EXPECT_LT(outside[1], 60);
  EXPECT_NE(inside, outside);
}

TEST(OverlayScene, robots_are_solid_and_ghosts_are_not) {
  const RobotSurface robot(one_box());
  OverlayScene scene;
  scene.robot = &robot;
  scene.robot_pose = at({0.5, 0.15, 0.0});
  scene.start_pose = at({0.5, -0.15, 0.0});
  const cv::Mat dark = drawn(scene, 10), bright = drawn(scene, 240);
  EXPECT_EQ(pixel_at(dark, {0.45, 0.15, 0.0}), pixel_at(bright, {0.45, 0.15, 0.0}));
  EXPECT_NE(pixel_at(dark, {0.45, -0.15, 0.0}), pixel_at(bright, {0.45, -0.15, 0.0}));
  EXPECT_NE(pixel_at(dark, {0.45, -0.15, 0.0}), cv::Vec3b(10, 10, 10));
}

TEST(OverlayScene, the_path_keeps_its_colours_in_paint_and_is_hidden_by_the_robot) {
  const FreeSpaceMap map = map_of({{{0.5, 0.0, 0.0}, 0.12}}, {});
  const OverlayMap shown = overlay_map(map.snapshot());
  const RobotSurface robot(one_box());
  OverlayScene scene;
  scene.map = &shown;
  scene.path = {{{0.5, -0.1, 0.0}, {0.5, 0.0, 0.0}, {0.5, 0.1, 0.0}}, {0.0, 0.0, 0.02}};
  const Colour tight = clearance_colour(0.0, 0.02);
  const Vector3d left(0.5, -0.06, 0.0);
  EXPECT_EQ(pixel_at(drawn(scene), left), cv::Vec3b(tight.blue, tight.green, tight.red));
  scene.robot = &robot;
  scene.robot_pose = at({0.3, -0.06, 0.0});
  EXPECT_NE(pixel_at(drawn(scene), left), cv::Vec3b(tight.blue, tight.green, tight.red));
}

TEST(OverlayScene, the_halo_is_as_wide_as_the_bound) {
  for (const double bound : {0.0, 0.03}) {
    OverlayScene scene;
    scene.ball = OverlayBall{{0.5, 0.0, 0.0}, 0.08, bound, true};
    const cv::Mat picture = drawn(scene);
    EXPECT_FALSE(shows_image(pixel_at(picture, {0.5, 0.0, 0.07})));
    EXPECT_EQ(shows_image(pixel_at(picture, {0.5, 0.0, 0.1})), bound == 0.0);
    EXPECT_TRUE(shows_image(pixel_at(picture, {0.5, 0.0, 0.13})));
  }
}

TEST(OverlayScene, clearances_have_colours_that_differ_in_brightness) {
  const auto brightness = [](Colour c) { return 0.3 * c.red + 0.59 * c.green + 0.11 * c.blue; };
  const Colour tight = clearance_colour(0.0, 0.1), half = clearance_colour(0.05, 0.1),
               wide = clearance_colour(1.0, 0.1);
  EXPECT_GT(brightness(half) - brightness(tight), 80.0);
  EXPECT_GT(brightness(half) - brightness(wide), 80.0);
  EXPECT_GT(tight.red, 2 * tight.blue);
  EXPECT_GT(wide.blue, 2 * wide.red);
  EXPECT_EQ(clearance_colour(0.1, 0.0), tight);
}

}  // namespace overlay_scene_test
