#pragma once

#include <optional>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "datasets/sources/recording.hpp"
#include "tracking/tracking_session.hpp"

namespace clearway {

/// With the calibration's errors that a setup states; the tracking's own defaults where it says nothing.
Camera tracking_camera(const CameraIntrinsics& intrinsics, const CameraErrorsSetup& errors = {});
TagBody tag_body(const BoardSetup& board);

/// What a setup says of detecting tags and of accepting a pose; the tracking's own default where it says
/// nothing.
TrackingOptions tracking_options(const Setup& setup);

/// The camera of an image: the setup's, else the recording's; whether it is rectified, the recording says.
/// @throws std::invalid_argument when neither has it.
CameraIntrinsics intrinsics_of(const Setup& setup, const ImageFrame& image);
/// The same with the errors that the setup states.
Camera camera_of(const Setup& setup, const ImageFrame& image);

/// Camera, boards, probe and errors for tracking the probe in images like this one. @pre setup.probe
/// @throws std::invalid_argument as camera_of and fixed_board do.
TrackingSetup tracking_setup(const Setup& setup, const ImageFrame& image);

/// The board that anchors the map frame: the first with a place in it.
/// @throws std::invalid_argument when there is none; `needed_by` is what needs it.
const BoardSetup& fixed_board(const Setup& setup, const std::string& needed_by);

/// Image -> painted sphere: a tracking session, made when the first image has the camera.
class Painter {
 public:
  /// @pre setup.probe, and the map has the setup's volumes
  Painter(const Setup& setup, FreeSpaceMap& map, FusionCounts& counts);

  /// Tracks the probe by the tags in its image, and paints when the sample is accepted: as `brush` says (its
  /// strokes are then the caller's), else into the volumes whose time it is, a stroke ending when the hand
  /// pauses.
  TrackedImage take(const Frame& frame, const ImageFrame& image, const std::vector<TagDetection>& tags,
                    double since_start, const std::optional<Brush>& brush = {});
  void finish();

 private:
  void continue_stroke(const std::string& sensor, double since_start);
  Sphere sphere_of(const PaintingSample& sample) const;
  void paint(const PaintingSample& sample, const std::string& sensor, double since_start);
  void use(const Brush& brush, const PaintingSample& sample, double since_start);
  void count(const PaintingSample& sample, const Sphere& sphere);

  const Setup& setup_;
  FreeSpaceMap& map_;
  FusionCounts& counts_;
  const BoardSetup* base_ = nullptr;
  std::vector<VolumeSetup> volumes_;
  std::optional<TrackingSession> session_;
  std::optional<double> last_painted_;  ///< seconds since the start
  int strokes_ = 0;
};

}  // namespace clearway
