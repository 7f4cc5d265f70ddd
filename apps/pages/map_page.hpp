#pragma once

#include <optional>
#include <string>

#include "apps/pages/report_page.hpp"
#include "mapping/files/map_leaves.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A page that shows `map`: its voxels by state and its exact spheres. States with more surface than a viewer
/// can draw are shown in larger voxels: painted and seen free where all of one is, occupied and conflict
/// where any is; see PageVoxels::cells. @param is_whole its first view and colours reach to the farthest
/// voxel, else as far as MapLeaves::main_bounds
ReportPage page_of_map(const MapLeaves& map, const std::string& title, bool is_whole = false);

/// The first view of the page stands beside `from`, so that no wall hides what can be seen from there: where
/// sensors stood, or the robot. Left as it is where `from` is amid the occupied voxels. Metres, map frame.
void look_from(ReportPage& page, const Snapshot& map, const Eigen::Vector3d& from);

/// The robot's bodies, and where they are at `home`.
void show_robot(ReportPage& page, const Robot& robot, const Configuration& home);

/// A shape without its place, link and part.
PageShape page_shape(const Shape& shape);

/// A plan as the page animates it: in time, as show_motion has it, with clearances from `space` (none with
/// loads, which it does not know). A load rests where it is taken and put down. A path that
/// cannot be given time has waypoints at most 3 degrees (or 20 mm) apart, of more than 600 an even choice. A
/// plan without a path shows what was explored, and its start and goal.
PagePlan page_of_plan(const Plan& plan, const ConfigurationSpace& space, const Configuration& start,
                      const std::string& name);

/// The page of `inspect --diff --view`, of MapLeaves::difference.
std::string difference_page(const MapLeaves& difference, const std::string& name);

/// The page of `inspect --view`. @param place where the map is, for `clearway inspect`; none: in no file
std::string map_page(const MapLeaves& map, const std::string& name,
                     const std::optional<std::string>& place = {}, bool is_whole = false);

}  // namespace clearway
