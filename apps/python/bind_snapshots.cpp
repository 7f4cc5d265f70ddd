// Maps to ask: states, slices, rays; loading, saving and combining them.
#include <cmath>
#include <stdexcept>
#include <utility>

#include "apps/inspect/map_folder.hpp"
#include "apps/python/bindings.hpp"
#include "apps/python/named_files.hpp"
#include "apps/python/records.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_difference.hpp"
#include "mapping/maps/map_edit.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/maps/ray_states.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_cells = 500'000'000;

NamedMap load_snapshot(const std::filesystem::path& path, std::optional<double> cloud_resolution) {
  std::error_code error;
  const bool is_folder = std::filesystem::is_directory(path, error);
  return without_lock([&] {
    return read_named(is_folder ? path / "map.ot" : path, [&] {
      LoadedMap loaded = load_map_with(path, {record_beside()}, cloud_resolution);
      NamedMap named{std::exchange(loaded.map, {}), path, loaded.sha256, {}, path};
      named.made_of = std::make_shared<const LoadedMap>(std::move(loaded));
      return named;
    });
  });
}

/// As `inspect --save`: the folder is replaced as a whole, or not at all.
void save_snapshot(const NamedMap& self, const std::filesystem::path& directory) {
  without_lock([&] {
    require_saved_map_place("directory", directory);
    std::optional<QueryRecord> record;
    if (self.made_of) record = record_to_hand_on(*self.made_of, self.made_of_file);
    save_map_folder(directory, self.map, std::move(record));
  });
}

/// A map made of others, of which the first with a record of queries hands it on.
NamedMap made_of(Snapshot map, const NamedMap& first, const NamedMap* second = nullptr) {
  const auto has_record = [](const NamedMap& each) {
    try {
      return each.made_of && record_to_hand_on(*each.made_of, each.made_of_file).has_value();
    } catch (const std::exception&) {
      return true;  // save() says what is wrong with it
    }
  };
  const NamedMap& from = second != nullptr && !has_record(first) ? *second : first;
  return {std::move(map), {}, {}, from.made_of, from.made_of_file};
}

std::uint8_t number(VoxelState state) { return static_cast<std::uint8_t>(state); }

py::array states_at(const NamedMap& self, const std::vector<Eigen::Vector3d>& points) {
  return own(without_lock([&] {
    std::vector<std::uint8_t> states;
    states.reserve(points.size());
    for (const Eigen::Vector3d& point : points) states.push_back(number(self.map.state(point)));
    return states;
  }));
}

/// First cell of a box on one axis, and how many: all that the box overlaps, at least one. A face between two
/// voxels is one, wherever it is rounded to.
std::pair<std::int64_t, std::size_t> cells_along(double low, double high, double resolution) {
  constexpr double rounding = 1e-9;  // voxels
  const double first = std::floor(low / resolution + rounding);
  const double count = std::max(1.0, std::ceil(high / resolution - rounding) - first);
  if (!(std::abs(first) < 1e9) || !(count <= most_cells))
    throw std::invalid_argument("box: expected one within 1e9 voxels");
  return {static_cast<std::int64_t>(first), static_cast<std::size_t>(count)};
}

/// States of all voxels of a box, and the box that they fill.
struct StateGrid {
  std::vector<std::uint8_t> states;
  std::array<std::size_t, 3> shape{};
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
};

StateGrid grid_of(const Snapshot& map, const Eigen::AlignedBox3d& box) {
  std::array<std::int64_t, 3> first{};
  StateGrid grid;
  const double edge = map.resolution();
  for (int axis = 0; axis < 3; ++axis) {
    std::tie(first[axis], grid.shape[axis]) = cells_along(box.min()[axis], box.max()[axis], edge);
    grid.low[axis] = static_cast<double>(first[axis]) * edge;
  }
  const double cells = static_cast<double>(grid.shape[0]) * grid.shape[1] * grid.shape[2];
  if (cells > most_cells)
    throw std::invalid_argument("box: expected at most 500 million voxels, got " + std::to_string(cells));
  grid.states.reserve(static_cast<std::size_t>(cells));
  const auto place = [&](int axis,
                         std::size_t i) {  // a plane asks where it is, a box in the middles of its voxels
    if (box.min()[axis] == box.max()[axis]) return box.min()[axis];
    return (static_cast<double>(first[axis]) + static_cast<double>(i) + 0.5) * edge;
  };
  for (std::size_t x = 0; x < grid.shape[0]; ++x)
    for (std::size_t y = 0; y < grid.shape[1]; ++y)
      for (std::size_t z = 0; z < grid.shape[2]; ++z)
        grid.states.push_back(number(map.state({place(0, x), place(1, y), place(2, z)})));
  return grid;
}

py::ssize_t length(std::size_t count) { return static_cast<py::ssize_t>(count); }

py::tuple states_in(const NamedMap& self, const py::object& box) {
  const Eigen::AlignedBox3d wanted = bounds_or(self.map, box);
  StateGrid grid = without_lock([&] { return grid_of(self.map, wanted); });
  const auto [x, y, z] = grid.shape;
  return py::make_tuple(own(std::move(grid.states), {length(x), length(y), length(z)}), to_array(grid.low));
}

int axis_of(const std::string& name) {
  if (name == "x" || name == "y" || name == "z") return name[0] - 'x';
  throw std::invalid_argument("axis: expected 'x', 'y' or 'z', got '" + name + "'");
}

/// Rows go up, columns right, as matplotlib's imshow(origin="lower") draws them.
py::tuple slice(const NamedMap& self, const std::string& axis_name, double value, const py::object& box) {
  const int axis = axis_of(axis_name);
  if (!std::isfinite(value)) throw std::invalid_argument("value: expected a finite number of metres");
  Eigen::AlignedBox3d wanted = bounds_or(self.map, box);
  wanted.min()[axis] = wanted.max()[axis] = value;
  const StateGrid grid = without_lock([&] { return grid_of(self.map, wanted); });
  const int right = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  const std::size_t columns = grid.shape[right], rows = grid.shape[up];
  std::vector<std::uint8_t> states(rows * columns);
  for (std::size_t row = 0; row < rows; ++row)  // the later axis lies closer together
    for (std::size_t column = 0; column < columns; ++column)
      states[row * columns + column] = grid.states[column * rows + row];
  const double edge = self.map.resolution();
  const auto end = [&](int i) { return grid.low[i] + static_cast<double>(grid.shape[i]) * edge; };
  return py::make_tuple(own(std::move(states), {length(rows), length(columns)}),
                        py::make_tuple(grid.low[right], end(right), grid.low[up], end(up)));
}

struct Leaves {
  std::vector<Eigen::Vector3d> centers;
  std::vector<double> sizes, log_odds;
  std::vector<std::uint8_t> states;
  std::vector<std::uint16_t> volumes;
};

py::dict leaves(const NamedMap& self) {
  Leaves all = without_lock([&] {
    Leaves found;
    self.map.visit_leaves([&](const Voxel& voxel) {
      found.centers.push_back(voxel.center);
      found.sizes.push_back(voxel.size);
      found.log_odds.push_back(voxel.observed ? voxel.log_odds : std::nan(""));
      found.states.push_back(number(voxel.state));
      found.volumes.push_back(voxel.volumes);
    });
    return found;
  });
  py::dict arrays;
  arrays["centers"] = to_array(all.centers);
  arrays["sizes"] = own(std::move(all.sizes));
  arrays["states"] = own(std::move(all.states));
  arrays["log_odds"] = own(std::move(all.log_odds));
  arrays["volumes"] = own(std::move(all.volumes));
  return arrays;
}

/// Whether all that lies between two points, their own voxels included, is free under a policy.
bool is_in_sight(const Snapshot& map, Policy policy, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Requirement requirement{.policy = policy};
  const auto passes = [&](VoxelState state) {
    return allows(requirement, state, state == VoxelState::painted ? 0xffff : 0);
  };
  if (!from.allFinite() || !to.allFinite())
    throw std::invalid_argument("line of sight: expected points that are finite");
  if (!passes(map.state(from)) || !passes(map.state(to))) return false;
  const double distance = (to - from).norm();
  if (!(distance > 0.0)) return true;
  const RayReport ray = ray_states(map, from, to - from);
  if (ray.blocked && ray.distance <= distance) return false;
  for (const RayRun& run : ray.runs)
    if (run.from <= distance && !passes(run.state)) return false;
  return ray.distance >= distance || passes(VoxelState::unknown);
}

py::array lines_of_sight(const NamedMap& self, const py::object& from, const py::object& to,
                         const std::string& policy) {
  const Policy asked = parse_policy(policy);
  const std::vector<Eigen::Vector3d> begins = points_from(from, "from_points"),
                                     ends = points_from(to, "to_points");
  if (begins.size() != ends.size())
    throw std::invalid_argument("to_points: expected as many points as from_points, " +
                                std::to_string(begins.size()) + ", got " + std::to_string(ends.size()));
  return to_array(without_lock([&] {
    std::vector<bool> clear;
    for (std::size_t i = 0; i < begins.size(); ++i)
      clear.push_back(is_in_sight(self.map, asked, begins[i], ends[i]));
    return clear;
  }));
}

py::list runs_of(const RayReport& report) {
  py::list runs;
  for (const RayRun& run : report.runs) runs.append(py::make_tuple(to_python(run.state), run.from, run.to));
  return runs;
}

void bind_answers(py::module_& module) {
  Record<VoxelCounts>(module, "VoxelCounts")
      .field("painted", &VoxelCounts::painted, "Painted voxels.")
      .field("seen_free", &VoxelCounts::seen_free, "Voxels seen free.")
      .field("occupied", &VoxelCounts::occupied, "Occupied voxels.")
      .field("conflict", &VoxelCounts::conflict, "Voxels both painted and occupied.");
  Record<Voxel>(module, "Voxel")
      .field("state", &Voxel::state, "Its VoxelState.")
      .field("volumes", &Voxel::volumes)
      .field("observed", &Voxel::observed)
      .field("log_odds", &Voxel::log_odds)
      .field("center", &Voxel::center, "Of the leaf that answered, metres.")
      .field("size", &Voxel::size);
  Record<Stroke>(module, "Stroke")
      .field("label", &Stroke::label, "As given to begin_stroke.")
      .field("source", &Stroke::source)
      .field("begin", &Stroke::begin)
      .field("end", &Stroke::end);
  Record<PaintedVolume>(module, "PaintedVolume")
      .field("label", &PaintedVolume::label, "Its name.")
      .field("critical_parts", &PaintedVolume::critical_parts)
      .computed(
          "centers",
          [](const PaintedVolume& self) {
            std::vector<Eigen::Vector3d> centers;
            for (const Sphere& sphere : self.spheres) centers.push_back(sphere.center);
            return to_array(centers);
          },
          "Centres of its spheres, (n, 3), metres, in the order painted.")
      .computed(
          "radii",
          [](const PaintedVolume& self) {
            std::vector<double> radii;
            for (const Sphere& sphere : self.spheres) radii.push_back(sphere.radius);
            return own(std::move(radii));
          },
          "Radii of its spheres, (n,), metres.")
      .computed(
          "times", [](const PaintedVolume& self) { return own(std::vector<double>(self.times)); },
          "Seconds, one for each sphere, 0 where unknown.")
      .field("strokes", &PaintedVolume::strokes)
      .def(
          "contains",
          [](const PaintedVolume& self, const py::object& points) {
            std::vector<bool> inside;
            for (const Eigen::Vector3d& point : points_from(points, "points"))
              inside.push_back(self.contains(point));
            return to_array(inside);
          },
          py::arg("points"), doc("PaintedVolume::contains", "Of each point of an (n, 3) array."));
  Record<RayReport>(module, "RayReport")
      .computed("runs", &runs_of, "(state, from, to) of each stretch, metres from the origin, without gaps.")
      .computed(
          "blocked",
          [](const RayReport& self) { return self.blocked ? py::cast(*self.blocked) : py::none(); },
          "The first blocked voxel, or None.")
      .field("distance", &RayReport::distance);
}

std::string describe_snapshot(const NamedMap& self) {
  const VoxelCounts counts = self.map.counts();
  return "Snapshot(resolution=" + py::repr(py::float_(self.map.resolution())).cast<std::string>() +
         ", painted=" + std::to_string(counts.painted) + ", seen_free=" + std::to_string(counts.seen_free) +
         ", occupied=" + std::to_string(counts.occupied) + ", conflict=" + std::to_string(counts.conflict) +
         ")";
}

py::object bounds(const NamedMap& self) {
  if (self.map.bounds().isEmpty()) return py::none();
  return to_array(self.map.bounds());
}

py::dict differences(const NamedMap& self, const NamedMap& other) {
  const MapDifference found = without_lock([&] { return difference(self.map, other.map); });
  py::dict states, all;
  for (const auto& [pair, count] : found.states)
    states[py::make_tuple(to_python(pair.first), to_python(pair.second))] = count;
  all["resolution"] = found.resolution;
  all["threshold"] = found.threshold;
  all["volumes"] = found.volumes;
  all["states"] = states;
  all["evidence"] = found.evidence;
  return all;
}

void bind_files(py::class_<NamedMap>& snapshot) {
  snapshot.def("save", &save_snapshot, py::arg("directory"), doc("save_map_folder"))
      .def(
          "export",
          [](const NamedMap& self, const std::filesystem::path& file) {
            without_lock([&] { export_map(self.map, file); });
          },
          py::arg("file"), doc("export_map"))
      .def(
          "merge",
          [](const NamedMap& self, const NamedMap& other) {
            return without_lock([&] { return made_of(merge(self.map, other.map), self, &other); });
          },
          py::arg("other"), doc("merge"))
      .def(
          "crop",
          [](const NamedMap& self, const py::object& box) {
            const Eigen::AlignedBox3d wanted = box_from(box, "box");
            return without_lock([&] { return made_of(crop(self.map, wanted), self); });
          },
          py::arg("box"), doc("crop", "The box is (low, high), two points."))
      .def(
          "coarsen",
          [](const NamedMap& self, double resolution) {
            return without_lock([&] { return made_of(coarsen(self.map, resolution), self); });
          },
          py::arg("resolution"), doc("coarsen"))
      .def("difference", &differences, py::arg("other"), doc("Snapshot::difference"));
}

void bind_questions(py::class_<NamedMap>& snapshot) {
  snapshot
      .def(
          "state",
          [](const NamedMap& self, const py::object& point) {
            return to_python(self.map.state(point_from(point, "point")));
          },
          py::arg("point"), "State of the voxel at a point; unknown for one that is not finite or far away.")
      .def(
          "states",
          [](const NamedMap& self, const py::object& points) {
            return states_at(self, points_from(points, "points"));
          },
          py::arg("points"),
          "States at each point of an (n, 3) array, as numbers of VoxelState in an array of bytes.")
      .def(
          "voxel",
          [](const NamedMap& self, const py::object& point) {
            return self.map.voxel(point_from(point, "point"));
          },
          py::arg("point"), doc("Voxel", "Unknown for a point that is not finite or far away."))
      .def(
          "last_seen",
          [](const NamedMap& self, const py::object& point) {
            return self.map.last_seen(point_from(point, "point"));
          },
          py::arg("point"), doc("Snapshot::last_seen"))
      .def("states_in", &states_in, py::arg("box") = py::none(), doc("Snapshot::states_in"))
      .def("slice", &slice, py::arg("axis"), py::arg("value"), py::arg("box") = py::none(),
           doc("Snapshot::slice"))
      .def("leaves", &leaves, doc("Snapshot::leaves"))
      .def(
          "ray",
          [](const NamedMap& self, const py::object& origin, const py::object& direction) {
            return ray_states(self.map, point_from(origin, "origin"), point_from(direction, "direction"));
          },
          py::arg("origin"), py::arg("direction"), doc("ray_states"))
      .def(
          "line_of_sight",
          [](const NamedMap& self, const py::object& from, const py::object& to, const std::string& policy) {
            return is_in_sight(self.map, parse_policy(policy), point_from(from, "from_point"),
                               point_from(to, "to_point"));
          },
          py::arg("from_point"), py::arg("to_point"), py::arg("policy") = "known_free",
          doc("Snapshot::line_of_sight"))
      .def("lines_of_sight", &lines_of_sight, py::arg("from_points"), py::arg("to_points"),
           py::arg("policy") = "known_free", "The same of many lines, (n, 3) each.");
}

}  // namespace

Eigen::AlignedBox3d bounds_or(const Snapshot& map, const py::object& box) {
  if (!box.is_none()) return box_from(box, "box");
  if (map.bounds().isEmpty()) throw std::invalid_argument("box: expected one, because the map is empty");
  return map.bounds();
}

void bind_snapshots(py::module_& module) {
  bind_answers(module);
  py::class_<NamedMap> snapshot(module, "Snapshot", doc("Snapshot"));
  snapshot
      .def_property_readonly(
          "resolution", [](const NamedMap& self) { return self.map.resolution(); },
          "Edge of a voxel, metres.")
      .def_property_readonly(
          "volumes", [](const NamedMap& self) { return self.map.volumes(); }, doc("Snapshot::volumes"))
      .def_property_readonly(
          "bounds", &bounds,
          "The box of all stored leaves, (2, 3): low and high, metres; None for an empty map.")
      .def_property_readonly(
          "integration", [](const NamedMap& self) { return to_string(integration_of(self.map)); },
          doc("MapIntegration"))
      .def_property_readonly(
          "caveat", [](const NamedMap& self) { return map_caveat(self.map); }, doc("map_caveat"))
      .def(
          "counts", [](const NamedMap& self) { return without_lock([&] { return self.map.counts(); }); },
          doc("VoxelCounts"))
      .def("__repr__", &describe_snapshot, "Resolution and counts of voxels.");
  bind_files(snapshot);
  bind_questions(snapshot);
  module.def("load_map", &load_snapshot, py::arg("path"), py::arg("cloud_resolution") = py::none(),
             doc("load_map"));
  module.def("save_map", &save_snapshot, py::arg("map"), py::arg("directory"), doc("save_map_folder"));
}

}  // namespace clearway
