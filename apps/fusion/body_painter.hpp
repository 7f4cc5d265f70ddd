#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "apps/fusion/moving_robot.hpp"

namespace clearway {

/// Spheres that lie wholly inside a shape (its own frame), each by at least `margin` metres: those in the
/// middle first, `most` at most; none where the margin leaves nothing.
/// @pre shape.has_exact_distance()
std::vector<Sphere> inner_spheres(const Shape& shape, double margin, std::size_t most = 200);

/// Paints with the bodies of a robot that a person leads by its hand: where they were, the space was free.
///
/// At each reading of the joints the spheres inside of the setup's parts (`robot: paints`) are painted, each
/// smaller by how far a point of its body may be from where the joints put it: place_error, and of each joint
/// its lever times joint_error. Nothing is painted between readings. The latency plays no part: wherever the
/// robot was, whenever, was free.
class BodyPainter {
 public:
  /// @param robot lives as long as this
  /// @throws std::invalid_argument for a part that the robot does not have, or whose bodies are meshes (of
  ///         which nothing is proved inside), or no larger than the error.
  BodyPainter(const Setup& setup, const MovingRobot& robot, FreeSpaceMap& map);

  /// Paints with the readings up to `time` that were not yet used.
  /// @param start of the recording: the volumes' times count from there
  /// @param brush what paints into which volume at the moment; empty: the volumes whose time it is
  void paint_until(double time, double start, const std::optional<Brush>& brush);

  /// Of what it paints, metres.
  double largest_radius() const;

  std::size_t spheres() const { return spheres_; }  ///< painted so far

 private:
  struct Painting {
    int link;
    std::vector<Sphere> spheres;  ///< in the link's frame, already smaller
  };
  void paint(const LinkPoses& poses, double since_start, const std::optional<Brush>& brush);

  const MovingRobot& robot_;
  FreeSpaceMap& map_;
  std::vector<VolumeSetup> volumes_;
  std::vector<Painting> paintings_;
  std::vector<double> times_;
  std::size_t next_ = 0, spheres_ = 0;
  std::optional<double> last_painted_;
  int strokes_ = 0;
};

}  // namespace clearway
