#include "tracking/uncertain_pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

namespace clearway {
namespace uncertain_pose_test {

using Random = std::mt19937;

Vector6d normal6(Random& random) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int i = 0; i < 6; ++i) v[i] = normal(random);
  return v;
}

UncertainPose random_pose(Random& random, double sigma = 1e-3) {
  const Eigen::Quaterniond q = Eigen::Quaterniond(normal6(random).head<4>()).normalized();
  UncertainPose pose;
  pose.pose.linear() = q.toRotationMatrix();
  pose.pose.translation() = normal6(random).head<3>();
  Matrix6d root;
  for (int i = 0; i < 6; ++i) root.col(i) = sigma * normal6(random);
  pose.covariance = root * root.transpose();
  return pose;
}

// The covariance of f(a, b) by numeric derivatives of poses that Eigen multiplies: no adjoint, no MRPT.
template <typename Function>
Matrix6d by_numeric_derivative(const UncertainPose& a, const UncertainPose& b, const Function& f) {
  const Eigen::Isometry3d middle = f(a.pose, b.pose);
  Matrix6d by_a, by_b;
  for (int i = 0; i < 6; ++i) {
    const Vector6d h = 1e-6 * Vector6d::Unit(i);
    by_a.col(i) =
        (difference(middle, f(moved(a.pose, h), b.pose)) - difference(middle, f(moved(a.pose, -h), b.pose))) /
        2e-6;
    by_b.col(i) =
        (difference(middle, f(a.pose, moved(b.pose, h))) - difference(middle, f(a.pose, moved(b.pose, -h)))) /
        2e-6;
  }
  return by_a * a.covariance * by_a.transpose() + by_b * b.covariance * by_b.transpose();
}

double relative(const Matrix6d& a, const Matrix6d& b) { return (a - b).norm() / b.norm(); }

TEST(UncertainPose, composes_and_inverts_as_eigen_and_numeric_derivatives_do) {
  Random random(11);
  for (int i = 0; i < 500; ++i) {
    const UncertainPose a = random_pose(random), b = random_pose(random);
    const UncertainPose ab = compose(a, b), back = inverse(a);
    EXPECT_LT((ab.pose.matrix() - (a.pose * b.pose).matrix()).norm(), 1e-9);
    EXPECT_LT((back.pose.matrix() - a.pose.inverse().matrix()).norm(), 1e-9);
    const auto product = [](const auto& x, const auto& y) { return Eigen::Isometry3d(x * y); };
    const auto inverse_of_first = [](const auto& x, const auto&) { return Eigen::Isometry3d(x.inverse()); };
    EXPECT_LT(relative(ab.covariance, by_numeric_derivative(a, b, product)), 1e-6);
    EXPECT_LT(relative(back.covariance, by_numeric_derivative(a, b, inverse_of_first)), 1e-6);
  }
}

TEST(UncertainPose, equation_1_is_the_inverse_of_the_base_times_the_probe) {
  Random random(12);
  for (int i = 0; i < 200; ++i) {
    const UncertainPose base = random_pose(random), probe = random_pose(random);
    const UncertainPose eq1 = base_from_probe(base, probe);
    const auto equation = [](const auto& b, const auto& p) { return Eigen::Isometry3d(b.inverse() * p); };
    EXPECT_LT((eq1.pose.matrix() - equation(base.pose, probe.pose).matrix()).norm(), 1e-9);
    EXPECT_LT(relative(eq1.covariance, by_numeric_derivative(base, probe, equation)), 1e-6);
  }
}

TEST(UncertainPose, turning_the_camera_frame_changes_nothing_even_through_half_turns_and_gimbal_poses) {
  Random random(13);
  const UncertainPose base = random_pose(random), probe = random_pose(random);
  const UncertainPose expected = base_from_probe(base, probe);
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
    for (double angle : {0.0, M_PI / 2, M_PI, -M_PI / 2}) {
      const Eigen::Isometry3d turn(Eigen::AngleAxisd(angle, axis));
      const UncertainPose turned =
          base_from_probe({turn * base.pose, base.covariance}, {turn * probe.pose, probe.covariance});
      EXPECT_LT((turned.pose.matrix() - expected.pose.matrix()).norm(), 1e-9);
      EXPECT_LT(relative(turned.covariance, expected.covariance), 1e-9);
    }
}

TEST(UncertainPose, carried_covariance_matches_sampled_motions) {
  Random random(14);
  const UncertainPose base = random_pose(random, 2e-3), probe = random_pose(random, 2e-3);
  const Eigen::Vector3d ball(0.1, -0.05, 0.2);
  const UncertainPose eq1 = base_from_probe(base, probe);
  const UncertainPoint center = transform(eq1, ball);
  const Matrix6d base_root = Eigen::LLT<Eigen::MatrixXd>(base.covariance).matrixL();
  const Matrix6d probe_root = Eigen::LLT<Eigen::MatrixXd>(probe.covariance).matrixL();
  Matrix6d pose_sum = Matrix6d::Zero();
  Eigen::Matrix3d point_sum = Eigen::Matrix3d::Zero();
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const Eigen::Isometry3d camera_from_base = moved(base.pose, base_root * normal6(random));
    const Eigen::Isometry3d camera_from_probe = moved(probe.pose, probe_root * normal6(random));
    const Eigen::Isometry3d sampled = camera_from_base.inverse() * camera_from_probe;
    const Vector6d motion = difference(eq1.pose, sampled);
    const Eigen::Vector3d shift = sampled * ball - center.point;
    pose_sum += motion * motion.transpose() / n;
    point_sum += shift * shift.transpose() / n;
  }
  EXPECT_LT(relative(pose_sum, eq1.covariance), 0.05);
  EXPECT_LT((point_sum - center.covariance).norm() / center.covariance.norm(), 0.05);
}

TEST(UncertainPose, zero_changes_nothing_and_there_and_back_is_where_it_began) {
  Random random(15);
  for (int i = 0; i < 100; ++i) {
    const UncertainPose a = random_pose(random);
    EXPECT_LT(relative(compose(a, {}).covariance, a.covariance), 1e-6);
    EXPECT_LT(relative(inverse(inverse(a)).covariance, a.covariance), 1e-6);
    const Vector6d motion = 0.3 * normal6(random);
    EXPECT_LT((difference(a.pose, moved(a.pose, motion)) - motion).norm(), 1e-9);
    EXPECT_LT((moved(a.pose, Vector6d::Zero()).matrix() - a.pose.matrix()).norm(), 1e-15);
  }
}

TEST(UncertainPose, however_many_are_composed_stay_rotations) {
  Random random(16);
  UncertainPose chain = random_pose(random), back = chain;
  const UncertainPose step = random_pose(random);
  for (int i = 0; i < 5000; ++i) {
    chain = compose(chain, step);
    chain.pose.translation().setZero();
    back = inverse(back);
  }
  for (const UncertainPose& pose : {chain, back}) {
    const Eigen::Matrix3d rotation = pose.pose.linear();
    EXPECT_LT((rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm(), 3e-15);
  }
}

TEST(UncertainPoint, of_a_covariance_that_rounding_made_negative_has_no_sigma) {
  UncertainPoint point;
  point.covariance = Eigen::Vector3d(-1e-20, -2e-20, -3e-20).asDiagonal();
  EXPECT_EQ(point.largest_sigma(), 0.0);
}

TEST(UncertainPoint, largest_sigma_is_the_longest_half_axis) {
  UncertainPoint point;
  point.covariance = Eigen::Vector3d(1e-6, 9e-6, 4e-6).asDiagonal();
  EXPECT_NEAR(point.largest_sigma(), 3e-3, 1e-12);
  EXPECT_EQ(UncertainPoint{}.largest_sigma(), 0.0);
}

}  // namespace uncertain_pose_test
}  // namespace clearway
