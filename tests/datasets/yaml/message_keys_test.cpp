#include "datasets/yaml/message_keys.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace clearway {
namespace {

std::string refusal(const std::string& text, RosMessage kind) {
  try {
    require_no_lost_keys(YamlFields(text, "m"), kind);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RosMessageKeys, AreRefusedWhereTheirLossWouldMoveOrFreeSomething) {
  EXPECT_EQ(refusal("position: [0, 0, 1]\nrpy: [0, 0, 1]", RosMessage::pose),
            "m, line 2, rpy: expected no such key, as what it says would be lost; known are orientation, "
            "position.");
  for (const char* lost : {"Scale: 2", "scaling: [1]", "primitive: [{}]", "frame_id: a", "tolerance: 1",
                           "location: [1, 2, 3]", "x: 1", "boxes: [{}]", "attached_bodies: [{}]"})
    EXPECT_NE(refusal(lost, RosMessage::collision_object), "") << lost;
  for (const char* kept :
       {"id: a", "primitive: []", "primitive: {}", "scale:", "shape: ball", "mass: 1", "color: [1, 0, 0]",
        "pose: {}", "repository: https://a.b", "purpose: test", "tags: [a, b]\ntags_deg: [c]"})
    EXPECT_EQ(refusal(kept, RosMessage::collision_object), "") << kept;
}

TEST(RosMessageKeys, NotesMayBeLong) {
  EXPECT_EQ(refusal("comments: [\"" + std::string(200, 'a') + "\"]", RosMessage::collision_object), "");
}

TEST(RosMessageKeys, AllOfThemTellAMessageFromOthers) {
  EXPECT_TRUE(has_keys_of(YamlFields("name: a\nis_diff: true", "m"), RosMessage::planning_scene));
  EXPECT_FALSE(has_keys_of(YamlFields("name: a\nsamples: 3", "m"), RosMessage::planning_scene));
  EXPECT_FALSE(has_keys_of(YamlFields("", "m"), RosMessage::planning_scene));
}

}  // namespace
}  // namespace clearway
