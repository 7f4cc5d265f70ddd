// Which voxels of a map are blocked under a policy, and how far they are.
#include <limits>
#include <stdexcept>

#include "apps/python/bindings.hpp"
#include "apps/python/records.hpp"
#include "mapping/field/blocked_space.hpp"

namespace clearway {
namespace {

/// Painted volumes by their labels as the bits of a mask.
std::uint16_t mask_of(const Snapshot& map, const std::optional<std::vector<std::string>>& labels) {
  if (!labels) return 0xffff;
  std::uint16_t mask = 0;
  for (const std::string& label : *labels) {
    std::size_t v = 0;
    while (v < map.volumes().size() && map.volumes()[v].label != label) ++v;
    if (v == map.volumes().size())
      throw std::invalid_argument("volumes: the map has no painted volume '" + label + "'");
    mask = static_cast<std::uint16_t>(mask | (1U << v));
  }
  return mask;
}

/// Keeps the blocked space alive as long as Python asks it.
struct SharedSpace {
  std::shared_ptr<const BlockedSpace> space;
};

SharedSpace blocked_space(const NamedMap& self, const std::string& policy, const py::object& region,
                          double max_distance, const std::optional<std::vector<std::string>>& volumes,
                          double seen_within) {
  const Requirement requirement{parse_policy(policy), mask_of(self.map, volumes), seen_within};
  const Eigen::AlignedBox3d box = region.is_none() ? bounds_or(self.map, region) : box_from(region, "region");
  return without_lock([&] { return SharedSpace{self.map.blocked_space(requirement, box, max_distance)}; });
}

py::array clearances(const SharedSpace& self, const py::object& points) {
  const std::vector<Eigen::Vector3d> asked = points_from(points, "points");
  return own(without_lock([&] {
    std::array<std::vector<double>, 3> axes;
    for (const Eigen::Vector3d& point : asked)
      for (int axis = 0; axis < 3; ++axis) axes[static_cast<std::size_t>(axis)].push_back(point[axis]);
    std::vector<double> distances(asked.size());
    self.space->clearances({axes[0], axes[1], axes[2]}, distances);
    return distances;
  }));
}

py::array are_blocked(const SharedSpace& self, const py::object& points) {
  const std::vector<Eigen::Vector3d> asked = points_from(points, "points");
  return to_array(without_lock([&] {
    std::vector<bool> blocked;
    for (const Eigen::Vector3d& point : asked) blocked.push_back(self.space->is_blocked(point));
    return blocked;
  }));
}

/// Distance to the first blocked voxel's centre along each ray, infinity where there is none.
py::array cast_rays(const SharedSpace& self, const py::object& origins, const py::object& directions,
                    double max_range) {
  const std::vector<Eigen::Vector3d> from = points_from(origins, "origins"),
                                     along = points_from(directions, "directions");
  if (from.size() != along.size())
    throw std::invalid_argument("directions: expected as many as origins, " + std::to_string(from.size()) +
                                ", got " + std::to_string(along.size()));
  return own(without_lock([&] {
    std::vector<double> distances;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const RayHit hit = self.space->cast_ray(from[i], along[i], max_range);
      distances.push_back(hit.hit ? hit.distance : std::numeric_limits<double>::infinity());
    }
    return distances;
  }));
}

}  // namespace

void bind_blocked_space(py::module_& module) {
  Record<NearestBlocked>(module, "NearestBlocked")
      .field("distance", &NearestBlocked::distance)
      .field("point", &NearestBlocked::point)
      .field("direction", &NearestBlocked::direction)
      .field("voxel", &NearestBlocked::voxel)
      .field("found", &NearestBlocked::found);
  Record<RayHit>(module, "RayHit")
      .field("hit", &RayHit::hit, "Whether a blocked voxel was met.")
      .field("voxel", &RayHit::voxel)
      .field("distance", &RayHit::distance);
  py::class_<SharedSpace>(module, "BlockedSpace", doc("BlockedSpace"))
      .def_property_readonly(
          "resolution", [](const SharedSpace& self) { return self.space->resolution(); },
          doc("BlockedSpace::resolution"))
      .def_property_readonly(
          "max_distance", [](const SharedSpace& self) { return self.space->max_distance(); },
          doc("BlockedSpace::max_distance"))
      .def_property_readonly(
          "region", [](const SharedSpace& self) { return to_array(self.space->region()); },
          "The box that is looked at, snapped outwards to cubes of voxels: (2, 3), low and high, metres.")
      .def_property_readonly(
          "blocked_count", [](const SharedSpace& self) { return self.space->blocked_count(); },
          doc("BlockedSpace::blocked_count"))
      .def_property_readonly(
          "policy", [](const SharedSpace& self) { return to_python(self.space->requirement().policy); },
          "Under which a voxel is blocked.")
      .def(
          "is_blocked",
          [](const SharedSpace& self, const py::object& point) {
            return self.space->is_blocked(point_from(point, "point"));
          },
          py::arg("point"), "Whether the voxel of a point is blocked; a point that is not finite is.")
      .def("are_blocked", &are_blocked, py::arg("points"), "The same of each point of an (n, 3) array.")
      .def(
          "clearance",
          [](const SharedSpace& self, const py::object& point) {
            return self.space->clearance(point_from(point, "point"));
          },
          py::arg("point"), doc("BlockedSpace::clearance"))
      .def("clearances", &clearances, py::arg("points"),
           "clearance() of each point of an (n, 3) array, (n,), bit for bit the same.")
      .def(
          "nearest",
          [](const SharedSpace& self, const py::object& point, double limit) {
            return self.space->nearest(point_from(point, "point"), limit);
          },
          py::arg("point"), py::arg("limit"), doc("BlockedSpace::nearest"))
      .def(
          "cast_ray",
          [](const SharedSpace& self, const py::object& origin, const py::object& direction,
             double max_range) {
            return self.space->cast_ray(point_from(origin, "origin"), point_from(direction, "direction"),
                                        max_range);
          },
          py::arg("origin"), py::arg("direction"), py::arg("max_range") = 0.0, doc("BlockedSpace::cast_ray"))
      .def("cast_rays", &cast_rays, py::arg("origins"), py::arg("directions"), py::arg("max_range") = 0.0,
           "Distances of cast_ray() for many rays, (n, 3) each, as (n,); infinity where nothing is hit.")
      .def(
          "__repr__",
          [](const SharedSpace& self) {
            return "BlockedSpace(policy='" + std::string(to_string(self.space->requirement().policy)) +
                   "', blocked_count=" + std::to_string(self.space->blocked_count()) + ")";
          },
          "Policy and count of blocked voxels.");
  py::class_<NamedMap>(module.attr("Snapshot"))
      .def("blocked_space", &blocked_space, py::arg("policy") = "not_occupied",
           py::arg("region") = py::none(), py::arg("max_distance") = 0.5, py::kw_only(),
           py::arg("volumes") = py::none(), py::arg("seen_within") = 0.0,
           doc("Snapshot::blocked_space", doc("blocked_space()")));
}

}  // namespace clearway
