#include "planning/control_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "planning/cube_gap.hpp"
#include "planning/reach.hpp"
#include "planning/segment_distance.hpp"

namespace clearway {
namespace {

/// Voxels from a ball's own to those from which it is looked round.
constexpr int look_round = 3;
/// Voxels that are asked for a ball that is close: the eight about its middle, and one on each side.
constexpr std::size_t looks = 14;
/// Numbers that the widest registers hold.
constexpr std::size_t registers = 8;

/// A voxel as one number; |index| < 2^20.
std::uint64_t key_of(const Eigen::Vector3i& voxel) {
  constexpr int bias = 1 << 20;
  const auto part = [](int index) { return static_cast<std::uint64_t>(index + bias); };
  return part(voxel.x()) << 42U | part(voxel.y()) << 21U | part(voxel.z());
}

/// The part of its own z axis that together with the radius about it holds a body; nothing for boxes and
/// hulls.
bool is_about_its_axis(const Shape& shape) {
  return shape.kind() != Shape::Kind::box && shape.kind() != Shape::Kind::convex;
}

/// Lower bound of the distance of two such bodies.
double axis_gap(const Shape& a, const Eigen::Isometry3d& pose_a, const Shape& b,
                const Eigen::Isometry3d& pose_b) {
  const auto half = [](const Shape& shape, const Eigen::Isometry3d& pose) -> Eigen::Vector3d {
    const double length = shape.kind() == Shape::Kind::sphere ? 0.0 : shape.length();
    return 0.5 * length * pose.linear().col(2);
  };
  const Eigen::Vector3d along_a = half(a, pose_a), along_b = half(b, pose_b);
  const Eigen::Vector3d at_a = pose_a.translation(), at_b = pose_b.translation();
  return segment_to_segment(at_a - along_a, at_a + along_a, at_b - along_b, at_b + along_b).distance -
         a.radius() - b.radius();
}

/// A ball that holds a body, link frame.
Sphere ball_around(const Body& body) {
  const Eigen::Vector3d middle = body.shape.bounds(Eigen::Isometry3d::Identity()).center();
  double radius = body.shape.bounding_radius();
  if (body.shape.kind() == Shape::Kind::convex) {
    radius = 0.0;
    for (const Eigen::Vector3d& corner : body.shape.vertices())
      radius = std::max(radius, (corner - middle).norm());
  }
  return {body.link_from_shape * middle, radius * (1.0 + 1e-9)};
}

}  // namespace

ControlRows::ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance)
    : robot_(&space.robot()),
      padding_(space.options().padding),
      reach_(influence_distance + padding_),
      close_(std::min(close_distance, influence_distance) + padding_),
      resolution_(space.map().resolution()),
      kinematics_(space.robot()) {
  const auto count = static_cast<int>(robot_->bodies.size());
  for (int i = 0; i < count; ++i) {
    const BlockedSpace* blocked = space.blocked_space(i);
    if (blocked == nullptr) continue;
    const Body& body = robot_->bodies[static_cast<std::size_t>(i)];
    auto group = std::find_if(groups_.begin(), groups_.end(),
                              [&](const Group& known) { return known.space == blocked; });
    if (group == groups_.end()) {
      groups_.push_back({NearestCubes(*blocked), blocked, {}});
      group = groups_.end() - 1;
    }
    const Eigen::AlignedBox3d reach = reach_box(*robot_, body);
    group->bodies.push_back({i,
                             body.link,
                             &body,
                             {reach.min().array() - padding_, reach.max().array() + padding_},
                             ball_around(body),
                             balls_.size(),
                             balls_.size() + body.cover.size()});
    balls_.insert(balls_.end(), body.cover.begin(), body.cover.end());
  }
  for (const BodyPair& pair : contact_pairs(*robot_)) {
    const Body& first = robot_->bodies[static_cast<std::size_t>(pair.first)];
    const Body& second = robot_->bodies[static_cast<std::size_t>(pair.second)];
    pairs_.push_back(
        {pair.first, pair.second, first.link, second.link, ball_around(first), ball_around(second)});
  }
  const std::size_t points = balls_.size() + static_cast<std::size_t>(count) + registers;
  for (std::vector<double>* vector : {&x_, &y_, &z_, &clearance_}) vector->resize(points);
  second_gradient_.resize(robot_->dof());
  // What a look may find at most, as a rule: a loop must not wait for memory.
  near_.reserve(balls_.size());
  voxels_.reserve(looks * balls_.size());
  offsets_.reserve(looks * balls_.size());
  candidates_.reserve(looks * balls_.size());
  rows_.reserve(looks * balls_.size() + pairs_.size());
  gradients_.reserve(robot_->dof() * (looks * balls_.size() + pairs_.size()));
}

ControlRows::~ControlRows() = default;

void ControlRows::look(const Configuration& q) {
  kinematics_.place(q);
  find_rows();
}

void ControlRows::find_rows() {
  rows_.clear();
  gradients_.clear();
  for (Group& group : groups_) {
    find_near_balls(group);
    find_cubes(group);
    for (std::size_t i = 0; i < near_.size();) {
      const std::size_t body = near_[i].body;
      candidates_.clear();
      for (; i < near_.size() && near_[i].body == body; ++i) gather(group, near_[i]);
      close_body(group.bodies[body]);
    }
  }
  pair_rows();
}

/// Cover balls that may be within reach of something.
void ControlRows::find_near_balls(const Group& group) {
  near_.clear();
  const std::size_t count = group.bodies.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d middle = pose(group.bodies[i].link) * group.bodies[i].bound.center;
    x_[i] = middle.x();
    y_[i] = middle.y();
    z_[i] = middle.z();
  }
  look_up(*group.space, count, true);
  for (std::size_t i = 0; i < count; ++i) {
    const NearBody& body = group.bodies[i];
    // Beyond its max_distance the field says nothing.
    const double within = body.bound.radius + reach_;
    if (within <= group.space->max_distance() && clearance_[i] >= within) continue;
    const Eigen::Isometry3d& map_from_link = pose(body.link);
    for (std::size_t ball = body.first_ball; ball < body.last_ball; ++ball)
      near_.push_back({i, ball, map_from_link * balls_[ball].center});
  }
  keep_near(group, false);
  keep_near(group, true);
}

/// Clearances of the first points, which are filled up to whole registers, so that none is looked up alone.
void ControlRows::look_up(const BlockedSpace& space, std::size_t count, bool closely) {
  const std::size_t whole = (count + registers - 1) / registers * registers;
  for (std::size_t i = count; i < whole; ++i) {
    x_[i] = x_[count - 1];
    y_[i] = y_[count - 1];
    z_[i] = z_[count - 1];
  }
  const auto part = [whole](std::vector<double>& all) { return std::span(all).first(whole); };
  if (closely) {
    space.clearances({part(x_), part(y_), part(z_)}, part(clearance_));
  } else {
    space.coarse_clearances({part(x_), part(y_), part(z_)}, part(clearance_));
  }
}

/// Looks the balls up and leaves off those that are out of reach.
void ControlRows::keep_near(const Group& group, bool closely) {
  const std::size_t count = near_.size();
  if (count == 0) return;
  for (std::size_t i = 0; i < count; ++i) {
    x_[i] = near_[i].center.x();
    y_[i] = near_[i].center.y();
    z_[i] = near_[i].center.z();
  }
  look_up(*group.space, count, closely);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double apart = clearance_[i] - balls_[near_[i].ball].radius;
    if (apart >= reach_) continue;
    near_[kept] = near_[i];
    near_[kept++].is_close = apart < close_;
  }
  near_.resize(kept);
}

/// The cubes nearest to the balls' voxels, and to those around the ones that are close.
void ControlRows::find_cubes(Group& group) {
  voxels_.clear();
  for (NearBall& ball : near_) {
    ball.first_voxel = voxels_.size();
    const Eigen::Vector3d at = ball.center / resolution_;
    if (!ball.is_close) {
      voxels_.push_back(at.array().floor().matrix().cast<int>());
      continue;
    }
    const Eigen::Vector3i low = (at.array() - 0.5).floor().matrix().cast<int>();
    for (int corner = 0; corner < 8; ++corner)
      voxels_.push_back(low + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2));
    for (int way = 0; way < 6; ++way) {
      voxels_.push_back(at.array().floor().matrix().cast<int>());
      voxels_.back()[way / 2] += way % 2 == 0 ? look_round : -look_round;
    }
  }
  offsets_.resize(voxels_.size());
  group.cubes.look_up(voxels_, offsets_);
}

/// A ball's cubes become candidates for rows of its body.
void ControlRows::gather(const Group& group, const NearBall& ball) {
  const Eigen::AlignedBox3d& reach_of_body = group.bodies[ball.body].reach;
  const double within = balls_[ball.ball].radius + reach_, half = 0.5 * resolution_;
  if (within + look_round * resolution_ > group.space->max_distance())
    return gather_within_reach(group, ball, within);
  std::array<Eigen::Vector3i, looks> cubes;
  std::array<std::uint64_t, looks> seen;
  std::array<double, looks> distances;
  std::size_t seen_count = 0, count = 0;
  double nearest = within;
  bool hides_some = false;
  for (std::size_t k = ball.first_voxel; k < ball.first_voxel + (ball.is_close ? looks : 1); ++k) {
    const NearestCubes::Offset& offset = offsets_[k];
    if (offset[0] == NearestCubes::nothing) continue;
    const Eigen::Vector3i voxel = voxels_[k] + Eigen::Vector3i(offset[0], offset[1], offset[2]);
    const std::uint64_t key = key_of(voxel);
    const auto known = seen.begin() + static_cast<std::ptrdiff_t>(seen_count);
    if (std::find(seen.begin(), known, key) != known) continue;
    seen[seen_count++] = key;
    const Eigen::Vector3d cube = center(voxel);
    const double apart = ((ball.center - cube).cwiseAbs().array() - half).max(0.0).matrix().norm();
    if (apart >= within) continue;
    if ((cube.array() + half < reach_of_body.min().array()).any() ||
        (cube.array() - half > reach_of_body.max().array()).any()) {
      hides_some = true;
      continue;
    }
    cubes[count] = voxel;
    distances[count++] = apart;
    nearest = std::min(nearest, apart);
  }
  if (hides_some)
    return gather_within_reach(group, ball,
                               count > 0 ? std::min(within, nearest + 2.0 * resolution_) : within);
  for (std::size_t i = 0; i < count; ++i) add_candidate(cubes[i], ball.center, distances[i] - nearest);
}

/// The same, cube by cube, where the field does not tell: beyond its max_distance, or when what is nearest
/// cannot be reached and hides what can, as a floor under a sliding disc does.
void ControlRows::gather_within_reach(const Group& group, const NearBall& ball, double within) {
  const Eigen::AlignedBox3d box =
      Eigen::AlignedBox3d(ball.center.array() - within, ball.center.array() + within)
          .intersection(group.bodies[ball.body].reach);
  if (box.isEmpty()) return;
  struct Visit {  // referred to by one pointer, so that the visitor needs no memory of its own
    ControlRows& self;
    Eigen::Vector3d center;
    double within, nearest;
    double apart(const Eigen::Vector3d& cube) const {
      return ((center - cube).cwiseAbs().array() - 0.5 * self.resolution_).max(0.0).matrix().norm();
    }
  } visit{*this, ball.center, within, within};
  visited_.clear();
  group.space->visit_surface(box, [&visit](const Eigen::Vector3d& cube) {
    const double distance = visit.apart(cube);
    if (distance < visit.within) visit.self.visited_.push_back(cube);
    visit.nearest = std::min(visit.nearest, distance);
    return true;
  });
  for (const Eigen::Vector3d& cube : visited_) {
    const Eigen::Vector3i voxel = (cube / resolution_).array().floor().matrix().cast<int>();
    add_candidate(voxel, ball.center, visit.apart(cube) - visit.nearest);
  }
}

void ControlRows::add_candidate(const Eigen::Vector3i& voxel, const Eigen::Vector3d& towards, double behind) {
  const std::uint64_t key = key_of(voxel);
  for (Candidate& known : candidates_) {
    if (known.key != key) continue;
    if (behind < known.behind) known = {key, voxel, towards, behind};
    return;
  }
  candidates_.push_back({key, voxel, towards, behind});
}

/// A row for each cube that is near the body's exact shape.
void ControlRows::close_body(const NearBody& near) {
  if (candidates_.empty()) return;
  const Body& body = *near.body;
  const Eigen::Isometry3d map_from_shape = pose(near.link) * body.link_from_shape;
  for (const Candidate& candidate : candidates_) {
    const Eigen::Vector3d cube = center(candidate.voxel);
    CubeGap gap = cube_gap(body.shape, map_from_shape, cube, resolution_, candidate.towards, reach_);
    if (gap.distance >= reach_) continue;
    if (gap.normal.squaredNorm() < 0.5) {  // they overlap
      gap.normal = (cube - candidate.towards).stableNormalized();
      gap.point = cube;
      if (gap.normal.squaredNorm() < 0.5) continue;
    }
    append({near.index, -1, gap.distance - padding_, candidate.behind, gap.point, gap.normal}, near.link, -1);
  }
}

/// Rows between bodies of the robot whose bounding balls are near each other.
void ControlRows::pair_rows() {
  const double within = reach_ - padding_;
  for (const Pair& pair : pairs_) {
    const Eigen::Isometry3d &first_pose = pose(pair.first_link), &second_pose = pose(pair.second_link);
    const double apart = pair.first_bound.radius + pair.second_bound.radius + within;
    const Eigen::Vector3d between =
        first_pose * pair.first_bound.center - second_pose * pair.second_bound.center;
    if (between.squaredNorm() > apart * apart) continue;
    const Body& first = robot_->bodies[static_cast<std::size_t>(pair.first)];
    const Body& second = robot_->bodies[static_cast<std::size_t>(pair.second)];
    const Eigen::Isometry3d first_placed = first_pose * first.link_from_shape,
                            second_placed = second_pose * second.link_from_shape;
    if (is_about_its_axis(first.shape) && is_about_its_axis(second.shape) &&
        axis_gap(first.shape, first_placed, second.shape, second_placed) >= within)
      continue;
    DistanceBounds bounds = distance(first.shape, first_placed, second.shape, second_placed, within);
    if (bounds.lower >= within) continue;
    if (bounds.direction.squaredNorm() < 0.5) {  // they overlap: along the line between their middles
      bounds.direction = -between.stableNormalized();
      if (bounds.direction.squaredNorm() < 0.5) continue;
      bounds.point_a = first_pose * pair.first_bound.center;
      bounds.point_b = second_pose * pair.second_bound.center;
    }
    kinematics_.rate(pair.second_link, bounds.point_b, bounds.direction, second_gradient_);
    append({pair.first, pair.second, bounds.lower, 0.0, bounds.point_a, bounds.direction}, pair.first_link,
           pair.second_link);
  }
}

/// Rows that no joint can change are left out.
void ControlRows::append(const ControlRow& row, int link, int other_link) {
  const std::size_t dof = robot_->dof(), begin = gradients_.size();
  gradients_.resize(begin + dof);
  const auto gradient = std::span(gradients_).subspan(begin);
  kinematics_.rate(link, row.point, row.normal, gradient);
  double largest = 0.0;
  for (std::size_t j = 0; j < dof; ++j) {
    if (other_link >= 0) gradient[j] -= second_gradient_[j];
    largest = std::max(largest, std::abs(gradient[j]));
  }
  if (largest <= 1e-12) {
    gradients_.resize(begin);
    return;
  }
  rows_.push_back(row);
}

}  // namespace clearway
