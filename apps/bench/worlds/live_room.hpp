#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "datasets/descriptions/scene.hpp"
#include "mapping/scans/scan.hpp"
#include "mapping/voxels/sphere.hpp"

namespace clearway::bench {

/// A depth frame, and which of the places about the arm has the fist in it; -1: none.
struct LiveFrame {
  Scan scan;
  int place = -1;
};

/// A closed room of 2.4 m about an arm at the origin, with balls hanging in it, for a map at `resolution`; a
/// depth camera in its corner (640 x 480, a structured-light camera's noise), which is not shown the arm, as
/// if its pixels had been taken out; a ball that flies round; and a fist that turns up here and there.
class LiveRoom {
 public:
  explicit LiveRoom(double resolution);

  /// What sensors that look all around make the map of, without the fist and the ball that flies.
  std::vector<Scan> views() const;

  /// Whether the camera sees a point that is not in something's shadow.
  bool is_seen(const Eigen::Vector3d& point) const;
  const Eigen::Vector3d& camera() const { return eye_; }

  /// Ten frames a place: of these three with the fist. They may be repeated end to end.
  std::vector<LiveFrame> frames(const std::vector<Sphere>& places) const;

 private:
  double resolution_;
  Eigen::Vector3d eye_;
  SceneDepth camera_;
  std::vector<SceneShape> things_;
};

}  // namespace clearway::bench
