#include "mapping/scans/ray_window.hpp"

#include <algorithm>
#include <cstring>
#include <new>

namespace clearway {
namespace {

constexpr int line = 64;

struct Layout {
  Eigen::Vector3i corner, size;
  std::int64_t stride_y, stride_z;
};

Layout layout_of(const Eigen::AlignedBox3i& box) {
  Layout result;
  for (int axis = 0; axis < 3; ++axis) {
    const int grain = axis == 0 ? line : ScanTile::edge;
    const int first = (box.min()[axis] - RayWindow::margin) & ~(grain - 1);
    const int last = (box.max()[axis] + RayWindow::margin) | (grain - 1);
    result.corner[axis] = first;
    result.size[axis] = last - first + 1;
  }
  const std::int64_t lines = (result.size.x() / line) | 1;
  result.stride_y = lines * line;
  result.stride_z = ((lines * result.size.y()) | 1) * line;
  return result;
}

/// Sixteen words of 4 x 4 x 4 cells from 16 masks of 64 cells along x, row (y, z) at y + 4 z.
void arrange(const std::uint64_t (&masks)[16], std::uint64_t* words) {
  // Two cells along x of each row lie side by side in a word, and 4 rows (2 in y, 2 in z) fill a byte.
  const auto spread = [](std::uint64_t v) {
    v &= 0xffffU;
    v = (v | v << 24U) & 0x000000ff000000ffU;
    v = (v | v << 12U) & 0x000f000f000f000fU;
    return (v | v << 6U) & 0x0303030303030303U;
  };
  for (unsigned group = 0; group < 4; ++group) {          // 16 cells along x: four words
    for (unsigned quarter = 0; quarter < 4; ++quarter) {  // 2 x 2 rows: 16 bits of each word
      std::uint64_t bits = 0;
      for (unsigned row = 0; row < 4; ++row) {
        const unsigned y = (quarter & 1U) * 2 + (row & 1U), z = (quarter >> 1U) * 2 + (row >> 1U);
        bits |= spread(masks[y + 4 * z] >> 16 * group) << 2 * row;
      }
      for (unsigned word = 0; word < 4; ++word)
        words[4 * group + word] |= (bits >> 16 * word & 0xffffU) << 16 * quarter;
    }
  }
}

}  // namespace

std::int64_t RayWindow::bytes_of(const Eigen::AlignedBox3i& box) {
  const Layout layout = layout_of(box);
  return layout.stride_z * layout.size.z();
}

void RayWindow::cover(const Eigen::AlignedBox3i& box, bool few) {
  const Layout layout = layout_of(box);
  corner_ = layout.corner;
  size_ = layout.size;
  is_few_ = few;
  if (few) expected_.assign(static_cast<std::size_t>(size_.cast<std::int64_t>().prod()) / 4096, 0);
  stride_[1] = layout.stride_y;
  stride_[2] = layout.stride_z;
  const std::int64_t bytes = layout.stride_z * size_.z();
  if (bytes <= capacity_) return;
  constexpr std::size_t page = std::size_t{1} << 21U;
  const std::size_t wanted = (static_cast<std::size_t>(bytes) + page - 1) / page * page;
  capacity_ = 0;
  cells_.reset();
  cells_.reset(static_cast<std::uint8_t*>(std::aligned_alloc(page, wanted)));
  if (cells_ == nullptr) throw std::bad_alloc();
  std::memset(cells_.get(), 0, wanted);
  capacity_ = static_cast<std::int64_t>(wanted);
}

/// Between two places no farther apart than a block is thick, the line stays in the box of both.
void RayWindow::expect_ray(const Eigen::Vector3i& from, const Eigen::Vector3i& to) {
  const Eigen::Vector3d begin = from.cast<double>(), way = (to - from).cast<double>();
  const int pieces = (to - from).cwiseAbs().maxCoeff() / block_edge + 1;
  Eigen::Vector3i last = from;
  for (int i = 1; i <= pieces; ++i) {
    const Eigen::Vector3i next = (begin + way * (double(i) / pieces)).array().round().matrix().cast<int>();
    const Eigen::Vector3i low = last.cwiseMin(next).array() - margin,
                          high = last.cwiseMax(next).array() + margin;
    for (int z = low.z() & -block_edge; z <= high.z(); z += block_edge)
      for (int y = low.y() & -block_edge; y <= high.y(); y += block_edge)
        for (int x = low.x() & -line; x <= high.x(); x += line) expected_[block_of({x, y, z})] = 1;
    last = next;
  }
}

bool collect_words(std::uint8_t* first, std::int64_t stride_y, std::int64_t stride_z, InstructionSet set,
                   std::uint64_t* words) {
  std::uint64_t masks[16];
  if (!take_masks(first, stride_y, stride_z, set, masks)) return false;
  arrange(masks, words);
  return true;
}

}  // namespace clearway
