#include "planning/geometry/turn_between.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace turn_between_test {

TEST(TurnBetween, IsARotationThatTakesOneToTheOther) {
  Random random(29);
  for (int i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d from = random.point(1.0).normalized();
    Eigen::Vector3d to = random.point(1.0).normalized();
    if (i % 2 == 0)  // almost the same, or almost opposite
      to = ((i % 4 == 0 ? 1 : -1) * from + std::pow(10.0, random.between(-17, 0)) * to).normalized();
    const Eigen::Matrix3d turn = turn_between(from, to).toRotationMatrix();
    EXPECT_LT((turn * from - to).norm(), 1e-14);
    EXPECT_LT((turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_NEAR(turn.determinant(), 1.0, 1e-14);
  }
}

}  // namespace turn_between_test
}  // namespace clearway
