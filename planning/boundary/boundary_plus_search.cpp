#include "planning/boundary/boundary_plus_search.hpp"

#include <algorithm>

#include "mapping/system/number_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/boundary/boundary_following.hpp"
#include "planning/routes/route_guide.hpp"

namespace clearway {
namespace {

constexpr double same_deadlock = 1.0;  ///< steps
constexpr double spacing = 8.0;        ///< steps, of the points of traces that edges are tried from
constexpr int tries = 4;               ///< edges from each of them
constexpr int first_round = 64;        ///< samples of the first hand-over; each has twice as many as the last
constexpr int few_samples = 2000;      ///< cost a tenth of what the local method does

/// The constraint with the largest multiplier, nullptr when no pair of bodies and obstacles holds the step
/// back.
const ProximityConstraint* blocking_pair(const LocalRun& stuck) {
  const auto& pairs = stuck.constraints.pairs;
  const ProximityConstraint* blocking = nullptr;
  double strongest = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double multiplier = stuck.local.multipliers[static_cast<Eigen::Index>(i)];
    if (multiplier <= strongest) continue;
    strongest = multiplier;
    blocking = &pairs[i];
  }
  return blocking;
}

}  // namespace

std::string plane_name(int plane) {
  constexpr const char* names[] = {"over", "under", "left", "right", "upper", "lower"};
  return plane < 6 ? names[plane] : "random";
}

Eigen::VectorXd plane_direction(int plane, const ConfigurationSpace& space, const DamperOptions& damper,
                                const Configuration& lock, const LocalRun& stuck, std::mt19937_64& random) {
  const Robot& robot = space.robot();
  const ProximityConstraint* pair = blocking_pair(stuck);
  if (plane < 4 && pair != nullptr) {
    Eigen::Vector3d way = Eigen::Vector3d::UnitZ() - pair->normal.z() * pair->normal;
    way = way.norm() > 0.1 ? Eigen::Vector3d(way.normalized()) : pair->normal.unitOrthogonal();
    if (plane >= 2) way = pair->normal.cross(way);
    if (plane % 2 == 1) way = -way;
    const int link = robot.bodies[static_cast<std::size_t>(pair->body)].link;
    const auto J = jacobian(robot, forward_kinematics(robot, lock), link, pair->point);
    return (J.topRows<3>().transpose() * way).cwiseQuotient(damper.weight);
  }
  if (plane == 4 || plane == 5)
    return damper.weight.cwiseProduct(side_limits(robot, lock, plane == 4) - lock);
  return Eigen::VectorXd::NullaryExpr(lock.size(),
                                      [&random](Eigen::Index) { return 2.0 * random_unit(random) - 1.0; });
}

BoundaryPlusSearch::BoundaryPlusSearch(const PlanProblem& problem, const BoundaryPlusOptions& options,
                                       const DamperOptions& damper)
    : problem_(problem),
      options_(options),
      damper_(damper),
      constraints_(constraints_for(problem.space, damper)),
      trees_(problem, damper.weight),
      random_(problem.seed),
      memory_{DeadlockMemory(damper.weight, same_deadlock * damper.max_step),
              DeadlockMemory(damper.weight, same_deadlock * damper.max_step)} {}

bool BoundaryPlusSearch::run(Side side, int node, int most_steps,
                             const std::optional<Eigen::VectorXd>& direction) {
  const Configuration from = trees_.nodes(side)[static_cast<std::size_t>(node)].q;
  const Configuration& to = side == BidirectionalTrees::start ? problem_.goal : problem_.start;
  const PlanProblem leg{problem_.space, problem_.cost, from, to, problem_.seed, problem_.out_of_time};
  LocalRun run = run_local(leg, damper_, constraints_, memory_[side], most_steps, direction);
  local_steps_ += run.local_steps;
  boundary_steps_ += run.boundary_steps;
  const std::size_t first = trees_.nodes(side).size();
  const int last = trees_.add_trace(side, node, run.trace, run.origins);
  if (run.end == RunEnd::reached) {
    side == BidirectionalTrees::start ? trees_.join_at(last, 0) : trees_.join_at(0, last);
    return true;
  }
  if (run.end == RunEnd::deadlock) {
    const Configuration& q = run.trace.back();
    memory_[side].remember(q);
    const Configuration& old = trees_.nodes(side)[static_cast<std::size_t>(locks_[side].node)].q;
    const auto distance = [&](const Configuration& a) { return damper_.weight.cwiseProduct(to - a).norm(); };
    if (memory_[side].size() == 1 || distance(q) < distance(old)) locks_[side] = {last, std::move(run)};
  }
  return trees_.join(side, first, spacing * damper_.max_step, tries);
}

bool BoundaryPlusSearch::by_local_method() {
  for (const Side side : {BidirectionalTrees::start, BidirectionalTrees::goal}) {
    if (!run(side, 0, options_.local_steps, std::nullopt)) continue;
    how_ = side == BidirectionalTrees::start ? "the local method" : "the local method from the goal";
    return true;
  }
  return false;
}

bool BoundaryPlusSearch::by_plane(int plane) {
  for (const Side side : {BidirectionalTrees::start, BidirectionalTrees::goal}) {
    if (problem_.out_of_time()) return false;
    if (memory_[side].size() == 0) continue;
    const int node = locks_[side].node;
    const Configuration lock = trees_.nodes(side)[static_cast<std::size_t>(node)].q;
    const Eigen::VectorXd direction =
        plane_direction(plane, problem_.space, damper_, lock, locks_[side].run, random_);
    ++planes_;
    if (!run(side, node, options_.plane_steps, direction)) continue;
    how_ = "boundary following, plane " + std::to_string(plane + 1) + " (" + plane_name(plane) + ")" +
           (side == BidirectionalTrees::start ? "" : " from the goal");
    return true;
  }
  return false;
}

/// The local method from the sampled node of the start's tree that is nearest to the goal.
bool BoundaryPlusSearch::back_to_local_method() {
  const auto& nodes = trees_.nodes(BidirectionalTrees::start);
  int best = -1;
  double least = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].is_sampled || memory_[BidirectionalTrees::start].knows(nodes[i].q)) continue;
    const double distance = damper_.weight.cwiseProduct(problem_.goal - nodes[i].q).norm();
    if (best >= 0 && distance >= least) continue;
    best = static_cast<int>(i);
    least = distance;
  }
  if (best < 0) return false;
  ++handed_back_;
  return run(BidirectionalTrees::start, best, options_.plane_steps, std::nullopt);
}

/// From now on some of the samples lie along a route for the hand.
void BoundaryPlusSearch::guide_samples() {
  const EndEffector hand = find_end_effector(problem_.space);
  is_guided_ = true;
  guide_ = guide_along(problem_, hand, find_end_effector_route(problem_, hand), options_.guided_share);
}

/// So many more samples, the first of all without a guide.
bool BoundaryPlusSearch::by_trees(int samples) {
  if (samples <= 0) return false;
  ++rounds_;
  const int unguided = std::clamp(unguided_samples - trees_.samples(), 0, samples);
  bool is_grown = trees_.grow(unguided, random_, guide_);
  if (!is_grown && unguided < samples && !problem_.out_of_time()) {
    if (!is_guided_ && options_.guided_share > 0.0) guide_samples();
    is_grown = trees_.grow(samples - unguided, random_, guide_);
  }
  if (is_grown) how_ = "trees of " + counted(trees_.samples(), "sample");
  return is_grown;
}

bool BoundaryPlusSearch::by_hand_over(int samples) {
  if (samples <= 0 || problem_.out_of_time()) return false;
  if (by_trees(samples)) return true;
  if (problem_.out_of_time() || !back_to_local_method()) return false;
  how_ = "the local method after trees of " + counted(trees_.samples(), "sample");
  return true;
}

BoundaryPlusStage BoundaryPlusSearch::solve() {
  if (problem_.space.is_edge_free(problem_.start, problem_.goal)) {
    trees_.join_at(0, 0);
    return BoundaryPlusStage::straight_edge;
  }
  int left = options_.max_samples - std::min(few_samples, options_.max_samples);
  if (by_trees(options_.max_samples - left)) return BoundaryPlusStage::hand_over;
  if (by_local_method()) return BoundaryPlusStage::local_method;
  for (int round = 0, samples = first_round; !problem_.out_of_time(); ++round, samples *= 2) {
    if (round >= options_.planes && left == 0) break;
    if (round < options_.planes && by_plane(round)) return BoundaryPlusStage::plane;
    samples = std::min(samples, left);
    left -= samples;
    if (by_hand_over(samples)) return BoundaryPlusStage::hand_over;
  }
  return BoundaryPlusStage::none;
}

std::string BoundaryPlusSearch::effort() const {
  return counted(local_steps_, "local step") + ", " +
         counted(planes_, "run along boundaries", "runs along boundaries") + " and a hand-over to trees of " +
         counted(trees_.samples(), "sample");
}

std::vector<Configuration> BoundaryPlusSearch::explored() const {
  const auto& nodes = trees_.nodes(BidirectionalTrees::start);
  std::vector<Configuration> trace;
  for (int i = locks_[BidirectionalTrees::start].node; i >= 0; i = nodes[static_cast<std::size_t>(i)].parent)
    trace.push_back(nodes[static_cast<std::size_t>(i)].q);
  std::reverse(trace.begin(), trace.end());
  return trace;
}

void BoundaryPlusSearch::add_statistics(PlanResult& result) const {
  result.statistics["steps_local"] = local_steps_;
  result.statistics["steps_boundary"] = boundary_steps_;
  result.statistics["deadlocks"] = static_cast<double>(memory_[BidirectionalTrees::start].size() +
                                                       memory_[BidirectionalTrees::goal].size());
  result.statistics["planes_tried"] = planes_;
  result.statistics["samples"] = trees_.samples();
  result.statistics["hand_over_rounds"] = rounds_;
  result.statistics["handed_back"] = handed_back_;
  result.edges_checked += trees_.edges_checked();
  if (trees_.is_joined()) result.statistics["sampled_share"] = trees_.sampled_share();
}

}  // namespace clearway
