#include "mapping/volumes/volume_quality.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/volumes/volume_voxels.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {
namespace {

/// Painted voxels of one volume and the cells that hold them.
struct PaintedCells {
  std::size_t painted = 0, occupied = 0;
  Eigen::Array3d low = Eigen::Array3d::Constant(HUGE_VAL);    ///< cells, inclusive
  Eigen::Array3d high = Eigen::Array3d::Constant(-HUGE_VAL);  ///< cells, exclusive
};

template <class Visit>
void visit_painted(const FusedTree& tree, std::uint16_t bit, const Visit& visit) {
  tree.visit_leaves([&](const FusedNode& node, const CellCube& cube) {
    if ((node.painted() & bit) != 0) visit(cube, tree.state(node) == VoxelState::conflict);
  });
}

PaintedCells count_painted(const FusedTree& tree, std::uint16_t bit) {
  PaintedCells cells;
  visit_painted(tree, bit, [&](const CellCube& cube, bool occupied) {
    cells.painted += cube.volume();
    if (occupied) cells.occupied += cube.volume();
    cells.low = cells.low.min(cube.corner.cast<double>().array());
    cells.high = cells.high.max(cube.corner.cast<double>().array() + cube.edge);
  });
  return cells;
}

/// Wide enough to find necks between parts in which the largest sphere fits one and a half times.
std::uint16_t cap_for(const std::vector<Sphere>& spheres, double resolution) {
  double half_voxels = 80.0;
  for (const Sphere& sphere : spheres) half_voxels = std::max(half_voxels, 3.0 * sphere.radius / resolution);
  return static_cast<std::uint16_t>(std::min(half_voxels * half_voxels, static_cast<double>(largest_cap)));
}

VolumeVoxels gather(const FusedTree& tree, std::uint16_t bit, const PaintedCells& cells, std::uint16_t cap) {
  const Eigen::Vector3i size = (cells.high - cells.low).matrix().cast<int>().array() + 2;
  VolumeVoxels voxels;
  voxels.first = cells.low.matrix().cast<int>().array() - 1;
  voxels.resolution = tree.getResolution();
  voxels.block = DistanceBlock(size.x(), size.y(), size.z(), cap);
  std::fill(voxels.block.squared.begin(), voxels.block.squared.end(), std::uint16_t{0});
  visit_painted(tree, bit, [&](const CellCube& cube, bool occupied) {
    if (occupied) return;
    const Eigen::Vector3i at = cube.corner - voxels.first;
    for (int z = at.z(); z < at.z() + cube.edge; ++z) {
      for (int y = at.y(); y < at.y() + cube.edge; ++y) {
        std::fill_n(&voxels.block.squared[voxels.block.index(at.x(), y, z)], cube.edge, cap);
      }
    }
  });
  return voxels;
}

std::vector<VolumeHole> describe_holes(const VolumeVoxels& voxels, const FusedTree& tree, std::uint16_t bit,
                                       const PaintedVolume& exact) {
  std::vector<VolumeHole> holes;
  for (const auto& pocket : find_pockets(voxels)) {
    VolumeHole hole;
    hole.voxels = pocket.size();
    hole.volume = static_cast<double>(pocket.size()) * std::pow(voxels.resolution, 3);
    double best = HUGE_VAL;
    for (const std::size_t cell : pocket) hole.centroid += voxels.center(cell);
    hole.centroid /= static_cast<double>(pocket.size());
    for (const std::size_t cell : pocket) {
      const Eigen::Vector3d center = voxels.center(cell);
      const double off = (center - hole.centroid).squaredNorm();
      if (off < best) {
        best = off;
        hole.inside = center;
      }
      if (!exact.contains(center)) ++hole.beyond_spheres;
      CellCube cube;
      const FusedNode* node = tree.find_leaf(voxels.cell(cell), cube);
      if (node != nullptr && (node->painted() & bit) != 0) ++hole.occupied;
    }
    holes.push_back(hole);
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const VolumeHole& a, const VolumeHole& b) { return a.voxels > b.voxels; });
  return holes;
}

void search_voxels(const FusedTree& tree, std::uint16_t bit, const PaintedCells& cells,
                   const PaintedVolume& exact, const QualityOptions& options, VolumeQuality& quality) {
  if (cells.painted == 0) return;
  const Eigen::Array3d size = cells.high - cells.low + 2.0;
  const double padded = std::ceil(size.x() / DistanceBlock::lane) * DistanceBlock::lane * size.y() * size.z();
  if (padded > static_cast<double>(options.most_cells)) {
    quality.not_searched = "the box about the volume holds " + std::to_string(padded / 1e6) +
                           " million voxels, more than the " + std::to_string(options.most_cells / 1000000) +
                           " million that are searched";
    return;
  }
  VolumeVoxels voxels = gather(tree, bit, cells, cap_for(exact.spheres, tree.getResolution()));
  quality.holes = describe_holes(voxels, tree, bit, exact);
  transform_distances(voxels.block);
  VolumeParts parts = find_parts(voxels, options.neck_ratio);
  quality.parts = std::move(parts.sizes);
  for (const PartsMeet& neck : parts.necks) {
    quality.necks.push_back({voxels.center(neck.cell), neck.level * voxels.resolution,
                             neck.smaller * voxels.resolution, neck.larger * voxels.resolution});
  }
}

}  // namespace

double VolumeQuality::sphericity() const {
  if (!(surface.area > 0.0)) return 0.0;
  return std::cbrt(std::numbers::pi * 36.0 * exact.middle() * exact.middle()) / surface.area;
}

VolumeQuality measure_volume(const Snapshot& map, int index, const QualityOptions& options) {
  if (index < 0 || index >= FusedTree::volume_limit) {
    throw std::invalid_argument("painted volume " + std::to_string(index) +
                                " does not exist, expected 0 to 14");
  }
  if (!(options.neck_ratio > 0.0 && options.neck_ratio < 1.0)) {
    throw std::invalid_argument("quality of a painted volume: neck_ratio is " +
                                std::to_string(options.neck_ratio) + ", expected a value in (0, 1)");
  }
  const auto number = static_cast<std::size_t>(index);
  const bool named = number < map.volumes().size();
  const PaintedVolume volume =
      named ? map.volumes()[number] : PaintedVolume{"volume " + std::to_string(index), {}, {}, {}};
  const auto bit = static_cast<std::uint16_t>(1U << number);
  const PaintedCells cells = count_painted(map.tree(), bit);

  VolumeQuality quality;
  quality.label = volume.label;
  quality.spheres = volume.spheres.size();
  quality.exact = union_volume(volume.spheres, options.relative_width);
  quality.surface = union_area(volume.spheres);
  quality.voxels = cells.painted;
  quality.occupied = cells.occupied;
  quality.voxel_volume = static_cast<double>(cells.painted) * std::pow(map.resolution(), 3);
  quality.spacing = sample_spacing(volume.spheres);
  search_voxels(map.tree(), bit, cells, volume, options, quality);
  return quality;
}

}  // namespace clearway
