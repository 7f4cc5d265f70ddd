#include "mapping/maps/map_damage.hpp"

#include <gtest/gtest.h>

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

/// Two walls of the same scene, the second `nearer` than the first by as much as a wrong pose makes it.
TEST(MapContradiction, IsSaidOfScansThatHitWhatOthersSawFree) {
  const auto caveat = [](float nearer, int edge) {
    FreeSpaceMap map({.resolution = 0.02});
    for (int scan = 0; scan < 4; ++scan) {
      Scan wall;
      wall.time = scan;
      for (int y = -edge; y < edge; ++y)
        for (int z = -edge; z < edge; ++z)
          wall.points.push_back({2.01F - nearer * static_cast<float>(scan),
                                 0.01F + 0.02F * static_cast<float>(y),
                                 0.01F + 0.02F * static_cast<float>(z)});
      map.insert(wall);
    }
    return map_caveat(map.snapshot());
  };
  EXPECT_EQ(caveat(0.0F, 25), "");
  EXPECT_EQ(caveat(0.02F, 25), "");  // within the sensor's noise
  EXPECT_NE(caveat(0.4F, 25).find("% of what its scans hit others had seen free"), std::string::npos);
  EXPECT_EQ(caveat(0.4F, 3), "") << "too few looks";
}

}  // namespace map_damage_test
}  // namespace clearway
