#include "mapping/maps/map_damage.hpp"

#include <gtest/gtest.h>

#include <random>

#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/maps/map_edit.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace map_damage_test {

/// A painted sphere, of a recording that was damaged after `records` or not at all.
Snapshot map_of(std::optional<std::size_t> records) {
  FreeSpaceMap map({.resolution = 0.1});
  map.add_volume("tunnel", {});
  map.paint(0, {{0.0, 0.0, 0.0}, 0.5});
  if (records) map.note_damaged_recording(*records);
  return map.snapshot();
}

TEST(MapDamage, IsSaidOfNoOtherMap) { EXPECT_EQ(damage_caveat(map_of(std::nullopt)), ""); }

TEST(MapDamage, StaysInTheFileAndInWhatIsMadeOfTheMap) {
  const TemporaryFolder folder;
  const Snapshot map = map_of(37), whole = map_of(std::nullopt);
  save_map(map, folder / "map");
  const Snapshot loaded = load_map(folder / "map");
  EXPECT_NE(damage_caveat(loaded).find("damaged recording: 37 records"), std::string::npos);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-0.2, -0.2, -0.2), Eigen::Vector3d(0.2, 0.2, 0.2));
  for (const Snapshot& made :
       {crop(loaded, box), coarsen(loaded, 0.2), merge(loaded, whole), merge(whole, loaded)})
    EXPECT_EQ(damage_caveat(made), damage_caveat(map));
  EXPECT_NE(damage_caveat(merge(loaded, map_of(1))).find("38 records"), std::string::npos);
}

/// A square of a metre before the sensor, and poses by which it is always in the same place, to so much
/// (rad), or not at all, as where the poses are taken the wrong way round.
TEST(MapContradiction, IsSaidOfScansThatHitWhatOthersSawFree) {
  const auto caveat = [](double turns, float half_edge) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> angle(-turns, turns);
    FreeSpaceMap map({.resolution = 0.02});
    for (int scan = 0; scan < 12; ++scan) {
      Scan square;
      square.time = scan;
      for (float y = -half_edge; y < half_edge; y += 0.015F)
        for (float z = -half_edge; z < half_edge; z += 0.015F) square.points.push_back({2.0F, y, z});
      const Eigen::Isometry3d turn(Eigen::AngleAxisd(angle(random), Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(angle(random), Eigen::Vector3d::UnitY()));
      square.map_from_sensor = turn * Eigen::Translation3d(-2.0, 0.0, 0.0);
      map.insert(square);
    }
    return map_caveat(map.snapshot());
  };
  EXPECT_EQ(caveat(0.0, 0.5F), "");
  EXPECT_EQ(caveat(0.01, 0.5F), "");  // as poses are
  EXPECT_NE(caveat(3.0, 0.5F).find("% of what its scans hit others had seen free"), std::string::npos);
  EXPECT_EQ(caveat(3.0, 0.05F), "") << "too few looks";
}

/// A square at another distance in each scan, as where numbers of depth are no metres: each stands amid what
/// others had seen free, and so in no stable place.
TEST(MapContradiction, IsSaidOfScansThatHitAmidWhatOthersSawFree) {
  const auto caveat = [](float step, float half_edge) {
    FreeSpaceMap map({.resolution = 0.02});
    for (int scan = 0; scan < 8; ++scan) {
      Scan square;
      square.time = scan;
      const float x = 3.0F - step * static_cast<float>(scan);
      for (float y = -half_edge; y < half_edge; y += 0.015F)
        for (float z = -half_edge; z < half_edge; z += 0.015F) square.points.push_back({x, y, z});
      map.insert(square);
    }
    const ScanAgreement& agreement = map.snapshot().tree().agreement();
    EXPECT_LT(agreement.called_free, 1 + agreement.looked_up / 50) << "stable places say nothing";
    return contradiction_caveat(map.snapshot());
  };
  EXPECT_EQ(caveat(0.0F, 0.4F), "");
  EXPECT_NE(
      caveat(0.2F, 0.4F).find("% of what its scans hit others had seen free, as where poses, axes, units"),
      std::string::npos)
      << caveat(0.2F, 0.4F);
  EXPECT_EQ(caveat(0.2F, 0.05F), "") << "too few looks";
}

}  // namespace map_damage_test
}  // namespace clearway
