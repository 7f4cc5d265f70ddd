#include "apps/sensed_spaces.hpp"

#include <gtest/gtest.h>

#include "apps/suite_teams.hpp"

namespace clearway {
namespace {

/// A disc on a plane and a box that a sensor sees go past it.
struct Passing {
  SuiteTeam given;
  SuiteSensing sensing{{{-1.0, 0.0, 0.02}}, 3.0, 0.05, 10.0, 0.25};
  std::map<std::string, std::string> policies;
  Team team;

  Passing() {
    given.name = "passing";
    given.robots.push_back({"disc", "point", {}, 0.0, {}, {0.0, 0.0}, {0.0, 0.0}});
    SuiteMoving box;
    box.shape.name = "box";
    box.shape.geometry = BoxShape{{0.1, 0.4, 0.1}};
    Eigen::Isometry3d from = Eigen::Isometry3d::Identity(), to = from;
    from.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
    to.translation() = Eigen::Vector3d(0.5, 0.0, 0.0);
    box.path = {{0.0, from}, {1.0, from}, {1.1, to}};
    box.is_sensed = true;
    given.moving.push_back(box);
    team = make_team(given, empty_map(), policies);
  }
};

bool is_occupied(const ConfigurationSpace& space, double x) {
  return space.map().state(Eigen::Vector3d(x, 0.01, 0.01)) == VoxelState::occupied;
}

TEST(SensedSpaces, WhatMovedIsKnownWhenTheLatencyIsOver) {
  const Passing scene;
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, scene.policies);
  EXPECT_TRUE(is_occupied(*spaces.at(0, 0.0), 0.96));  // its face, seen at once
  EXPECT_FALSE(is_occupied(*spaces.at(0, 1.2), 0.46));
  // It stands at its new place from 1.1 s on; scans every 0.1 s are known 0.25 s later.
  EXPECT_FALSE(is_occupied(*spaces.at(0, 1.30), 0.46));
  EXPECT_TRUE(is_occupied(*spaces.at(0, 1.40), 0.46));
  const Configuration near = Eigen::Vector2d(0.3, 0.0);
  EXPECT_FALSE(spaces.at(0, 1.5)->is_free(near));
  EXPECT_TRUE(scene.team.robots[0].space->is_free(near));  // what it knew before anything was seen
}

TEST(SensedSpaces, BetweenScansRobotsKeepTheSameMap) {
  const Passing scene;
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, scene.policies);
  const auto first = spaces.at(0, 0.36);
  EXPECT_EQ(spaces.at(0, 0.44), first);
  EXPECT_NE(spaces.at(0, 0.46), first);
}

}  // namespace
}  // namespace clearway
