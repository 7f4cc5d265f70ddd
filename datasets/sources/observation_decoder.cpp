#include "datasets/sources/observation_decoder.hpp"

#include <mrpt/maps/CPointsMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/obs/CObservationVelodyneScan.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

Eigen::Isometry3d isometry(const mrpt::poses::CPose3D& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      result.linear()(row, column) = pose.getRotationMatrix()(row, column);
    result.translation()[row] = pose.m_coords[row];
  }
  return result;
}

namespace {

using Content = std::function<void(decltype(Frame::content)&&)>;
using Skipped = std::function<void(const std::string&)>;

CameraIntrinsics intrinsics(const mrpt::img::TCamera& camera) {
  CameraIntrinsics result{static_cast<int>(camera.ncols),
                          static_cast<int>(camera.nrows),
                          camera.fx(),
                          camera.fy(),
                          camera.cx(),
                          camera.cy(),
                          {}};
  result.is_rectified = camera.cameraName == rectified_camera_name;
  if (camera.distortion == mrpt::img::DistortionModel::kannala_brandt)
    set_lens(result, LensModel::fisheye, std::array{camera.k1(), camera.k2(), camera.k3(), camera.k4()});
  else if (camera.distortion == mrpt::img::DistortionModel::plumb_bob)
    set_lens(result, LensModel::rational, camera.dist);  // MRPT's plumb bob has room for k4, k5, k6
  return result;
}

void decode_image(const mrpt::img::CImage& stored, const mrpt::img::TCamera& camera,
                  const mrpt::poses::CPose3D& pose, const Content& content, const Skipped& skipped) {
  if (stored.isExternallyStored()) {
    return skipped("an image is stored outside of the recording, in '" + stored.getExternalStorageFile() +
                   "': only embedded images are read");
  }
  if (stored.isEmpty()) return skipped("an image has no pixels");
  const mrpt::img::CImage grey = stored.isColor() ? stored.grayscale() : stored;
  if (grey.getPixelDepth() != mrpt::img::PixelDepth::D8U)
    return skipped("an image does not have 8 bits a channel");
  ImageFrame frame;
  frame.image.width = static_cast<int>(grey.getWidth());
  frame.image.height = static_cast<int>(grey.getHeight());
  frame.image.pixels.reserve(grey.getWidth() * grey.getHeight());
  for (int row = 0; row < frame.image.height; ++row) {
    const auto* line = grey.ptrLine<uint8_t>(row);
    frame.image.pixels.insert(frame.image.pixels.end(), line, line + frame.image.width);
  }
  frame.intrinsics = intrinsics(camera);
  frame.world_from_sensor = isometry(pose);
  content(std::move(frame));
}

/// Points of a range image: MRPT's depth camera looks along +x, with +y left and +z up.
std::vector<Eigen::Vector3f> range_points(const mrpt::obs::CObservation3DRangeScan& scan) {
  const Lens lens(intrinsics(scan.cameraParams));
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < scan.rangeImage.rows(); ++row) {
    for (int column = 0; column < scan.rangeImage.cols(); ++column) {
      constexpr std::uint16_t saturated = 65535;  // of cameras' pictures: no return
      const std::uint16_t steps = scan.rangeImage(row, column);
      const double range = steps * static_cast<double>(scan.rangeUnits);
      if (!(range > 0) || steps == saturated) continue;
      const auto optical = lens.pixel_ray({column, row});
      if (!optical) continue;
      const Eigen::Vector3d ray(1, -optical->x(), -optical->y());
      const Eigen::Vector3d point = scan.range_is_depth ? range * ray : range * ray.normalized();
      if (point.allFinite()) points.push_back(point.cast<float>());
    }
  }
  return points;
}

void decode_range_camera(const mrpt::obs::CObservation3DRangeScan& scan,
                         const mrpt::poses::CPose3D& world_from_robot, const Content& content,
                         const Skipped& skipped) {
  const mrpt::poses::CPose3D world_from_sensor = world_from_robot + scan.sensorPose;
  CloudFrame cloud;
  cloud.world_from_sensor = isometry(world_from_sensor);
  cloud.max_range = scan.maxRange;
  if (scan.hasRangeImage) {
    if (scan.rangeImage_isExternallyStored()) {
      skipped("a range image is stored outside of the recording: only embedded ones are read");
    } else {
      cloud.kind = "depth";
      cloud.points = range_points(scan);
      content(std::move(cloud));
    }
  } else if (scan.hasPoints3D) {
    if (scan.points3D_isExternallyStored()) {
      skipped("a cloud is stored outside of the recording: only embedded ones are read");
    } else {
      cloud.kind = "points";
      for (size_t i = 0; i < scan.points3D_x.size(); ++i) {
        const Eigen::Vector3f point(scan.points3D_x[i], scan.points3D_y.at(i), scan.points3D_z.at(i));
        take_point(cloud, point);
      }
      content(std::move(cloud));
    }
  } else {
    skipped("");
  }
  if (scan.hasIntensityImage) {
    decode_image(scan.intensityImage, scan.cameraParamsIntensity,
                 world_from_sensor + scan.relativePoseIntensityWRTDepth, content, skipped);
  }
}

CloudFrame laser_scan(const mrpt::obs::CObservation2DRangeScan& scan,
                      const mrpt::poses::CPose3D& world_from_robot) {
  CloudFrame cloud;
  cloud.kind = "laser2d";
  cloud.max_range = scan.maxRange;
  cloud.world_from_sensor = isometry(world_from_robot + scan.sensorPose);
  const size_t size = scan.getScanSize();
  const double first = (scan.rightToLeft ? -0.5 : 0.5) * scan.aperture;
  const double step = size > 1 ? (scan.rightToLeft ? 1 : -1) * scan.aperture / (size - 1.0) : 0;
  for (size_t i = 0; i < size; ++i) {
    const double range = scan.getScanRange(i), angle = first + step * static_cast<double>(i);
    if (std::isinf(range) && range > 0.0) {
      ++cloud.infinite;
      if (scan.maxRange > 0.0F && std::isfinite(scan.maxRange))
        cloud.clear_to.emplace_back(scan.maxRange * std::cos(angle), scan.maxRange * std::sin(angle), 0);
      continue;
    }
    if (!scan.getScanRangeValidity(i) || !(range > 0) || !(range < scan.maxRange)) continue;
    cloud.points.emplace_back(range * std::cos(angle), range * std::sin(angle), 0);
  }
  return cloud;
}

CloudFrame velodyne_scan(mrpt::obs::CObservationVelodyneScan scan,
                         const mrpt::poses::CPose3D& world_from_robot) {
  CloudFrame cloud;
  cloud.kind = "velodyne";
  cloud.max_range = scan.maxRange;
  cloud.world_from_sensor = isometry(world_from_robot + scan.sensorPose);
  if (scan.point_cloud.size() == 0) scan.generatePointCloud();
  for (size_t i = 0; i < scan.point_cloud.x.size(); ++i) {
    const Eigen::Vector3f point(scan.point_cloud.x[i], scan.point_cloud.y.at(i), scan.point_cloud.z.at(i));
    take_point(cloud, point);
  }
  return cloud;
}

void decode_point_cloud(const mrpt::obs::CObservationPointCloud& observed,
                        const mrpt::poses::CPose3D& world_from_robot, const Content& content,
                        const Skipped& skipped) {
  if (observed.isExternallyStored())
    return skipped("a cloud is stored outside of the recording: only embedded ones are read");
  CloudFrame cloud;
  cloud.kind = "points";
  cloud.world_from_sensor = isometry(world_from_robot + observed.sensorPose);
  for (size_t i = 0; observed.pointcloud && i < observed.pointcloud->size(); ++i) {
    Eigen::Vector3f point;
    observed.pointcloud->getPointFast(i, point.x(), point.y(), point.z());
    if (point.allFinite())
      cloud.points.push_back(point);
    else
      ++cloud.unusable;
  }
  content(std::move(cloud));
}

/// Of a kind that shows where something is, or is not, and that has no frame of ours; empty for others.
std::string unread(const mrpt::obs::CObservation& observation) {
  constexpr std::array kinds{"CObservationRotatingScan",  // has no elevations of its rows
                             "CObservationRange", "CObservationRGBD360", "CObservation3DScene"};
  std::string_view kind = observation.GetRuntimeClass()->className;
  kind.remove_prefix(std::min(kind.size(), kind.rfind(':') + 1));
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) return {};
  return "sensor " + quote(observation.sensorLabel) + ": what MRPT keeps as " + std::string(kind) +
         " is not read";
}

}  // namespace

void decode_observation(const mrpt::obs::CObservation& observation,
                        const mrpt::poses::CPose3D& world_from_robot, const Content& content,
                        const Skipped& skipped) {
  using namespace mrpt::obs;
  if (const auto* image = dynamic_cast<const CObservationImage*>(&observation)) {
    decode_image(image->image, image->cameraParams, world_from_robot + image->cameraPose, content, skipped);
  } else if (const auto* stereo = dynamic_cast<const CObservationStereoImages*>(&observation)) {
    decode_image(stereo->imageLeft, stereo->leftCamera,
                 world_from_robot + mrpt::poses::CPose3D(stereo->cameraPose), content, skipped);
  } else if (const auto* range = dynamic_cast<const CObservation3DRangeScan*>(&observation)) {
    decode_range_camera(*range, world_from_robot, content, skipped);
  } else if (const auto* laser = dynamic_cast<const CObservation2DRangeScan*>(&observation)) {
    content(laser_scan(*laser, world_from_robot));
  } else if (const auto* points = dynamic_cast<const CObservationPointCloud*>(&observation)) {
    decode_point_cloud(*points, world_from_robot, content, skipped);
  } else if (const auto* velodyne = dynamic_cast<const CObservationVelodyneScan*>(&observation)) {
    content(velodyne_scan(*velodyne, world_from_robot));
  } else if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation)) {
    content(OdometryFrame{isometry(mrpt::poses::CPose3D(odometry->odometry))});
  } else if (const auto* comment = dynamic_cast<const CObservationComment*>(&observation)) {
    content(CommentFrame{comment->text});
  } else {
    skipped(unread(observation));
  }
}

}  // namespace clearway
