// Scan insertion: ours in `compatible` mode against OctoMap's insertPointCloud, same mode, same frames.

#include <octomap/OcTree.h>

#include "apps/bench/bench.hpp"
#include "datasets/room.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway::bench {
namespace {

Scan scan_of(const CloudFrame& frame) {
  Scan scan;
  scan.sensor = frame.kind;
  scan.map_from_sensor = frame.world_from_sensor;
  scan.points = frame.points;
  return scan;
}

octomap::Pointcloud cloud_of(const Scan& scan) {
  octomap::Pointcloud cloud;
  cloud.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
    cloud.push_back(at.x(), at.y(), at.z());
  }
  return cloud;
}

}  // namespace

BenchResult bench_insert(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  const FurnishedRoom room(static_cast<std::size_t>(options.runs), 1, 1.0);
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  octomap::OcTree stock(resolution);
  std::size_t next_ours = 0, next_peer = 0;
  const Pair pair = interleave(
      options.runs,
      [&] {
        const Scan scan = scan_of(room.frame(next_ours++));
        return 1e3 * cpu_seconds([&] { map.insert(scan); });
      },
      [&] {
        const Scan scan = scan_of(room.frame(next_peer++));
        const octomap::Pointcloud cloud = cloud_of(scan);
        const Eigen::Vector3f origin = scan.map_from_sensor.translation().cast<float>();
        return 1e3 * cpu_seconds([&] {
                 stock.insertPointCloud(cloud, {origin.x(), origin.y(), origin.z()}, -1.0, false, true);
               });
      });
  return {pair.ours, pair.peer,    "OctoMap insertPointCloud",  "CPU ms per scan",
          true,      options.runs, {{"resolution", resolution}}};
}

}  // namespace clearway::bench
