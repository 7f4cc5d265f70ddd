// Painting spheres along a stroke: ours against OctoMap's updateNode for each voxel, called as its
// documentation advises for many voxels: lazy_eval, and updateInnerOccupancy once at the end.

#include <octomap/OcTree.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include "apps/bench/bench.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

constexpr double painted_radius = 0.1;
constexpr int spheres_a_stroke = 1000;

/// A winding stroke of samples 8 mm apart: 60 a second at half a metre a second.
Sphere sphere_of_stroke(int i, double step = 0.008) {
  const double t = step * i / 0.6;
  return {{0.6 * std::cos(t) + 1e-4 * i, 0.6 * std::sin(t), 0.2 * std::sin(0.37 * t)}, painted_radius};
}

/// Sets each voxel wholly inside the sphere free: what a program does that has only OctoMap.
void paint_stock(octomap::OcTree& tree, const Sphere& sphere) {
  const double edge = tree.getResolution();
  const Eigen::Array3d low = ((sphere.center.array() - sphere.radius) / edge).floor();
  const Eigen::Array3d high = ((sphere.center.array() + sphere.radius) / edge).floor();
  const auto far = [&](int axis, double cell) {
    return std::max(std::abs(cell * edge - sphere.center[axis]),
                    std::abs((cell + 1) * edge - sphere.center[axis]));
  };
  const auto key = [](double cell) { return static_cast<octomap::key_type>(cell + 32768.0); };
  for (double x = low.x(); x <= high.x(); ++x) {
    for (double y = low.y(); y <= high.y(); ++y) {
      for (double z = low.z(); z <= high.z(); ++z) {
        const Eigen::Array3d corner(far(0, x), far(1, y), far(2, z));
        if (corner.square().sum() > sphere.radius * sphere.radius) continue;
        tree.updateNode(octomap::OcTreeKey(key(x), key(y), key(z)), false, true);
      }
    }
  }
}

/// CPU microseconds of each of a stroke's spheres, and of what must follow the last one.
struct Stroke {
  std::vector<double> spheres;
  double end = 0.0;

  double mean() const {
    return (std::accumulate(spheres.begin(), spheres.end(), end)) / static_cast<double>(spheres.size());
  }
};

/// What comes before each sphere is not counted.
Stroke time_stroke(
    int spheres, const std::function<void(int)>& paint, const std::function<void()>& before = [] {}) {
  Stroke stroke;
  for (int i = 0; i < spheres; ++i) {
    before();
    stroke.spheres.push_back(1e6 * cpu_seconds([&] { paint(i); }));
  }
  return stroke;
}

/// Of some strokes painted in the same way: medians of the strokes' own figures.
struct Strokes {
  std::vector<double> medians, p99s, means;

  double add(const Stroke& stroke) {
    medians.push_back(median(stroke.spheres));
    p99s.push_back(quantile(stroke.spheres, 0.99));
    means.push_back(stroke.mean());
    return medians.back();
  }
  nlohmann::ordered_json json() const {
    return {{"median", median(medians)}, {"p99", median(p99s)}, {"mean_with_end", median(means)}};
  }
  std::vector<std::string> row(const std::string& name) const {
    return {name, figure(median(medians)), figure(median(p99s)), figure(median(means))};
  }
};

Stroke paint_ours(double resolution, int spheres, double step = 0.008) {
  FreeSpaceMap map({.resolution = resolution});
  map.add_volume("stroke", {});
  return time_stroke(spheres, [&](int i) { map.paint(0, sphere_of_stroke(i, step)); });
}

/// Each sphere finds all nodes held by a snapshot.
Stroke paint_while_held(double resolution) {
  FreeSpaceMap map({.resolution = resolution});
  map.add_volume("stroke", {});
  std::optional<Snapshot> held;
  return time_stroke(
      spheres_a_stroke, [&](int i) { map.paint(0, sphere_of_stroke(i)); },
      [&] { held.emplace(map.snapshot()); });
}

Stroke paint_with_octomap(double resolution) {
  octomap::OcTree tree(resolution);
  Stroke stroke = time_stroke(spheres_a_stroke, [&](int i) { paint_stock(tree, sphere_of_stroke(i)); });
  stroke.end = 1e6 * cpu_seconds([&] { tree.updateInnerOccupancy(); });
  return stroke;
}

Table paint_table(const Strokes& ours, const Strokes& peer, const Strokes& held, const Strokes& apart) {
  Table table{"CPU us per ball:", {"what", "median", "p99", "mean, last pass included"}, {}};
  table.rows = {ours.row("ours"), peer.row("OctoMap, `lazy_eval`")};
  std::vector<std::string> ratios{"ratio"};
  for (const auto part : {&Strokes::medians, &Strokes::p99s, &Strokes::means})
    ratios.push_back(figure(median(peer.*part) / median(ours.*part)));
  table.rows.push_back(ratios);
  table.rows.push_back(held.row("ours while a snapshot holds all nodes"));
  table.rows.push_back(apart.row("ours, balls 25 cm apart (15 a run)"));
  return table;
}

}  // namespace

BenchResult bench_paint(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.005;
  Strokes ours, held, apart, peer;
  const Pair pair = interleave(
      options,
      [&] {
        held.add(paint_while_held(resolution));
        apart.add(paint_ours(resolution, 15, 0.25));
        return ours.add(paint_ours(resolution, spheres_a_stroke));
      },
      [&] { return peer.add(paint_with_octomap(resolution)); });
  BenchResult result{pair.ours,
                     pair.peer,
                     "OctoMap updateNode, lazy_eval",
                     "CPU us per ball",
                     true,
                     options.runs,
                     {{"resolution", resolution},
                      {"ball_radius", painted_radius},
                      {"balls", spheres_a_stroke},
                      {"ours", ours.json()},
                      {"peer", peer.json()},
                      {"ours_snapshot_held", held.json()},
                      {"ours_far_apart", apart.json()}}};
  result.compared =
      "A stroke of 1,000 balls of radius 10 cm, 8 mm apart, at " + length_text(resolution) +
      ": `paint` against OctoMap's `updateNode` for each voxel inside, with `lazy_eval` and one "
      "`updateInnerOccupancy` after the last ball, its fastest way. Both sides: medians over the "
      "runs of each stroke's median, p99 and mean.";
  result.tables = {paint_table(ours, peer, held, apart)};
  return result;
}

}  // namespace clearway::bench
