// The distance field after one more depth frame, against dynamicEDT3D fed the same changes.

#include <dynamicEDT3D/dynamicEDTOctomap.h>
#include <octomap/OcTree.h>

#include <memory>
#include <vector>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "apps/bench/worlds/scan_source.hpp"
#include "datasets/simulation/room.hpp"
#include "mapping/field/blocked_field.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

constexpr double field_end = 0.5;  ///< m

/// A map that grows frame by frame, and its field, which follows.
class OurField {
 public:
  OurField(double resolution, const Eigen::AlignedBox3d& box)
      : map_({.resolution = resolution, .discretize = true, .integration = Integration::compatible}),
        cells_(field_region(box, resolution, field_end)),
        now_(map_.snapshot()),
        field_(std::make_unique<BlockedField>(from_nothing())) {}

  void insert(const Scan& scan) {
    map_.insert(scan);
    before_ = now_;
    now_ = map_.snapshot();
  }
  /// CPU milliseconds to follow the last scan.
  double update() {
    std::unique_ptr<BlockedField> next;
    settle_heap();
    const double seconds = cpu_seconds([&] {
      next = std::make_unique<BlockedField>(now_.tree(), before_.tree(), *field_);
      next->distances()->complete();
    });
    field_ = std::move(next);
    return 1e3 * seconds;
  }
  double read_changes() const {
    return 1e3 * cpu_seconds([&] {
             blocked_cells(now_.tree(), {}, cells_.first, before_.tree(), field_->distances()->blocked());
           });
  }
  /// All of it.
  BlockedField from_nothing() const {
    BlockedField field(now_.tree(), {}, cells_);
    field.distances()->complete();
    return field;
  }
  const BlockedField& field() const { return *field_; }

 private:
  FreeSpaceMap map_;
  FieldRegion cells_;
  Snapshot now_, before_;
  std::unique_ptr<BlockedField> field_;
};

/// The same with OctoMap and dynamicEDT3D.
class TheirField {
 public:
  TheirField(double resolution, const Eigen::AlignedBox3d& box) : tree_(resolution) {
    tree_.enableChangeDetection(true);
    const Eigen::Vector3f low = box.min().cast<float>(), high = box.max().cast<float>();
    field_ = std::make_unique<DynamicEDTOctomap>(static_cast<float>(field_end), &tree_,
                                                 octomap::point3d(low.x(), low.y(), low.z()),
                                                 octomap::point3d(high.x(), high.y(), high.z()), false);
    field_->update();
  }
  void insert(const Scan& scan) { insert_stock(tree_, scan, 0.0, true); }
  double update() {
    settle_heap();
    return 1e3 * cpu_seconds([&] { field_->update(); });
  }

 private:
  octomap::OcTree tree_;
  std::unique_ptr<DynamicEDTOctomap> field_;
};

struct Difference {
  std::size_t cells = 0, blocked = 0;
};

Difference compare(const DistanceTiles& a, const DistanceTiles& b) {
  Difference difference;
  const Eigen::Vector3i& size = a.size();
  for (int z = 0; z < size.z(); ++z) {
    for (int y = 0; y < size.y(); ++y) {
      for (int x = 0; x < size.x(); ++x) {
        difference.cells += a.squared(x, y, z) != b.squared(x, y, z) ? 1 : 0;
        difference.blocked += a.is_blocked(x, y, z) != b.is_blocked(x, y, z) ? 1 : 0;
      }
    }
  }
  return difference;
}

struct Round {
  std::vector<double> ours, theirs, reading, nothing, changed, flipped;
  std::size_t wrong = 0;
};

nlohmann::ordered_json describe(const Round& round) {
  return {{"ours", median(round.ours)},
          {"ours_worst", quantile(round.ours, 1.0)},
          {"peer", median(round.theirs)},
          {"ratio", median(round.theirs) / median(round.ours)},
          {"of_ours_reading_the_tree", median(round.reading)},
          {"ours_from_nothing", median(round.nothing)},
          {"voxels_flipped", median(round.flipped)},
          {"cells_changed", median(round.changed)},
          {"cells_that_differ_from_a_fresh_field", round.wrong}};
}

std::vector<std::string> row_of(const std::string& name, const Round& round) {
  return {name,
          figure(median(round.ours)),
          figure(median(round.theirs)),
          figure(median(round.theirs) / median(round.ours)),
          figure(quantile(round.ours, 1.0)),
          figure(quantile(round.theirs, 1.0)),
          count_text(median(round.flipped)),
          count_text(median(round.changed))};
}

}  // namespace

BenchResult bench_field_update(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const auto frames = static_cast<std::size_t>(options.runs);
  const FurnishedRoom room(frames, 1, 1.0);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-2.6, -2.1, -0.2), Eigen::Vector3d(2.6, 2.1, 2.8));
  OurField ours(resolution, box);
  TheirField theirs(resolution, box);
  Round first, second;  // the first round sees new space, the second what is known, with new noise
  const FurnishedRoom again(frames, 2, 1.0);
  for (std::size_t i = 0; i < 2 * frames; ++i) {
    options.say("frame " + std::to_string(i + 1) + " of " + std::to_string(2 * frames));
    const Scan scan = scan_of(i < frames ? room.frame(i) : again.frame(i - frames));
    ours.insert(scan);
    theirs.insert(scan);
    Round& round = i < frames ? first : second;
    const std::shared_ptr<const DistanceTiles> before = ours.field().distances();
    round.reading.push_back(ours.read_changes());
    round.ours.push_back(ours.update());
    round.theirs.push_back(theirs.update());
    std::unique_ptr<BlockedField> fresh;
    settle_heap();
    round.nothing.push_back(
        1e3 * cpu_seconds([&] { fresh = std::make_unique<BlockedField>(ours.from_nothing()); }));
    round.wrong += compare(*ours.field().distances(), *fresh->distances()).cells;
    const Difference change = compare(*before, *ours.field().distances());
    round.changed.push_back(static_cast<double>(change.cells));
    round.flipped.push_back(static_cast<double>(change.blocked));
  }
  const double cells = ours.field().cells().size.cast<double>().prod();
  nlohmann::ordered_json detail{
      {"resolution", resolution},
      {"max_distance", field_end},
      {"cells", cells},
      {"bytes_per_cell", static_cast<double>(ours.field().distances()->bytes()) / cells},
      {"first_round_new_space", describe(first)},
      {"second_round_known_space", describe(second)}};
  BenchResult result{median(first.ours),
                     median(first.theirs),
                     "dynamicEDT3D",
                     "CPU ms per depth frame",
                     true,
                     options.runs,
                     detail};
  result.compared =
      "The field of a room of " + figure(1e-6 * cells) + " million cells at " + length_text(resolution) +
      ", truncated at 0.5 m, after each further depth frame: `BlockedField` from the field before "
      "against dynamicEDT3D's `update`, on the same voxels. Inserting the frame itself counts on neither "
      "side. " +
      std::to_string(first.wrong + second.wrong) + " cells differ from a field made from nothing.";
  result.tables = {{"",
                    {"CPU ms per frame", "ours", "dynamicEDT3D", "ratio", "ours at most",
                     "dynamicEDT3D at most", "voxels flipped", "cells changed"},
                    {row_of("new space", first), row_of("known space, new noise", second)}}};
  return result;
}

}  // namespace clearway::bench
