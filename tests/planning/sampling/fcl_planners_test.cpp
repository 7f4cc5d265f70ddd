#include "planning/sampling/fcl_planners.hpp"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <map>
#include <thread>

#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/blocked_octree.hpp"
#include "planning/sampling/fcl_octree_space.hpp"
#include "planning/space/part_policies.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace fcl_planners_test {

using Eigen::Vector2d;

/// Furniture and a painted volume about an arm at the origin.
VoxelScene furnished(const std::vector<std::string>& critical) {
  return {0.05,
          {box_of(0.5, 0.3, -0.1, 0.8, 0.6, 0.5), box_of(-0.9, -0.7, -0.1, -0.6, -0.5, 0.4)},
          {{{0.4, 0.0, 0.4}, 0.35}, {{0.0, 0.0, 0.5}, 1.1}, {{0.0, -0.4, 0.6}, 0.4}},
          critical};
}

Policies all_parts(Policy policy) { return {.parts = {}, .other = policy, .critical_by_default = false}; }

PlanResult plan_in(const ConfigurationSpace& space, const Configuration& start, const Configuration& goal,
                   std::uint64_t seed, const PlannerOptions& options) {
  const PathCost cost(space.robot());
  return make_planner("rrtconnect_fcl", options)->plan({space, cost, start, goal, seed});
}

TEST(BlockedOctree, HoldsExactlyTheVoxelsThatThePolicyForbids) {
  const Snapshot map = furnished({"tool"}).snapshot();
  for (const Requirement& requirement : {Requirement{Policy::not_occupied}, Requirement{Policy::known_free},
                                         Requirement{Policy::painted}, Requirement{Policy::painted, 2}}) {
    const auto tree = blocked_octree(map, requirement);
    int blocked = 0;
    for (double x = -0.575; x < 0.95; x += 0.05) {
      for (double y = -0.675; y < 0.65; y += 0.05) {
        for (double z = -0.275; z < 1.0; z += 0.05) {
          const Voxel voxel = map.voxel({x, y, z});
          const auto* node = tree->search(x, y, z);
          const bool is_blocked = node != nullptr && tree->isNodeOccupied(node);
          ASSERT_EQ(is_blocked, !allows(requirement, voxel.state, voxel.volumes))
              << x << ' ' << y << ' ' << z;
          blocked += is_blocked;
        }
      }
    }
    EXPECT_GT(blocked, 100);
    const auto* far = tree->search(30.0, -80.0, 99.0);
    EXPECT_EQ(far != nullptr, requirement.policy != Policy::not_occupied) << "unknown";
  }
}

TEST(FclOctreeSpace, AgreesWithOurExactDecisionUnderEveryPolicy) {
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    const Snapshot map = furnished(robot.critical_parts).snapshot();
    for (const Policies& policies : {all_parts(Policy::not_occupied), all_parts(Policy::known_free),
                                     all_parts(Policy::painted), Policies{}}) {
      for (const double padding : {0.0, 0.02}) {
        const ConfigurationSpace space(robot, map, policies, {.padding = padding});
        const FclOctreeSpace fcl(space);
        Random random(5);
        int free = 0, refused_by_padding = 0;
        for (int i = 0; i < 400; ++i) {
          const Configuration q = random.configuration(robot);
          const bool ours = space.is_free(q);
          free += ours;
          if (padding == 0.0) {
            EXPECT_EQ(fcl.is_free(q), ours) << name << ": " << q.transpose();
          } else if (fcl.is_free(q)) {  // grown boxes and hulls have corners, so FCL may refuse more
            EXPECT_TRUE(ours) << name << ": " << q.transpose();
          } else {
            refused_by_padding += ours;
          }
        }
        EXPECT_LE(refused_by_padding, 8);
        EXPECT_GT(free, 10);
        EXPECT_LT(free, 400);
      }
    }
  }
}

TEST(FclOctreeSpace, TheUnmappedLayersBesideASlidingDiscAreNoObstacle) {
  const Robot point = load_robot("point");
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("layer", {});
  for (double x = -1.0; x < 1.0; x += 0.02) map.paint(volume, {{x, 0.0, 0.0}, 0.3});
  const ConfigurationSpace space(point, map.snapshot(), all_parts(Policy::painted));
  const FclOctreeSpace fcl(space);
  EXPECT_TRUE(fcl.is_free(Vector2d(0.3, 0.0)));
  EXPECT_FALSE(fcl.is_free(Vector2d(0.3, 1.0)));
  EXPECT_FALSE(fcl.is_free(Vector2d(0.3, std::nan(""))));
}

const std::vector<Eigen::AlignedBox3d> thin_wall = {box_of(1, -2.0, -0.05, 1.05, 0.9, 0.05)};

TEST(FclPlanners, TheSameSeedGivesTheSamePathOnAnyThread) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{0.05, thin_wall, {}, {}}.snapshot(),
                                 all_parts(Policy::not_occupied));
  const PathCost cost(space.robot());
  const Vector2d start(0, 0), goal(2, 0);
  const std::string names[] = {"rrtconnect_fcl", "kpiece_fcl", "prm_fcl", "bitstar_fcl"};
  std::map<std::string, std::vector<PlanResult>> results;
  std::vector<std::thread> threads;
  for (const std::string& name : names) results[name].resize(6);
  for (const std::string& name : names) {
    for (std::size_t i = 0; i < 6; ++i) {
      threads.emplace_back([&, i] {
        PlannerOptions options = {{"resolution", "0.002"}};
        if (name == "bitstar_fcl") options["max_samples"] = "400";
        results.at(name)[i] = make_planner(name, options)->plan({space, cost, start, goal, 1 + i / 3});
      });
    }
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& [name, found] : results) {
    for (const PlanResult& result : found) {
      ASSERT_EQ(result.status, PlanStatus::solved) << name << ": " << result.explanation;
      EXPECT_EQ(result.waypoints.front(), start);
      EXPECT_EQ(result.waypoints.back(), goal);
      EXPECT_NEAR(result.cost, cost(result.waypoints), 1e-9);
    }
    EXPECT_EQ(found[0].waypoints, found[1].waypoints) << name;
    EXPECT_EQ(found[0].waypoints, found[2].waypoints) << name;
    EXPECT_EQ(found[3].waypoints, found[5].waypoints) << name;
    EXPECT_NE(found[0].waypoints, found[3].waypoints) << name;
  }
}

TEST(FclPlanners, StayWhereStartAndGoalAreOne) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{0.05, thin_wall, {}, {}}.snapshot(),
                                 all_parts(Policy::not_occupied));
  for (const char* name : {"rrtconnect_fcl", "kpiece_fcl", "prm_fcl", "bitstar_fcl"}) {
    const PlanResult result =
        make_planner(name, {})->plan({space, PathCost(space.robot()), Vector2d(0, 0), Vector2d(0, 0)});
    EXPECT_EQ(result.status, PlanStatus::solved) << name;
    EXPECT_EQ(result.waypoints.size(), 2u) << name;
  }
}

TEST(RrtConnectFcl, LooksThatAreFarApartMissAThinWallAndTheCheckFindsIt) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{0.05, thin_wall, {}, {}}.snapshot(),
                                 all_parts(Policy::not_occupied));
  const Vector2d start(0.2, 0), goal(2, 0);
  int coarse = 0, fine = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    for (const auto& [resolution, valid] : {std::pair{"0.5", &coarse}, std::pair{"0.0005", &fine}}) {
      const PlanResult result = plan_in(space, start, goal, seed, {{"resolution", resolution}});
      ASSERT_EQ(result.status, PlanStatus::solved) << result.explanation;
      *valid += check_path(space.robot(), space.map(), space.policies(), 0.0, result.waypoints).valid;
    }
  }
  EXPECT_EQ(coarse, 0) << "straight through";
  EXPECT_EQ(fine, 5);
}

TEST(RrtConnectFcl, SimplificationShortens) {
  const ConfigurationSpace space(load_robot("point"), VoxelScene{0.05, thin_wall, {}, {}}.snapshot(),
                                 all_parts(Policy::not_occupied));
  const Vector2d start(0, 0), goal(2, 0);
  const auto length = [](const PlanResult& result) {
    double sum = 0.0;
    for (std::size_t i = 1; i < result.waypoints.size(); ++i) {
      sum += (result.waypoints[i] - result.waypoints[i - 1]).norm();
    }
    return sum;
  };
  double plain = 0.0, simplified = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const PlanResult with = plan_in(space, start, goal, seed, {{"resolution", "0.0005"}}),
                     without =
                         plan_in(space, start, goal, seed, {{"resolution", "0.0005"}, {"simplify", "false"}});
    ASSERT_EQ(with.status, PlanStatus::solved) << with.explanation;
    ASSERT_EQ(without.status, PlanStatus::solved) << without.explanation;
    simplified += length(with);
    plain += length(without);
  }
  EXPECT_LT(simplified, plain);
}

TEST(RrtConnectFcl, AMapThatChangedIsNotTakenForTheOldOne) {
  const auto planner = make_planner("rrtconnect_fcl", {{"resolution", "0.002"}});
  const Robot point = load_robot("point");
  const PathCost cost(point);
  for (int round = 0; round < 3; ++round) {
    for (const bool walled : {false, true}) {
      const VoxelScene scene{0.05, walled ? thin_wall : std::vector<Eigen::AlignedBox3d>{}, {}, {}};
      const ConfigurationSpace space(point, scene.snapshot(), all_parts(Policy::not_occupied));
      const PlanResult result = planner->plan({space, cost, Vector2d(0.2, 0), Vector2d(2, 0)});
      ASSERT_EQ(result.status, PlanStatus::solved);
      EXPECT_TRUE(check_path(point, space.map(), space.policies(), 0.0, result.waypoints).valid);
    }
  }
}

}  // namespace fcl_planners_test
}  // namespace clearway
