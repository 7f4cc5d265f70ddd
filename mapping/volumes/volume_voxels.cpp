#include "mapping/volumes/volume_voxels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

namespace clearway {
namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// Calls visit(index, on_border) for each cell of the block in its order.
template <class Visit>
void visit_cells(const DistanceBlock& block, const Visit& visit) {
  for (int z = 0; z < block.nz; ++z) {
    for (int y = 0; y < block.ny; ++y) {
      const bool border = z == 0 || z == block.nz - 1 || y == 0 || y == block.ny - 1;
      for (int x = 0; x < block.nx; ++x) visit(block.index(x, y, z), border || x == 0 || x == block.nx - 1);
    }
  }
}

std::size_t step_from(std::size_t index, std::ptrdiff_t step) {
  return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(index) + step);
}

/// Sets of cells with the largest squared distance of each (that of its root).
class Parts {
 public:
  explicit Parts(const DistanceBlock& block) : block_(block), parent_(block.squared.size(), none) {}

  bool holds(std::size_t cell) const { return parent_[cell] != none; }
  void add(std::size_t cell) { parent_[cell] = static_cast<std::uint32_t>(cell); }
  std::size_t root(std::size_t cell) {
    while (parent_[cell] != cell) {
      parent_[cell] = parent_[parent_[cell]];
      cell = parent_[cell];
    }
    return cell;
  }
  /// Half voxels.
  double peak(std::size_t root) const { return std::sqrt(static_cast<double>(block_.squared[root])); }
  /// The root with the larger peak stays; of equal ones the first cell.
  void join(std::size_t a, std::size_t b) {
    const auto key = [&](std::size_t root) { return std::make_pair(block_.squared[root], none - root); };
    if (key(a) < key(b)) std::swap(a, b);
    parent_[b] = static_cast<std::uint32_t>(a);
  }

 private:
  const DistanceBlock& block_;
  std::vector<std::uint32_t> parent_;
};

/// Free cells in order of falling distance, equal ones in the block's order.
std::vector<std::uint32_t> cells_by_distance(const DistanceBlock& block) {
  std::vector<std::size_t> start(std::size_t{block.cap} + 2, 0);
  visit_cells(block, [&](std::size_t i, bool) {
    if (block.squared[i] != 0) ++start[std::size_t{block.cap} - block.squared[i] + 1];
  });
  for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
  std::vector<std::uint32_t> order(start.back());
  visit_cells(block, [&](std::size_t i, bool) {
    if (block.squared[i] != 0) {
      order[start[std::size_t{block.cap} - block.squared[i]]++] = static_cast<std::uint32_t>(i);
    }
  });
  return order;
}

}  // namespace

Eigen::Vector3i VolumeVoxels::cell(std::size_t index) const {
  const auto stride = static_cast<std::size_t>(block.stride), ny = static_cast<std::size_t>(block.ny);
  return first + Eigen::Vector3i(static_cast<int>(index % stride), static_cast<int>(index / stride % ny),
                                 static_cast<int>(index / stride / ny));
}

std::array<std::ptrdiff_t, 6> VolumeVoxels::face_steps() const {
  const std::ptrdiff_t row = block.stride, slice = row * block.ny;
  return {-slice, -row, -1, 1, row, slice};
}

std::vector<std::vector<std::size_t>> find_pockets(const VolumeVoxels& voxels) {
  const DistanceBlock& block = voxels.block;
  const auto steps = voxels.face_steps();
  std::vector<std::uint8_t> done(block.squared.size(), 0);
  std::vector<std::size_t> filled;
  const auto fill = [&](std::size_t seed) {
    const std::size_t begin = filled.size();
    filled.push_back(seed);
    done[seed] = 1;
    for (std::size_t k = begin; k < filled.size(); ++k) {
      for (const std::ptrdiff_t step : steps) {
        const std::size_t next = step_from(filled[k], step);
        if (done[next] != 0 || block.squared[next] != 0) continue;
        done[next] = 1;
        filled.push_back(next);
      }
    }
  };
  visit_cells(block, [&](std::size_t i, bool border) { done[i] = border ? 1 : 0; });
  visit_cells(block, [&](std::size_t i, bool border) {  // outside: what shares a face with the margin
    if (border || done[i] != 0 || block.squared[i] != 0) return;
    const Eigen::Array3i at = (voxels.cell(i) - voxels.first).array();
    const Eigen::Array3i last(block.nx - 2, block.ny - 2, block.nz - 2);
    if ((at == 1).any() || (at == last).any()) fill(i);
    filled.clear();
  });
  std::vector<std::vector<std::size_t>> pockets;
  visit_cells(block, [&](std::size_t i, bool) {
    if (done[i] != 0 || block.squared[i] != 0) return;
    fill(i);
    pockets.push_back(std::move(filled));
    filled.clear();
  });
  return pockets;
}

VolumeParts find_parts(const VolumeVoxels& voxels, double ratio) {
  const DistanceBlock& block = voxels.block;
  const auto steps = voxels.face_steps();
  Parts parts(block);
  VolumeParts result;
  const std::vector<std::uint32_t> order = cells_by_distance(block);
  for (const std::size_t cell : order) {
    parts.add(cell);
    const double level = std::sqrt(static_cast<double>(block.squared[cell]));
    for (const std::ptrdiff_t step : steps) {
      const std::size_t next = step_from(cell, step);
      if (!parts.holds(next)) continue;
      const std::size_t a = parts.root(cell), b = parts.root(next);
      if (a == b) continue;
      const double smaller = std::min(parts.peak(a), parts.peak(b));
      if (level <= std::min(ratio * smaller, smaller - 2.0)) {
        result.necks.push_back(
            {cell, 0.5 * level, 0.5 * smaller, 0.5 * std::max(parts.peak(a), parts.peak(b))});
      }
      parts.join(a, b);
    }
  }
  std::vector<std::size_t> sizes(block.squared.size(), 0);
  for (const std::size_t cell : order) ++sizes[parts.root(cell)];
  std::copy_if(sizes.begin(), sizes.end(), std::back_inserter(result.sizes),
               [](std::size_t n) { return n > 0; });
  std::sort(result.sizes.begin(), result.sizes.end(), std::greater<>());
  std::stable_sort(result.necks.begin(), result.necks.end(),
                   [](const PartsMeet& a, const PartsMeet& b) { return a.level < b.level; });
  return result;
}

}  // namespace clearway
