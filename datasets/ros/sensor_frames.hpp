#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/ros_messages.hpp"
#include "datasets/sources/recording.hpp"

// Messages of sensors as frames, in the sensor's own frame. Each function throws std::runtime_error with a
// clause where the message contradicts itself or is of a kind that is not known here.

namespace clearway {

/// As gray_pixels.
GrayImage gray_image(const RosImage& image);
/// PNG and JPEG.
GrayImage gray_image(const RosCompressedImage& image);

/// A depth image: 16UC1 (mono16) in steps, or 32FC1 in metres, along the optical axis; 0 and NaN are no
/// returns. The points are in the sensor's own axes (x forward), which the optical frame's pose turns into.
/// @param rays of that camera (depth_rays) @param step metres
CloudFrame depth_cloud(const RosImage& image, const CameraIntrinsics& camera,
                       const std::vector<Eigen::Vector2d>& rays, double step = 1e-3);

/// Whether the coordinates of a cloud make sense in the other order of bytes than the one it states, and not
/// in that: some drivers say `is_bigendian` of what is not, which PCL and RViz do not read.
/// @throws std::runtime_error a clause, as points_cloud
bool has_other_order(RosPointCloud cloud);

/// Its finite points but those at the origin, which drivers put where nothing came back.
CloudFrame points_cloud(const RosPointCloud& cloud);
/// When the points of points_cloud were measured, by a field of each point's time: t, time, timestamp,
/// time_stamp, offset_time or time_offset, since the stamp or since 1970. Their unit is s, ms, us or ns, by
/// which they span 0.01 to 0.5 s; else ns of integers and s of others. Nothing: there is no such field, or
/// all are equal.
struct PointTimes {
  std::string field;
  double raw_span = 0.0;      ///< in the field's unit
  std::vector<double> times;  ///< s since the stamp; none: they make no sense in any unit
};
std::optional<PointTimes> point_times(const RosPointCloud& cloud);

constexpr double longest_sweep = 60.0;  ///< s, of a laser; a longer one is none

/// A return of a laser of at least its least and less than its largest range.
struct LaserReturn {
  std::size_t ray = 0;    ///< its number in the scan
  Eigen::Vector3f point;  ///< m, in the laser's axes while this ray was out
  bool is_clear =
      false;  ///< where a ray that met nothing (+inf, or no less than range_max) reaches range_max
};
/// @param with_clear whether rays that met nothing are among them
std::vector<LaserReturn> laser_returns(const RosLaserScan& scan, bool with_clear);
/// These returns as if the laser stood meanwhile.
CloudFrame laser_cloud(const RosLaserScan& scan, bool with_clear);
/// Such a cloud without points, which knows how many rays met nothing.
CloudFrame empty_laser_cloud(const RosLaserScan& scan);
/// Whether angle_increment leads away from angle_max. Beams are placed by the increment, as RViz and
/// laser_geometry do.
bool has_opposite_angles(const RosLaserScan& scan);

}  // namespace clearway
