// Look-ups of many points in a BlockedField, and the one from a single cell.

#include "mapping/field/field_look_up.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "mapping/field/blocked_field.hpp"

namespace clearway {
namespace {

void check_lengths(const PointArrays& points, std::span<double> out) {
  const std::size_t count = points.x.size();
  if (points.y.size() == count && points.z.size() == count && out.size() == count) return;
  throw std::invalid_argument("clearance of many points: x, y, z and out hold " + std::to_string(count) +
                              ", " + std::to_string(points.y.size()) + ", " +
                              std::to_string(points.z.size()) + " and " + std::to_string(out.size()) +
                              " numbers, expected as many each");
}

FieldPoints part_of(const PointArrays& points, std::size_t begin, std::size_t count) {
  return {points.x.data() + begin, points.y.data() + begin, points.z.data() + begin, count};
}

/// Few enough that points and bounds stay in the first cache between the two passes.
constexpr std::size_t batch = 256;

/// Bounds of the points of a batch, or left_out.
using LookUpMany = void (*)(const FieldLookUp& field, const FieldPoints& points, double* out);

void leave_all_out(const FieldLookUp& /*field*/, const FieldPoints& points, double* out) {
  std::fill_n(out, points.count, left_out);
}

struct Variants {
  LookUpMany avx2 = leave_all_out, avx512 = leave_all_out;

  LookUpMany of(InstructionSet vectors) const {
    if (vectors == InstructionSet::portable) return leave_all_out;
    return vectors == InstructionSet::avx512 ? avx512 : avx2;
  }
};

#ifdef __x86_64__
constexpr Variants tight_variants{clearances_avx2, clearances_avx512};
constexpr Variants coarse_variants{coarse_clearances_avx2, coarse_clearances_avx512};
#else
constexpr Variants tight_variants, coarse_variants;
#endif

/// Looks up batch after batch with `many`, and what that leaves out with `one`.
template <class One>
void look_up_all(const FieldLookUp& field, const PointArrays& points, std::span<double> out, LookUpMany many,
                 const One& one) {
  check_lengths(points, out);
  for (std::size_t begin = 0; begin < out.size(); begin += batch) {
    const std::size_t end = std::min(begin + batch, out.size());
    many(field, part_of(points, begin, end - begin), &out[begin]);
    for (std::size_t i = begin; i < end; ++i) {
      if (out[i] == left_out) out[i] = one(Eigen::Vector3d(points.x[i], points.y[i], points.z[i]));
    }
  }
}

}  // namespace

const double* half_roots() {
  static const std::vector<double> roots = [] {
    std::vector<double> table;
    for (unsigned squared = 0; squared < 65536; ++squared) table.push_back(0.5 * std::sqrt(double(squared)));
    return table;
  }();
  return roots.data();
}

FieldLookUp BlockedField::look_up() const {
  FieldLookUp field;
  field.tiles = tiles_->known_tiles();
  field.tiles_x = tiles_->tile_counts().x();
  field.tiles_y = tiles_->tile_counts().y();
  for (int axis = 0; axis < 3; ++axis) {
    field.last[axis] = cells_.size[axis] - 1;
    field.first[axis] = cells_.first[axis];
    field.low[axis] = box_.min()[axis];
    field.high[axis] = box_.max()[axis];
  }
  field.resolution = cells_.resolution;
  field.inverse_resolution = inverse_resolution_;
  field.max_distance = cells_.max_distance;
  field.outside_blocked = outside_blocked_;
  return field;
}

double BlockedField::coarse_clearance(const Eigen::Vector3d& point) const {
  double gap_squared = 0.0, largest = 0.0, border = HUGE_VAL;
  std::array<int, 3> cell{};
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double coordinate = point[axis], low = box_.min()[axis], high = box_.max()[axis];
    if (!std::isfinite(coordinate)) return 0.0;
    const double nearest = std::min(std::max(coordinate, low), high);
    inside = inside && nearest == coordinate;
    const double at = nearest * inverse_resolution_ - cells_.first[axis];
    const int i = std::min(static_cast<int>(at), cells_.size[axis] - 1);
    const double gap = at - i - 0.5;
    gap_squared += gap * gap;
    cell[static_cast<std::size_t>(axis)] = i;
    largest = std::max(largest, std::abs(coordinate));
    border = std::min(border, std::min(nearest - low, high - nearest));
  }
  if (outside_blocked_ && !inside) return 0.0;
  const double best = half_roots()[tiles_->squared(cell[0], cell[1], cell[2])] - std::sqrt(gap_squared);
  double bound = best * cells_.resolution;
  if (outside_blocked_) bound = std::min(bound, border);
  return std::clamp(bound - (rounding_of_voxel * cells_.resolution + rounding_of_coordinate * largest), 0.0,
                    cells_.max_distance);
}

bool BlockedField::is_voxel_blocked(const Eigen::Vector3i& voxel) const {
  const int x = voxel.x() - cells_.first.x(), y = voxel.y() - cells_.first.y(),
            z = voxel.z() - cells_.first.z();
  const bool is_inside =
      x >= 0 && y >= 0 && z >= 0 && x < cells_.size.x() && y < cells_.size.y() && z < cells_.size.z();
  return is_inside ? tiles_->is_blocked(x, y, z) : outside_blocked_;
}

std::array<int, 7> BlockedField::squared_around(const Eigen::Vector3i& voxel) const {
  const int x = voxel.x() - cells_.first.x(), y = voxel.y() - cells_.first.y(),
            z = voxel.z() - cells_.first.z();
  const int last_x = cells_.size.x() - 1, last_y = cells_.size.y() - 1, last_z = cells_.size.z() - 1;
  const int border = std::min({x, y, z, last_x - x, last_y - y, last_z - z});
  // The border is too far to count.
  if (border > 0 && (!outside_blocked_ || (2 * border - 1) * (2 * border - 1) >= tiles_->cap())) {
    const DistanceTiles& cells = *tiles_;
    const std::uint16_t* const row = cells.line(x >> 5, y, z);
    const int in_row = x & 31;
    return {row[in_row],
            in_row > 0 ? row[in_row - 1] : cells.squared(x - 1, y, z),
            in_row < 31 ? row[in_row + 1] : cells.squared(x + 1, y, z),
            cells.squared(x, y - 1, z),
            cells.squared(x, y + 1, z),
            cells.squared(x, y, z - 1),
            cells.squared(x, y, z + 1)};
  }
  const auto one = [&](int i, int j, int k) {
    const int within = std::min({i, j, k, last_x - i, last_y - j, last_z - k});
    if (within < 0) return outside_blocked_ ? 0 : -1;
    const int squared = tiles_->squared(i, j, k);
    return outside_blocked_ ? std::min(squared, (2 * within + 1) * (2 * within + 1)) : squared;
  };
  return {one(x, y, z),     one(x - 1, y, z), one(x + 1, y, z), one(x, y - 1, z),
          one(x, y + 1, z), one(x, y, z - 1), one(x, y, z + 1)};
}

void BlockedField::clearances(const PointArrays& points, std::span<double> out,
                              InstructionSet vectors) const {
  look_up_all(look_up(), points, out, tight_variants.of(vectors),
              [this](const Eigen::Vector3d& point) { return clearance(point); });
}

void BlockedField::coarse_clearances(const PointArrays& points, std::span<double> out,
                                     InstructionSet vectors) const {
  look_up_all(look_up(), points, out, coarse_variants.of(vectors),
              [this](const Eigen::Vector3d& point) { return coarse_clearance(point); });
}

void BlockedField::clearances(const PointArrays& points, std::span<double> out) const {
  clearances(points, out, best_instruction_set());
}

void BlockedField::coarse_clearances(const PointArrays& points, std::span<double> out) const {
  coarse_clearances(points, out, best_instruction_set());
}

}  // namespace clearway
