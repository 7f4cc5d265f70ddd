#include "planning/control_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planning/cube_gap.hpp"
#include "planning/reach.hpp"

namespace clearway {
namespace {

/// Rows of a ball at most, as a rule.
constexpr std::size_t rows_of_ball = 14;

/// A pair that is farther apart cannot come to the bound of its damper in one step.
double binding_distance(const DamperOptions& damper, const BodyPair& pair) {
  const double most = damper.max_step * pair.approach.cwiseQuotient(damper.weight).sum();
  const double margin = damper.influence_distance - damper.security_distance;
  return std::min(damper.influence_distance,
                  damper.security_distance + (1.0 + 1e-9) * most * margin / damper.xi);
}

}  // namespace

ControlRows::ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance)
    : ControlRows(space, influence_distance, close_distance,
                  [&](const BodyPair&) { return influence_distance; }) {}

ControlRows::ControlRows(const ConfigurationSpace& space, const DamperOptions& damper)
    : ControlRows(space, damper.influence_distance,
                  0.5 * (damper.influence_distance + damper.security_distance),
                  [&](const BodyPair& pair) { return binding_distance(damper, pair); }) {}

ControlRows::ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance,
                         const std::function<double(const BodyPair&)>& pair_reach)
    : robot_(&space.robot()),
      padding_(space.options().padding),
      reach_(influence_distance + padding_),
      close_(std::min(close_distance, influence_distance) + padding_),
      resolution_(space.map().resolution()),
      kinematics_(space.robot()),
      pairs_(space.robot(), pair_reach) {
  for (int i = 0; i < static_cast<int>(robot_->bodies.size()); ++i) {
    if (space.blocked_space(i) != nullptr) add_body(i, space.blocked_space(i));
  }
  second_gradient_.resize(robot_->dof());
  // What a look may find at most, as a rule: a loop must not wait for memory.
  const std::size_t most = rows_of_ball * balls() + pairs_.size();
  rows_.reserve(most);
  gradients_.resize(robot_->dof() * (most + 1));
}

ControlRows::~ControlRows() = default;

void ControlRows::add_body(int index, const BlockedSpace* space) {
  auto group = std::find_if(guarded_.begin(), guarded_.end(),
                            [&](const GuardedBodies& known) { return known.space == space; });
  if (group == guarded_.end()) {
    guarded_.push_back({space, NearBalls(*space, reach_, close_), BallCubes(*space, reach_), {}});
    group = guarded_.end() - 1;
  }
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const Eigen::AlignedBox3d reach = reach_box(*robot_, body);
  group->balls.add(body.link, ball_around(body), body.cover);
  group->cubes.add({reach.min().array() - padding_, reach.max().array() + padding_}, body.cover.size());
  group->bodies.push_back(index);
}

std::size_t ControlRows::balls() const {
  return std::accumulate(
      guarded_.begin(), guarded_.end(), std::size_t{0},
      [](std::size_t sum, const GuardedBodies& group) { return sum + group.balls.size(); });
}

void ControlRows::look(const Configuration& q) {
  kinematics_.place(q);
  find_rows();
}

void ControlRows::find_rows() {
  rows_.clear();
  for (GuardedBodies& group : guarded_) {
    const std::span<const NearBall> balls = group.balls.look(kinematics_.map_from_link());
    if (balls.empty()) continue;
    group.cubes.look(balls);
    for (std::size_t first = 0, last = 0; first < balls.size(); first = last) {
      while (last < balls.size() && balls[last].body == balls[first].body) ++last;
      cube_rows(group.bodies[static_cast<std::size_t>(balls[first].body)],
                group.cubes.gather(balls, first, last));
    }
  }
  pair_rows();
}

/// A row for each cube that is near the body's exact shape.
void ControlRows::cube_rows(int index, std::span<const BodyCube> cubes) {
  if (cubes.empty()) return;
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const CubeGaps gaps(body.shape, pose(body.link) * body.link_from_shape, resolution_);
  for (const BodyCube& cube : cubes) {
    CubeGap gap = gaps.to(cube.center, cube.towards, reach_);
    if (gap.distance >= reach_) continue;
    if (gap.normal.squaredNorm() < 0.5) {  // they overlap
      gap.normal = (cube.center - cube.towards).stableNormalized();
      gap.point = cube.center;
      if (gap.normal.squaredNorm() < 0.5) continue;
    }
    append({index, -1, gap.distance - padding_, cube.behind, gap.point, gap.normal}, body.link, nullptr);
  }
}

/// Rows between bodies of the robot that are near each other.
void ControlRows::pair_rows() {
  for (const NearPair& pair : pairs_.look(kinematics_.map_from_link())) {
    append({pair.first, pair.second, pair.distance, 0.0, pair.first_point, pair.direction}, pair.first_link,
           &pair);
  }
}

/// Rows that no joint can change are left out.
void ControlRows::append(const ControlRow& row, int link, const NearPair* pair) {
  const std::size_t dof = robot_->dof(), begin = rows_.size() * dof;
  if (gradients_.size() < begin + dof) gradients_.resize(2 * (begin + dof));
  const auto gradient = std::span(gradients_).subspan(begin, dof);
  kinematics_.rate(link, row.point, row.normal, gradient);
  if (pair != nullptr) {
    kinematics_.rate(pair->second_link, pair->second_point, row.normal, second_gradient_);
    for (std::size_t j = 0; j < dof; ++j) gradient[j] -= second_gradient_[j];
  }
  if (std::any_of(gradient.begin(), gradient.end(), [](double rate) { return std::abs(rate) > 1e-12; }))
    rows_.push_back(row);
}

}  // namespace clearway
