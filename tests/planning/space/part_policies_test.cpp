// What is chosen for a part depends on whether a map holds any paint, or any free voxel: one is enough.

#include "planning/space/part_policies.hpp"

#include <gtest/gtest.h>

#include "mapping/voxels/fused_tree.hpp"
#include "planning/robot_files/load_robot.hpp"

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

}  // namespace part_policies_test
}  // namespace clearway
