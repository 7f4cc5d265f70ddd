#include "planning/constraint/near_voxels.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clearway {
namespace {

/// Voxels from a sphere's own to those from which it is looked round.
constexpr int look_round = 3;
/// Voxels that are asked for a sphere that is close: the eight about its middle, and one on each side.
constexpr std::size_t looks = 14;

constexpr std::array<VoxelKey, 8> corners = [] {
  std::array<VoxelKey, 8> steps{};
  for (int i = 0; i < 8; ++i) steps[static_cast<std::size_t>(i)] = voxel_step(i & 1, i >> 1 & 1, i >> 2);
  return steps;
}();
constexpr std::array<VoxelKey, 6> ways{voxel_step(look_round, 0, 0), voxel_step(-look_round, 0, 0),
                                       voxel_step(0, look_round, 0), voxel_step(0, -look_round, 0),
                                       voxel_step(0, 0, look_round), voxel_step(0, 0, -look_round)};

double distance_to(const Eigen::Vector3d& cube, double half, const Eigen::Vector3d& point) {
  const auto beyond = [&](int axis) { return std::max(std::abs(point[axis] - cube[axis]) - half, 0.0); };
  const double x = beyond(0), y = beyond(1), z = beyond(2);
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

NearVoxels::NearVoxels(const BlockedSpace& space)
    : space_(space), nearest_(space), resolution_(space.resolution()) {}

void NearVoxels::add(const Eigen::AlignedBox3d& reach_box, std::size_t spheres) {
  Reach reach{reach_box, {}, {}};
  const double half = 0.5 * resolution_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto middle = [&](int i) { return (i + 0.5) * resolution_; };
    const double least = std::clamp(reach_box.min()[axis], -farthest(), farthest());
    const double most = std::clamp(reach_box.max()[axis], -farthest(), farthest());
    int& low = reach.low[axis] = whole_below(least / resolution_) - 2;
    while (middle(low) + half < least) ++low;
    int& high = reach.high[axis] = whole_below(most / resolution_) + 2;
    while (middle(high) - half > most) --high;
  }
  reaches_.push_back(reach);
  most_spheres_ += spheres;
  for (std::vector<VoxelKey>* vector : {&voxels_, &cubes_}) vector->reserve(looks * most_spheres_);
  first_.reserve(most_spheres_ + 1);
  gathered_.reserve(looks * most_spheres_);
  make_room(looks * spheres);
}

void NearVoxels::look(std::span<const NearSphere> spheres) {
  voxels_.resize(looks * spheres.size());
  first_.clear();
  std::size_t count = 0;
  for (const NearSphere& sphere : spheres) {
    first_.push_back(count);
    const double most = farthest() / resolution_;  // beyond lies no voxel of a map
    const Eigen::Vector3d at = (sphere.center / resolution_).cwiseMax(-most).cwiseMin(most);
    const VoxelKey own = voxel_key({whole_below(at.x()), whole_below(at.y()), whole_below(at.z())});
    if (!sphere.is_close) {
      voxels_[count++] = own;
      continue;
    }
    const VoxelKey low =
        voxel_key({whole_below(at.x() - 0.5), whole_below(at.y() - 0.5), whole_below(at.z() - 0.5)});
    for (const VoxelKey corner : corners) voxels_[count++] = low + corner;
    for (const VoxelKey way : ways) voxels_[count++] = own + way;
  }
  first_.push_back(count);
  voxels_.resize(count);
  cubes_.resize(count);
  nearest_.look_up(voxels_, cubes_);
}

std::span<const NearVoxel> NearVoxels::gather(std::span<const NearSphere> spheres, std::size_t first,
                                              std::size_t last) {
  gathered_.clear();
  known_count_ = 0;
  if (++turn_ == 0) {  // it has gone round
    std::fill(known_.begin(), known_.end(), Known{});
    turn_ = 1;
  }
  for (std::size_t i = first; i < last; ++i) {
    gather(spheres[i], static_cast<int>(i - first),
           std::span(cubes_).subspan(first_[i], first_[i + 1] - first_[i]));
  }
  return gathered_;
}

void NearVoxels::gather(const NearSphere& sphere, int which, std::span<const VoxelKey> cubes) {
  const double within = sphere.radius + sphere.reach, half = 0.5 * resolution_;
  if (within + look_round * resolution_ > space_.max_distance()) return visit(sphere, within);
  make_room(looks);
  const Reach& reach = reaches_[static_cast<std::size_t>(sphere.body)];
  // Neighbours mostly see the same cube: each run of equal ones counts once. Branches that none foresees cost
  // more than what they spare.
  std::array<VoxelKey, looks> runs;
  std::size_t run_count = 0;
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    runs[run_count] = cubes[i];
    run_count += i + 1 == cubes.size() || cubes[i + 1] != cubes[i] ? 1 : 0;
  }
  std::array<Known*, looks> seen;
  std::size_t seen_count = 0;
  for (std::size_t i = 0; i < run_count; ++i) {
    if (runs[i] == no_voxel) continue;
    Known& cube = known(runs[i], reach);
    seen[seen_count] = &cube;
    seen_count += cube.sphere != which ? 1 : 0;
    cube.sphere = which;
  }
  std::array<double, looks> apart;
  double nearest = within;
  bool hides_some = false;
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen_count; ++i) {
    const double distance = distance_to(seen[i]->center, half, sphere.center);
    const bool is_near = distance < within, counts = is_near && seen[i]->is_in_reach;
    hides_some |= is_near && !counts;
    nearest = counts ? std::min(nearest, distance) : nearest;
    apart[count] = distance;
    seen[count] = seen[i];
    count += counts ? 1 : 0;
  }
  if (hides_some) return visit(sphere, count > 0 ? std::min(within, nearest + 2.0 * resolution_) : within);
  for (std::size_t i = 0; i < count; ++i) add_cube(*seen[i], sphere, apart[i] - nearest);
}

NearVoxels::Known& NearVoxels::known(VoxelKey key, const Reach& reach) {
  const std::size_t mask = known_.size() - 1;
  for (std::size_t i = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15U) >> 44U);; ++i) {
    Known& place = known_[i & mask];
    if (place.turn == turn_ && place.key == key) return place;
    if (place.turn == turn_) continue;
    ++known_count_;
    const Eigen::Vector3i voxel = voxel_of(key);
    return place = {key, turn_, -1, -1, reach.holds(voxel), center_of(voxel)};
  }
}

/// So that no more than half of the table is in use. Places move.
void NearVoxels::make_room(std::size_t more) {
  if (2 * (known_count_ + more) <= known_.size()) return;
  std::vector<Known> before(64);
  while (before.size() < 2 * (known_count_ + more)) before.resize(2 * before.size());
  before.swap(known_);
  known_count_ = 0;
  for (const Known& cube : before) {
    if (cube.turn != turn_ || cube.key == no_voxel) continue;
    std::size_t i = static_cast<std::size_t>((cube.key * 0x9e3779b97f4a7c15U) >> 44U);
    while (known_[i & (known_.size() - 1)].turn == turn_) ++i;
    known_[i & (known_.size() - 1)] = cube;
    ++known_count_;
  }
}

/// The same, cube by cube, where the field does not decide: beyond its max_distance, or when what is nearest
/// cannot be reached and hides what can, as a floor under a sliding disc does.
void NearVoxels::visit(const NearSphere& sphere, double within) {
  const Eigen::AlignedBox3d box =
      Eigen::AlignedBox3d(sphere.center.array() - within, sphere.center.array() + within)
          .intersection(reaches_[static_cast<std::size_t>(sphere.body)].box);
  if (box.isEmpty()) return;
  struct Visit {  // referred to by one pointer, so that the visitor needs no memory of its own
    std::vector<Eigen::Vector3d>& visited;
    const NearSphere& sphere;
    double half, within, nearest;
  } visit{visited_, sphere, 0.5 * resolution_, within, within};
  visited_.clear();
  space_.visit_surface(box, [&visit](const Eigen::Vector3d& cube) {
    const double distance = distance_to(cube, visit.half, visit.sphere.center);
    if (distance < visit.within) visit.visited.push_back(cube);
    visit.nearest = std::min(visit.nearest, distance);
    return true;
  });
  make_room(visited_.size());
  for (const Eigen::Vector3d& cube : visited_) {
    const Eigen::Vector3d at = cube / resolution_;
    const Eigen::Vector3i voxel(whole_below(at.x()), whole_below(at.y()), whole_below(at.z()));
    add_cube(known(voxel_key(voxel), reaches_[static_cast<std::size_t>(sphere.body)]), sphere,
             distance_to(cube, visit.half, sphere.center) - visit.nearest);
  }
}

void NearVoxels::add_cube(Known& known, const NearSphere& sphere, double behind) {
  if (known.place < 0) {
    known.place = static_cast<std::int32_t>(gathered_.size());
    gathered_.push_back({known.center, sphere.center, behind});
    return;
  }
  NearVoxel& gathered = gathered_[static_cast<std::size_t>(known.place)];
  if (behind >= gathered.behind) return;
  gathered.towards = sphere.center;
  gathered.behind = behind;
}

}  // namespace clearway
