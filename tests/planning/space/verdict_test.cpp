#include <gtest/gtest.h>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/configuration_space.hpp"

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
  robot.bodies[0].shape = Shape::sphere(50.0);
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  for (const Policy policy : {Policy::painted, Policy::known_free}) {
    const ConfigurationSpace space(robot, builder.snapshot(), {.parts = {{"base", policy}}}, {});
    const Verdict verdict = space.check(Configuration::Zero(2));
    EXPECT_EQ(verdict.obstruction,
              policy == Policy::painted ? Obstruction::outside_painted : Obstruction::unknown);
    EXPECT_NE(space.map().state(verdict.point), VoxelState::painted);
    EXPECT_LE(verdict.point.norm(), 50.0 + 0.02);
    EXPECT_GT(verdict.depth, 0.0);
  }
}

TEST(Verdict, CutsNamesThatAreLongerThanASentence) {
  const std::string part(5000, 'x');
  EXPECT_LT((Verdict{Obstruction::self_collision, part, part, {}, 0.0}.sentence().size()), 200U);
}

}  // namespace verdict_test
}  // namespace clearway
