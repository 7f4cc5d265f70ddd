#include "tracking/tag_body.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/pose_refinement.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace tag_body_test {

using scene::tag_before_camera;

constexpr double kDegree = M_PI / 180.0;

struct Error {
  double metres = 0.0, radians = 0.0;
};

Error error_of(const BodyPose& pose, const Eigen::Isometry3d& truth) {
  const Vector6d motion = difference(truth, pose.camera_from_body.pose);
  return {motion.head<3>().norm(), motion.tail<3>().norm()};
}

TEST(BodyPose, of_a_cube_and_a_board_in_rendered_images_is_right_to_a_millimetre_and_a_third_of_a_degree) {
  const TagBody board = scene::board("board", 10, 2, 2, 0.05, 0.08);
  const TagBody cube = scene::cube("cube", 30, 0.05, 0.07);
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera()})
    for (int i = 0; i < 6; ++i) {
      const Eigen::Isometry3d camera_from_board =
          tag_before_camera(0.6, 0.3 + 0.1 * i, i, 0.4 * i, -0.12, 0.02);
      const Eigen::Isometry3d camera_from_cube =
          tag_before_camera(0.5, 0.5 + 0.05 * i, 2 * i, 0.3 * i, 0.11, -0.03);
      auto tags = scene::placed(board, camera_from_board);
      for (const auto& tag : scene::placed(cube, camera_from_cube)) tags.push_back(tag);
      const auto found = TagDetector().detect(scene::render(camera, tags));
      const auto board_pose = estimate_body_pose(board, found, camera);
      const auto cube_pose = estimate_body_pose(cube, found, camera);
      ASSERT_TRUE(board_pose && cube_pose);
      EXPECT_EQ(board_pose->tags, (std::vector<int>{10, 11, 12, 13}));
      EXPECT_GE(cube_pose->tags.size(), 2u);
      for (const Error& error :
           {error_of(*board_pose, camera_from_board), error_of(*cube_pose, camera_from_cube)}) {
        EXPECT_LT(error.metres, 1e-3);
        EXPECT_LT(error.radians, kDegree / 3);
      }
      EXPECT_LT(board_pose->rms_px, 0.25);
      EXPECT_GT(board_pose->ambiguity_ratio, 2.0);
      EXPECT_GT(cube_pose->separation, 36.0);
    }
}

TEST(BodyPose, from_four_tags_is_several_times_better_than_from_one) {
  std::mt19937 random(31);
  const TagBody board = scene::board("board", 0, 2, 2, 0.06, 0.12);
  TagBody single = board;
  for (int id = 1; id < 4; ++id) single.tags.erase(id);
  double many_turn = 0, one_turn = 0, many_shift = 0, one_shift = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Isometry3d truth = tag_before_camera(0.8, 0.6, i, i);
    const auto seen =
        scene::noisy_detections(scene::plain_camera(), scene::placed(board, truth), 0.3, random);
    const auto many = estimate_body_pose(board, seen, scene::plain_camera());
    const auto one = estimate_body_pose(single, seen, scene::plain_camera());
    ASSERT_TRUE(many && one);
    many_turn += std::pow(error_of(*many, truth).radians, 2),
        one_turn += std::pow(error_of(*one, truth).radians, 2);
    many_shift += std::pow(error_of(*many, truth).metres, 2),
        one_shift += std::pow(error_of(*one, truth).metres, 2);
  }
  EXPECT_LT(std::sqrt(many_turn), std::sqrt(one_turn) / 3);
  EXPECT_LT(std::sqrt(many_shift), std::sqrt(one_shift) / 3);
}

// Normalised estimation error squared: 6 on average when the covariance is honest.
double mean_nees(const TagBody& body, double distance, double stated, double actual, int trials) {
  std::mt19937 random(32);
  BodyPoseOptions options;
  options.pixel_noise = stated;
  double sum = 0;
  for (int i = 0; i < trials; ++i) {
    const Eigen::Isometry3d truth = tag_before_camera(distance, 0.7, i, 0.7 * i);
    const auto seen =
        scene::noisy_detections(scene::distorted_camera(), scene::placed(body, truth), actual, random);
    const auto pose = estimate_body_pose(body, seen, scene::distorted_camera(), options);
    if (!pose) return -1;
    const Vector6d error = difference(pose->camera_from_body.pose, truth);
    sum += Cholesky(pose->camera_from_body.covariance).squared(error) / trials;
  }
  return sum;
}

TEST(BodyPose, covariance_is_calibrated_for_boards_and_cubes) {
  // 1,000 trials of chi-square(6): standard deviation of the mean 0.11
  EXPECT_NEAR(mean_nees(scene::board("board", 0, 2, 2, 0.06, 0.1), 0.6, 0.3, 0.3, 1000), 6.0, 0.45);
  EXPECT_NEAR(mean_nees(scene::board("board", 0, 2, 2, 0.06, 0.1), 0.8, 0.5, 0.5, 1000), 6.0, 0.45);
  EXPECT_NEAR(mean_nees(scene::cube("cube", 0, 0.05, 0.07), 0.6, 0.3, 0.3, 1000), 6.0, 0.45);
}

TEST(BodyPose, covariance_grows_with_the_residuals_when_the_noise_is_worse_than_stated) {
  const TagBody board = scene::board("board", 0, 2, 2, 0.06, 0.1);
  const double honest = mean_nees(board, 0.6, 0.3, 0.9, 500);  // 54 without the residuals' word
  EXPECT_LT(honest, 9.0);
  EXPECT_LT(mean_nees(board, 0.6, 0.9, 0.3, 500), 2.0);  // a stated noise is never lowered
}

TEST(BodyPose, is_one_of_the_minima_that_random_starts_find_and_the_best_of_them) {
  std::mt19937 random(33);
  std::normal_distribution<double> normal;
  const Camera camera = scene::plain_camera();
  for (int i = 0; i < 40; ++i) {
    const TagBody body =
        i % 2 ? scene::board("one", 0, 1, 1, 0.06, 0.1) : scene::board("three", 0, 3, 1, 0.04, 0.06);
    const Eigen::Isometry3d truth = tag_before_camera(0.9, 0.1 + 0.02 * i, i, i);
    const auto seen = scene::noisy_detections(camera, scene::placed(body, truth), 0.4, random);
    const auto pose = estimate_body_pose(body, seen, camera);
    ASSERT_TRUE(pose);
    std::vector<CornerMatch> corners;
    for (const auto& d : seen)
      for (int k = 0; k < 4; ++k) {
        const double h = body.tags.at(d.id).size / 2;
        const Eigen::Vector3d points[4] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
        corners.push_back({body.tags.at(d.id).body_from_tag * points[k], d.corners[k]});
      }
    const double best = pose->rms_px * pose->rms_px * static_cast<double>(corners.size());
    for (int start = 0; start < 60; ++start) {
      Vector6d off;
      for (int k = 0; k < 6; ++k) off[k] = (k < 3 ? 0.02 : 0.6) * normal(random);
      const auto other = refine_pose(camera, corners, moved(truth, off), 200);
      if (!other || !(other->camera_from_body.linear().col(2).dot(other->camera_from_body.translation()) < 0))
        continue;
      EXPECT_GT(other->squared_error, best - 1e-6) << i;
      const double turn = scene::angle(other->camera_from_body, pose->camera_from_body.pose);
      if (turn > 0.1 && other->squared_error < best + 20.0 && pose->alternative) {
        const double nearest = std::min(turn, scene::angle(other->camera_from_body, *pose->alternative));
        EXPECT_LT(nearest, 0.12) << "an unreported minimum, " << i;
      }
    }
  }
}

TEST(BodyPose, a_flat_far_tag_is_reported_as_ambiguous) {
  std::mt19937 random(34);
  const TagBody body = scene::board("one", 0, 1, 1, 0.06, 0.1);
  int ambiguous = 0;
  for (int i = 0; i < 200; ++i) {
    const auto seen = scene::noisy_detections(
        scene::plain_camera(), scene::placed(body, tag_before_camera(1.5, 0.35, i)), 0.3, random);
    const auto pose = estimate_body_pose(body, seen, scene::plain_camera());
    ASSERT_TRUE(pose);
    ambiguous += pose->alternative && pose->separation < 36.0;
  }
  EXPECT_GT(ambiguous, 180);
}

// Of a far board each tag offers answers of its own: what separates is the best of them, not the last.
TEST(BodyPose, separation_is_no_more_than_the_alternative_is_worse) {
  std::mt19937 random(35);
  const TagBody body = scene::board("flat", 0, 2, 2, 0.04, 0.05);
  const Camera camera = scene::plain_camera();
  const BodyPoseOptions options{.pixel_noise = 0.3};
  int with_other = 0;
  for (int i = 0; i < 60; ++i) {
    const auto seen = scene::noisy_detections(
        camera, scene::placed(body, tag_before_camera(1.5, 0.3, i, 0.3 * i)), 0.3, random);
    const auto pose = estimate_body_pose(body, seen, camera, options);
    ASSERT_TRUE(pose);
    if (!pose->alternative) continue;
    const auto left = [&](const Eigen::Isometry3d& camera_from_body) {
      std::vector<TagView> views;
      for (const TagDetection& tag : seen) {
        if (std::find(pose->tags.begin(), pose->tags.end(), tag.id) == pose->tags.end()) continue;
        const MountedTag& mounted = body.tags.at(tag.id);
        views.push_back(*view_tag(camera, mounted.size, mounted.body_from_tag, body.errors, options.edge_bias,
                                  tag.corners, camera_from_body));
      }
      return unexplained(views, options.pixel_noise * pose->noise_factor);
    };
    const double worse = left(*pose->alternative) - left(pose->camera_from_body.pose);
    EXPECT_LE(pose->separation, worse * (1.0 + 1e-6) + 1e-6) << i;
    ++with_other;
  }
  EXPECT_GT(with_other, 20);
}

TEST(BodyPose, leaves_out_a_tag_seen_at_a_graze_but_not_when_it_is_the_only_one) {
  std::mt19937 random(37);
  const TagBody cube = scene::cube("cube", 0, 0.05, 0.07);
  const Eigen::Isometry3d truth = tag_before_camera(0.5, 12 * kDegree, M_PI / 2);  // one side at 78 degrees
  std::vector<scene::PlacedTag> tags;
  for (const auto& [id, tag] : cube.tags) tags.push_back({id, tag.size, truth * tag.body_from_tag});
  std::erase_if(tags, [](const auto& tag) { return !faces_camera(tag.camera_from_tag); });
  ASSERT_EQ(tags.size(), 2u);
  auto seen = scene::noisy_detections(scene::plain_camera(), tags, 0.1, random);
  const int frontal = 0, grazing = tags[1].id;
  const auto pose = estimate_body_pose(cube, seen, scene::plain_camera());
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->tags, std::vector<int>{frontal});
  BodyPoseOptions all;
  all.min_facing = 0.0;
  EXPECT_EQ(estimate_body_pose(cube, seen, scene::plain_camera(), all)->tags,
            (std::vector<int>{frontal, grazing}));
  seen.erase(seen.begin());
  const auto alone = estimate_body_pose(cube, seen, scene::plain_camera());
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->tags, std::vector<int>{grazing});
}

TEST(BodyPose, uses_only_its_own_tags_and_is_empty_without_any) {
  std::mt19937 random(35);
  const TagBody board = scene::board("board", 0, 2, 2, 0.06, 0.1);
  const Eigen::Isometry3d truth = tag_before_camera(0.6, 0.5);
  auto seen = scene::noisy_detections(scene::plain_camera(), scene::placed(board, truth), 0.1, random);
  const auto alone = estimate_body_pose(board, seen, scene::plain_camera());
  seen.push_back({99, 0, 80.0, seen[0].corners});
  const auto crowded = estimate_body_pose(board, seen, scene::plain_camera());
  ASSERT_TRUE(alone && crowded);
  EXPECT_EQ(alone->camera_from_body.pose.matrix(), crowded->camera_from_body.pose.matrix());
  EXPECT_FALSE(estimate_body_pose(board, {}, scene::plain_camera()));
  EXPECT_FALSE(estimate_body_pose(board, {seen.back()}, scene::plain_camera()));
}

TEST(BodyPose, leaves_out_a_tag_that_the_others_contradict) {
  std::mt19937 random(36);
  const TagBody board = scene::board("board", 0, 2, 2, 0.06, 0.1);
  TagBody bent = board;
  bent.tags[3].body_from_tag.translation().x() += 0.01;
  const Eigen::Isometry3d truth = tag_before_camera(0.6, 0.5);
  const auto seen = scene::noisy_detections(scene::plain_camera(), scene::placed(bent, truth), 0.1, random);
  const auto pose = estimate_body_pose(board, seen, scene::plain_camera());
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->tags, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(pose->rejected, std::vector<int>{3});
  EXPECT_LT(error_of(*pose, truth).metres, 0.001);
  BodyPoseOptions all;
  all.reject_tags = false;
  const auto with_it = estimate_body_pose(board, seen, scene::plain_camera(), all);
  EXPECT_GT(with_it->rms_px, 1.0);
  EXPECT_GT(with_it->chi_square, chi_square_limit(with_it->freedom));
}

TEST(BodyPose, rejects_no_tag_for_noise_or_for_errors_as_stated) {
  std::mt19937 random(38);
  const TagBody board = scene::board("board", 0, 3, 2, 0.06, 0.1);
  int rejected = 0;
  for (int i = 0; i < 200; ++i) {
    TagBody glued = board;
    std::normal_distribution<double> place(0.0, board.errors.place);
    for (auto& [id, tag] : glued.tags)
      for (int k = 0; k < 3; ++k) tag.body_from_tag.translation()[k] += place(random);
    const auto seen = scene::noisy_detections(
        scene::plain_camera(), scene::placed(glued, tag_before_camera(0.6, 0.5, i)), 0.3, random);
    rejected += static_cast<int>(estimate_body_pose(board, seen, scene::plain_camera())->rejected.size());
  }
  EXPECT_LE(rejected, 1);
}

TEST(BodyPose, its_limits_hold_the_truth_of_a_frontal_tag_whose_covariance_does_not) {
  std::mt19937 random(39);
  const TagBody body = scene::board("one", 0, 1, 1, 0.06, 0.1);
  const Camera camera = scene::plain_camera();
  int beyond_covariance = 0, beyond_limits = 0;
  const int trials = 300;
  for (int i = 0; i < trials; ++i) {
    const Eigen::Isometry3d truth = tag_before_camera(0.6, 0.12, 0.37 * i);
    const auto seen = scene::noisy_detections(camera, scene::placed(body, truth), 0.3, random);
    const auto pose = estimate_body_pose(body, seen, camera);
    ASSERT_TRUE(pose);
    const auto tilt_from = [&](const Eigen::Isometry3d& other) {
      return std::acos(std::min(1.0, pose->camera_from_body.pose.linear().col(2).dot(other.linear().col(2))));
    };
    double widest = 0.0;
    for (const Eigen::Isometry3d& limit : pose->limits) widest = std::max(widest, tilt_from(limit));
    beyond_limits += tilt_from(truth) > widest;
    const Vector6d error = difference(pose->camera_from_body.pose, truth);
    beyond_covariance += Cholesky(pose->camera_from_body.covariance).squared(error) > 22.5;  // 1 in 1,000
  }
  EXPECT_EQ(beyond_limits, 0);
  EXPECT_GT(beyond_covariance, trials / 50);
}

TEST(TagBody, refuses_empty_bodies_and_tags_that_cannot_be) {
  const TagBody board = scene::board("board", 0, 2, 2, 0.06, 0.1);
  EXPECT_NO_THROW(board.validate());
  EXPECT_THROW((TagBody{"none", {}}.validate()), std::invalid_argument);
  const auto refuses = [&](int id, const MountedTag& tag) {
    TagBody spoilt = board;
    spoilt.tags[id] = tag;
    EXPECT_THROW(spoilt.validate(), std::invalid_argument);
  };
  MountedTag mirrored{0.06, Eigen::Isometry3d::Identity()}, lost = mirrored, stretched = mirrored;
  mirrored.body_from_tag.linear()(0, 0) = -1;
  stretched.body_from_tag.linear() *= 1.01;
  lost.body_from_tag.translation().x() = NAN;
  refuses(2, mirrored);
  refuses(2, stretched);
  refuses(2, lost);
  refuses(2, {0.0, Eigen::Isometry3d::Identity()});
  refuses(2, {NAN, Eigen::Isometry3d::Identity()});
  refuses(-1, {0.06, Eigen::Isometry3d::Identity()});
  TagBody doubtful = board;
  doubtful.errors.turn = -0.1;
  EXPECT_THROW(doubtful.validate(), std::invalid_argument);
}

TEST(BodyPoseOptions, out_of_range_are_refused) {
  BodyPoseOptions options;
  options.pixel_noise = 0.0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options.pixel_noise = 0.3;
  options.distinct_angle = 0.0;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options.distinct_angle = 0.1;
  options.edge_bias = -0.1;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options.edge_bias = 0.1;
  options.noise_freedom = 5;
  EXPECT_THROW(options.validate(), std::invalid_argument);
  options.noise_freedom = 8;
  for (double facing : {-0.1, 1.0, std::nan("")}) {
    options.min_facing = facing;
    EXPECT_THROW(options.validate(), std::invalid_argument);
  }
}

/// A picture five times as noisy as stated may hide larger tilts: as far as the noise that it shows has it.
TEST(BodyPose, limits_are_those_of_the_noise_that_the_residuals_show) {
  const TagBody board = scene::board("board", 10, 2, 2, 0.05, 0.08);
  const Camera camera = scene::plain_camera();
  std::mt19937 random(5);
  BodyPoseOptions options;
  options.edge_bias = 0.0, options.pixel_noise = 0.1, options.reject_tags = false;
  const auto seen = scene::noisy_detections(
      camera, scene::placed(board, tag_before_camera(0.6, 0.4, 1.0, 0.2, 0.0, 0.0)), 0.5, random);
  const auto pose = estimate_body_pose(board, seen, camera, options);
  ASSERT_TRUE(pose);
  ASSERT_GT(pose->noise_factor, 1.5);
  std::vector<CornerMatch> corners;
  for (const TagDetection& tag : seen) {
    const MountedTag& mounted = board.tags.at(tag.id);
    const auto points = tag_corners(mounted.size);
    for (std::size_t i = 0; i < 4; ++i)
      corners.push_back({mounted.body_from_tag * points[i], tag.corners[i]});
  }
  const auto farthest = [&](const std::vector<Eigen::Isometry3d>& limits) {
    double most = 0.0;
    for (const Eigen::Isometry3d& limit : limits)
      most = std::max(most, difference(pose->camera_from_body.pose, limit).tail<3>().norm());
    return most;
  };
  const auto limits = tilt_limits(camera, corners, pose->camera_from_body.pose, 0.1 * pose->noise_factor,
                                  confidence_factor(options.noise_freedom + pose->freedom));
  ASSERT_FALSE(limits.empty());
  EXPECT_NEAR(farthest(pose->limits), farthest(limits), 1e-6 * farthest(limits));
}

/// Corners that contradict each other are explained least badly from infinitely far away.
TEST(BodyPose, is_never_where_its_tags_would_be_smaller_than_a_pixel) {
  const TagBody board = scene::board("board", 10, 2, 2, 0.05, 0.08);
  const Camera camera = scene::plain_camera();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> across(0.2, 0.8), side(8.0, 60.0), turn(0.0, 2.0 * M_PI);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<TagDetection> tags;
    for (int id = 10; id < 14; ++id) {
      TagDetection tag;
      tag.id = id;
      const Eigen::Vector2d middle(across(random) * camera.width, across(random) * camera.height);
      const double half = 0.7 * side(random), angle = turn(random);
      for (std::size_t k = 0; k < 4; ++k) {
        const double to_corner = angle + 0.5 * M_PI * static_cast<double>(k);
        tag.corners[k] = middle + half * Eigen::Vector2d(std::cos(to_corner), std::sin(to_corner));
      }
      tags.push_back(tag);
    }
    const auto pose = estimate_body_pose(board, tags, camera);
    if (!pose) continue;
    ++found;
    EXPECT_LT(pose->camera_from_body.pose.translation().norm(), 0.05 * camera.fx + 0.2) << i;
  }
  EXPECT_GT(found, 30);
}

}  // namespace tag_body_test
}  // namespace clearway
