#pragma once

#include <optional>
#include <vector>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/simulation/surface.hpp"

namespace clearway {

/// The shapes and the fixed boards of a scene as a camera sees them.
std::vector<Surface> still_surfaces(const Scene& scene);

/// The probe at a pose: the tags of its board, the ball, and a thin stick between them.
std::vector<Surface> probe_surfaces(const Setup& setup, const Eigen::Isometry3d& map_from_probe);

/// What moves, as it is in sight at a time: the probe, unless a gripper has taken over from it, and the
/// gripper (the tags of its board and a thin stick to its tip), with the hands that hold them.
struct MovingThings {
  std::optional<ProbeMotion::State> probe;
  std::optional<Eigen::Isometry3d> map_from_tip;
  std::vector<int> covered;  ///< tags of the probe on which a finger lies
};
/// @param time s after the first picture
MovingThings moving_things(const Scene& scene, const ProbeMotion& motion, double time);
std::vector<Surface> surfaces_of(const Scene& scene, const MovingThings& moving);

}  // namespace clearway
