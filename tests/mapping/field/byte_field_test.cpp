// The bytes against the squared distances that they are made of, which have tests of their own.

#include "mapping/field/byte_field.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "mapping/field/byte_numbers.hpp"
#include "mapping/field/distance_axes.hpp"
#include "mapping/snapshot.hpp"
#include "tests/worlds/instruction_sets.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace byte_field_test {

/// The number of each cell beside the exact distance of its middle, metres.
void expect_bounds(const BlockedSpace& space) {
  const ByteField& bytes = space.byte_field();
  EXPECT_EQ(&space.byte_field(), &bytes);
  std::vector<bool> is_taken(bytes.cells.size() - 3, false);
  const Eigen::Vector3i first = (bytes.low / bytes.resolution).array().round().cast<int>();
  std::size_t count = 0, below_end = 0;
  for (int z = 0; z < bytes.size.z(); ++z) {
    for (int y = 0; y < bytes.size.y(); ++y) {
      for (int x = 0; x < bytes.size.x(); ++x, ++count) {
        const Eigen::Vector3i voxel = first + Eigen::Vector3i(x, y, z);
        const Eigen::Array3i from_border =
            Eigen::Array3i(x, y, z).min(bytes.size.array() - 1 - Eigen::Array3i(x, y, z));
        const double distance = std::sqrt(space.squared_around(voxel)[0]) / 2 * bytes.resolution;
        const double border = (from_border.minCoeff() + 0.5) * bytes.resolution;
        const bool is_of_border = bytes.outside_blocked && border <= distance;  // looked at elsewhere
        const std::size_t index = bytes.index(x, y, z);
        ASSERT_LT(index, is_taken.size());
        ASSERT_FALSE(is_taken[index]) << "of two cells";
        is_taken[index] = true;
        if (bytes.cells[index] == 0) bytes.know(index);
        const int number = bytes.cells[index];
        ASSERT_GE(number, 1);
        ASSERT_EQ(number == 1, space.is_voxel_blocked(voxel)) << voxel.transpose();
        ASSERT_TRUE(is_of_border || (number - 1) * bytes.step <= distance * (1 + 1e-12)) << voxel.transpose();
        if (number >= bytes.end) continue;
        ++below_end;
        ASSERT_GT(number * bytes.step, distance) << voxel.transpose();
      }
    }
  }
  EXPECT_GT(below_end, count / 10);
}

TEST(ByteField, EachNumberIsTheDistanceRoundedDown) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const Snapshot map = worlds::random_map(seed, 0.05).snapshot();
    for (const Requirement& requirement :
         {Requirement{Policy::not_occupied}, Requirement{Policy::known_free}, Requirement{Policy::painted}}) {
      for (const double reach : {0.1, 0.6, 4.45}) {  // a few voxels, and all that a field can have
        const auto space = map.blocked_space(
            requirement, {Eigen::Vector3d(-0.5, -1.2, -0.3), Eigen::Vector3d(0.63, 1.3, 0.4)}, reach);
        expect_bounds(*space);
        EXPECT_EQ(space->byte_field().outside_blocked, requirement.policy != Policy::not_occupied);
      }
    }
  }
}

TEST(ByteNumbers, AreTheRootsOfWholeNumbersRoundedDown) {
  std::vector<std::uint16_t> squared(std::size_t{largest_cap} + 1);
  std::iota(squared.begin(), squared.end(), std::uint16_t{0});
  std::vector<std::uint8_t> numbers(squared.size());
  for (const InstructionSet set : worlds::instruction_sets()) {
    for (int units = 2; units <= 16; ++units) {
      number_bytes(squared.data(), squared.size(), units, set, numbers.data());
      long long root = 0;  // the largest whole number whose square is at most units^2 / 4 of what is asked
      for (long long i = 0; i <= largest_cap; ++i) {
        while (4 * (root + 1) * (root + 1) <= units * units * i) ++root;
        ASSERT_EQ(int{numbers[static_cast<std::size_t>(i)]}, std::min(1 + root, 255LL)) << i << " " << units;
      }
    }
  }
}

}  // namespace byte_field_test
}  // namespace clearway
