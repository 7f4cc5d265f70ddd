#include "planning/files/load_json.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace load_json_test {

using Json = nlohmann::ordered_json;

LegLoad load_of(const Shape& shape, Random& random) {
  return {{"can", "hand", random.pose(1.0), shape, random.unit(), {"link5", "finger"}}, {0, 3}};
}

TEST(LoadJson, ReadsBackWhatItWrote) {
  Random random(1);
  for (const Shape& shape :
       {Shape::sphere(0.1), Shape::capsule(0.1, 0.3), Shape::cylinder(0.1, 0.3), Shape::box({0.1, 0.2, 0.3}),
        Shape::convex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})}) {
    std::vector<LegLoad> loads = {load_of(shape, random), load_of(shape, random)};
    loads[1].legs.clear();
    const Json json = json_of(loads);
    const std::vector<LegLoad> read = loads_of(JsonField(json, "plan p.json"));
    ASSERT_EQ(read.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_TRUE(is_same(read[i].load, loads[i].load));
      EXPECT_EQ(read[i].load.link_from_load.matrix(), loads[i].load.link_from_load.matrix());
      EXPECT_EQ(read[i].legs, loads[i].legs);
    }
    EXPECT_EQ(json_of(read).dump(), json.dump());

    Pick pick;
    pick.object = loads[0].load;
    pick.map_from_object = random.pose(1.0);
    pick.map_from_place = random.pose(1.0);
    pick.object_from_tip = random.pose(1.0);
    pick.approach = random.point(0.1);
    pick.lift = 0.2, pick.contact = 0.05, pick.margin = 0.01;
    const Json of_pick = json_of(pick);
    EXPECT_TRUE(is_same(pick_of(JsonField(of_pick, "plan p.json")), pick));
  }
}

TEST(LoadJson, SameIsSameInEveryFieldThatCounts) {
  Random random(2);
  const Load load = load_of(Shape::box({0.1, 0.2, 0.3}), random).load;
  const auto differs = [&](const std::function<void(Load&)>& change) {
    Load other = load;
    change(other);
    return !is_same(load, other);
  };
  EXPECT_TRUE(is_same(load, load));
  EXPECT_TRUE(differs([](Load& other) { other.name = "tin"; }));
  EXPECT_TRUE(differs([](Load& other) { other.link = "arm"; }));
  EXPECT_TRUE(differs([](Load& other) { other.mass += 1e-3; }));
  EXPECT_TRUE(differs([](Load& other) { other.touches.pop_back(); }));
  EXPECT_TRUE(differs([](Load& other) { other.link_from_load.translation().y() += 1e-5; }));
  EXPECT_TRUE(differs([](Load& other) { other.shape = Shape::box({0.1, 0.2, 0.2999}); }));
  EXPECT_TRUE(differs([](Load& other) { other.shape = Shape::sphere(0.1); }));
}

TEST(LoadJson, SaysWhichFieldIsWrong) {
  Random random(3);
  const Json good = json_of(std::vector<LegLoad>{load_of(Shape::sphere(0.1), random)});
  const auto sentence = [&](const std::function<void(Json&)>& spoil) {
    Json json = good;
    spoil(json[0]);
    try {
      loads_of(JsonField(json, "plan p.json"));
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto names = [&](const std::string& words, const std::function<void(Json&)>& spoil) {
    EXPECT_NE(sentence(spoil).find(words), std::string::npos) << sentence(spoil);
    EXPECT_NE(sentence(spoil).find("plan p.json"), std::string::npos) << sentence(spoil);
  };
  names("[0].shape", [](Json& json) { json["shape"] = {{"sphere", -1.0}}; });
  names("[0].shape", [](Json& json) { json["shape"] = {{"ball", 1.0}}; });
  names("[0].shape.box", [](Json& json) { json["shape"] = {{"box", {1.0, 2.0}}}; });
  names("[0].shape", [](Json& json) { json["shape"] = {{"hull", Json::array()}}; });
  names("[0].legs", [](Json& json) { json["legs"] = {0}; });
  names("[0].legs", [](Json& json) { json["legs"] = Json::array(); });
  names("[0].mass_kg", [](Json& json) { json["mass_kg"] = "heavy"; });
  names("[0].pose", [](Json& json) { json["pose"] = {1, 2, 3}; });
}

}  // namespace load_json_test
}  // namespace clearway
