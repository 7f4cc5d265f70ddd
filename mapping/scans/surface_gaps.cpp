#include "mapping/scans/surface_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {
namespace {

constexpr int columns = 2048, rows = 1024;  // of the image: a full turn by half a turn
constexpr float widest_gap = 0.0872F;       // sin 5 degrees, between two rays
constexpr float least_slant = 0.0140F;      // sin 0.8 degrees, between a ray and the surface
constexpr double trims_of_two = 2.0;  // by which two hits of one surface may differ in range for noise alone
constexpr int widest_step = 28;       // columns: about 5 degrees
constexpr double widest_side = 8.0;   // voxels
constexpr float infinite = std::numeric_limits<float>::infinity();

/// Grows with the angle of (x, y), from 0 to 4 in a full turn, by arithmetic that all machines round alike.
float turn_of(float x, float y) {
  const float sum = std::abs(x) + std::abs(y);
  const float part = y / std::max(sum, std::numeric_limits<float>::min());
  if (x < 0.0F) return 2.0F - part;
  return part < 0.0F ? 4.0F + part : part;
}

/// Metres between two columns at this place: turn_of is no angle.
double column_width(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  return 4.0 / columns * sum * sum / std::max(1e-9, std::sqrt(x * x + y * y));
}

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

/// @param farthest longer ways hit nothing, metres
/// @param apart of a run of ends that lie nearer than this to each other one is enough, metres
void SurfaceGaps::add(std::span<const Eigen::Vector3f> ways, float farthest, float apart) {
  const int u = axes_[0], v = axes_[1], w = axes_[2];
  const float longest = farthest * farthest;
  Eigen::Vector3f last = Eigen::Vector3f::Constant(infinite);
  for (const Eigen::Vector3f& way : ways) {
    if ((way - last).squaredNorm() < apart * apart) continue;
    last = way;
    const float x = way[u], y = way[v], z = way[w];
    const float across = x * x + y * y, squared = across + z * z;
    if (!(squared > 0.0F && squared < infinite)) continue;
    const float height = z / (std::sqrt(across) + std::abs(z));
    const int column = (static_cast<int>(turn_of(x, y) * (columns / 4)) + columns / 2) % columns;
    const int row = std::min(rows - 1, static_cast<int>((height + 1.0F) * (rows / 2)));
    seen_.extend(Eigen::Vector2i(column, row));
    rays_.push_back({way, squared, static_cast<std::uint16_t>(column), static_cast<std::uint16_t>(row),
                     squared <= longest});
  }
}

void SurfaceGaps::draw() {
  const int width = seen_.sizes().x() + 1;
  image_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(seen_.sizes().y() + 1), none);
  for (std::size_t i = 0; i < rays_.size(); ++i) {
    const Ray& ray = rays_[i];
    int& pixel =
        image_[static_cast<std::size_t>((ray.row - seen_.min().y()) * width + ray.column - seen_.min().x())];
    if (pixel == none) pixel = static_cast<int>(i);
  }
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
  const double x = from[axes_[0]], y = from[axes_[1]], across = std::sqrt(x * x + y * y);
  if (before + behind > 0.0 && across > 0.0) {
    Eigen::Vector3d side = Eigen::Vector3d::Zero();
    side[axes_[0]] = -y / across, side[axes_[1]] = x / across;
    gap.side = pose.linear() * side;
    const double width = column_width(x, y) / search.resolution;
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

/// Each pixel with the next in its row, and the last in its column.
void SurfaceGaps::walk(const GapSearch& search) {
  columns_.assign(columns, {});
  const auto width = static_cast<std::size_t>(seen_.sizes().x() + 1);
  const auto column_of = [&](std::size_t i) {
    return static_cast<int>(rays_[static_cast<std::size_t>(row_[i])].column);
  };
  const auto half = [](int step) { return step <= widest_step ? 0.5 * step : 0.5; };
  for (std::size_t begin = 0; begin < image_.size(); begin += width) {
    row_.clear();
    for (std::size_t i = begin; i < begin + width; ++i) {
      if (image_[i] != none) row_.push_back(image_[i]);
    }
    const std::size_t count = row_.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t next = (i + 1) % count, last = (i + count - 1) % count;
      const int step = (column_of(next) - column_of(i) + columns) % columns;  // over the seam, too
      const int last_step = (column_of(i) - column_of(last) + columns) % columns;
      if (0 < step && step < columns / 2 && are_neighbours(row_[i], row_[next]))
        add_gap(row_[i], row_[next], search, 0.0, 0.0);
      add_to(columns_[static_cast<std::size_t>(column_of(i))], row_[i], search, half(last_step), half(step));
    }
  }
  for (Column& column : columns_) add_to(column, none, search, 0.0, 0.0);
}

void SurfaceGaps::add_to(Column& column, int ray, const GapSearch& search, double before, double behind) {
  const bool goes_on = are_neighbours(column.last, ray);
  if (!goes_on && column.gap != none) {
    const SurfaceGap gap = gaps_[static_cast<std::size_t>(column.gap)];
    go_on(gap, gap.to, search);
  }
  const bool has_gap = goes_on && add_gap(column.last, ray, search, before, behind);
  const int added = has_gap ? static_cast<int>(gaps_.size()) - 1 : none;
  if (has_gap && column.begins) {
    const SurfaceGap gap = gaps_.back();
    go_on(gap, gap.from, search);
  }
  column = {ray, added, !goes_on};
}

const std::vector<SurfaceGap>& SurfaceGaps::find(std::span<const Eigen::Vector3f> hits,
                                                 std::span<const Eigen::Vector3f> clear,
                                                 const GapSearch& search) {
  rays_.clear();
  gaps_.clear();
  seen_.setEmpty();
  choose_pole(hits);
  const auto apart = static_cast<float>(0.25 * search.resolution);
  add(hits, search.max_range > 0.0 ? static_cast<float>(search.max_range) : infinite, apart);
  add(clear, 0.0F, 0.0F);
  if (rays_.empty()) return gaps_;
  draw();
  walk(search);
  return gaps_;
}

void spare_gaps(std::span<const SurfaceGap> gaps, ScanGrid& grid) {
  const auto take_out = [&](const Eigen::Vector3d& at) {
    const Eigen::Array3d floor = at.array().floor();
    if ((floor < -32768.0).any() || (floor > 32767.0).any()) return;
    const Eigen::Vector3i cell = floor.matrix().cast<int>();
    ScanTile* const tile = grid.find(cell);
    if (tile == nullptr) return;
    const unsigned bit = ScanTile::bit_of(cell);
    const std::uint64_t mask = std::uint64_t{1} << (bit & 63U);
    tile->free[bit >> 6U] &= ~mask;
    tile->clear[bit >> 6U] &= ~mask;
    tile->spared[bit >> 6U] |= mask;
  };
  for (const SurfaceGap& gap : gaps) {
    const double steps = std::ceil(2.5 * (gap.to - gap.from).norm());
    const Eigen::Vector3d step = (gap.to - gap.from) / std::max(1.0, steps);
    const double first = -std::round(gap.before), last = std::round(gap.behind);
    for (double i = 1.0; i < steps; i += 1.0) {
      for (double k = first; k <= last; k += 1.0) take_out(gap.from + i * step + k * gap.side);
    }
  }
}

}  // namespace clearway
