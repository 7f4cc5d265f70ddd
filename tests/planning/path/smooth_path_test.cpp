#include "planning/path/smooth_path.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace smooth_path_test {

TEST(SmoothPath, IsContinuousWithItsSlopeAndStaysAsNearToTheEdgesAsItSays) {
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Index n = 2 + random.below(6);
    std::vector<Configuration> path;
    for (int i = 0; i < 6; ++i) {
      Configuration q(n);
      for (double& value : q) value = random.between(-2, 2);
      path.push_back(q);
    }
    std::vector<double> reach(path.size(), 0.0);
    for (std::size_t i = 1; i + 1 < path.size(); ++i)
      reach[i] = (trial % 2 == 0 ? 0.5 : 0.2) *
                 std::min((path[i] - path[i - 1]).norm(), (path[i + 1] - path[i]).norm());
    const SmoothPath smooth = blended_path(path, reach);
    Configuration last = path.front();
    Eigen::VectorXd slope = (path[1] - path[0]).normalized();
    for (const PathPiece& piece : smooth.pieces) {
      EXPECT_LT((piece.begin - last).norm(), 1e-8);
      EXPECT_LT((piece.direction - slope).norm(), 1e-8);
      last = piece.at(piece.length);
      slope = piece.slope(piece.length);
      if (piece.is_straight()) continue;
      const std::size_t i = piece.corner;
      const Eigen::VectorXd turn =
          (path[i + 1] - path[i]).normalized() - (path[i] - path[i - 1]).normalized();
      for (int k = 0; k <= 20; ++k) {
        const Configuration q = piece.at(piece.length * k / 20);
        double off = 1e9;  // from the nearest of many points of both edges
        for (int m = 0; m <= 2000; ++m) {
          const double s = reach[i] * (m / 1000.0 - 1.0);
          const Configuration there = s < 0 ? path[i] + s * (path[i] - path[i - 1]).normalized()
                                            : path[i] + s * (path[i + 1] - path[i]).normalized();
          off = std::min(off, (q - there).norm());
        }
        EXPECT_LE(off, reach[i] / 4 * turn.norm() + 1e-3);
      }
    }
    EXPECT_LT((last - path.back()).norm(), 1e-8);
  }
}

}  // namespace smooth_path_test
}  // namespace clearway
