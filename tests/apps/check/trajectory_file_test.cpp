#include "apps/check/trajectory_file.hpp"

#include <gtest/gtest.h>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace read_trajectories_test {

/// Half a million short numbers: a long rest at a short period, of an arm of six joints.
TEST(ReadTrajectories, TakesFilesOfAnyLength) {
  constexpr int count = 25'000;
  std::string text = "joint_names: [a, b, c, d, e, f]\npoints:\n";
  for (int i = 0; i < count; ++i)
    text +=
        "- {positions: [0,0,0,0,0,0], velocities: [0,0,0,0,0,0], accelerations: [0,0,0,0,0,0], "
        "time_from_start: " +
        std::to_string(0.001 * i) + "}\n";
  TemporaryFolder folder;
  const std::vector<ForeignTrajectory> read = read_trajectories(folder.write("long.yaml", text));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].points.size(), static_cast<std::size_t>(count));
}

}  // namespace read_trajectories_test
}  // namespace clearway
