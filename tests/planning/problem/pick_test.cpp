#include "planning/problem/pick.hpp"

#include <gtest/gtest.h>

#include <random>

namespace clearway {
namespace pick_test {

/// Points are as deep in a shape as its distance says; of a hull that is a bound.
TEST(PickCore, HoldsWhatLiesDeeperThanTheDepthAndNothingElse) {
  std::mt19937_64 random(4);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Pick pick;
  pick.object.name = "can";
  EXPECT_FALSE(core_of(pick));
  pick.grip["finger"] = {0.04, 0.0};
  int inside = 0, beyond = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double r = uniform(0.01, 0.05);
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 30; ++i)
      corners.push_back(Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * 0.05);
    const std::vector<std::pair<Shape, double>> shapes{{Shape::sphere(r), r},
                                                       {Shape::capsule(r, 0.05), r},
                                                       {Shape::cylinder(r, 0.2), r},
                                                       {Shape::box({2 * r, 0.15, 0.12}), r},
                                                       {Shape::convex(corners), 0.0}};
    for (const auto& [shape, half] : shapes) {
      pick.object.shape = shape;
      pick.depth = uniform(0.0, 0.03);
      const Shape core = *core_of(pick);
      const double depth = half > 0.0 ? std::min(pick.depth, half / 2) : 0.0;
      for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d point(uniform(-0.06, 0.06), uniform(-0.06, 0.06), uniform(-0.06, 0.06));
        const double in_core = core.signed_distance(point), in_shape = shape.signed_distance(point);
        EXPECT_TRUE(in_core >= -1e-9 || in_shape < -depth + 1e-9) << static_cast<int>(shape.kind());
        EXPECT_TRUE(half == 0.0 || in_shape >= -depth - 1e-9 || in_core < 1e-9)
            << static_cast<int>(shape.kind());
        inside += in_core < 0.0;
        beyond += in_shape < 0.0 && in_core > 0.0;
      }
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(beyond, 500);
  pick.depth = 0.0025;
  EXPECT_EQ(core_name(pick), "can-deeper-than-2.5mm");
}

}  // namespace pick_test
}  // namespace clearway
