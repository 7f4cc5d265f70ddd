#include <gtest/gtest.h>

#include "planning/space/configuration_space.hpp"

namespace clearway {
namespace verdict_test {

TEST(Verdict, TellsEachObstructionInASentenceOfItsOwn) {
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
}

}  // namespace verdict_test
}  // namespace clearway
