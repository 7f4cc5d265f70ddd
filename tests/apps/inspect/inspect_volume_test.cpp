#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace inspect_volume_test {

using Json = nlohmann::json;

/// Two spheres that meet in a circle of 6 cm, and a third one apart from them with an occupied voxel.
std::string dumbbell(const TemporaryFolder& folder) {
  FreeSpaceMap map({.resolution = 0.01});
  map.add_volume("tunnel", {"tool"});
  map.paint(0, {{0.0, 0.0, 0.0}, 0.1});
  map.paint(0, {{0.16, 0.0, 0.0}, 0.1});
  map.paint(0, {{0.5, 0.0, 0.0}, 0.1});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.5, 0.5, 0.0);
  scan.points = {{0.005F, -0.495F, 0.005F}};
  map.insert(scan);
  save_map(map.snapshot(), folder.file("map"));
  return folder.file("map");
}

TEST(InspectHoles, ReportsVolumeSpacingHolesAndNecksAsJson) {
  const TemporaryFolder folder;
  const CommandRun run = run_command({"inspect", dumbbell(folder), "--holes", "--json"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  const Json volumes = Json::parse(run.out)["painted_volumes"];
  ASSERT_EQ(volumes.size(), 1U);
  const Json& volume = volumes[0];
  EXPECT_EQ(volume["label"], "tunnel");
  EXPECT_EQ(volume["balls"], 3);
  EXPECT_LT(volume["voxel_volume_m3"], volume["exact"]["volume_m3"]);
  EXPECT_GT(volume["exact"]["not_covered_m3"], volume["exact"]["volume_error_m3"]);
  EXPECT_NEAR(volume["spacing"]["largest_m"], 0.34, 1e-9);
  ASSERT_EQ(volume["spacing"]["thin"].size(), 1U);
  EXPECT_EQ(volume["spacing"]["thin"][0]["ball"], 2);
  EXPECT_EQ(volume["parts_voxels"].size(), 2U);
  ASSERT_EQ(volume["holes"].size(), 1U);
  EXPECT_EQ(volume["holes"][0]["voxels"], 1);
  EXPECT_EQ(volume["holes"][0]["occupied_voxels"], 1);
  EXPECT_NEAR(volume["holes"][0]["centroid"][1], 0.005, 1e-6);
  ASSERT_GE(volume["necks"].size(), 1U);
  EXPECT_NEAR(volume["necks"][0]["position"][0], 0.08, 0.02);
  EXPECT_NEAR(volume["necks"][0]["radius_m"], 0.05, 0.015);
}

TEST(InspectHoles, ReportsTheSameAsText) {
  const TemporaryFolder folder;
  const CommandRun run = run_command({"inspect", dumbbell(folder), "--holes"});
  ASSERT_EQ(run.status, exit_done) << run.log;
  for (const char* words : {"painted volume  ", "tunnel", "exact volume", "not covered by voxels", "hole 1",
                            "1 sensed occupied", "neck 1", "before ball 2", "parts"}) {
    EXPECT_NE(run.out.find(words), std::string::npos) << words << "\n" << run.out;
  }
  EXPECT_EQ(run_command({"inspect", folder.file("map")}).out.find("exact volume"), std::string::npos);
}

TEST(InspectHoles, OfAMapWithoutPaintSaysSo) {
  const TemporaryFolder folder;
  save_map(FreeSpaceMap().snapshot(), folder.file("empty"));
  const CommandRun run = run_command({"inspect", folder.file("empty"), "--holes"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  EXPECT_NE(run.out.find("no painted volume"), std::string::npos);
}

}  // namespace inspect_volume_test
}  // namespace clearway
