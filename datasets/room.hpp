#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "datasets/recording.hpp"
#include "datasets/scene.hpp"
#include "datasets/surface.hpp"

namespace clearway {

/// A furnished room of 5 x 4 x 2.6 m, seen by a depth camera that walks round it: generated frames with exact
/// truth, for benchmarks and evaluations. Map frame: z up, floor at z = 0, origin in the middle of the floor.
class FurnishedRoom {
 public:
  /// @param frames poses on the walk (one full round). @param seed of the noise.
  /// @param noise scales the noise of the range, 1 is a structured-light camera's
  ///        (sigma = 1.2 mm + 1.9 mm/m^2 * range^2; Nguyen et al. 2012), 0 none.
  FurnishedRoom(std::size_t frames, std::uint64_t seed, double noise);

  std::size_t frames() const { return scene_.depth->map_from_sensor.size(); }
  const SceneDepth& camera() const { return *scene_.depth; }

  /// Frame `index`: 640 x 480 pixels less those without return, sensor frame (x forward, y left, z up).
  CloudFrame frame(std::size_t index) const;

  /// True when the point lies inside a wall or a thing.
  bool is_solid(const Eigen::Vector3d& point) const;
  const std::vector<SceneShape>& shapes() const { return scene_.shapes; }
  const std::vector<Surface>& surfaces() const { return surfaces_; }

 private:
  Scene scene_;
  std::uint64_t seed_;
  std::vector<Surface> surfaces_;
};

}  // namespace clearway
