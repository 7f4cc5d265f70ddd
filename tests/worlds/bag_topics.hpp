#pragma once

#include "datasets/sources/frame_source.hpp"

namespace clearway::worlds {

/// All topics of the bags in tests/datasets/ros/bags.
inline SourceOptions all_topics() {
  SourceOptions options;
  options.bag.images = "/camera/image";
  options.bag.camera_info = "/camera/camera_info";
  options.bag.depth = {{"/camera/depth", options.bag.camera_info}};
  options.bag.clouds = {"/points"};
  options.bag.scans = {"/scan"};
  options.bag.fixed_frame = "map";
  return options;
}

}  // namespace clearway::worlds
