#include "mapping/maps/map_integration.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <tuple>

#include "mapping/continued_map.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/maps/map_edit.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/random_map.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace map_integration_test {

using worlds::Dice;
using enum MapIntegration;

Snapshot made_by(MapIntegration which, unsigned seed = 1) {
  FreeSpaceMap map(
      {.resolution = 0.1, .integration = which == compatible ? Integration::compatible : Integration::safe});
  Dice dice(seed);
  map.paint(map.add_volume("v", {}), worlds::random_sphere(dice));
  if (which != none) map.insert(worlds::random_scan(dice, 50));
  return map.snapshot();
}

/// The file of a map, with another line (or none) in the place of the one that says its integration.
std::string file_that_says(const Snapshot& map, const std::string& line) {
  std::string text = format_fused_tree(map.tree(), map.volumes());
  const auto at = text.find("# clearway integration ");
  text.replace(at, text.find('\n', at) + 1 - at, line);
  const auto first = text.find('\n') + 1, second = text.find('\n', first) + 1;
  const std::string before = text.substr(0, first), after = text.substr(second);
  return before + seal_line(before, after) + after;
}

TEST(MapIntegration, AMapKnowsWhichIntegrationMadeIt) {
  for (const MapIntegration which : {none, safe, compatible})
    EXPECT_EQ(integration_of(made_by(which)), which);
  EXPECT_EQ(integration_of(Snapshot()), none);
}

TEST(MapIntegration, OfTwoPartsWhatTheirScansAndDamageSayIsAddedUp) {
  const auto part = [](std::optional<std::uint64_t> records, const ScanAgreement& agreement) {
    const auto tree = std::make_shared<FusedTree>(0.1);
    tree->add_agreement(agreement);
    if (records) tree->set_records_before_damage(*records);
    return Snapshot(tree, {});
  };
  for (const auto& [first, second, both] :
       {std::tuple<std::optional<std::uint64_t>, std::optional<std::uint64_t>, std::optional<std::uint64_t>>(
            std::nullopt, std::nullopt, std::nullopt),
        {5, std::nullopt, 5},
        {std::nullopt, 7, 7},
        {5, 7, 12}}) {
    const FusedTree merged = merge(part(first, {100, 3, 200}), part(second, {50, 1, 70})).tree();
    EXPECT_EQ(merged.records_before_damage(), both);
    EXPECT_EQ(merged.agreement(), (ScanAgreement{150, 4, 270}));
  }
}

TEST(MapIntegration, OfTwoPartsTheLessSafeOneHolds) {
  for (const MapIntegration a : {none, safe, compatible}) {
    for (const MapIntegration b : {none, safe, compatible}) {
      const MapIntegration expected = a == compatible || b == compatible ? compatible
                                      : a == safe || b == safe           ? safe
                                                                         : none;
      EXPECT_EQ(integration_of(merge(made_by(a, 1), made_by(b, 2))), expected);
      if (b == none) continue;
      ContinuedMap continued(made_by(a),
                             {.integration = b == safe ? Integration::safe : Integration::compatible});
      Dice dice(3);
      continued.insert(worlds::random_scan(dice, 50));
      EXPECT_EQ(integration_of(continued.snapshot()), expected);
    }
  }
}

TEST(MapIntegration, StaysThroughEditsAndFiles) {
  const TemporaryFolder folder;
  for (const MapIntegration which : {none, safe, compatible}) {
    const Snapshot map = made_by(which);
    EXPECT_EQ(integration_of(coarsen(map, 0.2)), which);
    EXPECT_EQ(integration_of(crop(map, {Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 0)})), which);
    save_map(map, folder.path() / "map");
    EXPECT_EQ(integration_of(load_map(folder.path() / "map")), which);
  }
}

TEST(MapIntegration, OfAForeignFileIsUnknownAndOfACloudNone) {
  const TemporaryFolder folder;
  const Snapshot map = made_by(safe);
  for (const char* name : {"foreign.bt", "foreign.ot"}) {
    export_map(map, folder.path() / name);
    const Snapshot foreign = load_map(folder.path() / name);
    EXPECT_EQ(integration_of(foreign), unknown);
    EXPECT_EQ(integration_of(merge(map, foreign)), unknown);
    EXPECT_EQ(integration_of(merge(made_by(compatible), foreign)), compatible);
    save_map(foreign, folder.path() / "saved");
    EXPECT_EQ(integration_of(load_map(folder.path() / "saved")), unknown);
  }
  export_map(map, folder.path() / "cloud.pcd");
  EXPECT_EQ(integration_of(load_map(folder.path() / "cloud.pcd", 0.1)), none);
}

TEST(MapIntegration, AFileThatDoesNotSayIsReadAsUnknownAndOneThatSaysNonsenseIsDamaged) {
  const Snapshot map = made_by(safe);
  const OctreeContent old = parse_octree(file_that_says(map, ""), "old.ot");
  EXPECT_EQ(old.tree->integration(), unknown);
  EXPECT_TRUE(*old.tree == map.tree());
  EXPECT_EQ(parse_octree(file_that_says(map, "# clearway integration safe\n"), "a.ot").tree->integration(),
            safe);
  for (const char* line : {"# clearway integration careful\n", "# clearway integration \n",
                           "# clearway integration safe\n# clearway integration safe\n"})
    EXPECT_THROW(parse_octree(file_that_says(map, line), "bad.ot"), DamagedFile) << line;
}

TEST(MapIntegration, AVerdictOnAMapOfCompatibleIntegrationOrForeignFreeSpaceSaysSo) {
  const TemporaryFolder folder;
  EXPECT_EQ(integration_caveat(made_by(safe)), "");
  EXPECT_EQ(integration_caveat(made_by(none)), "");
  EXPECT_NE(integration_caveat(made_by(compatible)).find("compatible integration"), std::string::npos);
  export_map(made_by(safe), folder.path() / "map.bt");
  EXPECT_NE(integration_caveat(load_map(folder.path() / "map.bt")).find("not known"), std::string::npos);
  FreeSpaceMap hits({.resolution = 0.1});  // obstacles alone
  Scan scan;
  scan.points.emplace_back(0.01F, 0.0F, 0.0F);
  hits.insert(scan);
  export_map(hits.snapshot(), folder.path() / "obstacles.bt");
  EXPECT_EQ(integration_caveat(load_map(folder.path() / "obstacles.bt")), "");
}

}  // namespace map_integration_test
}  // namespace clearway
