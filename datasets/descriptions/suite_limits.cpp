#include "datasets/descriptions/suite_limits.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <numbers>
#include <sstream>

#include "datasets/yaml/yaml_fields.hpp"

namespace clearway {
namespace {

constexpr double budget = 1e9;  ///< bytes
constexpr double bytes_of_point = 40, bytes_of_ray = 60, bytes_of_painted = 60;
constexpr double most_runs = 1e6, most_steps = 2e5;

std::string text(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << value;
  return out.str();
}

double area(const BoxShape& box) {
  const Eigen::Vector3d& s = box.size;
  return 2 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x());
}
double area(const CylinderShape& cylinder) {
  return 2 * std::numbers::pi * cylinder.radius * (cylinder.length + cylinder.radius);
}
double area(const SphereShape& sphere) { return 4 * std::numbers::pi * sphere.radius * sphere.radius; }

Eigen::Array3d box_about(const BoxShape& box) { return box.size; }
Eigen::Array3d box_about(const CylinderShape& cylinder) {
  return {2 * cylinder.radius, 2 * cylinder.radius, cylinder.length};
}
Eigen::Array3d box_about(const SphereShape& sphere) { return Eigen::Array3d::Constant(2 * sphere.radius); }

/// All voxels that solids meet are listed.
void require_cells(const YamlFields& fields, const SuiteWorld& world) {
  constexpr double most = budget / bytes_of_point;
  double voxels = 0;
  for (const SceneShape& solid : world.solids) {
    const auto box = std::visit([](const auto& shape) { return box_about(shape); }, solid.geometry);
    voxels += (box / world.resolution + 2.0).prod();
    if (voxels > most)
      fields.fail("solids", "expected at most " + text(most) + " voxels of " + text(world.resolution) +
                                " m in an exact world, got " + text(voxels) + " up to '" + solid.name +
                                "'; make the solids smaller or the resolution coarser");
  }
}

/// Rays end on solids half a voxel apart.
void require_solids(const YamlFields& fields, const SuiteWorld& world) {
  constexpr double most = budget / bytes_of_point;
  const double spacing = world.resolution / 2;
  double points = 0;
  const auto entries = fields.list_of_maps("solids");
  for (size_t i = 0; i < world.solids.size(); ++i) {
    points += std::visit([](const auto& shape) { return area(shape); }, world.solids[i].geometry) /
              (spacing * spacing);
    if (points <= most) continue;
    const auto* key = entries[i].has("box") ? "box" : entries[i].has("sphere") ? "sphere" : "cylinder";
    entries[i].fail(key, "expected solids with at most " + text(most) + " points half a voxel (" +
                             text(spacing) + " m) apart on them, got " + text(points) +
                             "; make them smaller or the world's resolution coarser");
  }
}

/// What moves and is sensed is scanned as solids are.
void require_sensed(const YamlFields& fields, const SuiteTeams& all, double spacing) {
  constexpr double most = budget / bytes_of_point;
  for (const SuiteTeam& team : all.teams)
    for (const SuiteMoving& moving : team.moving) {
      const double points = std::visit([](const auto& shape) { return area(shape); }, moving.shape.geometry) /
                            (spacing * spacing);
      if (moving.is_sensed && points > most)
        fields.fail("teams", "expected '" + moving.shape.name + "' to have at most " + text(most) +
                                 " points half a voxel (" + text(spacing) + " m) apart on it, got " +
                                 text(points));
    }
}

/// Rays at the range's end are a voxel apart, to the faces of a cube.
void require_range(const YamlFields& fields, const std::string& key, double range, double resolution) {
  const double most = std::sqrt(budget / bytes_of_ray / 24);
  if (range / resolution <= most) return;
  fields.fail(key, "expected at most " + text(std::floor(most)) + " voxels of " + text(resolution) +
                       " m, that is " + text(std::floor(most) * resolution) + " m, got " + text(range) +
                       "; shorten it or make the resolution coarser");
}

/// Octrees hold the surface of what is painted; spheres that overlap share the box about all of them.
void require_paint(const YamlFields& fields, const SuiteWorld& world) {
  constexpr double most = budget / bytes_of_painted;
  const double voxel = world.resolution;
  double voxels = 0;
  const auto entries = fields.list_of_maps("volumes");
  for (size_t i = 0; i < world.volumes.size(); ++i) {
    double surfaces = 0;
    Eigen::AlignedBox3d box;
    for (const auto& stroke : world.volumes[i].strokes)
      for (const SuiteSphere& sphere : stroke) {
        surfaces += 4 * std::numbers::pi * std::pow(sphere.radius / voxel, 2);
        box.extend(Eigen::Vector3d(sphere.center.array() - sphere.radius));
        box.extend(Eigen::Vector3d(sphere.center.array() + sphere.radius));
      }
    voxels += std::min(surfaces, box.volume() / std::pow(voxel, 3));
    if (voxels > most)
      entries[i].fail("strokes", "expected paint with at most " + text(most) + " voxels of " + text(voxel) +
                                     " m on its surface, got " + text(voxels) +
                                     "; make the balls smaller or the world's resolution coarser");
  }
}

}  // namespace

void require_size(const YamlFields& fields, const SuiteWorld& world) {
  if (!world.map.empty()) return;
  if (world.is_exact) return require_cells(fields, world);
  require_solids(fields, world);
  if (!world.sensors.empty()) require_range(fields, "sensor_range", world.sensor_range, world.resolution);
  require_paint(fields, world);
}

void require_size(const YamlFields& fields, const SuiteExperiment& experiment) {
  if (experiment.teams) {
    const double steps = experiment.teams->duration / experiment.teams->period;
    if (steps > most_steps)
      fields.fail("duration", "expected at most " + text(most_steps) + " steps of the period, " +
                                  text(experiment.teams->period) + " s, got " + text(steps));
    if (const auto& sensing = experiment.teams->sensing) {
      require_range(fields.map("sensing"), "range", sensing->range, sensing->resolution);
      require_sensed(fields, *experiment.teams, sensing->resolution / 2);
    }
    return;
  }
  const double problems =
      experiment.generate ? experiment.generate->count : static_cast<double>(experiment.problems.size());
  const double runs = problems * experiment.runs * static_cast<double>(experiment.planners.size());
  if (runs > most_runs)
    fields.fail("runs", "expected at most " + text(most_runs) +
                            " runs (problems, planners and runs multiplied), got " + text(runs));
}

}  // namespace clearway
