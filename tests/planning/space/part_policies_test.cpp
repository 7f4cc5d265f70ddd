// What is chosen for a part depends on whether a map holds any paint, or any free voxel: one is enough.

#include "planning/space/part_policies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>

#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "planning/robot/load.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/map_of_looks.hpp"

namespace clearway {
namespace part_policies_test {

enum class Seen { never, free, occupied };

/// A bare tree, without volumes, that stores one voxel at most.
Snapshot one_voxel(bool painted, Seen seen) {
  const auto tree = std::make_shared<FusedTree>(0.05);
  FusedNode voxel;
  if (seen == Seen::free) voxel.observe(-1.0F);
  if (seen == Seen::occupied) voxel.observe(1.0F);
  if (painted) voxel.add_paint(1);
  if (painted || seen != Seen::never) tree->set_leaf({{3, 4, 5}, 1}, voxel);
  tree->finish();
  return {tree, {}};
}

Policy policy_of(const Robot& robot, const Snapshot& map, const Policies& policies = {}) {
  return part_policies(robot, map, policies).at(robot.bodies.front().part);
}

TEST(PartPolicies, ACriticalPartStaysInPaintWhereABareTreeHoldsAnyBeItOneVoxelInConflict) {
  Robot robot = load_robot("point");
  robot.critical_parts = {robot.bodies.front().part};
  EXPECT_EQ(policy_of(robot, one_voxel(true, Seen::never)), Policy::painted);
  EXPECT_EQ(policy_of(robot, one_voxel(true, Seen::free)), Policy::painted);
  EXPECT_EQ(policy_of(robot, one_voxel(true, Seen::occupied)), Policy::painted);
  for (const Seen seen : {Seen::never, Seen::free, Seen::occupied})
    EXPECT_EQ(policy_of(robot, one_voxel(false, seen)), Policy::known_free);
}

TEST(PartPolicies, ARobotWithoutCriticalPartsStaysInFreeSpaceWhereThereIsAnyBeItOneVoxel) {
  Robot robot = load_robot("point");
  robot.critical_parts.clear();
  EXPECT_EQ(policy_of(robot, one_voxel(true, Seen::never)), Policy::known_free);
  EXPECT_EQ(policy_of(robot, one_voxel(false, Seen::free)), Policy::known_free);
  for (const bool painted : {false, true})
    EXPECT_EQ(policy_of(robot, one_voxel(painted, Seen::occupied)), Policy::not_occupied);
  EXPECT_EQ(policy_of(robot, one_voxel(false, Seen::never)), Policy::not_occupied);
  EXPECT_EQ(policy_of(robot, one_voxel(false, Seen::free), {.critical_by_default = false}),
            Policy::not_occupied);
}

/// By the header's words, part by part.
Policy expected_policy(const Robot& robot, const Snapshot& map, const Policies& policies,
                       const std::string& part) {
  if (const auto given = policies.parts.find(part); given != policies.parts.end()) return given->second;
  if (robot.loads.size() == 1 && robot.loads[0].name == part) {
    Policy strictest = Policy::not_occupied;  // painted, known_free, not_occupied: from the strictest on
    for (const std::string& holder : {robot.loads[0].link, robot.loads[0].touches[0]}) {
      for (const Body& body : robot.bodies)
        if (robot.links[static_cast<std::size_t>(body.link)].name == holder)
          strictest = std::min(strictest, expected_policy(robot, map, policies, body.part));
    }
    return strictest;
  }
  const bool is_listed =
      std::find(robot.critical_parts.begin(), robot.critical_parts.end(), part) != robot.critical_parts.end();
  if (policies.critical_by_default && (is_listed || map.volumes_of_part(part) != 0))
    return map.volumes().empty() ? Policy::known_free : Policy::painted;
  if (policies.other) return *policies.other;
  return policies.critical_by_default && robot.critical_parts.empty() && !map.bounds().isEmpty()
             ? Policy::known_free
             : Policy::not_occupied;
}

TEST(PartPolicies, AreAsTheirDefinitionSaysForAnyChoiceOfPartsVolumesAndLoads) {
  const Robot plain = load_robot("puma560");
  const std::array all{Policy::painted, Policy::known_free, Policy::not_occupied};
  Random random(8);
  std::set<Policy> of_loads;
  for (int trial = 0; trial < 200; ++trial) {
    Robot robot = plain;
    robot.critical_parts.clear();
    const auto some_part = [&] {
      return plain.bodies[static_cast<std::size_t>(random.below(static_cast<int>(plain.bodies.size())))].part;
    };
    for (int i = random.below(3); i > 0; --i) robot.critical_parts.push_back(some_part());
    if (trial % 2 == 0) {
      Load load;
      load.name = "box";
      load.shape = Shape::sphere(0.05);
      load.link = plain.links[static_cast<std::size_t>(plain.bodies.back().link)].name;
      load.touches = {plain.links[static_cast<std::size_t>(plain.bodies[plain.bodies.size() - 2].link)].name};
      robot = with_load(robot, load);
    }
    FreeSpaceMap builder({.resolution = 0.1});
    for (int i = random.below(3); i > 0; --i) {
      const int volume = builder.add_volume("v" + std::to_string(i), {some_part()});
      builder.paint(volume, {Eigen::Vector3d::Zero(), 0.3});
    }
    Policies policies{.critical_by_default = random.below(3) > 0};
    if (random.below(2) == 0) policies.other = all[static_cast<std::size_t>(random.below(3))];
    for (int i = random.below(3); i > 0; --i)
      policies.parts[some_part()] = all[static_cast<std::size_t>(random.below(3))];
    if (trial % 8 == 0) policies.parts["box"] = all[static_cast<std::size_t>(random.below(3))];
    const Snapshot map = builder.snapshot();
    const std::map<std::string, Policy> chosen = part_policies(robot, map, policies);
    for (const Body& body : robot.bodies)
      EXPECT_EQ(chosen.at(body.part), expected_policy(robot, map, policies, body.part)) << trial << body.part;
    if (trial % 2 == 0) of_loads.insert(chosen.at("box"));
  }
  EXPECT_EQ(of_loads.size(), 3U);
}

/// Also where bodies that turn about their own axis count as parts of the link before: what holds a load does
/// not change by that.
TEST(PartPolicies, OfASpaceAreThoseOfItsRobotForALoadOnAnyLink) {
  for (const char* name : {"puma560", "panda", "arm6"}) {
    const Robot plain = load_robot(name);
    for (const Link& link : plain.links) {
      Load load;
      load.name = "box";
      load.shape = Shape::box({0.05, 0.05, 0.05});
      load.link = link.name;
      load.link_from_load.translation() = Eigen::Vector3d(0.0, 0.2, 0.05);
      const Robot robot = with_load(plain, load);
      const std::vector<std::string> holders = holders_of(robot, "box");
      if (holders.empty()) continue;
      std::vector<std::string> others;
      for (const Body& body : plain.bodies)
        if (std::find(holders.begin(), holders.end(), body.part) == holders.end())
          others.push_back(body.part);
      FreeSpaceMap map({.resolution = 0.1});
      map.paint(map.add_volume("of holders", holders), {{0.5, 0.0, 0.5}, 0.3});
      map.paint(map.add_volume("of others", others), {{-0.5, 0.0, 0.5}, 0.3});
      Policies policies{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false};
      for (const std::string& holder : holders) policies.parts[holder] = Policy::painted;
      const ConfigurationSpace space(robot, map.snapshot(), policies);
      EXPECT_EQ(space.policies(), part_policies(robot, space.map(), policies)) << name << " " << link.name;
      EXPECT_EQ(space.policies().at("box"), Policy::painted) << name << " " << link.name;
      const BlockedSpace* const blocked = space.blocked_space(static_cast<int>(robot.bodies.size()) - 1);
      if (!blocked) continue;
      EXPECT_FALSE(blocked->is_blocked({0.5, 0.0, 0.5})) << name << " " << link.name;
      EXPECT_TRUE(blocked->is_blocked({-0.5, 0.0, 0.5})) << name << " " << link.name;
    }
  }
}

TEST(PartPolicies, AnAgeThatTheMapCannotTellMakesNoSpace) {
  const Robot robot = load_robot("point");
  const Policies known{.other = Policy::known_free, .critical_by_default = false},
      any{.other = Policy::not_occupied, .critical_by_default = false};
  const Snapshot map = worlds::map_of_looks({{Eigen::Vector3d::Zero(), 2.5}});
  const Snapshot bare = one_voxel(false, Seen::free);
  EXPECT_NO_THROW(ConfigurationSpace(robot, map, known, {.seen_within = 5.0}));
  EXPECT_NO_THROW(ConfigurationSpace(robot, bare, known));
  EXPECT_THROW(ConfigurationSpace(robot, map, any, {.seen_within = 5.0}), std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace(robot, bare, known, {.seen_within = 5.0}), std::invalid_argument);
}

/// By its volumes where the map has some, else by what is painted at all.
TEST(PartPolicies, APartThatMustLieInPaintIsToldWhereNoneCountsForIt) {
  const Robot robot = load_robot("point");
  const auto sentence = [&](const Snapshot& map, Policy policy) {
    return empty_volume_sentence(ConfigurationSpace(robot, map, {.parts = {{"base", policy}}}));
  };
  FreeSpaceMap builder({.resolution = 0.1});
  const int own = builder.add_volume("own", {"base"}), other = builder.add_volume("other", {"hand"});
  const Sphere ball{Eigen::Vector3d::Zero(), 0.3};
  EXPECT_NE(sentence(builder.snapshot(), Policy::painted), "");
  builder.paint(other, ball);
  EXPECT_NE(sentence(builder.snapshot(), Policy::painted), "");
  EXPECT_EQ(sentence(builder.snapshot(), Policy::known_free), "");
  builder.paint(own, ball);
  EXPECT_EQ(sentence(builder.snapshot(), Policy::painted), "");
  EXPECT_EQ(sentence(one_voxel(true, Seen::never), Policy::painted), "");
  EXPECT_NE(sentence(one_voxel(false, Seen::free), Policy::painted), "");
}

/// Others are not looked for in the map.
TEST(PartPolicies, OnlyAPartThatAJointMovesLacksPaint) {
  const Snapshot bare = FreeSpaceMap({.resolution = 0.1}).snapshot();
  for (const char* name : {"puma560", "panda", "point"}) {
    const Robot robot = load_robot(name);
    for (const Body& body : robot.bodies) {
      const bool is_part_moved = std::any_of(
          robot.bodies.begin(), robot.bodies.end(),
          [&](const Body& other) { return other.part == body.part && is_moved(robot, other.link); });
      const ConfigurationSpace space(robot, bare,
                                     {.parts = {{body.part, Policy::painted}}, .critical_by_default = false});
      EXPECT_EQ(empty_volume_sentence(space) != "", is_part_moved) << name << " " << body.part;
    }
  }
}

TEST(PartPolicies, OfAPartThatTheRobotLacksAreRefusedNamingThoseThatItHas) {
  const Robot robot = load_robot("point");
  try {
    part_policies(robot, Snapshot(), {.parts = {{"wing", Policy::painted}}});
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'wing', expected a part of point: "), std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find(robot.bodies[0].part), std::string::npos) << error.what();
  }
}

TEST(PartPolicies, RequirementsNameTheVolumesOfThePartElseOfItsFirstHolderThatHasSomeElseAll) {
  const Robot plain = load_robot("puma560");
  const std::string carrier = plain.bodies.back().part, beside = plain.bodies[plain.bodies.size() - 2].part;
  Load load;
  load.name = "box";
  load.shape = Shape::sphere(0.05);
  load.link = plain.links[static_cast<std::size_t>(plain.bodies.back().link)].name;
  load.touches = {plain.links[static_cast<std::size_t>(plain.bodies[plain.bodies.size() - 2].link)].name};
  const Robot robot = with_load(plain, load);
  const auto volumes_of_box = [&](const std::vector<std::string>& parts) {
    FreeSpaceMap builder({.resolution = 0.1});
    for (std::size_t i = 0; i < parts.size(); ++i)
      builder.add_volume("v" + std::to_string(i),
                         parts[i].empty() ? std::vector<std::string>{} : std::vector{parts[i]});
    const Requirement requirement = part_requirement(robot, builder.snapshot(), "box", Policy::painted, 5.0);
    EXPECT_EQ(requirement.policy, Policy::painted);
    EXPECT_EQ(requirement.seen_within, 0.0);
    return requirement.volumes;
  };
  EXPECT_EQ(volumes_of_box({}), 0xffff);
  EXPECT_EQ(volumes_of_box({""}), 0xffff);
  EXPECT_EQ(volumes_of_box({"", beside}), 0b10);
  EXPECT_EQ(volumes_of_box({carrier, beside}), 0b1);
  EXPECT_EQ(volumes_of_box({carrier, beside, "box", "box"}), 0b1100);
  const Requirement free = part_requirement(robot, Snapshot(), "box", Policy::known_free, 5.0);
  EXPECT_EQ(free.seen_within, 5.0);
  EXPECT_EQ(free.volumes, 0xffff);
  EXPECT_EQ(part_requirement(robot, Snapshot(), "box", Policy::not_occupied, 5.0).seen_within, 0.0);
}

}  // namespace part_policies_test
}  // namespace clearway
