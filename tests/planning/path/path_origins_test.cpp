#include "planning/path/path_origins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace clearway {
namespace path_origins_test {

using Eigen::Vector2d;

const std::vector<Configuration> corner = {Vector2d(0, 0), Vector2d(2, 0), Vector2d(4, 0), Vector2d(4, 2)};
const std::vector<WaypointOrigin> corner_origins = {
    {}, {PathPhase::free_motion, {}, 1}, {PathPhase::boundary, "tool", 2}, {PathPhase::goal_tree, {}, 3}};

TEST(PathOrigins, StayWithEdgesAndTheirPartsAndShortcutsHaveTheirOwn) {
  EXPECT_EQ(origins_after(corner, corner_origins, corner), corner_origins);
  // Half of the first edge, the rest of it, half of the second, a cut corner, the rest of the last one.
  const std::vector<Configuration> after = {Vector2d(0, 0), Vector2d(1, 0), Vector2d(2, 0),
                                            Vector2d(3, 0), Vector2d(4, 1), Vector2d(4, 2)};
  const WaypointOrigin shortened{PathPhase::shortened, {}, 0};
  EXPECT_EQ(origins_after(corner, corner_origins, after),
            (std::vector<WaypointOrigin>{
                {}, corner_origins[1], corner_origins[1], corner_origins[2], shortened, corner_origins[3]}));
  EXPECT_EQ(origins_after(corner, corner_origins, {corner.front(), corner.back()})[1], shortened);
}

TEST(PathOrigins, AreNoneWhereNoneAreKnown) {
  EXPECT_TRUE(origins_after(corner, {}, corner).empty());
  EXPECT_TRUE(origins_after(corner, corner_origins, {}).empty());
}

/// Points drawn along a random path, near it: each is reported on the edge that it was drawn on, or on a
/// neighbour that begins or ends within the noise.
TEST(PathOrigins, NameTheEdgeThatAMotionIsOn) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<Configuration> path{Configuration::Zero(6)};
    for (int i = 0; i < 12; ++i)
      path.push_back(path.back() + Configuration(Configuration::NullaryExpr(
                                       6, [&](Eigen::Index) { return uniform(random); })));
    std::vector<Configuration> along;
    std::vector<std::size_t> edge;
    for (std::size_t k = 1; k < path.size(); ++k)
      for (const double share : {0.05, 0.3, 0.5, 0.95}) {
        along.push_back(path[k - 1] + share * (path[k] - path[k - 1]));
        along.back()[0] += 1e-4 * uniform(random);
        edge.push_back(k);
      }
    EXPECT_EQ(waypoints_ahead(path, along), edge) << round;
  }
  EXPECT_EQ(waypoints_ahead({Vector2d(0, 0)}, {Vector2d(0, 0)}), std::vector<std::size_t>{0});
}

}  // namespace path_origins_test
}  // namespace clearway
