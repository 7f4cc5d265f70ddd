#include "tracking/pose_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_refinement.hpp"

namespace clearway {
namespace pose_errors_test {

using scene::tag_before_camera;
using Corners = std::array<Eigen::Vector2d, 4>;

constexpr double kEdge = 0.1, kNoise = 0.3;
const TagErrors kErrors{0.002, 0.003, 0.0005, 0.005};

Corners corners_of(const Camera& camera, double size, const Eigen::Isometry3d& camera_from_tag) {
  return scene::true_corners(camera, {0, size, camera_from_tag});
}

Eigen::Matrix<double, 8, 1> stacked(const Corners& a, const Corners& b) {
  Eigen::Matrix<double, 8, 1> difference;
  for (int i = 0; i < 4; ++i) difference.segment<2>(2 * i) = a[i] - b[i];
  return difference;
}

struct Tag {
  double size = 0.06;
  Eigen::Isometry3d body_from_tag = Eigen::Isometry3d::Identity();
};

std::vector<Tag> board() {
  std::vector<Tag> tags(3);
  for (int i = 0; i < 3; ++i) {
    tags[i].body_from_tag = Eigen::Translation3d(0.1 * i - 0.1, 0.02 * i, 0.01 * i) *
                            Eigen::AngleAxisd(0.3 * i, Eigen::Vector3d(1, 2, 0.5).normalized());
  }
  return tags;
}

const Eigen::Isometry3d kPose = tag_before_camera(0.6, 0.6, 0.4, 0.2, 0.05, -0.03);

std::vector<TagView> views(const Camera& camera, const std::vector<Corners>& seen,
                           const Eigen::Isometry3d& pose = kPose) {
  std::vector<TagView> all;
  const std::vector<Tag> tags = board();
  for (std::size_t i = 0; i < tags.size(); ++i)
    all.push_back(*view_tag(camera, tags[i].size, tags[i].body_from_tag, kErrors, kEdge, seen[i], pose));
  return all;
}

std::vector<Corners> exact(const Camera& camera) {
  std::vector<Corners> all;
  for (const Tag& tag : board()) all.push_back(corners_of(camera, tag.size, kPose * tag.body_from_tag));
  return all;
}

TEST(TagView, columns_are_what_an_error_of_one_deviation_does_to_the_picture) {
  const Camera camera = scene::distorted_camera();
  const Tag tag = board()[1];
  const Corners seen = exact(camera)[1];
  const TagView view = views(camera, exact(camera))[1];
  EXPECT_LT(view.residual.norm(), 1e-9);
  const auto expect_moved = [&](const Eigen::Matrix<double, 8, 1>& column, double size,
                                const Eigen::Isometry3d& camera_from_tag, const char* what) {
    const auto moved = stacked(corners_of(camera, size, camera_from_tag), seen);
    EXPECT_LT((moved - column).norm(), 0.02 * column.norm() + 1e-6) << what;
  };
  const Eigen::Isometry3d camera_from_tag = kPose * tag.body_from_tag;
  expect_moved(view.by_own.col(0), tag.size * (1 + kErrors.size), camera_from_tag, "size");
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
    Eigen::Isometry3d placed = tag.body_from_tag;
    placed.translation() += kErrors.place * axis;
    expect_moved(view.by_own.col(1 + k), tag.size, kPose * placed, "place");
    const Eigen::Isometry3d turned = camera_from_tag * Eigen::AngleAxisd(kErrors.turn, axis);
    expect_moved(view.by_own.col(4 + k), tag.size, turned, "turn");
    Vector6d motion = Vector6d::Zero();
    motion[k] = 1e-5;
    expect_moved(1e-5 * view.by_motion.col(k), tag.size, moved(kPose, motion) * tag.body_from_tag, "motion");
    motion.setZero();
    motion[3 + k] = 1e-5;
    expect_moved(1e-5 * view.by_motion.col(3 + k), tag.size, moved(kPose, motion) * tag.body_from_tag,
                 "turned");
  }
  Eigen::Isometry3d larger = tag.body_from_tag;
  larger.translation() *= 1 + kErrors.scale;
  expect_moved(view.by_shared.col(kCameraModes), tag.size * (1 + kErrors.scale), kPose * larger, "scale");
}

TEST(TagView, an_edges_bias_moves_its_line_and_leaves_the_other_lines_where_they_are) {
  const Camera camera = scene::plain_camera();
  const Corners seen = exact(camera)[0];
  const TagView view = views(camera, exact(camera))[0];
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : seen) middle += 0.25 * corner;
  for (int edge = 0; edge < 4; ++edge) {
    for (int line = 0; line < 4; ++line) {
      const Eigen::Vector2d along = (seen[(line + 1) % 4] - seen[line]).normalized();
      Eigen::Vector2d outwards(along.y(), -along.x());
      if (outwards.dot(seen[line] - middle) < 0) outwards = -outwards;
      for (int corner : {line, (line + 1) % 4}) {
        const Eigen::Vector2d shift = view.by_own.block<2, 1>(2 * corner, 7 + edge);
        EXPECT_NEAR(shift.dot(outwards), line == edge ? kEdge : 0.0, 1e-9) << edge << " " << line;
      }
    }
  }
}

TEST(Unexplained, is_the_quadratic_form_of_the_whole_covariance) {
  const Camera camera = scene::distorted_camera();
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<Corners> seen = exact(camera);
  for (Corners& corners : seen)
    for (Eigen::Vector2d& corner : corners) corner += Eigen::Vector2d(normal(random), normal(random));
  const std::vector<TagView> tags = views(camera, seen);
  Eigen::MatrixXd covariance = kNoise * kNoise * Eigen::MatrixXd::Identity(24, 24);
  Eigen::MatrixXd shared(24, kCameraModes + 1);
  Eigen::VectorXd residual(24);
  for (int i = 0; i < 3; ++i) {
    shared.middleRows<8>(8 * i) = tags[i].by_shared;
    residual.segment<8>(8 * i) = tags[i].residual;
    covariance.block<8, 8>(8 * i, 8 * i) += tags[i].by_own * tags[i].by_own.transpose();
  }
  covariance += shared * shared.transpose();
  const double whole = residual.dot(solve_symmetric(covariance, residual).col(0));
  EXPECT_NEAR(unexplained(tags, kNoise), whole, 1e-8 * whole);
}

TEST(CarriedErrors, are_what_a_new_fit_to_a_disturbed_picture_gives) {
  const Camera camera = scene::distorted_camera();
  const std::vector<Corners> seen = exact(camera);
  const std::vector<TagView> tags = views(camera, seen);
  const auto errors = carry_errors(tags, kNoise);
  ASSERT_TRUE(errors);
  // The fit to a picture that the error of `shift` per deviation has moved, seen from the undisturbed one.
  const auto refitted = [&](const auto& shift) -> Vector6d {
    std::vector<CornerMatch> corners;
    const std::vector<Tag> board_tags = board();
    for (std::size_t t = 0; t < seen.size(); ++t) {
      const double h = 0.5 * board_tags[t].size;
      const Eigen::Vector3d points[4] = {{-h, h, 0}, {h, h, 0}, {h, -h, 0}, {-h, -h, 0}};
      for (int i = 0; i < 4; ++i)
        corners.push_back({board_tags[t].body_from_tag * points[i],
                           seen[t][i] + shift(tags[t]).template segment<2>(2 * i)});
    }
    return difference(refine_pose(camera, corners, kPose)->camera_from_body, kPose);
  };
  for (int k = 0; k < kCameraModes; ++k) {
    const Vector6d motion =
        refitted([&](const TagView& tag) -> Eigen::Matrix<double, 8, 1> { return tag.by_shared.col(k); });
    EXPECT_LT((motion - errors->by_camera.col(k)).norm(), 0.03 * motion.norm() + 1e-6) << k;
  }
  Matrix6d edges = Matrix6d::Zero(), places = Matrix6d::Zero();
  for (int t = 0; t < 3; ++t)
    for (int k = 0; k < 11; ++k) {
      const Vector6d motion = refitted([&](const TagView& tag) -> Eigen::Matrix<double, 8, 1> {
        return &tag == &tags[t] ? Eigen::Matrix<double, 8, 1>(tag.by_own.col(k))
                                : Eigen::Matrix<double, 8, 1>(Eigen::Matrix<double, 8, 1>::Zero());
      });
      (k < 7 ? places : edges) += motion * motion.transpose();
    }
  const Vector6d scale = refitted(
      [&](const TagView& tag) -> Eigen::Matrix<double, 8, 1> { return tag.by_shared.col(kCameraModes); });
  places += scale * scale.transpose();
  EXPECT_LT((edges - errors->edges).norm(), 0.05 * edges.norm());
  EXPECT_LT((places - errors->tags).norm(), 0.05 * places.norm());
}

TEST(CameraShift, is_what_another_camera_shows) {
  Camera camera = scene::plain_camera();
  camera.errors = {0.001, 0.0005, 1.5, 0.4};
  const Eigen::Vector3d point(0.14, -0.1, 0.5);
  const Eigen::Vector2d here = scene::pixel_by_opencv(camera, point);
  const auto shift = camera.shift_by_errors(here);
  const auto expect = [&](int mode, const Camera& other) {
    EXPECT_LT((scene::pixel_by_opencv(other, point) - here - shift.col(mode)).norm(),
              0.01 * shift.col(mode).norm())
        << mode;
  };
  Camera other = camera;
  other.fx *= 1.001;
  other.fy *= 1.001;
  expect(0, other);
  other = camera;
  other.fx *= 1.00025;
  other.fy *= 0.99975;
  expect(1, other);
  other = camera;
  other.cx += 1.5;
  expect(2, other);
  // A lens with k1 alone that shifts the farthest corner by 0.4 px; fx and fy differ by 0.8 %.
  other = camera;
  const double reach = std::hypot(camera.cx, camera.height - 1 - camera.cy) > std::hypot(camera.cx, camera.cy)
                           ? std::hypot(std::max(camera.cx, camera.width - 1 - camera.cx),
                                        std::max(camera.cy, camera.height - 1 - camera.cy))
                           : std::hypot(std::max(camera.cx, camera.width - 1 - camera.cx), camera.cy);
  other.distortion[0] = 0.4 / reach * std::pow(camera.fx / reach, 2.0);
  EXPECT_LT((scene::pixel_by_opencv(other, point) - here - shift.col(4)).norm(), 0.03 * shift.col(4).norm());
  camera.errors.distortion.reset();
  EXPECT_GT(camera.shift_by_errors(here).col(4).norm(),
            3.0 * scene::distorted_camera().shift_by_errors(here).col(4).norm());
}

TEST(ChiSquareLimit, is_exceeded_once_in_ten_thousand_times) {
  // Tables of chi-square: quantiles of 0.9999.
  EXPECT_NEAR(chi_square_limit(2), 18.42, 0.06 * 18.42);
  EXPECT_NEAR(chi_square_limit(10), 35.56, 0.015 * 35.56);
  EXPECT_NEAR(chi_square_limit(18), 48.85, 0.015 * 48.85);
  EXPECT_NEAR(chi_square_limit(100), 161.3, 0.01 * 161.3);
}

TEST(ConfidenceFactor, keeps_all_but_one_in_a_thousand_points_with_noise_that_is_estimated) {
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int freedom : {10, 18, 60}) {
    const double factor = confidence_factor(freedom);
    int beyond = 0;
    const int trials = 60000;
    for (int i = 0; i < trials; ++i) {
      double squares = 0.0, point = 0.0;
      for (int k = 0; k < freedom; ++k) squares += std::pow(normal(random), 2.0);
      for (int k = 0; k < 3; ++k) point += std::pow(normal(random), 2.0);
      beyond += point > factor * factor * squares / freedom;
    }
    EXPECT_NEAR(beyond, 0.001 * trials, 5.0 * std::sqrt(0.001 * trials)) << freedom;
  }
  EXPECT_NEAR(confidence_factor(1000000), std::sqrt(16.266), 1e-3);  // chi-square of 3, 0.999
  EXPECT_EQ(confidence_factor(3), confidence_factor(10));
}

TEST(TagErrors, that_are_negative_or_not_finite_are_refused) {
  EXPECT_NO_THROW(kErrors.validate("x"));
  EXPECT_THROW((TagErrors{-1e-9, 0, 0, 0}.validate("x")), std::invalid_argument);
  EXPECT_THROW((TagErrors{0, NAN, 0, 0}.validate("x")), std::invalid_argument);
  EXPECT_THROW((CameraErrors{0.0, 0.0, INFINITY, {}}.validate()), std::invalid_argument);
}

}  // namespace pose_errors_test
}  // namespace clearway
