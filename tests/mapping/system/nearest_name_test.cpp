#include "mapping/system/nearest_name.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace nearest_name_test {

using Names = std::vector<std::string>;

TEST(EditDistance, CountsSwappedNeighboursOnce) {
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("widht", "width"), 1U);
  EXPECT_EQ(edit_distance("width", "widths"), 1U);
  EXPECT_EQ(edit_distance("abc", "xyz"), 3U);
  EXPECT_EQ(edit_distance("ba", "ab"), 1U);
}

TEST(NearestName, IsWhatTakesTheFewestEdits) {
  EXPECT_EQ(nearest_name("bem", {"boundary", "beam", "constraint"}), "beam");
  EXPECT_EQ(nearest_name("rrt_connect", {"beam", "rrtconnect"}), "rrtconnect");
  EXPECT_EQ(nearest_name("hadn", {"arm", "hand"}), "hand");
  EXPECT_EQ(nearest_name("Hand", {"arm", "hand"}), "hand");
  EXPECT_EQ(nearest_name("resolutoin", {"resolution"}), "resolution");
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, GoesOnWhereTheNameEndsOrHoldsItAsItsLastWord) {
  EXPECT_EQ(nearest_name("rate", {"path", "rate_hz"}), "rate_hz");
  EXPECT_EQ(nearest_name("rate_hz", {"path", "rate"}), "rate");
  EXPECT_EQ(nearest_name("tolerance", {"tip", "turn-tolerance"}), "turn-tolerance");
  EXPECT_EQ(nearest_name("out-folder", {"map", "out"}), "out");
  EXPECT_EQ(nearest_name("ance", {"turn-tolerance"}), "");
  EXPECT_EQ(nearest_name("panda_hnd", {"base", "link7", "hand"}), "hand");
  EXPECT_EQ(nearest_name("kitchn", {"laser", "miniature_kitchen"}), "miniature_kitchen");
  EXPECT_EQ(nearest_name("upper_arm", {"lower_rod_arm"}), "");
}

TEST(NearestName, IsNoneOfThoseThatShareLittle) {
  EXPECT_EQ(nearest_name("x", {"y", "fx"}), "");
  EXPECT_EQ(nearest_name("goal", {"gain", "load"}), "");
  EXPECT_EQ(nearest_name("prm", {"beam", "est"}), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'x'), {"beam"}), "");
}

TEST(Suggestion, NamesWhatIsNearElseWhatThereIs) {
  EXPECT_EQ(suggestion("bem", {"boundary", "beam"}), "did you mean 'beam'?");
  EXPECT_EQ(suggestion("frobnicate", {"boundary", "beam"}), "expected one of boundary, beam");
  EXPECT_EQ(suggestion("beam", {}), "expected none");
}

}  // namespace nearest_name_test
}  // namespace clearway
