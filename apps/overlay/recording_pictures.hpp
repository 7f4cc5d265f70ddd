#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/overlay/overlay_scene.hpp"
#include "apps/overlay/view.hpp"
#include "apps/track/image_poses.hpp"
#include "mapping/free_space_map.hpp"

namespace clearway {

/// "12.3 s"
std::string to_tenths(double seconds);

/// The paint as it was at some time, over what the sensors saw in the end. The map must live on.
class GrowingPaint {
 public:
  explicit GrowingPaint(const Snapshot& map);

  /// @param time seconds since the recording's start, rising
  const OverlayMap& at(double time);
  std::size_t spheres() const;

 private:
  void show();

  const Snapshot& final_;
  OverlayMap shown_;
  FreeSpaceMap paint_;
  std::vector<Voxel> conflicts_;
  std::vector<std::size_t> next_;  ///< sphere of each volume
};

/// The images of the recording with what was painted so far. Setup and map must live on.
class RecordingPictures {
 public:
  RecordingPictures(const Setup& setup, const Snapshot& map) : setup_(setup), paint_(map) {}

  cv::Mat draw(const View& view, const ImagePoses& poses, double since_start);

  /// An image for which the pose of the camera is not known.
  cv::Mat draw_lost(const cv::Mat& image, const ImagePoses& poses, double since_start);

 private:
  std::optional<OverlayBall> ball_of(const ImagePoses& poses, double since_start);
  Strip strip(double since_start) const;

  const Setup& setup_;
  GrowingPaint paint_;
  std::optional<double> refused_at_;
  std::string refusal_, cure_;
};

}  // namespace clearway
