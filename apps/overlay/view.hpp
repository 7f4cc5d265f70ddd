#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "tracking/camera.hpp"

namespace clearway {

/// An image and where its camera was.
struct View {
  cv::Mat image;
  Camera camera;
  Eigen::Isometry3d camera_from_map = Eigen::Isometry3d::Identity();
};

}  // namespace clearway
