// Clearance of many points at once, and from one cell alone.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <stdexcept>

#include "mapping/field/blocked_field.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/worlds/blocked_truth.hpp"
#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace field_look_up_test {

using worlds::BlockedTruth;
using worlds::box_around;
using worlds::Dice;

const std::vector<Requirement> requirements = {
    {Policy::not_occupied}, {Policy::known_free}, {Policy::painted, 1}};

struct Points {
  std::vector<double> x, y, z;
  void add(const Eigen::Vector3d& point) {
    x.push_back(point.x());
    y.push_back(point.y());
    z.push_back(point.z());
  }
  Eigen::Vector3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
  PointArrays arrays() const { return {x, y, z}; }
};

/// In the region and beyond it, on faces of cells, and what is no point at all.
Points mixed_points(Dice& dice, int count, double resolution) {
  Points points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d point = dice.point(i % 7 == 0 ? 1.6 : 1.0);
    if (i % 5 == 0) point = (point.array() / resolution).round() * resolution;
    if (i % 11 == 0) point = ((point.array() / resolution).floor() + 0.5) * resolution;
    if (i % 97 == 0) point[dice.whole(0, 2)] = i % 2 == 0 ? std::nan("") : -HUGE_VAL;
    points.add(point);
  }
  return points;
}

void expect_bits_of_one_by_one(const BlockedField& field, const Points& points) {
  const std::size_t count = points.x.size();
  for (const InstructionSet vectors : worlds::instruction_sets()) {
    std::vector<double> tight(count), coarse(count);
    field.clearances(points.arrays(), tight, vectors);
    field.coarse_clearances(points.arrays(), coarse, vectors);
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d point = points.at(i);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(tight[i]), std::bit_cast<std::uint64_t>(field.clearance(point)))
          << point.transpose() << " with vectors " << static_cast<int>(vectors);
      ASSERT_EQ(std::bit_cast<std::uint64_t>(coarse[i]),
                std::bit_cast<std::uint64_t>(field.coarse_clearance(point)))
          << point.transpose() << " with vectors " << static_cast<int>(vectors);
    }
  }
}

/// Half voxels, squared, from the middle of a voxel to the nearest of some cubes; `most` where it is farther.
int squared_to_nearest(const std::vector<Eigen::Vector3i>& cubes, const Eigen::Vector3i& voxel, int most) {
  for (const Eigen::Vector3i& cube : cubes) {
    int sum = 0;
    for (const int away : (cube - voxel).cwiseAbs()) sum += away == 0 ? 0 : (2 * away - 1) * (2 * away - 1);
    most = std::min(most, sum);
  }
  return most;
}

TEST(FieldLookUp, SquaredDistancesOfAVoxelAndItsNeighboursAreThoseToAllBlockedCubes) {
  constexpr double edge = 0.05;
  const Snapshot map = worlds::random_map(5, edge, 2, 20).snapshot();
  Dice dice(8);
  for (const Requirement& requirement : requirements) {
    const BlockedField field(map.tree(), requirement, field_region(box_around(0.8), edge, 0.3));
    const bool is_closed = !allows(requirement, VoxelState::unknown, 0);
    const int last = field.cells().first.x() + field.cells().size.x() - 1, first = field.cells().first.x();
    std::vector<Eigen::Vector3i> cubes;  // with a shell about the region where what is beyond it is blocked
    for (int x = first - 1; x <= last + 1; ++x) {
      for (int y = first - 1; y <= last + 1; ++y) {
        for (int z = first - 1; z <= last + 1; ++z) {
          const Eigen::Vector3i cell(x, y, z);
          const bool is_blocked = field.is_blocked((cell.cast<double>().array() + 0.5) * edge);
          EXPECT_EQ(field.is_voxel_blocked(cell), is_blocked);
          if (is_blocked) cubes.push_back(cell);
        }
      }
    }
    const int beyond = static_cast<int>(std::ceil(4.0 * 0.3 * 0.3 / (edge * edge) * (1.0 - 1e-9)));
    int compared = 0;
    for (int trial = 0; trial < 500; ++trial) {
      const Eigen::Vector3i voxel = (dice.point(0.85) / edge).array().floor().matrix().cast<int>();
      const std::array<int, 7> found = field.squared_around(voxel);
      for (std::size_t i = 0; i < found.size(); ++i) {
        Eigen::Vector3i cell = voxel;
        if (i > 0) cell[static_cast<Eigen::Index>(i - 1) / 2] += i % 2 == 1 ? -1 : 1;
        if ((cell.array() < first).any() || (cell.array() > last).any()) {
          EXPECT_EQ(found[i], is_closed ? 0 : -1);
          continue;
        }
        ++compared;
        EXPECT_EQ(std::min(found[i], beyond), squared_to_nearest(cubes, cell, beyond)) << cell.transpose();
      }
    }
    EXPECT_GT(compared, 2500);
  }
}

TEST(FieldLookUp, ManyPointsGetTheBitsThatEachGetsAlone) {
  const Snapshot map = worlds::random_map(5, 0.05, 2, 20).snapshot();
  Dice dice(6);
  for (const Requirement& requirement : requirements) {
    const BlockedField field(map.tree(), requirement, field_region(box_around(1.1), 0.05, 0.6));
    expect_bits_of_one_by_one(field, mixed_points(dice, 40000, 0.05));
    for (const int count : {0, 1, 3, 4, 7, 8, 9, 255, 256, 257, 263}) {
      expect_bits_of_one_by_one(field, mixed_points(dice, count, 0.05));
    }
  }
}

TEST(FieldLookUp, ARegionOneCellThinIsLookedUpAsWell) {
  const Snapshot map = worlds::random_map(5, 0.05, 2, 20).snapshot();
  Dice dice(7);
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::AlignedBox3d region = box_around(1.0);
    region.min()[axis] = 0.4;
    region.max()[axis] = 0.45;
    const BlockedField field(map.tree(), {}, field_region(region, 0.05, 0.5));
    Points points = mixed_points(dice, 2000, 0.05);
    for (std::size_t i = 0; i < points.x.size(); i += 2) {
      (axis == 0 ? points.x : axis == 1 ? points.y : points.z)[i] = dice.uniform(0.4, 0.45);
    }
    expect_bits_of_one_by_one(field, points);
  }
}

TEST(FieldLookUp, TheBoundFromOneCellLiesBelowTheOtherAndWithinADiagonalOfTheDistance) {
  const Snapshot map = worlds::random_map(5, 0.08, 3, 60).snapshot();
  for (const Requirement& requirement : requirements) {
    const auto space = map.blocked_space(requirement, box_around(0.8), 0.6);
    const BlockedTruth truth(map, requirement, space->region());
    Dice dice(8);
    for (int i = 0; i < 3000; ++i) {
      const Eigen::Vector3d point = dice.point(i % 10 == 0 ? 1.5 : 0.79);
      const double coarse = space->coarse_clearance(point);
      ASSERT_LE(coarse, space->clearance(point)) << point.transpose();
      if (!space->region().contains(point)) continue;
      ASSERT_GE(coarse, std::min(truth.distance(point), 0.6) - std::sqrt(3.0) * 0.08 - 1e-9);
    }
  }
}

TEST(FieldLookUp, ArraysOfDifferentLengthsAreRefused) {
  const auto space = Snapshot().blocked_space({}, box_around(2.0), 1.0);
  const std::vector<double> three(3, 0.0), two(2, 0.0);
  std::vector<double> out(3);
  EXPECT_NO_THROW(space->clearances({three, three, three}, out));
  EXPECT_THROW(space->clearances({three, two, three}, out), std::invalid_argument);
  EXPECT_THROW(space->coarse_clearances({three, three, two}, out), std::invalid_argument);
  out.resize(2);
  EXPECT_THROW(space->coarse_clearances({three, three, three}, out), std::invalid_argument);
}

}  // namespace field_look_up_test
}  // namespace clearway
