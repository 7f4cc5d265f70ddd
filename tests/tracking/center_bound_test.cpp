#include "tracking/center_bound.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/pose_errors.hpp"

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

/// Poses that are made up, so that each source of error is known by itself: by arithmetic.
struct Made {
  BodyPose base, probe;
  Eigen::Vector3d ball{0.0, 0.03, 0.1};

  Made() {
    base.camera_from_body.pose = Eigen::Translation3d(0.0, 0.0, 1.0);
    probe.camera_from_body.pose = Eigen::Translation3d(0.2, 0.1, 0.8);
    base.freedom = probe.freedom = 18;
    base.limits = {base.camera_from_body.pose};
    probe.limits = {probe.camera_from_body.pose};
  }
  CenterBound bound(bool is_mean = false) const {
    return bound_center(base, base.camera_from_body, is_mean, probe, ball, 10);
  }
  Eigen::Vector3d center() const {
    return base.camera_from_body.pose.inverse() * (probe.camera_from_body.pose * ball);
  }
};

const double of_model = confidence_factor(1000000), of_noise = confidence_factor(28);

TEST(CenterBound, each_source_alone_is_the_whole_bound) {
  constexpr double sigma = 1e-3;
  EXPECT_EQ(Made().bound().total, 0.0);
  for (const bool is_base : {true, false}) {
    const auto body = [&](Made& made) -> PoseErrors& { return (is_base ? made.base : made.probe).errors; };
    Made noise, tags, edges, camera;
    body(noise).noise(1, 1) = body(tags).tags(1, 1) = body(edges).edges(1, 1) = sigma * sigma;
    body(camera).by_camera(1, 3) = sigma;
    EXPECT_NEAR(noise.bound().noise, of_noise * sigma, 1e-12);
    EXPECT_NEAR(noise.bound().total, of_noise * sigma, 1e-12);
    EXPECT_NEAR(tags.bound().tags, of_model * sigma, 1e-12);
    EXPECT_NEAR(tags.bound().total, of_model * sigma, 1e-12);
    EXPECT_NEAR(edges.bound().edges, of_model * sigma, 1e-12);
    EXPECT_NEAR(edges.bound().total, of_model * sigma, 1e-12);
    EXPECT_NEAR(camera.bound().camera, of_model * sigma, 1e-12);
    EXPECT_NEAR(camera.bound().total, of_model * sigma, 1e-12);
  }
  Made both;  // the same error of the camera moves both alike: the ball stays where it is on the base
  both.base.errors.by_camera(1, 3) = both.probe.errors.by_camera(1, 3) = sigma;
  EXPECT_NEAR(both.bound().total, 0.0, 1e-12);
}

TEST(CenterBound, turns_that_the_noise_may_hide_count_of_either_body_and_of_no_mean) {
  const Eigen::Isometry3d turn(Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitX()));
  Made base, probe, both;
  base.base.limits.push_back(base.base.camera_from_body.pose * turn);
  probe.probe.limits.push_back(probe.probe.camera_from_body.pose * turn);
  both.base.limits = base.base.limits, both.probe.limits = probe.probe.limits;
  const double chord = 2.0 * std::sin(0.01);
  const double of_base = chord * base.center().tail<2>().norm(),
               of_probe = chord * base.ball.tail<2>().norm();
  EXPECT_NEAR(base.bound().total, of_base, 1e-12);
  EXPECT_NEAR(base.bound(true).total, 0.0, 1e-12);
  EXPECT_NEAR(probe.bound().total, of_probe, 1e-12);
  EXPECT_NEAR(probe.bound(true).total, of_probe, 1e-12);
  EXPECT_NEAR(both.bound().total, std::hypot(of_base, of_probe), 1e-12);
}

TEST(CenterBound, a_means_noise_has_the_factor_that_the_residuals_show) {
  constexpr double sigma = 1e-3;
  for (const double factor : {1.0, 3.0}) {
    Made made;
    made.base.noise_factor = factor;
    made.base.camera_from_body.covariance.setZero();
    made.base.camera_from_body.covariance(0, 0) = sigma * sigma;
    EXPECT_NEAR(made.bound(true).total, of_noise * factor * sigma, 1e-12) << factor;
    EXPECT_NEAR(made.bound(false).total, 0.0, 1e-12) << factor;
  }
}

/// Who is seen by fewer corners says how sure the noise is.
TEST(CenterBound, the_noise_is_known_as_well_as_of_the_body_that_shows_less) {
  constexpr double sigma = 1e-3;
  for (const auto& [of_base, of_probe] : {std::pair(2, 2000), {2000, 2}, {2, 2}}) {
    Made made;
    made.base.freedom = of_base, made.probe.freedom = of_probe;
    made.probe.errors.noise(2, 2) = sigma * sigma;
    EXPECT_NEAR(made.bound().noise, confidence_factor(12) * sigma, 1e-12) << of_base << ' ' << of_probe;
  }
}

}  // namespace center_bound_test
}  // namespace clearway
