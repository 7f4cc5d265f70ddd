#include "planning/gate/voxel_evidence.hpp"

#include <gtest/gtest.h>

#include "mapping/free_space_map.hpp"

namespace clearway {
namespace voxel_evidence_test {

Scan look(double time, float range) {
  Scan scan;
  scan.sensor = "lidar";
  scan.time = time;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.025, 0.025, 0.025);
  scan.points = {Eigen::Vector3f(range, 0.0F, 0.0F)};
  return scan;
}

const Eigen::Vector3d hit(1.025, 0.025, 0.025), passed(0.525, 0.025, 0.025), never(0.525, 0.525, 0.025);

TEST(VoxelEvidence, NamesTheNewestScansFirstAndCountsTheOthers) {
  FreeSpaceMap map({.resolution = 0.05});
  map.keep_scans();
  for (int i = 0; i < 7; ++i) map.insert(look(10.0 + i, 1.0F));
  const Provenance history = map.provenance();
  const VoxelEvidence evidence = evidence_of(map.snapshot(), &history, hit);
  EXPECT_EQ(evidence.hit_count, 7U);
  ASSERT_EQ(evidence.hits.size(), VoxelEvidence::most_named);
  EXPECT_EQ(evidence.hits[0].number, 6);
  EXPECT_EQ(evidence.hits[3].number, 3);
  EXPECT_EQ(evidence.voxel.state, VoxelState::occupied);
  EXPECT_EQ(evidence.sentence(),
            "hit by 7 scans, last by scan 6 of 'lidar' at 16 s, last seen at 16 s; painted by no one");
  EXPECT_EQ(evidence_of(map.snapshot(), &history, passed).sentence(),
            "passed by 7 scans, hit by none, last seen at 16 s; painted by no one");
  EXPECT_EQ(evidence_of(map.snapshot(), &history, never).sentence(), "no scan saw it; painted by no one");
}

TEST(VoxelEvidence, WithoutAHistorySaysWhatTheSnapshotKnows) {
  FreeSpaceMap map({.resolution = 0.05});
  map.paint(map.add_volume("lane", {}), {passed, 0.2}, 4.0);
  map.insert(look(10.0, 1.0F));
  EXPECT_EQ(evidence_of(map.snapshot(), nullptr, hit).sentence(),
            "seen by scans that are not on record, last seen at 10 s; painted by no one");
  const VoxelEvidence painted = evidence_of(map.snapshot(), nullptr, passed);
  EXPECT_EQ(painted.painted_by, std::vector<std::string>{"lane"});
  EXPECT_NE(painted.sentence().find("; painted into 'lane'"), std::string::npos) << painted.sentence();
}

TEST(VoxelEvidence, ListsWhatWasPaintedAndErased) {
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("lane", {});
  map.begin_stroke("there", "probe");
  map.paint(volume, {never, 0.2}, 4.0);
  map.begin_stroke("off");
  map.erase(volume, {never, 0.15}, 5.0);
  map.end_stroke();
  const Provenance history = map.provenance();
  const VoxelEvidence evidence = evidence_of(map.snapshot(), &history, never);
  EXPECT_EQ(evidence.voxel.state, VoxelState::unknown);
  ASSERT_FALSE(evidence.strokes.empty());
  EXPECT_TRUE(evidence.strokes.back().erases);
  EXPECT_NE(evidence.sentence().find("erased from 'lane' by 'off' at 5 s"), std::string::npos)
      << evidence.sentence();
}

}  // namespace voxel_evidence_test
}  // namespace clearway
