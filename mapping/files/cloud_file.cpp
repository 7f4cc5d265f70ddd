#include "mapping/files/cloud_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "mapping/files/cloud_gaps.hpp"
#include "mapping/files/cloud_parser.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/files/number_words.hpp"
#include "mapping/files/velodyne_scan.hpp"
#include "mapping/files/xyz_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/triangle_cells.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_points = 100'000'000;
constexpr double finest_voxel = 1e-4, coarsest_voxel = 100.0;  ///< m
constexpr double of_apart = 1.25;  ///< a thinned surface's voxels, of what its points are apart: no holes

std::vector<Eigen::Vector3f> finite_points(ParsedCloud& cloud) {
  std::erase_if(cloud.points, [](const Eigen::Vector3f& point) { return !point.allFinite(); });
  return std::move(cloud.points);
}

std::string raw(const std::vector<Eigen::Vector3f>& points) {
  std::string bytes(points.size() * sizeof(Eigen::Vector3f), '\0');
  if (!points.empty()) std::memcpy(bytes.data(), points.front().data(), bytes.size());
  return bytes;
}

constexpr std::string_view statement = "clearway: centres of voxels with an edge of ";

std::string statement_of(double edge) { return std::string(statement) + to_text(edge) + " m\n"; }

}  // namespace

std::optional<double> stated_edge(const std::filesystem::path& file) {
  std::ifstream stream(input_place(file), std::ios::binary);
  std::string line;
  for (int i = 0; i < 4 && std::getline(stream, line); ++i) {
    std::string_view rest = line;
    rest.remove_prefix(line.starts_with("# ") ? 2 : line.starts_with("comment ") ? 8 : rest.size());
    if (!rest.starts_with(statement)) continue;
    rest.remove_prefix(statement.size());
    const std::optional<double> edge = parsed_number(next_word(rest));
    if (edge && *edge >= finest_voxel && *edge <= coarsest_voxel) return edge;
  }
  return std::nullopt;
}

bool has_turned_viewpoint(const std::filesystem::path& file) {
  std::ifstream stream(input_place(file), std::ios::binary);
  std::string line;
  for (int i = 0; i < 20 && std::getline(stream, line) && !line.starts_with("DATA"); ++i) {
    std::string_view rest = line;
    if (next_word(rest) != "VIEWPOINT") continue;
    double turned = 0.0;  // x y z qw qx qy qz
    for (int k = 0; k < 7; ++k) {
      const double number = parsed_number(next_word(rest)).value_or(0.0);
      if (k >= 4) turned = std::max(turned, std::abs(number));
    }
    return turned > 1e-6;
  }
  return false;
}

namespace {

/// Takes out the parts that would take more than some 20 million voxels together, those of the most first.
std::vector<ThinnedPart> take_costly(CloudVoxels& voxels) {
  constexpr double most_filled = 2e7;
  const auto cost = [&](const ThinnedPart& part) {
    return static_cast<double>(part.points.size()) * std::pow(1.0 + of_apart * part.apart / voxels.edge, 3);
  };
  std::stable_sort(voxels.parts.begin(), voxels.parts.end(),
                   [&](const ThinnedPart& a, const ThinnedPart& b) { return cost(a) < cost(b); });
  double filled = 0.0;
  std::size_t kept = 0;
  while (kept < voxels.parts.size() && (filled += cost(voxels.parts[kept])) <= most_filled) ++kept;
  const auto first = voxels.parts.begin() + static_cast<std::ptrdiff_t>(kept);
  std::vector<ThinnedPart> left(std::make_move_iterator(first), std::make_move_iterator(voxels.parts.end()));
  voxels.parts.erase(first, voxels.parts.end());
  return left;
}

}  // namespace

CloudVoxels voxels_of_cloud(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points,
                            std::optional<double> chosen) {
  const auto stated = stated_edge(file);
  if (stated && chosen.value_or(*stated) == *stated) return {*stated, {}, {}};
  const auto with_strewn = [&](CloudVoxels voxels) {
    if (auto strewn = strewn_part(points, voxels.edge)) voxels.left.push_back(*std::move(strewn));
    return voxels;
  };
  if (chosen) return with_strewn({*chosen, {}, {}, true});
  const auto whole = [](double apart) { return std::ceil(1250.0 * apart) / 1000.0; };
  CloudVoxels voxels;
  voxels.joins_near = true;
  if (const auto spacing = thinned_spacing(points, voxels.edge)) voxels.edge = whole(*spacing);
  for (;;) {
    voxels.parts = thinned_parts(points, voxels.edge);
    voxels.left = take_costly(voxels);
    std::size_t left = 0;
    double widest = 0.0;
    for (const ThinnedPart& part : voxels.left) {
      left += part.points.size();
      widest = std::max(widest, part.apart);
    }
    if (2 * left <= points.size()) return with_strewn(std::move(voxels));
    voxels.edge = whole(widest);
  }
}

bool is_cloud_file(const std::filesystem::path& file) {
  const std::string kind = extension_of(file);
  return kind == ".pcd" || kind == ".ply" || is_velodyne_file(file) || is_xyz_file(file);
}

std::vector<Eigen::Vector3f> read_cloud(const std::filesystem::path& file) {
  if (is_velodyne_file(file)) return read_velodyne_scan(file).points;
  if (is_xyz_file(file)) return read_xyz_file(file);
  ParsedCloud cloud = parse_cloud(file);
  return finite_points(cloud);
}

namespace {

/// Points over a triangle, no farther apart than `step`: in rows from the corner across from its shortest
/// side.
void add_points(std::array<Eigen::Vector3f, 3> corners, double step, std::vector<Eigen::Vector3f>& points) {
  const auto across = [&](std::size_t i) { return (corners[(i + 1) % 3] - corners[(i + 2) % 3]).norm(); };
  std::size_t first = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (across(i) < across(first)) first = i;
  std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(first), corners.end());
  const Eigen::Vector3f b = corners[1] - corners[0], c = corners[2] - corners[0];
  const auto pieces = [&](float length) { return std::max(1, static_cast<int>(std::ceil(length / step))); };
  const int rows = pieces(std::max(b.norm(), c.norm()));
  for (int i = 0; i <= rows; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(rows);
    const Eigen::Vector3f from = corners[0] + share * b, way = share * (c - b);
    const int parts = pieces(way.norm());
    for (int k = 0; k <= parts; ++k)
      points.push_back(from + static_cast<float>(k) / static_cast<float>(parts) * way);
  }
}

/// About how many of them.
double points_over(const CloudFace& corners, double step) {
  const auto corner = [&](std::size_t i) { return Eigen::Vector3d(corners[i % 3].cast<double>()); };
  const double area = 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  double around = 0.0;
  for (std::size_t i = 0; i < 3; ++i) around += (corner(i) - corner(i + 1)).norm();
  return area / (step * step) + around / step + 3.0;
}

}  // namespace

CloudSurface read_surface(const std::filesystem::path& file, double edge) {
  if (is_velodyne_file(file) || is_xyz_file(file)) return {read_cloud(file)};
  ParsedCloud cloud = parse_cloud(file);
  if (cloud.has_lost_faces)
    throw std::invalid_argument(
        "'" + file.string() + "' has faces that cannot be read (strips of triangles, or " +
        "lists of an unusual type): expected faces with indices of 4 bytes, or points alone");
  constexpr double most = 5e7;
  const double step = 0.4 * edge;
  CloudSurface surface;
  std::vector<Eigen::Vector3f> on_faces;
  double asked = 0.0;
  for (const auto& [i, j, k] : cloud.triangles) {
    const CloudFace corners{cloud.points[i], cloud.points[j], cloud.points[k]};
    if (!(corners[0].allFinite() && corners[1].allFinite() && corners[2].allFinite()))
      throw DamagedFile("'" + file.string() +
                        "' is damaged: a face of it has a corner that is not finite, and without it there "
                        "would be a hole; expected finite corners, or points alone");
    asked += points_over(corners, step);
    if (!(asked <= most))
      throw std::invalid_argument("'" + file.string() +
                                  "' has faces of more than 50 million points at voxels of " + to_text(edge) +
                                  " m: expected smaller ones, or a coarser --cloud-resolution");
    add_points(corners, step, on_faces);
    surface.faces.push_back(corners);
  }
  surface.points = finite_points(cloud);
  surface.points.insert(surface.points.end(), on_faces.begin(), on_faces.end());
  return surface;
}

ViewedCloud read_viewed_cloud(const std::filesystem::path& file) {
  if (is_velodyne_file(file)) {
    VelodyneScan scan = read_velodyne_scan(file);
    return {std::move(scan.points), Eigen::Isometry3d::Identity(), scan.left_out()};
  }
  if (is_xyz_file(file)) return {read_xyz_file(file)};
  ParsedCloud parsed = parse_cloud(file);
  if (parsed.viewpoint == decltype(parsed.viewpoint){})
    parsed.viewpoint[3] = 1.0F;  // some write zeros for none
  const auto& [x, y, z, qw, qx, qy, qz] = parsed.viewpoint;
  const Eigen::Vector3f origin(x, y, z);
  const Eigen::Quaternionf turn(qw, qx, qy, qz);
  if (!origin.allFinite() || !(std::abs(turn.norm() - 1.0F) < 1e-3F)) {
    throw DamagedFile("'" + file.string() +
                      "' is damaged: its viewpoint is not a finite place and a unit quaternion");
  }
  const std::size_t all = parsed.points.size();
  ViewedCloud cloud{finite_points(parsed), Eigen::Isometry3d(turn.normalized().cast<double>())};
  cloud.left_out = all - cloud.points.size();
  cloud.file_from_viewpoint.translation() = origin.cast<double>();
  return cloud;
}

float left_log_odds(const FusedTree& tree) { return std::nextafter(tree.getClampingThresMaxLog(), 0.0F); }

namespace {

/// Each cell once, those of a block of 16 along each axis one after the other: the way down the tree to the
/// next one is short then.
void sort_by_blocks(std::vector<Eigen::Vector3i>& cells) {
  constexpr int least = 32768;
  std::vector<std::uint64_t> numbers;
  numbers.reserve(cells.size());
  for (const Eigen::Vector3i& cell : cells) {
    std::uint64_t of_block = 0, in_block = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<std::uint64_t>(cell[axis] + least);
      of_block = of_block << 12U | at >> 4U;
      in_block = in_block << 4U | (at & 15U);
    }
    numbers.push_back(of_block << 12U | in_block);
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  cells.clear();
  for (const std::uint64_t number : numbers) {
    const auto at = [&](unsigned axis) {  // from the last one on
      return static_cast<int>((number >> (12U + 12U * axis) & 0xfffU) << 4U | (number >> 4U * axis & 15U)) -
             least;
    };
    cells.emplace_back(at(2), at(1), at(0));
  }
}

}  // namespace

std::shared_ptr<const FusedTree> tree_of_cloud(const std::vector<Eigen::Vector3f>& points,
                                               const CloudVoxels& voxels, const std::filesystem::path& file,
                                               const std::vector<CloudFace>& faces) {
  const double resolution = voxels.edge;
  if (!(resolution >= finest_voxel && resolution <= coarsest_voxel)) {
    throw std::invalid_argument("cloud resolution is " + short_text(resolution) +
                                ", expected metres in [0.0001, 100]");
  }
  auto tree = std::make_shared<FusedTree>(resolution);
  const auto cell_of = [&](const Eigen::Vector3d& point) {
    const auto cell = tree->cell(point);
    if (!cell) {
      throw std::invalid_argument("'" + file.string() + "' has a point at (" + short_text(point.x()) + ", " +
                                  short_text(point.y()) + ", " + short_text(point.z()) + "), beyond " +
                                  short_text(32768.0 * resolution) +
                                  " m, the reach of a map of this resolution: expected metres from an origin "
                                  "nearby (shift a cloud of UTM coordinates), or a coarser cloud resolution");
    }
    return *cell;
  };
  const auto occupy = [&](const Eigen::Vector3i& cell, float log_odds) {
    const Eigen::Vector3i key = cell.array() + 32768;
    tree->set_observed({static_cast<octomap::key_type>(key.x()), static_cast<octomap::key_type>(key.y()),
                        static_cast<octomap::key_type>(key.z())},
                       log_odds);
  };
  for (const ThinnedPart& part : voxels.parts) {
    for (const std::size_t i : part.points) {
      const Eigen::Array3d center = points[i].cast<double>().array();
      const Eigen::Vector3i low = cell_of(center - of_apart / 2.0 * part.apart);
      const Eigen::Vector3i high = cell_of(center + of_apart / 2.0 * part.apart);
      for (int x = low.x(); x <= high.x(); ++x)
        for (int y = low.y(); y <= high.y(); ++y)
          for (int z = low.z(); z <= high.z(); ++z) occupy({x, y, z}, tree->getProbHitLog());
    }
  }
  std::vector<Eigen::Vector3i> cells;
  cells.reserve(points.size());
  for (const Eigen::Vector3f& point : points) cells.push_back(cell_of(point.cast<double>()));
  if (voxels.joins_near)
    for (const Eigen::Vector3i& cell : cells_between(points, cells, resolution))
      occupy(cell, tree->getClampingThresMaxLog());
  for (const auto& [a, b, c] : faces) {  // points on it miss voxels of which it meets no more than a corner
    visit_cells_met(
        {a.cast<double>(), b.cast<double>(), c.cast<double>()}, resolution,
        [&](const Eigen::Vector3i& cell) { cells.emplace_back(cell.cwiseMax(-32768).cwiseMin(32767)); });
  }
  sort_by_blocks(cells);
  for (const Eigen::Vector3i& cell : cells) occupy(cell, tree->getClampingThresMaxLog());
  cells.clear();
  for (const ThinnedPart& part : voxels.left)
    for (const std::size_t i : part.points) cells.push_back(cell_of(points[i].cast<double>()));
  sort_by_blocks(cells);
  for (const Eigen::Vector3i& cell : cells) occupy(cell, left_log_odds(*tree));
  tree->finish();
  return tree;
}

std::vector<Eigen::Vector3f> occupied_centers(const FusedTree& tree, const std::filesystem::path& file) {
  std::vector<Eigen::Vector3f> centers;
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    const VoxelState state = tree.state(node);
    if (state != VoxelState::occupied && state != VoxelState::conflict) return;
    if (centers.size() + cube.volume() > most_points) {
      throw std::invalid_argument(
          "cannot export '" + file.string() +
          "': the map has more than 100 million occupied voxels, expected .ot or .bt");
    }
    for (int i = 0; i < cube.edge * cube.edge * cube.edge; ++i) {
      const Eigen::Vector3i step(i % cube.edge, i / cube.edge % cube.edge, i / cube.edge / cube.edge);
      const Eigen::Array3d cell = (cube.corner + step).cast<double>().array();
      centers.emplace_back(((cell + 0.5) * tree.getResolution()).matrix().cast<float>());
    }
  });
  return centers;
}

std::string format_pcd(const std::vector<Eigen::Vector3f>& points, std::optional<double> edge) {
  const std::string count = std::to_string(points.size());
  return "# .PCD v0.7 - Point Cloud Data file format\n" +
         (edge ? "# " + statement_of(*edge) : std::string()) +
         "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n" + raw(points);
}

std::string format_ply(const std::vector<Eigen::Vector3f>& points, std::optional<double> edge) {
  return "ply\nformat binary_little_endian 1.0\n" +
         (edge ? "comment " + statement_of(*edge) : std::string()) + "element vertex " +
         std::to_string(points.size()) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + raw(points);
}

}  // namespace clearway
