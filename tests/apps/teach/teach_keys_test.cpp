#include "apps/teach/teach_keys.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace teach_keys_test {

constexpr TeachState states[] = {TeachState::ready,     TeachState::painting, TeachState::erasing,
                                 TeachState::selecting, TeachState::planning, TeachState::planned,
                                 TeachState::playing,   TeachState::approved, TeachState::marking};

TEST(TeachKeys, OneKeyBeginsAndEndsAStroke) {
  EXPECT_EQ(action_of_key(' ', TeachState::ready), TeachAction::paint_on);
  EXPECT_EQ(action_of_key(' ', TeachState::painting), TeachAction::paint_off);
  EXPECT_EQ(action_of_key('e', TeachState::approved), TeachAction::erase_on);
  EXPECT_EQ(action_of_key('e', TeachState::erasing), TeachAction::erase_off);
  EXPECT_EQ(action_of_key(27, TeachState::planning), TeachAction::quit);
  EXPECT_EQ(action_of_key('y', TeachState::ready), std::nullopt);
  EXPECT_EQ(action_of_key(-1, TeachState::ready), std::nullopt);
}

TEST(TeachKeys, EveryStateOffersAWayOnAndAWayOut) {
  for (const TeachState state : states) {
    const std::string keys = keys_of(state, {});
    EXPECT_NE(keys.find("q: quit"), std::string::npos) << to_string(state);
    EXPECT_LT(keys.size(), 100u) << keys;
  }
  EXPECT_EQ(keys_of(TeachState::painting, {}), "space: stop painting, u: undo, q: quit");
  EXPECT_NE(keys_of(TeachState::planned, {}).find("a: approve"), std::string::npos);
  EXPECT_EQ(keys_of(TeachState::selecting, {}).find("a: approve"), std::string::npos);
  EXPECT_EQ(keys_of(TeachState::ended, {}), "");
  EXPECT_EQ(keys_of(TeachState::marking, {}), "o: stop marking, u: undo, q: quit");
  EXPECT_EQ(action_of_key('o', TeachState::ready), TeachAction::object);
  EXPECT_EQ(action_of_key('o', TeachState::marking), TeachAction::object_off);
}

TEST(TeachKeys, WithoutAProbeNoKeyIsOfferedThatNeedsItsBall) {
  EXPECT_EQ(keys_of(TeachState::ready, {.probe = false}), "s: start, u: undo, w: save, q: quit");
  EXPECT_NE(keys_of(TeachState::ready, {}).find("space: paint"), std::string::npos);
}

TEST(TeachKeys, PickPlaceAndDetachAreOfferedWhereTheyApply) {
  const auto offers = [](TeachState state, const KeyOffer& offer, const std::string& key) {
    return keys_of(state, offer).find(key) != std::string::npos;
  };
  for (const TeachState state : states)
    for (const char* key : {"k: pick", "d: place", "x: detach"})
      EXPECT_FALSE(offers(state, {}, key)) << to_string(state) << ", " << key;
  EXPECT_TRUE(offers(TeachState::selecting, {.objects = true}, "k: pick"));
  EXPECT_FALSE(offers(TeachState::ready, {.objects = true}, "k: pick"));
  EXPECT_TRUE(offers(TeachState::selecting, {.objects = true, .place = true}, "d: place"));
  EXPECT_TRUE(offers(TeachState::ready, {.load = true}, "x: detach"));
  EXPECT_FALSE(offers(TeachState::planning, {.load = true}, "x: detach"));
}

TEST(TeachKeys, UndoStrokeAndAnotherArmAreOfferedWhereTheyApply) {
  const auto offers = [](TeachState state, const KeyOffer& offer, const std::string& key) {
    return keys_of(state, offer).find(key) != std::string::npos;
  };
  for (const TeachState state : states)
    for (const char* key : {"z: undo stroke", "b: other arm"})
      EXPECT_FALSE(offers(state, {}, key)) << to_string(state) << ", " << key;
  EXPECT_TRUE(offers(TeachState::selecting, {.stroke = true}, "z: undo stroke"));
  EXPECT_TRUE(offers(TeachState::painting, {.stroke = true}, "z: undo stroke"));
  EXPECT_FALSE(offers(TeachState::marking, {.stroke = true}, "z: undo stroke"));
  EXPECT_TRUE(offers(TeachState::selecting, {.robot = true}, "b: other arm"));
  EXPECT_FALSE(offers(TeachState::painting, {.robot = true}, "b: other arm"));
  EXPECT_EQ(action_of_key('z', TeachState::selecting), TeachAction::undo_stroke);
  EXPECT_EQ(action_of_key('b', TeachState::selecting), TeachAction::branch);
}

TEST(TeachKeys, AFileOfKeysBringsRobotsVolumesAndLoads) {
  const TemporaryFolder folder;
  folder.write(
      "keys.jsonl",
      "{\"key\": \"1\", \"action\": \"robot\", \"robot\": \"planar2\"}\n"
      "{\"key\": \"2\", \"action\": \"volume\", \"label\": \"shelf\"}\n"
      "{\"key\": \"3\", \"action\": \"attach\", \"load\": {\"name\": \"can\", \"sphere\": 0.1, \"link\": "
      "\"forearm\"}}\n"
      "{\"key\": \"4\", \"action\": \"object\", \"name\": \"cup\"}\n");
  const std::vector<TeachKey> keys = load_teach_keys(folder / "keys.jsonl");
  EXPECT_EQ(words_of(keys), "1: robot planar2, 2: volume shelf, 3: attach can, 4: object cup");
  clearway::Setup setup;
  setup.probe.emplace();
  FreeSpaceMap map(MapOptions{.resolution = 0.1});
  map.add_volume("free", {});
  const FusionCounts counts;
  std::vector<TeachEvent> due;
  TeachSession session([&](double) { return std::exchange(due, {}); }, {});
  session.begin(setup, map, counts);
  const auto press = [&](char key) {
    const auto event = event_of_key(key, keys, session);
    if (!event) return std::string("nothing");
    due = {*event};
    session.before(1.0);
    return std::string(to_string(event->action)) + session.events().back().refusal;
  };
  EXPECT_EQ(press('1'), "robot");
  EXPECT_EQ(press('2'), "volume");
  EXPECT_EQ(map.volumes().back().label, "shelf");
  EXPECT_EQ(press('3'), "attach");
  EXPECT_EQ(press('3'), "detach");
  EXPECT_EQ(press('4'), "object");
  EXPECT_EQ(press('4').substr(0, 10), "object_off");
  EXPECT_EQ(press('5'), "nothing");
  const auto refused = [&](const std::string& text, const std::string& part) {
    folder.write("bad.jsonl", text);
    try {
      load_teach_keys(folder / "bad.jsonl");
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("{\"action\": \"plan\"}", "keys file");
  refused("{\"key\": \"11\", \"action\": \"plan\"}", "one visible ASCII character");
  refused("{\"key\": \"p\", \"action\": \"plan\"}", "a key that does nothing yet");
  refused("{\"key\": \"1\", \"time\": 0, \"action\": \"plan\"}", "no such field");
  refused("{\"key\": \"1\", \"action\": \"plan\"}\n{\"key\": \"1\", \"action\": \"play\"}",
          "line 2: field 'key': expected each key once");
}

}  // namespace teach_keys_test
}  // namespace clearway
