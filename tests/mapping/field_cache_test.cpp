#include "mapping/field_cache.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/fused_tree.hpp"

namespace clearway {
namespace {

Eigen::AlignedBox3d box_around(double reach) {
  return {Eigen::Vector3d::Constant(-reach), Eigen::Vector3d::Constant(reach)};
}

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

}  // namespace
}  // namespace clearway
