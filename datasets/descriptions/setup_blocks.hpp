#pragma once

#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"

namespace clearway {

// Parts of a setup as YAML text that parse_setup reads back, for commands that measure them.

/// The `camera` key of a setup.
std::string camera_block(const CameraIntrinsics& camera);
/// The `errors` key.
std::string errors_block(const ErrorsSetup& errors);
/// The `boards` key.
std::string boards_block(const std::vector<BoardSetup>& boards);
/// The `probe` key.
std::string probe_block(const ProbeSetup& probe);
/// The `robot` key.
std::string robot_block(const RobotSetup& robot);
/// The `sensors` key.
std::string sensors_block(const std::vector<SensorSetup>& sensors);

/// A setup's text with the top level key of `block` replaced by it, or added at the end: all other lines stay
/// as they are, comments too. @param block as the functions above give it
/// @throws std::invalid_argument when the text has the key in a form that is not replaced (a flow map)
std::string with_block(const std::string& setup, const std::string& block);

}  // namespace clearway
