#include "planning/beam/lattice_poses.hpp"

#include <gtest/gtest.h>

#include "planning/robot/link_pose.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace lattice_poses_test {

TEST(LatticePoses, AreThoseOfForwardKinematicsAtNodesAndHalfWayBitForBit) {
  Random random(3);
  for (const char* name : {"puma560", "panda", "point"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
    const PathCost cost(robot);
    const Configuration start = random.configuration(robot);
    BeamOptions options;
    options.step = {0.0087};
    const Lattice lattice({space, cost, start, start}, options);
    LatticePoses poses(robot, lattice);
    for (int i = 0; i < 200; ++i) {
      LatticeIndex from(robot.dof()), to;
      for (int& index : from) index = random.below(101) - 50;
      to = from;
      for (int& index : to) index += random.below(3) - 1;
      const Configuration q = lattice.configuration(from);
      const Configuration middle = q + 0.5 * (lattice.configuration(to) - q);
      for (std::size_t link = 0; link < robot.links.size(); ++link) {
        const auto expected = [&](const Configuration& at) {
          const int joint = robot.links[link].joint;
          return pose_on_parent(robot, robot.links[link], joint < 0 ? 0.0 : at[joint]).matrix();
        };
        EXPECT_EQ(poses.at(link, from).matrix(), expected(q)) << name << ' ' << link;
        EXPECT_EQ(poses.between(link, from, to).matrix(), expected(middle)) << name << ' ' << link;
      }
      const LinkPoses& all = poses.all_at(i % 2 == 0 ? from : to);
      const LinkPoses expected = forward_kinematics(robot, lattice.configuration(i % 2 == 0 ? from : to));
      for (std::size_t link = 0; link < all.size(); ++link)
        EXPECT_EQ(all[link].matrix(), expected[link].matrix()) << name << ' ' << link;
    }
  }
}

TEST(LatticePoses, GiveTheForcesOfAScaledRobotsCostBitForBit) {
  Random random(4);
  const Robot robot = scaled(load_robot("point"), 0.1);
  const ConfigurationSpace space(robot, VoxelScene{}.snapshot());
  const PathCost cost(robot);
  const Configuration start = 0.1 * random.configuration(robot);
  BeamOptions options;
  options.step = {0.0013};
  const Lattice lattice({space, cost, start, start}, options);
  LatticePoses poses(cost.robot(), lattice, cost.scale());
  for (int i = 0; i < 100; ++i) {
    LatticeIndex node(robot.dof());
    for (int& index : node) index = random.below(101) - 50;
    const Configuration q = lattice.configuration(node);
    EXPECT_EQ(cost.generalized_forces(poses.all_at(node)), cost.generalized_forces(q));
    const LinkPoses expected = forward_kinematics(cost.robot(), cost.full_size(q));
    for (std::size_t link = 0; link < expected.size(); ++link)
      EXPECT_EQ(poses.all_at(node)[link].matrix(), expected[link].matrix());
  }
}

}  // namespace lattice_poses_test
}  // namespace clearway
