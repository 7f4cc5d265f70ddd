#include "planning/constraint/live_control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "mapping/voxels/fused_tree.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace live_control_test {

using Time = LiveControl::Time;
using std::chrono::milliseconds;

constexpr double edge = 0.02;

DamperOptions damper(const Robot& robot) {
  return {0.01, 0.1, 0.02, 0.04, Eigen::VectorXd::Ones(static_cast<Eigen::Index>(robot.dof()))};
}

ConfigurationSpace space_of(const Robot& robot, const Snapshot& map) {
  return {robot, map, {.critical_by_default = false}, {.max_distance = 0.3}};
}

/// A wall across x, `ahead` of the origin, as stairs of voxels.
FreeSpaceMap wall(double ahead) {
  FreeSpaceMap map({.resolution = edge});
  for (double y = -0.6; y < 0.6; y += edge) occupy(map, {ahead + 0.2 * y, y, 0.01});
  return map;
}

/// Reports where each tree that it watches is taken apart, and how many are alive at once.
class TreeWatch {
 public:
  Snapshot watched(const Snapshot& map) {
    {
      const std::lock_guard lock(guard_);
      most_alive_ = std::max(most_alive_, ++alive_);
    }
    const auto end = [this](const FusedTree* tree) {
      delete tree;
      const std::lock_guard lock(guard_);
      --alive_;
      threads_.insert(std::this_thread::get_id());
    };
    return {std::shared_ptr<const FusedTree>(new FusedTree(map.tree()), end), map.volumes()};
  }
  int alive() const {
    const std::lock_guard lock(guard_);
    return alive_;
  }
  int most_alive() const {
    const std::lock_guard lock(guard_);
    return most_alive_;
  }
  std::set<std::thread::id> threads() const {
    const std::lock_guard lock(guard_);
    return threads_;
  }

 private:
  mutable std::mutex guard_;
  int alive_ = 0, most_alive_ = 0;
  std::set<std::thread::id> threads_;
};

TEST(LiveControl, StepsAsOneMadeInTheLoopFromTheSameMapBitForBit) {
  const Robot robot = load_robot("puma560");
  Random random(4);
  FreeSpaceMap map({.resolution = edge});
  LiveControl live(damper(robot), {});
  Configuration q = random.configuration(robot);
  double constraints = 0.0;
  for (int frame = 0; frame < 12; ++frame) {
    for (int i = 0; i < 150; ++i) occupy(map, random.point(1.0));
    const Snapshot seen = map.snapshot();  // its fields follow those of the frame before
    live.publish(space_of(robot, seen), Time());
    const FusedTree copy(seen.tree());
    const ConfigurationSpace space =
        space_of(robot, Snapshot(std::make_shared<const FusedTree>(copy), seen.volumes()));
    ControlStep control(space, damper(robot));
    const Configuration goal = random.configuration(robot);
    for (int i = 0; i < 60; ++i) {
      const Eigen::VectorXd wanted = step_to_goal(damper(robot), q, goal);
      control.look(q);
      const Eigen::VectorXd expected = control.solve(wanted);
      ASSERT_EQ(live.step(q, wanted, Time()), expected) << frame << ", " << i;
      ASSERT_EQ(live.number(), static_cast<std::uint64_t>(frame) + 1);
      constraints += static_cast<double>(control.constraints().constraints().size());
      q += expected;
    }
  }
  EXPECT_GT(constraints, 1000.0);
}

TEST(LiveControl, RefusesAMapOfARobotWithOtherJoints) {
  Robot robot = load_robot("puma560");
  FreeSpaceMap map({.resolution = edge});
  LiveControl live(damper(robot), {});
  live.publish(space_of(robot, map.snapshot()), Time());
  robot.joints[2].name = "elbow";
  EXPECT_THROW(live.publish(space_of(robot, map.snapshot()), Time()), std::invalid_argument);
  ASSERT_TRUE(live.fetch(Configuration::Zero(6)));
  EXPECT_EQ(live.number(), 1U);
}

TEST(LiveControl, StandsStillWhereNobodyHasLookedSinceTheLastFetch) {
  const Robot robot = load_robot("puma560");
  FreeSpaceMap map({.resolution = edge});
  occupy(map, {3.0, 3.0, 3.0});
  LiveControl live(damper(robot), {});
  const Configuration q = Configuration::Zero(6), wanted = Configuration::Constant(6, 0.01);
  for (int frame = 0; frame < 2; ++frame) {
    live.publish(space_of(robot, map.snapshot()), Time());
    ASSERT_TRUE(live.fetch(q));
    EXPECT_EQ(live.solve(wanted, Time()), Configuration::Zero(6));
    live.control().look(q);
    EXPECT_NE(live.solve(wanted, Time()), Configuration::Zero(6));
  }
}

TEST(LiveControl, TakesMapsApartOnTheMappingThreadAndNeverHasMoreThanThree) {
  const Robot robot = load_robot("point");
  TreeWatch watch;
  const Snapshot map = wall(0.5).snapshot();
  std::optional<LiveControl> live(std::in_place, damper(robot), LiveOptions{});
  std::thread::id mapping;
  std::atomic<bool> done = false;
  std::thread mapper([&] {
    mapping = std::this_thread::get_id();
    for (int i = 0; i < 40; ++i) live->publish(space_of(robot, watch.watched(map)), Time());
    done = true;
    while (watch.alive() > 1) live->collect();  // until the loop has the last one
  });
  const Configuration q = Configuration::Zero(2);
  while (!done || live->number() < 40) live->step(q, Eigen::Vector2d(0.001, 0.0), Time());
  mapper.join();
  EXPECT_EQ(live->number(), 40U);
  EXPECT_EQ(watch.threads(), std::set{mapping});
  EXPECT_LE(watch.most_alive(), 3);
  EXPECT_EQ(watch.alive(), 1);
  live.reset();
  EXPECT_EQ(watch.alive(), 0);
}

TEST(LiveControl, TwoThreadsMapAndControlWithoutARaceAndNumbersOnlyGrow) {
  const Robot robot = load_robot("point");
  LiveControl live(damper(robot), {});
  constexpr std::uint64_t frames = 60;
  std::thread mapper([&] {
    Random random(2);
    FreeSpaceMap map = wall(0.5);
    for (std::uint64_t i = 1; i <= frames; ++i) {
      occupy(map, {random.between(0.2, 0.6), random.between(-0.5, 0.5), 0.01});
      const std::uint64_t number = live.publish(space_of(robot, map.snapshot()), Time(milliseconds(i)));
      EXPECT_EQ(number, i);
    }
  });
  Configuration q = Configuration::Zero(2);
  std::uint64_t last = 0;
  Configuration goal = Eigen::Vector2d(0.8, 0.1);
  while (live.number() < frames) {
    q += live.step(q, step_to_goal(damper(robot), q, goal), Time(milliseconds(frames)));
    ASSERT_GE(live.number(), last);
    last = live.number();
    if (live.has_map()) {
      ASSERT_EQ(live.age(Time(milliseconds(frames))), milliseconds(frames - last));
    }
  }
  mapper.join();
}

TEST(LiveControl, KnowsTheAgeAndNumberOfItsMapAndTakesTheNewest) {
  const Robot robot = load_robot("point");
  const Snapshot map = wall(0.5).snapshot();
  LiveControl live(damper(robot), {.max_age = milliseconds(100)});
  const Configuration q = Configuration::Zero(2);
  EXPECT_FALSE(live.has_map());
  EXPECT_EQ(live.number(), 0U);
  EXPECT_EQ(live.age(Time()), LiveControl::Duration::max());
  EXPECT_TRUE(live.is_too_old(Time()));
  EXPECT_FALSE(live.fetch(q));
  live.publish(space_of(robot, map), Time(milliseconds(1000)));
  live.publish(space_of(robot, map), Time(milliseconds(1030)));
  EXPECT_TRUE(live.fetch(q));
  EXPECT_FALSE(live.fetch(q));
  EXPECT_EQ(live.number(), 2U);  // the first was never used
  EXPECT_EQ(live.age(Time(milliseconds(1050))), milliseconds(20));
  EXPECT_FALSE(live.is_too_old(Time(milliseconds(1130))));
  EXPECT_TRUE(live.is_too_old(Time(milliseconds(1131))));
  EXPECT_EQ(live.collect(), 0U);
  live.publish(space_of(robot, map), Time(milliseconds(1060)));
  EXPECT_TRUE(live.fetch(q));
  EXPECT_EQ(live.collect(), 1U);
}

TEST(LiveControl, MakesAMapReadyWhereTheRobotWasLastSeenAlsoWhenOldOnesWereCollected) {
  const Robot robot = load_robot("puma560");
  const Snapshot map = wall(0.6).snapshot();
  LiveControl live(damper(robot), {});
  Random random(6);
  const auto seen_at = [&](const Configuration& q) {  // before the loop looks with its map
    const LinkPoses expected = forward_kinematics(robot, q);
    const auto& poses = live.control().constraints().kinematics().map_from_link();
    for (std::size_t i = 0; i < expected.size(); ++i)
      if (!poses[i].isApprox(expected[i], 1e-9)) return false;
    return true;
  };
  const Configuration first = random.configuration(robot), second = random.configuration(robot);
  for (const bool collects : {false, true}) {
    for (const Configuration& q : {first, second}) {
      live.publish(space_of(robot, map), Time::clock::now());
      live.fetch(q);  // gives back the map before
      live.publish(space_of(robot, map), Time::clock::now());
      live.fetch(q);
      if (collects) live.collect();
    }
    live.publish(space_of(robot, map), Time::clock::now());
    live.fetch(first);
    EXPECT_TRUE(seen_at(second));
  }
}

TEST(LiveControl, TrustsNoMapFromTheFuture) {
  const Robot robot = load_robot("puma560");
  LiveControl live(damper(robot), {});
  const Time now = Time::clock::now();
  live.publish(space_of(robot, wall(0.6).snapshot()), now + std::chrono::hours(1));
  const Configuration q = Configuration::Zero(6);
  EXPECT_EQ(live.step(q, Eigen::VectorXd::Constant(6, 1e-3), now), Eigen::VectorXd(Eigen::VectorXd::Zero(6)));
  EXPECT_TRUE(live.is_braking());
  live.publish(space_of(robot, wall(0.6).snapshot()), Time::min());
  live.fetch(q);
  EXPECT_TRUE(live.is_too_old(now));
}

TEST(LiveControl, BrakesAlongTheLastStepWhenTheMapIsTooOldAndGoesOnWithANewOne) {
  const Robot robot = load_robot("point");
  const Snapshot map = wall(2.0).snapshot();  // far away
  LiveControl live(damper(robot), {.max_age = milliseconds(100), .brake = 0.003});
  const Eigen::Vector2d wanted(0.008, -0.004), across(0.0, 0.005);
  Configuration q = Configuration::Zero(2);
  EXPECT_TRUE(live.step(q, wanted, Time()).isZero(0.0));  // nothing is known yet
  EXPECT_TRUE(live.is_braking());
  live.publish(space_of(robot, map), Time());
  EXPECT_TRUE(live.step(q, wanted, Time(milliseconds(100))).isApprox(wanted, 1e-12));
  EXPECT_FALSE(live.is_braking());
  const Time late(milliseconds(101));
  for (const double share : {5.0 / 8.0, 2.0 / 8.0, 0.0, 0.0}) {  // whatever is wanted
    EXPECT_LT((live.step(q, across, late) - share * wanted).norm(), 1e-12) << share;
    EXPECT_TRUE(live.is_braking());
  }
  live.publish(space_of(robot, map), Time(milliseconds(90)));
  EXPECT_TRUE(live.step(q, across, late).isApprox(across, 1e-12));
  EXPECT_FALSE(live.is_braking());
}

TEST(LiveControl, KeepsItsDistanceWhileItBrakes) {
  const Robot robot = load_robot("point");
  const Snapshot map = wall(0.5).snapshot();
  const DamperOptions options = damper(robot);
  LiveControl live(options, {.max_age = milliseconds(1), .brake = 0.0004});
  live.publish(space_of(robot, map), Time());
  Configuration q = Configuration::Zero(2);
  double least = options.influence_distance;
  for (int i = 0; i < 100; ++i) {
    const bool is_near = live.has_map() && live.control().separation() < 0.08;
    q += live.step(q, Eigen::Vector2d(0.01, 0.0), Time(milliseconds(is_near || live.is_braking() ? 2 : 0)));
    least = std::min(least, live.control().separation());
    EXPECT_TRUE(i > 0 || !live.is_braking());
  }
  EXPECT_TRUE(live.is_braking());
  EXPECT_GT(least, options.security_distance - 1e-4);
  EXPECT_LT(least, 0.08);
  EXPECT_TRUE(live.step(q, Eigen::Vector2d(0.01, 0.0), Time(milliseconds(2))).isZero(1e-9));
}

TEST(LiveControl, StandsAtOnceWithoutABrake) {
  const Robot robot = load_robot("point");
  LiveControl live(damper(robot), {.max_age = milliseconds(100)});
  live.publish(space_of(robot, wall(2.0).snapshot()), Time());
  const Configuration q = Configuration::Zero(2);
  EXPECT_FALSE(live.step(q, Eigen::Vector2d(0.01, 0.0), Time()).isZero(0.0));
  EXPECT_TRUE(live.step(q, Eigen::Vector2d(0.01, 0.0), Time(milliseconds(101))).isZero(0.0));
}

TEST(LiveControl, RefusesOptionsOutOfRangeAndKeepsItsMapWhenARobotDoesNotFit) {
  const Robot point = load_robot("point"), puma = load_robot("puma560");
  EXPECT_THROW(LiveControl(damper(point), {.max_age = milliseconds(0)}), std::invalid_argument);
  EXPECT_THROW(LiveControl(damper(point), {.brake = 0.0}), std::invalid_argument);
  const Snapshot map = wall(0.5).snapshot();
  LiveControl live(damper(point), {});
  live.publish(space_of(point, map), Time());
  EXPECT_THROW(live.publish(space_of(puma, map), Time()), std::invalid_argument);
  EXPECT_TRUE(live.fetch(Configuration::Zero(2)));
  EXPECT_EQ(live.number(), 1U);
}

TEST(LiveControl, NumbersThatAreNotFiniteAreRefusedByNameAndChangeNothing) {
  const Robot point = load_robot("point");
  LiveControl live(damper(point), {}), other(damper(point), {});
  const Snapshot map = wall(0.5).snapshot();
  live.publish(space_of(point, map), Time());
  other.publish(space_of(point, map), Time());
  const Eigen::Vector2d q(0, 0), wanted(0.01, 0), lost(std::nan(""), 0);
  EXPECT_THROW(live.step(lost, wanted, Time()), std::invalid_argument);
  EXPECT_THROW(live.step(q, lost, Time()), std::invalid_argument);
  EXPECT_THROW(live.solve(lost, Time()), std::invalid_argument);
  EXPECT_FALSE(live.has_map());
  EXPECT_EQ(Eigen::VectorXd(live.step(q, wanted, Time())), Eigen::VectorXd(other.step(q, wanted, Time())));
  DamperOptions far = damper(point);
  far.influence_distance = HUGE_VAL;
  LiveControl endless(far, {});
  EXPECT_THROW(endless.publish(space_of(point, map), Time()), std::invalid_argument);
}

/// The mapping thread prepares the next map where the loop last said that the robot was: no slip of the loop
/// may keep it from doing so.
TEST(LiveControl, AReadingOfAnotherSizeLeavesTheNextMapsAsTheyAre) {
  const Robot point = load_robot("point");
  LiveControl live(damper(point), {});
  const Snapshot map = wall(0.5).snapshot();
  const Eigen::Vector2d q(0, 0), wanted(0.01, 0), lost(std::nan(""), 0);
  live.publish(space_of(point, map), Time());
  live.step(q, wanted, Time());
  for (const Configuration& wrong :
       {Configuration(Eigen::Vector3d::Zero()), Configuration(), Configuration(lost)}) {
    live.publish(space_of(point, map), Time());
    EXPECT_THROW(live.step(wrong, wanted, Time()), std::invalid_argument);
    EXPECT_THROW(live.step(q, wrong, Time()), std::invalid_argument);
    EXPECT_THROW(live.fetch(wrong), std::invalid_argument);
    EXPECT_EQ(live.collect(), 0U);
    const std::uint64_t newest = live.publish(space_of(point, map), Time());
    live.step(q, wanted, Time());
    EXPECT_EQ(live.number(), newest);
    EXPECT_EQ(live.collect(), 1U);
  }
  LiveControl::ReadyMap ready = live.prepare(space_of(point, map), Time());
  live.publish(std::move(ready));
  EXPECT_THROW(live.publish(std::move(ready)), std::invalid_argument);  // NOLINT: what it is asked about
}

}  // namespace live_control_test
}  // namespace clearway
