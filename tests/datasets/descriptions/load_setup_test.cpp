#include "datasets/descriptions/load_setup.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "datasets/descriptions/setup.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace load_setup_test {

class LoadFiles : public ::testing::Test {
 protected:
  LoadSetup load(const std::string& text) { return load_load(folder_.write("load.yaml", text)); }
  PickSetup pick(const std::string& text) { return load_pick(folder_.write("pick.yaml", text)); }

  std::string sentence(const std::string& text) {
    try {
      load(text);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

TEST_F(LoadFiles, SayShapePlaceAndLegs) {
  const LoadSetup can = load(
      "{name: can, cylinder: [0.03, 0.12], link: hand, pose_deg: [0, 0, 0.13, 180, 0, 0], mass: 0.3, "
      "touches: [finger], legs: [2, 3]}");
  EXPECT_EQ(can.name, "can");
  EXPECT_EQ(std::get<LoadCylinder>(can.shape).length, 0.12);
  EXPECT_NEAR(can.link_from_load.linear()(2, 2), -1.0, 1e-12);
  EXPECT_EQ(can.link_from_load.translation().z(), 0.13);
  EXPECT_EQ(can.mass, 0.3);
  EXPECT_EQ(can.touches, std::vector<std::string>{"finger"});
  EXPECT_EQ(can.legs, (std::vector<int>{2, 3}));
  EXPECT_EQ(std::get<LoadBox>(load("{name: a, box: [1, 2, 3], link: b}").shape).edges.z(), 3.0);
  EXPECT_EQ(std::get<LoadSphere>(load("{name: a, sphere: 2, link: b}").shape).radius, 2.0);
  EXPECT_EQ(std::get<LoadCapsule>(load("{name: a, capsule: [1, 2], link: b}").shape).length, 2.0);
  const LoadMesh mesh = std::get<LoadMesh>(load("{name: a, mesh: cup.stl, scale: 0.001, link: b}").shape);
  EXPECT_EQ(mesh.file.filename(), "cup.stl");
  EXPECT_EQ(mesh.file.parent_path(), folder_.path());
  EXPECT_EQ(mesh.scale, 0.001);
}

TEST_F(LoadFiles, AreRefusedInASentenceThatNamesTheKey) {
  const auto names = [&](const std::string& word, const std::string& text) {
    EXPECT_NE(sentence(text).find(word), std::string::npos) << sentence(text);
    EXPECT_NE(sentence(text).find("load.yaml"), std::string::npos) << sentence(text);
  };
  names("exactly one of box", "{name: a, link: b}");
  names("exactly one of box", "{name: a, box: [1, 1, 1], sphere: 1, link: b}");
  names("box", "{name: a, box: [1, 1], link: b}");
  names("sphere", "{name: a, sphere: -1, link: b}");
  names("sphere", "{name: a, sphere: .nan, link: b}");
  names("sphere: expected a number from 1e-06 to 1000, got '1001'", "{name: a, sphere: 1001, link: b}");
  names("cylinder", "{name: a, cylinder: [0.1, 1e5], link: b}");
  names("link", "{name: a, sphere: 1}");
  names("mass", "{name: a, sphere: 1, link: b, mass: -1}");
  names("legs", "{name: a, sphere: 1, link: b, legs: [0]}");
  names("legs", "{name: a, sphere: 1, link: b, legs: [1.5]}");
  names("legs", "{name: a, sphere: 1, link: b, legs: []}");
  names("tuoches", "{name: a, sphere: 1, link: b, tuoches: [c]}");
  names("map", "[1, 2]");
}

TEST_F(LoadFiles, HaveAHullAsPointsOrInAFile) {
  const std::vector<Eigen::Vector3d> expected{{0.1, -2e-3, 3.0}, {1, 2, 3}};
  EXPECT_EQ(std::get<LoadHull>(load("{name: a, hull: [[0.1, -2e-3, 3], [1, 2, 3]], link: b}").shape).points,
            expected);
  const std::string text = "{name: a, hull: hull.txt, link: b}";
  for (const char* points : {"0.1 -2e-3 3.0\n1 2 3", " 0.1\t-2e-3  3 \r\n1 2 3\r\n"}) {
    folder_.write("hull.txt", points);
    EXPECT_EQ(std::get<LoadHull>(load(text).shape).points, expected);
  }
  for (const char* points :
       {"1 2", "1 2 3 4", "1 2 nan", "1 2 inf", "1 2 3\n\n1 2 3", "a b c", "1,2,3", "1 2 1e7"}) {
    folder_.write("hull.txt", points);
    EXPECT_NE(sentence(text).find("hull.txt', line "), std::string::npos) << sentence(text);
  }
  folder_.write("hull.txt", "");
  EXPECT_NE(sentence(text).find("expected 1 to 100000 points"), std::string::npos) << sentence(text);
  EXPECT_NE(sentence("{name: a, hull: none.txt, link: b}").find("none.txt' cannot be read"),
            std::string::npos);
}

TEST(LoadsOfASetup, AreFoundByNameAndSayNoLegs) {
  const auto setup = [](const std::string& loads) {
    return parse_setup("loads: [" + loads +
                           "]\nqueries:\n  - {name: q, start: [0], goals: [[1]], loads: "
                           "[{name: pot, sphere: 2, link: b}, {name: can, sphere: 3, link: b}]}",
                       "s.yaml");
  };
  const clearway::Setup two =
      setup("{name: can, sphere: 1, link: hand}, {name: lid, box: [1, 1, 1], link: b}");
  EXPECT_EQ(std::get<LoadSphere>(two.load("can")->shape).radius, 1.0);
  EXPECT_EQ(std::get<LoadSphere>(two.load("pot")->shape).radius, 2.0);
  EXPECT_EQ(two.load("cup"), nullptr);
  EXPECT_THROW(setup("{name: can, sphere: 1, link: hand, legs: [1]}"), std::invalid_argument);
  EXPECT_THROW(setup("{name: can, sphere: 1, link: a}, {name: can, sphere: 1, link: a}"),
               std::invalid_argument);
}

TEST(PicksOfQueries, HaveAPlaceAndAtMostOneGoal) {
  const auto query = [](const std::string& more) {
    return parse_setup(
               "queries:\n  - {name: q, start: [0], pick: {name: can, sphere: 0.1, link: hand, pose: [1, 0, "
               "0, 0, 0, 0], grasp: [0, 0, 0.1, 0, 0, 0]" +
                   more,
               "s.yaml")
        .queries.front();
  };
  const std::string place = ", place: [2, 0, 0, 0, 0, 0]}";
  EXPECT_EQ(query(place + "}").pick->map_from_place->translation().x(), 2.0);
  EXPECT_TRUE(query(place + "}").goals.empty());
  EXPECT_EQ(query(place + ", goals: [[1]]}").goals.size(), 1u);
  EXPECT_THROW(query("}}"), std::invalid_argument);
  EXPECT_THROW(query(place + ", goals: [[1], [2]]}"), std::invalid_argument);
  EXPECT_THROW(query(place + ", loads: [{name: a, sphere: 1, link: b}]}"), std::invalid_argument);
  EXPECT_THROW(query(place + ", goals: [[1, 2]]}"), std::invalid_argument);
}

TEST_F(LoadFiles, SayHowAnObjectIsTaken) {
  const PickSetup can = pick(
      "{name: can, sphere: 0.1, link: hand, pose: [1, 0, 0, 0, 0, 0], grasp: [0, 0, 0.1, 0, 0, 0], "
      "approach: [0.1, 0, 0], lift: 0.05}");
  EXPECT_EQ(can.map_from_object.translation().x(), 1.0);
  EXPECT_EQ(can.object_from_tip.translation().z(), 0.1);
  EXPECT_FALSE(can.map_from_place.has_value());
  const std::string taken =
      "{name: can, sphere: 0.1, link: hand, pose: [1, 0, 0, 0.1, 0.2, 0.3], grasp: [0, 0, 0.1, 0, 0, 0], ";
  for (const char* key : {"place", "place_deg"}) {  // three numbers keep the attitude, six say one
    const auto kept = pick(taken + key + ": [2, 3, 4]}"),
               turned = pick(taken + key + ": [2, 3, 4, 0, 0, 0]}");
    EXPECT_EQ(kept.map_from_place->translation(), Eigen::Vector3d(2, 3, 4));
    EXPECT_EQ(kept.map_from_place->linear(), kept.map_from_object.linear());
    EXPECT_TRUE(turned.map_from_place->linear().isIdentity(1e-12));
    EXPECT_THROW(pick(taken + key + ": [2, 3, 4, 0]}"), std::invalid_argument);
    EXPECT_THROW(pick(taken + key + ": 2}"), std::invalid_argument);
  }
  EXPECT_EQ(can.approach.x(), 0.1);
  EXPECT_EQ(can.lift, 0.05);
  EXPECT_EQ(can.contact, 0.0);
  EXPECT_THROW(pick("{name: can, sphere: 0.1, link: hand, pose: [1, 0, 0, 0, 0, 0]}"), std::invalid_argument);
  EXPECT_THROW(pick("{name: can, sphere: 0.1, link: hand, grasp: [1, 0, 0, 0, 0, 0]}"),
               std::invalid_argument);
}

}  // namespace load_setup_test
}  // namespace clearway
