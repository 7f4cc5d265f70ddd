#include "mapping/voxels/voxel_state.hpp"

#include <gtest/gtest.h>

#include <set>
#include <stdexcept>

namespace clearway {
namespace voxel_state_test {

constexpr Policy policies[] = {Policy::painted, Policy::known_free, Policy::not_occupied};
constexpr VoxelState states[] = {VoxelState::unknown, VoxelState::seen_free, VoxelState::painted,
                                 VoxelState::occupied, VoxelState::conflict};

TEST(VoxelState, PoliciesAreReadAsTheyAreWrittenAndNothingElseIs) {
  std::set<std::string> words;
  for (const Policy policy : policies) {
    EXPECT_EQ(parse_policy(to_string(policy)), policy) << to_string(policy);
    words.insert(std::string(to_string(policy)));
  }
  EXPECT_EQ(words, (std::set<std::string>{"painted", "known_free", "not_occupied"}));
  for (const char* other : {"", "Painted", "painted ", "free", "unknown", "occupied"}) {
    try {
      parse_policy(other);
      ADD_FAILURE() << other;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("expected painted, known_free or not_occupied"),
                std::string::npos);
    }
  }
}

TEST(VoxelState, EachHasANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const VoxelState state : states) names.insert(to_string(state));
  EXPECT_EQ(names, (std::set<std::string_view>{"unknown", "seen_free", "painted", "occupied", "conflict"}));
}

/// The table of mapping/README.md, written out.
TEST(VoxelState, APolicyAllowsWhatTheTableSays) {
  constexpr std::uint16_t own = 0b0110;
  const auto allowed = [&](Policy policy, VoxelState state, std::uint16_t mask) {
    return allows({.policy = policy, .volumes = own}, state, mask);
  };
  for (const VoxelState state : states) {
    const bool blocks = state == VoxelState::occupied || state == VoxelState::conflict;
    EXPECT_EQ(allowed(Policy::not_occupied, state, 0), !blocks) << to_string(state);
    EXPECT_EQ(allowed(Policy::known_free, state, 0),
              state == VoxelState::painted || state == VoxelState::seen_free)
        << to_string(state);
    EXPECT_EQ(allowed(Policy::painted, state, 0b0100), !blocks) << to_string(state);
    EXPECT_FALSE(allowed(Policy::painted, state, 0b1001)) << to_string(state);
  }
}

}  // namespace voxel_state_test
}  // namespace clearway
