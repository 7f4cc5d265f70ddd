#include "planning/team/team_member.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/system/number_text.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {

using Eigen::Index;
using Eigen::VectorXd;

double weighted_reach(const ConfigurationSpace& space, double prismatic_scale) {
  return joint_reach(space).cwiseQuotient(joint_weights(space, prismatic_scale)).maxCoeff();
}

double longest_step(const ConfigurationSpace& space, double prismatic_scale, const TeamOptions& options,
                    double braking) {
  const VectorXd weight = joint_weights(space, prismatic_scale);
  double longest = std::sqrt(options.max_acceleration * weight.minCoeff() * braking) * options.period;
  for (Index j = 0; j < weight.size(); ++j) {
    const Joint& joint = space.robot().joints[static_cast<std::size_t>(j)];
    longest = std::min(longest, weight[j] * joint.max_velocity * options.period);
  }
  return longest;
}

double braking_step(double room, double change) {
  // s + (s - c) + (s - 2 c) + ... = (m + 1) s - c m (m + 1) / 2 for m c <= s <= (m + 1) c
  const double left = std::max(0.0, room);
  const double whole = std::floor(0.5 * (std::sqrt(1.0 + 8.0 * left / change) - 1.0));
  return (left + 0.5 * change * whole * (whole + 1.0)) / (whole + 1.0);
}

namespace {

DamperOptions damper_of(const TeamRobot& robot, const TeamOptions& options, const TeamFigures& figures,
                        std::size_t index) {
  DamperOptions damper;
  damper.weight = joint_weights(*robot.space, options.boundary.local.prismatic_scale);
  damper.influence_distance = figures.influence_distance;
  damper.security_distance = figures.security_distance;
  damper.xi = figures.xi;
  damper.max_step = figures.max_step[index];
  return damper;
}

}  // namespace

TeamMember::TeamMember(const TeamRobot& robot, const TeamOptions& options, const TeamFigures& figures,
                       std::size_t index)
    : robot_(robot),
      options_(options),
      space_(robot.space),
      obstacle_constraints_(robot.space->robot()),
      damper_(damper_of(robot, options, figures, index)),
      own_(damper_),
      controller_(robot.space->robot(), options.boundary, damper_) {
  own_.security_distance = figures.own_security_distance;
  change_ = damper_.weight * (options.max_acceleration * options.period * options.period);
  previous_ = step_ = VectorXd::Zero(robot.start.size());
  trace_.positions.push_back(robot.start);
  if (robot.start == robot.goal) trace_.arrival = 0.0;
}

void TeamMember::see(std::shared_ptr<const ConfigurationSpace> space) {
  if (space) space_ = std::move(space);
}

std::vector<PlacedShape> TeamMember::bodies() const {
  return placed_bodies(space_->robot(), forward_kinematics(space_->robot(), position()));
}

/// Lahouar 2006, eq. 1-2, slowed before the goal so that braking keeps the acceleration limit.
VectorXd TeamMember::wanted_step() const {
  const VectorXd wanted = step_to_goal(damper_, position(), robot_.goal);
  const double to_goal = damper_.weight.cwiseProduct(robot_.goal - position()).norm();
  const double most = braking_step(to_goal, change_.minCoeff());
  const double length = wanted.norm();
  return length > most ? VectorXd(wanted * (most / length)) : wanted;
}

/// Lahouar 2006, eq. 5 and 8: approach to another robot is shared, an obstacle's own velocity enters.
void TeamMember::append_constraints(const std::vector<PlacedShape>& robots,
                                    const std::vector<PlacedShape>& obstacles) {
  const LinkPoses poses = forward_kinematics(space_->robot(), position());
  std::vector<ObstacleConstraint> constraints;
  obstacle_constraints_.append(poses, robots, damper_.influence_distance, constraints);
  const std::size_t shared = constraints.size();
  unavoidable_ = obstacle_constraints_.append(poses, obstacles, damper_.influence_distance, constraints);
  constraints_.separation = std::min(constraints_.separation, unavoidable_);
  const Index before = constraints_.matrix.rows(), all = before + static_cast<Index>(constraints.size());
  constraints_.matrix.conservativeResize(all, position().size());
  constraints_.bounds.conservativeResize(all);
  sources_.assign(static_cast<std::size_t>(before), {OutrunBy::map, -1});
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const ObstacleConstraint& constraint = constraints[i];
    const Index at = before + static_cast<Index>(i);
    constraints_.matrix.row(at) = constraint.gradient.cwiseQuotient(damper_.weight).transpose();
    constraints_.bounds[at] = damper_bound(damper_, constraint.distance) * (i < shared ? 0.5 : 1.0) -
                              constraint.approach_speed * options_.period;
    constraints_.pairs.push_back(constraint);
    constraints_.separation = std::min(constraints_.separation, constraint.distance);
    sources_.push_back({i < shared ? OutrunBy::robot : OutrunBy::obstacle, constraint.obstacle});
  }
}

void TeamMember::look(const std::vector<PlacedShape>& robots, const std::vector<PlacedShape>& obstacles) {
  constraints_ = constraints_at(*space_, position(), own_);
  append_constraints(robots, obstacles);
  trace_.separations.push_back(constraints_.separation);
}

OutrunBy TeamMember::choose() {
  const VectorXd wanted = wanted_step();
  local_ = local_step(constraints_, wanted, damper_);
  BoundaryChoice choice{local_.step, true, ""};
  if (options_.follows_boundaries)
    choice = controller_.next(constraints_, local_, wanted, position(), robot_.goal);
  along_boundary_ = !choice.is_local;
  trace_.along_boundary.push_back(along_boundary_);
  limit_change(choice.step);
  is_overlapped_ = !space_->is_free(position());
  if (local_.demand < 1.0) ++trace_.relaxed;
  if (is_overlapped_anew()) return {OutrunBy::overlap, -1};
  if (unavoidable_ < damper_.security_distance) return {OutrunBy::fixed, -1};
  return local_.demand < 1.0 ? who_gave_way() : OutrunBy{};
}

/// The step nearest to `wanted` that keeps all constraints and changes the velocity by no more than the
/// acceleration limit; where these exclude each other, that limit gives way.
void TeamMember::limit_change(const VectorXd& wanted) {
  const double most = damper_.max_step;
  QuadraticProgram program{wanted, constraints_.matrix, constraints_.bounds, {}, {}};
  program.lower.resize(wanted.size());
  program.upper.resize(wanted.size());
  for (Index j = 0; j < wanted.size(); ++j) {
    const double down = -std::min(most, braking_step(-constraints_.lower[j], change_[j]));
    const double up = std::min(most, braking_step(constraints_.upper[j], change_[j]));
    program.lower[j] = std::clamp(previous_[j] - change_[j], down, up);
    program.upper[j] = std::clamp(previous_[j] + change_[j], down, up);
  }
  const QuadraticSolution smooth = solve(program);
  if (smooth.feasible) {
    step_ = smooth.x;
    return;
  }
  step_ = local_step(constraints_, wanted, damper_).step;
}

/// Something is where it stands that was not there in the map that it began with.
bool TeamMember::is_overlapped_anew() const { return is_overlapped_ && robot_.space->is_free(position()); }

/// Which constraints of the map and of the robot itself the map that it began with has, too: the same cubes
/// give the same constraints.
std::vector<bool> TeamMember::known_constraints() const {
  std::vector<bool> known(constraints_.pairs.size(), space_ == robot_.space);
  if (space_ == robot_.space) return known;
  const StepConstraints before = constraints_at(*robot_.space, position(), own_);
  for (std::size_t i = 0; i < known.size() && sources_[i].kind == OutrunBy::map; ++i) {
    const ProximityConstraint& constraint = constraints_.pairs[i];
    known[i] = std::any_of(before.pairs.begin(), before.pairs.end(), [&](const ProximityConstraint& old) {
      return old.body == constraint.body && std::abs(old.distance - constraint.distance) <= 1e-9 &&
             old.normal.isApprox(constraint.normal, 1e-9) && old.gradient.isApprox(constraint.gradient, 1e-9);
    });
  }
  return known;
}

/// Whose demand was kept least; of equals an obstacle's.
OutrunBy TeamMember::who_gave_way() const {
  OutrunBy least{OutrunBy::map, -1};
  double share = 1.0;
  const std::vector<bool> known = known_constraints();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const double kept = local_.shares[static_cast<Index>(i)];
    OutrunBy source = sources_[i];
    if (source.kind == OutrunBy::map && !known[i]) source.kind = OutrunBy::sensed;
    if (kept > share || (kept == share && source.kind <= least.kind)) continue;
    share = kept;
    least = source;
  }
  return least;
}

Configuration TeamMember::moved(const VectorXd& step) const {
  Configuration q = position() + step.cwiseQuotient(damper_.weight);
  const Robot& robot = space_->robot();
  for (Index j = 0; j < q.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    q[j] = std::clamp(q[j], joint.lower, joint.upper);  // rounding at a limit
  }
  const double missed = damper_.weight.cwiseProduct(robot_.goal - q).norm();
  return missed <= 1e-9 * damper_.max_step ? robot_.goal : q;
}

double TeamMember::move() {
  Configuration next = position();
  double share = 1.0;
  // What was sensed anew may overlap the robot where it stands: no edge from there is free, and it leaves by
  // the step that its constraints demand.
  if (is_overlapped_) next = moved(step_);
  for (int halving = 0; !is_overlapped_ && halving <= 10; ++halving, share *= 0.5) {
    const Configuration reached = moved(share * step_);
    if (reached == position()) break;
    if (!space_->is_edge_free(position(), reached)) continue;
    if (halving > 0) ++trace_.shortened;
    next = reached;
    break;
  }
  const VectorXd taken = damper_.weight.cwiseProduct(next - position());
  if (((taken - previous_).cwiseAbs().array() > change_.array() * (1.0 + 1e-6)).any()) ++trace_.accelerated;
  previous_ = taken;
  const bool has_moved = next != position();
  trace_.greatest_motion =
      std::max(trace_.greatest_motion, space_->motion_bound((next - position()).cwiseAbs()));
  trace_.positions.push_back(next);
  trace_.deadlocks = controller_.counts().deadlocks;
  trace_.switches = controller_.counts().switches;
  trace_.returns = controller_.counts().returns;
  if (!is_at_goal()) {
    trace_.arrival = -1.0;
  } else if (has_moved) {
    trace_.arrival = options_.period * static_cast<double>(trace_.positions.size() - 1);
  }
  return previous_.norm() / damper_.max_step;
}

double TeamMember::share_gone(std::size_t steps) const {
  const std::vector<Configuration>& all = trace_.positions;
  const Configuration& before = all[all.size() - 1 - std::min(steps, all.size() - 1)];
  return damper_.weight.cwiseProduct(position() - before).norm() /
         (static_cast<double>(steps) * damper_.max_step);
}

std::string TeamMember::where() const {
  const double to_goal = damper_.weight.cwiseProduct(robot_.goal - position()).norm();
  return "'" + robot_.name + "' is " + short_text(to_goal) + " from its goal in joint space, " +
         holding_back(*space_, constraints_, local_.multipliers);
}

}  // namespace clearway
