#include "planning/robot_files/allowed_collisions.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace contact_exemptions_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;
using worlds::UrdfRobot;
using Pairs = std::vector<std::pair<int, int>>;

/// A sphere that turns about the middle of one on the base, then slides out of it: they touch for the first
/// 0.2 m of `travel`.
UrdfRobot sliding_sphere(double travel) {
  const std::string sphere = "<sphere radius='0.1'/>";
  return {"slider",
          urdf_link("base", "0 0 0", sphere) + "<link name='turntable'/>" +
              urdf_link("hand", "0 0 0", sphere) +
              urdf_joint("turn", "revolute", "base", "turntable", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
              urdf_joint("slide", "prismatic", "turntable", "hand", "0 0 0", "1 0 0", urdf_limit(0, travel))};
}

TEST(AllowedCollisions, BodiesThatSometimesComeApartAreNotExemptHoweverOftenTheyTouch) {
  for (const double travel : {0.22, 0.25, 0.28, 0.35, 0.5}) {  // they touch in 91, 80, 71, 57 and 40 %
    const UrdfRobot slider = sliding_sphere(travel);
    EXPECT_TRUE(always_colliding_bodies(slider.robot()).empty()) << travel;
    EXPECT_TRUE(slider.robot().exempt.empty()) << travel;
  }
  const UrdfRobot within = sliding_sphere(0.19);
  EXPECT_EQ(always_colliding_bodies(within.robot()), (Pairs{{0, 1}}));
}

/// A ball that leaves a long box by its first centimetre alone, where every joint stands at 0.
TEST(AllowedCollisions, BodiesThatAreApartAtZeroAreNotExemptHoweverOftenTheyTouchElsewhere) {
  const std::string ball = "<sphere radius='0.05'/>";
  const auto pairs_of = [&](double middle) {
    const UrdfRobot robot(
        "tunnel",
        urdf_link("base", std::to_string(middle) + " 0 0", "<box size='0.2 0.2 2'/>") +
            urdf_link("turntable", "0 0 1", ball) + urdf_link("hand", "0 0 0", ball) +
            urdf_joint("turn", "revolute", "base", "turntable", "0 0 0", "1 0 0", urdf_limit(-1, 1)) +
            urdf_joint("slide", "prismatic", "turntable", "hand", "0 0 0", "1 0 0", urdf_limit(0, 1)));
    return always_colliding_bodies(robot.robot());
  };
  EXPECT_EQ(pairs_of(1.04), (Pairs{{0, 2}}));
  EXPECT_EQ(pairs_of(1.06), Pairs{});  // from 0.01 m on they touch
}

/// What nearly always touches is passed over in robots alone whose files say nothing of pairs.
TEST(AllowedCollisions, WhereSettingsListPairsNoOthersArePassedOver) {
  const TemporaryFolder folder;
  const std::string ball = "<sphere radius='0.1'/>";
  std::string text = "<robot name='row'>";
  for (const char* link : {"a", "b", "c"}) text += urdf_link(link, "0 0 0", ball);
  const std::string urdf = folder.write(
      "row.urdf", text + urdf_joint("1", "revolute", "a", "b", "0 0 0.05", "0 0 1", urdf_limit(-1, 1)) +
                      urdf_joint("2", "revolute", "b", "c", "0 0 0.05", "0 0 1", urdf_limit(-1, 1)) +
                      "</robot>");
  EXPECT_EQ(load_robot(urdf).exempt, (Pairs{{0, 1}, {0, 2}, {1, 2}}));
  folder.write("row.yaml", "exempt: []");
  EXPECT_EQ(load_robot(urdf).exempt, (Pairs{{0, 1}, {1, 2}}));
  folder.write("row.yaml", "exempt: [[c, a]]");
  EXPECT_EQ(load_robot(urdf).exempt, (Pairs{{0, 1}, {0, 2}, {1, 2}}));
}

TEST(AllowedCollisions, PairsOfPartsArePairsOfAllTheirBodiesAndOfNoBodyWithItself) {
  Robot robot;
  robot.links.resize(2);
  robot.links[0].name = "a link without bodies";
  for (const char* part : {"arm", "hand", "arm", "tool"}) robot.bodies.emplace_back().part = part;
  const auto pairs = [&](const std::string& first, const std::string& second) {
    Pairs found = bodies_of_parts(robot, {{first, second}}, "r.srdf");
    std::sort(found.begin(), found.end());
    return found;
  };
  EXPECT_EQ(pairs("arm", "hand"), (Pairs{{0, 1}, {1, 2}}));
  EXPECT_EQ(pairs("tool", "arm"), (Pairs{{0, 3}, {2, 3}}));
  EXPECT_EQ(pairs("hand", "tool"), (Pairs{{1, 3}}));
  EXPECT_EQ(pairs("tool", "tool"), Pairs{});
  EXPECT_EQ(pairs("tool", "a link without bodies"), Pairs{});
  EXPECT_THROW(pairs("arm", "leg"), std::invalid_argument);
}

TEST(AllowedCollisions, NoPairIsExemptThatTouchesInLessThanNineTenthsByFcl) {
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "puma560_miniature"}) {
    Robot robot = load_robot(name);
    const Pairs found = always_colliding_bodies(robot);
    for (const auto& pair : found) {
      Pairs others;
      for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a) {
        for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b)
          if (std::pair(a, b) != pair) others.emplace_back(a, b);
      }
      robot.exempt = others;  // so that the truth looks at this pair alone
      const FclTruth truth(robot, {}, 0.05);
      Random random(5);
      int touching = 0;
      for (int i = 0; i < 300; ++i)
        touching += truth.touches_itself(forward_kinematics(robot, random.configuration(robot)));
      EXPECT_GE(touching, 270) << name << " " << pair.first << " " << pair.second;
    }
  }
}

TEST(AllowedCollisions, SiblingsWithJointsOfTheirOwnAreNotNeighbours) {
  const UrdfRobot pair = worlds::scissors();
  EXPECT_TRUE(adjacent_bodies(pair.robot()).empty());
  EXPECT_TRUE(pair.robot().exempt.empty());
  // With bodies on the base and on what is fixed to an arm: each arm to the base, the fixed one to its arm;
  // the arms and what they carry still not to each other.
  const std::string sphere = "<sphere radius='0.02'/>";
  const UrdfRobot more(
      "more", urdf_link("base", "0 0 0", sphere) + urdf_link("left", "0 0 0", sphere) +
                  urdf_link("right", "0 0 0", sphere) + urdf_link("tool", "0 0 0", sphere) +
                  urdf_joint("l", "revolute", "base", "left", "-0.5 0 0", "0 0 1", urdf_limit(-1, 1)) +
                  urdf_joint("r", "revolute", "base", "right", "0.5 0 0", "0 0 1", urdf_limit(-1, 1)) +
                  urdf_joint("f", "fixed", "left", "tool", "0.3 0 0", "0 0 1", ""));
  const auto index = [&](const std::string& part) {
    for (std::size_t i = 0; i < more.robot().bodies.size(); ++i)
      if (more.robot().bodies[i].part == part) return static_cast<int>(i);
    return -1;
  };
  const auto sorted = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
  const int base = index("base"), left = index("left"), right = index("right"), tool = index("tool");
  Pairs expected{sorted(base, left), sorted(base, right), sorted(left, tool)};
  std::sort(expected.begin(), expected.end());
  Pairs found = adjacent_bodies(more.robot());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

/// A tool of which one body sweeps a ring about the joint, past a post that stands `post` from its axis.
TEST(AllowedCollisions, PairsAreProvedToStayApartOnlyWhereTheyDo) {
  Random random(41);
  int apart = 0, meeting = 0;
  for (int i = 0; i < 120; ++i) {
    const double post = random.between(0.2, 0.7), lower = random.between(-3.0, 0.0),
                 upper = random.between(0.0, 3.0), turned = random.between(-3.0, 3.0);
    const worlds::Ring ring(i % 3 == 0 ? "prismatic" : "revolute", lower, upper, post, turned);
    const std::pair<int, int> pair = ring.post_and_tool();
    const double least = ring.least_distance();
    const Pairs proved = never_meeting_bodies(ring.robot());
    const bool is_proved = std::find(proved.begin(), proved.end(), pair) != proved.end();
    EXPECT_TRUE(least > 0.0 || !is_proved) << i;
    EXPECT_TRUE(least <= 0.02 || is_proved) << i << " " << least;
    apart += least > 0.02;
    meeting += least <= 0.0;
  }
  EXPECT_GT(apart, 15);
  EXPECT_GT(meeting, 15);
}

/// Two balls about a joint that follows another at a part of its turns: they meet at one angle of it.
TEST(AllowedCollisions, OfAnEndlessJointThatFollowsSlowlyAWholeTurnIsLookedAt) {
  for (const double multiplier : {0.5, -0.25, 1.0, 3.0}) {
    // Met after almost half a turn.
    const UrdfRobot geared = worlds::geared(multiplier, "0.05", "-0.3 0.05 1", "0.3 0.05 0");
    const Robot& robot = geared.robot();
    const auto is_between = [&](const std::pair<int, int>& pair) {
      const std::string &first = robot.bodies[static_cast<std::size_t>(pair.first)].part,
                        &second = robot.bodies[static_cast<std::size_t>(pair.second)].part;
      return (first == "a" && second == "b") || (first == "b" && second == "a");
    };
    EXPECT_EQ(std::count_if(robot.exempt.begin(), robot.exempt.end(), is_between), 0) << multiplier;
  }
}

/// Balls that touch in a quarter of a whole turn, which the joint that leads them is slow to make.
TEST(AllowedCollisions, SamplesOfAnEndlessJointReachAllThatFollowsIt) {
  const UrdfRobot geared = worlds::geared(0.25, "0.13", "0.3 0 1", "0.3 0 0");
  for (const auto& [a, b] : always_colliding_bodies(geared.robot()))
    EXPECT_FALSE(geared.robot().bodies[static_cast<std::size_t>(a)].part == "a" &&
                 geared.robot().bodies[static_cast<std::size_t>(b)].part == "b");
  const LinkPoses poses = forward_kinematics(geared.robot(), Configuration::Constant(1, 0.0));
  EXPECT_LT((poses[static_cast<std::size_t>(geared.robot().bodies[3].link)].translation() -
             poses[static_cast<std::size_t>(geared.robot().bodies[4].link)].translation())
                .norm(),
            0.26);  // they do touch there
}

/// A turret: a tool fixed to its arm turns through a post that is fixed beside its base.
TEST(AllowedCollisions, WhatIsFixedToNeighboursIsTestedUnlessNothingElseIsBetweenThem) {
  const auto turret = [](bool base_has_body, bool arm_has_body, double post) {
    const auto link = [](const char* name, bool has_body) {
      return has_body ? urdf_link(name, "0 0 0", "<sphere radius='0.05'/>")
                      : "<link name='" + std::string(name) + "'/>";
    };
    return UrdfRobot(
        "turret", link("base", base_has_body) + link("arm", arm_has_body) +
                      urdf_link("post", "0 0 0", "<sphere radius='0.05'/>") +
                      urdf_link("tool", "0.2 0 0", "<box size='0.04 0.04 0.4'/>") +
                      urdf_joint("p", "fixed", "base", "post", std::to_string(post) + " 0 0.3", "0 0 1", "") +
                      urdf_joint("j", "revolute", "base", "arm", "0 0 0.3", "0 0 1", urdf_limit(-3, 3)) +
                      urdf_joint("t", "fixed", "arm", "tool", "0 0 0", "0 0 1", ""));
  };
  const auto is_exempt = [](const Robot& robot, const std::string& a, const std::string& b) {
    return std::any_of(robot.exempt.begin(), robot.exempt.end(), [&](const auto& pair) {
      const std::string& first = robot.bodies[static_cast<std::size_t>(pair.first)].part;
      const std::string& second = robot.bodies[static_cast<std::size_t>(pair.second)].part;
      return (first == a && second == b) || (first == b && second == a);
    });
  };
  const UrdfRobot full = turret(true, true, 0.35);
  EXPECT_FALSE(is_exempt(full.robot(), "post", "tool"));  // they meet in a tenth of a turn
  EXPECT_TRUE(is_exempt(full.robot(), "base", "arm"));
  EXPECT_TRUE(is_exempt(full.robot(), "arm", "tool"));
  const UrdfRobot bare_arm = turret(true, false, 0.35);
  EXPECT_TRUE(is_exempt(bare_arm.robot(), "base", "tool"));  // the flange is the tool's
  EXPECT_FALSE(is_exempt(bare_arm.robot(), "post", "tool"));
  const UrdfRobot overlapping = turret(true, true, 0.0);
  EXPECT_TRUE(is_exempt(overlapping.robot(), "post", "tool"));  // wherever the joint stands
  const UrdfRobot bare_base = turret(false, true, 0.35);
  EXPECT_FALSE(is_exempt(bare_base.robot(), "post", "tool"));

  FreeSpaceMap map({.resolution = 0.05});
  const ConfigurationSpace space(full.robot(), map.snapshot(), {.critical_by_default = false});
  EXPECT_FALSE(space.is_free(Configuration::Constant(1, 0.0)));
  EXPECT_TRUE(space.is_free(Configuration::Constant(1, 1.0)));
  EXPECT_FALSE(space.is_edge_free(Configuration::Constant(1, -1.0), Configuration::Constant(1, 1.0)));
  EXPECT_TRUE(space.is_edge_free(Configuration::Constant(1, 0.6), Configuration::Constant(1, 2.0)));
}

}  // namespace contact_exemptions_test
}  // namespace clearway
