#include "tracking/static_board.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace static_board_test {

Vector6d normal6(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d v;
  for (int i = 0; i < 6; ++i) v[i] = normal(random);
  return v;
}

struct NoisyBoard {
  std::mt19937 random{51};
  Eigen::Isometry3d truth = scene::tag_before_camera(0.7, 0.6, 1.0);
  Matrix6d covariance, root;

  NoisyBoard() {
    Matrix6d mixed = Matrix6d::Identity();
    for (int i = 0; i < 6; ++i) mixed.col(i) += 0.4 * normal6(random);
    covariance = 1e-6 * mixed * mixed.transpose();
    root = Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL();
  }
  UncertainPose seen() { return {moved(truth, root * normal6(random)), covariance}; }
};

TEST(StaticBoard, its_mean_closes_in_on_the_truth_as_its_covariance_says) {
  double nees = 0, single = 0, mean = 0;
  NoisyBoard board;
  const int runs = 300;
  for (int run = 0; run < runs; ++run) {
    StaticBoard filter;
    std::optional<UncertainPose> fused;
    for (int i = 0; i < 60; ++i) fused = filter.add(board.seen());
    ASSERT_TRUE(fused);
    const Vector6d error = difference(fused->pose, board.truth);
    nees += Cholesky(fused->covariance).squared(error) / runs;
    mean += error.squaredNorm() / runs;
    single += difference(board.seen().pose, board.truth).squaredNorm() / runs;
  }
  EXPECT_LT(mean, single / 20);
  EXPECT_LT(nees, 6.6);  // forgetting makes the stated covariance a little larger than the true one
  EXPECT_GT(nees, 2.5);
}

TEST(StaticBoard, the_first_image_is_the_mean_and_the_second_halves_the_variance) {
  NoisyBoard board;
  StaticBoardOptions options;
  options.memory = 10000;
  StaticBoard filter(options);
  const UncertainPose first = board.seen();
  EXPECT_EQ(filter.add(first)->pose.matrix(), first.pose.matrix());
  const auto second = filter.add(board.seen());
  ASSERT_TRUE(second);
  EXPECT_LT((2.0 * second->covariance - first.covariance).norm(), 1e-3 * first.covariance.norm());
}

TEST(StaticBoard, ignores_outliers_and_starts_again_when_the_board_stays_elsewhere) {
  NoisyBoard board;
  StaticBoard filter;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(filter.add(board.seen()));
  NoisyBoard elsewhere = board;
  elsewhere.truth.translation().x() += 0.05;
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(filter.add(elsewhere.seen()));
  EXPECT_TRUE(filter.add(board.seen()));  // back in time: nothing happened
  EXPECT_EQ(filter.moves().count, 0);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(filter.add(elsewhere.seen()));
  const auto fused = filter.add(elsewhere.seen());
  ASSERT_TRUE(fused);
  EXPECT_EQ(filter.moves().count, 1);
  EXPECT_NEAR(filter.moves().farthest, 0.05, 0.01);
  EXPECT_LT(difference(fused->pose, elsewhere.truth).norm(), 0.01);
}

TEST(StaticBoard, refuses_options_out_of_their_range) {
  const auto refuses = [](StaticBoardOptions options) {
    EXPECT_THROW(StaticBoard{options}, std::invalid_argument);
  };
  refuses({0, 5.0, 5});
  refuses({10001, 5.0, 5});
  refuses({30, 0.0, 5});
  refuses({30, NAN, 5});
  refuses({30, 5.0, 0});
}

/// Of equal looks the mean of M images is no surer than M + 1 of them make it: the fixed point of its filter,
/// P = R / (M + 1), by hand.
TEST(StaticBoard, a_mean_of_many_looks_is_as_sure_as_its_memory_has_it) {
  for (const int memory : {1, 5, 50}) {
    StaticBoardOptions options;
    options.memory = memory;
    StaticBoard board(options);
    UncertainPose seen;
    seen.covariance = 1e-6 * Matrix6d::Identity();
    std::optional<UncertainPose> mean;
    for (int i = 0; i < 20 * (memory + 1); ++i) mean = board.add(seen);
    ASSERT_TRUE(mean);
    const Matrix6d expected = seen.covariance / (memory + 1);
    EXPECT_LT((mean->covariance - expected).cwiseAbs().maxCoeff(), 1e-3 * expected(0, 0)) << memory;
  }
}

}  // namespace static_board_test
}  // namespace clearway
