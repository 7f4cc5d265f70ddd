#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "mapping/snapshot.hpp"
#include "planning/files/query_record.hpp"
#include "planning/geometry/shape.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot/robot.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A snapshot, and where it was loaded from: what a plan's file says of its map.
struct NamedMap {
  Snapshot map;
  std::filesystem::path file{};  ///< empty: of no file
  std::string digest{};          ///< map_sha256 of that file
  /// The map that it was loaded from, or made of, with its record of queries and without its voxels.
  std::shared_ptr<const LoadedMap> made_of{};
  std::filesystem::path made_of_file{};  ///< of that
};

/// A robot, and the name or path that it was asked for by.
struct NamedRobot {
  Robot robot;
  std::string asked{};
  std::map<std::string, std::filesystem::path> packages{};
};

/// A space, with where its map and robot are from.
struct NamedSpace {
  std::shared_ptr<const ConfigurationSpace> space;
  std::filesystem::path map_file{};
  std::string map_digest{}, asked{};
  std::map<std::string, std::filesystem::path> packages{};  ///< of the robot

  const ConfigurationSpace& operator*() const { return *space; }
  const ConfigurationSpace* operator->() const { return space.get(); }
};

// Each adds what its file is about to the module.
void bind_maps(pybind11::module_& module);
void bind_snapshots(pybind11::module_& module);
void bind_blocked_space(pybind11::module_& module);
void bind_robots(pybind11::module_& module);
void bind_spaces(pybind11::module_& module);
void bind_loads(pybind11::module_& module);
void bind_plans(pybind11::module_& module);
void bind_plan_check(pybind11::module_& module);
void bind_motion_records(pybind11::module_& module);  ///< before the functions that name them
void bind_motions(pybind11::module_& module);
void bind_teams(pybind11::module_& module);

/// A box, or where it is None the map's bounds. @throws std::invalid_argument for an empty map
Eigen::AlignedBox3d bounds_or(const Snapshot& map, const pybind11::object& box);

/// A configuration of the robot: an array, or the name of a state of its SRDF.
Configuration configuration_from(pybind11::handle value, const std::string& name, const Robot& robot);
/// One or several.
std::vector<Configuration> configurations_from(pybind11::handle value, const std::string& name,
                                               const Robot& robot);

/// The one shape that is given; the others are None.
Shape shape_from(const pybind11::object& box, const pybind11::object& sphere,
                 const pybind11::object& cylinder, const pybind11::object& capsule,
                 const pybind11::object& vertices);

/// A planner's options, from keywords, in their text form.
PlannerOptions options_from(const pybind11::dict& keywords);

/// A dictionary of policies by the names of loads.
std::map<std::string, Policy> policies_of_loads(const pybind11::dict& policies);

}  // namespace clearway
