#include "tracking/tag_record.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace tag_record_test {

BodyPose pose_of(std::vector<int> tags, std::vector<int> rejected) {
  BodyPose pose;
  pose.tags = std::move(tags);
  pose.rejected = std::move(rejected);
  return pose;
}

TEST(TagRecord, trusts_tags_until_the_others_have_contradicted_them_three_times) {
  TagRecord record;
  EXPECT_TRUE(record.is_trusted(4));
  for (int i = 0; i < 2; ++i) record.note(pose_of({1, 2, 3}, {4}), true);
  EXPECT_TRUE(record.is_trusted(4));
  record.note(pose_of({1, 2, 3}, {4}), true);
  EXPECT_FALSE(record.is_trusted(4));
  EXPECT_TRUE(record.is_trusted(1));
  const std::vector<TagDetection> seen = {
      {.id = 1, .corners = {}}, {.id = 4, .corners = {}}, {.id = 9, .corners = {}}};
  const auto kept = record.trusted(seen);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].id, 1);
  EXPECT_EQ(kept[1].id, 9);
}

TEST(TagRecord, an_outlier_now_and_then_costs_no_trust) {
  TagRecord record;
  for (int i = 0; i < 300; ++i) record.note(i % 5 == 0 ? pose_of({1, 2}, {3}) : pose_of({1, 2, 3}, {}), true);
  EXPECT_TRUE(record.is_trusted(3));
}

TEST(TagRecord, a_tag_that_is_mended_is_trusted_again) {
  TagRecord record;
  for (int i = 0; i < 50; ++i) record.note(pose_of({1, 2}, {3}), true);
  EXPECT_FALSE(record.is_trusted(3));
  for (int i = 0; i < 50; ++i) record.note(pose_of({1, 2, 3}, {}), true);
  EXPECT_TRUE(record.is_trusted(3));
}

TEST(TagRecord, images_with_two_tags_say_not_which_is_wrong) {
  TagRecord record;
  for (int i = 0; i < 10; ++i) record.note(pose_of({1}, {3}), true);
  for (int i = 0; i < 10; ++i) record.note(pose_of({1, 3}, {}), false);
  for (int id : {1, 3}) EXPECT_TRUE(record.is_trusted(id));
}

TEST(TagRecord, two_tags_that_contradict_each_other_three_times_are_both_disputed) {
  TagRecord record;
  for (int i = 0; i < 2; ++i) record.note(pose_of({1, 3}, {}), false);
  EXPECT_FALSE(record.is_disputed(1));
  record.note(pose_of({1, 3}, {}), false);
  EXPECT_TRUE(record.is_disputed(1));
  EXPECT_TRUE(record.is_disputed(3));
  EXPECT_FALSE(record.is_disputed(2));
  for (int i = 0; i < 10; ++i) record.note(pose_of({1}, {}), true);  // agrees with itself alone
  EXPECT_TRUE(record.is_disputed(1));
}

TEST(TagRecord, a_third_tag_settles_a_dispute) {
  TagRecord record;
  for (int i = 0; i < 5; ++i) record.note(pose_of({1, 3}, {}), false);
  for (int i = 0; i < 6; ++i) record.note(pose_of({1, 2}, {3}), true);
  EXPECT_FALSE(record.is_disputed(1));
  EXPECT_FALSE(record.is_trusted(3));
}

TEST(TagRecord, three_tags_that_fit_badly_dispute_none) {
  TagRecord record;
  for (int i = 0; i < 10; ++i) record.note(pose_of({1, 2, 3}, {}), false);
  for (int id : {1, 2, 3}) EXPECT_FALSE(record.is_disputed(id));
}

TEST(TagRecord, a_blurred_image_now_and_then_disputes_nothing) {
  TagRecord record;
  for (int i = 0; i < 300; ++i) record.note(pose_of({1, 3}, {}), i % 3 != 1);
  EXPECT_FALSE(record.is_disputed(1));
}

}  // namespace tag_record_test
}  // namespace clearway
