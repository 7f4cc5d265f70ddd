#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <string>
#include <vector>

#include "datasets/ros/ros_messages.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// A sweep's returns, each in the place that the laser had at its own time (laser_geometry's
/// transformLaserScanToPointCloud), in parts during which the laser moves by `most_way` at most, as far as 32
/// parts do. A part has the pose at its middle ray and the time of its first one; one without returns is left
/// out, unless it is the only one.
/// @param time s, of the first ray @param most_way m @param with_clear as of laser_returns
/// @param world_from_laser at a time; what it throws goes on to the caller
/// @throws std::runtime_error a clause: the sweep would take more than 60 s.
std::vector<Frame> frames_of_sweep(const RosLaserScan& scan, const std::string& sensor, double time,
                                   double most_way, bool with_clear,
                                   const std::function<Eigen::Isometry3d(double time)>& world_from_laser);

/// A cloud's points, each in the place that the sensor had at its own time, in parts as those of a sweep.
/// @param times s, one for each point @param world_from_sensor at a time; what it throws goes on
std::vector<Frame> frames_of_timed_cloud(
    const CloudFrame& cloud, const std::vector<double>& times, const std::string& sensor, double most_way,
    const std::function<Eigen::Isometry3d(double time)>& world_from_sensor);

}  // namespace clearway
