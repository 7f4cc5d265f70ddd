#include "planning/ball_cubes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clearway {
namespace {

/// Voxels from a ball's own to those from which it is looked round.
constexpr int look_round = 3;
/// Voxels that are asked for a ball that is close: the eight about its middle, and one on each side.
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

BallCubes::BallCubes(const BlockedSpace& space, double reach)
    : space_(space), nearest_(space), reach_(reach), resolution_(space.resolution()) {}

void BallCubes::add(const Eigen::AlignedBox3d& reach_box, std::size_t balls) {
  Reach reach{reach_box, {}, {}};
  const double half = 0.5 * resolution_;
  for (int axis = 0; axis < 3; ++axis) {
    const auto middle = [&](int i) { return (i + 0.5) * resolution_; };
    int& low = reach.low[axis] = whole_below(reach_box.min()[axis] / resolution_) - 2;
    while (middle(low) + half < reach_box.min()[axis]) ++low;
    int& high = reach.high[axis] = whole_below(reach_box.max()[axis] / resolution_) + 2;
    while (middle(high) - half > reach_box.max()[axis]) --high;
  }
  reaches_.push_back(reach);
  most_balls_ += balls;
  for (std::vector<VoxelKey>* vector : {&voxels_, &cubes_}) vector->reserve(looks * most_balls_);
  first_.reserve(most_balls_ + 1);
  gathered_.reserve(looks * most_balls_);
  known_.reserve(looks * most_balls_);
}

void BallCubes::look(std::span<const NearBall> balls) {
  voxels_.clear();
  first_.clear();
  for (const NearBall& ball : balls) {
    first_.push_back(voxels_.size());
    const Eigen::Vector3d at = ball.center / resolution_;
    const VoxelKey own = voxel_key({whole_below(at.x()), whole_below(at.y()), whole_below(at.z())});
    if (!ball.is_close) {
      voxels_.push_back(own);
      continue;
    }
    const VoxelKey low =
        voxel_key({whole_below(at.x() - 0.5), whole_below(at.y() - 0.5), whole_below(at.z() - 0.5)});
    for (const VoxelKey corner : corners) voxels_.push_back(low + corner);
    for (const VoxelKey way : ways) voxels_.push_back(own + way);
  }
  first_.push_back(voxels_.size());
  cubes_.resize(voxels_.size());
  nearest_.look_up(voxels_, cubes_);
}

std::span<const BodyCube> BallCubes::gather(std::span<const NearBall> balls, std::size_t first,
                                            std::size_t last) {
  gathered_.clear();
  known_.clear();
  for (std::size_t i = first; i < last; ++i)
    gather(balls[i], std::span(cubes_).subspan(first_[i], first_[i + 1] - first_[i]));
  return gathered_;
}

void BallCubes::gather(const NearBall& ball, std::span<const VoxelKey> cubes) {
  const double within = ball.radius + reach_, half = 0.5 * resolution_;
  if (within + look_round * resolution_ > space_.max_distance()) return visit(ball, within);
  struct Seen {
    VoxelKey key;
    Eigen::Vector3d center;
    double apart;
  };
  const Reach& reach = reaches_[static_cast<std::size_t>(ball.body)];
  std::array<VoxelKey, looks> known;
  std::array<Seen, looks> seen;
  std::size_t known_count = 0, count = 0;
  double nearest = within;
  bool hides_some = false;
  for (const VoxelKey key : cubes) {
    const auto end = known.begin() + static_cast<std::ptrdiff_t>(known_count);
    if (key == no_voxel || std::find(known.begin(), end, key) != end) continue;
    known[known_count++] = key;
    const Eigen::Vector3i voxel = voxel_of(key);
    const Eigen::Vector3d cube = center_of(voxel);
    const double apart = distance_to(cube, half, ball.center);
    if (apart >= within) continue;
    if (!reach.holds(voxel)) {
      hides_some = true;
      continue;
    }
    seen[count++] = {key, cube, apart};
    nearest = std::min(nearest, apart);
  }
  if (hides_some) return visit(ball, count > 0 ? std::min(within, nearest + 2.0 * resolution_) : within);
  for (std::size_t i = 0; i < count; ++i)
    add_cube(seen[i].key, seen[i].center, ball, seen[i].apart - nearest);
}

/// The same, cube by cube, where the field does not tell: beyond its max_distance, or when what is nearest
/// cannot be reached and hides what can, as a floor under a sliding disc does.
void BallCubes::visit(const NearBall& ball, double within) {
  const Eigen::AlignedBox3d box =
      Eigen::AlignedBox3d(ball.center.array() - within, ball.center.array() + within)
          .intersection(reaches_[static_cast<std::size_t>(ball.body)].box);
  if (box.isEmpty()) return;
  struct Visit {  // referred to by one pointer, so that the visitor needs no memory of its own
    std::vector<Eigen::Vector3d>& visited;
    const NearBall& ball;
    double half, within, nearest;
  } visit{visited_, ball, 0.5 * resolution_, within, within};
  visited_.clear();
  space_.visit_surface(box, [&visit](const Eigen::Vector3d& cube) {
    const double distance = distance_to(cube, visit.half, visit.ball.center);
    if (distance < visit.within) visit.visited.push_back(cube);
    visit.nearest = std::min(visit.nearest, distance);
    return true;
  });
  for (const Eigen::Vector3d& cube : visited_) {
    const Eigen::Vector3d at = cube / resolution_;
    const Eigen::Vector3i voxel(whole_below(at.x()), whole_below(at.y()), whole_below(at.z()));
    add_cube(voxel_key(voxel), center_of(voxel), ball,
             distance_to(cube, visit.half, ball.center) - visit.nearest);
  }
}

void BallCubes::add_cube(VoxelKey key, const Eigen::Vector3d& cube, const NearBall& ball, double behind) {
  const auto place = std::find(known_.begin(), known_.end(), key) - known_.begin();
  if (place == static_cast<std::ptrdiff_t>(known_.size())) {
    known_.push_back(key);
    gathered_.push_back({cube, ball.center, behind});
    return;
  }
  BodyCube& known = gathered_[static_cast<std::size_t>(place)];
  if (behind >= known.behind) return;
  known.towards = ball.center;
  known.behind = behind;
}

}  // namespace clearway
