#include "tracking/center_bound.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace center_bound_test {

using scene::tag_before_camera;

/// A board and a cube, and what the tracker makes of them when the picture is taken by `actual`.
struct Stage {
  Camera stated = scene::plain_camera(), actual = stated;
  TagBody base = scene::board("base", 0, 3, 2, 0.06, 0.09), probe = scene::cube("probe", 20, 0.05, 0.07);
  TagBody actual_base = base, actual_probe = probe;
  Eigen::Vector3d ball{0.0, 0.0, 0.15};
  Eigen::Isometry3d camera_from_base = tag_before_camera(0.7, 0.7, 0.2, 0.0, -0.12, 0.06);
  Eigen::Isometry3d camera_from_probe = tag_before_camera(0.45, 0.8, 2.5, 0.3, 0.12, -0.06);
  BodyPoseOptions options;
  std::mt19937 random{7};

  CenterBound bound;
  Eigen::Vector3d error;

  void see(double noise) {
    auto tags = scene::placed(actual_base, camera_from_base);
    for (const auto& tag : scene::placed(actual_probe, camera_from_probe)) tags.push_back(tag);
    const auto seen = scene::noisy_detections(actual, tags, noise, random);
    const auto base_pose = estimate_body_pose(base, seen, stated, options);
    const auto probe_pose = estimate_body_pose(probe, seen, stated, options);
    ASSERT_TRUE(base_pose && probe_pose);
    bound = bound_center(*base_pose, base_pose->camera_from_body, false, *probe_pose, ball,
                         options.noise_freedom);
    error = base_pose->camera_from_body.pose.inverse() * (probe_pose->camera_from_body.pose * ball) -
            camera_from_base.inverse() * (camera_from_probe * ball);
  }
};

TEST(CenterBound, holds_the_ball_under_noise_and_is_not_ten_times_too_large) {
  Stage stage;
  stage.stated.errors = {0.0, 0.0, 0.0, 0.0};
  stage.base.errors = stage.probe.errors = {0.0, 0.0, 0.0, 0.0};
  stage.options.edge_bias = 0.0;
  double sum = 0.0;
  const int trials = 1000;
  int outside = 0;
  for (int i = 0; i < trials; ++i) {
    stage.see(0.3);
    outside += stage.error.norm() > stage.bound.total;
    sum += stage.error.norm() / stage.bound.total / trials;
    EXPECT_EQ(stage.bound.camera + stage.bound.tags + stage.bound.edges, 0.0);
  }
  EXPECT_LE(outside, 3);
  EXPECT_GT(sum, 0.15);  // the mean of three Gaussians over five deviations of the worst of them
}

TEST(CenterBound, its_camera_part_is_what_the_calibrations_errors_do_to_both_bodies_together) {
  Stage stage;
  stage.stated.errors = {0.003, 0.0, 0.0, 0.0};
  stage.actual.fx *= 1.003;
  stage.actual.fy *= 1.003;
  stage.see(0.0);
  const double one_deviation = stage.bound.camera / confidence_factor(1000000);
  EXPECT_NEAR(stage.error.norm(), one_deviation, 0.1 * one_deviation);
  // Seen from one distance, both bodies are off alike: the errors cancel but for what is between the two.
  const double lone = 0.003 * 0.7;  // metres that the board alone is off
  EXPECT_LT(stage.error.norm(), 0.7 * lone);
}

TEST(CenterBound, its_tags_part_is_what_a_larger_print_does) {
  Stage stage;
  stage.base.errors = {0.01, 0.0, 0.0, 0.0};
  stage.probe.errors = {0.0, 0.0, 0.0, 0.0};
  for (auto& [id, tag] : stage.actual_base.tags) {
    tag.size *= 1.01;
    tag.body_from_tag.translation() *= 1.01;
  }
  stage.see(0.0);
  const double one_deviation = stage.bound.tags / confidence_factor(1000000);
  EXPECT_NEAR(stage.error.norm(), one_deviation, 0.1 * one_deviation);
}

TEST(CenterBound, is_at_least_each_part_and_at_most_their_sum_in_squares) {
  Stage stage;
  for (int i = 0; i < 50; ++i) {
    stage.camera_from_probe = tag_before_camera(0.3 + 0.02 * i, 0.02 * i, 0.7 * i, 0.3 * i, 0.05, -0.06);
    stage.see(0.2);
    const CenterBound& b = stage.bound;
    const double parts[] = {b.noise, b.tilt, b.camera, b.tags, b.edges};
    double squares = 0.0;
    for (double part : parts) {
      EXPECT_GE(b.total, part * (1 - 1e-12));
      squares += part * part;
    }
    EXPECT_LE(b.total, std::sqrt(squares) * (1 + 1e-12));
  }
}

TEST(CenterBound, of_one_body_holds_its_point_and_the_camera_when_tags_and_calibration_are_off_too) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  const TagBody stated = scene::board("base", 0, 3, 2, 0.06, 0.09);
  Camera camera = scene::plain_camera();
  camera.errors = {0.003, 0.0, 0.0, 0.0};
  const Eigen::Vector3d point(0.1, 0.05, 0.02);
  const int trials = 400;
  int outside = 0;
  double sum = 0.0;
  for (int i = 0; i < trials; ++i) {
    Camera actual = camera;
    const double longer = 1.0 + camera.errors.focal * normal(random);
    actual.fx *= longer;
    actual.fy *= longer;
    TagBody body = stated;
    for (auto& [id, tag] : body.tags) {
      tag.size *= 1.0 + stated.errors.size * normal(random);
      for (int axis = 0; axis < 3; ++axis)
        tag.body_from_tag.translation()[axis] += stated.errors.place * normal(random);
    }
    const Eigen::Isometry3d pose = tag_before_camera(0.7, 0.7, 0.3 * i, 0.0, 0.05, 0.02);
    const auto seen = scene::noisy_detections(actual, scene::placed(body, pose), 0.3, random);
    const auto found = estimate_body_pose(stated, seen, camera);
    ASSERT_TRUE(found);
    const Eigen::Isometry3d& by_fit = found->camera_from_body.pose;
    const CenterBound of_point = bound_point(*found, point, 8), of_camera = bound_camera(*found, 8);
    const double error = (by_fit * point - pose * point).norm();
    outside += error > of_point.total;
    outside += (by_fit.inverse().translation() - pose.inverse().translation()).norm() > of_camera.total;
    sum += error / of_point.total / trials;
  }
  EXPECT_LE(outside, 4);
  EXPECT_GT(sum, 0.05);
}

}  // namespace center_bound_test
}  // namespace clearway
