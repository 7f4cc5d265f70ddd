// Maps to write: painting, scans, going on with a map that was loaded.
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "apps/python/bindings.hpp"
#include "apps/python/records.hpp"
#include "mapping/continued_map.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/history/paint_log.hpp"
#include "mapping/stamps/seen_stamps.hpp"

namespace clearway {
namespace {

/// A map that one thread writes at a time, whatever Python's threads do while the interpreter's lock is let
/// go.
struct GuardedMap {
  explicit GuardedMap(const MapOptions& options) : map(options) {}

  FreeSpaceMap map;
  mutable std::mutex writing;

  template <typename Work>
  auto alone(const Work& work) {
    const py::gil_scoped_release released;
    const std::lock_guard lock(writing);
    return work();
  }
};

struct GuardedContinuedMap {
  GuardedContinuedMap(const Snapshot& start, const MapOptions& options) : map(start, options) {}

  ContinuedMap map;
  std::mutex writing;
};

Integration integration_from(const std::string& word) {
  if (word == "safe") return Integration::safe;
  if (word == "compatible") return Integration::compatible;
  throw std::invalid_argument("integration: expected 'safe' or 'compatible', got '" + word + "'");
}

/// Rows of ax, ay, az, bx, by, bz, radius.
std::vector<Capsule> capsules_from(const py::object& value) {
  std::vector<Capsule> capsules;
  if (value.is_none()) return capsules;
  for (const Eigen::VectorXd& row : vectors_from(value, "bodies", 7)) {
    if (!row.allFinite() || !(row[6] >= 0.0))
      throw std::invalid_argument("bodies: expected finite capsules of a radius that is not negative");
    capsules.push_back({row.head<3>(), row.segment<3>(3), row[6]});
  }
  return capsules;
}

/// One that the map keeps: what it took for a scan without a time would make things look unseen.
double time_from(const std::optional<double>& time) {
  if (!time) return std::numeric_limits<double>::quiet_NaN();
  if (std::isfinite(*time) && std::abs(*time) <= SeenStamps::latest_time) return *time;
  throw std::invalid_argument("time: expected a finite number of seconds, at most 1e12 from 0, got " +
                              py::str(py::float_(*time)).cast<std::string>() +
                              (std::isfinite(*time) ? " (are these nanoseconds?)" : ""));
}

Scan scan_from(const py::object& points, const py::object& map_from_sensor, const std::optional<double>& time,
               const std::string& sensor) {
  Scan scan;
  scan.points = cloud_from(points, "points");
  if (!map_from_sensor.is_none()) scan.map_from_sensor = pose_from(map_from_sensor, "map_from_sensor");
  scan.time = time_from(time);
  scan.sensor = sensor;
  return scan;
}

ScanFilter filter_from(double min_range, double max_range, double thin_to, int outlier_neighbours,
                       double outlier_deviations, const py::object& crop, const py::object& bodies) {
  ScanFilter filter{.min_range = min_range,
                    .max_range = max_range,
                    .thin_to = thin_to,
                    .outlier_neighbours = outlier_neighbours,
                    .outlier_deviations = outlier_deviations};
  for (const auto& [name, value] :
       {std::pair{"min_range", min_range}, {"max_range", max_range}, {"thin_to", thin_to}})
    if (!std::isfinite(value) || value < 0.0)
      throw std::invalid_argument(std::string(name) +
                                  ": expected a finite number of metres, not negative, got " +
                                  py::str(py::float_(value)).cast<std::string>());
  if (outlier_neighbours < 0 || !(outlier_deviations >= 0.0))
    throw std::invalid_argument(
        "outlier_neighbours, outlier_deviations: expected numbers that are not negative");
  if (!crop.is_none()) filter.crop = box_from(crop, "crop");
  filter.bodies = capsules_from(bodies);
  return filter;
}

/// `insert` of both kinds of maps.
template <typename Map>
void bind_insert(py::class_<Map>& type) {
  const ScanFilter filter;
  type.def(
      "insert",
      [](Map& self, const py::object& points, const py::object& map_from_sensor,
         const std::optional<double>& time, const std::string& sensor, double min_range, double max_range,
         double thin_to, int outlier_neighbours, double outlier_deviations, const py::object& crop,
         const py::object& bodies, const py::object& clear_to) {
        Scan scan = scan_from(points, map_from_sensor, time, sensor);
        if (!clear_to.is_none()) scan.clear_to = cloud_from(clear_to, "clear_to");
        const ScanFilter wanted =
            filter_from(min_range, max_range, thin_to, outlier_neighbours, outlier_deviations, crop, bodies);
        const py::gil_scoped_release released;
        const std::lock_guard lock(self.writing);
        return self.map.insert(scan, wanted);
      },
      py::arg("points"), py::arg("map_from_sensor") = py::none(), py::kw_only(), py::arg("time") = py::none(),
      py::arg("sensor") = "", py::arg("min_range") = filter.min_range,
      py::arg("max_range") = filter.max_range, py::arg("thin_to") = filter.thin_to,
      py::arg("outlier_neighbours") = filter.outlier_neighbours,
      py::arg("outlier_deviations") = filter.outlier_deviations, py::arg("crop") = py::none(),
      py::arg("bodies") = py::none(), py::arg("clear_to") = py::none(),
      doc("FreeSpaceMap::insert", doc("insert()")));
}

void read_options(MapOptions& options, const std::string& integration, const py::dict& margins) {
  options.integration = integration_from(integration);
  const std::map<std::string, double*> known = {{"band", &options.margins.band},
                                                {"sigmas", &options.margins.sigmas},
                                                {"noise_constant", &options.margins.noise_constant},
                                                {"noise_quadratic", &options.margins.noise_quadratic},
                                                {"noise_limit", &options.margins.noise_limit},
                                                {"most_called_free", &options.margins.most_called_free}};
  for (const auto& [key, value] : margins) {
    const auto name = py::str(key).cast<std::string>();
    const auto found = known.find(name);
    if (found == known.end()) {
      std::string names;
      for (const auto& [word, place] : known) names += (names.empty() ? "" : ", ") + word;
      throw std::invalid_argument("margins: there is no '" + name + "', expected " + names);
    }
    *found->second = numbers_from(value, "margins['" + name + "']", 1).front();
  }
}

/// Total counts of many spheres.
PaintCounts paint(GuardedMap& self, int volume, const py::object& center, const py::object& radius,
                  const py::object& time) {
  std::vector<Eigen::Vector3d> centers;
  if (dimensions_of(center, "center") == 1)
    centers = {point_from(center, "center")};
  else
    centers = points_from(center, "center");
  const std::vector<double> radii = numbers_from(radius, "radius", centers.size());
  const std::vector<double> times = numbers_from(time, "time", centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i)  // all or nothing
    if (!centers[i].allFinite() || !std::isfinite(radii[i]) || !(radii[i] > 0.0) || !std::isfinite(times[i]))
      throw std::invalid_argument("sphere " + std::to_string(i) +
                                  ": expected a finite center and time and a finite radius above 0, metres");
  return self.alone([&] {
    for (std::size_t i = 0; i < centers.size(); ++i)
      require_paintable({centers[i], radii[i]}, times[i], self.map.options().resolution);
    PaintCounts total;
    for (std::size_t i = 0; i < centers.size(); ++i) {
      const PaintCounts counts = self.map.paint(volume, {centers[i], radii[i]}, times[i]);
      total.painted += counts.painted;
      total.newly += counts.newly;
      total.conflicts += counts.conflicts;
    }
    return total;
  });
}

void bind_counts(py::module_& module) {
  Record<PaintCounts>(module, "PaintCounts")
      .field("painted", &PaintCounts::painted)
      .field("newly", &PaintCounts::newly)
      .field("conflicts", &PaintCounts::conflicts);
  Record<EraseCounts>(module, "EraseCounts")
      .field("shrunk", &EraseCounts::shrunk)
      .field("removed", &EraseCounts::removed)
      .field("unpainted", &EraseCounts::unpainted);
  Record<ScanCounts>(module, "ScanCounts")
      .field("inserted", &ScanCounts::inserted, "Points whose voxels were hit.")
      .field("beyond_range", &ScanCounts::beyond_range)
      .field("dropped_invalid", &ScanCounts::dropped_invalid)
      .field("dropped_filter", &ScanCounts::dropped_filter)
      .field("cleared", &ScanCounts::cleared)
      .field("origin_invalid", &ScanCounts::origin_invalid);
}

void bind_painting(py::class_<GuardedMap>& type) {
  type.def(
          "add_volume",
          [](GuardedMap& self, const std::string& label, const std::vector<std::string>& critical_parts) {
            return self.alone([&] { return self.map.add_volume(label, critical_parts); });
          },
          py::arg("label"), py::arg("critical_parts") = std::vector<std::string>{},
          doc("FreeSpaceMap::add_volume"))
      .def("paint", &paint, py::arg("volume"), py::arg("center"), py::arg("radius"), py::arg("time") = 0.0,
           doc("FreeSpaceMap::paint",
               "center: a point, or (n, 3) for many spheres: then radius and time are one number each, or n, "
               "and the counts are sums. Metres, seconds. Nothing is painted where one sphere is refused."))
      .def(
          "erase",
          [](GuardedMap& self, int volume, const py::object& center, double radius, double time) {
            const Sphere eraser{point_from(center, "center"), radius};
            return self.alone([&] { return self.map.erase(volume, eraser, time); });
          },
          py::arg("volume"), py::arg("center"), py::arg("radius"), py::arg("time") = 0.0,
          doc("FreeSpaceMap::erase", "center, radius: of the eraser, metres. time: seconds."))
      .def(
          "begin_stroke",
          [](GuardedMap& self, const std::string& label, const std::string& source) {
            return self.alone([&] { return self.map.begin_stroke(label, source); });
          },
          py::arg("label"), py::arg("source") = "", doc("FreeSpaceMap::begin_stroke"))
      .def(
          "end_stroke", [](GuardedMap& self) { self.alone([&] { self.map.end_stroke(); }); },
          "Ends the stroke that begin_stroke() started.")
      .def(
          "undo_stroke",
          [](GuardedMap& self, const std::optional<int>& stroke) {
            return self.alone(
                [&] { return stroke ? self.map.undo_stroke(*stroke) : self.map.undo_stroke(); });
          },
          py::arg("stroke") = py::none(), doc("FreeSpaceMap::undo_stroke"));
}

std::string describe_map(GuardedMap& self) {
  const auto [resolution, volumes] = self.alone([&] {
    return std::pair{self.map.options().resolution, self.map.volumes().size()};
  });
  return "FreeSpaceMap(resolution=" + py::repr(py::float_(resolution)).cast<std::string>() +
         ", volumes=" + std::to_string(volumes) + ")";
}

void bind_free_space_map(py::module_& module) {
  const MapOptions usual;
  py::class_<GuardedMap> type(module, "FreeSpaceMap", doc("FreeSpaceMap"));
  type.def(py::init([](double resolution, const std::string& integration, const py::dict& margins,
                       double hit_probability, double miss_probability, double min_probability,
                       double max_probability, double occupied_probability, bool discretize, int threads) {
             MapOptions options{resolution,      hit_probability,      miss_probability, min_probability,
                                max_probability, occupied_probability, discretize,       threads};
             read_options(options, integration, margins);
             return std::make_unique<GuardedMap>(options);
           }),
           py::arg("resolution") = usual.resolution, py::kw_only(), py::arg("integration") = "safe",
           py::arg("margins") = py::dict(), py::arg("hit_probability") = usual.hit_probability,
           py::arg("miss_probability") = usual.miss_probability,
           py::arg("min_probability") = usual.min_probability,
           py::arg("max_probability") = usual.max_probability,
           py::arg("occupied_probability") = usual.occupied_probability,
           py::arg("discretize") = usual.discretize, py::arg("threads") = usual.threads,
           doc("MapOptions", doc("FreeSpaceMap()")))
      .def_property_readonly(
          "resolution", [](const GuardedMap& self) { return self.map.options().resolution; },
          doc("MapOptions::resolution"))
      .def(
          "snapshot",
          [](GuardedMap& self) { return self.alone([&] { return NamedMap{self.map.snapshot()}; }); },
          doc("FreeSpaceMap::snapshot"))
      .def("__repr__", &describe_map, "Resolution and count of painted volumes.");
  bind_painting(type);
  bind_insert(type);
}

void bind_continued_map(py::module_& module) {
  const MapOptions usual;
  py::class_<GuardedContinuedMap> type(module, "ContinuedMap", doc("ContinuedMap"));
  type.def(py::init([](const NamedMap& start, const std::string& integration, const py::dict& margins,
                       double hit_probability, double miss_probability, bool discretize, int threads) {
             MapOptions options;
             options.hit_probability = hit_probability;
             options.miss_probability = miss_probability;
             options.discretize = discretize;
             options.threads = threads;
             read_options(options, integration, margins);
             return std::make_unique<GuardedContinuedMap>(start.map, options);
           }),
           py::arg("start"), py::kw_only(), py::arg("integration") = "safe", py::arg("margins") = py::dict(),
           py::arg("hit_probability") = usual.hit_probability,
           py::arg("miss_probability") = usual.miss_probability, py::arg("discretize") = usual.discretize,
           py::arg("threads") = usual.threads, doc("ContinuedMap()"))
      .def(
          "snapshot",
          [](GuardedContinuedMap& self) {
            const py::gil_scoped_release released;
            const std::lock_guard lock(self.writing);
            return NamedMap{self.map.snapshot()};
          },
          doc("ContinuedMap::snapshot"))
      .def(
          "__repr__", [](const GuardedContinuedMap&) { return "ContinuedMap()"; }, "Its kind.");
  bind_insert(type);
}

}  // namespace

void bind_maps(py::module_& module) {
  bind_counts(module);
  bind_free_space_map(module);
  bind_continued_map(module);
}

}  // namespace clearway
