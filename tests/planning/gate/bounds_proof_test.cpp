// That parts stay in the map's bounds all along edges, against the survey of the independent check.
#include "planning/gate/bounds_proof.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "planning/gate/gate.hpp"
#include "planning/gate/motion_proof.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace bounds_proof_test {

const Policies unknown_is_free{.other = Policy::not_occupied, .critical_by_default = false};

/// Rays that met nothing, along x and y: seen up to `range` from the origin, not further; and obstacles.
Snapshot seen_about(double range, const std::vector<Eigen::Vector3d>& occupied = {}) {
  constexpr double edge = 0.05;
  FreeSpaceMap map({.resolution = edge});
  Scan scan;
  scan.map_from_sensor.translation().setConstant(edge / 2);
  for (const float side : {-9.0F, 9.0F}) {
    scan.points.emplace_back(side, 0.0F, 0.0F);
    scan.points.emplace_back(0.0F, side, 0.0F);
    scan.points.emplace_back(0.0F, 0.0F, side);
  }
  map.insert(scan, {.max_range = range});
  for (const Eigen::Vector3d& place : occupied) occupy(map, place);
  return map.snapshot();
}

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

TEST(BoundsProof, TheDiscStaysWhereSomeOfItIsInside) {
  const ConfigurationSpace space(load_robot("point"), seen_about(1.0), unknown_is_free);  // radius 0.2 m
  const BoundsProof proof(space, {});
  const double last = space.map().bounds().max().x() + 0.2;
  EXPECT_FALSE(proof.leaving(space.robot(), at(0, 0), at(last - 0.01, 0)));
  EXPECT_FALSE(proof.leaving(space.robot(), at(last - 0.01, 0), at(last - 0.01, 0)));
  const auto left = proof.leaving(space.robot(), at(0, 0), at(last + 0.3, 0));
  ASSERT_TRUE(left);
  EXPECT_EQ(left->part, "base");
  EXPECT_GT(left->place.parameter * (last + 0.3), last - 0.001);
  EXPECT_TRUE(proof.leaving(space.robot(), at(last + 0.3, 0), at(last + 0.3, 0)));
  EXPECT_TRUE(proof.leaving(space.robot(), at(last, -0.5), at(last, 0.5)));  // along the rim: not proved
  const BoundsProof allowed(space, {"base"});
  EXPECT_FALSE(allowed.leaving(space.robot(), at(0, 0), at(5, 0)));
  EXPECT_THROW(BoundsProof(space, {"elbow"}), std::invalid_argument);
}

TEST(BoundsProof, AsksNothingWhereTheSurveyDoesNot) {
  const auto leaves = [](Snapshot map, const Policies& policies) {
    const ConfigurationSpace space(load_robot("point"), std::move(map), policies);
    return BoundsProof(space, {}).leaving(space.robot(), at(0, 0), at(0, 5)).has_value();
  };
  EXPECT_TRUE(leaves(seen_about(1.0), unknown_is_free));
  EXPECT_TRUE(leaves(Snapshot(), unknown_is_free));
  EXPECT_FALSE(leaves(seen_about(1.0), {.other = Policy::known_free}));
  const VoxelScene wall{0.1, {box_of(1.0, -1.0, -0.1, 1.2, 1.0, 0.1)}, {}, {}};
  EXPECT_FALSE(leaves(wall.snapshot(), unknown_is_free));  // obstacles alone say not where sensors looked
}

/// What is proved the survey never refuses; what is not it refuses, but where a part is inside by less than
/// a 64th of a voxel, or outside between its poses.
TEST(BoundsProof, HoldsForDrawnEdgesOfArmsWhereTheSurveyDoes) {
  int stays = 0, leaves = 0, undecided = 0;
  for (const char* name : {"puma560", "arm5", "point"}) {
    Random random(3);
    for (int world = 0; world < 6; ++world) {
      Robot robot = load_robot(name);
      robot.map_from_base = random.pose(0.3);
      const ConfigurationSpace space(robot, seen_about(random.between(0.3, 0.9)), unknown_is_free);
      const BoundsProof proof(space, {});
      for (int edge = 0; edge < 15; ++edge) {
        const Configuration from = random.configuration(robot);
        const Configuration to = from + 0.2 * (random.configuration(robot) - from);
        const bool is_refused =
            refusal(survey_path(robot, space.map(), space.policies(), {from, to}), {}).has_value();
        const bool is_left = proof.leaving(robot, from, to).has_value();
        ASSERT_TRUE(is_left || !is_refused) << name << ", world " << world << ", edge " << edge;
        (is_left ? is_refused ? leaves : undecided : stays) += 1;
      }
    }
  }
  EXPECT_GT(stays, 15);
  EXPECT_GT(leaves, 30);
  EXPECT_LT(undecided, 8);
}

/// Pieces that come so near to the rim are proved inside only when they are short.
TEST(BoundsProof, IsWhatEndsTheProofOfAMotionAlongTheRim) {
  const ConfigurationSpace space(load_robot("point"), seen_about(1.0), unknown_is_free);
  const ProofSpace proof{space, BoundsProof(space, {})};
  const double last = space.map().bounds().max().x() + 0.2;
  int ended = 0;
  for (double inside = 2e-6; inside < 2e-3; inside *= 1.2) {
    const Configuration from = at(last - inside, -0.5), to = at(last - inside, 0.5);
    if (proof.holds(from, to)) continue;
    ASSERT_TRUE(space.is_edge_free(from, to));
    const ProofEnd end = find_proof_end(proof, {{}, from, to});
    ASSERT_TRUE(end.leaving) << inside;
    EXPECT_EQ(end.leaving->part, "base");
    ++ended;
  }
  EXPECT_GT(ended, 10);
}

TEST(BoundsProof, DoesNotHideWhatIsInTheWayBefore) {
  Random random(5);
  int blocked = 0;
  for (int world = 0; world < 10; ++world) {
    std::vector<Eigen::Vector3d> occupied;
    for (int i = 0; i < 6; ++i)
      occupied.emplace_back(random.between(-0.9, 0.9), random.between(-0.9, 0.9), 0.025);
    const ConfigurationSpace space(load_robot("point"), seen_about(1.0, occupied), unknown_is_free);
    const ProofSpace proof{space, BoundsProof(space, {})};
    for (int i = 0; i < 30; ++i) {
      const Configuration from = at(random.between(-0.8, 0.8), random.between(-0.8, 0.8));
      const Configuration to = at(random.between(-2.5, 2.5), random.between(-2.5, 2.5));
      if (!space.check(from).is_free()) continue;
      double touches = 2.0, leaves = 2.0;
      for (int k = 0; k <= 1000; ++k) {
        const Configuration q = from + k / 1000.0 * (to - from);
        if (touches > 1.0 && !space.check(q).is_free()) touches = k / 1000.0;
        if (leaves > 1.0 && proof.bounds.leaving(space.robot(), q, q)) leaves = k / 1000.0;
      }
      if (touches > 1.0 || leaves - touches < 0.01) continue;
      ++blocked;
      EXPECT_FALSE(find_proof_end(proof, {{}, from, to}).leaving) << world << ", " << i;
    }
  }
  EXPECT_GT(blocked, 40);
}

MotionChunk along_x(const std::vector<double>& places) {
  MotionChunk chunk;
  for (const double x : places) {
    chunk.times.push_back(0.1 * static_cast<double>(chunk.times.size()));
    chunk.positions.push_back(at(x, 0.0));
  }
  return chunk;
}

TEST(Gate, RefusesAPartThatLeavesTheMapAndSaysHowFarItMayGo) {
  Robot disc = load_robot("point");
  for (Joint& joint : disc.joints) joint.max_velocity = 0.0;
  const Snapshot map = seen_about(1.0);
  const double last = map.bounds().max().x() + 0.2;
  std::vector<double> places;  // 1 m/s: stands 0.1 m farther
  for (int i = 0; i < 7; ++i) places.push_back(last - 0.35 + 0.1 * i);
  const MotionChunk chunk = along_x(places);
  Gate gate({.limits = {.max_velocity = {10.0}, .deceleration = {5.0}}});
  gate.publish({disc, map, unknown_is_free});
  const GateVerdict verdict = gate.judge(chunk);
  EXPECT_EQ(verdict.reason, GateReason::outside_map);
  EXPECT_EQ(verdict.obstruction.part, "base");
  for (const char* words : {"base leaves the map's bounds", "--allow-outside base"})
    EXPECT_NE(verdict.sentence.find(words), std::string::npos) << verdict.sentence;
  ASSERT_TRUE(verdict.may_go);
  EXPECT_LT(verdict.may_go->stop[0], last);
  EXPECT_GT(verdict.may_go->stop[0], last - 0.1);
  Gate allowed({.limits = {.max_velocity = {10.0}, .deceleration = {5.0}}, .allow_outside = {"base"}});
  allowed.publish({disc, map, unknown_is_free});
  EXPECT_TRUE(allowed.judge(chunk).is_passed());
  Gate unknown({.allow_outside = {"elbow"}});
  EXPECT_THROW(unknown.publish({disc, map, unknown_is_free}), std::invalid_argument);
  EXPECT_EQ(unknown.judge(chunk).reason, GateReason::no_map);
}

}  // namespace bounds_proof_test
}  // namespace clearway
