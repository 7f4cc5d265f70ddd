#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/delivered_depth.hpp"
#include "datasets/simulation/surface.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// What a frame's pixels and pose get wrong, instead of the range noise of FurnishedRoom's own.
struct RoomErrors {
  DepthNoise depth = DepthNoise::structured_light();
  SequenceErrors sequence{};
};

/// How the camera goes through the room.
enum class RoomWalk {
  round,  ///< one round near the middle, looking outwards; 640 x 480 pixels
  wide,   ///< along the walls and past the things, each seen from several sides; slanted boards stand in the
          ///< room; 320 x 240 pixels, 2 s from frame to frame
};

/// A furnished room of 5 x 4 x 2.6 m, seen by a depth camera that walks round it: generated frames with exact
/// truth, for benchmarks and evaluations. Map frame: z up, floor at z = 0, origin in the middle of the floor.
class FurnishedRoom {
 public:
  /// @param frames poses on the walk (one full round). @param seed of the noise.
  /// @param noise scales the noise of the range, 1 is a structured-light camera's
  ///        (sigma = 1.2 mm + 1.9 mm/m^2 * range^2; Nguyen et al. 2012), 0 none.
  FurnishedRoom(std::size_t frames, std::uint64_t seed, double noise);
  /// The same walk with a camera's other errors as well.
  FurnishedRoom(std::size_t frames, std::uint64_t seed, const RoomErrors& errors,
                RoomWalk walk = RoomWalk::round);

  std::size_t frames() const { return scene_.depth->map_from_sensor.size(); }
  const SceneDepth& camera() const { return *scene_.depth; }

  /// Frame `index`: all pixels less those without return, sensor frame (x forward, y left, z up).
  /// Its pose is the stated one, wrong by the pose errors asked for.
  CloudFrame frame(std::size_t index) const;

  /// The frames in the order in which they arrive (see deliver_depth), with their stated poses.
  const std::vector<Delivery>& deliveries() const { return deliveries_; }

  /// The pose that frame `index` comes with: the camera's own, wrong by the pose errors asked for.
  const Eigen::Isometry3d& stated_pose(std::size_t index) const { return stated_.at(index); }

  /// Where the ray of frame `index` through `direction` (sensor frame, unit length) truly meets something:
  /// the range, infinite for nowhere, and the normal in the map frame. From the true pose.
  Hit truth(std::size_t index, const Eigen::Vector3d& direction) const;

  /// Distance from a point to the nearest wall or thing, metres; negative inside of one.
  double distance_to_solid(const Eigen::Vector3d& point) const;
  /// True when the point lies inside a wall or a thing.
  bool is_solid(const Eigen::Vector3d& point) const;
  const std::vector<SceneShape>& shapes() const { return scene_.shapes; }
  const std::vector<Surface>& surfaces() const { return surfaces_; }

 private:
  void state_poses();

  Scene scene_;
  std::uint64_t seed_;
  std::vector<Eigen::Isometry3d> stated_;  ///< of each frame
  std::vector<Delivery> deliveries_;
  std::vector<Surface> surfaces_;
};

}  // namespace clearway
