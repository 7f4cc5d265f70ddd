#include "apps/suites/sensed_spaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "apps/compare/team_result.hpp"
#include "apps/suites/suite_teams.hpp"
#include "apps/suites/suite_world.hpp"

namespace clearway {
namespace sensed_spaces_test {

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
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, empty_map(), scene.policies);
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
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, empty_map(), scene.policies);
  const auto first = spaces.at(0, 0.36);
  EXPECT_EQ(spaces.at(0, 0.44), first);
  EXPECT_NE(spaces.at(0, 0.46), first);
}

SceneShape box_at(const Eigen::Vector3d& size, const Eigen::Vector3d& center) {
  SceneShape shape;
  shape.name = "box";
  shape.geometry = BoxShape{size};
  shape.map_from_shape.translation() = center;
  return shape;
}

/// A disc that stands at its goal, and a box that one sensor sees come near it and go away again.
struct Approach {
  SuiteTeam given;
  SuiteSensing sensing{{{0.0, -0.8, 0.02}}, 2.0, 0.05, 5.0, 0.1};
  std::map<std::string, std::string> policies;
  SuiteWorld world;
  Snapshot map;
  static constexpr double goal_x = 0.3;

  Approach() {
    given.name = "approach";
    given.robots.push_back({"disc", "point", {}, 0.0, {}, {-0.3, 0.0}, {goal_x, 0.0}});
    SuiteMoving box;
    box.shape = box_at(Eigen::Vector3d(0.3, 0.1, 0.3), Eigen::Vector3d::Zero());
    const auto pose_at = [](double y) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = Eigen::Vector3d(goal_x, y, 0.0);
      return pose;
    };
    box.path = {{0.0, pose_at(1.1)}, {18.0, pose_at(0.2)}, {22.0, pose_at(0.4)}};
    box.is_sensed = true;
    given.moving.push_back(box);
    world.name = "place";
    world.resolution = 0.05;
    world.sensor_range = 2.6;
  }

  /// A wall that the disc must not be driven into, in a map that was saved and is loaded.
  void load() {
    world.solids = {box_at(Eigen::Vector3d(2.0, 0.1, 0.4), Eigen::Vector3d(0.0, -0.75, 0.0))};
    world.sensors = {{0.0, 0.5, 0.02}, {0.0, -1.1, 0.02}};
    map = make_map(world, {});
    world.solids.clear();
    world.sensors.clear();
    world.map = "a file that was loaded";
    sensing.sensors = {{-0.5, -0.55, 0.02}};
  }

  /// Paint about the disc and where the box comes.
  void paint() {
    SuiteVolume volume;
    volume.label = "free";
    auto& stroke = volume.strokes.emplace_back();
    for (int x = -6; x <= 6; ++x)
      for (int y = -6; y <= 4; ++y) stroke.push_back({Eigen::Vector3d(0.1 * x, 0.1 * y, 0.0), 0.3});
    world.volumes.push_back(volume);
    map = make_map(world, {});
  }

  struct Outcome {
    TeamRun run;
    TeamVerdict verdict;
    std::string check;
    bool gave_way = false;  ///< the disc left its goal
    Snapshot map;           ///< at the end
  };

  Outcome run() const {
    Team team = make_team(given, map, policies);
    SensedSpaces spaces(team, given.moving, sensing, world, map, policies);
    team.sensed = [&](std::size_t robot, double time) { return spaces.at(robot, time); };
    TeamOptions options =
        team_options("constraint", {{"influence_distance", "0.25"}, {"security_distance", "0.06"}});
    options.duration = 24.0;
    Outcome found;
    found.run = run_team(team, options);
    found.verdict = check_team(team, found.run, options.max_acceleration, 0.5);
    const double unseen = team.obstacles[0].greatest_speed() * (sensing.latency + 1.0 / sensing.rate_hz);
    found.check = team_result(team, found.run, found.verdict, {.unseen_motion = unseen}).check;
    for (const Configuration& q : found.run.traces[0].positions)
      found.gave_way = found.gave_way || q.y() < -0.05;
    found.map = spaces.map();
    return found;
  }
};

void expect_kept(const Approach::Outcome& found) {
  EXPECT_TRUE(found.run.outrun.empty()) << found.run.outrun;
  EXPECT_EQ(found.check, "valid") << found.verdict.contact << found.verdict.between;
  EXPECT_GT(found.verdict.least_separation, 0.03);  // d_s is 6 cm, a scan is known after 1.5 cm of the way
  EXPECT_TRUE(found.gave_way);
}

TEST(SensedSpaces, InALoadedMapARobotGivesWayToWhatIsSeenAndKeepsFromWhatWasLoaded) {
  Approach scene;
  scene.load();
  const Approach::Outcome found = scene.run();
  expect_kept(found);
  // What the loaded map holds stands still, and is not seen away however long sensors look.
  std::size_t walls = 0;
  scene.map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::occupied) return;
    ++walls;
    EXPECT_EQ(found.map.state(leaf.center), VoxelState::occupied) << leaf.center.transpose();
  });
  EXPECT_GT(walls, 100U);
}

TEST(SensedSpaces, InAPaintedMapARobotThatMustStayInPaintGivesWayToWhatIsSeenThere) {
  Approach scene;
  scene.paint();
  scene.policies["base"] = "painted";
  const Approach::Outcome found = scene.run();
  expect_kept(found);
  EXPECT_GT(found.map.counts().conflict, 0U);  // the box's face, in paint
}

TEST(SensedSpaces, PaintIsAConflictWhereAnObstacleIsSeenAndPaintAgainAfterIt) {
  Approach scene;
  scene.paint();
  Team team = make_team(scene.given, scene.map, scene.policies);
  Eigen::Isometry3d near = Eigen::Isometry3d::Identity(), far = near;
  near.translation() = Eigen::Vector3d(0.3, 0.225, 0.0);
  far.translation() = Eigen::Vector3d(0.3, 1.1, 0.0);
  team.obstacles[0].motion = RigidMotion({{0.0, near}, {1.0, near}, {1.1, far}});
  SensedSpaces spaces(team, scene.given.moving, scene.sensing, scene.world, scene.map, scene.policies);
  const Eigen::Vector3d face(0.31, 0.175, 0.01);
  EXPECT_EQ(scene.map.state(face), VoxelState::painted);
  EXPECT_EQ(spaces.at(0, 0.5)->map().state(face), VoxelState::conflict);
  EXPECT_EQ(spaces.at(0, 1.2)->map().state(face), VoxelState::conflict);
  EXPECT_EQ(spaces.at(0, 4.0)->map().state(face), VoxelState::painted);
  EXPECT_EQ(scene.map.state(face), VoxelState::painted);  // the world's own map is not touched
}

/// The box stands against a wall, or on it, and goes away: what of it is left in the map.
std::size_t left_over(const Approach& scene, double y) {
  Team team = make_team(scene.given, scene.map, scene.policies);
  Eigen::Isometry3d near = Eigen::Isometry3d::Identity(), far = near;
  near.translation() = Eigen::Vector3d(0.3, y, 0.0);
  far.translation() = Eigen::Vector3d(0.3, 1.1, 0.0);
  team.obstacles[0].motion = RigidMotion({{0.0, near}, {1.0, near}, {1.1, far}});
  SensedSpaces spaces(team, scene.given.moving, scene.sensing, scene.world, scene.map, scene.policies);
  const auto count_near = [&](double time) {
    spaces.at(0, time);
    const std::vector<Eigen::Vector3d>& seen = spaces.seen_anew().back().voxels;
    return std::count_if(seen.begin(), seen.end(), [](const Eigen::Vector3d& at) { return at.y() < 0.8; });
  };
  EXPECT_GT(count_near(0.9), 10);
  return static_cast<std::size_t>(count_near(6.0));
}

TEST(SensedSpaces, NothingIsLeftOfWhatLayAgainstAWall) {
  Approach loaded;
  loaded.load();  // a wall up to y = -0.7
  EXPECT_EQ(left_over(loaded, -0.64), 0U);
  Approach made;
  made.world.solids = {box_at(Eigen::Vector3d(2.0, 0.1, 0.4), Eigen::Vector3d(0.0, -0.76, 0.0))};
  made.world.sensors = {{0.0, 0.5, 0.02}, {0.0, -1.1, 0.02}};
  made.map = make_map(made.world, {});
  made.sensing.sensors = {{-0.5, -0.55, 0.02}};
  EXPECT_EQ(left_over(made, -0.64), 0U);
}

TEST(SensedSpaces, WhatIsSeenAnewIsReportedChangeByChange) {
  const Passing scene;
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, empty_map(), scene.policies);
  const auto is_seen = [&](const SeenAnew& seen, double x) {
    return std::any_of(seen.voxels.begin(), seen.voxels.end(), [&](const Eigen::Vector3d& voxel) {
      return (voxel - Eigen::Vector3d(x, 0.025, 0.025)).cwiseAbs().maxCoeff() < 0.03;
    });
  };
  for (int k = 0; k <= 300; ++k) spaces.at(0, 0.02 * k);
  const std::vector<SeenAnew>& all = spaces.seen_anew();
  EXPECT_EQ(all.front().time, 0.0);
  EXPECT_TRUE(is_seen(all.front(), 0.975));
  EXPECT_FALSE(is_seen(all.front(), 0.475));
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_GT(all[i].time, all[i - 1].time);
    EXPECT_NE(all[i].voxels, all[i - 1].voxels);
    EXPECT_EQ(is_seen(all[i], 0.475), all[i].time > 1.34) << all[i].time;
  }
  // Every one of them is blocked in the map of that time, and nothing else is: there was nothing before.
  std::size_t blocked = 0;
  spaces.map().visit_leaves([&](const Voxel& leaf) { blocked += leaf.state == VoxelState::occupied; });
  EXPECT_EQ(all.back().voxels.size(), blocked);
  for (const Eigen::Vector3d& voxel : all.back().voxels)
    EXPECT_EQ(spaces.map().state(voxel), VoxelState::occupied);
}

TEST(SensedSpaces, AMapsAgeIsBetweenTheLatencyAndOneScanMore) {
  const Passing scene;  // ten scans a second, known after 0.25 s
  SensedSpaces spaces(scene.team, scene.given.moving, scene.sensing, {}, empty_map(), scene.policies);
  for (int k = 0; k <= 100; ++k) spaces.at(0, 0.02 * k);
  ASSERT_EQ(spaces.ages().size(), 101U);
  for (std::size_t k = 13; k <= 100; ++k) {
    EXPECT_GE(spaces.ages()[k], 0.25 - 1e-9);
    EXPECT_LE(spaces.ages()[k], 0.35 + 1e-9);
  }
  EXPECT_EQ(spaces.ages()[5], 0.1);  // the scan at time 0 was known at once
}

TEST(SensedSpaces, WhatALoadedMapHidesIsNotSeen) {
  Approach scene;
  scene.load();
  scene.sensing.sensors = {{0.0, -1.1, 0.02}};  // behind the wall
  const Team team = make_team(scene.given, scene.map, scene.policies);
  SensedSpaces spaces(team, scene.given.moving, scene.sensing, scene.world, scene.map, scene.policies);
  const auto space = spaces.at(0, 20.0);
  for (double y = 0.1; y < 0.5; y += 0.025)
    EXPECT_NE(space->map().state(Eigen::Vector3d(0.31, y, 0.01)), VoxelState::occupied) << y;
}

TEST(SensedSpaces, ASensorInAnOccupiedVoxelIsRefusedByPlace) {
  Approach scene;
  scene.load();
  scene.sensing.sensors.emplace_back(0.01, -0.71, 0.02);
  try {
    check_sensors(scene.sensing, scene.map);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "sensor 2 at (0.01, -0.71, 0.02) stands in an occupied voxel, expected a place from which "
              "something is seen");
  }
}

TEST(SensedSpaces, ASensorInTheWayOfWhatItShallSeeIsRefusedWithTheTime) {
  Approach scene;
  Team team = make_team(scene.given, empty_map(), {});
  EXPECT_NO_THROW(check_sensors(scene.sensing, team));
  scene.sensing.sensors.emplace_back(0.3, 0.6, 0.1);  // the box comes from y = 1.1 at 5 cm a second
  try {
    check_sensors(scene.sensing, team);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()),
              "sensor 2 at (0.3, 0.6, 0.1) is met by 'box' at 9 s, expected a place beside its way");
  }
  team.obstacles[0].is_sensed = false;
  EXPECT_NO_THROW(check_sensors(scene.sensing, team));
}

}  // namespace sensed_spaces_test
}  // namespace clearway
