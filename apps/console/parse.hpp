#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "mapping/system/number_text.hpp"  // grouped, counted

namespace clearway {

/// Comma-separated finite numbers. @throws std::invalid_argument naming `what` and the offending text.
std::vector<double> parse_numbers(const std::string& text, const std::string& what);

/// Comma-separated configuration with one value per joint; `degrees` applies to revolute joints only.
/// @throws std::invalid_argument naming `what`, how many values were given and which joints are expected.
Eigen::VectorXd parse_configuration(const std::string& text, const std::string& what,
                                    const std::vector<std::string>& joints,
                                    const std::vector<bool>& is_prismatic, bool degrees);

/// x,y,z[,roll,pitch,yaw] as a pose, Rz(yaw) Ry(pitch) Rx(roll), m and rad; angles beyond a whole turn are
/// refused, as they are meant in degrees.
Eigen::Isometry3d pose_from_numbers(const std::vector<double>& numbers, const std::string& what);

/// The six numbers of a pose, for messages and files.
std::vector<double> numbers_from_pose(const Eigen::Isometry3d& pose);

/// A configuration or a pose for messages: "(0.1, -2, 0.3)".
std::string to_text(const Eigen::VectorXd& values);
std::string to_text(const Eigen::Isometry3d& pose);

/// A number with `digits` significant digits in the classic locale.
std::string significant(double value, int digits = 4);

}  // namespace clearway
