#pragma once

#include "tracking/probe.hpp"
#include "tracking/tag_detector.hpp"

namespace clearway {

/// What is true of one setup: the camera, the tags and the errors of its parts.
struct TrackingSetup {
  Camera camera;
  TagBody base;
  PaintingProbe probe;
  ErrorBudget budget;
};

/// Options of the parts of a session.
struct TrackingOptions {
  TagDetectorOptions detector;
  BodyPoseOptions pose;
  AcceptanceOptions acceptance;
};

/// All that one image gave.
struct TrackedImage {
  std::vector<TagDetection> detections;
  PaintingSample sample;
};

/// Image in, painted sphere (or the reason why not) out: detector, body poses, Chong 2008, eq. 1 and 3,
/// acceptance. The easy call; the parts are in the headers it names. One session per camera, used by one
/// thread at a time.
class TrackingSession {
 public:
  /// Throws std::invalid_argument as TagDetector and Probe do.
  explicit TrackingSession(const TrackingSetup& setup, const TrackingOptions& options = {});

  /// One grey image taken at `time` (seconds, rising). An image of another type or size than the camera's is
  /// refused as a sample with its reason; nothing is thrown.
  TrackedImage step(const cv::Mat& gray, double time);

  /// The same for an image in which another detector of the same options has found `detections`.
  TrackedImage step(const cv::Mat& gray, std::vector<TagDetection> detections, double time);

  const Probe& probe() const { return probe_; }              ///< counts by reason, r0
  const TagDetector& detector() const { return detector_; }  ///< counts of detections

 private:
  bool takes(const cv::Mat& gray) const;

  Camera camera_;
  TagDetector detector_;
  Probe probe_;
};

}  // namespace clearway
