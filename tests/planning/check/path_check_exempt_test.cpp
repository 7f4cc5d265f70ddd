// Which pairs of bodies the check passes over for reasons of its own.
#include <gtest/gtest.h>

#include <algorithm>

#include "planning/check/path_check.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace path_check_exempt_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;
using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

struct Checked {
  explicit Checked(const Robot& given) : robot(given), arm(robot), bodies(robot) {}
  Pairs justified() const { return check::justified_exemptions(robot, arm, bodies); }

  Robot robot;
  check::KdlArm arm;
  check::FclBodies bodies;
};

void exempt_all(Robot& robot) {
  robot.exempt.clear();
  for (int a = 0; a < static_cast<int>(robot.bodies.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(robot.bodies.size()); ++b) robot.exempt.emplace_back(a, b);
}

TEST(PathCheckExempt, EveryPairThatARobotsFilesExemptHasAReasonOrNeverMeets) {
  Random random(8);
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  std::vector<Robot> robots{whip.robot(), telescope.robot(), rack.robot()};
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "puma560_miniature"})
    robots.push_back(load_robot(name));
  for (const Robot& robot : robots) {
    const Checked checked(robot);
    const Pairs justified = checked.justified();
    for (const auto& [first, second] : robot.exempt) {
      const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
      if (justified.contains({a, b}) || !checked.arm.may_touch(a, b)) continue;
      for (int i = 0; i < 400; ++i) {
        const Configuration q = random.configuration(robot);
        ASSERT_GT(checked.bodies.distance(a, checked.arm.place(q, a), b, checked.arm.place(q, b)), 1e-4)
            << robot.name << ": " << robot.bodies[a].part << " " << robot.bodies[b].part;
      }
    }
  }
}

/// Whatever a robot in memory says: a pair that is at times apart and at times touching is looked at.
TEST(PathCheckExempt, NoPairThatMeetsIsPassedOver) {
  Random random(9);
  int refused = 0;
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          scissors = worlds::scissors(), rack = worlds::rack_and_pinion();
  std::vector<Robot> robots{whip.robot(), telescope.robot(), scissors.robot(), rack.robot()};
  for (const char* name : {"puma560", "arm5", "arm6"}) robots.push_back(load_robot(name));
  for (Robot& robot : robots) {
    const auto honest = robot.exempt;
    exempt_all(robot);
    const Checked checked(robot);
    const Pairs justified = checked.justified();
    for (const auto& pair : robot.exempt) {
      if (std::find(honest.begin(), honest.end(), pair) != honest.end()) continue;
      const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
      for (int i = 0; i < 400; ++i) {
        const Configuration q = random.configuration(robot);
        if (!checked.bodies.touch(a, checked.arm.place(q, a), b, checked.arm.place(q, b))) continue;
        EXPECT_FALSE(justified.contains({a, b})) << robot.name << " " << a << " " << b;
        EXPECT_FALSE(check_path(robot, Snapshot(), {}, 0.0, {q}).valid) << robot.name << " " << a << " " << b;
        ++refused;
        break;
      }
    }
  }
  EXPECT_GT(refused, 10);
}

/// A robot that is made in memory, whose exempt pairs are taken at their word.
TEST(PathCheckExempt, PairsOfBodiesThatTheRobotDoesNotHaveAreLeftOut) {
  Robot robot = worlds::whip().robot();
  robot.source.clear();
  robot.srdf.clear();
  exempt_all(robot);
  const Pairs honest = Checked(robot).justified();
  ASSERT_FALSE(honest.empty());
  const int bodies = static_cast<int>(robot.bodies.size());
  for (int body = 0; body < bodies; ++body)
    for (const int beyond : {bodies, bodies + 1}) robot.exempt.emplace_back(body, beyond);
  EXPECT_EQ(Checked(robot).justified(), honest);
}

TEST(PathCheckExempt, PairsStayApartOnlyWhereTheyDo) {
  Random random(43);
  int apart = 0, meeting = 0;
  for (int i = 0; i < 60; ++i) {
    const double post = random.between(0.2, 0.7), lower = random.between(-3.0, 0.0),
                 upper = random.between(0.0, 3.0), turned = random.between(-3.0, 3.0);
    const worlds::Ring ring(i % 3 == 0 ? "prismatic" : "revolute", lower, upper, post, turned);
    Robot robot = ring.robot();
    exempt_all(robot);
    const bool passed_over = Checked(robot).justified().contains(ring.post_and_tool());
    const double least = ring.least_distance();
    EXPECT_TRUE(least > 0.0 || !passed_over) << i;
    EXPECT_TRUE(least <= 0.02 || passed_over) << i << " " << least;
    apart += least > 0.02;
    meeting += least <= 0.0;
  }
  EXPECT_GT(apart, 8);
  EXPECT_GT(meeting, 8);
}

/// Balls that meet at one angle of a joint that follows another slowly, or touch for a quarter of its turn.
TEST(PathCheckExempt, OfAnEndlessJointThatFollowsSlowlyAWholeTurnIsLookedAt) {
  for (const double multiplier : {0.25, -0.5, 1.0}) {
    for (const char* at : {"-0.3 0.05 1", "0.3 0 1"}) {
      const worlds::UrdfRobot geared = worlds::geared(multiplier, "0.13", at, "0.3 0 0");
      Robot robot = geared.robot();
      exempt_all(robot);
      const Checked checked(robot);
      for (const auto& [first, second] : checked.justified())
        EXPECT_FALSE(robot.bodies[first].part == "a" && robot.bodies[second].part == "b") << multiplier << at;
    }
  }
}

/// A ball that slides away from another one, which it touches on a share of the way, wherever its joint's
/// values begin.
TEST(PathCheckExempt, APairThatTouchesInNearlyAllConfigurationsIsPassedOver) {
  const std::string ball = "<sphere radius='0.2'/>";
  for (const double share : {0.05, 0.5, 0.8, 0.85, 0.95, 0.98, 1.0}) {
    for (const double begin : {0.0, 0.35, -0.6}) {
      const std::string to_zero = std::to_string(-begin) + " 0 0",
                        limits = urdf_limit(begin, begin + 0.4 / share);
      const worlds::UrdfRobot slide(
          "slide", urdf_link("base", "0 0 -5", ball) + urdf_link("post", "0 0 0", ball) +
                       urdf_link("carriage", "0 0 5", ball) + urdf_link("tool", "0 0 0", ball) +
                       urdf_joint("p", "fixed", "base", "post", "0 0 0", "0 0 1", "") +
                       urdf_joint("x", "prismatic", "base", "carriage", to_zero, "1 0 0", limits) +
                       urdf_joint("t", "fixed", "carriage", "tool", "0 0 0", "0 0 1", ""));
      Robot robot = slide.robot();
      exempt_all(robot);
      std::set<std::string> passed_over;
      for (const auto& [first, second] : Checked(robot).justified())
        passed_over.insert(robot.bodies[first].part + " " + robot.bodies[second].part);
      EXPECT_EQ(passed_over.contains("post tool"), share > 0.9) << share << " from " << begin;
      EXPECT_TRUE(passed_over.contains("base carriage")) << share << " from " << begin;
    }
  }
}

/// A ball whose way leads into a plate by a hundredth of its length: the looks do not come to where they
/// meet.
TEST(PathCheckExempt, APairThatTakesTooManyLooksIsNotHeldApart) {
  const std::string ball = "<sphere radius='0.05'/>", plate = "<box size='0.02 0.5 4'/>";
  const worlds::UrdfRobot ramp(
      "ramp",
      urdf_link("base", "0 0 -5", ball) + urdf_link("post", "0 0 0", plate) +
          urdf_link("carriage", "0 0 5", ball) + urdf_link("tool", "0 0 0.06", ball) +
          urdf_joint("p", "fixed", "base", "post", "0 0 0", "0 0 1", "") +
          urdf_joint("x", "prismatic", "base", "carriage", "0 0 0", "1 0 0.01", urdf_limit(-0.2, 0.8)) +
          urdf_joint("t", "fixed", "carriage", "tool", "0 0 0", "0 0 1", ""));
  Robot robot = ramp.robot();
  exempt_all(robot);
  for (const auto& [first, second] : Checked(robot).justified())
    EXPECT_FALSE(robot.bodies[first].part == "post" && robot.bodies[second].part == "tool");
  EXPECT_TRUE(check_path(robot, Snapshot(), {}, 0.0, {Configuration::Constant(1, 0.1)}).valid);
  EXPECT_FALSE(check_path(robot, Snapshot(), {}, 0.0, {Configuration::Constant(1, -0.1)}).valid);
}

/// A rod on a turntable, with a post beside it and a ball above it that only meets it by the lift.
TEST(PathCheckExempt, WhatTheFilesSayIsReadAgain) {
  TemporaryFolder folder;
  const std::string ball = "<sphere radius='0.05'/>";
  const std::string urdf = folder.write(
      "lift.urdf",
      "<robot name='lift'>" + urdf_link("base", "0 0 -1", ball) + urdf_link("post", "0 0 0", ball) +
          urdf_link("carriage", "0 0 1", ball) + urdf_link("rod", "0.3 0 0", "<box size='0.04 0.04 0.6'/>") +
          urdf_joint("p", "fixed", "base", "post", "0.4 0 0.5", "0 0 1", "") +
          urdf_joint("up", "prismatic", "base", "carriage", "0 0 0", "0 0 1", urdf_limit(0, 1)) +
          urdf_joint("turn", "revolute", "carriage", "rod", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
          "</robot>");
  const auto verdict = [&](const Robot& robot) {
    const Configuration meets = (Configuration(2) << 0.5, 0.0).finished();
    return check_path(robot, Snapshot(), {}, 0.0, {meets});
  };
  EXPECT_FALSE(verdict(load_robot(urdf)).valid);
  const auto write = [&](const std::string& inside) {
    folder.write("lift.srdf", "<robot name='lift'>" + inside + "</robot>");
  };
  const std::string off = "<disable_default_collisions link='rod'/>";
  const std::string other = "<disable_collisions link1='base' link2='rod'/>";
  for (const auto& [text, is_valid] :
       {std::pair(std::string("<disable_collisions link1='rod' link2='post'/>"), true), std::pair(off, true),
        std::pair(off + "<enable_collisions link1='post' link2='rod'/>", false), std::pair(other, false)}) {
    write(text);
    const Robot robot = load_robot(urdf);
    EXPECT_EQ(verdict(robot).valid, is_valid) << text;
    write(other);  // what the file says when the check reads it counts
    EXPECT_FALSE(verdict(robot).valid) << text;
  }
  write(off);
  const Robot before = load_robot(urdf);
  EXPECT_TRUE(verdict(before).valid);
  write(off + "<enable_collisions link1='rod' link2='post'/>");
  EXPECT_FALSE(verdict(before).valid);
  write(other);
  folder.write("lift.yaml", "exempt: [[rod, post]]");
  const Robot robot = load_robot(urdf);
  EXPECT_TRUE(verdict(robot).valid);
  folder.write("lift.yaml", "exempt: [[rod, base]]");
  EXPECT_FALSE(verdict(robot).valid);
  folder.write("lift.yaml", "exempt: [[rod");
  EXPECT_NE(verdict(robot).first_contact.find("is no settings file"), std::string::npos);
}

}  // namespace path_check_exempt_test
}  // namespace clearway
