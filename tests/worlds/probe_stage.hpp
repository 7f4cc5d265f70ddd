#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "tests/worlds/tag_scene.hpp"
#include "tracking/probe.hpp"

namespace clearway::scene {

/// No image needs another to confirm it, so that a test may look at one.
inline AcceptanceOptions on_its_own() {
  AcceptanceOptions acceptance;
  acceptance.max_pause = std::numeric_limits<double>::infinity();
  return acceptance;
}

/// A board and a cube probe half a metre before the camera; detections are made from true corners.
struct Stage {
  Camera camera = plain_camera();
  TagBody base = board("base", 0, 3, 2, 0.06, 0.09);
  PaintingProbe probe{cube("probe", 20, 0.05, 0.07), {0.0, 0.0, 0.09}, 0.04};
  ErrorBudget budget;
  AcceptanceOptions acceptance = on_its_own();
  BodyPoseOptions pose;
  Eigen::Isometry3d camera_from_base = tag_before_camera(0.6, 0.7, 0.2, 0.0, -0.08, 0.06);
  Eigen::Isometry3d camera_from_probe = tag_before_camera(0.45, 0.8, 2.5, 0.3, 0.08, -0.04);
  double noise = 0.05;
  std::mt19937 random{41};

  Probe made() const { return Probe(camera, base, probe, budget, acceptance, pose); }

  std::vector<TagDetection> seen() {
    auto tags = placed(base, camera_from_base);
    for (const auto& tag : placed(probe.body, camera_from_probe)) tags.push_back(tag);
    return noisy_detections(camera, tags, noise, random);
  }
};

inline std::vector<TagDetection> without(std::vector<TagDetection> detections, int first, int last) {
  std::erase_if(detections, [&](const TagDetection& d) { return d.id >= first && d.id <= last; });
  return detections;
}

inline void expect_refused(const PaintingSample& sample, Refusal refusal) {
  EXPECT_FALSE(sample.accepted);
  EXPECT_EQ(to_string(sample.refusal), to_string(refusal)) << sample.reason;
  EXPECT_FALSE(sample.reason.empty());
}

}  // namespace clearway::scene
