// Fuses a point cloud into a map, asks the map what it knows, saves it and loads it again.
//
// A depth camera at (0, 0, 0.5) m looks along the map's x axis at a wall 1.51 m away.

#include <filesystem>
#include <iostream>
#include <mapping/files/map_file.hpp>
#include <mapping/free_space_map.hpp>

using namespace clearway;

/// What the camera measures: points in its own frame, metres, together with its pose in the map.
Scan look_at_the_wall() {
  Scan scan;
  scan.sensor = "camera";
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
  for (double up = -0.36; up <= 0.36; up += 0.006) {
    for (double aside = -0.48; aside <= 0.48; aside += 0.006) {
      scan.points.push_back((1.51 * Eigen::Vector3d(1.0, aside, up)).cast<float>());
    }
  }
  return scan;
}

/// Three points, their states, and what we expect there.
bool knows_the_scene(const Snapshot& map) {
  const struct {
    const char* place;
    Eigen::Vector3d point;
    VoxelState expected;
  } questions[] = {{"on the wall    ", {1.51, 0.1, 0.5}, VoxelState::occupied},
                   {"before the wall", {1.00, 0.1, 0.5}, VoxelState::seen_free},
                   {"behind the wall", {2.00, 0.1, 0.5}, VoxelState::unknown}};
  bool as_expected = true;
  for (const auto& [place, point, expected] : questions) {
    std::cout << place << ": " << to_string(map.state(point)) << '\n';
    as_expected = as_expected && map.state(point) == expected;
  }
  return as_expected;
}

int main() {
  // Voxels of 2 cm. By default integration is `safe`: what a scan hits is blocked at once, and nothing next
  // to a surface is called free.
  FreeSpaceMap map({.resolution = 0.02});
  const ScanCounts counts = map.insert(look_at_the_wall(), {.max_range = 3.0});
  std::cout << "points inserted: " << counts.inserted << '\n';

  // A snapshot is an immutable view, cheap to copy and safe to read from many threads.
  const Snapshot snapshot = map.snapshot();
  bool as_expected = knows_the_scene(snapshot);

  const auto folder = std::filesystem::temp_directory_path() / "clearway_example_map";
  save_map(snapshot, folder);
  const Snapshot loaded = load_map(folder);
  const VoxelCounts saved = snapshot.counts(), read = loaded.counts();
  as_expected = as_expected && saved.occupied == read.occupied && saved.seen_free == read.seen_free;
  std::cout << "saved and loaded: " << read.occupied << " voxels occupied, " << read.seen_free
            << " seen free\n";
  std::filesystem::remove_all(folder);

  std::cout << (as_expected ? "as expected\n" : "NOT as expected\n");
  return as_expected ? 0 : 1;
}
