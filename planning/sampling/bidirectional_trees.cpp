#include "planning/sampling/bidirectional_trees.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "mapping/system/random_unit.hpp"

namespace clearway {
namespace {

/// The longest edge as a share of the space's extent.
constexpr double range_share = 0.1;

/// Nodes beside an obstacle take samples from within so many ranges: what lies behind it is not theirs.
constexpr double domain_ranges = 3.0;

/// Of joints that turn more than once, each so manieth sample is from anywhere within the limits, the others
/// from one turn about start and goal: all poses, once.
constexpr int far_samples = 8;

/// Less of an edge than this is not worth a node.
constexpr double least_share = 0.25;

constexpr int steps_aside = 2;  ///< from where an edge was blocked

/// Joints with wide limits, or none: only as far as the map and the ends make sense, as in ompl_query.
double margin_beyond_ends(const PlanProblem& problem, const Joint& joint) {
  if (joint.kind == JointKind::revolute) return 2.0 * std::numbers::pi;
  const Eigen::AlignedBox3d map = problem.space.map().bounds();
  return (map.isEmpty() ? 0.0 : map.diagonal().norm()) + (problem.goal - problem.start).norm();
}

BidirectionalTrees::Side other(BidirectionalTrees::Side side) {
  return side == BidirectionalTrees::start ? BidirectionalTrees::goal : BidirectionalTrees::start;
}

}  // namespace

BidirectionalTrees::BidirectionalTrees(const PlanProblem& problem, const Eigen::VectorXd& weight,
                                       double range)
    : problem_(problem),
      weight_(weight),
      low_(problem.start),
      high_(problem.start),
      near_low_(problem.start),
      near_high_(problem.start),
      trees_{Tree(problem.space.robot().dof()), Tree(problem.space.robot().dof())} {
  const Robot& robot = problem.space.robot();
  for (Eigen::Index j = 0; j < low_.size(); ++j) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
    const auto [least, most] = std::minmax(problem.start[j], problem.goal[j]);
    const double margin = margin_beyond_ends(problem, joint);
    low_[j] = std::max(joint.lower, least - margin);
    high_[j] = std::min(joint.upper, most + margin);
    near_low_[j] = low_[j], near_high_[j] = high_[j];
    if (joint.kind != JointKind::revolute || high_[j] - low_[j] <= 2.0 * std::numbers::pi) continue;
    const double middle = 0.5 * (least + most);
    near_low_[j] = std::max(low_[j], std::min(least, middle - std::numbers::pi));
    near_high_[j] = std::min(high_[j], std::max(most, middle + std::numbers::pi));
  }
  range_ = range > 0.0 ? range : range_share * length(near_low_, near_high_);
  add(start, problem.start, -1, false);
  add(goal, problem.goal, -1, false);
}

int BidirectionalTrees::add(Side side, const Configuration& q, int parent, bool is_sampled) {
  Tree& tree = trees_[side];
  tree.nodes.push_back({q, parent, is_sampled, false});
  tree.weighted.add(weight_.cwiseProduct(q));
  return static_cast<int>(tree.nodes.size()) - 1;
}

int BidirectionalTrees::add_trace(Side side, int from, const std::vector<Configuration>& trace,
                                  const std::vector<WaypointOrigin>& origins) {
  Tree& tree = trees_[side];
  for (std::size_t i = 1; i < trace.size(); ++i) {
    from = add(side, trace[i], from, false);
    if (origins.size() != trace.size()) continue;
    tree.nodes.back().origin = static_cast<int>(tree.origins.size());
    tree.origins.push_back(origins[i]);
  }
  return from;
}

/// Of the edge between a node and its parent.
WaypointOrigin BidirectionalTrees::origin_of(Side side, int node) const {
  const int origin = trees_[side].nodes[static_cast<std::size_t>(node)].origin;
  if (origin >= 0) return trees_[side].origins[static_cast<std::size_t>(origin)];
  return {side == start ? PathPhase::start_tree : PathPhase::goal_tree, {}, node};
}

int BidirectionalTrees::nearest(Side side, const Configuration& q) const {
  return static_cast<int>(trees_[side].weighted.nearest(weight_.cwiseProduct(q)));
}

bool BidirectionalTrees::is_free(const Configuration& from, const Configuration& to) {
  ++edges_checked_;
  return problem_.space.is_edge_free(from, to);
}

bool BidirectionalTrees::join(Side side, std::size_t first, double spacing, int tries) {
  const std::vector<Node>&mine = trees_[side].nodes, &theirs = trees_[other(side)].nodes;
  for (std::size_t i = mine.size(), last = 0; i-- > first;) {
    if (last > 0 && i > first && length(mine[i].q, mine[last].q) < spacing) continue;
    last = i;
    if (problem_.out_of_time()) return false;
    std::vector<std::pair<double, std::size_t>> targets;  // spaced, too; nearest and then latest first
    for (std::size_t k = theirs.size(), before = k; k-- > 0;) {
      if (before < theirs.size() && k > 0 && length(theirs[k].q, theirs[before].q) < spacing) continue;
      targets.emplace_back(length(mine[i].q, theirs[k].q), k);
      before = k;
    }
    const std::size_t tried = std::min(targets.size(), static_cast<std::size_t>(tries));
    std::partial_sort(targets.begin(), targets.begin() + static_cast<std::ptrdiff_t>(tried), targets.end(),
                      [](const auto& a, const auto& b) {
                        return a.first != b.first ? a.first < b.first : a.second > b.second;
                      });
    targets.resize(tried);
    for (const auto& [distance, k] : targets) {
      if (problem_.out_of_time()) return false;
      if (!is_free(mine[i].q, theirs[k].q)) continue;
      joined_[side] = static_cast<int>(i);
      joined_[other(side)] = static_cast<int>(k);
      return true;
    }
  }
  return false;
}

/// One edge of at most the range from the nearest node.
/// @param from_anywhere also from a node whose domain does not reach so far
BidirectionalTrees::Reached BidirectionalTrees::extend(Side side, const Configuration& towards,
                                                       bool from_anywhere) {
  const int from = nearest(side, towards);
  const Node& node = trees_[side].nodes[static_cast<std::size_t>(from)];
  const Configuration& near = node.q;
  const double far = length(near, towards);
  if (far == 0.0) return {-1, from, false};  // or distinguished by no weight
  if (!from_anywhere && node.is_beside && far > domain_ranges * range_) return {};
  return advance(side, from,
                 far <= range_ ? towards : Configuration(near + (range_ / far) * (towards - near)));
}

/// As far along that edge as it is free.
BidirectionalTrees::Reached BidirectionalTrees::advance(Side side, int from, const Configuration& towards) {
  Node& node = trees_[side].nodes[static_cast<std::size_t>(from)];
  const Configuration near = node.q;
  ++edges_checked_;
  const double share = problem_.space.free_share(near, towards);
  if (share == 1.0) return {from, add(side, towards, from, true), true};
  node.is_beside = true;
  if (share < least_share) return {from, -1, false};
  return {from, add(side, near + share * (towards - near), from, true), false};
}

/// Edges from the other tree's nearest node on to that node of this one.
bool BidirectionalTrees::connect(Side side, int node) {
  const Side far_side = other(side);
  const Configuration target = trees_[side].nodes[static_cast<std::size_t>(node)].q;
  while (!problem_.out_of_time()) {
    const Reached reached = extend(far_side, target, true);
    if (reached.node < 0) return false;
    if (trees_[far_side].nodes[static_cast<std::size_t>(reached.node)].q != target) {
      if (reached.is_whole) continue;
      return false;
    }
    joined_[side] = node;
    joined_[far_side] = reached.node;
    return true;
  }
  return false;
}

/// Steps from where an edge was blocked, each joint by up to half a range: what lies round the corner.
bool BidirectionalTrees::step_aside(Side side, int from, std::mt19937_64& random) {
  for (int i = 0; i < steps_aside && !problem_.out_of_time(); ++i) {
    Configuration to = trees_[side].nodes[static_cast<std::size_t>(from)].q;
    for (Eigen::Index j = 0; j < to.size(); ++j) {
      const double most = std::min(0.5 * range_ / weight_[j], high_[j] - low_[j]);
      to[j] = std::clamp(to[j] + most * (2.0 * random_unit(random) - 1.0), low_[j], high_[j]);
    }
    const int next = advance(side, from, to).node;
    if (next < 0) continue;
    if (connect(side, next)) return true;
    from = next;
  }
  return false;
}

/// One step of the walk along a route, from a node of that tree.
bool BidirectionalTrees::step_along(RouteWalk& walk, Side side, std::mt19937_64& random) {
  const auto end = side == start ? RouteWalk::start : RouteWalk::goal;
  const std::vector<Node>& nodes = trees_[side].nodes;
  for (std::size_t& i = walked_[side]; i < nodes.size(); ++i) walk.add(end, static_cast<int>(i), nodes[i].q);
  const auto from = walk.choose(end, random);
  if (!from) return false;
  const auto to = walk.step(end, *from, nodes[static_cast<std::size_t>(from->node)].q, random);
  if (!to) return false;
  const Reached reached = advance(side, from->node, *to);
  walk.learn(end, reached.is_whole);
  return reached.node >= 0 && connect(side, reached.node);
}

Configuration BidirectionalTrees::draw(std::mt19937_64& random) const {
  const bool is_far = samples_ % far_samples == 0;
  const Eigen::VectorXd &low = is_far ? low_ : near_low_, &high = is_far ? high_ : near_high_;
  Configuration q(low.size());
  for (Eigen::Index j = 0; j < q.size(); ++j) q[j] = low[j] + (high[j] - low[j]) * random_unit(random);
  return q;
}

/// The smaller tree's; now and then the other's, for the smaller one may not be able to grow.
BidirectionalTrees::Side BidirectionalTrees::next_side() const {
  const Side smaller = trees_[start].nodes.size() <= trees_[goal].nodes.size() ? start : goal;
  return samples_ % 4 == 0 ? other(smaller) : smaller;
}

bool BidirectionalTrees::grow(int samples, std::mt19937_64& random, const TreeGuide& guide) {
  for (int i = 0; i < samples && !problem_.out_of_time(); ++i) {
    ++samples_;
    const Side side = next_side();
    if (guide.walk != nullptr && random_unit(random) < guide.walk_share) {
      if (step_along(*guide.walk, side, random)) return true;
      continue;
    }
    const std::optional<Configuration> q = guide.sample ? guide.sample(random) : std::nullopt;
    const Reached reached = q ? extend(side, *q, true) : extend(side, draw(random), false);
    if (reached.node >= 0 && connect(side, reached.node)) return true;
    const bool is_blocked = reached.from >= 0 && !reached.is_whole;
    if (is_blocked && step_aside(side, std::max(reached.from, reached.node), random)) return true;
  }
  return false;
}

std::vector<Configuration> BidirectionalTrees::path() const {
  std::vector<Configuration> path;
  for (int i = joined_[start]; i >= 0; i = trees_[start].nodes[static_cast<std::size_t>(i)].parent)
    path.push_back(trees_[start].nodes[static_cast<std::size_t>(i)].q);
  std::reverse(path.begin(), path.end());
  for (int i = joined_[goal]; i >= 0; i = trees_[goal].nodes[static_cast<std::size_t>(i)].parent) {
    const Configuration& q = trees_[goal].nodes[static_cast<std::size_t>(i)].q;
    if (q != path.back()) path.push_back(q);
  }
  return path;
}

std::vector<WaypointOrigin> BidirectionalTrees::path_origins() const {
  std::vector<WaypointOrigin> origins;
  for (int i = joined_[start]; i > 0; i = trees_[start].nodes[static_cast<std::size_t>(i)].parent)
    origins.push_back(origin_of(start, i));
  origins.emplace_back();  // the start's
  std::reverse(origins.begin(), origins.end());
  const int met = joined_[goal];
  if (trees_[goal].nodes[static_cast<std::size_t>(met)].q !=
      trees_[start].nodes[static_cast<std::size_t>(joined_[start])].q)
    origins.push_back({PathPhase::start_tree, {}, static_cast<int>(trees_[start].nodes.size())});
  for (int i = met; i > 0; i = trees_[goal].nodes[static_cast<std::size_t>(i)].parent)
    origins.push_back(origin_of(goal, i));
  return origins;
}

/// Some configuration that was reached from the root is farther from it than a share of the space's extent:
/// more than an edge or two.
bool BidirectionalTrees::got_away(Side side) const {
  const double far = 1.5 * range_share * length(near_low_, near_high_);
  const std::vector<Node>& nodes = trees_[side].nodes;
  return std::any_of(nodes.begin(), nodes.end(),
                     [&](const Node& node) { return length(nodes.front().q, node.q) > far; });
}

/// Few nodes of the one tree are told by many of the other's: the smaller tree grows three times as often.
/// A handful of samples says nothing.
bool BidirectionalTrees::seems_walled_in(Side side) const {
  constexpr std::size_t fewer = 100;
  constexpr int least_samples = 100;
  if (samples_ < least_samples) return false;
  const bool is_small = fewer * trees_[side].nodes.size() <= trees_[other(side)].nodes.size();
  return is_small || (!got_away(side) && got_away(other(side)));
}

std::string BidirectionalTrees::reach() const {
  std::string text = std::to_string(trees_[start].nodes.size()) + " reached from the start, " +
                     std::to_string(trees_[goal].nodes.size()) + " from the goal";
  for (const Side side : {start, goal})
    if (seems_walled_in(side))
      text += std::string(": the ") + (side == start ? "start" : "goal") + " may be walled in";
  return "Configurations: " + text + ".";
}

double BidirectionalTrees::sampled_share() const {
  double sampled = 0.0, whole = 0.0;
  for (const Side side : {start, goal}) {
    const std::vector<Node>& nodes = trees_[side].nodes;
    for (int i = joined_[side]; i > 0; i = nodes[static_cast<std::size_t>(i)].parent) {
      const Node& node = nodes[static_cast<std::size_t>(i)];
      const double edge = length(node.q, nodes[static_cast<std::size_t>(node.parent)].q);
      whole += edge;
      if (node.is_sampled) sampled += edge;
    }
  }
  const double gap = length(trees_[start].nodes[static_cast<std::size_t>(joined_[start])].q,
                            trees_[goal].nodes[static_cast<std::size_t>(joined_[goal])].q);
  whole += gap;
  return whole > 0.0 ? sampled / whole : 0.0;
}

}  // namespace clearway
