#include "tracking/calibration/straight_edges.hpp"

#include <gtest/gtest.h>

#include "planning/geometry/turn_between.hpp"
#include "tests/worlds/calibration_views.hpp"
#include "tracking/tag_detector.hpp"

namespace clearway {
namespace straight_edges_test {

/// Tags of some 60 pixels a side, all over the image.
std::vector<scene::PlacedTag> tags_of_60_pixels(const Camera& camera) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<scene::PlacedTag> tags;
  while (tags.size() < 30) {
    const auto ray = camera.undistort(Eigen::Vector2d(320 + 240 * unit(random), 240 + 170 * unit(random)));
    if (!ray) continue;
    const double distance = 0.06 * camera.fx / 60.0;
    const Eigen::Isometry3d ahead = scene::tag_before_camera(distance, 0.4 * std::abs(unit(random)),
                                                             3.0 * unit(random), 3.0 * unit(random));
    tags.push_back({3, 0.06, turn_between(Eigen::Vector3d::UnitZ(), ray->homogeneous()) * ahead});
  }
  return tags;
}

TEST(StraightEdges, meet_where_the_detector_finds_the_corners_of_tags_in_a_fisheye) {
  const Camera camera = scene::fisheye_camera();
  TagDetector detector;
  double by_edges = 0.0, by_lens = 0.0;
  int corners = 0;
  for (const scene::PlacedTag& tag : tags_of_60_pixels(camera)) {
    const auto seen = detector.detect(scene::render(camera, {tag}));
    if (seen.size() != 1) continue;
    const auto found =
        corners_by_straight_edges(camera, {tag.size, Eigen::Isometry3d::Identity()}, {}, tag.camera_from_tag);
    ASSERT_TRUE(found);
    const auto truth = scene::true_corners(camera, tag);
    for (std::size_t i = 0; i < 4; ++i, ++corners) {
      by_edges += ((*found)[i] - seen[0].corners[i]).squaredNorm();
      by_lens += (truth[i] - seen[0].corners[i]).squaredNorm();
    }
  }
  ASSERT_GE(corners, 100);
  EXPECT_LT(std::sqrt(by_edges / corners), 0.15);
  EXPECT_GT(std::sqrt(by_lens / corners), 0.5);
}

TEST(StraightEdges, are_those_of_the_lines_that_fit_many_points_of_each_edge) {
  for (const Camera& camera : {scene::fisheye_camera(), scene::distorted_camera()})
    for (const scene::PlacedTag& tag : tags_of_60_pixels(camera)) {
      const MountedTag mounted{tag.size, Eigen::Isometry3d::Identity()};
      const auto found = corners_by_straight_edges(camera, mounted, {}, tag.camera_from_tag);
      ASSERT_TRUE(found);
      const auto lines = scene::corners_of_lines(mounted, [&](const Eigen::Vector3d& point) {
        return camera.project(tag.camera_from_tag * point).value();
      });
      for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(((*found)[i] - lines[i]).norm(), 0.15);
    }
}

TEST(StraightEdges, of_a_camera_without_a_distortion_meet_in_the_corners) {
  const scene::PlacedTag tag{3, 0.06, scene::tag_before_camera(0.3, 0.6, 1.0, 0.4, 0.05, 0.03)};
  const auto found = corners_by_straight_edges(
      scene::plain_camera(), {tag.size, Eigen::Isometry3d::Identity()}, {}, tag.camera_from_tag);
  const auto truth = scene::true_corners(scene::plain_camera(), tag);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((found.value()[i] - truth[i]).norm(), 1e-9);
}

TEST(StraightEdges, of_a_tag_behind_the_camera_are_none) {
  Eigen::Isometry3d behind = Eigen::Isometry3d::Identity();
  behind.translation().z() = -1.0;
  EXPECT_FALSE(
      corners_by_straight_edges(scene::plain_camera(), {0.06, Eigen::Isometry3d::Identity()}, {}, behind));
}

}  // namespace straight_edges_test
}  // namespace clearway
