#include "planning/path/path_pieces.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace path_pieces_test {

std::vector<Configuration> random_path(Random& random, int waypoints) {
  std::vector<Configuration> path;
  for (int i = 0; i < waypoints; ++i) path.push_back(Eigen::Vector3d(random.point(2.0)));
  return path;
}

TEST(PathPieces, APlaceLiesAtItsLengthAlongThePath) {
  Random random(1);
  const Eigen::VectorXd weight = Eigen::Vector3d(1.0, 2.0, 0.5);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Configuration> path = random_path(random, 2 + round % 5);
    const std::vector<double> lengths = edge_lengths(path, weight);
    const double whole = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    const double along = random.between(0.0, whole);
    const PlaceOnPath place = place_at(lengths, along);
    ASSERT_LT(place.edge + 1, path.size());
    double walked = weight.cwiseProduct(point_at(path, place) - path[place.edge]).norm();
    for (std::size_t i = 0; i < place.edge; ++i) walked += weight.cwiseProduct(path[i + 1] - path[i]).norm();
    EXPECT_NEAR(walked, along, 1e-12 * (1.0 + whole));
    EXPECT_EQ(point_at(path, place_at(lengths, 0.0)), path.front());
    EXPECT_EQ(point_at(path, place_at(lengths, whole + 1.0)), path.back());
  }
}

TEST(PathPieces, CertifiesEdgeByEdgeUntilTheFirstThatIsBlocked) {
  const ConfigurationSpace space(
      load_robot("point"), VoxelScene{0.05, {box_of(1, -1, -0.05, 1.1, 1, 0.05)}, {}, {}}.snapshot(),
      Policies{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false});
  const Eigen::Vector2d a(0, 0), b(0.5, 0), c(2, 0), d(3, 0);
  std::uint64_t edges = 0;
  EXPECT_TRUE(is_certified(space, {a, b}, edges));
  EXPECT_EQ(edges, 1u);
  EXPECT_FALSE(is_certified(space, {a, b, c, d}, edges));
  EXPECT_EQ(edges, 3u);
}

}  // namespace path_pieces_test
}  // namespace clearway
