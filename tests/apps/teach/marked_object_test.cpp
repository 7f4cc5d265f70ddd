#include "apps/teach/marked_object.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "planning/picks/pick_scene.hpp"

namespace clearway {
namespace marked_object_test {

constexpr double resolution = 0.01;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1.0p-53;
  }

 private:
  std::mt19937_64 random_;
};

/// A ball led over a table and round something: its centre is off by as much as the bound allows.
std::vector<MarkingBall> stroke(Draw& draw, double table) {
  std::vector<MarkingBall> balls;
  const Eigen::Vector2d middle(draw(-1, 1), draw(-1, 1));
  const double bound = draw(0.0005, 0.008), radius = draw(0.015, 0.03);
  const int count = 2 + static_cast<int>(draw(0, 30));
  for (int i = 0; i < count; ++i) {
    const double height = i == 0 ? 0.0 : draw(0.0, 0.2);
    Eigen::Vector3d center(middle.x() + draw(-0.08, 0.08), middle.y() + draw(-0.08, 0.08),
                           table + radius + height);
    const Eigen::Vector3d off(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    center += bound * (i % 3 == 0 ? Eigen::Vector3d(0, 0, draw(-1, 1) > 0 ? 1 : -1)
                                  : off / std::max(1.0, off.norm()));
    balls.push_back({center, radius - bound, radius, bound});
  }
  balls.push_back({balls.front().center + Eigen::Vector3d(0, 0, 0.1), radius - bound, radius, bound});
  return balls;
}

Pick pick_of(const MarkedObject& object) {
  Pick pick;
  pick.object = object.load;
  pick.map_from_object = object.map_from_object;
  return pick;
}

/// Voxels by their index.
std::set<std::array<long, 3>> keys_of(const std::vector<Eigen::Vector3d>& centers) {
  std::set<std::array<long, 3>> keys;
  for (const Eigen::Vector3d& c : centers)
    keys.insert({std::lround(c.x() / resolution - 0.5), std::lround(c.y() / resolution - 0.5),
                 std::lround(c.z() / resolution - 0.5)});
  return keys;
}

TEST(MarkedObject, NoVoxelOfWhatItStandsOnLeavesTheMap) {
  Draw draw(5);
  for (int i = 0; i < 150; ++i) {
    const double table = draw(-0.3, 0.5);
    for (const Eigen::Vector3d& voxel :
         object_voxels(pick_of(marked_object(stroke(draw, table), resolution)), resolution))
      ASSERT_GE(voxel.z() - resolution / 2, table - 1e-9) << i;
  }
}

/// Brute force over the voxels of each ball: those wholly inside of it, in rows above the plane.
TEST(MarkedObject, EachVoxelInsideOfAPaintedBallIsItsAndLiesInTheBody) {
  Draw draw(6);
  std::size_t inside = 0;
  for (int i = 0; i < 40; ++i) {
    const std::vector<MarkingBall> balls = stroke(draw, draw(-0.3, 0.5));
    const MarkedObject object = marked_object(balls, resolution);
    const double plane = object.load.shape.bounds(object.map_from_object).min().z();
    const auto taken = keys_of(object_voxels(pick_of(object), resolution));
    for (const MarkingBall& ball : balls)
      for (double x = -0.04; x <= 0.04; x += resolution)
        for (double y = -0.04; y <= 0.04; y += resolution)
          for (double z = -0.04; z <= 0.04; z += resolution) {
            const Eigen::Vector3d low =
                ((ball.center + Eigen::Vector3d(x, y, z)) / resolution).array().floor();
            const Eigen::Vector3d center = (low.array() + 0.5) * resolution;
            const Eigen::Vector3d far =
                (center - ball.center).cwiseAbs() + Eigen::Vector3d::Constant(resolution / 2);
            if (far.norm() > ball.painted || center.z() - resolution / 2 < plane) continue;
            ++inside;
            EXPECT_TRUE(taken.contains(
                {static_cast<long>(low.x()), static_cast<long>(low.y()), static_cast<long>(low.z())}));
            for (int corner = 0; corner < 8; ++corner) {
              const Eigen::Vector3d at =
                  center + resolution / 2 *
                               Eigen::Vector3d(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
              EXPECT_LE(distance_to_cube(object.load.shape, object.map_from_object, at, 1e-9).upper, 1e-6);
            }
          }
  }
  EXPECT_GT(inside, 1000U);
}

TEST(MarkedObject, IsRefusedWithoutBallsOrHeight) {
  EXPECT_THROW(marked_object({}, resolution), std::invalid_argument);
  EXPECT_THROW(marked_object({{{0, 0, 0.02}, 0.005, 0.02, 0.015}}, 0.1), std::invalid_argument);
  EXPECT_NO_THROW(marked_object({{{0, 0, 0.02}, 0.018, 0.02, 0.002}}, resolution));
}

}  // namespace marked_object_test
}  // namespace clearway
