#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/descriptions/suite.hpp"

namespace clearway {

class YamlFields;

/// A list of [x, y, z, radius]. @throws std::invalid_argument
std::vector<SuiteSphere> read_spheres(const YamlFields& fields, const std::string& key);

/// One stroke of a suite's volume: {balls}, {points, radius, spacing} or {points, around, radii, count,
/// seed}; the map must hold nothing else. @throws std::invalid_argument
std::vector<SuiteSphere> read_suite_stroke(const YamlFields& fields);

/// Spheres of one radius at both ends of the polyline, at its corners, and between them at most `spacing`
/// apart.
/// @pre at least one point, radius and spacing > 0 @param points,radius,spacing metres
std::vector<SuiteSphere> spheres_along(const std::vector<Eigen::Vector3d>& points, double radius,
                                       double spacing);

/// `count` spheres in the order of the polyline, evenly along it, each moved by up to `around` along each
/// axis, with radii between the two: a hand that waves its ball about a way. Metres. @pre at least one point
std::vector<SuiteSphere> spheres_about(const std::vector<Eigen::Vector3d>& points, double around,
                                       double smallest_radius, double largest_radius, int count,
                                       std::uint64_t seed);

}  // namespace clearway
