#include "planning/constraint/control_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "planning/geometry/cube_gap.hpp"
#include "planning/robot/reach.hpp"

namespace clearway {
namespace {

/// Rows of a ball at most, as a rule.
constexpr std::size_t rows_of_ball = 14;

}  // namespace

ControlRows::ControlRows(const ConfigurationSpace& space, double influence_distance, double close_distance)
    : ControlRows(space, Binding{influence_distance, influence_distance, 0.0,
                                 std::vector<double>(space.robot().dof()),
                                 std::min(close_distance, influence_distance)}) {}

ControlRows::ControlRows(const ConfigurationSpace& space, const DamperOptions& damper)
    : ControlRows(space, binding_of(damper)) {}

ControlRows::ControlRows(const ConfigurationSpace& space, Binding binding)
    : robot_(&space.robot()),
      padding_(space.options().padding),
      resolution_(space.map().resolution()),
      binding_(std::move(binding)),
      kinematics_(space.robot()),
      pairs_(space.robot(), [&](const BodyPair& pair) {
        return binding_.distance(
            std::inner_product(binding_.steps.begin(), binding_.steps.end(), pair.approach.data(), 0.0));
      }) {
  for (int i = 0; i < static_cast<int>(robot_->bodies.size()); ++i) {
    if (space.blocked_space(i) != nullptr) add_body(i, space.blocked_space(i));
  }
  second_gradient_.resize(robot_->dof());
  // What a look may find at most, as a rule: a loop must not wait for memory.
  const std::size_t most = rows_of_ball * balls() + pairs_.size();
  rows_.reserve(most);
  gaps_.resize(most);
  gradients_.resize(robot_->dof() * (most + 1));
}

/// What cannot come to the bound of its damper in one step does not count.
ControlRows::Binding ControlRows::binding_of(const DamperOptions& damper) {
  const double margin = damper.influence_distance - damper.security_distance;
  Binding binding{damper.influence_distance,
                  damper.security_distance,
                  (1.0 + 1e-9) * margin / damper.xi,
                  {},
                  0.5 * (damper.influence_distance + damper.security_distance)};
  for (const double weight : damper.weight) binding.steps.push_back(damper.max_step / weight);
  return binding;
}

ControlRows::~ControlRows() = default;

void ControlRows::add_body(int index, const BlockedSpace* space) {
  auto group = std::find_if(guarded_.begin(), guarded_.end(),
                            [&](const GuardedBodies& known) { return known.space == space; });
  if (group == guarded_.end()) {
    guarded_.push_back({space, NearBalls(*space), BallCubes(*space), {}, {}, {}});
    group = guarded_.end() - 1;
  }
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const Eigen::AlignedBox3d box = reach_box(*robot_, body);
  group->balls.add(body.link, ball_around(body), body.cover);
  group->cubes.add({box.min().array() - padding_, box.max().array() + padding_}, body.cover.size());
  group->bodies.push_back(index);
  group->bounds.push_back(ball_around(body));
  group->reach.push_back({binding_.influence + padding_, binding_.close + padding_});
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
    set_reach(group);
    const std::span<const NearBall> balls = group.balls.look(kinematics_.map_from_link(), group.reach);
    if (balls.empty()) continue;
    group.cubes.look(balls);
    for (std::size_t first = 0, last = 0; first < balls.size(); first = last) {
      while (last < balls.size() && balls[last].body == balls[first].body) ++last;
      cube_rows(group, balls[first].body, group.cubes.gather(balls, first, last));
    }
  }
  pair_rows();
}

void ControlRows::set_reach(GuardedBodies& group) const {
  if (binding_.per_move == 0.0) return;
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    const int link = robot_->bodies[static_cast<std::size_t>(group.bodies[i])].link;
    const Sphere& bound = group.bounds[i];
    const Eigen::Vector3d middle = pose(link).linear().lazyProduct(bound.center) + pose(link).translation();
    const double move = kinematics_.farthest_move(link, {middle, bound.radius}, binding_.steps);
    group.reach[i] = {binding_.distance(move) + padding_, binding_.close_distance(move) + padding_};
  }
}

/// A row for each cube that is near the body's exact shape.
void ControlRows::cube_rows(const GuardedBodies& group, int which, std::span<const BodyCube> cubes) {
  if (cubes.empty()) return;
  const int index = group.bodies[static_cast<std::size_t>(which)];
  const double reach = group.reach[static_cast<std::size_t>(which)].near;
  const Body& body = robot_->bodies[static_cast<std::size_t>(index)];
  const CubeGaps gaps(body.shape, pose(body.link) * body.link_from_shape, resolution_);
  if (gaps_.size() < cubes.size()) gaps_.resize(2 * cubes.size());
  const auto found = std::span(gaps_).first(cubes.size());
  gaps.to(cubes, reach, found);
  for (std::size_t i = 0; i < cubes.size(); ++i) {
    const BodyCube& cube = cubes[i];
    CubeGap& gap = found[i];
    if (gap.distance >= reach) continue;
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
