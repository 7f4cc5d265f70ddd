#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tracking/painting_probe.hpp"
#include "tracking/tag_detector.hpp"

/// Painting sessions drawn from a seed, as corners without images, whose truth is not what the tracker is
/// given: calibration, sizes and places of tags, the print's scale; corners with noise of several families,
/// bias that lasts (growth of the squares, blur along the motion), outliers of corners, edges and whole tags,
/// tags hidden and tags that have come loose.
namespace clearway::scene {

struct TrackedFrame {
  double time = 0.0;
  std::vector<TagDetection> detections;
  Eigen::Vector3d true_ball = Eigen::Vector3d::Zero();  ///< in the base
};

struct TrackedSession {
  std::string what;  ///< one line
  Camera camera;     ///< these four as the tracker is given them
  TagBody base;
  PaintingProbe probe;
  ErrorBudget budget;
  std::vector<TrackedFrame> frames;
  std::vector<Eigen::Vector3d> true_way;  ///< of the ball in the base, ten places a frame
};

/// `severity` multiplies the sizes of all errors, which are drawn between a third and one of those that the
/// tracker expects by default.
TrackedSession draw_session(std::uint64_t seed, int frames, double severity = 1.0);

}  // namespace clearway::scene
