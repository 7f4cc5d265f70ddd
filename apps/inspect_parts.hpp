#pragma once

#include <Eigen/Core>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "apps/commands.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {

// What `inspect` says, one file a question: `describe_…` finds it out as JSON, `print_…` says it as text.
// Lengths are metres in the map frame.

/// The map as a whole: where it is from, voxels by state, bounds, painted volumes.
nlohmann::ordered_json describe_map(const InspectOptions& options, const Snapshot& map);
void print_map(const nlohmann::ordered_json& json, std::ostream& out);

/// The state of one voxel, why, and how far the nearest blocked voxels are.
nlohmann::ordered_json describe_point(const Snapshot& map, const Eigen::Vector3d& point);
void print_point(const nlohmann::ordered_json& json, std::ostream& out);

/// Quality of each painted volume: exact volume and area, what the voxels lose, sample spacing, holes, necks.
nlohmann::ordered_json describe_volumes(const Snapshot& map);
void print_volumes(const nlohmann::ordered_json& json, std::ostream& out);

/// A point or direction as [x, y, z].
nlohmann::ordered_json to_json(const Eigen::Vector3d& v);

/// "x, y, z" of a point written by to_json.
std::string point_text(const nlohmann::ordered_json& point);

/// Names as "a, b", or "-".
std::string join(const nlohmann::ordered_json& names);

/// A length as "12.34 mm".
std::string millimetres(const nlohmann::ordered_json& metres);

}  // namespace clearway
