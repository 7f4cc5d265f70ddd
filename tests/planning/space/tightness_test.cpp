// Tight as well as safe: configuration checks at 2 cm beside every body against every blocked cube.
// `clearway_bench checks --runs 20` does the same with 100,000 configurations of each arm.

#include <gtest/gtest.h>

#include "apps/bench/peers/brute_force.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace tightness_test {

class TightAsWellAsSafe : public testing::TestWithParam<const char*> {};

TEST_P(TightAsWellAsSafe, NoTouchingConfigurationIsAcceptedAndNoFreeOneRefusedUnderAnyPolicy) {
  const Robot robot = load_robot(GetParam());
  bench::Agreement uniform, borderline;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    const Snapshot map =
        bench::ArmWorld{.half = 0.8, .painted = 40, .critical = robot.critical_parts, .seed = seed}.snapshot(
            robot);
    bench::Dice dice(seed);
    for (const Policies& policies : {Policies{.critical_by_default = false}, Policies{},
                                     Policies{.other = Policy::known_free, .critical_by_default = false}}) {
      const ConfigurationSpace space(robot, map, policies);
      const bench::BruteForce truth = bench::brute_force_of(space);
      uniform += bench::compare(space, truth, dice, 1'000, 0, 0);
      borderline += bench::compare(space, truth, dice, 0, 100, 14);  // some 0.1 mm from touching
    }
  }
  EXPECT_GT(uniform.free, uniform.checked / 50);
  EXPECT_GT(uniform.touching, uniform.checked / 50);
  EXPECT_EQ(uniform.wrongly_accepted, 0);
  EXPECT_LE(1000 * uniform.wrongly_refused, uniform.free) << "widest " << uniform.widest << " m";
  EXPECT_GE(borderline.free, 250);
  EXPECT_EQ(borderline.wrongly_accepted, 0);
  EXPECT_LT(borderline.widest, 1e-5);  // there FCL's two solvers disagree with each other too
}

INSTANTIATE_TEST_SUITE_P(Arms, TightAsWellAsSafe, testing::Values("puma560", "panda"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace tightness_test
}  // namespace clearway
