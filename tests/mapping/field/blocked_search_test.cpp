// nearest() and visit_blocked() against brute force over voxel cubes.

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "mapping/free_space_map.hpp"
#include "tests/worlds/blocked_truth.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace blocked_search_test {

using worlds::BlockedTruth;
using worlds::box_around;
using worlds::Dice;

const std::vector<Requirement> requirements = {
    {Policy::not_occupied}, {Policy::known_free}, {Policy::painted, 1}};

void expect_nearest(const BlockedSpace& space, const BlockedTruth& truth, const Eigen::Vector3d& point,
                    double limit) {
  const double exact = truth.distance(point);
  const NearestBlocked nearest = space.nearest(point, limit);
  if (std::abs(exact - limit) < 1e-12) return;  // either answer is right
  ASSERT_EQ(nearest.found, exact < limit) << point.transpose() << " limit " << limit;
  if (!nearest.found) return;
  ASSERT_NEAR(nearest.distance, exact, 1e-12);
  ASSERT_NEAR((nearest.point - point).norm(), nearest.distance, 1e-12);
  const double half = 0.5 * space.resolution();
  ASSERT_LE((nearest.point - nearest.voxel).cwiseAbs().maxCoeff(), half + 1e-12);
  ASSERT_TRUE(space.is_blocked(nearest.voxel));
  if (nearest.distance > 0.0) {
    ASSERT_NEAR((point + nearest.distance * nearest.direction - nearest.point).norm(), 0.0, 1e-12);
    ASSERT_NEAR(nearest.direction.norm(), 1.0, 1e-12);
  } else {
    ASSERT_EQ(nearest.direction.norm(), 0.0);
  }
  ASSERT_LE(space.clearance(point), nearest.distance);
}

TEST(BlockedSearch, FindsTheExactNearestCube) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.1, 3, 60).snapshot();
    for (const Requirement& requirement : requirements) {
      const auto space = map.blocked_space(requirement, box_around(0.9), 0.7);
      const BlockedTruth truth(map, requirement, space->region());
      Dice dice(seed);
      for (int i = 0; i < trials(1500, 4000); ++i) {
        expect_nearest(*space, truth, dice.point(i % 5 == 0 ? 1.6 : 0.9), dice.uniform(0.0, 0.7));
      }
    }
  }
}

TEST(BlockedSearch, FindsALoneVoxelFromEverywhere) {
  FreeSpaceMap map({.resolution = 0.05});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.32, 0.11, -0.21);
  scan.points = {{0.0F, 0.0F, 0.0F}};
  map.insert(scan);
  const Snapshot snapshot = map.snapshot();
  const auto space = snapshot.blocked_space({Policy::not_occupied}, box_around(1.0), 2.0);
  const BlockedTruth truth(snapshot, {Policy::not_occupied}, space->region());
  ASSERT_EQ(truth.blocked().size(), 1U);
  Dice dice(4);
  for (int i = 0; i < 5000; ++i) expect_nearest(*space, truth, dice.point(1.2), dice.uniform(0.0, 2.0));
}

TEST(BlockedSearch, NamesTheSameOfEquallyNearCubesHoweverFarItLooks) {
  std::size_t ties = 0;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.125, 3, 60).snapshot();  // no rounding: ties are exact
    const auto space = map.blocked_space({Policy::not_occupied}, box_around(1.0), 2.0);
    const BlockedTruth truth(map, {Policy::not_occupied}, space->region());
    Dice dice(seed);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d point =
          Eigen::Vector3d(dice.whole(-16, 16), dice.whole(-16, 16), dice.whole(-16, 16)) / 16.0;
      const double exact = truth.distance(point);
      if (exact > 0.7) continue;
      const auto is_nearest = [&](const Eigen::Vector3i& cell) {
        return truth.distance_to_cube(point, cell) == exact;
      };
      ties += std::count_if(truth.blocked().begin(), truth.blocked().end(), is_nearest) > 1 ? 1 : 0;
      const Eigen::Vector3d named = space->nearest(point, 2.0).voxel;
      for (const double beyond : {0.25, 0.3, 0.4, 0.5, 0.7, 1.0})
        ASSERT_EQ(space->nearest(point, exact + beyond).voxel, named) << point.transpose() << " " << beyond;
    }
  }
  EXPECT_GT(ties, 300U);
}

TEST(BlockedSearch, OfEquallyNearBordersTheFirstAxisIsNamedAndItsLowerSideFirst) {
  FreeSpaceMap map({.resolution = 0.5});  // no rounding: ties are exact
  map.paint(map.add_volume("all", {"base"}), {Eigen::Vector3d::Zero(), 8.0});
  const auto space = map.snapshot().blocked_space({Policy::painted, 1}, box_around(2.0), 8.0);
  ASSERT_EQ(space->blocked_count(), 0U);
  const Eigen::AlignedBox3d& region = space->region();
  const double half = region.sizes().x() / 2;
  ASSERT_EQ(region.sizes(), Eigen::Vector3d::Constant(2.0 * half));
  const auto named = [&](double x, double y, double z) -> Eigen::Vector3d {  // from its middle
    return space->nearest(region.center() + Eigen::Vector3d(x, y, z), 8.0).point - region.center();
  };
  EXPECT_EQ(named(0.0, 0.0, 0.0), Eigen::Vector3d(-half, 0.0, 0.0));
  EXPECT_EQ(named(1.0, 1.0, 0.0), Eigen::Vector3d(half, 1.0, 0.0));
  EXPECT_EQ(named(1.0, -1.0, 1.0), Eigen::Vector3d(half, -1.0, 1.0));
  EXPECT_EQ(named(0.0, 1.0, -1.0), Eigen::Vector3d(0.0, half, -1.0));
  EXPECT_EQ(named(0.0, 1.0, 1.25), Eigen::Vector3d(0.0, 1.0, half));
}

TEST(BlockedSearch, ACubeExactlyAtTheLimitIsFound) {
  FreeSpaceMap map({.resolution = 0.5});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(1.25, 0.25, 0.25);
  scan.points = {{0.0F, 0.0F, 0.0F}};
  map.insert(scan);
  const auto space = map.snapshot().blocked_space({}, box_around(4.0), 4.0);
  EXPECT_TRUE(space->nearest({1.25, 0.25, 0.25}, 0.0).found);  // inside
  EXPECT_TRUE(space->nearest({-1.0, 0.25, 0.25}, 2.0).found);
  EXPECT_FALSE(space->nearest({-1.0, 0.25, 0.25}, 1.999).found);
}

TEST(BlockedSearch, RefusesAPointThatIsNotFinite) {
  const auto space = Snapshot().blocked_space({}, box_around(2.0), 1.0);
  EXPECT_THROW(space->nearest({std::nan(""), 0.0, 0.0}, 1.0), std::invalid_argument);
  EXPECT_THROW(space->nearest(Eigen::Vector3d::Zero(), std::nan("")), std::invalid_argument);
  EXPECT_FALSE(space->nearest(Eigen::Vector3d::Zero(), 1.0).found);
}

// Cells are read where they are looked at: also those beside a box, on the other side of a tile's border.
TEST(BlockedSearch, NoVoxelInsideASolidIsOfItsSurfaceWhereverTheFirstLookIs) {
  Dice dice(6);
  for (int i = 0; i < 200; ++i) {
    const Snapshot unknown = FreeSpaceMap({.resolution = 0.1}).snapshot();
    const auto space = unknown.blocked_space({Policy::known_free}, box_around(5.0), 0.5);
    const Eigen::Vector3d low = dice.point(4.0);
    const Eigen::AlignedBox3d box(low, (low.array() + dice.uniform(0.0, 0.5)).matrix());
    ASSERT_TRUE(space->visit_surface(box, [](const Eigen::Vector3d&) { return false; })) << low.transpose();
  }
}

using Cells = std::set<std::tuple<int, int, int>>;

TEST(BlockedSearch, VisitsEachBlockedCubeThatMeetsABoxOnce) {
  const double resolution = 0.1;
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot map = worlds::random_map(seed, resolution, 3, 80).snapshot();
    for (const Requirement& requirement : requirements) {
      const auto space = map.blocked_space(requirement, box_around(0.7), 0.5);
      const bool outside_blocked = requirement.policy != Policy::not_occupied;
      Dice dice(seed);
      for (int i = 0; i < 25; ++i) {
        Eigen::AlignedBox3d box(dice.point(1.0));
        box.extend(dice.point(1.0));
        if (i % 5 == 0) {  // within the layer of cells about the region
          const int axis = dice.whole(0, 2);
          const double middle = dice.whole(0, 1) == 0 ? -0.75 : 0.75;
          box.min()[axis] = middle - 0.04;
          box.max()[axis] = middle + 0.04;
        }
        Cells expected, found;
        for (int x = -12; x < 12; ++x) {
          for (int y = -12; y < 12; ++y) {
            for (int z = -12; z < 12; ++z) {
              const Eigen::Vector3d center = (Eigen::Vector3d(x, y, z).array() + 0.5) * resolution;
              const Eigen::AlignedBox3d cube(center.array() - 0.05, center.array() + 0.05);
              const bool inside = space->region().contains(center);
              const Voxel voxel = map.voxel(center);
              const bool blocked =
                  inside ? !allows(requirement, voxel.state, voxel.volumes) : outside_blocked;
              if (blocked && cube.intersects(box)) expected.insert({x, y, z});
            }
          }
        }
        const bool finished = space->visit_blocked(box, [&](const Eigen::Vector3d& center) {
          const Eigen::Vector3i cell = (center / resolution).array().floor().cast<int>();
          EXPECT_TRUE(found.insert({cell.x(), cell.y(), cell.z()}).second);
          return true;
        });
        EXPECT_TRUE(finished);
        ASSERT_EQ(found, expected);
        // Of these the surface: a neighbour over a face is not blocked.
        std::erase_if(expected, [&](const auto& cell) {
          const auto& [cx, cy, cz] = cell;
          const Eigen::Vector3d center = (Eigen::Vector3d(cx, cy, cz).array() + 0.5) * resolution;
          for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = resolution * Eigen::Vector3d::Unit(axis);
            if (!space->is_blocked(center + step) || !space->is_blocked(center - step)) return false;
          }
          return true;
        });
        Cells surface;
        EXPECT_TRUE(space->visit_surface(box, [&](const Eigen::Vector3d& center) {
          const Eigen::Vector3i cell = (center / resolution).array().floor().cast<int>();
          EXPECT_TRUE(surface.insert({cell.x(), cell.y(), cell.z()}).second);
          return true;
        }));
        ASSERT_EQ(surface, expected);
      }
    }
  }
}

TEST(BlockedSearch, ATouchingCubeMeetsABox) {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.35, 0.05, 0.05);
  scan.points = {{0.0F, 0.0F, 0.0F}};
  map.insert(scan);
  const auto space = map.snapshot().blocked_space({}, box_around(1.0), 1.0);
  const auto touched = [&](const Eigen::AlignedBox3d& box) {
    return !space->visit_blocked(box, [](const Eigen::Vector3d&) { return false; });
  };
  EXPECT_TRUE(touched({Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.3, 0.05, 0.05)}));
  EXPECT_FALSE(touched({Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.299, 0.05, 0.05)}));
  EXPECT_TRUE(touched({Eigen::Vector3d(0.4, 0.1, 0.1), Eigen::Vector3d(0.5, 0.2, 0.2)}));
  EXPECT_FALSE(touched({Eigen::Vector3d(0.401, 0.1, 0.1), Eigen::Vector3d(0.5, 0.2, 0.2)}));
  EXPECT_FALSE(touched(Eigen::AlignedBox3d()));
}

}  // namespace blocked_search_test
}  // namespace clearway
