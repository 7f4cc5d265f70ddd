#include "tracking/pose_refinement.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace pose_refinement_test {

std::vector<CornerMatch> matches_of_random_points(const Camera& camera,
                                                  const Eigen::Isometry3d& camera_from_body, double noise,
                                                  std::mt19937& random) {
  std::uniform_real_distribution<double> place(-0.1, 0.1);
  std::normal_distribution<double> pixel(0.0, 1.0);
  std::vector<CornerMatch> matches;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d point(place(random), place(random), place(random));
    matches.push_back({point, scene::pixel_by_opencv(camera, camera_from_body * point) +
                                  noise * Eigen::Vector2d(pixel(random), pixel(random))});
  }
  return matches;
}

double squared_error(const Camera& camera, const std::vector<CornerMatch>& matches,
                     const Eigen::Isometry3d& pose) {
  double sum = 0;
  for (const auto& m : matches)
    sum += (scene::pixel_by_opencv(camera, pose * m.in_body) - m.pixel).squaredNorm();
  return sum;
}

TEST(RefinePose, reaches_the_true_pose_of_exact_points_from_a_wrong_start) {
  std::mt19937 random(21);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Camera camera = i % 2 ? scene::plain_camera() : scene::distorted_camera();
    const Eigen::Isometry3d truth = scene::tag_before_camera(0.7, 0.4, i, 2 * i);
    Vector6d off;
    for (int k = 0; k < 6; ++k) off[k] = (k < 3 ? 0.02 : 0.15) * normal(random);
    const auto matches = matches_of_random_points(camera, truth, 0.0, random);
    const auto found = refine_pose(camera, matches, moved(truth, off));
    ASSERT_TRUE(found);
    EXPECT_LT(difference(truth, found->camera_from_body).norm(), 1e-7);
    EXPECT_LT(found->squared_error, 1e-10);
  }
}

TEST(RefinePose, ends_where_no_small_motion_lowers_the_error_that_opencv_measures) {
  std::mt19937 random(22);
  const Camera camera = scene::distorted_camera();
  for (int i = 0; i < 50; ++i) {
    const Eigen::Isometry3d truth = scene::tag_before_camera(0.8, 0.5, i, i);
    const auto matches = matches_of_random_points(camera, truth, 0.5, random);
    const auto found = refine_pose(camera, matches, truth);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->squared_error, squared_error(camera, matches, found->camera_from_body), 1e-9);
    for (int k = 0; k < 6; ++k)
      for (double h : {-1e-4, 1e-4})
        EXPECT_LT(found->squared_error,
                  squared_error(camera, matches, moved(found->camera_from_body, h * Vector6d::Unit(k))));
  }
}

TEST(RefinePose, its_information_is_the_curvature_of_the_error_of_exact_points) {
  std::mt19937 random(23);
  const Camera camera = scene::distorted_camera();
  const Eigen::Isometry3d truth = scene::tag_before_camera(0.6, 0.5, 1, 1);
  const auto matches = matches_of_random_points(camera, truth, 0.0, random);
  const auto found = refine_pose(camera, matches, truth);
  ASSERT_TRUE(found);
  const double h = 1e-5;
  for (int i = 0; i < 6; ++i)
    for (int k = 0; k < 6; ++k) {
      const auto at = [&](double a, double b) {
        return squared_error(camera, matches, moved(truth, a * Vector6d::Unit(i) + b * Vector6d::Unit(k)));
      };
      const double curvature = (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (8 * h * h);
      EXPECT_NEAR(found->information(i, k), curvature, 1e-3 * found->information.norm());
    }
}

TEST(RefinePose, gives_nothing_for_too_few_points_or_a_start_behind_the_camera) {
  std::mt19937 random(24);
  const Eigen::Isometry3d truth = scene::tag_before_camera(0.6, 0.5);
  auto matches = matches_of_random_points(scene::plain_camera(), truth, 0.0, random);
  Eigen::Isometry3d behind = truth;
  behind.translation().z() *= -1;
  EXPECT_FALSE(refine_pose(scene::plain_camera(), matches, behind));
  matches.resize(2);
  EXPECT_FALSE(refine_pose(scene::plain_camera(), matches, truth));
  EXPECT_FALSE(refine_pose(scene::plain_camera(), {}, truth));
}

}  // namespace pose_refinement_test
}  // namespace clearway
