#include "apps/inspect/hand_shapes.hpp"

#include <map>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/suites/suite_cells.hpp"
#include "datasets/yaml/whole_turn.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/geometry/shape.hpp"

namespace clearway {
namespace {

constexpr double most_cells = 25e6, farthest_middle = 1e5, largest = 1e3;  // m
constexpr double cells_a_side = 32768;  ///< of a map, from its origin, as OctoMap's keys

struct PlacedShape {
  Shape shape;
  Eigen::Isometry3d map_from_shape;
};

Shape shape_of_sizes(const std::string& kind, const double* size) {
  if (kind == "box") return Shape::box({size[0], size[1], size[2]});
  return kind == "sphere" ? Shape::sphere(size[0]) : Shape::cylinder(size[0], size[1]);
}

PlacedShape parse_shape(const std::string& text, const std::string& flag) {
  static const std::map<std::string, std::size_t> sizes{{"box", 3}, {"sphere", 1}, {"cylinder", 2}};
  const auto refuse = [&](const std::string& expected) {
    throw std::invalid_argument(flag + ": got " + quote(text) + ", expected " + expected);
  };
  const std::size_t colon = text.find(':');
  const auto known = sizes.find(text.substr(0, colon));
  if (colon == std::string::npos || known == sizes.end())
    refuse("box:X,Y,Z,SX,SY,SZ, sphere:X,Y,Z,R or cylinder:X,Y,Z,R,H");
  const auto& [kind, count] = *known;
  const std::vector<double> n = parse_numbers(text.substr(colon + 1), flag);
  const std::size_t turns = n.size() - std::min(n.size(), 3 + count);
  if (n.size() < 3 + count || (turns != 0 && (kind == "sphere" || (turns != 1 && turns != 3))))
    refuse(kind == "sphere" ? "sphere:X,Y,Z,R"
                            : kind + (kind == "box" ? ":X,Y,Z,SX,SY,SZ" : ":X,Y,Z,R,H") +
                                  ", and then YAW, or ROLL,PITCH,YAW, or nothing");
  const Eigen::Vector3d middle(n[0], n[1], n[2]);
  if (!(middle.cwiseAbs().maxCoeff() <= farthest_middle)) refuse("a middle within 100 km");
  for (std::size_t i = 3; i < 3 + count; ++i)
    if (!(n[i] >= tiny && n[i] <= largest)) refuse("sizes above 0, at most 1000 m");
  for (std::size_t i = 3 + count; i < n.size(); ++i)
    if (!is_within_turn(n[i])) refuse("angles in radians, each within a whole turn");
  PlacedShape placed{shape_of_sizes(kind, n.data() + 3), Eigen::Isometry3d::Identity()};
  placed.map_from_shape.translation() = middle;
  if (turns == 1) placed.map_from_shape.linear() = rotation_from_rpy(0.0, 0.0, n.back());
  if (turns == 3)
    placed.map_from_shape.linear() = rotation_from_rpy(n[3 + count], n[4 + count], n[5 + count]);
  return placed;
}

/// Whether a convex body, which the shapes are, holds the cube: it holds its corners.
bool holds_cube(const PlacedShape& placed, const Eigen::Vector3d& center, double edge) {
  const Eigen::Isometry3d shape_from_map = placed.map_from_shape.inverse();
  const double slack = 1e-9 * (edge + center.lpNorm<Eigen::Infinity>());
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector3d side(i & 1U ? 0.5 : -0.5, i & 2U ? 0.5 : -0.5, i & 4U ? 0.5 : -0.5);
    if (placed.shape.signed_distance(shape_from_map * (center + edge * side)) > slack) return false;
  }
  return true;
}

/// The centres of the cells about the shapes for which `takes` says so.
template <typename Takes>
std::vector<Eigen::Vector3d> cells(const std::vector<std::string>& shapes, const std::string& flag,
                                   double edge, const Takes& takes) {
  std::vector<Eigen::Vector3d> centers;
  double looked_at = 0.0;
  for (const std::string& text : shapes) {
    const PlacedShape placed = parse_shape(text, flag);
    const Eigen::AlignedBox3d box = placed.shape.bounds(placed.map_from_shape);
    looked_at += (box.sizes().array() / edge + 2.0).prod();
    if (looked_at > most_cells)
      throw std::invalid_argument(
          flag + ": got " + quote(text) +
          ", for which more than 25000000 voxels would have to be looked at, expected "
          "a smaller shape");
    const Eigen::Array3d first = (box.min().array() / edge - 1e-6).floor();
    const Eigen::Array3d last = (box.max().array() / edge + 1e-6).floor();
    if (first.minCoeff() < -cells_a_side || last.maxCoeff() >= cells_a_side)
      throw std::invalid_argument(
          flag + ": got " + quote(text) + ", expected a shape within " + significant(cells_a_side * edge) +
          " m of the map's origin, as far as voxels of " + significant(edge) + " m reach");
    for (double z = first.z(); z <= last.z(); ++z)
      for (double y = first.y(); y <= last.y(); ++y)
        for (double x = first.x(); x <= last.x(); ++x) {
          const Eigen::Vector3d center = edge * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
          if (takes(placed, center)) centers.push_back(center);
        }
  }
  return centers;
}

}  // namespace

std::vector<Eigen::Vector3d> cells_met(const std::vector<std::string>& shapes, double edge) {
  return cells(shapes, "--occupy", edge, [&](const PlacedShape& placed, const Eigen::Vector3d& center) {
    return meets_cube(placed.shape, placed.map_from_shape, center, edge);
  });
}

std::vector<Eigen::Vector3d> cells_inside(const std::vector<std::string>& shapes, double edge) {
  return cells(shapes, "--clear", edge, [&](const PlacedShape& placed, const Eigen::Vector3d& center) {
    return holds_cube(placed, center, edge);
  });
}

}  // namespace clearway
