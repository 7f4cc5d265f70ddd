// ConfigurationSpace::is_edge_free, where its bounds are hard to get right: joints that turn a link by a
// multiple of their value, slides, pairs of bodies, bodies that stand still.

#include <gtest/gtest.h>

#include <numeric>

#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/slide_robot.hpp"
#include "tests/worlds/trials.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace edge_proof_test {

constexpr double edge = 0.05;

Policies not_occupied() { return {.critical_by_default = false}; }

std::vector<Eigen::Vector3d> cubes_about(const Robot& robot, Random& random, int count) {
  std::vector<Eigen::Vector3d> cubes;
  for (int i = 0; i < count; ++i) {
    const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
    const Body& body = robot.bodies[robot.bodies.size() - 1 - static_cast<std::size_t>(random.below(2))];
    const Eigen::Vector3d near = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape *
                                 body.shape.support(random.point(1.0));
    cubes.emplace_back(((near / edge).array().floor() + 0.5) * edge);
  }
  return cubes;
}

Snapshot map_of(const std::vector<Eigen::Vector3d>& cubes) {
  FreeSpaceMap builder({.resolution = edge});
  for (const Eigen::Vector3d& cube : cubes) occupy(builder, cube);
  return builder.snapshot();
}

/// How many random edges are accepted and how many refused; none accepted may touch when sampled densely.
struct Count {
  int accepted = 0, refused = 0, wrongly_refused = 0;
};
Count try_edges(const Robot& robot, int obstacles, std::uint64_t seed, int edges) {
  Random random(seed);
  const std::vector<Eigen::Vector3d> cubes = cubes_about(robot, random, obstacles);
  const ConfigurationSpace space(robot, map_of(cubes), not_occupied());
  const FclTruth truth(robot, cubes, edge);
  Count count;
  for (int i = 0; i < edges; ++i) {
    const Configuration from = random.configuration(robot);
    const Configuration to = from + random.unit() * (random.configuration(robot) - from);
    const bool free = space.is_edge_free(from, to);
    (free ? count.accepted : count.refused)++;
    bool touched = false;
    for (int k = 0; k <= 400 && !touched; ++k) {
      const LinkPoses poses = forward_kinematics(robot, from + (to - from) * k / 400);
      touched = truth.touches_itself(poses) || truth.touches_cube(poses);
    }
    EXPECT_FALSE(free && touched) << robot.name << " seed " << seed << " edge " << i << " from "
                                  << from.transpose() << " to " << to.transpose();
    count.wrongly_refused += !free && !touched;
  }
  return count;
}

TEST(EdgeProof, NoEdgeOfAMimicJointIsAcceptedThatTouchesOnItsWay) {
  const worlds::UrdfRobot whip = worlds::whip();
  for (const int obstacles : {0, 2}) {
    const Count count = try_edges(whip.robot(), obstacles, 1, 300);
    EXPECT_GT(count.accepted, 30);
    EXPECT_GT(count.refused, 30);
    EXPECT_LT(count.wrongly_refused, 10);
  }
}

TEST(EdgeProof, NoEdgeOfASlideIsAcceptedThatTouchesOnItsWay) {
  const worlds::UrdfRobot telescope = worlds::telescope();
  for (const int obstacles : {0, 2}) {
    const Count count = try_edges(telescope.robot(), obstacles, 2, 300);
    EXPECT_GT(count.accepted, 30);
    EXPECT_GT(count.refused, 30);
    EXPECT_LT(count.wrongly_refused, 10);
  }
}

TEST(EdgeProof, NoEdgeOfAMimicJointOfAnotherKindIsAcceptedThatTouchesOnItsWay) {
  const worlds::UrdfRobot rack = worlds::rack_and_pinion();
  for (const int obstacles : {0, 2}) {
    const Count count = try_edges(rack.robot(), obstacles, 4, 300);
    EXPECT_GT(count.accepted, 30);
    EXPECT_GT(count.refused, 30);
    EXPECT_LT(count.wrongly_refused, 10);
  }
}

TEST(EdgeProof, NoEdgeOfTwoArmsIsAcceptedOnWhichTheyMeet) {
  const worlds::UrdfRobot scissors = worlds::scissors();
  const Count count = try_edges(scissors.robot(), 0, 3, 400);
  EXPECT_GT(count.accepted, 80);
  EXPECT_GT(count.refused, 80);
  EXPECT_LT(count.wrongly_refused, 10);
}

/// A sphere of 5 cm on a slide along x, past or into one of 5 cm on its base, x = 1 m: no bound on its motion
/// has slack.
worlds::UrdfRobot sliding_sphere(double beside) {
  const std::string sphere = "<sphere radius='0.05'/>";
  return {"slider", worlds::urdf_link("base", "1 " + std::to_string(beside) + " 0", sphere) +
                        "<link name='turntable'/>" + worlds::urdf_link("hand", "0 0 0", sphere) +
                        worlds::urdf_joint("turn", "revolute", "base", "turntable", "0 0 0", "0 0 1",
                                           worlds::urdf_limit(-1, 1)) +
                        worlds::urdf_joint("slide", "prismatic", "turntable", "hand", "0 0 0", "1 0 0",
                                           worlds::urdf_limit(-10, 2))};
}

TEST(EdgeProof, ABodyThatRunsStraightIntoAnotherIsRefusedHoweverFarAwayItStarts) {
  const worlds::UrdfRobot slider = sliding_sphere(0.0);
  const ConfigurationSpace space(slider.robot(), Snapshot(), not_occupied());
  for (const double start : {0.8, 0.5, 0.0, -2.0, -9.0}) {
    const auto reaches = [&](double end) {
      return space.is_edge_free(Eigen::Vector2d(0.0, start), Eigen::Vector2d(0.0, end));
    };
    EXPECT_TRUE(reaches(0.899)) << start;
    for (const double end : {0.901, 0.95, 1.0, 1.5}) EXPECT_FALSE(reaches(end)) << start << " to " << end;
  }
}

TEST(EdgeProof, BodiesThatPassMoreThanHalfTheEdgeResolutionApartAreProvedToDoSo) {
  constexpr double resolution = 0.01, gap = 0.51 * resolution;
  const worlds::UrdfRobot slider = sliding_sphere(0.1 + gap);
  const ConfigurationSpace space(slider.robot(), Snapshot(), not_occupied(), {.edge_resolution = resolution});
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector2d from(0.0, random.between(-1.0, 1.0)), to(0.0, random.between(1.0, 2.0));
    ASSERT_TRUE(space.is_edge_free(from, to)) << from.y() << " to " << to.y();
    ASSERT_TRUE(space.is_edge_free(to, from)) << to.y() << " to " << from.y();
  }
}

TEST(EdgeProof, AnEdgeThatStartsBesideAnObstacleIsJudgedAsTheOneBack) {
  const worlds::UrdfRobot slider = sliding_sphere(5.0);
  FreeSpaceMap builder({.resolution = 0.1});
  occupy(builder, {0.05, 0.05, 0.05});  // up to x = 0.1, before which the sphere begins and ends
  const ConfigurationSpace space(slider.robot(), builder.snapshot(), not_occupied(),
                                 {.edge_resolution = 0.01});
  int accepted = 0, refused = 0;
  for (double room = -0.0025; room < 0.01; room += 0.0005) {  // below 0 they overlap
    for (double length = 0.05; length < 1.5; length += 0.05) {
      const Eigen::Vector2d near(0.0, 0.15 + room), far(0.0, 0.15 + room + length);
      const bool is_free = space.is_edge_free(near, far);
      ASSERT_EQ(space.is_edge_free(far, near), is_free) << room << " m apart, " << length << " m long";
      ASSERT_TRUE(is_free || room < 0.0051) << room << " m apart, " << length << " m long";
      (is_free ? accepted : refused)++;
    }
  }
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 10);
}

TEST(EdgeProof, BodiesThatStandStillOnTheEdgeKeepTheirPadding) {
  const Robot arm = load_robot("planar2");                          // capsules of radius 0.05 and 1 m
  const std::vector<Eigen::Vector3d> cubes{{0.525, 0.125, 0.025}};  // from y = 0.1 on, beside the upper arm
  const Eigen::Vector2d from(0.0, -1.0), to(0.0, -1.5);             // the elbow alone turns, away from it
  const auto is_free = [&](double padding) {
    const ConfigurationSpace space(arm, map_of(cubes), not_occupied(), {.padding = padding});
    EXPECT_EQ(space.is_free(from), space.is_edge_free(from, to)) << padding;
    return space.is_edge_free(from, to);
  };
  EXPECT_TRUE(is_free(0.0));
  EXPECT_TRUE(is_free(0.049));
  EXPECT_FALSE(is_free(0.051));
  EXPECT_FALSE(is_free(0.09));
  // In a tube padding adds to how far the upper arm may be from where it stands, half a metre from the
  // shoulder.
  const auto is_tube_free = [&](double padding, double aside) {
    const ConfigurationSpace space(arm, map_of(cubes), not_occupied(), {.padding = padding});
    return space.is_edge_free(from, to, Eigen::Vector2d(aside, 0.0));
  };
  EXPECT_TRUE(is_tube_free(0.01, 0.01));
  EXPECT_TRUE(is_tube_free(0.0, 0.04));
  EXPECT_TRUE(is_tube_free(0.04, 0.0));
  EXPECT_FALSE(is_tube_free(0.04, 0.04));
}

TEST(EdgeProof, NoBodyMovesFartherAndNoPairComesNearerThanTheBoundsOfEveryKindOfJoint) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          scissors = worlds::scissors(), rack = worlds::rack_and_pinion();
  for (const Robot& robot : {whip.robot(), telescope.robot(), scissors.robot(), rack.robot()}) {
    const ConfigurationSpace space(robot, Snapshot(), not_occupied());
    const std::vector<BodyPair> pairs = self_collision_pairs(robot);
    ASSERT_FALSE(pairs.empty()) << robot.name;
    std::vector<std::shared_ptr<fcl::CollisionGeometryd>> shapes;
    for (const Body& body : robot.bodies) shapes.push_back(fcl_geometry(body.shape));
    Random random(7);
    double tightest_motion = 0.0, tightest_approach = 0.0;
    for (int i = 0; i < 2'000; ++i) {
      const Configuration from = random.configuration(robot);
      const Configuration to = from + 0.01 * (random.configuration(robot) - from);
      const Eigen::VectorXd moved = (to - from).cwiseAbs();
      const LinkPoses a = forward_kinematics(robot, from), b = forward_kinematics(robot, to);
      for (const Body& body : robot.bodies) {
        const Eigen::Vector3d point = body.link_from_shape * body.shape.support(random.point(1.0));
        const auto link = static_cast<std::size_t>(body.link);
        const double share = (b[link] * point - a[link] * point).norm() / space.motion_bound(moved);
        ASSERT_LE(share, 1 + 1e-9) << robot.name << " " << body.part;
        tightest_motion = std::max(tightest_motion, share);
      }
      for (const BodyPair& pair : pairs) {
        const auto gap = [&](const LinkPoses& poses) {
          const auto first = static_cast<std::size_t>(pair.first),
                     second = static_cast<std::size_t>(pair.second);
          const Body &one = robot.bodies[first], &other = robot.bodies[second];
          return fcl_distance(
              shapes[first].get(), poses[static_cast<std::size_t>(one.link)] * one.link_from_shape,
              shapes[second].get(), poses[static_cast<std::size_t>(other.link)] * other.link_from_shape);
        };
        const double nearer = std::abs(gap(a) - gap(b)), bound = pair.approach.dot(moved);
        ASSERT_LE(nearer, bound * (1 + 1e-9) + 1e-6) << robot.name;
        if (bound > 1e-3) tightest_approach = std::max(tightest_approach, nearer / bound);
      }
    }
    EXPECT_GT(tightest_motion, 0.5) << robot.name;
    EXPECT_GT(tightest_approach, 0.4) << robot.name;
  }
}

/// Whatever is in the tube, corners and all, is free; and none but a sound deviation is taken.
TEST(EdgeProof, NoTubeIsAcceptedInWhichSomethingTouches) {
  for (const char* name : {"panda", "arm5", "arm6"}) {
    const Robot robot = load_robot(name);
    Random random(21);
    const std::vector<Eigen::Vector3d> cubes = cubes_about(robot, random, 6);
    const ConfigurationSpace space(robot, map_of(cubes), not_occupied());
    const FclTruth truth(robot, cubes, edge);
    int accepted = 0, refused = 0;
    const int edges = trials(90, 300);
    for (int i = 0; i < edges; ++i) {
      const Configuration from = random.configuration(robot);
      const Configuration to = from + 0.3 * random.unit() * (random.configuration(robot) - from);
      Eigen::VectorXd aside(from.size());
      for (double& value : aside) value = random.below(3) == 0 ? 0.0 : random.between(0.0, 0.1);
      const bool is_free = space.is_edge_free(from, to, aside);
      (is_free ? accepted : refused)++;
      if (!is_free) continue;
      ASSERT_TRUE(space.is_edge_free(from, to)) << name << " " << i;
      for (int k = 0; k < 300; ++k) {
        Configuration q = from + random.unit() * (to - from);
        for (Eigen::Index j = 0; j < q.size(); ++j)
          q[j] += aside[j] * (k % 2 == 0 ? 1 - 2 * random.below(2) : random.between(-1, 1));
        const LinkPoses poses = forward_kinematics(robot, q);
        ASSERT_FALSE(truth.touches_itself(poses) || truth.touches_cube(poses)) << name << " " << i;
      }
    }
    EXPECT_GT(accepted, edges / 15) << name;
    EXPECT_GT(refused, edges / 30) << name;
  }
}

/// A ball on a slide stands 0.1 m before another one: free as far as it may be aside.
TEST(EdgeProof, ATubeAboutARobotThatStandsKeepsItsPairsApart) {
  const std::string ball = "<sphere radius='0.05'/>";
  const worlds::UrdfRobot slider(
      "slider", worlds::urdf_link("base", "1 0 0", ball) + "<link name='turntable'/>" +
                    worlds::urdf_link("hand", "0 0 0", ball) +
                    worlds::urdf_joint("turn", "revolute", "base", "turntable", "0 0 0", "0 0 1",
                                       worlds::urdf_limit(-1, 1)) +
                    worlds::urdf_joint("slide", "prismatic", "turntable", "hand", "0 0 0", "1 0 0",
                                       worlds::urdf_limit(-10, 2)));
  const ConfigurationSpace space(slider.robot(), Snapshot(), not_occupied());
  const auto is_free = [&](double from, double to, double aside) {
    return space.is_edge_free(Eigen::Vector2d(0.0, from), Eigen::Vector2d(0.0, to),
                              Eigen::Vector2d(0.0, aside));
  };
  EXPECT_TRUE(is_free(0.8, 0.8, 0.0999));
  EXPECT_FALSE(is_free(0.8, 0.8, 0.1001));
  EXPECT_TRUE(is_free(0.7, 0.8, 0.098));
  EXPECT_FALSE(is_free(0.7, 0.8, 0.1001));
}

TEST(EdgeProof, ATubeWithoutWidthIsTheEdgeAndOneThatIsNoTubeIsRefused) {
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, map_of({{5.025, 5.025, 0.025}}), not_occupied());
  const Eigen::Vector2d from(0.0, 0.5), to(0.5, 1.0);
  EXPECT_TRUE(space.is_edge_free(from, to, Eigen::Vector2d::Zero()));
  EXPECT_FALSE(space.is_edge_free(from, to, Eigen::Vector2d(0.0, -1e-9)));
  EXPECT_FALSE(space.is_edge_free(from, to, Eigen::Vector2d(0.0, std::nan(""))));
  EXPECT_FALSE(space.is_edge_free(from, to, Eigen::Vector2d(HUGE_VAL, 0.0)));
  EXPECT_FALSE(space.is_edge_free(from, to, Eigen::Vector3d::Zero()));
}

/// Poses that are handed in, and what is known of the ends, save time: a neighbour's edges are asked one
/// after the other, from either end, with what the ones before have found.
TEST(EdgeProof, WhatIsKnownOfAnEdgeChangesNoAnswer) {
  int accepted = 0, refused = 0;
  for (const char* name : {"arm5", "panda"}) {
    const Robot robot = load_robot(name);
    Random random(17);
    const ConfigurationSpace space(robot, map_of(cubes_about(robot, random, 12)), not_occupied(),
                                   {.padding = 0.01});
    const CollisionModel& model = space.collision_model();
    std::vector<int> all(model.members());
    std::iota(all.begin(), all.end(), 0);
    const KnownClearances nothing{std::vector<double>(model.members(), -1.0),
                                  std::vector<double>(model.members(), HUGE_VAL)};
    for (int i = 0; i < 60; ++i) {
      const Configuration from = random.configuration(model.robot);
      if (!model.is_free_by_shapes(from)) continue;
      KnownClearances of_from = nothing;
      for (int k = 0; k < 4; ++k) {
        const Configuration to = from + random.unit() * (random.configuration(model.robot) - from);
        KnownClearances of_to = nothing;
        std::vector<RecentCubes> recent(model.bodies.size());
        const bool is_free = model.is_edge_free_by_shapes(from, to);
        (is_free ? accepted : refused)++;
        const Configuration middle = from + 0.5 * (to - from);
        const EdgePoses forth{forward_kinematics(model.robot, from), forward_kinematics(model.robot, middle),
                              forward_kinematics(model.robot, to)};
        ASSERT_EQ(model.is_edge_free(from, to, all, recent, nullptr, nullptr, &forth), is_free) << name;
        ASSERT_EQ(model.is_edge_free(from, to, all, recent, &of_from, &of_to, &forth), is_free) << name;
        ASSERT_EQ(model.is_edge_free(from, to, all, recent, &of_from, &of_to), is_free) << name;
      }
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 20);
}

/// A ball of 0.05 m before a wall at 0.5 m, on edges that are proved half way or not at all: with the pose of
/// another place half way, one out of the wall, or into it, would be.
TEST(EdgeProof, ThePosesOfAnEdgeAreTakenForItsBeginningItsMiddleAndItsEnd) {
  Robot robot = worlds::slide_robot();
  robot.joints[0].lower = -1.0;
  robot.bodies[0].shape = Shape::sphere(0.05);
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  const VoxelScene wall{0.05, {box_of(0.501, -0.1, -0.1, 0.549, 0.1, 0.1)}, {}, {}};
  const ConfigurationSpace space(robot, wall.snapshot(), not_occupied(),
                                 {.padding = 0.0, .max_distance = 1.0, .edge_resolution = 0.4});
  const CollisionModel& model = space.collision_model();
  const auto at = [](double x) { return Configuration::Constant(1, x); };
  for (const auto& [inner, outer] : {std::pair(0.3, -0.06), std::pair(0.46, 0.1)})
    for (const bool is_inwards : {false, true}) {
      const Configuration from = at(is_inwards ? outer : inner), to = at(is_inwards ? inner : outer);
      const EdgePoses poses{forward_kinematics(model.robot, from),
                            forward_kinematics(model.robot, (from + to) / 2),
                            forward_kinematics(model.robot, to)};
      std::vector<RecentCubes> recent(model.bodies.size());
      EXPECT_EQ(model.is_edge_free(from, to, {0}, recent, nullptr, nullptr, &poses), inner < 0.45)
          << inner << ' ' << is_inwards;
    }
}

TEST(EdgeProof, PiecesInARowAreProvedWhereEachOfThemIsProvedAlone) {
  int proved = 0, refused = 0, by_themselves = 0;
  for (const char* name : {"puma560", "arm5", "panda"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), not_occupied());
    const CollisionModel& model = space.collision_model();
    EdgePieces pieces(*model.spheres);
    Random random(29);
    for (int i = 0; i < 8000; ++i) {
      const Configuration from = random.configuration(model.robot);
      const Configuration to = from + 0.1 * random.unit() * (random.configuration(model.robot) - from);
      if (!space.is_free(from) || pieces.examine(from, to) != EdgePieces::Finding::open) continue;
      const auto is_proved = [&](const std::vector<EdgePieces::Piece>& some) {
        return model.are_pieces_free(from, to, some, pieces.open_members());
      };
      bool each = true, each_by_itself = true;
      for (const EdgePieces::Piece& one : pieces.open_pieces()) {
        each = each && is_proved({one});
        each_by_itself = each_by_itself && model.is_edge_free_by_shapes(from + one.begin * (to - from),
                                                                        from + one.end * (to - from));
      }
      ASSERT_EQ(is_proved(pieces.open_pieces()), each) << name << " edge " << i;
      if (each_by_itself) {
        ASSERT_TRUE(each) << name << " edge " << i;
        ++by_themselves;
      }
      (each ? proved : refused)++;
    }
  }
  EXPECT_GT(std::min({proved, refused, by_themselves}), 100);
}

TEST(EdgeProof, AnEdgeThatEndsJustInsideOfWhatBlocksIsRefusedFromEitherEnd) {
  int edges = 0, proved_before = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    for (const double padding : {0.0, 0.02}) {
      const Policies policies{.other = padding > 0.0 ? Policy::painted : Policy::not_occupied};
      const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), policies, {.padding = padding});
      const CollisionModel& model = space.collision_model();
      Random random(33);
      for (int i = 0; i < 150; ++i) {
        const Configuration from = random.configuration(model.robot);
        const auto end = worlds::just_inside(model, from, random.configuration(model.robot));
        if (!end) continue;
        ++edges;
        for (const double part : {0.0, 0.8, 0.99}) {
          const Configuration start = from + part * (*end - from), before = start + 0.9 * (*end - start);
          EXPECT_FALSE(model.is_edge_free_by_shapes(start, *end)) << robot.name << " edge " << i;
          EXPECT_FALSE(model.is_edge_free_by_shapes(*end, start)) << robot.name << " edge " << i;
          EXPECT_LT(space.free_share(start, *end), 1.0) << robot.name << " edge " << i;
          proved_before += model.is_edge_free_by_shapes(start, before);
        }
      }
    }
  }
  EXPECT_GT(edges, 100);
  EXPECT_GT(2 * proved_before, 3 * edges);  // or their ends would not be what is refused
}

}  // namespace edge_proof_test
}  // namespace clearway
