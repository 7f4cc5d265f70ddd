// Rays through the map: BlockedSpace::cast_ray against OctoMap's castRay, same map, same end voxels.

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

struct Ray {
  Eigen::Vector3d origin, direction;
};

octomap::point3d to_octomap(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Rays from seen free voxels in all directions.
std::vector<Ray> random_rays(const Snapshot& map, std::size_t count) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Eigen::Vector3d origin(2.2 * unit(engine), 1.8 * unit(engine), 1.3 + 1.2 * unit(engine));
    if (map.state(origin) != VoxelState::seen_free) continue;
    rays.push_back({origin, Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized()});
  }
  return rays;
}

}  // namespace

BenchResult bench_cast_ray(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  constexpr std::size_t frames = 24, count = 20000;
  constexpr double range = 4.0;
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : room_scans(frames)) map.insert(scan);
  const Snapshot snapshot = map.snapshot();
  const std::vector<Ray> rays = random_rays(snapshot, count);
  nlohmann::ordered_json detail{
      {"resolution", resolution}, {"rays", count}, {"nodes", snapshot.tree().size()}};
  BenchResult result;
  for (const bool ignore_unknown : {true, false}) {
    const Policy policy = ignore_unknown ? Policy::not_occupied : Policy::known_free;
    std::shared_ptr<const BlockedSpace> space;
    const double build =
        cpu_seconds([&] { space = snapshot.blocked_space({policy}, snapshot.bounds(), 0.5); });
    std::size_t hits = 0, stock_hits = 0, differ = 0;
    for (const Ray& ray : rays) {
      octomap::point3d end;
      const bool stock = snapshot.tree().castRay(to_octomap(ray.origin), to_octomap(ray.direction), end,
                                                 ignore_unknown, range);
      const RayHit ours = space->cast_ray(ray.origin, ray.direction, range);
      const bool occupied = ours.hit && snapshot.state(ours.voxel) == VoxelState::occupied;
      if (occupied != stock || (stock && to_octomap(ours.voxel) != end)) ++differ;
    }
    if (differ != 0)
      throw std::runtime_error(std::to_string(differ) + " rays end in other voxels than OctoMap's");
    const Pair pair = interleave(
        options.runs,
        [&] {
          return 1e6 * cpu_seconds([&] {
                   for (const Ray& ray : rays) hits += space->cast_ray(ray.origin, ray.direction, range).hit;
                 }) /
                 count;
        },
        [&] {
          return 1e6 * cpu_seconds([&] {
                   octomap::point3d end;
                   for (const Ray& ray : rays) {
                     stock_hits += snapshot.tree().castRay(to_octomap(ray.origin), to_octomap(ray.direction),
                                                           end, ignore_unknown, range);
                   }
                 }) /
                 count;
        });
    detail[std::string(to_string(policy))] = {
        {"ours", pair.ours},
        {"peer", pair.peer},
        {"ratio", pair.peer / pair.ours},
        {"field_cpu_ms", 1e3 * build},
        {"share_stopped", static_cast<double>(hits) / (count * options.runs)}};
    if (ignore_unknown)
      result = {pair.ours, pair.peer, "OctoMap castRay", "CPU us per ray", true, options.runs, {}};
  }
  result.detail = detail;
  return result;
}

}  // namespace clearway::bench
