#pragma once

#include <string>

#include "datasets/ros/message_bag.hpp"

namespace clearway {

/// Whether a topic is the option in which RealSense's SDK records how far a step of this depth topic is:
/// "/device_0/sensor_0/option/Depth Units/value" beside "/device_0/sensor_0/Depth_0/image/data"
/// (librealsense, ros_file_format.h).
bool is_depth_units(const BagTopic& topic, const std::string& depth);

/// Reads such a message: metres per step. @throws std::runtime_error a clause when it is none
double read_depth_units(WireReader& in);

}  // namespace clearway
