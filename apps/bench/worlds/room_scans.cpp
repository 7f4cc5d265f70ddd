#include "apps/bench/worlds/room_scans.hpp"

#include "datasets/simulation/room.hpp"
#include "datasets/sources/lens.hpp"

namespace clearway::bench {

Scan scan_of(const CloudFrame& frame) {
  Scan scan;
  scan.sensor = frame.kind;
  scan.map_from_sensor = frame.world_from_sensor;
  scan.points = frame.points;
  return scan;
}

Scan scan_of(const DepthImage& image) {
  const auto width = static_cast<std::size_t>(image.intrinsics.width);
  const Lens lens(image.intrinsics);
  Scan scan;
  scan.sensor = "depth";
  scan.map_from_sensor = image.world_from_sensor;
  for (std::size_t pixel = 0; pixel < image.ranges.size(); ++pixel) {
    const float range = image.ranges[pixel];
    if (!(range > 0.0F)) continue;
    const auto optical =
        lens.pixel_ray({static_cast<double>(pixel % width), static_cast<double>(pixel / width)});
    if (!optical) continue;
    const Eigen::Vector3d ray = Eigen::Vector3d(1, -optical->x(), -optical->y()).normalized();
    scan.points.push_back((double{range} * ray).cast<float>());
  }
  return scan;
}

std::vector<Scan> room_scans(std::size_t frames, std::size_t used) {
  const FurnishedRoom room(frames, 1, 1.0);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < used; ++i) scans.push_back(scan_of(room.frame(i)));
  return scans;
}

}  // namespace clearway::bench
