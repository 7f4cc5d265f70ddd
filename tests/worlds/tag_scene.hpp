#pragma once

#include <Eigen/Geometry>
#include <array>
#include <opencv2/core/mat.hpp>
#include <random>
#include <string>
#include <vector>

#include "tracking/camera.hpp"
#include "tracking/tag_body.hpp"

/// Images of printed tags with exactly known truth, drawn ray by ray: every sub-pixel's ray (undistorted by
/// OpenCV, not by our Camera) meets the tag's plane and takes the grey of the cell that it hits.
namespace clearway::scene {

struct PlacedTag {
  int id = 0;
  double size = 0.06;
  Eigen::Isometry3d camera_from_tag = Eigen::Isometry3d::Identity();
};

struct Look {
  int supersample = 4;
  double blur = 0.6;   ///< Gaussian, pixels
  double noise = 2.0;  ///< Gaussian, grey levels
  unsigned seed = 1;
};

Camera plain_camera();
Camera distorted_camera();
/// Like an Azure Kinect's colour camera: k1 to k6 are large and nearly cancel.
Camera rational_camera();
/// 100 degrees from the axis in its corners.
Camera fisheye_camera();

/// Camera looking at a tag `distance` ahead, turned by `tilt` about an axis of the tag's plane at `azimuth`,
/// rolled about its normal, shifted sideways.
Eigen::Isometry3d tag_before_camera(double distance, double tilt, double azimuth = 0.0, double roll = 0.0,
                                    double x = 0.0, double y = 0.0);

/// Pixel of a point of the camera frame by OpenCV.
Eigen::Vector2d pixel_by_opencv(const Camera& camera, const Eigen::Vector3d& point);

/// The corners as TagDetection promises them: upper left, upper right, lower right, lower left of the print.
std::array<Eigen::Vector2d, 4> true_corners(const Camera& camera, const PlacedTag& tag);

cv::Mat render(const Camera& camera, const std::vector<PlacedTag>& tags, const Look& look = {});

/// A flat board of columns x rows tags in its own x-y plane, centred, ids rising from `first`.
TagBody board(const std::string& name, int first, int columns, int rows, double size, double pitch);

/// A cube with one tag on each of five faces (not on -z); frame in its middle.
TagBody cube(const std::string& name, int first, double size, double side);

/// Its tags that face the camera.
std::vector<PlacedTag> placed(const TagBody& body, const Eigen::Isometry3d& camera_from_body);

/// Detections without an image: true corners with Gaussian noise of `sigma` pixels.
std::vector<TagDetection> noisy_detections(const Camera& camera, const std::vector<PlacedTag>& tags,
                                           double sigma, std::mt19937& random);

/// Of the turn between them, radians.
double angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

}  // namespace clearway::scene
