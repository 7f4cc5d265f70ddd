#include <gtest/gtest.h>

#include <array>
#include <set>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/map_of_looks.hpp"

namespace clearway {
namespace verdict_test {

TEST(Verdict, DescribesEachObstructionInASentenceOfItsOwn) {
  const auto sentence = [](Obstruction obstruction) {
    return Verdict{obstruction, "tool", "hand", {0.5, -0.25, 1.0}, 0.0125}.sentence();
  };
  const std::string there = " at (0.5, -0.25, 1), 12.5 mm deep";
  EXPECT_EQ(Verdict{}.sentence(), "free");
  Verdict verdict;
  verdict.obstruction = Obstruction::not_finite;
  EXPECT_EQ(verdict.sentence(), "the configuration has the wrong size or is not finite");
  EXPECT_EQ((Verdict{Obstruction::joint_limit, "", "elbow", {}, 0.25}.sentence()),
            "joint elbow is 0.25 (rad or m) past its limit");
  EXPECT_EQ(sentence(Obstruction::self_collision), "tool touches hand");
  EXPECT_EQ(sentence(Obstruction::occupied), "tool touches an occupied voxel" + there);
  EXPECT_EQ(sentence(Obstruction::conflict),
            "tool touches a voxel that is painted free but sensed occupied" + there);
  EXPECT_EQ(sentence(Obstruction::unknown), "tool reaches into unknown space" + there);
  EXPECT_EQ(sentence(Obstruction::stale), "tool reaches into space that was not seen lately enough" + there);
  EXPECT_EQ(sentence(Obstruction::outside_painted), "tool leaves its painted volume" + there);
  EXPECT_EQ((Verdict{Obstruction::occupied, "tool", "", {0.5, -0.25, 1.0}, 4e-14, 0.001}.sentence()),
            "tool touches an occupied voxel at (0.5, -0.25, 1), with its padding alone: it is 1 mm away");
}

/// All of the cubes in it would take minutes to look at.
TEST(Verdict, OfABodyAsLargeAsAHouseNamesOneOfTheCubesThatItMeets) {
  FreeSpaceMap builder({.resolution = 0.02});
  builder.paint(builder.add_volume("free", {}), {Eigen::Vector3d::Zero(), 0.3});
  Robot robot = load_robot("point");
  for (const auto& [policy, radius] : {std::pair(Policy::painted, 50.0), std::pair(Policy::known_free, 50.0),
                                       std::pair(Policy::painted, 8.0)}) {
    robot.bodies[0].shape = Shape::sphere(radius);
    robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
    const ConfigurationSpace space(robot, builder.snapshot(), {.parts = {{"base", policy}}}, {});
    const Verdict verdict = space.check(Configuration::Zero(2));
    EXPECT_EQ(verdict.obstruction,
              policy == Policy::painted ? Obstruction::outside_painted : Obstruction::unknown);
    EXPECT_NE(space.map().state(verdict.point), VoxelState::painted);
    EXPECT_LE(verdict.point.norm(), radius + 0.02);
    EXPECT_GT(verdict.depth, 0.0);
  }
}

TEST(Verdict, CutsNamesThatAreLongerThanASentence) {
  const std::string part(5000, 'x');
  EXPECT_LT((Verdict{Obstruction::self_collision, part, part, {}, 0.0}.sentence().size()), 200U);
}

/// How deep a ball is in a cube of edge 0.1, with the padding, by the header's words; below 0: it is not.
double depth_of(const Eigen::Vector3d& ball, double radius, const Eigen::Vector3d& cube, double padding) {
  const Eigen::Array3d apart = (ball - cube).cwiseAbs();
  const double distance = (apart - 0.05).max(0.0).matrix().norm() - radius;
  const double way_out = (radius + 0.05 - apart).minCoeff();  // along an axis, of the box around the ball
  return distance > 0.0 ? padding - distance : padding + std::max(0.0, way_out);
}

TEST(Verdict, NamesTheDeepestVoxelOfTheFirstBodyThatIsNotClear) {
  Random random(3);
  std::set<Obstruction> seen;
  for (int trial = 0; trial < 36; ++trial) {
    FreeSpaceMap builder({.resolution = 0.1});
    const int volume = builder.add_volume("all", {});
    std::vector<Eigen::Vector3d> voxels;
    for (int x = -6; x < 6; ++x)
      for (int y = -6; y < 6; ++y)
        for (int z = -6; z < 6; ++z) voxels.push_back((Eigen::Array3d(x, y, z) + 0.5) * 0.1);
    for (int i = 0; i < trial % 7; ++i) builder.paint(volume, {random.point(0.5), random.between(0.1, 0.4)});
    for (int i = 0; i < 40 * (trial % 5); ++i)
      occupy(builder, voxels[static_cast<std::size_t>(random.below(1728))]);
    Robot robot = load_robot("point");
    robot.bodies[0].shape = Shape::sphere(random.between(0.05, 0.2));
    robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
    robot.bodies[0].link_from_shape.setIdentity();
    const double padding = trial % 2 == 0 ? 0.0 : 0.03;
    const Policy policy = std::array{Policy::painted, Policy::known_free,
                                     Policy::not_occupied}[static_cast<std::size_t>(trial % 3)];
    const ConfigurationSpace space(robot, builder.snapshot(), {.other = policy, .critical_by_default = false},
                                   {.padding = padding});
    for (int i = 0; i < 10; ++i) {
      const Configuration q = Eigen::Vector2d(random.between(-0.3, 0.3), random.between(-0.3, 0.3));
      const Eigen::Vector3d at =
          forward_kinematics(robot, q)[static_cast<std::size_t>(robot.bodies[0].link)].translation();
      const Requirement requirement{policy};
      double deepest = 0.0;
      for (const Eigen::Vector3d& voxel : voxels) {
        const double depth = depth_of(at, robot.bodies[0].shape.radius(), voxel, padding);
        const VoxelState state = space.map().state(voxel);
        const std::uint16_t mask = state == VoxelState::painted ? 1 : 0;
        if (!allows(requirement, state, mask)) deepest = std::max(deepest, depth);
      }
      const Verdict verdict = space.check(q);
      ASSERT_EQ(verdict.is_free(), deepest == 0.0) << trial;
      ASSERT_NEAR(verdict.depth, deepest, 1e-9) << trial;
      seen.insert(verdict.obstruction);
      if (verdict.is_free()) continue;
      EXPECT_NEAR(depth_of(at, robot.bodies[0].shape.radius(), verdict.point, padding), deepest, 1e-9);
      EXPECT_NEAR(verdict.gap, std::max(padding - deepest, 0.0), 1e-9);  // of the padding alone
      const VoxelState state = space.map().state(verdict.point);
      EXPECT_EQ(verdict.obstruction, state == VoxelState::occupied   ? Obstruction::occupied
                                     : state == VoxelState::conflict ? Obstruction::conflict
                                     : policy == Policy::painted     ? Obstruction::outside_painted
                                                                     : Obstruction::unknown);
      EXPECT_EQ(verdict.part, robot.bodies[0].part);
    }
  }
  EXPECT_EQ(seen.size(), 5U);  // all but what is of joints, of another body or too old
}

TEST(Verdict, NamesWhatWasSeenTooLongAgoApartFromWhatIsUnknown) {
  const Snapshot map = worlds::map_of_looks({{Eigen::Vector3d::Constant(0.025), 2.5}});  // the newest: 15 s
  const Robot disc = load_robot("point");
  const auto obstruction = [&](double seen_within, double x) {
    const ConfigurationSpace space(disc, map, {.other = Policy::known_free, .critical_by_default = false},
                                   {.seen_within = seen_within});
    return space.check(Eigen::Vector2d(x, 0.025)).obstruction;
  };
  EXPECT_EQ(obstruction(0.0, 0.025), Obstruction::none);
  EXPECT_EQ(obstruction(13.0, 0.025), Obstruction::none);
  EXPECT_EQ(obstruction(12.0, 0.025), Obstruction::stale);
  EXPECT_EQ(obstruction(12.0, 3.0), Obstruction::unknown);
}

TEST(Verdict, NamesTheJointThatIsFarthestPastItsLimits) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, Snapshot(), {.critical_by_default = false});
  Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    Configuration q = random.configuration(robot);
    double past = 0.0;
    std::string name;
    for (int i = 0; i < 3; ++i) {
      const auto j = static_cast<std::size_t>(random.below(6));
      const double by = random.between(0.01, 1.0);
      q[static_cast<Eigen::Index>(j)] = i % 2 == 0 ? robot.joints[j].upper + by : robot.joints[j].lower - by;
    }
    for (std::size_t j = 0; j < 6; ++j) {
      const double value = q[static_cast<Eigen::Index>(j)];
      for (const double beyond : {value - robot.joints[j].upper, robot.joints[j].lower - value})
        if (beyond > past) past = beyond, name = robot.joints[j].name;
    }
    const Verdict verdict = space.check(q);
    EXPECT_EQ(verdict.obstruction, Obstruction::joint_limit);
    EXPECT_EQ(verdict.other, name);
    EXPECT_NEAR(verdict.depth, past, 1e-12);
  }
}

}  // namespace verdict_test
}  // namespace clearway
