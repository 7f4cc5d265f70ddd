#include "mapping/scans/surface_gaps.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace clearway {
namespace {

constexpr int columns = 2048, rows = 1024;  // of the finest image: a full turn by half a turn
constexpr float widest_gap = 0.0872F;       // sin 5 degrees, between two rays
constexpr int most_steps = 3;               // of the usual ones between two neighbours
constexpr float least_slant = 0.0140F;      // sin 0.8 degrees, between a ray and the surface
constexpr double trims_of_two = 2.0;  // by which two hits of one surface may differ in range for noise alone
constexpr int widest_step = 28;       // pixels: about 5 degrees
constexpr double farthest_cell = 32767.0;  // of a map
constexpr double widest_side = 8.0;        // voxels
constexpr double samples = 2.5;            // of a line in a voxel's width
constexpr float infinite = std::numeric_limits<float>::infinity();

/// atan2(y, x) but for 0.0003 radians, by arithmetic that all machines round alike.
float angle_of(float x, float y) {
  constexpr float turn = static_cast<float>(2 * M_PI);
  const float wide = std::abs(x), high = std::abs(y);
  const float slope = std::min(wide, high) / std::max({wide, high, std::numeric_limits<float>::min()});
  const float square = slope * slope;
  float angle = slope + slope * square * (-0.32762276F + square * (0.15931422F - 0.04649647F * square));
  if (high > wide) angle = 0.25F * turn - angle;
  if (x < 0.0F) angle = 0.5F * turn - angle;
  return y < 0.0F ? -angle : angle;
}

int index_of(float angle, int from, int count) {
  constexpr float per_radian = columns / static_cast<float>(2 * M_PI);
  return std::clamp(static_cast<int>(std::floor(angle * per_radian)) + from, 0, count - 1);
}

/// So many pixels may lie between neighbours.
int limit_of(int usual_step) { return usual_step > 0 ? most_steps * usual_step : widest_step; }

}  // namespace

/// The z axis, about which lidars turn, but for cameras, which look along it.
void SurfaceGaps::choose_pole(std::span<const Eigen::Vector3f> ways) {
  Eigen::Array3d sums = Eigen::Array3d::Zero();
  for (std::size_t i = 0; i < ways.size(); i += 1 + ways.size() / 1024) {
    const Eigen::Array3d way = ways[i].cast<double>().array().abs();
    if (way.isFinite().all()) sums += way / std::max(1e-9, way.matrix().norm());
  }
  const bool looks_along_z = sums.z() > std::max(sums.x(), sums.y());
  const int pole = !looks_along_z ? 2 : sums.y() <= sums.x() ? 1 : 0;
  axes_ = {(pole + 1) % 3, (pole + 2) % 3, pole};
}

/// @param apart of a run of ends that lie nearer than this to each other one is enough, metres
void SurfaceGaps::add(std::span<const Eigen::Vector3f> ways, bool are_hits, float apart) {
  const int u = axes_[0], v = axes_[1], w = axes_[2];
  Eigen::Vector3f last = Eigen::Vector3f::Constant(infinite);
  for (const Eigen::Vector3f& way : ways) {
    if ((way - last).squaredNorm() < apart * apart) continue;
    last = way;
    const float x = way[u], y = way[v], z = way[w];
    const float across = x * x + y * y, squared = across + z * z;
    if (!(squared > 0.0F && squared < infinite)) continue;
    const int column = index_of(angle_of(x, y), columns / 2, columns);
    const int row = index_of(angle_of(std::sqrt(across), z), rows / 2, rows);
    seen_.extend(Eigen::Vector2i(column, row));
    rays_.push_back(
        {way, squared, static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row), are_hits});
  }
}

void SurfaceGaps::draw() {
  const int first = seen_.min().x() / pixel_;
  width_ = seen_.max().x() / pixel_ - first + 1;
  height_ = seen_.sizes().y() + 1;
  words_ = (static_cast<std::size_t>(width_) + 63) / 64;
  drawn_.assign(words_ * static_cast<std::size_t>(height_), 0);
  image_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Ray& ray = rays_[i];
    const auto row = static_cast<std::size_t>(ray.row - seen_.min().y()),
               column = static_cast<std::size_t>(ray.column / pixel_ - first);
    std::uint64_t& word = drawn_[row * words_ + column / 64];
    const std::uint64_t bit = std::uint64_t{1} << column % 64;
    if ((word & bit) != 0) continue;
    word |= bit;
    image_[row * static_cast<std::size_t>(width_) + column] = static_cast<int>(i);
  }
}

/// Calls `visit(column, ray)` for each pixel of a row that a ray is drawn in: of two million they are few.
template <typename Visit>
void SurfaceGaps::visit_row(int row, const Visit& visit) const {
  const auto at = static_cast<std::size_t>(row);
  for (std::size_t word = 0; word < words_; ++word)
    for (std::uint64_t left = drawn_[at * words_ + word]; left != 0; left &= left - 1) {
      const std::size_t column = 64 * word + static_cast<std::size_t>(std::countr_zero(left));
      visit(static_cast<int>(column), image_[at * static_cast<std::size_t>(width_) + column]);
    }
}

/// Pixels from one with a hit to the next in its row (along) or its column: half of these steps are no
/// longer. 0 where there are none of at most widest_step.
int SurfaceGaps::usual_step(bool along) const {
  std::array<std::size_t, widest_step + 1> counts{};
  std::size_t all = 0;
  std::vector<int> last(static_cast<std::size_t>(along ? height_ : width_), none);
  for (int row = 0; row < height_; ++row) {
    visit_row(row, [&](int column, int ray) {
      if (!rays_[static_cast<std::size_t>(ray)].is_hit) return;
      const int at = along ? column : row;
      int& before = last[static_cast<std::size_t>(along ? row : column)];
      const int step = at - std::exchange(before, at);
      if (step <= std::min(at, widest_step)) ++counts[static_cast<std::size_t>(step)], ++all;
    });
  }
  std::size_t fewer = 0;
  for (int step = 1; step <= widest_step; ++step) {
    fewer += counts[static_cast<std::size_t>(step)];
    if (all > 0 && 2 * fewer >= all) return step;
  }
  return 0;
}

bool SurfaceGaps::are_neighbours(int a, int b) const {
  if (a == none || b == none) return false;
  const Ray &from = rays_[static_cast<std::size_t>(a)], &to = rays_[static_cast<std::size_t>(b)];
  return from.is_hit && to.is_hit && from.way.dot(to.way) > 0.0F &&
         from.way.cross(to.way).squaredNorm() <= widest_gap * widest_gap * from.squared * to.squared;
}

/// @param a, b neighbours
/// @param before, behind half the columns to the next pixels on both sides of the line
/// @return whether something lies between them
bool SurfaceGaps::add_gap(int a, int b, const GapSearch& search, double before, double behind) {
  const Ray &one = rays_[static_cast<std::size_t>(a)], &other = rays_[static_cast<std::size_t>(b)];
  const float near = std::sqrt(std::min(one.squared, other.squared)),
              far = std::sqrt(std::max(one.squared, other.squared));
  if (!(far - near > static_cast<float>(trims_of_two * search.margins.trim(far)))) return false;
  const Eigen::Vector3f &from = one.way, &to = other.way;
  const float length = (to - from).norm();
  if (!(length > static_cast<float>(search.resolution))) return false;
  if (!(from.cross(to).norm() >= least_slant * length * far)) return false;
  const Eigen::Isometry3d& pose = search.map_from_sensor;
  SurfaceGap gap{pose * from.cast<double>() / search.resolution, pose * to.cast<double>() / search.resolution,
                 Eigen::Vector3d::Zero(), 0.0, 0.0};
  const auto is_in_map = [](const Eigen::Vector3d& at) {
    return (at.array().abs() <= farthest_cell).all();  // else the scan does not hit it
  };
  if (!is_in_map(gap.from) || !is_in_map(gap.to)) return false;
  const double x = from[axes_[0]], y = from[axes_[1]], across = std::sqrt(x * x + y * y);
  if (before + behind > 0.0 && across > 0.0) {
    Eigen::Vector3d side = Eigen::Vector3d::Zero();
    side[axes_[0]] = -y / across, side[axes_[1]] = x / across;
    gap.side = pose.linear() * side;
    const double width = 2 * M_PI / columns * across / search.resolution;
    gap.before = std::min(before * width, widest_side), gap.behind = std::min(behind * width, widest_side);
  }
  gaps_.push_back(gap);
  return true;
}

/// Beyond the end of this gap that is nearer to the sensor, as far as the ray that ends there stays within a
/// voxel of the surface.
/// @param end of the gap, which no neighbour follows
void SurfaceGaps::go_on(const SurfaceGap& gap, const Eigen::Vector3d& end, const GapSearch& search) {
  const Eigen::Vector3d& other = end == gap.from ? gap.to : gap.from;
  const Eigen::Vector3d origin = search.map_from_sensor.translation() / search.resolution;
  const Eigen::Vector3d ray = end - origin, along = end - other;
  if (!(ray.norm() < (other - origin).norm())) return;
  const double slant = ray.cross(along).norm() / (ray.norm() * along.norm());
  SurfaceGap more = gap;
  more.from = end;
  more.to = end + std::min(1.0, 1.0 / (slant * along.norm())) * along;
  gaps_.push_back(more);
}

/// The rays of a row of the image that matter: a ray that hits nothing parts others only where it goes past
/// them.
void SurfaceGaps::gather_row(int row) {
  row_.clear();
  visit_row(row, [&](int, int ray) {
    if (row_.empty() || parts(row_.back(), ray)) row_.push_back(ray);
  });
}

/// Whether `ray` counts behind `last`.
bool SurfaceGaps::parts(int last, int ray) const {
  if (last == none || ray == none) return true;
  const Ray &before = rays_[static_cast<std::size_t>(last)], &now = rays_[static_cast<std::size_t>(ray)];
  return now.is_hit || !before.is_hit || now.squared >= before.squared;
}

/// From the `i`th of the row to the next one, over the seam, too.
int SurfaceGaps::step_from(std::size_t i) const {
  const std::size_t next = i + 1 < row_.size() ? i + 1 : 0;
  const auto column_of = [&](std::size_t at) {
    return rays_[static_cast<std::size_t>(row_[at])].column / pixel_;
  };
  const int turn = columns / pixel_;
  return (column_of(next) - column_of(i) + turn) % turn;
}

/// @param most pixels between neighbours
void SurfaceGaps::walk_rows(const GapSearch& search, int most) {
  for (int row = 0; row < height_; ++row) {
    gather_row(row);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      const int step = step_from(i), next = row_[i + 1 < row_.size() ? i + 1 : 0];
      if (0 < step && step <= most && are_neighbours(row_[i], next)) add_gap(row_[i], next, search, 0.0, 0.0);
    }
  }
}

/// @param along, most pixels between neighbours in a row, in a column
void SurfaceGaps::walk_columns(const GapSearch& search, int along, int most) {
  columns_.assign(static_cast<std::size_t>(width_), {});
  const auto half = [&](int step) { return 0.5 * pixel_ * (0 < step && step <= along ? step : 1); };
  for (int row = 0; row < height_; ++row) {
    gather_row(row);
    for (std::size_t i = 0; i < row_.size(); ++i) {
      const int at = rays_[static_cast<std::size_t>(row_[i])].column / pixel_ - seen_.min().x() / pixel_;
      Column& column = columns_[static_cast<std::size_t>(at)];
      if (!parts(column.last, row_[i])) continue;
      add_to(column, row_[i], most, search, half(step_from(i > 0 ? i - 1 : row_.size() - 1)),
             half(step_from(i)));
    }
  }
  for (Column& column : columns_) add_to(column, none, most, search, 0.0, 0.0);
}

/// @param most rows between neighbours
void SurfaceGaps::add_to(Column& column, int ray, int most, const GapSearch& search, double before,
                         double behind) {
  const bool goes_on =
      are_neighbours(column.last, ray) &&
      rays_[static_cast<std::size_t>(ray)].row - rays_[static_cast<std::size_t>(column.last)].row <= most;
  const auto is_clear = [&](int other) {
    return other != none && !rays_[static_cast<std::size_t>(other)].is_hit;
  };
  if (!goes_on && column.gap != none && !is_clear(ray)) {
    const SurfaceGap gap = gaps_[static_cast<std::size_t>(column.gap)];
    go_on(gap, gap.to, search);
  }
  const bool has_gap = goes_on && add_gap(column.last, ray, search, before, behind);
  const int added = has_gap ? static_cast<int>(gaps_.size()) - 1 : none;
  if (has_gap && column.begins) {
    const SurfaceGap gap = gaps_.back();
    go_on(gap, gap.from, search);
  }
  column = {ray, added, !goes_on && !is_clear(column.last)};
}

const std::vector<SurfaceGap>& SurfaceGaps::find(std::span<const Eigen::Vector3f> hits,
                                                 std::span<const Eigen::Vector3f> clear,
                                                 const GapSearch& search) {
  rays_.clear();
  gaps_.clear();
  seen_.setEmpty();
  choose_pole(hits);
  add(hits, true, static_cast<float>(0.25 * search.resolution));
  add(clear, false, 0.0F);
  if (rays_.empty()) return gaps_;
  pixel_ = 1;
  draw();
  int step = usual_step(true);
  walk_rows(search, limit_of(step));
  if (step > 1) {  // so that rays of each ring fall in each column
    pixel_ = step;
    draw();
    step = usual_step(true);
  }
  walk_columns(search, limit_of(step), limit_of(usual_step(false)));
  return gaps_;
}

namespace {

bool is_occupied(const FusedTree& tree, const Eigen::Vector3i& cell) {
  CellCube cube;
  const FusedNode* leaf = tree.find_leaf(cell, cube);
  return leaf != nullptr && leaf->observed() && tree.isNodeOccupied(leaf);
}

/// Nothing seen of the cell, or, where something is, not seen clearly.
void spare(const FusedTree* tree, const Eigen::Vector3i& cell, ScanGrid& grid) {
  ScanTile* const tile = grid.find(cell);
  if (tile == nullptr) return;
  const unsigned bit = ScanTile::bit_of(cell), word = bit >> 6U;
  const std::uint64_t mask = std::uint64_t{1} << (bit & 63U);
  if ((tile->free[word] & mask) == 0) {
    tile->spared[word] |= mask;
    return;
  }
  tile->clear[word] &= ~mask;
  if (tree != nullptr && is_occupied(*tree, cell)) return;
  tile->free[word] &= ~mask;
  tile->spared[word] |= mask;
}

}  // namespace

void spare_gaps(std::span<const SurfaceGap> gaps, const FusedTree* tree, ScanGrid& grid) {
  for (const SurfaceGap& gap : gaps) {
    const auto steps = static_cast<int>(std::ceil(samples * (gap.to - gap.from).norm()));
    const Eigen::Vector3d step = (gap.to - gap.from) / std::max(1, steps);
    const int first = -static_cast<int>(std::round(gap.before)),
              last = static_cast<int>(std::round(gap.behind));
    for (int i = 1; i < steps; ++i) {
      for (int k = first; k <= last; ++k) {
        const Eigen::Array3d cell = (gap.from + i * step + k * gap.side).array().floor();
        if ((cell.abs() <= farthest_cell).all()) spare(tree, cell.matrix().cast<int>(), grid);
      }
    }
  }
}

}  // namespace clearway
