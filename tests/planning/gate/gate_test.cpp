#include "planning/gate/gate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numbers>
#include <set>
#include <stdexcept>
#include <thread>

#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace gate_test {

using Kind = MotionPiece::Kind;

/// The disc robot, whose radius is 0.2 m, as fast as a gate's options let it be.
Robot disc() {
  Robot robot = load_robot("point");
  for (Joint& joint : robot.joints) joint.max_velocity = 0.0;
  return robot;
}

/// A wall at x = 1 m before the disc.
ConfigurationSpace before_wall(double padding = 0.0) {
  VoxelScene scene;
  scene.occupied = {box_of(1.0, -1.0, 0.0, 1.05, 1.0, 0.05)};
  return {disc(), scene.snapshot(), {.critical_by_default = false}, {.padding = padding}};
}

/// Along x at y = 0, a configuration every 0.1 s.
MotionChunk along_x(const std::vector<double>& places, double begin = 0.0) {
  MotionChunk chunk;
  for (const double x : places) {
    chunk.times.push_back(begin + 0.1 * static_cast<double>(chunk.times.size()));
    chunk.positions.push_back(Eigen::Vector2d(x, 0.0));
  }
  return chunk;
}

GateOptions with_limits(double deceleration, double velocity = 10.0) {
  return {.limits = {.max_velocity = {velocity}, .deceleration = {deceleration}}};
}

TEST(Gate, PassesAMotionOnlyWhenItsStopIsFree) {
  // 1 m/s at the end: with 5 m/s^2 the disc stands 0.1 m farther, with 1.25 m/s^2 0.4 m.
  const MotionChunk chunk = along_x({0.0, 0.1, 0.2, 0.3, 0.4, 0.5});
  Gate hard(with_limits(5.0));
  hard.publish(before_wall());
  const GateVerdict passed = hard.judge(chunk);
  EXPECT_TRUE(passed.is_passed()) << passed.sentence;
  ASSERT_TRUE(passed.may_go);
  EXPECT_EQ(passed.may_go->time, 0.5);
  EXPECT_NEAR(passed.may_go->stop[0], 0.6, 1e-12);
  Gate soft(with_limits(1.25));
  soft.publish(before_wall());
  const GateVerdict refused = soft.judge(chunk);
  EXPECT_EQ(refused.reason, GateReason::blocked);
  ASSERT_TRUE(refused.piece);
  EXPECT_EQ(refused.piece->kind, Kind::braking);
  EXPECT_EQ(refused.piece->waypoint, 5U);
  EXPECT_NEAR(refused.parameter, 0.3 / 0.4, 1e-3);
}

TEST(Gate, AChunkMayLeaveTheLastOneAtAConfigurationThatItNames) {
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  const GateVerdict early = gate.judge(along_x({0.2, 0.25}), 0);
  EXPECT_EQ(early.reason, GateReason::jump);
  EXPECT_NE(early.sentence.find("no chunk was passed"), std::string::npos) << early.sentence;
  ASSERT_TRUE(gate.judge(along_x({0.0, 0.1, 0.2, 0.3, 0.4})).is_passed());
  const GateVerdict unsaid = gate.judge(along_x({0.2, 0.25}));
  EXPECT_EQ(unsaid.reason, GateReason::jump);
  EXPECT_NE(unsaid.sentence.find("configuration 2 of that is: leaves_at"), std::string::npos)
      << unsaid.sentence;
  EXPECT_EQ(gate.judge(along_x({0.2, 0.25}), 3).reason, GateReason::jump);
  EXPECT_NE(gate.judge(along_x({0.2, 0.25}), 5).sentence.find("has 5 configurations"), std::string::npos);
  EXPECT_EQ(gate.judge(along_x({0.2, 5.0}), 2).reason, GateReason::velocity_limit);
  ASSERT_TRUE(gate.judge(along_x({0.2005, 0.25, 0.3}), 2).is_passed()) << "after refusals, too, and joined";
  EXPECT_EQ(gate.judge(along_x({0.4, 0.45})).reason, GateReason::jump) << "the rest is not run";
  EXPECT_TRUE(gate.judge(along_x({0.3, 0.35})).is_passed());
  gate.restart(Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(gate.judge(along_x({0.3, 0.35}), 0).reason, GateReason::jump);
  EXPECT_NE(gate.judge(along_x({0.3, 0.35})).sentence.find("where the robot was said to start it is 0"),
            std::string::npos);
}

/// Towards the wall at 1 m/s and slowing before it: who turns back in its midst needs the way straight on.
TEST(Gate, WhereAChunkLeavesTheLastOneTheRobotCanStop) {
  const MotionChunk slowing = along_x({0.13, 0.23, 0.33, 0.43, 0.53, 0.63, 0.705, 0.755, 0.78, 0.78});
  Gate gate(with_limits(2.6));  // 0.19 m from 1 m/s; the disc may come to 0.8 m
  gate.publish(before_wall());
  for (const auto& [at, x, passes] :
       {std::tuple{std::size_t{2}, 0.33, true}, {std::size_t{5}, 0.63, false}}) {
    gate.restart();
    ASSERT_TRUE(gate.judge(slowing).is_passed()) << gate.judge(slowing).sentence;
    const GateVerdict back = gate.judge(along_x({x, x - 0.1}), at);
    EXPECT_EQ(back.is_passed(), passes) << at << ": " << back.sentence;
    if (passes) continue;
    EXPECT_EQ(back.reason, GateReason::blocked);
    ASSERT_TRUE(back.piece);
    EXPECT_EQ(back.piece->kind, Kind::braking);
    EXPECT_FALSE(back.may_go);
    EXPECT_TRUE(gate.judge(along_x({0.78, 0.7})).is_passed()) << "which goes on to its end";
  }
}

/// A hand that is passed at its limit, as a policy of single precision sends it.
TEST(Gate, ChunksOfSinglePrecisionAtALimitAreProvedThere) {
  Robot robot = disc();
  robot.joints[0].upper = 0.4;
  Gate gate(with_limits(5.0));
  gate.publish({robot, before_wall().map(), {.critical_by_default = false}});
  const auto at_limit = static_cast<double>(0.4F);
  ASSERT_GT(at_limit, 0.4);
  const GateVerdict verdict = gate.judge(along_x({at_limit, at_limit}));
  ASSERT_TRUE(verdict.is_passed()) << verdict.sentence;
  EXPECT_EQ(verdict.may_go->position[0], 0.4);
  gate.restart(Eigen::Vector2d(at_limit, 0.0));
  EXPECT_TRUE(gate.judge(along_x({0.4, 0.3})).is_passed());
}

/// As many joints are not the same joints: the arm's last radians would be the disc's metres.
TEST(Gate, AMapOfAnotherRobotIsRefused) {
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  const Snapshot map = VoxelScene{}.snapshot();
  EXPECT_THROW(gate.publish({load_robot("planar2"), map, {.critical_by_default = false}}),
               std::invalid_argument);
  Robot renamed = disc();
  std::swap(renamed.joints[0].name, renamed.joints[1].name);
  EXPECT_THROW(gate.publish({renamed, map, {.critical_by_default = false}}), std::invalid_argument);
  Robot with_more = disc();
  with_more.joints.push_back(with_more.joints[1]);
  with_more.joints.back().name = "z";
  EXPECT_THROW(gate.publish({with_more, map, {.critical_by_default = false}}), std::invalid_argument);
  EXPECT_EQ(gate.publish(before_wall()), 2U);
}

TEST(Gate, FingersThatHoldALoadStandStill) {
  const worlds::UrdfRobot gripper = worlds::gripper();
  Load can;
  can.name = "can";
  can.link = "palm";
  can.shape = Shape::sphere(0.01);
  can.link_from_load.translation().z() = -0.08;
  can.touches = {"left", "right"};
  const auto moved = [](double begin, double x, double grip, double at_end) {
    MotionChunk chunk;
    for (int i = 0; i < 4; ++i) {
      chunk.times.push_back(begin + 0.1 * i);
      chunk.positions.push_back(
          (Configuration(5) << x + 0.01 * i, 0, 0.5, 0, grip + (at_end - grip) * i / 3.0).finished());
    }
    return chunk;
  };
  GateOptions options = with_limits(5.0);
  options.allow_outside = {"all"};
  for (const bool is_loaded : {false, true}) {
    Gate gate(options);
    gate.publish({is_loaded ? with_load(gripper.robot(), can) : gripper.robot(),
                  VoxelScene{}.snapshot(),
                  {.critical_by_default = false}});
    EXPECT_TRUE(gate.judge(moved(0.0, 0.0, 0.02, 0.02)).is_passed())
        << gate.judge(moved(0, 0, 0.02, 0.02)).sentence;
    const GateVerdict opened = gate.judge(moved(0.3, 0.03, 0.02, 0.021));
    EXPECT_EQ(opened.is_passed(), !is_loaded);
    if (!is_loaded) continue;
    EXPECT_EQ(opened.reason, GateReason::joint_limit);
    EXPECT_NE(opened.sentence.find("joint 'grip' holds load 'can'"), std::string::npos) << opened.sentence;
    EXPECT_TRUE(
        gate.judge(moved(0.3, 0.03, 0.0205, 0.0205)).is_passed());  // as far as it may start elsewhere
    EXPECT_FALSE(gate.judge(moved(0.6, 0.06, 0.0213, 0.0213)).is_passed()) << "and no farther, bit by bit";
  }
}

TEST(Gate, TheReactionTimeIsDrivenOn) {
  const MotionChunk chunk = along_x({0.0, 0.1, 0.2, 0.3, 0.4, 0.5});
  GateOptions options = with_limits(5.0);
  for (const auto& [reaction, passes] : {std::pair{0.19, true}, std::pair{0.21, false}}) {
    options.limits.reaction = reaction;
    Gate gate(options);
    gate.publish(before_wall());
    EXPECT_EQ(gate.judge(chunk).is_passed(), passes) << reaction;
  }
}

TEST(Gate, NamesPieceBodyVoxelAndHowFarTheArmMayStillGo) {
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  const GateVerdict verdict = gate.judge(along_x({0.0, 0.3, 0.6, 0.9, 1.2}));  // 3 m/s: stands after 0.9 m
  EXPECT_EQ(verdict.reason, GateReason::blocked);
  ASSERT_TRUE(verdict.piece);
  EXPECT_EQ(verdict.piece->kind, Kind::edge);
  EXPECT_EQ(verdict.piece->waypoint, 2U);  // from 0.6 to 0.9 the disc meets the wall at 0.8
  EXPECT_NEAR(verdict.parameter, 2.0 / 3.0, 1e-3);
  EXPECT_EQ(verdict.obstruction.part, "base");
  EXPECT_EQ(verdict.obstruction.obstruction, Obstruction::occupied);
  EXPECT_NEAR(verdict.obstruction.point.x(), 1.025, 1e-9);
  EXPECT_EQ(verdict.evidence->voxel.state, VoxelState::occupied);
  EXPECT_FALSE(verdict.may_go);  // from 0 it would stand at 0.9
  EXPECT_EQ(verdict.sentence.rfind("from positions[2] to positions[3]: base touches an occupied voxel", 0),
            0U)
      << verdict.sentence;

  const GateVerdict slower = gate.judge(along_x({0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9}));  // 0.225 m to stand
  ASSERT_TRUE(slower.may_go);
  EXPECT_GT(slower.may_go->position[0], 0.575 - 0.15 / 32);  // a 64th of an edge, and it brakes up to 0.8
  EXPECT_LT(slower.may_go->position[0], 0.575);
  EXPECT_LT(slower.may_go->stop[0], 0.8);
  EXPECT_NEAR(slower.may_go->time, slower.may_go->position[0] / 1.5, 1e-9);
}

TEST(Gate, WhatItSaysMayGoPassesAsAChunkOfItsOwn) {
  Random random(5);
  int some = 0, within = 0;
  for (int i = 0; i < 400; ++i) {
    MotionChunk chunk;
    Configuration q = Eigen::Vector2d(random.between(-0.5, 0.5), random.between(-0.5, 0.5));
    double time = 0.0;
    for (int k = 0; k < 12; ++k) {
      chunk.times.push_back(time += random.between(0.02, 0.2));
      chunk.positions.push_back(q);
      q += Eigen::Vector2d(random.between(-0.05, 0.2), random.between(-0.1, 0.1));
    }
    Gate gate(with_limits(random.between(2.0, 20.0), 100.0));
    gate.publish(before_wall());
    const GateVerdict verdict = gate.judge(chunk);
    if (verdict.is_passed() || !verdict.may_go) continue;
    MotionChunk part;
    for (std::size_t k = 0; chunk.times[k] < verdict.may_go->time; ++k) {
      part.times.push_back(chunk.times[k]);
      part.positions.push_back(chunk.positions[k]);
    }
    within += std::find(chunk.times.begin(), chunk.times.end(), verdict.may_go->time) == chunk.times.end();
    part.times.push_back(verdict.may_go->time);
    part.positions.push_back(verdict.may_go->position);
    const GateVerdict again = gate.judge(part);
    ASSERT_TRUE(again.is_passed()) << i << ": " << again.sentence;
    EXPECT_EQ(again.may_go->stop, verdict.may_go->stop);
    ++some;
  }
  EXPECT_GT(some, 100);
  EXPECT_GT(within, 50);
}

TEST(Gate, AShortEdgeAtTheEndHidesNoFastMotion) {
  // 1.5 m/s towards the wall, and a last edge that claims to stand.
  MotionChunk chunk = along_x({0.0, 0.15, 0.3, 0.45, 0.6, 0.75});
  chunk.times.push_back(chunk.times.back() + 1e-6);
  chunk.positions.push_back(chunk.positions.back());
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  const GateVerdict verdict = gate.judge(chunk);
  EXPECT_EQ(verdict.reason, GateReason::blocked);
  ASSERT_TRUE(verdict.piece);
  EXPECT_EQ(verdict.piece->kind, Kind::braking);
  EXPECT_EQ(verdict.piece->waypoint, 5U);
}

TEST(Gate, AChunkStartsWhereTheLastPassedOneEndsOrStands) {
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  EXPECT_TRUE(gate.judge(along_x({-0.5, -0.4})).is_passed());  // anywhere; stands at -0.3
  EXPECT_EQ(gate.judge(along_x({-0.5, -0.4})).reason, GateReason::jump);
  EXPECT_EQ(gate.judge(along_x({-0.35, -0.3})).reason, GateReason::jump);
  EXPECT_EQ(gate.judge(along_x({-0.398, -0.3})).reason, GateReason::jump);
  EXPECT_TRUE(gate.judge(along_x({-0.3995, -0.3})).is_passed());  // within the tolerance
  EXPECT_EQ(gate.judge(along_x({-0.2, 2.0, 3.0})).reason, GateReason::velocity_limit);
  EXPECT_EQ(gate.judge(along_x({-0.2, 0.7, 1.0})).reason, GateReason::blocked);  // where it stands
  EXPECT_EQ(gate.judge(along_x({-0.25, -0.2})).reason, GateReason::jump);  // what was refused moved nothing
  EXPECT_TRUE(gate.judge(along_x({-0.2, -0.15})).is_passed());
  gate.restart();
  EXPECT_TRUE(gate.judge(along_x({-0.5, -0.45})).is_passed());
  gate.restart(Eigen::Vector2d(0.2, 0.0));
  const GateVerdict jump = gate.judge(along_x({-0.45, -0.4}));
  EXPECT_EQ(jump.reason, GateReason::jump);
  EXPECT_NE(
      jump.sentence.find("is -0.45, where the robot was said to start it is 0.2, expected within 0.001"),
      std::string::npos)
      << jump.sentence;
  GateOptions options = with_limits(5.0);
  options.start = Eigen::Vector2d(0.0, 0.0);
  Gate stated(options);
  stated.publish(before_wall());
  EXPECT_EQ(stated.judge(along_x({0.1, 0.2})).reason, GateReason::jump);
  EXPECT_TRUE(stated.judge(along_x({0.0, 0.1})).is_passed());
}

/// An encoder that wraps at half a turn: between chunks the same place, within one a turn back; and not where
/// what follows the joint is elsewhere after a turn.
TEST(Gate, JointsWithoutLimitsMayWrapBetweenChunks) {
  const auto at = [](double angle) { return Configuration::Constant(1, angle); };
  for (const double multiplier : {2.0, 0.5}) {
    const worlds::UrdfRobot geared = worlds::geared(multiplier, "0.05", "0.3 0 0", "0.3 0 0");
    Robot robot = geared.robot();
    for (Joint& joint : robot.joints) joint.max_velocity = 0.0;
    GateOptions options = with_limits(5.0);
    options.allow_outside = {"all"};
    Gate gate(options);
    gate.publish({robot, Snapshot(), {.critical_by_default = false}, {.padding = 0.0}});
    EXPECT_TRUE(gate.judge({{0.0, 0.1}, {at(3.0), at(3.1)}}).is_passed());
    const double wrapped = 3.1 - 2.0 * std::numbers::pi;
    EXPECT_EQ(gate.judge({{0.1, 0.2}, {at(wrapped + 0.01), at(-3.1)}}).reason, GateReason::jump);
    const GateVerdict within = gate.judge({{0.1, 0.2}, {at(3.1), at(-3.1)}});
    EXPECT_EQ(within.reason, GateReason::velocity_limit);
    EXPECT_NE(within.sentence.find("go on where an encoder wraps"), std::string::npos) << within.sentence;
    const GateVerdict next = gate.judge({{0.1, 0.2}, {at(wrapped), at(-3.1)}});
    EXPECT_EQ(next.reason, multiplier == 2.0 ? GateReason::none : GateReason::jump) << next.sentence;
  }
}

TEST(Gate, WhatTheToleranceLeavesOpenIsProvedToo) {
  GateOptions options = with_limits(5.0);
  options.tolerance = 0.5;
  options.start = Eigen::Vector2d(0.9, 0.0);  // in the wall
  Gate gate(options);
  gate.publish(before_wall());
  const GateVerdict verdict = gate.judge(along_x({0.5, 0.4}));
  EXPECT_EQ(verdict.reason, GateReason::blocked);
  ASSERT_TRUE(verdict.piece);
  EXPECT_EQ(verdict.piece->kind, Kind::joining);
  EXPECT_EQ(verdict.parameter, 0.0);
  EXPECT_FALSE(verdict.may_go);
}

/// Who ends at 1 m/s in the origin stands at x = 0.25 m: a chunk near both is joined from either, and a post
/// stands beside the way from the origin alone.
TEST(Gate, WhereItMayBeInTwoPlacesTheWayFromEachIsProved) {
  GateOptions options = with_limits(2.0);
  options.tolerance = 0.25;
  FreeSpaceMap map({.resolution = 0.005});
  occupy(map, {-0.0175, 0.2325, 0.0025});
  const ConfigurationSpace space(disc(), map.snapshot(), {.critical_by_default = false});
  const Eigen::Vector2d end(0.0, 0.0), stop(0.25, 0.0), first(0.2, 0.15);
  EXPECT_FALSE(space.is_edge_free(end, first));
  EXPECT_TRUE(space.is_edge_free(stop, first));
  MotionChunk next;
  next.times = {0.0, 1.0};
  next.positions = {first, Eigen::Vector2d(0.22, 0.15)};
  Gate moving(options);
  moving.publish(ConfigurationSpace(disc(), map.snapshot(), {.critical_by_default = false}));
  EXPECT_TRUE(moving.judge(along_x({-0.1, 0.0})).is_passed());
  const GateVerdict verdict = moving.judge(next);
  EXPECT_EQ(verdict.reason, GateReason::blocked);
  ASSERT_TRUE(verdict.piece);
  EXPECT_EQ(verdict.piece->kind, Kind::joining);
  Gate standing(options);  // known to stand at the stop
  standing.publish(ConfigurationSpace(disc(), map.snapshot(), {.critical_by_default = false}));
  standing.restart(stop);
  EXPECT_TRUE(standing.judge(next).is_passed());
}

TEST(Gate, ARobotThatWaitsIsJudgedWhereItStands) {
  Gate gate(with_limits(5.0));
  gate.publish(before_wall());
  EXPECT_TRUE(gate.judge(along_x({0.7, 0.7, 0.7})).is_passed());
  gate.restart();
  EXPECT_EQ(gate.judge(along_x({0.9, 0.9, 0.9})).reason, GateReason::blocked);
}

TEST(Gate, AStopPastAJointLimitIsRefusedByTheJoint) {
  Robot robot = disc();
  robot.joints[0].upper = 0.55;
  Gate gate(with_limits(5.0));
  gate.publish({robot, before_wall().map(), {.critical_by_default = false}});
  const GateVerdict verdict = gate.judge(along_x({0.3, 0.4, 0.5}));  // would stand at 0.6
  EXPECT_EQ(verdict.reason, GateReason::joint_limit);
  EXPECT_EQ(verdict.obstruction.other, robot.joints[0].name);
  ASSERT_TRUE(verdict.piece);
  EXPECT_EQ(verdict.piece->kind, Kind::braking);
  ASSERT_TRUE(verdict.may_go);
  EXPECT_NEAR(verdict.may_go->position[0], 0.45, 0.1 / 64);
  EXPECT_FALSE(verdict.evidence);
}

TEST(Gate, JudgesByTheNewestMapAndRefusesOneThatIsTooOld) {
  GateOptions options = with_limits(5.0);
  options.max_age = 0.2;
  Gate gate(options);
  EXPECT_EQ(gate.judge(along_x({0.0, 0.1})).reason, GateReason::no_map);
  EXPECT_EQ(gate.publish(before_wall(), 10.0), 1U);
  const auto reason_at = [&](double time) {
    gate.restart();
    return gate.judge(along_x({0.0, 0.1}, time)).reason;
  };
  EXPECT_EQ(reason_at(10.0), GateReason::none);
  EXPECT_EQ(reason_at(10.19), GateReason::none);
  EXPECT_EQ(reason_at(10.21), GateReason::stale_map);
  EXPECT_EQ(reason_at(9.79), GateReason::stale_map);  // no clock does that
  EXPECT_EQ(gate.publish(before_wall(), 10.1), 2U);
  EXPECT_EQ(reason_at(10.21), GateReason::none);
  gate.restart();
  EXPECT_EQ(gate.judge(along_x({0.0, 0.1}, 10.2)).map, 2U);
}

TEST(Gate, RefusesOptionsAndRobotsThatDoNotFitAndKeepsItsMap) {
  EXPECT_THROW(Gate({.tolerance = -1.0}), std::invalid_argument);
  EXPECT_THROW(Gate({.max_age = 0.0}), std::invalid_argument);
  Gate gate({.limits = {.deceleration = {1.0, 2.0}}});
  gate.publish(before_wall());
  const Robot arm = load_robot("arm5");
  EXPECT_THROW(gate.publish({arm, VoxelScene().snapshot()}), std::invalid_argument);
  Gate any;
  any.publish(before_wall());
  EXPECT_THROW(any.publish({arm, VoxelScene().snapshot()}), std::invalid_argument);
  EXPECT_EQ(any.judge(along_x({0.0, 0.1})).map, 1U);
  EXPECT_THROW(any.restart(Eigen::VectorXd::Zero(5)), std::invalid_argument);
  EXPECT_EQ(any.judge(along_x({0.0, 0.1})).map, 1U);  // as before
  Gate early;                                         // no map says which robot it is
  early.restart(Eigen::VectorXd::Zero(5));
  early.publish(before_wall());
  EXPECT_THROW(early.judge(along_x({0.0, 0.1})), std::invalid_argument);
  Gate aged({.max_age = 1.0});
  EXPECT_THROW(aged.publish(before_wall(), std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
}

TEST(Gate, NamesTheScanAndStrokeThatMadeTheVoxelThatBlocks) {
  FreeSpaceMap map({.resolution = 0.05});
  map.keep_scans();
  const int volume = map.add_volume("lane", {"base"});
  map.begin_stroke("to the right", "probe");
  for (double x = 0.0; x <= 2.0; x += 0.1) map.paint(volume, {Eigen::Vector3d(x, 0, 0), 0.4}, 3.0 + x);
  map.end_stroke();
  Scan scan;
  scan.sensor = "camera";
  scan.time = 7.25;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.0, 0.0, 0.025);
  scan.points = {Eigen::Vector3f(1.025F, 0.0F, 0.0F)};
  map.insert(scan);
  Gate gate(with_limits(5.0));
  gate.publish({disc(), map.snapshot()}, 0.0, std::make_shared<const Provenance>(map.provenance()));
  const GateVerdict verdict = gate.judge(along_x({0.2, 0.4, 0.6, 0.8, 1.0}));
  EXPECT_EQ(verdict.obstruction.obstruction, Obstruction::conflict);
  ASSERT_TRUE(verdict.evidence);
  ASSERT_EQ(verdict.evidence->hits.size(), 1U);
  EXPECT_EQ(verdict.evidence->hits[0].sensor, "camera");
  EXPECT_EQ(verdict.evidence->hits[0].time, 7.25);
  ASSERT_EQ(verdict.evidence->strokes.size(), 1U);
  EXPECT_EQ(verdict.evidence->strokes[0].stroke, "to the right");
  EXPECT_NE(verdict.sentence.find("hit by scan 0 of 'camera' at 7.25 s"), std::string::npos)
      << verdict.sentence;
  EXPECT_NE(verdict.sentence.find("painted into 'lane' by 'to the right' of 'probe'"), std::string::npos)
      << verdict.sentence;
}

/// A chunk about a free configuration, towards another one.
MotionChunk drawn_chunk(const ConfigurationSpace& space, Random& random) {
  Configuration q = random.configuration(space.robot());
  for (int i = 0; i < 200 && !space.is_free(q); ++i) q = random.configuration(space.robot());
  const Configuration way = 0.1 * (random.configuration(space.robot()) - q);
  MotionChunk chunk;
  const int count = 2 + random.below(15);
  for (int i = 0; i < count; ++i) {
    chunk.times.push_back(0.25 * i);
    chunk.positions.push_back(q);
    for (Eigen::Index j = 0; j < q.size(); ++j) q[j] += way[j] * random.between(0.2, 0.6);
  }
  return chunk;
}

TEST(Gate, PassesNothingThatDenseSamplingWithFclFindsToTouch) {
  constexpr double edge = 0.06;
  int passed = 0, refused = 0;
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    Random random(11);
    FreeSpaceMap map({.resolution = edge});
    std::vector<Eigen::Vector3d> cubes;
    for (int i = 0; i < 120; ++i) {
      cubes.push_back(((random.point(0.9) / edge).array().floor() + 0.5) * edge);
      occupy(map, cubes.back());
    }
    const FclTruth truth(robot, cubes, edge);
    Gate gate(with_limits(3.0));
    gate.publish({robot, map.snapshot(), {.critical_by_default = false}});
    const ConfigurationSpace space(robot, map.snapshot(), {.critical_by_default = false});
    for (int i = 0; i < 150; ++i) {
      gate.restart();
      const MotionChunk chunk = drawn_chunk(space, random);
      const GateVerdict verdict = gate.judge(chunk);
      refused += !verdict.is_passed();
      if (!verdict.is_passed()) continue;
      ++passed;
      std::vector<Configuration> path = chunk.positions;
      path.push_back(verdict.may_go->stop);
      for (std::size_t k = 1; k < path.size(); ++k) {
        for (int sample = 0; sample <= 12; ++sample) {
          const LinkPoses poses =
              forward_kinematics(robot, path[k - 1] + sample / 12.0 * (path[k] - path[k - 1]));
          ASSERT_FALSE(truth.touches_cube(poses)) << name << ", chunk " << i << ", edge " << k - 1;
          ASSERT_FALSE(truth.touches_itself(poses)) << name << ", chunk " << i << ", edge " << k - 1;
        }
      }
      const PathVerdict check = check_path(robot, map.snapshot(), space.policies(), 0.0, path);
      ASSERT_TRUE(check.valid) << name << ", chunk " << i << ": " << check.first_contact;
    }
  }
  EXPECT_GT(passed, 60);
  EXPECT_GT(refused, 60);
}

TEST(Gate, OneThreadPublishesWhileAnotherJudges) {
  Gate gate(with_limits(5.0));
  constexpr std::uint64_t maps = 40;
  std::atomic<bool> done = false;
  std::thread mapping([&] {
    for (std::uint64_t i = 1; i <= maps; ++i) EXPECT_EQ(gate.publish(before_wall(), 0.1), i);
    done = true;
  });
  std::uint64_t last = 0;
  while (!done || last < maps) {
    gate.restart();
    const GateVerdict verdict = gate.judge(along_x({0.0, 0.1, 0.2}));
    ASSERT_GE(verdict.map, last);
    last = verdict.map;
    ASSERT_EQ(verdict.reason, last == 0 ? GateReason::no_map : GateReason::none);
  }
  mapping.join();
}

}  // namespace gate_test
}  // namespace clearway
