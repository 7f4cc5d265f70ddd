#include "planning/problem/waypoint_origin.hpp"

#include <gtest/gtest.h>

#include <set>

namespace clearway {
namespace waypoint_origin_test {

TEST(PathPhase, NamesAreReadBackAndNoTwoAreEqual) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(PathPhase::shortened); ++i) {
    const auto phase = static_cast<PathPhase>(i);
    EXPECT_EQ(path_phase(to_string(phase)), phase);
    EXPECT_TRUE(names.insert(to_string(phase)).second) << to_string(phase);
  }
  EXPECT_EQ(path_phase("no such phase"), PathPhase::unknown);
}

}  // namespace waypoint_origin_test
}  // namespace clearway
