// Paints free space with spheres, as a person does with a probe, and asks where a tool may be.
//
// A stroke of spheres is painted along the y axis; then a camera sees a post in the middle of the paint.

#include <cmath>
#include <iostream>
#include <mapping/free_space_map.hpp>

using namespace clearway;

/// A post of 4 cm at the map's origin, 0.3 m high, seen by a camera at (1, 0, 0.15) m.
Scan look_at_the_post() {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(1.0, 0.0, 0.15);
  for (double up = -0.15; up <= 0.15; up += 0.01) {
    for (double aside = -0.02; aside <= 0.02; aside += 0.01) {
      scan.points.push_back(Eigen::Vector3d(-0.99, aside, up).cast<float>());
    }
  }
  return scan;
}

int main() {
  FreeSpaceMap map({.resolution = 0.02});

  // A painted volume says for which robot parts its space is meant: here the part "tool".
  const int volume = map.add_volume("along the shelf", {"tool"});
  map.begin_stroke("to and fro");
  for (double y = -0.4; y <= 0.4; y += 0.05) {
    map.paint(volume, {.center = {0.0, y, 0.15}, .radius = 0.12});  // metres, map frame
  }
  map.end_stroke();

  // Where does the space of the tool end? Under the policy `painted` all that is not painted is blocked.
  const Eigen::AlignedBox3d region(Eigen::Vector3d(-0.5, -0.8, -0.2), Eigen::Vector3d(0.5, 0.8, 0.5));
  const Snapshot painted = map.snapshot();
  const Requirement tool{.policy = Policy::painted, .volumes = painted.volumes_of_part("tool")};
  const Eigen::Vector3d middle(0.0, 0.0, 0.15);
  const double free_before = painted.blocked_space(tool, region, 0.3)->clearance(middle);
  std::cout << "middle of the stroke: " << to_string(painted.state(middle)) << '\n'
            << "a ball of 6 cm fits there: " << (free_before > 0.06 ? "yes" : "no") << '\n';

  // Sensing does not erase paint: what is painted and occupied is a conflict, which blocks under every
  // policy.
  map.insert(look_at_the_post());
  const Snapshot seen = map.snapshot();
  const Eigen::Vector3d surface(0.01, 0.0, 0.15);
  const auto blocked = seen.blocked_space(tool, region, 0.3);
  const double free_after = blocked->clearance(middle);
  const NearestBlocked nearest = blocked->nearest(middle + Eigen::Vector3d(0.0, 0.05, 0.0), 0.3);
  std::cout << "surface of the post: " << to_string(seen.state(surface)) << ", " << seen.counts().conflict
            << " voxels in conflict\n"
            << "a ball of 6 cm fits there: " << (free_after > 0.06 ? "yes" : "no") << '\n'
            << "from 5 cm beside it the nearest blocked voxel lies towards y "
            << (nearest.direction.y() < 0.0 ? "-" : "+") << '\n';

  // A stroke can be undone; what sensors saw stays.
  map.undo_stroke();
  const Snapshot undone = map.snapshot();
  std::cout << "stroke undone: " << undone.counts().painted << " voxels painted, surface "
            << to_string(undone.state(surface)) << '\n';

  const bool as_expected = painted.state(middle) == VoxelState::painted && free_before > 0.06 &&
                           seen.state(surface) == VoxelState::conflict && free_after < 0.06 &&
                           nearest.found && nearest.direction.y() < 0.0 && undone.counts().painted == 0 &&
                           undone.state(surface) == VoxelState::occupied;
  std::cout << (as_expected ? "as expected\n" : "NOT as expected\n");
  return as_expected ? 0 : 1;
}
