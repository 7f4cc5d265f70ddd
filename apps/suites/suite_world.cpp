#include "apps/suites/suite_world.hpp"

#include <algorithm>

#include "apps/suites/suite_cells.hpp"
#include "apps/suites/suite_scans.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway {
namespace {

bool meets_pocket(const SuiteWorld& world, const SuiteSphere& sphere) {
  return std::any_of(world.pockets.begin(), world.pockets.end(), [&](const SuiteSphere& pocket) {
    return (sphere.center - pocket.center).norm() < sphere.radius + pocket.radius;
  });
}

void paint(const SuiteWorld& world, const SuiteVolume& volume, const std::vector<std::string>& critical_parts,
           FreeSpaceMap& map) {
  const int index =
      map.add_volume(volume.label, volume.critical_parts.empty() ? critical_parts : volume.critical_parts);
  for (const auto& stroke : volume.strokes) {
    map.begin_stroke(volume.label);
    for (const SuiteSphere& sphere : stroke)
      if (!meets_pocket(world, sphere)) map.paint(index, {sphere.center, sphere.radius});
    map.end_stroke();
  }
}

}  // namespace

Snapshot make_map(const SuiteWorld& world, const std::vector<std::string>& critical_parts) {
  if (world.is_exact) return map_of_solids(world.solids, world.resolution);
  FreeSpaceMap map({.resolution = world.resolution, .discretize = true});
  for (const Eigen::Vector3d& sensor : world.sensors) {
    Scan scan = scan_solids(world.solids, sensor, world.sensor_range, world.resolution);
    for (Eigen::Vector3f& point : scan.points) {  // it sees voxels whose middles are within its range
      const Eigen::Vector3d middle =
          voxel_middle(scan.map_from_sensor * point.cast<double>(), world.resolution) - sensor;
      if (middle.norm() > world.sensor_range && point.norm() <= world.sensor_range)
        point = middle.cast<float>();
    }
    map.insert(scan, {.max_range = world.sensor_range});
  }
  for (const SuiteVolume& volume : world.volumes) paint(world, volume, critical_parts, map);
  return map.snapshot();
}

}  // namespace clearway
