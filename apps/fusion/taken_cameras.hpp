#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Notes of each camera whether its pictures were taken as raw or rectified, and what says so.
class TakenCameras {
 public:
  /// A frame that is used. Only the first image of a sensor counts.
  void see(const Frame& frame, const Setup& setup);

  /// Whether an image of that sensor was seen.
  bool has_seen(const std::string& sensor) const;

  /// All cameras that were seen, those of which the source itself says so first. To be asked at the end.
  std::vector<TakenCamera> all(const FrameSource& source) const;

 private:
  std::vector<TakenCamera> seen_;
};

/// "rectified" or "raw", and what says so, for tables: "raw, by its topic's name". Here, so that reports need
/// nothing of what reads recordings (hand_over.cpp).
inline std::string shown(const TakenCamera& camera) {
  return std::string(camera.is_rectified ? "rectified" : "raw") + ", by " + camera.known_by;
}

}  // namespace clearway
