// The distance field from nothing, its memory and its look-ups, against dynamicEDT3D on the same voxels.

#include <dynamicEDT3D/dynamicEDTOctomap.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/field_points.hpp"
#include "datasets/simulation/room.hpp"
#include "mapping/field/blocked_field.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

Snapshot room_map(double resolution) {
  const FurnishedRoom room(16, 1, 1.0);
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (std::size_t i = 0; i < room.frames(); ++i) {
    const CloudFrame frame = room.frame(i);
    Scan scan;
    scan.sensor = frame.kind;
    scan.map_from_sensor = frame.world_from_sensor;
    scan.points = frame.points;
    map.insert(scan);
  }
  return map.snapshot();
}

/// What the map's bounds are grown to, so that the room has at least 8 million cells at 2 cm.
Eigen::AlignedBox3d region_of(const Snapshot& map) {
  Eigen::AlignedBox3d box = map.bounds();
  if (box.isEmpty()) throw std::invalid_argument("distance field: the map is empty, expected voxels");
  while (box.volume() < 8.2e6 * std::pow(0.02, 3)) {
    box.min().array() -= 0.02;
    box.max().array() += 0.02;
  }
  return box;
}

/// The voxels that `requirement` forbids and the free ones, as a stock tree.
std::unique_ptr<octomap::OcTree> stock_tree(const FusedTree& tree, const Requirement& requirement) {
  auto stock = std::make_unique<MirrorTree<octomap::OcTree>>(tree.getResolution());
  stock->mirror(tree, [&](const FusedNode& from, octomap::OcTreeNode& to) {
    const bool allowed = allows(requirement, tree.state(from), from.painted());
    to.setLogOdds(allowed ? stock->getClampingThresMinLog() : stock->getClampingThresMaxLog());
  });
  return stock;
}

/// One requirement and one truncation: both fields from nothing, interleaved.
struct Contest {
  Contest(const Snapshot& map, Policy policy, double max_distance)
      : tree(map.tree()),
        requirement{policy},
        region(field_region(region_of(map), map.resolution(), max_distance)),
        stock(stock_tree(tree, requirement)) {}

  std::unique_ptr<BlockedField> ours() const {
    return std::make_unique<BlockedField>(tree, requirement, region);
  }
  std::unique_ptr<DynamicEDTOctomap> theirs() const {
    const Eigen::Vector3f low =
        ((region.first.cast<double>().array() + 0.5) * region.resolution).cast<float>();
    const Eigen::Vector3f high = ((region.first + region.size).cast<double>().array() - 0.5).cast<float>() *
                                 static_cast<float>(region.resolution);
    auto field = std::make_unique<DynamicEDTOctomap>(
        static_cast<float>(region.max_distance), stock.get(), octomap::point3d(low.x(), low.y(), low.z()),
        octomap::point3d(high.x(), high.y(), high.z()), requirement.policy != Policy::not_occupied);
    field->update();
    return field;
  }
  Pair measure(int runs) const {
    const auto time = [](const auto& make) {
      decltype(make()) made;
      settle_heap();
      return 1e3 * cpu_seconds([&] { made = make(); });
    };
    return interleave(
        runs, [&] { return time([&] { return ours(); }); }, [&] { return time([&] { return theirs(); }); });
  }

  const FusedTree& tree;
  Requirement requirement;
  FieldRegion region;
  std::unique_ptr<octomap::OcTree> stock;
};

/// Points handed over a body's worth at a time, in arrays that are in the cache, as whoever has just computed
/// them has them.
class LookUps {
 public:
  explicit LookUps(Points points) : points_(std::move(points)) {}

  /// Look-ups a second: median of the runs. `look(begin, end)` looks up points of `at`, x, y, z into `out`.
  template <class Look>
  double rate(int runs, const Look& look) {
    std::vector<double> rates;
    for (int run = 0; run < runs; ++run) {
      double seconds = 0.0;
      for (std::size_t from = 0; from + block <= points_.size(); from += block) {
        std::copy_n(points_.begin() + static_cast<std::ptrdiff_t>(from), block, at.begin());
        for (std::size_t i = 0; i < block; ++i) {
          x[i] = at[i].x();
          y[i] = at[i].y();
          z[i] = at[i].z();
        }
        seconds += cpu_seconds([&] {
          for (std::size_t i = 0; i < block; i += body) look(i, i + body);
        });
        if (*std::min_element(out.begin(), out.end()) < 0.0) throw std::logic_error("a distance is negative");
      }
      rates.push_back(static_cast<double>(points_.size() / block * block) / seconds);
    }
    return median(rates);
  }
  PointArrays arrays(std::size_t from, std::size_t end) const {
    const std::size_t count = end - from;
    return {{&x[from], count}, {&y[from], count}, {&z[from], count}};
  }
  std::span<double> outs(std::size_t from, std::size_t end) { return {&out[from], end - from}; }

  static constexpr std::size_t body = 64, block = 128 * body;
  Points at{block};
  std::vector<double> x = std::vector<double>(block), y = x, z = x, out = x;

 private:
  Points points_;
};

nlohmann::ordered_json look_ups(const Contest& contest, int runs) {
  const auto ours = contest.ours();
  const auto theirs = contest.theirs();
  const Eigen::AlignedBox3d& box = ours->region();
  nlohmann::ordered_json result;
  for (const auto& [name, points] : {std::pair{"coherent_moving_body", body_points(box, 1 << 20)},
                                     {"coherent_lines_of_200", look_up_points(box, 1 << 20, 200)},
                                     {"random", look_up_points(box, 1 << 20, 1)}}) {
    LookUps all(points);
    const auto one_by_one = [&](const auto& look) {
      return all.rate(runs, [&](std::size_t from, std::size_t end) {
        for (std::size_t i = from; i < end; ++i) all.out[i] = look(all.at[i]);
      });
    };
    auto& rates = result[name];
    rates["coarse_clearances"] = all.rate(runs, [&](std::size_t i, std::size_t end) {
      ours->coarse_clearances(all.arrays(i, end), all.outs(i, end));
    });
    rates["clearances"] = all.rate(runs, [&](std::size_t i, std::size_t end) {
      ours->clearances(all.arrays(i, end), all.outs(i, end));
    });
    rates["coarse_clearance_one_by_one"] =
        one_by_one([&](const Eigen::Vector3d& point) { return ours->coarse_clearance(point); });
    rates["clearance_one_by_one"] =
        one_by_one([&](const Eigen::Vector3d& point) { return ours->clearance(point); });
    rates["dynamicEDT3D"] = one_by_one([&](const Eigen::Vector3d& point) {
      const Eigen::Vector3f at = point.cast<float>();
      // Below 0 it says that the point lies beyond its map.
      return std::max(0.0,
                      static_cast<double>(theirs->getDistance(octomap::point3d(at.x(), at.y(), at.z()))));
    });
  }
  return result;
}

/// How far the bound stays below the exact distance, in voxels, and how often it does not.
nlohmann::ordered_json slack(const BlockedField& field) {
  double largest = 0.0, sum = 0.0, coarse = 0.0;
  std::size_t over = 0;
  const Points points = look_up_points(field.region(), 1000000, 1);
  for (const Eigen::Vector3d& point : points) {
    const NearestBlocked nearest = field.nearest(point, field.max_distance());
    const double exact = nearest.found ? nearest.distance : field.max_distance();
    const double gap = (exact - field.clearance(point)) / field.resolution();
    over += gap < 0.0 ? 1 : 0;
    largest = std::max(largest, gap);
    sum += gap;
    coarse += (exact - field.coarse_clearance(point)) / field.resolution();
  }
  return {{"points", points.size()},
          {"largest_slack_voxels", largest},
          {"mean_slack_voxels", sum / static_cast<double>(points.size())},
          {"coarse_mean_slack_voxels", coarse / static_cast<double>(points.size())},
          {"overestimates", over}};
}

}  // namespace

BenchResult bench_field(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const Snapshot map = options.input.empty() ? room_map(resolution) : load_map(options.input, resolution);
  const Contest contest(map, Policy::not_occupied, 0.5);
  const Pair pair = contest.measure(options.runs);
  const auto field = contest.ours();
  const double cells = contest.region.size.cast<double>().prod();
  const auto other = [&](Policy policy, double max_distance) {
    const Contest again(map, policy, max_distance);
    const Pair times = again.measure(std::min(options.runs, 3));
    const double bytes = static_cast<double>(again.ours()->layers().bytes()) / cells;
    return nlohmann::ordered_json{{"ours", times.ours},
                                  {"peer", times.peer},
                                  {"ratio", times.peer / times.ours},
                                  {"bytes_per_cell", bytes}};
  };
  nlohmann::ordered_json detail{
      {"resolution", map.resolution()},
      {"max_distance", contest.region.max_distance},
      {"cells", cells},
      {"blocked", field->blocked_count()},
      {"bytes_per_cell", static_cast<double>(field->layers().bytes()) / cells},
      {"bytes_per_cell_at_most", static_cast<double>(field_bytes(contest.region, true)) / cells},
      {"peer_bytes_per_cell", 28},
      {"truncated_at_1_m", other(Policy::not_occupied, 1.0)},
      {"unknown_is_occupied", other(Policy::known_free, 0.5)},
      {"look_ups_per_second", look_ups(contest, options.runs)},
      {"bound", slack(*field)}};
  return {pair.ours, pair.peer, "dynamicEDT3D", "CPU ms from nothing", true, options.runs, detail};
}

}  // namespace clearway::bench
