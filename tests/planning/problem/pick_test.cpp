// What distinguishes picks, and what is none, on either side of each bound.
#include "planning/problem/pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/worlds/slide_robot.hpp"

namespace clearway {
namespace pick_test {

constexpr double resolution = 0.02, padding = 0.005;

Pick can() {
  Pick pick;
  pick.object.name = "can";
  pick.object.link = "carriage";
  pick.object.shape = Shape::cylinder(0.03, 0.12);
  pick.object.mass = 0.2;
  pick.object.touches = {"finger"};
  pick.map_from_object.translation() << 0.3, 0.1, 0.2;
  pick.map_from_place.translation() << 0.3, -0.1, 0.2;
  pick.margin = 0.01;
  pick.contact = 0.06;
  pick.grip["finger"] = {0.02, 0.01};
  return pick;
}

using Change = std::function<void(Pick&, double)>;

TEST(Pick, EachNumberButTheDepthDistinguishesPicksBeyondAMicrometre) {
  const std::map<std::string, Change> changes{
      {"object", [](Pick& pick, double by) { pick.map_from_object.translation().y() += by; }},
      {"object's turn",
       [](Pick& pick, double by) {
         pick.map_from_object.rotate(Eigen::AngleAxisd(by, Eigen::Vector3d::UnitX()));
       }},
      {"place", [](Pick& pick, double by) { pick.map_from_place.translation().z() -= by; }},
      {"grasp", [](Pick& pick, double by) { pick.object_from_tip.translation().x() -= by; }},
      {"approach", [](Pick& pick, double by) { pick.approach.x() += by; }},
      {"lift", [](Pick& pick, double by) { pick.lift += by; }},
      {"contact", [](Pick& pick, double by) { pick.contact -= by; }},
      {"margin", [](Pick& pick, double by) { pick.margin -= by; }},
      {"open", [](Pick& pick, double by) { pick.grip["finger"].open += by; }},
      {"closed", [](Pick& pick, double by) { pick.grip["finger"].closed -= by; }},
      {"mass", [](Pick& pick, double by) { pick.object.mass += by; }},
      {"shape", [](Pick& pick, double by) { pick.object.shape = Shape::cylinder(0.03, 0.12 + 2.0 * by); }}};
  for (const auto& [name, change] : changes)
    for (const double by : {0.0, 0.4e-6, 3e-6, 0.01}) {
      Pick other = can();
      change(other, by);
      EXPECT_EQ(is_same(can(), other), by < 1e-6) << name << ' ' << by;
      EXPECT_EQ(is_same(other, can()), by < 1e-6) << name << ' ' << by;
    }
  Pick deeper = can(), elsewhere = can();
  deeper.depth = 0.01;
  elsewhere.object.link_from_load.translation().x() = 1.0;  // is where the grasp has it
  EXPECT_TRUE(is_same(can(), deeper));
  EXPECT_TRUE(is_same(can(), elsewhere));
}

TEST(Pick, NamesAndWhatTouchesDistinguishPicks) {
  const std::map<std::string, std::function<void(Pick&)>> changes{
      {"name", [](Pick& pick) { pick.object.name = "jar"; }},
      {"link", [](Pick& pick) { pick.object.link = "rail"; }},
      {"touches", [](Pick& pick) { pick.object.touches.clear(); }},
      {"more touches", [](Pick& pick) { pick.object.touches.emplace_back("rail"); }},
      {"no grip", [](Pick& pick) { pick.grip.clear(); }},
      {"more grip",
       [](Pick& pick) {
         pick.grip["thumb"] = {0.0, 0.0};
       }},
      {"another joint", [](Pick& pick) {
         pick.grip = {{"thumb", {0.02, 0.01}}};
       }}};
  for (const auto& [name, change] : changes) {
    Pick other = can();
    change(other);
    EXPECT_FALSE(is_same(can(), other)) << name;
    EXPECT_FALSE(is_same(other, can())) << name;
  }
}

TEST(Pick, WhatIsNoneIsRefusedOnEitherSideOfEachBound) {
  const auto refusal = [](const Change& change, double value) {
    Pick pick = can();
    change(pick, value);
    try {
      require_sound(pick, resolution, padding);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  struct Bound {
    std::string field;
    double least, most;  ///< that are accepted
    Change change;
  };
  constexpr double shortest = resolution + padding, none = std::numeric_limits<double>::denorm_min();
  for (const Bound& bound : std::vector<Bound>{
           {"approach", none, 10.0,
            [](Pick&pick, double to) {
              pick.approach = {0.0, to, 0.0};
            }},
           {"margin", 0.0, 0.1, [](Pick&pick, double to) { pick.margin = to; }},
           {"depth", 0.0, 1.0, [](Pick&pick, double to) { pick.depth = to; }},
           {"lift", 0.06, 10.0, [](Pick&pick, double to) { pick.lift = to; }},
           {"contact", std::nextafter(shortest, 1.0), 0.1 + 2.0 * shortest, [](Pick&pick, double to) {
              pick.contact = to;
              pick.lift = 1.0;
            }}}) {
    const double below = bound.least == none ? 0.0 : bound.least - 1e-9;
    EXPECT_EQ(refusal(bound.change, std::max(bound.least, 1e-6)), "") << bound.field;
    EXPECT_EQ(refusal(bound.change, bound.most), "") << bound.field;
    for (const double wrong : {below, bound.most + 1e-9, std::nan(""), HUGE_VAL}) {
      EXPECT_NE(refusal(bound.change, wrong).find(", " + bound.field + ": expected "), std::string::npos)
          << bound.field << ' ' << wrong;
    }
  }
}

/// Both values are asked for, at either limit.
TEST(Pick, TheHandIsOpenAndClosedWithinItsLimits) {
  Robot robot = worlds::slide_robot();
  robot.joints.resize(2, robot.joints[0]);
  robot.joints[1].name = "finger";
  robot.joints[1].lower = 0.01, robot.joints[1].upper = 0.04;
  robot.links.push_back(robot.links[1]);
  robot.links[2].name = "finger";
  robot.links[2].parent = robot.links[2].joint = 1;
  const auto is_accepted = [&](double open, double closed) {
    Pick pick = can();
    pick.grip["finger"] = {open, closed};
    try {
      require_grip(robot, pick);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("expected values within its limits, 0.01 to 0.04"),
                std::string::npos);
      return false;
    }
    return true;
  };
  EXPECT_TRUE(is_accepted(0.04, 0.01));
  EXPECT_TRUE(is_accepted(0.01, 0.04));
  for (const double beyond : {0.04 + 1e-9, 0.01 - 1e-9, std::nan("")}) {
    EXPECT_FALSE(is_accepted(beyond, 0.02));
    EXPECT_FALSE(is_accepted(0.02, beyond));
  }
}

}  // namespace pick_test
}  // namespace clearway
