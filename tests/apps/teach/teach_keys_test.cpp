#include "apps/teach/teach_keys.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace teach_keys_test {

constexpr TeachState states[] = {TeachState::ready,     TeachState::painting, TeachState::erasing,
                                 TeachState::selecting, TeachState::planning, TeachState::planned,
                                 TeachState::playing,   TeachState::approved};

TEST(TeachKeys, OneKeyBeginsAndEndsAStroke) {
  EXPECT_EQ(action_of_key(' ', TeachState::ready), TeachAction::paint_on);
  EXPECT_EQ(action_of_key(' ', TeachState::painting), TeachAction::paint_off);
  EXPECT_EQ(action_of_key('e', TeachState::approved), TeachAction::erase_on);
  EXPECT_EQ(action_of_key('e', TeachState::erasing), TeachAction::erase_off);
  EXPECT_EQ(action_of_key(27, TeachState::planning), TeachAction::quit);
  EXPECT_EQ(action_of_key('x', TeachState::ready), std::nullopt);
  EXPECT_EQ(action_of_key(-1, TeachState::ready), std::nullopt);
}

TEST(TeachKeys, EveryStateOffersAWayOnAndAWayOut) {
  for (const TeachState state : states) {
    const std::string keys = keys_of(state);
    EXPECT_NE(keys.find("q: quit"), std::string::npos) << to_string(state);
    EXPECT_LT(keys.size(), 100u) << keys;
  }
  EXPECT_EQ(keys_of(TeachState::painting), "space: stop painting, u: undo, q: quit");
  EXPECT_NE(keys_of(TeachState::planned).find("a: approve"), std::string::npos);
  EXPECT_EQ(keys_of(TeachState::selecting).find("a: approve"), std::string::npos);
  EXPECT_EQ(keys_of(TeachState::ended), "");
}

}  // namespace teach_keys_test
}  // namespace clearway
