#include "mapping/field/field_cache.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"

namespace clearway {
namespace field_cache_test {

using worlds::box_around;

TEST(FieldCache, TheOldestMakeRoomButStayUsable) {
  const std::size_t one = field_bytes(field_region(box_around(16.0), 1.0, 1.0));
  FieldCache cache(std::make_shared<const FusedTree>(1.0), 2 * one + 100);
  const auto first = cache.get({Policy::painted}, box_around(16.0), 1.0);
  const auto second = cache.get({Policy::known_free}, box_around(16.0), 1.0);
  EXPECT_EQ(cache.get({Policy::painted}, box_around(16.0), 1.0), first);
  const auto third = cache.get({Policy::not_occupied}, box_around(16.0), 1.0);
  EXPECT_EQ(cache.get({Policy::known_free}, box_around(16.0), 1.0), second);
  EXPECT_EQ(cache.get({Policy::not_occupied}, box_around(16.0), 1.0), third);
  EXPECT_NE(cache.get({Policy::painted}, box_around(16.0), 1.0), first);  // built again
  EXPECT_TRUE(first->is_blocked(Eigen::Vector3d::Zero()));
}

TEST(FieldCache, RefusesWhatAloneExceedsTheLimit) {
  FieldCache cache(std::make_shared<const FusedTree>(1.0), 2U << 20U);
  EXPECT_NO_THROW(cache.get({}, box_around(48.0), 1.0));
  EXPECT_THROW(cache.get({}, box_around(60.0), 1.0), std::invalid_argument);
}

TEST(FieldCache, TheSizeThatIsSaidToFitFits) {
  for (const std::size_t limit : {std::size_t{1} << 20U, std::size_t{7} << 22U}) {
    FieldCache cache(std::make_shared<const FusedTree>(1.0), limit);
    try {
      cache.get({}, box_around(500.0), 1.0);
      FAIL() << "expected a refusal";
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      const double edge = std::stod(text.substr(text.find("a cube of ") + 10));
      EXPECT_GE(edge, 0.5 * std::cbrt(static_cast<double>(limit) / 2.0));
      EXPECT_NO_THROW(cache.get({}, {Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(edge)}, 1.0));
    }
  }
}

struct Version {
  explicit Version(const FreeSpaceMap& map, FieldCache* previous = nullptr)
      : tree(std::make_shared<const FusedTree>(map.snapshot().tree())),
        fields(std::make_unique<FieldCache>(tree, field_memory_limit, previous)) {}
  std::shared_ptr<const FusedTree> tree;
  std::unique_ptr<FieldCache> fields;
};

void expect_equal(const BlockedField& a, const BlockedField& b) {
  ASSERT_EQ(a.blocked_count(), b.blocked_count());
  const Eigen::Vector3i size = a.cells().size;
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x) {
        ASSERT_EQ(a.distances()->squared(x, y, z), b.distances()->squared(x, y, z))
            << x << " " << y << " " << z;
      }
    }
  }
}

// Painting, scans and both at once, under all policies; some versions are never asked, so that the next one
// has more to catch up with. A second map stands for everything at once being different.
TEST(FieldCache, AFieldThatFollowsItsMapEqualsOneMadeFromNothing) {
  worlds::Dice dice(3);
  FreeSpaceMap map = worlds::random_map(3, 0.05, 1);
  const FreeSpaceMap other = worlds::random_map(4, 0.05, 3);
  Version version(map);
  for (int round = 0; round < 16; ++round) {
    for (const Policy policy : {Policy::not_occupied, Policy::known_free, Policy::painted}) {
      if (dice.whole(0, 3) == 0) continue;
      const auto field = version.fields->get({policy}, box_around(1.1), 0.6);
      expect_equal(*field, BlockedField(*version.tree, {policy}, field->cells()));
    }
    if (round % 3 != 0) map.insert(worlds::random_scan(dice, round % 2 == 0 ? 3 : 200));
    if (round % 3 != 1) map.paint(dice.whole(0, 1), worlds::random_sphere(dice), 1.0 + round);
    version = Version(round == 10 ? other : map, version.fields.get());
  }
}

TEST(FieldCache, WhatDidNotChangeIsSharedWithTheFieldBefore) {
  FreeSpaceMap map = worlds::random_map(5, 0.05);
  const Version before(map);
  const auto old_field = before.fields->get({}, box_around(3.0), 0.3);
  const std::uint16_t* old_line = old_field->distances()->line(0, 0, 0);
  map.paint(0, {Eigen::Vector3d(0.9, 0.9, 0.9), 0.06}, 9.0);
  const Version after(map, before.fields.get());
  const auto field = after.fields->get({}, box_around(3.0), 0.3);
  EXPECT_NE(field, old_field);
  EXPECT_EQ(field->distances()->line(0, 0, 0), old_line);
  EXPECT_EQ(after.fields->get({}, box_around(3.0), 0.3), field);
}

TEST(FieldCache, AFieldOfTheSameTreeIsHandedOn) {
  const auto tree = std::make_shared<const FusedTree>(1.0);
  FieldCache cache(tree, field_memory_limit);
  const auto field = cache.get({}, box_around(8.0), 1.0);
  FieldCache next(tree, field_memory_limit, &cache);
  EXPECT_EQ(next.get({}, box_around(8.0), 1.0), field);
}

}  // namespace field_cache_test
}  // namespace clearway
