#include "planning/space/configuration_space.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace configuration_space_test {

constexpr double edge = 0.05;

/// Some obstacle voxels about where the arm moves, and the map that holds them.
struct World {
  std::vector<Eigen::Vector3d> cubes;
  Snapshot map;

  World(const Robot& robot, Random& random, int count) {
    FreeSpaceMap builder({.resolution = edge});
    const int last = std::min(3, static_cast<int>(robot.bodies.size()));  // obstacles about the hand
    for (int i = 0; i < count; ++i) {
      const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
      const Body& body = robot.bodies[robot.bodies.size() - 1 - static_cast<std::size_t>(random.below(last))];
      const Eigen::Vector3d near = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape *
                                   body.shape.support(random.point(1.0));
      const Eigen::Vector3d cube = ((near / edge).array().floor() + 0.5) * edge;
      if (std::find(cubes.begin(), cubes.end(), cube) != cubes.end()) continue;
      occupy(builder, cube);
      cubes.push_back(cube);
    }
    map = builder.snapshot();
  }
};

Policies not_occupied() { return {.critical_by_default = false}; }

/// Configurations at the border between free and blocked as well as anywhere.
std::vector<Configuration> touching_zone(const ConfigurationSpace& space, Random& random, int count) {
  std::vector<Configuration> list;
  while (static_cast<int>(list.size()) < count) {
    Configuration free = random.configuration(space.robot()), blocked = random.configuration(space.robot());
    list.push_back(free);
    if (!space.is_free(free) || space.is_free(blocked)) continue;
    for (int i = 0; i < 10; ++i) {
      const Configuration middle = (free + blocked) / 2;
      (space.is_free(middle) ? free : blocked) = middle;
    }
    list.push_back(free);
    list.push_back(blocked);
  }
  return list;
}

TEST(ConfigurationSpace, IsFreeAgreesWithFclOnEveryVoxelCube) {
  int configurations = 0, free_count = 0, wrongly_free = 0, wrongly_blocked = 0;
  for (const char* name : {"puma560", "arm5", "planar2"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Random random(seed);
      const World world(robot, random, 40);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      const FclTruth truth(robot, world.cubes, edge);
      for (const Configuration& q : touching_zone(space, random, 900)) {
        const LinkPoses poses = forward_kinematics(robot, q);
        const bool expected = !truth.touches_cube(poses) && !truth.touches_itself(poses);
        const bool free = space.is_free(q);
        ASSERT_EQ(free, space.check(q).is_free());
        ++configurations;
        free_count += expected;
        wrongly_free += free && !expected;
        wrongly_blocked += !free && expected;
      }
    }
  }
  EXPECT_GE(configurations, 20'000);
  EXPECT_GT(free_count, 5'000);
  EXPECT_EQ(wrongly_free, 0);
  EXPECT_LE(wrongly_blocked, free_count / 1000);
}

TEST(ConfigurationSpace, NoAcceptedEdgeTouchesAnythingWhenSampledDensely) {
  int accepted = 0, refused = 0, refused_though_clear = 0;
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 11; seed <= 14; ++seed) {
      Random random(seed);
      const World world(robot, random, 30);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      const FclTruth truth(robot, world.cubes, edge);
      for (int i = 0; i < 200; ++i) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.15 * (random.configuration(robot) - from);
        const bool free = space.is_edge_free(from, to);
        ASSERT_EQ(free, space.is_edge_free(to, from));
        (free ? accepted : refused)++;
        const int samples = static_cast<int>(std::ceil((to - from).norm() / (free ? 0.001 : 0.01)));
        bool touched = false;
        for (int k = 0; k <= samples && !touched; ++k) {
          const LinkPoses poses = forward_kinematics(robot, from + (to - from) * k / samples);
          touched = truth.touches_cube(poses) || (k % 10 == 0 && truth.touches_itself(poses));
        }
        ASSERT_FALSE(free && touched) << name << " seed " << seed << " edge " << i;
        refused_though_clear += !free && !touched;
      }
    }
  }
  EXPECT_GE(accepted, 500);
  EXPECT_GE(refused, 200);
  EXPECT_LE(refused_though_clear, refused / 20);  // grazing ones, undecided or between the coarse samples
}

TEST(ConfigurationSpace, AStepBesideAnObstacleIsAcceptedWhenItKeepsSomeRoomAndNeverWhenItTouches) {
  int accepted = 0, refused = 0, with_room = 0;
  const Robot robot = load_robot("puma560");
  for (std::uint64_t seed = 41; seed <= 44; ++seed) {
    Random random(seed);
    const World world(robot, random, 30);
    const ConfigurationSpace space(robot, world.map, not_occupied());
    const FclTruth truth(robot, world.cubes, edge);
    for (int i = 0; i < 200; ++i) {
      Configuration free = random.configuration(robot), other = random.configuration(robot);
      if (!space.is_free(free) || space.is_free(other)) continue;
      while ((other - free).norm() > 0.01) {  // close to the obstacle, or the robot itself
        const Configuration middle = (free + other) / 2;
        (space.is_free(middle) ? free : other) = middle;
      }
      Configuration to = free;
      for (Eigen::Index j = 0; j < to.size(); ++j) to[j] += 0.02 * (random.below(3) - 1);
      const bool edge_free = space.is_edge_free(free, to);
      (edge_free ? accepted : refused)++;
      bool touched = false;
      double room = 1.0;
      for (int k = 0; k <= 100 && !touched; ++k) {
        const Configuration q = free + (to - free) * k / 100.0;
        const LinkPoses poses = forward_kinematics(robot, q);
        touched = truth.touches_cube(poses) || truth.touches_itself(poses);
        room = std::min(room, space.clearance(q));
      }
      ASSERT_FALSE(edge_free && touched) << "seed " << seed << " edge " << i;
      if (room > 3e-4) {
        ++with_room;
        ASSERT_TRUE(edge_free) << "seed " << seed << " edge " << i;
      }
    }
  }
  EXPECT_GE(accepted, 30);
  EXPECT_GE(refused, 50);
  EXPECT_GE(with_room, 20);
}

TEST(ConfigurationSpace, WhatIsQuicklyFreeIsFreeAndMostFreeEdgesAre) {
  int free = 0, quickly_free = 0;
  for (const char* name : {"puma560", "arm5", "panda"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 41; seed <= 43; ++seed) {
      Random random(seed);
      const World world(robot, random, 30);
      const ConfigurationSpace space(robot, world.map, not_occupied());
      for (int i = 0; i < 300; ++i) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.15 * (random.configuration(robot) - from);
        const bool is_free = space.is_edge_free(from, to), is_quick = space.is_edge_quickly_free(from, to);
        ASSERT_TRUE(is_free || !is_quick) << name << " seed " << seed << " edge " << i;
        free += is_free;
        quickly_free += is_quick;
      }
      Configuration outside = random.configuration(robot);
      outside[0] = robot.joints[0].upper + 0.1;
      EXPECT_FALSE(space.is_edge_quickly_free(random.configuration(robot), outside));
    }
  }
  EXPECT_GE(free, 500);
  EXPECT_GE(quickly_free, free * 6 / 10);
}

TEST(ConfigurationSpace, AClearanceUpToALimitIsTheLesserOfBoth) {
  const Robot robot = load_robot("puma560");
  Random random(51);
  const World world(robot, random, 25);
  const ConfigurationSpace space(robot, world.map, not_occupied());
  int cut = 0, kept = 0;
  for (const Configuration& q : touching_zone(space, random, 300)) {
    const double whole = space.clearance(q), limit = random.between(0.0, 0.1);
    const double told = space.clearance(q, limit);
    ASSERT_LE(told, limit);
    if (whole >= limit) {
      EXPECT_EQ(told, limit);
      ++cut;
    } else {
      EXPECT_LE(told, whole + 1e-9);  // what is near is looked at closely: by the same shapes
      EXPECT_EQ(told > 0.0, whole > 0.0);
      ++kept;
    }
  }
  EXPECT_GE(cut, 30);
  EXPECT_GE(kept, 100);
}

TEST(ConfigurationSpace, ClearanceIsNeverAboveFclsDistanceAndCloseToItNearObstacles) {
  const Robot robot = load_robot("puma560");
  double worst_over = 0.0, worst_under = 0.0;
  for (std::uint64_t seed = 21; seed <= 24; ++seed) {
    Random random(seed);
    const World world(robot, random, 25);
    const ConfigurationSpace space(robot, world.map, not_occupied());
    const FclTruth truth(robot, world.cubes, edge);
    for (int i = 0; i < 250; ++i) {
      const Configuration q = random.configuration(robot);
      const LinkPoses poses = forward_kinematics(robot, q);
      const double expected = std::min(truth.cube_distance(poses, 0.5), truth.self_distance(poses, 0.5));
      const double clearance = space.clearance(q);
      worst_over = std::max(worst_over, clearance - expected);
      if (expected < edge) worst_under = std::max(worst_under, expected - clearance);
    }
  }
  EXPECT_LT(worst_over, 1e-6);
  EXPECT_LT(worst_under, 1e-5);
}

TEST(ConfigurationSpace, CriticalPartsMustLieInsideTheirPaintedVolume) {
  const Robot robot = load_robot("puma560");
  Random random(31);
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("free", {"tool"});
  for (int i = 0; i < 12; ++i)
    builder.paint(volume, {tip_pose(robot, random.configuration(robot)).translation(), 0.35});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace space(robot, map);
  EXPECT_EQ(space.policies().at("tool"), Policy::painted);
  EXPECT_EQ(space.policies().at("link2"), Policy::not_occupied);
  const FclTruth alone(robot, {}, edge);
  const Body& tool = robot.bodies.back();
  const auto cylinder = fcl_geometry(tool.shape);
  const fcl::Boxd cube(edge, edge, edge);
  int free = 0;
  for (int i = 0; i < 1'500; ++i) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(tool.link)] * tool.link_from_shape;
    const Eigen::AlignedBox3d box = tool.shape.bounds(pose);
    bool expected = !alone.touches_itself(poses);
    for (double x = std::floor(box.min().x() / edge); expected && x <= box.max().x() / edge; ++x) {
      for (double y = std::floor(box.min().y() / edge); expected && y <= box.max().y() / edge; ++y) {
        for (double z = std::floor(box.min().z() / edge); expected && z <= box.max().z() / edge; ++z) {
          const Eigen::Vector3d center = (Eigen::Vector3d(x, y, z).array() + 0.5) * edge;
          if (map.state(center) == VoxelState::painted) continue;
          expected =
              !fcl_collide(cylinder.get(), pose, &cube, Eigen::Isometry3d(Eigen::Translation3d{center}));
        }
      }
    }
    ASSERT_EQ(space.is_free(q), expected);
    free += expected;
    if (!expected && !alone.touches_itself(poses)) {
      ASSERT_EQ(space.check(q).obstruction, Obstruction::outside_painted);
    }
  }
  EXPECT_GT(free, 20);
}

TEST(ConfigurationSpace, VolumesOfOtherPartsDoNotCountAndAMapWithoutPaintFallsBackToKnownFree) {
  const Robot robot = load_robot("point");
  const auto space_with = [&](const std::vector<std::string>& first, const std::vector<std::string>& second) {
    FreeSpaceMap builder({.resolution = edge});
    builder.paint(builder.add_volume("here", first), {Eigen::Vector3d::Zero(), 0.5});
    builder.paint(builder.add_volume("there", second), {Eigen::Vector3d(2.0, 0.0, 0.0), 0.5});
    return ConfigurationSpace(robot, builder.snapshot());
  };
  const Eigen::Vector2d here(0.0, 0.0), there(2.0, 0.0);
  const ConfigurationSpace named = space_with({"base"}, {"hand"});
  EXPECT_TRUE(named.is_free(here));
  EXPECT_EQ(named.check(there).obstruction, Obstruction::outside_painted);
  const ConfigurationSpace unnamed = space_with({}, {"hand"});
  EXPECT_TRUE(unnamed.is_free(here));
  EXPECT_TRUE(unnamed.is_free(there));
  EXPECT_FALSE(unnamed.is_edge_free(here, there));
  const ConfigurationSpace bare(robot, FreeSpaceMap({.resolution = edge}).snapshot());
  EXPECT_EQ(bare.policies().at("base"), Policy::known_free);
  EXPECT_EQ(bare.check(here).obstruction, Obstruction::unknown);
}

TEST(ConfigurationSpace, PaddingKeepsItsDistanceAndVerdictsNamePartPlaceAndDepth) {
  const Robot robot = load_robot("point");  // a disc of radius 0.2
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {1.025, 0.025, 0.025});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace tight(robot, map, not_occupied()),
      padded(robot, map, not_occupied(), {.padding = 0.1});
  const Eigen::Vector2d near(0.75, 0.025), touching(0.81, 0.025);  // the cube begins at x = 1
  EXPECT_TRUE(tight.is_free(near));
  EXPECT_NEAR(tight.clearance(near), 0.05, 1e-9);
  EXPECT_FALSE(padded.is_free(near));
  EXPECT_NEAR(padded.clearance(near), -0.05, 1e-9);
  // The shortest way out of the cube, whose lower face is z = 0, is downwards: half the disc's thickness.
  EXPECT_EQ(tight.check(touching).sentence(),
            "base touches an occupied voxel at (1.025, 0.025, 0.025), 5 mm deep");
  EXPECT_EQ(padded.check(near).sentence(),
            "base touches an occupied voxel at (1.025, 0.025, 0.025), 50 mm deep");
  EXPECT_EQ(tight.check(Eigen::Vector2d(0.0, 100.5)).sentence(), "joint y is 0.5 (rad or m) past its limit");
  EXPECT_EQ(tight.check(Eigen::Vector2d(0.0, NAN)).obstruction, Obstruction::not_finite);
  EXPECT_EQ(tight.check(Eigen::Vector3d::Zero()).obstruction, Obstruction::not_finite);
  EXPECT_FALSE(tight.is_edge_free(near, Eigen::Vector2d(0.75, NAN)));
  EXPECT_FALSE(tight.is_edge_free(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(2.0, 0.0)));
  EXPECT_TRUE(tight.is_edge_free(Eigen::Vector2d(0.0, 0.0), near));
  EXPECT_TRUE(tight.is_edge_free(near, near));
}

TEST(ConfigurationSpace, PaddingBeyondTheFieldsReachStillCountsWhereTheRobotCannotGo) {
  Robot robot = load_robot("point");  // a disc of radius 0.2
  robot.joints[0].upper = 1.0;
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {1.675, 0.025, 0.025});  // 0.45 m beyond the farthest that the disc gets
  const Snapshot map = builder.snapshot();
  for (const double max_distance : {0.0, 0.1, 1.0}) {
    const auto padded = [&](double padding) {
      return ConfigurationSpace(robot, map, not_occupied(),
                                {.padding = padding, .max_distance = max_distance});
    };
    const Eigen::Vector2d far(0.0, 0.025), end(1.0, 0.025);
    EXPECT_FALSE(padded(0.451).is_free(end));
    EXPECT_FALSE(padded(0.451).is_edge_free(far, end));
    EXPECT_LE(padded(0.451).clearance(end), 0.0);
    EXPECT_TRUE(padded(0.449).is_edge_free(far, end));
  }
}

TEST(ConfigurationSpace, AMapOutOfTheRobotsReachIsAsGoodAsNone) {
  Robot robot = load_robot("point");  // a disc of radius 0.2
  FreeSpaceMap builder({.resolution = edge});
  builder.paint(builder.add_volume("far", {}), {{0.0, 0.4, 0.0}, 0.3});
  occupy(builder, {0.025, 0.025, 0.025});
  const Snapshot far = builder.snapshot(), none = FreeSpaceMap({.resolution = edge}).snapshot();
  for (Joint& joint : robot.joints) std::tie(joint.lower, joint.upper) = std::pair(-1.0, 1.0);
  for (const double away : {-1e7, -90.0, -4.0, 4.0, 90.0, 1e7}) {
    robot.map_from_base.translation() = Eigen::Vector3d(away, away, 0.0);
    for (const Policy policy : {Policy::not_occupied, Policy::known_free, Policy::painted}) {
      const ConfigurationSpace in_far(robot, far, {.other = policy, .critical_by_default = false}),
          in_none(robot, none, {.other = policy, .critical_by_default = false});
      Random random(61);
      for (int i = 0; i < 10; ++i) {
        const Configuration from = random.configuration(robot), to = random.configuration(robot);
        ASSERT_EQ(in_far.is_free(from), policy == Policy::not_occupied);
        ASSERT_EQ(in_far.is_edge_free(from, to), policy == Policy::not_occupied);
        ASSERT_EQ(in_far.clearance(from), in_none.clearance(from));
        ASSERT_EQ(in_far.check(from).sentence(), in_none.check(from).sentence());
        ASSERT_EQ(in_far.proximity_constraints(from, 1.0).size(),
                  in_none.proximity_constraints(from, 1.0).size());
      }
    }
  }
}

// So its fields can be brought up to date. Where the reach is too large for a field, it is the map's.
TEST(ConfigurationSpace, WhereItKnowsBlockedSpaceDoesNotGrowWithTheMap) {
  for (const double resolution : {0.02, 0.002}) {
    FreeSpaceMap map({.resolution = resolution});
    const auto see = [&](const Eigen::Vector3d& point) {
      Scan scan;
      scan.points = {point.cast<float>()};
      map.insert(scan);
      const ConfigurationSpace space(load_robot("puma560"), map.snapshot(), {}, {.max_distance = 0.1});
      return space.blocked_space(static_cast<int>(space.robot().bodies.size()) - 1)->region();
    };
    const Eigen::AlignedBox3d before = see({0.1, 0.1, 0.1}), after = see({0.4, 0.3, 0.4});
    EXPECT_EQ(before.isApprox(after), resolution == 0.02);
    EXPECT_EQ(before.contains(Eigen::Vector3d(0.4, 0.3, 0.4)), resolution == 0.02);
    EXPECT_TRUE(after.contains(Eigen::Vector3d(0.4, 0.3, 0.4)));
  }
}

TEST(ConfigurationSpace, APartThatAPaintedVolumeNamesIsCriticalThoughTheRobotDoesNotSaySo) {
  Robot robot = load_robot("point");
  robot.critical_parts.clear();  // as a bare URDF is
  FreeSpaceMap builder({.resolution = edge});
  builder.paint(builder.add_volume("free", {"base"}), {Eigen::Vector3d::Zero(), 0.5});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace space(robot, map);
  EXPECT_EQ(space.policies().at("base"), Policy::painted);
  EXPECT_TRUE(space.is_free(Eigen::Vector2d(0.0, 0.0)));
  EXPECT_FALSE(space.is_free(Eigen::Vector2d(2.0, 0.0)));
  EXPECT_EQ(ConfigurationSpace(robot, map, not_occupied()).policies().at("base"), Policy::not_occupied);
}

TEST(ConfigurationSpace, SelfContactIsNamed) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, Snapshot(), not_occupied());
  const FclTruth truth(robot, {}, edge);
  Random random(41);
  int contacts = 0;
  for (int i = 0; i < 3'000; ++i) {
    const Configuration q = random.configuration(robot);
    const Verdict verdict = space.check(q);
    ASSERT_EQ(verdict.is_free(), !truth.touches_itself(forward_kinematics(robot, q)));
    if (verdict.is_free()) continue;
    ++contacts;
    EXPECT_EQ(verdict.obstruction, Obstruction::self_collision);
    EXPECT_EQ(verdict.part, "base");
  }
  EXPECT_GT(contacts, 5);
}

TEST(ConfigurationSpace, NoPointOfTheRobotMovesFartherThanTheMotionBound) {
  for (const char* name : {"puma560", "arm5", "planar2", "point"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, Snapshot(), not_occupied());
    Random random(51);
    double tightest = 0.0;
    for (int i = 0; i < 2'000; ++i) {
      const Configuration from = random.configuration(robot);
      Configuration to = random.configuration(robot);
      if (i % 2 == 0) to = from + 0.01 * (to - from);
      const double bound = space.motion_bound((to - from).cwiseAbs());
      const LinkPoses a = forward_kinematics(robot, from), b = forward_kinematics(robot, to);
      for (const Body& body : robot.bodies) {
        const Eigen::Vector3d point = body.link_from_shape * body.shape.support(random.point(1.0));
        const auto link = static_cast<std::size_t>(body.link);
        const double moved = (b[link] * point - a[link] * point).norm();
        ASSERT_LE(moved, bound * (1 + 1e-9));
        tightest = std::max(tightest, moved / bound);
      }
    }
    EXPECT_GT(tightest, 0.5) << name;
  }
}

TEST(ConfigurationSpace, ASlideWithoutLimitsBelowATurningJointIsRefused) {
  // How far the turning joint moves it has no bound: no edge could be judged by bounds.
  Robot robot = load_robot("planar2");
  robot.joints[1].kind = JointKind::prismatic;
  robot.joints[1].axis = Eigen::Vector3d::UnitX();
  robot.joints[1].lower = -1.0, robot.joints[1].upper = 1.0;
  EXPECT_NO_THROW(ConfigurationSpace(robot, Snapshot(), not_occupied()));
  for (const bool up : {true, false}) {
    Robot unlimited = robot;
    (up ? unlimited.joints[1].upper : unlimited.joints[1].lower) =
        (up ? 1.0 : -1.0) * std::numeric_limits<double>::infinity();
    try {
      ConfigurationSpace(unlimited, Snapshot(), not_occupied());
      FAIL() << "expected a refusal";
    } catch (const std::invalid_argument& told) {
      EXPECT_NE(std::string(told.what()).find("'" + robot.joints[1].name + "' slides without limits"),
                std::string::npos)
          << told.what();
    }
  }
  robot.joints[0].lower = -std::numeric_limits<double>::infinity();  // turning without limits is no harm
  EXPECT_NO_THROW(ConfigurationSpace(robot, Snapshot(), not_occupied()));
}

TEST(ConfigurationSpace, UnknownPartsAndImpossibleOptionsAreRefused) {
  const Robot robot = load_robot("planar2");
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {.parts = {{"nose", Policy::painted}}}),
               std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {}, {.padding = -0.1}), std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {}, {.edge_resolution = 0.0}), std::invalid_argument);
}

}  // namespace configuration_space_test
}  // namespace clearway
