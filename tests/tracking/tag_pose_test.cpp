#include "tracking/tag_pose.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/tag_detector.hpp"

namespace clearway {
namespace tag_pose_test {

using scene::PlacedTag;
using scene::tag_before_camera;

constexpr double kDegree = M_PI / 180.0;

double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.translation() - b.translation()).norm();
}

TEST(TagPose, returns_the_pose_that_made_exact_corners_among_at_most_two) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera()})
    for (int i = 0; i < 500; ++i) {
      const PlacedTag tag{
          1, 0.06,
          tag_before_camera(0.7 + 0.3 * unit(random), 0.15 + 0.5 * (1 + unit(random)), 3 * unit(random),
                            3 * unit(random), 0.12 * unit(random), 0.09 * unit(random))};
      if (!faces_camera(tag.camera_from_tag)) continue;
      const TagPose pose = estimate_tag_pose(scene::true_corners(camera, tag), tag.size, camera);
      ASSERT_GE(pose.solutions.size(), 1u);
      EXPECT_LE(pose.solutions.size(), 2u);
      EXPECT_LT(pose.solutions[0].rms_px, 1e-4);
      EXPECT_LT(distance(pose.solutions[0].camera_from_tag, tag.camera_from_tag), 1e-5);
      EXPECT_LT(scene::angle(pose.solutions[0].camera_from_tag, tag.camera_from_tag), 1e-4);
      EXPECT_GT(pose.ambiguity_ratio(), 100.0);
    }
}

TEST(TagPose, from_rendered_images_is_right_to_a_millimetre_and_a_degree_at_every_tilt) {
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera()})
    for (double tilt : {15.0, 25.0, 40.0, 55.0, 65.0})
      for (double azimuth : {0.3, 2.0, 4.4}) {
        const PlacedTag tag{42, 0.06,
                            tag_before_camera(0.45, tilt * kDegree, azimuth, 1.1 * azimuth, 0.05, -0.04)};
        const auto found = TagDetector().detect(scene::render(camera, {tag}));
        ASSERT_EQ(found.size(), 1u);
        const TagPose pose = estimate_tag_pose(found[0].corners, tag.size, camera);
        ASSERT_FALSE(pose.empty());
        EXPECT_LT(distance(pose.solutions[0].camera_from_tag, tag.camera_from_tag), 1e-3) << tilt;
        EXPECT_LT(scene::angle(pose.solutions[0].camera_from_tag, tag.camera_from_tag), 1.0 * kDegree)
            << tilt;
      }
}

TEST(TagPose, the_error_of_a_solution_is_the_root_of_its_corners_mean_square_in_pixels) {
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0.0, 0.5);
  for (const Camera& camera : {scene::plain_camera(), scene::distorted_camera()})
    for (int i = 0; i < 50; ++i) {
      const PlacedTag tag{1, 0.06, tag_before_camera(0.5, 0.5, 0.1 * i, 0.2 * i, 0.02, 0.01)};
      auto corners = scene::true_corners(camera, tag);
      for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(noise(random), noise(random));
      for (const auto& solution : estimate_tag_pose(corners, tag.size, camera).solutions) {
        double mean = 0.0;
        for (int k = 0; k < 4; ++k) {
          const Eigen::Vector3d point = solution.camera_from_tag * tag_corners(tag.size)[k];
          mean += (camera.project(point).value() - corners[k]).squaredNorm() / 4;
        }
        EXPECT_NEAR(solution.rms_px, std::sqrt(mean), 1e-9);
      }
    }
}

TEST(TagPose, a_tag_of_which_two_corners_are_one_has_none) {
  const Camera camera = scene::plain_camera();
  const auto pose_of = [&](double side) {  // half of the upper one, seen from 1 m
    const Eigen::Vector3d rays[4] = {
        {-side, -0.1, 1.0}, {side, -0.1, 1.0}, {0.1, 0.1, 1.0}, {-0.1, 0.1, 1.0}};
    std::array<Eigen::Vector2d, 4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = camera.project(rays[i]).value();
    return estimate_tag_pose(corners, 0.1, camera);
  };
  EXPECT_FALSE(pose_of(0.05).empty());
  EXPECT_TRUE(pose_of(1e-8).empty());
}

// Why the order of the corners matters: of the 24 orders only ours gives the true pose, and three others give
// a wrong pose that reprojects just as well, so that nothing downstream could notice.
TEST(TagPose, every_other_order_of_detected_corners_gives_a_wrong_pose_or_none) {
  const Camera camera = scene::plain_camera();
  const PlacedTag tag{42, 0.06, tag_before_camera(0.4, 0.6, 0.8, 0.4, 0.03, 0.02)};
  const auto found = TagDetector().detect(scene::render(camera, {tag}));
  ASSERT_EQ(found.size(), 1u);
  const double true_rms = estimate_tag_pose(found[0].corners, tag.size, camera).solutions.at(0).rms_px;
  std::array<int, 4> order = {0, 1, 2, 3};
  int right = 0, wrong_unnoticed = 0, none = 0;
  do {
    std::array<Eigen::Vector2d, 4> corners;
    for (int i = 0; i < 4; ++i) corners[i] = found[0].corners[order[i]];
    const TagPose pose = estimate_tag_pose(corners, tag.size, camera);
    if (pose.empty()) {
      ++none;
    } else if (scene::angle(pose.solutions[0].camera_from_tag, tag.camera_from_tag) < 2.0 * kDegree) {
      ++right;
      EXPECT_EQ(order, (std::array<int, 4>{0, 1, 2, 3}));
    } else {
      EXPECT_GT(scene::angle(pose.solutions[0].camera_from_tag, tag.camera_from_tag), 80.0 * kDegree);
      EXPECT_NEAR(pose.solutions[0].rms_px, true_rms, 0.01);
      ++wrong_unnoticed;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(right, 1);
  EXPECT_EQ(wrong_unnoticed, 3);  // the quarter turns
  EXPECT_EQ(none, 20);            // mirrored or crossed: refused
}

TEST(TagPose, the_ambiguity_ratio_is_that_of_both_errors_however_small_they_are) {
  const auto ratio = [](const std::vector<double>& errors) {
    TagPose pose;
    for (const double rms : errors) {
      pose.solutions.emplace_back();
      pose.solutions.back().rms_px = rms;
    }
    return pose.ambiguity_ratio();
  };
  EXPECT_DOUBLE_EQ(ratio({0.1, 0.15}), 1.5);
  EXPECT_DOUBLE_EQ(ratio({2.0, 5.0}), 2.5);
  EXPECT_TRUE(std::isinf(ratio({0.0, 0.1})));
  EXPECT_TRUE(std::isinf(ratio({0.1})));
  EXPECT_TRUE(std::isinf(ratio({})));
}

TEST(TagPose, solutions_are_sorted_and_both_face_the_camera) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  int two = 0;
  for (int i = 0; i < 2000; ++i) {
    const PlacedTag tag{1, 0.06, tag_before_camera(0.9, 0.6 * std::abs(unit(random)), 3 * unit(random))};
    const auto seen = scene::noisy_detections(scene::plain_camera(), {tag}, 0.5, random);
    const TagPose pose = estimate_tag_pose(seen[0].corners, tag.size, scene::plain_camera());
    for (const auto& solution : pose.solutions) EXPECT_TRUE(faces_camera(solution.camera_from_tag));
    if (pose.solutions.size() < 2) continue;
    ++two;
    EXPECT_LE(pose.solutions[0].rms_px, pose.solutions[1].rms_px);
    EXPECT_GE(pose.ambiguity_ratio(), 1.0);
  }
  EXPECT_GT(two, 1000);
}

TEST(TagPose, degenerate_corners_give_no_pose) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Camera camera = scene::distorted_camera();
  using Corners = std::array<Eigen::Vector2d, 4>;
  const auto at = [](double a, double b) { return Eigen::Vector2d(a, b); };
  const Corners faults[] = {{at(100, 100), at(100, 100), at(100, 100), at(100, 100)},
                            {at(100, 100), at(200, 100), at(300, 100), at(400, 100)},
                            {at(100, 100), at(200, 200), at(300, 300), at(50, 300)},
                            {at(100, 100), at(200, 200), at(200, 100), at(100, 200)},
                            {at(100, 100), at(200, 100), at(130, 120), at(100, 200)},
                            {at(nan, 100), at(200, 100), at(200, 200), at(100, 200)},
                            {at(100, 100), at(200, inf), at(200, 200), at(100, 200)},
                            {at(1e9, 100), at(2e9, 100), at(2e9, 200), at(1e9, 200)},
                            {at(100, 200), at(200, 200), at(200, 100), at(100, 100)}};  // mirrored
  for (const Corners& corners : faults) EXPECT_TRUE(estimate_tag_pose(corners, 0.06, camera).empty());
}

TEST(TagPose, a_corner_that_turns_by_less_than_a_twentieth_gives_no_pose) {
  const auto poses = [](double turn) {  // tangent, at the second corner
    const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(200, 100), Eigen::Vector2d(300, 100),
                                                 Eigen::Vector2d(400, 100 + 100 * turn),
                                                 Eigen::Vector2d(300, 300)};
    return estimate_tag_pose(corners, 0.06, scene::plain_camera()).solutions.size();
  };
  EXPECT_EQ(poses(0.048), 0u);
  EXPECT_GT(poses(0.053), 0u);
}

TEST(TagPose, a_tag_that_is_seen_edge_on_does_not_face_the_camera) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.0, 0.0, 1.0);
  EXPECT_FALSE(faces_camera(pose));  // away
  pose.linear() << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_FALSE(faces_camera(pose));
  pose.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  EXPECT_TRUE(faces_camera(pose));
}

TEST(TagPose, random_corners_never_throw_and_never_give_a_pose_behind_the_camera) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> x(-50, 690), y(-50, 530);
  for (int i = 0; i < 20000; ++i) {
    std::array<Eigen::Vector2d, 4> corners;
    for (auto& corner : corners) corner = {x(random), y(random)};
    for (const auto& solution : estimate_tag_pose(corners, 0.06, scene::plain_camera()).solutions) {
      EXPECT_GT(solution.camera_from_tag.translation().z(), 0.0);
      EXPECT_TRUE(std::isfinite(solution.rms_px));
      EXPECT_NEAR(solution.camera_from_tag.linear().determinant(), 1.0, 1e-9);
    }
  }
}

TEST(TagPose, refuses_a_size_that_is_not_positive) {
  const auto corners = scene::true_corners(scene::plain_camera(), {1, 0.06, tag_before_camera(0.5, 0.3)});
  for (double size : {0.0, -0.06, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(estimate_tag_pose(corners, size, scene::plain_camera()), std::invalid_argument);
}

}  // namespace tag_pose_test
}  // namespace clearway
