#include "planning/survey/swept_voxels.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/survey/path_poses.hpp"
#include "planning/survey/voxel_marks.hpp"

namespace clearway {
namespace {

Eigen::Vector3d center_of(const Cell& cell, double edge) {
  return (cell.cast<double>().array() + 0.5) * edge;
}

/// One look lowers the log-odds of a voxel by that much; maps of other sources have log-odds of any size.
bool is_seen_once(const Voxel& voxel, double one_look) {
  return voxel.observed && voxel.log_odds >= -one_look * (1.0 + 1e-5);
}

/// Of the voxels that were seen free: how long before the map's newest look each was last seen, at most.
class LookAges {
 public:
  explicit LookAges(const Snapshot& map) : map_(map) {}

  /// @return whether the map knows when it was seen
  bool add(const Eigen::Vector3d& center) {
    const std::optional<double> seen = map_.seen() ? map_.last_seen(center) : std::nullopt;
    is_known_ = is_known_ && seen.has_value();
    if (seen) oldest_ = std::max(oldest_.value_or(0.0), map_.seen()->newest() - *seen);
    return seen.has_value();
  }

  std::optional<double> oldest() const { return is_known_ ? oldest_ : std::nullopt; }

 private:
  const Snapshot& map_;
  bool is_known_ = true;
  std::optional<double> oldest_;
};

void count_voxel(const Snapshot& map, const Eigen::AlignedBox3d& bounds, const Eigen::Vector3d& center,
                 SweptVoxels& swept, LookAges& ages) {
  const Voxel voxel = map.voxel(center);
  bool has_look = false;
  switch (voxel.state) {
    case VoxelState::painted:
      ++swept.painted;
      return;
    case VoxelState::seen_free:
      ++swept.seen_free;
      has_look = ages.add(center);
      swept.maybe_by_hand +=
          map.tree().hand_edits().freed > 0 && (!has_look || voxel.log_odds == map.tree().by_hand_log_odds());
      swept.seen_once += is_seen_once(voxel, map.log_odds_of_a_look());
      return;
    case VoxelState::occupied:
    case VoxelState::conflict:
      ++swept.occupied;
      return;
    case VoxelState::unknown:
      ++swept.unknown;
      swept.beyond += !bounds.contains(center);
  }
}

SweptVoxels counts_of_marks(const Snapshot& map, const VoxelMarks& marks) {
  const double edge = marks.edge();
  const Eigen::AlignedBox3d bounds = map.bounds();
  SweptVoxels swept;
  LookAges ages(map);
  swept.edge = edge;
  const auto look_into = [&](const Cell& first, std::size_t voxels) {
    const Eigen::Vector3d low = first.cast<double>() * edge;
    const Eigen::AlignedBox3d brick(low, low.array() + VoxelMarks::brick_edge * edge);
    if (!bounds.isEmpty() && bounds.intersects(brick)) return true;
    swept.unknown += voxels;
    swept.beyond += voxels;
    return false;
  };
  marks.visit(look_into,
              [&](const Cell& cell) { count_voxel(map, bounds, center_of(cell, edge), swept, ages); });
  swept.oldest_look = ages.oldest();
  return swept;
}

}  // namespace

double SweptVoxels::litres(std::size_t voxels) const {
  return static_cast<double>(voxels) * edge * edge * edge * 1000.0;
}

double SweptVoxels::share(std::size_t voxels) const {
  return total() == 0 ? 0.0 : static_cast<double>(voxels) / static_cast<double>(total());
}

std::optional<SweptVoxels> swept_voxels(const Robot& robot, const Snapshot& map,
                                        const std::vector<Configuration>& path) {
  if (path.empty()) return std::nullopt;
  const check::KdlArm arm(without_file(robot));
  VoxelMarks marks(map.resolution());
  bool is_countable = true;
  for (std::size_t body = 0; body < robot.bodies.size() && is_countable; ++body) {
    if (!arm.is_policed(body)) continue;
    const MarkedShape shape(robot.bodies[body].shape);
    visit_body_poses(arm, body, path, map.resolution(), [&](const Eigen::Isometry3d& pose, const PathPlace&) {
      is_countable = is_countable && marks.mark(shape, pose);
    });
  }
  if (!is_countable) return std::nullopt;
  return counts_of_marks(map, marks);
}

namespace {

/// A body that no joint moves, where it stands.
struct Standing {
  MarkedShape shape;
  Eigen::Isometry3d pose;
  Eigen::AlignedBox3d box;
  StandingContact contact;
};

std::vector<Standing> standing_bodies(const Robot& robot) {
  const check::KdlArm arm(without_file(robot));
  check::BodyPoses poses;
  arm.place(Configuration::Zero(static_cast<Eigen::Index>(robot.dof())), poses);
  std::vector<Standing> standing;
  for (std::size_t body = 0; body < robot.bodies.size(); ++body) {
    if (arm.is_policed(body)) continue;
    const Shape& shape = robot.bodies[body].shape;
    standing.push_back({MarkedShape(shape),
                        poses[body],
                        shape.bounds(poses[body]),
                        {robot.bodies[body].part, 0, Eigen::Vector3d::Zero()}});
  }
  return standing;
}

/// Looks at the voxels of an occupied leaf, which may be a cube of many.
void touch_leaf(const Voxel& leaf, double edge, Standing& body) {
  const Eigen::Vector3d low = leaf.center.array() - leaf.size / 2;
  const auto across = static_cast<int>(std::lround(leaf.size / edge));
  const Eigen::Array3d begin = ((body.box.min() - low).array() / edge - 1.0).floor().max(0.0);
  const Eigen::Array3d end = ((body.box.max() - low).array() / edge + 1.0).ceil().min(across);
  for (int z = static_cast<int>(begin.z()); z < static_cast<int>(end.z()); ++z) {
    for (int y = static_cast<int>(begin.y()); y < static_cast<int>(end.y()); ++y) {
      for (int x = static_cast<int>(begin.x()); x < static_cast<int>(end.x()); ++x) {
        const Eigen::Vector3d center = low + edge * (Eigen::Vector3d(x, y, z).array() + 0.5).matrix();
        if (!body.shape.touches(body.pose, center, edge)) continue;
        const auto order = [](const Eigen::Vector3d& p) { return std::tuple(p.z(), p.y(), p.x()); };
        StandingContact& contact = body.contact;
        if (contact.voxels == 0 || order(center) < order(contact.lowest)) contact.lowest = center;
        ++contact.voxels;
      }
    }
  }
}

}  // namespace

std::vector<StandingContact> standing_contacts(const Robot& robot, const Snapshot& map) {
  std::vector<Standing> standing = standing_bodies(robot);
  const Eigen::AlignedBox3d bounds = map.bounds();
  std::erase_if(standing, [&](const Standing& body) { return !bounds.intersects(body.box); });
  if (standing.empty()) return {};
  Eigen::AlignedBox3d all;
  for (const Standing& body : standing) all.extend(body.box);
  map.visit_leaves(all, [&](const Voxel& leaf) {
    if (leaf.state != VoxelState::occupied && leaf.state != VoxelState::conflict) return;
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(leaf.size / 2);
    const Eigen::AlignedBox3d cube(leaf.center - half, leaf.center + half);
    for (Standing& body : standing) {
      if (cube.intersects(body.box)) touch_leaf(leaf, map.resolution(), body);
    }
  });
  std::vector<StandingContact> contacts;
  for (Standing& body : standing) {
    if (body.contact.voxels > 0) contacts.push_back(std::move(body.contact));
  }
  return contacts;
}

}  // namespace clearway
