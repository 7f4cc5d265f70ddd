#include "apps/bench/room_scans.hpp"

#include "datasets/room.hpp"

namespace clearway::bench {

Scan scan_of(const CloudFrame& frame) {
  Scan scan;
  scan.sensor = frame.kind;
  scan.map_from_sensor = frame.world_from_sensor;
  scan.points = frame.points;
  return scan;
}

std::vector<Scan> room_scans(std::size_t frames) {
  const FurnishedRoom room(frames, 1, 1.0);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < frames; ++i) scans.push_back(scan_of(room.frame(i)));
  return scans;
}

}  // namespace clearway::bench
