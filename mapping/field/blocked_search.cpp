// The exact questions to a BlockedField: the nearest blocked cube, and the blocked voxels that meet a box.

#include <algorithm>
#include <stdexcept>

#include "mapping/field/blocked_field.hpp"
#include "mapping/field/field_look_up.hpp"

namespace clearway {
namespace {

double squared_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& low,
                        const Eigen::Vector3d& high) {
  return (point.cwiseMax(low).cwiseMin(high) - point).squaredNorm();
}

}  // namespace

/// Branch and bound over boxes of cells. A box is dropped when it is farther than the best cube so far, or
/// when the field at its middle cell says that nothing blocked lies as near as its farthest cell.
class BlockedField::Search {
 public:
  Search(const BlockedField& space, const Eigen::Vector3d& point, double limit)
      : space_(space), point_(point), best_squared_(limit * limit) {}

  bool found() const { return found_; }
  const Eigen::Vector3i& voxel() const { return voxel_; }

  void run(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    const double resolution = space_.cells_.resolution;
    const double distance = squared_distance(point_, low.cast<double>() * resolution,
                                             (high.array() + 1).cast<double>().matrix() * resolution);
    if (found_ ? distance >= best_squared_ : distance > best_squared_) return;
    const Eigen::Vector3i middle = low + (high - low) / 2;
    const std::uint16_t squared = space_.squared(middle);
    if (low == high) {
      if (squared == 0) {
        best_squared_ = distance;
        voxel_ = low;
        found_ = true;
      }
      return;
    }
    if (is_empty(low, high, middle, squared)) return;
    split(low, high);
  }

 private:
  static bool is_empty(const Eigen::Vector3i& low, const Eigen::Vector3i& high, const Eigen::Vector3i& middle,
                       std::uint16_t squared) {
    const Eigen::Array3i reach = (middle - low).cwiseMax(high - middle).array();
    const Eigen::Array3i gap = (2 * reach - 1).max(0);
    return int{squared} > gap.square().sum();
  }

  void split(const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const int below = low[axis] + (high[axis] - low[axis]) / 2;  // last cell of the lower half
    Eigen::Vector3i lower_high = high, upper_low = low;
    lower_high[axis] = below;
    upper_low[axis] = below + 1;
    const bool lower_first = point_[axis] < (below + 1) * space_.cells_.resolution;
    if (lower_first) run(low, lower_high);
    run(upper_low, high);
    if (!lower_first) run(low, lower_high);
  }

  const BlockedField& space_;
  Eigen::Vector3d point_;
  double best_squared_;
  Eigen::Vector3i voxel_ = Eigen::Vector3i::Zero();
  bool found_ = false;
};

NearestBlocked BlockedField::describe(const Eigen::Vector3d& point, const Eigen::Vector3i& voxel) const {
  NearestBlocked result;
  result.found = true;
  result.voxel = center(voxel);
  result.point = point.cwiseMax(voxel.cast<double>() * cells_.resolution)
                     .cwiseMin((voxel.array() + 1).cast<double>().matrix() * cells_.resolution);
  result.distance = (result.point - point).norm();
  if (result.distance > 0.0) result.direction = (result.point - point) / result.distance;
  return result;
}

/// The nearest cell beyond the region: the one that holds the point, or the one across the nearest face.
NearestBlocked BlockedField::nearest_outside(const Eigen::Vector3d& point) const {
  if (!box_.contains(point)) {
    NearestBlocked result;
    result.found = true;
    result.point = point;
    result.voxel = ((point * inverse_resolution_).array().floor() + 0.5) * cells_.resolution;
    return result;
  }
  int axis = 0;
  bool upper = false;
  distance_to_border(point, axis, upper);
  Eigen::Vector3i voxel = cell_near(point);
  voxel[axis] = upper ? cells_.first[axis] + cells_.size[axis] : cells_.first[axis] - 1;
  return describe(point, voxel);
}

NearestBlocked BlockedField::nearest(const Eigen::Vector3d& point, double limit) const {
  if (!point.allFinite() || !(limit >= 0.0)) {
    throw std::invalid_argument("nearest blocked voxel: expected a finite point and a limit >= 0 in metres");
  }
  limit = std::min(limit, cells_.max_distance);
  NearestBlocked best;
  if (outside_blocked_) {
    best = nearest_outside(point);
    if (best.distance > limit) best = {};
    if (best.found) limit = best.distance;
  }
  const Eigen::Vector3i cell = cell_near(point);
  if (squared(cell) < tiles_->cap()) {  // a blocked cube is at most this far
    const double known = half_roots()[squared(cell)] * cells_.resolution;
    limit = std::min(limit, (known + (point - center(cell)).norm()) * (1.0 + 1e-9));
  }
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(limit);
  if (squared_distance(point, box_.min(), box_.max()) > limit * limit) return best;
  Search search(*this, point, limit);
  search.run(cell_near(point - reach), cell_near(point + reach));
  if (!search.found()) return best;
  const NearestBlocked inside = describe(point, search.voxel());
  return best.found && best.distance <= inside.distance ? best : inside;
}

namespace {

/// Cells whose closed cubes meet a closed box: a face that only touches counts, and so does one within
/// rounding.
struct CellRange {
  Eigen::Array3d low, high;

  CellRange(const Eigen::AlignedBox3d& box, double inverse_resolution) {
    if (!box.min().allFinite() || !box.max().allFinite()) {
      throw std::invalid_argument("blocked voxels of a box: expected a finite box in metres");
    }
    low = (box.min().array() * inverse_resolution - 1.0 - 1e-9).ceil();
    high = (box.max().array() * inverse_resolution + 1e-9).floor();
  }
};

}  // namespace

bool BlockedField::visit_blocked(const Eigen::AlignedBox3d& box,
                                 const std::function<bool(const Eigen::Vector3d&)>& visit) const {
  if (box.isEmpty()) return true;
  auto [low, high] = CellRange(box, inverse_resolution_);
  const Eigen::Array3d first = cells_.first.cast<double>().array();
  const Eigen::Array3d last = first + cells_.size.cast<double>().array() - 1.0;
  const double* roots = half_roots();
  if (!outside_blocked_) {
    low = low.max(first);
    high = high.min(last);
  }
  for (double z = low.z(); z <= high.z(); ++z) {
    for (double y = low.y(); y <= high.y(); ++y) {
      const bool row_inside = z >= first.z() && z <= last.z() && y >= first.y() && y <= last.y();
      for (double x = low.x(); x <= high.x(); ++x) {
        const Eigen::Array3d cell(x, y, z);
        if (row_inside && x >= first.x() && x <= last.x()) {
          const std::uint16_t gap = squared(cell.matrix().cast<int>());
          if (gap > 0) {  // nothing blocked in this row for the next (sqrt(gap) - 1) / 2 cells
            x += static_cast<int>(roots[gap] - 0.5);
            if (x >= last.x() && outside_blocked_) x = last.x();
            continue;
          }
        }
        if (!visit((cell + 0.5) * cells_.resolution)) return false;
      }
    }
  }
  return true;
}

/// Words of the cells 32 lane to 32 lane + 31 at all y; beyond the region as the requirement has it.
struct BlockedField::Row {
  const std::uint32_t* words;  ///< null beyond the region
  std::uint32_t beyond, fill;  ///< a word, and the bits of a word, that are beyond it
  int size;

  std::uint32_t operator[](int y) const {
    return words == nullptr || y < 0 || y >= size ? beyond : words[y] | fill;
  }
};

BlockedField::Row BlockedField::row(int lane, int z) const {
  const BlockedCells& blocked = tiles_->blocked_nearby();
  const std::uint32_t beyond = outside_blocked_ ? ~0U : 0U;
  const int inside = cells_.size.x() - 32 * lane;
  const bool is_in = lane >= 0 && lane < blocked.lanes() && z >= 0 && z < cells_.size.z();
  return {is_in ? blocked.row(lane, z) : nullptr, beyond, inside >= 32 ? 0U : beyond << std::max(inside, 0),
          cells_.size.y()};
}

bool BlockedField::visit_surface(const Eigen::AlignedBox3d& box,
                                 const std::function<bool(const Eigen::Vector3d&)>& visit) const {
  if (box.isEmpty()) return true;
  // One layer around the region is enough: beyond it no voxel has a neighbour that is not blocked.
  const CellRange range(box, inverse_resolution_);
  const Eigen::Array3d first = cells_.first.cast<double>().array();
  const Eigen::Array3d size = cells_.size.cast<double>().array();
  const Eigen::Array3i low = (range.low - first).max(-1.0).min(size).cast<int>();
  const Eigen::Array3i high = (range.high - first).max(-1.0).min(size).cast<int>();
  if ((range.low - first > size).any() || (range.high - first < -1.0).any()) return true;
  tiles_->blocked_in((low - 1).matrix(), (high + 1).matrix());
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int lane = low.x() >> 5; lane <= high.x() >> 5; ++lane) {
      const int from = std::max(low.x() - 32 * lane, 0), to = std::min(high.x() - 32 * lane, 31);
      const std::uint32_t wanted = ~0U << from & ~0U >> (31 - to);
      const Row own = row(lane, z), left = row(lane - 1, z), right = row(lane + 1, z);
      const Row below = row(lane, z - 1), above = row(lane, z + 1);
      for (int y = low.y(); y <= high.y(); ++y) {
        const std::uint32_t here = own[y];
        if ((here & wanted) == 0) continue;
        const std::uint32_t around = (here << 1U | left[y] >> 31U) & (here >> 1U | right[y] << 31U);
        std::uint32_t surface = here & wanted & ~(around & own[y - 1] & own[y + 1] & below[y] & above[y]);
        for (; surface != 0; surface &= surface - 1) {
          const Eigen::Vector3i cell(32 * lane + __builtin_ctz(surface), y, z);
          if (!visit(center(cells_.first + cell))) return false;
        }
      }
    }
  }
  return true;
}

}  // namespace clearway
