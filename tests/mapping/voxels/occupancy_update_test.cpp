#include "mapping/voxels/occupancy_update.hpp"

#include <gtest/gtest.h>

#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace evidence_rule_test {

/// OctoMap's own model: 0.7, 0.4, clamped at 0.1192 and 0.971.
OccupancyUpdate rule_with(Integration integration) {
  const FusedTree tree(0.1);
  return {integration,
          tree.getProbHitLog(),
          tree.getProbMissLog(),
          tree.getClampingThresMinLog(),
          tree.getClampingThresMaxLog(),
          tree.getOccupancyThresLog()};
}

/// How many looks free a voxel of these log-odds.
template <class Look>
int looks_until_free(const OccupancyUpdate& rule, float log_odds, const Look& look) {
  int count = 0;
  for (; log_odds >= rule.threshold && count < 100; ++count) log_odds = look(log_odds);
  return count;
}

TEST(OccupancyUpdate, ASafeHitBlocksWhateverThePast) {
  for (const float threshold : {-0.5F, 0.0F, 1.2F}) {
    OccupancyUpdate rule = rule_with(Integration::safe);
    rule.threshold = threshold;
    for (float past = rule.low; past <= rule.high; past += 0.01F) {
      EXPECT_GE(rule.after_hit(past), threshold) << past;
      EXPECT_GE(rule.after_hit(past), past) << past;
      EXPECT_LE(rule.after_hit(past), rule.high);
    }
  }
}

TEST(OccupancyUpdate, OneHitOfFreeSpaceIsGoneAfterThreeLooks) {
  const OccupancyUpdate rule = rule_with(Integration::safe);
  const auto miss = [&](float value) { return rule.after_miss(value); };
  const auto clear_look = [&](float value) { return rule.after_clear_look(value); };
  for (const float past : {rule.low, -1.0F, -0.1F, 0.0F}) {
    EXPECT_EQ(looks_until_free(rule, rule.after_hit(past), miss), 3) << past;
    EXPECT_EQ(looks_until_free(rule, rule.after_hit(past), clear_look), 3) << past;
  }
}

TEST(OccupancyUpdate, WhatWasHitForLongIsFreeAfterFiveClearLooksOrNinePlainOnes) {
  const OccupancyUpdate rule = rule_with(Integration::safe);
  const auto miss = [&](float value) { return rule.after_miss(value); };
  const auto clear_look = [&](float value) { return rule.after_clear_look(value); };
  EXPECT_EQ(looks_until_free(rule, rule.high, miss), 9);
  for (float value = 0.0F; value <= 1000.0F; value = 2.0F * value + 0.1F)  // beyond: of a foreign map
    EXPECT_LE(looks_until_free(rule, value, clear_look), 5) << value;
}

TEST(OccupancyUpdate, AClearLookTakesWhatAMissTakesOrMore) {
  const OccupancyUpdate rule = rule_with(Integration::safe);
  for (float value = rule.low; value <= rule.high; value += 0.01F) {
    EXPECT_LE(rule.after_clear_look(value), rule.after_miss(value)) << value;
    if (rule.distinguishes_clear_looks(value)) continue;
    EXPECT_EQ(rule.after_clear_look(value), rule.after_miss(value));
  }
}

TEST(OccupancyUpdate, CompatibleAddsAndClamps) {
  const OccupancyUpdate rule = rule_with(Integration::compatible);
  EXPECT_EQ(rule.after_hit(rule.low), rule.low + rule.hit);
  EXPECT_EQ(rule.after_hit(rule.high), rule.high);
  EXPECT_EQ(rule.after_miss(rule.low), rule.low);
  EXPECT_FALSE(rule.distinguishes_clear_looks(rule.high));
}

}  // namespace evidence_rule_test
}  // namespace clearway
