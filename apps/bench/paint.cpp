// Painting spheres along a stroke: ours against the stock calls that set a voxel's node each.

#include <octomap/OcTree.h>

#include <cmath>
#include <functional>
#include <optional>

#include "apps/bench/bench.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

constexpr double radius = 0.1;
constexpr int spheres_a_stroke = 1000;

/// A winding stroke of samples 8 mm apart: 60 a second at half a metre a second.
Sphere sphere_of_stroke(int i, double step = 0.008) {
  const double t = step * i / 0.6;
  return {{0.6 * std::cos(t) + 1e-4 * i, 0.6 * std::sin(t), 0.2 * std::sin(0.37 * t)}, radius};
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
        tree.updateNode(octomap::OcTreeKey(key(x), key(y), key(z)), false);
      }
    }
  }
}

/// CPU microseconds of each of the stroke's spheres; what comes before each is not counted.
std::vector<double> time_stroke(
    int spheres, const std::function<void(int)>& paint, const std::function<void()>& before = [] {}) {
  std::vector<double> times;
  for (int i = 0; i < spheres; ++i) {
    before();
    times.push_back(1e6 * cpu_seconds([&] { paint(i); }));
  }
  return times;
}

}  // namespace

BenchResult bench_paint(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.005;
  std::vector<double> medians, apart, shared, shared_worst;
  const Pair pair = interleave(
      options.runs,
      [&] {
        FreeSpaceMap map({.resolution = resolution});
        map.add_volume("stroke", {});
        const auto times = time_stroke(spheres_a_stroke, [&](int i) { map.paint(0, sphere_of_stroke(i)); });
        medians.push_back(median(times));
        FreeSpaceMap read({.resolution = resolution});  // each sphere finds all nodes held by a snapshot
        read.add_volume("stroke", {});
        std::optional<Snapshot> held;
        const auto copying = time_stroke(
            spheres_a_stroke, [&](int i) { read.paint(0, sphere_of_stroke(i)); },
            [&] { held.emplace(read.snapshot()); });
        shared.push_back(median(copying));
        shared_worst.push_back(quantile(copying, 0.99));
        FreeSpaceMap far({.resolution = resolution});
        far.add_volume("balls", {});
        apart.push_back(median(time_stroke(15, [&](int i) { far.paint(0, sphere_of_stroke(i, 0.25)); })));
        return quantile(times, 0.99);
      },
      [&] {
        octomap::OcTree tree(resolution);
        return quantile(time_stroke(30, [&](int i) { paint_stock(tree, sphere_of_stroke(i)); }), 0.99);
      });
  return {pair.ours,
          pair.peer,
          "OctoMap updateNode",
          "CPU us per ball, p99",
          true,
          options.runs,
          {{"resolution", resolution},
           {"ball_radius", radius},
           {"balls", spheres_a_stroke},
           {"ours_median", median(medians)},
           {"ours_median_far_apart", median(apart)},
           {"ours_median_snapshot_held", median(shared)},
           {"ours_p99_snapshot_held", median(shared_worst)}}};
}

}  // namespace clearway::bench
