#include "planning/check/path_check.hpp"

#include <gtest/gtest.h>

#include "mapping/system/number_text.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace path_check_test {

constexpr double edge = 0.05;

Eigen::Vector3d cell_of(const Eigen::Vector3d& point) {
  return ((point / edge).array().floor() + 0.5) * edge;
}

std::vector<Eigen::Vector3d> random_cubes(const Robot& robot, Random& random, int count) {
  std::vector<Eigen::Vector3d> cubes;
  for (int i = 0; i < count; ++i)
    cubes.push_back(cell_of(tip_pose(robot, random.configuration(robot)).translation()));
  return cubes;
}

Snapshot map_of(const std::vector<Eigen::Vector3d>& cubes) {
  FreeSpaceMap builder({.resolution = edge});
  for (const Eigen::Vector3d& cube : cubes) occupy(builder, cube);
  return builder.snapshot();
}

/// A path of straight edges that the planners' own check accepts.
std::vector<Configuration> free_path(const ConfigurationSpace& space, Random& random, std::size_t waypoints) {
  std::vector<Configuration> path;
  while (path.size() < waypoints) {
    Configuration next = random.configuration(space.robot());
    if (!path.empty()) next = path.back() + 0.1 * (next - path.back());
    if (path.empty() ? space.is_free(next) : space.is_edge_free(path.back(), next)) path.push_back(next);
  }
  return path;
}

TEST(PathCheck, AcceptsAFreePathAndRefusesItWhenAnObstacleIsDroppedOnIt) {
  for (const char* name : {"puma560", "panda", "arm5", "planar2", "point"}) {
    const Robot robot = load_robot(name);
    Random random(1);
    std::vector<Eigen::Vector3d> cubes = random_cubes(robot, random, 15);
    const ConfigurationSpace space(robot, map_of(cubes), {.critical_by_default = false});
    const std::vector<Configuration> path = free_path(space, random, 6);
    const PathVerdict before = check_path(robot, space.map(), {}, 0.0, path);
    ASSERT_TRUE(before.valid) << name << ": " << before.first_contact;
    EXPECT_GT(before.min_clearance, 0.0);
    EXPECT_EQ(before.clearance.size(), path.size());

    const Configuration middle = (path[3] + path[4]) / 2;
    const Body& last = robot.bodies.back();
    cubes.push_back(cell_of(forward_kinematics(robot, middle)[static_cast<std::size_t>(last.link)] *
                            last.link_from_shape.translation()));
    const PathVerdict after = check_path(robot, map_of(cubes), {}, 0.0, path);
    EXPECT_FALSE(after.valid);
    EXPECT_FALSE(after.undecided);
    EXPECT_EQ(after.min_clearance, 0.0);
    EXPECT_LE(after.edge, 3);
    EXPECT_NE(after.first_contact.find("edge " + std::to_string(after.edge)), std::string::npos)
        << after.first_contact;
    EXPECT_NE(after.first_contact.find(" touches a voxel that is occupied, at ("), std::string::npos)
        << after.first_contact;
    EXPECT_NE(after.first_contact.find("its policy is not_occupied"), std::string::npos);
  }
}

TEST(PathCheck, AgreesWithTheConfigurationSpaceAndWithDenseSamplingOnRandomEdges) {
  int valid = 0, refused = 0, undecided = 0;
  double slack = 0.0;
  const int edges = trials(16, 40);
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      Random random(seed);
      const std::vector<Eigen::Vector3d> cubes = random_cubes(robot, random, 30);
      const ConfigurationSpace space(robot, map_of(cubes), {.critical_by_default = false});
      const FclTruth truth(robot, cubes, edge);
      for (int i = 0; i < edges; ++i) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.15 * (random.configuration(robot) - from);
        const PathVerdict verdict = check_path(robot, space.map(), {}, 0.0, {from, to});
        ASSERT_TRUE(verdict.valid || !space.is_edge_free(from, to)) << name << ": " << verdict.first_contact;
        double least = 0.2;
        bool touched = false;
        const int samples = 200;
        for (int k = 0; k <= samples; ++k) {
          const LinkPoses poses = forward_kinematics(robot, from + (to - from) * k / samples);
          least = std::min(least, truth.cube_distance(poses, 0.2));
          touched = touched || truth.touches_itself(poses) || least <= 0.0;
        }
        ASSERT_FALSE(verdict.valid && touched);
        (verdict.valid ? valid : refused)++;
        undecided += verdict.undecided;
        if (!verdict.valid) continue;
        ASSERT_LE(verdict.min_clearance, least + 1e-9);
        slack = std::max(slack, least - verdict.min_clearance - 0.25 * least);
      }
    }
  }
  EXPECT_GE(valid, edges);
  EXPECT_GE(refused, edges);
  EXPECT_LE(undecided, 2);
  EXPECT_LT(slack, 0.005);  // the certified minimum is near the sampled one
}

TEST(PathCheck, LeavingThePaintedVolumeAndUnknownSpaceIsNamed) {
  const Robot robot = load_robot("point");
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("free", {"base"});
  for (double x = 0.0; x <= 1.0; x += 0.1) builder.paint(volume, {{x, 0.0, 0.0}, 0.4});
  const Snapshot map = builder.snapshot();
  const std::map<std::string, Policy> painted{{"base", Policy::painted}}, known{{"base", Policy::known_free}};
  const std::vector<Configuration> inside{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.0, 0.0)};
  const std::vector<Configuration> outside{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.0, 0.0),
                                           Eigen::Vector2d(1.0, 1.0)};
  EXPECT_TRUE(check_path(robot, map, painted, 0.0, inside).valid);
  EXPECT_TRUE(check_path(robot, map, known, 0.0, inside).valid);
  EXPECT_TRUE(check_path(robot, map, {}, 0.0, outside).valid);
  const PathVerdict verdict = check_path(robot, map, painted, 0.0, outside);
  EXPECT_FALSE(verdict.valid);
  EXPECT_EQ(verdict.edge, 1);
  EXPECT_NEAR(verdict.parameter, 0.1, 0.06);  // the disc reaches 0.3 m or so at y = 0.1
  EXPECT_NE(verdict.first_contact.find("base touches a voxel that is unknown"), std::string::npos)
      << verdict.first_contact;
  EXPECT_NE(verdict.first_contact.find("its policy is painted"), std::string::npos);
  EXPECT_FALSE(check_path(robot, map, painted, 0.15, inside).valid);  // padding into the unknown above
}

TEST(PathCheck, AThinSliceOfKnownSpaceIsEnoughForADisc) {
  Robot robot = load_robot("point");
  robot.map_from_base.translation().z() = 0.025;
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("floor", {"base"});
  for (int x = -10; x < 30; ++x) {
    for (int y = -10; y < 10; ++y)
      builder.paint(volume, {(Eigen::Vector3d(x, y, 0).array() + 0.5) * edge, 0.87 * edge});
  }
  const Snapshot map = builder.snapshot();
  const std::vector<Configuration> path{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.2, 0.2)};
  EXPECT_TRUE(ConfigurationSpace(robot, map).is_edge_free(path[0], path[1]));
  const PathVerdict verdict = check_path(robot, map, {{"base", Policy::painted}}, 0.0, path);
  EXPECT_TRUE(verdict.valid) << verdict.first_contact;
}

TEST(PathCheck, PathsThatAreNoPathsAreRefusedNamingTheWaypoint) {
  const Robot robot = load_robot("planar2");
  const Configuration q = Eigen::Vector2d(0.1, 0.2);
  const auto contact = [&](const std::vector<Configuration>& path) {
    return check_path(robot, Snapshot(), {}, 0.0, path).first_contact;
  };
  EXPECT_EQ(contact({}), "the path has no waypoints");
  EXPECT_EQ(contact({q, Eigen::Vector3d::Zero()}), "waypoint 1: has 3 values, but planar2 has 2 joints");
  EXPECT_EQ(contact({q, Eigen::Vector2d(NAN, 0)}),
            "waypoint 1: joint shoulder is nan, outside its limits -3.14159 to 3.14159");
  EXPECT_EQ(contact({Eigen::Vector2d(0, 3)}),
            "waypoint 0: joint elbow is 3, outside its limits -2.79253 to 2.79253");
  const double upper = robot.joints[0].upper;
  EXPECT_EQ(contact({Eigen::Vector2d(upper + 1e-5, 0)}),
            "waypoint 0: joint shoulder is 3.1416, outside its limits -3.14159 to 3.14159");
  EXPECT_EQ(contact({Eigen::Vector2d(upper + 1e-8, 0)}), "waypoint 0: joint shoulder is " +
                                                             text_beside(upper + 1e-8, upper) +
                                                             ", outside its limits -3.14159 to 3.14159");
  EXPECT_THROW(check_path(robot, Snapshot(), {}, -1.0, {q}), std::invalid_argument);
  const std::string part = robot.bodies.back().part;
  EXPECT_FALSE(check_path(robot, Snapshot(), {{part, Policy::painted}}, 0.0, {q}).valid);
  EXPECT_THROW(check_path(robot, Snapshot(), {{part + "s", Policy::painted}}, 0.0, {q}),
               std::invalid_argument);
  EXPECT_TRUE(check_path(robot, Snapshot(), {}, 0.0, {q}).valid);
  EXPECT_TRUE(check_path(robot, Snapshot(), {}, 0.0, {q, q, q}).valid);
  const Eigen::Vector3d on_arm = forward_kinematics(robot, q)[2].translation();
  EXPECT_FALSE(check_path(robot, map_of({cell_of(on_arm)}), {}, 0.0, {q}).valid);
  EXPECT_FALSE(check_path(robot, map_of({cell_of(on_arm)}), {}, 0.0, {q, q}).valid);
}

TEST(PathCheck, PlacesBodiesByKdlWhereOurKinematicsPlacesThemMimicJointsToo) {
  std::vector<Robot> robots;
  for (const char* name : {"puma560_miniature", "arm5", "planar2", "point"})
    robots.push_back(load_robot(name));
  Robot mimic = load_robot("arm5");  // the forearm's joint copies the upper arm's, reversed and shifted
  mimic.source.clear();
  mimic.links[3].joint = mimic.links[2].joint;
  mimic.links[3].multiplier = -0.5;
  mimic.links[3].offset = 0.3;
  robots.push_back(mimic);
  Random random(2);
  for (Robot& robot : robots) {
    robot.map_from_base = random.pose(1.0);
    const check::KdlArm arm(robot);
    check::BodyPoses placed;
    for (int i = 0; i < 500; ++i) {
      const Configuration q = random.configuration(robot);
      arm.place(q, placed);
      const LinkPoses poses = forward_kinematics(robot, q);
      for (std::size_t b = 0; b < placed.size(); ++b) {
        const Body& body = robot.bodies[b];
        ASSERT_LT((placed[b].matrix() -
                   (poses[static_cast<std::size_t>(body.link)] * body.link_from_shape).matrix())
                      .norm(),
                  1e-9);
      }
    }
  }
}

TEST(PathCheck, ItsDistancesAreProvedAndAsLargeAsOurs) {
  Robot robot = load_robot("arm5");  // sphere, capsules and a box; plus a cylinder and a hull
  robot.bodies[0].shape = Shape::cylinder(0.1, 0.3);
  robot.bodies[1].shape = Shape::convex({{0, 0, 0}, {0.2, 0, 0}, {0, 0.3, 0}, {0, 0, 0.2}, {0.1, 0.1, 0.2}});
  robot.bodies[2].shape = Shape::convex({{0, 0, 0}, {0.2, 0, 0}, {0, 0.3, 0}, {0.2, 0.3, 0}});  // flat
  const check::FclBodies bodies(robot);
  Random random(3);
  double over = 0.0, under = 0.0;
  for (int i = 0; i < 5'000; ++i) {
    const auto a = static_cast<std::size_t>(random.below(6)), b = static_cast<std::size_t>(random.below(6));
    const Eigen::Isometry3d pose_a = random.pose(0.4), pose_b = random.pose(0.4);
    const double pair = bodies.distance(a, pose_a, b, pose_b);
    const DistanceBounds ours = distance(robot.bodies[a].shape, pose_a, robot.bodies[b].shape, pose_b);
    over = std::max(over, pair - ours.upper);
    under = std::max(under, ours.lower - pair);
    const Eigen::Vector3d cube = random.point(0.4);
    const double to_cube = bodies.cube_distance(a, pose_a, cube, edge);
    const DistanceBounds ours_to_cube = distance_to_cube(robot.bodies[a].shape, pose_a, cube, edge);
    over = std::max(over, to_cube - ours_to_cube.upper);
    under = std::max(under, ours_to_cube.lower - to_cube);
  }
  EXPECT_LT(over, 1e-9);
  EXPECT_LT(under, 1e-4);
}

TEST(PathCheck, EveryEdgeOfAPathTooWideForOneBlockOfVoxelsIsChecked) {
  const Robot disc = load_robot("point");  // of radius 0.2, it slides up to 100 m
  std::vector<Configuration> path;         // round a square, in edges that are cut apart in several ways
  for (const auto& [x, y] :
       {std::pair(-50, -50), {0, -50}, {50, -50}, {50, 50}, {0, 50}, {-50, 50}, {-50, -40}})
    path.push_back(Eigen::Vector2d(x, y));
  std::vector<Eigen::Vector3d> beside;  // 0.1 m from the disc at each waypoint, outside the square
  for (const Configuration& q : path)
    beside.push_back(cell_of({q.x(), q.y() + (q.y() > 0 ? 0.301 : -0.349), 0.0}));
  beside.back() = cell_of({-50.349, -40.0, 0.0});
  const auto checked = [&](std::vector<Eigen::Vector3d> cubes) {
    return check_path(disc, map_of(cubes), {}, 0.0, path);
  };
  const PathVerdict free = checked(beside);
  ASSERT_TRUE(free.valid) << free.first_contact;
  ASSERT_EQ(free.clearance.size(), path.size());
  for (const double clearance : free.clearance) EXPECT_NEAR(clearance, 0.1, 1e-6);
  for (int blocked = 0; blocked + 1 < static_cast<int>(path.size()); ++blocked) {
    const auto at = static_cast<std::size_t>(blocked);
    const Eigen::Vector2d on = 0.37 * path[at] + 0.63 * path[at + 1];
    const PathVerdict verdict = checked({cell_of({on.x(), on.y(), 0.0})});
    EXPECT_FALSE(verdict.valid) << "edge " << blocked;
    EXPECT_EQ(verdict.edge, blocked) << verdict.first_contact;
  }
}

/// Along x, then along y: each half takes up little, so that the path is cut in the middle.
TEST(PathCheck, EveryEdgeOfAPathThatIsCutWhereItTurnsIsChecked) {
  const Robot disc = load_robot("point");
  std::vector<Configuration> path;
  for (const auto& [x, y] :
       {std::pair(-50, -50), {-25, -50}, {0, -50}, {25, -50}, {25, -25}, {25, 0}, {25, 25}})
    path.push_back(Eigen::Vector2d(x, y));
  EXPECT_TRUE(check_path(disc, map_of({cell_of({25.4, -50.4, 0.0})}), {}, 0.0, path).valid);
  for (int blocked = 0; blocked + 1 < static_cast<int>(path.size()); ++blocked) {
    const auto at = static_cast<std::size_t>(blocked);
    const Eigen::Vector2d on = 0.37 * path[at] + 0.63 * path[at + 1];
    const PathVerdict verdict = check_path(disc, map_of({cell_of({on.x(), on.y(), 0.0})}), {}, 0.0, path);
    EXPECT_FALSE(verdict.valid) << "edge " << blocked;
    EXPECT_EQ(verdict.edge, blocked) << verdict.first_contact;
  }
}

TEST(PathCheck, EveryStateOfAVoxelIsBlockedUnderThePoliciesThatDoNotAllowIt) {
  const Robot disc = load_robot("point");  // its only part: base
  FreeSpaceMap builder({.resolution = edge, .integration = Integration::compatible});
  const int ours = builder.add_volume("ours", {"base"}), others = builder.add_volume("others", {"hand"});
  const auto place = [](int i) { return Eigen::Vector3d(2.0 * i + 0.025, 0.025, 0.025); };
  constexpr double sphere = 0.6;            // holds the disc and the voxels that it touches
  const auto look_all_round = [&](int i) {  // rays that free what a sphere of this size holds
    Scan scan;
    scan.map_from_sensor.translation() = place(i);
    Random random(11);
    for (int k = 0; k < 20'000; ++k)
      scan.points.push_back((sphere * random.point(1.0).normalized()).cast<float>());
    builder.insert(scan);
  };
  struct Case {
    VoxelState state;
    bool not_occupied, known_free, painted;  ///< whether the disc may be there
  };
  const Case cases[] = {{VoxelState::unknown, true, false, false},
                        {VoxelState::seen_free, true, true, false},
                        {VoxelState::painted, true, true, true},
                        {VoxelState::occupied, false, false, false},
                        {VoxelState::conflict, false, false, false},
                        {VoxelState::painted, true, true, false}};  // for another part
  look_all_round(1);
  builder.paint(ours, {place(2), sphere});
  look_all_round(3);
  occupy(builder, place(3));
  occupy(builder, place(3));
  occupy(builder, place(3));
  builder.paint(ours, {place(4), sphere});
  occupy(builder, place(4));
  builder.paint(others, {place(5), sphere});
  const Snapshot map = builder.snapshot();
  for (int i = 0; i < 6; ++i) {
    ASSERT_EQ(map.state(place(i)), cases[i].state) << i;
    const Eigen::Vector2d at(place(i).x(), place(i).y()), on(at.x() + 0.05, at.y());
    const auto is_valid = [&](Policy policy) {
      const bool valid = check_path(disc, map, {{"base", policy}}, 0.0, {at, on}).valid;
      const ConfigurationSpace space(disc, map, {.parts = {{"base", policy}}});
      EXPECT_EQ(space.is_edge_free(at, on), valid) << i;  // whoever plans agrees
      return valid;
    };
    EXPECT_EQ(is_valid(Policy::not_occupied), cases[i].not_occupied) << i;
    EXPECT_EQ(is_valid(Policy::known_free), cases[i].known_free) << i;
    EXPECT_EQ(is_valid(Policy::painted), cases[i].painted) << i;
  }
}

/// Random edges, long ones too, in a world of their own: none may be valid that touches when sampled densely.
void expect_agreement_with_dense_samples(const Robot& robot, std::uint64_t seed, int obstacles, int edges) {
  Random random(seed);
  const std::vector<Eigen::Vector3d> cubes = random_cubes(robot, random, obstacles);
  const Snapshot map = map_of(cubes);
  const FclTruth truth(robot, cubes, edge);
  int valid = 0, refused = 0, wrongly_refused = 0;
  for (int i = 0; i < edges; ++i) {
    const Configuration from = random.configuration(robot);
    const Configuration to = from + random.unit() * (random.configuration(robot) - from);
    const PathVerdict verdict = check_path(robot, map, {}, 0.0, {from, to});
    (verdict.valid ? valid : refused)++;
    bool touched = false;
    double least = 0.2;
    for (int k = 0; k <= 300 && !touched; ++k) {
      const LinkPoses poses = forward_kinematics(robot, from + (to - from) * k / 300);
      touched = truth.touches_itself(poses) || truth.touches_cube(poses);
      if (verdict.valid && k % 10 == 0) least = std::min(least, truth.cube_distance(poses, 0.2));
    }
    EXPECT_FALSE(verdict.valid && touched) << robot.name << " seed " << seed << " edge " << i;
    EXPECT_LE(verdict.valid ? verdict.min_clearance : 0.0, least + 1e-9) << robot.name << " edge " << i;
    wrongly_refused += !verdict.valid && !touched;
  }
  EXPECT_GT(valid, edges / 20) << robot.name;
  EXPECT_GT(refused, edges / 20) << robot.name;
  EXPECT_LT(wrongly_refused, edges / 20 + 2) << robot.name;
}

TEST(PathCheck, NoEdgeOfMimicJointsSlidesOrTwoArmsIsValidThatTouchesOnItsWay) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          scissors = worlds::scissors(), rack = worlds::rack_and_pinion();
  for (const Robot& robot : {whip.robot(), telescope.robot(), scissors.robot(), rack.robot()}) {
    expect_agreement_with_dense_samples(robot, 21, 0, 150);
    expect_agreement_with_dense_samples(robot, 22, 2, 150);
  }
}

TEST(PathCheck, NoBodyMovesFartherAndNoPairComesNearerThanItsBoundsForEveryKindOfJoint) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          scissors = worlds::scissors(), rack = worlds::rack_and_pinion();
  for (const Robot& robot :
       {whip.robot(), telescope.robot(), scissors.robot(), rack.robot(), load_robot("panda")}) {
    const check::KdlArm arm(robot);
    const check::FclBodies fcl(robot);
    Random random(6);
    double tightest_motion = 0.0, tightest_approach = 0.0;
    for (int i = 0; i < 1'000; ++i) {
      const Configuration from = random.configuration(robot);
      const Configuration to = from + 0.01 * (random.configuration(robot) - from);
      const Eigen::VectorXd moved = (to - from).cwiseAbs();
      check::BodyPoses before, after;
      arm.place(from, before);
      arm.place(to, after);
      for (std::size_t b = 0; b < before.size(); ++b) {
        const Eigen::Vector3d point = robot.bodies[b].shape.support(random.point(1.0));
        const double way = (after[b] * point - before[b] * point).norm(), bound = arm.motion(b, moved);
        ASSERT_LE(way, bound * (1 + 1e-9) + 1e-12) << robot.name << " " << robot.bodies[b].part;
        if (bound > 1e-3) tightest_motion = std::max(tightest_motion, way / bound);
        for (std::size_t a = 0; a < b; ++a) {
          const double nearer =
              std::abs(fcl.distance(a, before[a], b, before[b]) - fcl.distance(a, after[a], b, after[b]));
          const double most = arm.approach(a, b, moved);
          ASSERT_LE(nearer, most + 1e-6) << robot.name;
          if (most > 1e-3) tightest_approach = std::max(tightest_approach, nearer / most);
        }
      }
    }
    EXPECT_GT(tightest_motion, 0.5) << robot.name;
    EXPECT_GT(tightest_approach, 0.4) << robot.name;
  }
}

TEST(PathCheck, AnEdgeThatEndsJustInsideOfWhatBlocksIsRefusedAndOneJustBeforeItIsNot) {
  for (const char* name : {"puma560", "arm5", "planar2"}) {
    const Robot robot = load_robot(name);
    const Snapshot map = worlds::voxels_about(robot, 4);
    const ConfigurationSpace space(robot, map, {.critical_by_default = false}, {.padding = 0.01});
    Random random(35);
    for (int edges = 0; edges < 12;) {
      const Configuration from = random.configuration(robot), to = random.configuration(robot);
      const auto end = worlds::just_inside(space.collision_model(), from, from + 0.3 * (to - from));
      if (!end) continue;
      const Configuration inside = *end + 1e-5 * (*end - from), before = *end - 0.02 * (*end - from);
      EXPECT_FALSE(check_path(robot, map, {}, 0.01, {from, inside}).valid) << name << ' ' << edges;
      const PathVerdict free = check_path(robot, map, {}, 0.01, {from, before});
      EXPECT_EQ(free.valid, space.is_edge_free(from, before)) << name << ' ' << edges << free.first_contact;
      ++edges;
    }
  }
}

/// Two balls 43 m apart on one carriage: some 2e9 voxels are about both, and few about each.
TEST(PathCheck, EdgesAboutWhichVoxelsAreTooManyAreCheckedBodyByBody) {
  const std::string ball = "<sphere radius='0.1'/>";
  const worlds::UrdfRobot pair(
      "pair", "<link name='base'/>" + worlds::urdf_link("near", "0 0 0", ball) +
                  worlds::urdf_link("far", "0 0 0", ball) +
                  worlds::urdf_joint("slide", "prismatic", "base", "near", "0 0 0", "1 0 0",
                                     worlds::urdf_limit(0, 1)) +
                  worlds::urdf_joint("weld", "fixed", "near", "far", "25 25 25", "1 0 0", ""));
  FreeSpaceMap builder({.resolution = 0.02});
  occupy(builder, {25.51, 25.01, 25.01});
  occupy(builder, {0.81, 0.01, 0.01});
  const auto verdict = [&](double to) {
    return check_path(pair.robot(), builder.snapshot(), {}, 0.001,
                      {Configuration::Zero(1), Configuration::Constant(1, to)});
  };
  const PathVerdict free = verdict(0.3);
  EXPECT_TRUE(free.valid) << free.first_contact;
  EXPECT_LE(free.min_clearance, 0.1 + 1e-9);
  EXPECT_GT(free.min_clearance, 0.07);
  EXPECT_NEAR(free.clearance.back(), 0.1, 1e-6);
  const PathVerdict met = verdict(0.5);
  EXPECT_FALSE(met.valid);
  EXPECT_NE(met.first_contact.find("far comes too near to a voxel that is occupied, at (25.51"),
            std::string::npos)
      << met.first_contact;
}

}  // namespace path_check_test
}  // namespace clearway
