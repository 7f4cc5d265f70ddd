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

}  // namespace map_damage_test
}  // namespace clearway
