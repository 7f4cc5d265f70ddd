// Of every door of the check: what was seen too long ago blocks, and an age that nobody can tell is refused
// before a verdict.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "mapping/stamps/seen_stamps.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/motion_check.hpp"
#include "planning/check/spline_check.hpp"
#include "planning/path/smooth_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/planning/check/ball_errand.hpp"
#include "tests/worlds/map_of_looks.hpp"

namespace clearway {
namespace check_ages_test {

using worlds::looked_at_edge;

/// Free round about the map's origin, as seen at 2.5 s; the newest look is of 15 s.
Snapshot map_of_looks() {
  return worlds::map_of_looks({{Eigen::Vector3d::Constant(looked_at_edge / 2), 2.5}});
}

/// Whether a short way of the disc is valid there, by each of the doors.
using Door = std::function<bool(const Snapshot& map, Policy policy, double seen_within)>;

std::map<std::string, Door> doors() {
  const Robot disc = load_robot("point");
  const Configuration from = Eigen::Vector2d::Constant(looked_at_edge / 2),
                      to = from + Configuration::Unit(2, 0) * looked_at_edge;
  const auto of = [](Policy policy) { return std::map<std::string, Policy>{{"base", policy}}; };
  const SmoothMotion made = smooth_motion(
      ConfigurationSpace(disc, Snapshot(), {.parts = {}, .critical_by_default = false}), {{from, to}});
  const auto errand = std::make_shared<ball_errand::BallErrand>(0.05, 0.2, 0.15);
  const SmoothMotion carried = smooth_motion(
      ConfigurationSpace(errand->robot, Snapshot(), {.parts = {}, .critical_by_default = false}),
      errand->legs);
  std::vector<Configuration> stops{errand->legs[0].front()};
  for (const auto& leg : errand->legs) stops.push_back(leg.back());
  return {
      {"path",
       [=](const Snapshot& map, Policy policy, double seen_within) {
         return check_path(disc, map, of(policy), 0.0, {from, to}, 0.0, seen_within).valid;
       }},
      {"legs",
       [=](const Snapshot& map, Policy policy, double seen_within) {
         return check_legs({{disc, map, {from, to}}}, of(policy), 0.0, 0.0, seen_within).valid;
       }},
      {"motion",
       [=](const Snapshot& map, Policy policy, double seen_within) {
         return check_motion(disc, map, of(policy), 0.0, made.motion, made.leg_ends, {from, to},
                             rate_limits(disc), seen_within)
             .valid;
       }},
      {"splines",
       [=](const Snapshot& map, Policy policy, double seen_within) {
         return check_splines(disc, map, of(policy), 0.0, {{0.0, from}, {1.0, to}}, seen_within).is_valid();
       }},
      {"pick",
       [=](const Snapshot& map, Policy policy, double seen_within) {
         return check_pick(errand->stated(map), {{"hand", policy}}, 0.0, seen_within).valid;
       }},
      {"pick motion", [=](const Snapshot& map, Policy policy, double seen_within) {
         const RateLimits limits = rate_limits(errand->robot);
         const MotionToCheck moved{carried.motion, carried.leg_ends, stops, limits};
         return check_pick_motion(errand->stated(map), moved, {{"hand", policy}}, 0.0, seen_within).valid;
       }}};
}

TEST(CheckAges, WhatWasSeenTooLongAgoIsRefusedByEachDoor) {
  const Snapshot map = map_of_looks();
  for (const auto& [name, is_valid] : doors()) {
    EXPECT_TRUE(is_valid(map, Policy::known_free, 0.0)) << name;
    EXPECT_TRUE(is_valid(map, Policy::known_free, 13.0)) << name;
    EXPECT_FALSE(is_valid(map, Policy::known_free, 12.0)) << name;
  }
}

TEST(CheckAges, AnAgeThatNobodyCanTellIsRefusedByEachDoor) {
  const Snapshot map = map_of_looks();
  for (const auto& [name, is_valid] : doors()) {
    for (const double age : {-1.0, std::nan(""), HUGE_VAL, map.seen()->period() / 2})
      EXPECT_THROW(is_valid(map, Policy::known_free, age), std::invalid_argument) << name << age;
    EXPECT_THROW(is_valid(Snapshot(), Policy::known_free, 12.0), std::invalid_argument) << name;
    for (const Policy policy : {Policy::painted, Policy::not_occupied})
      EXPECT_THROW(is_valid(map, policy, 13.0), std::invalid_argument) << name;
  }
}

}  // namespace check_ages_test
}  // namespace clearway
