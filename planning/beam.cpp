#include "planning/beam.hpp"

#include <algorithm>
#include <optional>
#include <tuple>
#include <unordered_set>

#include "planning/beam_search.hpp"
#include "planning/neighbour_queue.hpp"

namespace clearway {
namespace {

/// Nodes found blocked, so that the neighbours of a beam that moves along a wall are not checked again and
/// again. Bounded: when full it forgets everything, which costs time and changes nothing else.
class BlockedNodes {
 public:
  bool contains(const LatticeIndex& node) const { return nodes_.contains(node); }
  void insert(const LatticeIndex& node) {
    if (nodes_.size() >= most) nodes_.clear();
    nodes_.insert(node);
  }

 private:
  static constexpr std::size_t most = std::size_t{1} << 18;
  struct Hash {
    std::size_t operator()(const LatticeIndex& node) const {
      std::uint64_t hash = 1469598103934665603ull;  // FNV-1a
      for (const int index : node) hash = (hash ^ static_cast<std::uint32_t>(index)) * 1099511628211ull;
      return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
  };
  std::unordered_set<LatticeIndex, Hash> nodes_;
};

/// All neighbours at the next smallest distance, by node, each with its heads in the order of the beam.
std::map<LatticeIndex, std::vector<int>> nearest_group(NeighbourQueue& queue, BeamChecks& checks) {
  std::map<LatticeIndex, std::vector<int>> group;
  const double distance = queue.next_squared_distance();
  while (!queue.empty() && queue.next_squared_distance() == distance) {
    Neighbour neighbour = queue.pop();
    ++checks.neighbours;
    group[std::move(neighbour.node)].push_back(neighbour.head);
  }
  for (auto& [node, heads] : group) std::sort(heads.begin(), heads.end());
  return group;
}

/// Filters 1-4 for one node: the cheapest head with a free edge to it, or nothing.
std::optional<Head> admitted(const PlanProblem& problem, const Lattice& lattice, const BeamOptions& options,
                             const BeamPaths& paths, const LatticeIndex& node,
                             const std::vector<int>& parents, BeamChecks& checks, BlockedNodes& blocked) {
  if (blocked.contains(node) || !lattice.keeps_limits(node) || paths.was_visited(node)) return std::nullopt;
  const Configuration q = lattice.configuration(node);
  ++checks.configurations;
  if (!problem.space.is_free(q)) {
    blocked.insert(node);
    return std::nullopt;
  }
  const Eigen::VectorXd forces = problem.cost.generalized_forces(q);
  std::vector<Head> candidates;
  for (const int parent : parents) candidates.push_back(paths.extend(parent, node, forces));
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Head& a, const Head& b) { return a.cost < b.cost; });
  for (Head& candidate : candidates) {
    if (options.node_only) return candidate;
    ++checks.edges;
    if (problem.space.is_edge_free(lattice.configuration(paths.head(candidate.parent).node), q))
      return candidate;
  }
  return std::nullopt;
}

std::vector<Head> nearest_heads(const PlanProblem& problem, const Lattice& lattice,
                                const BeamOptions& options, const BeamPaths& paths, BeamChecks& checks,
                                BlockedNodes& blocked) {
  NeighbourQueue queue(lattice);
  for (const int head : paths.beam()) queue.add_head(head, paths.head(head).node);
  const auto width = static_cast<std::size_t>(options.width);
  std::vector<Head> kept;
  while (kept.size() < width && !queue.empty() && !problem.out_of_time()) {
    std::vector<Head> tied;  // equal distances
    for (const auto& [node, parents] : nearest_group(queue, checks)) {
      if (auto head = admitted(problem, lattice, options, paths, node, parents, checks, blocked)) {
        tied.push_back(std::move(*head));
      }
    }
    std::sort(tied.begin(), tied.end(), [](const Head& a, const Head& b) {
      return std::tie(a.cost, a.node) < std::tie(b.cost, b.node);
    });
    for (Head& head : tied) {
      if (kept.size() < width) kept.push_back(std::move(head));
    }
  }
  return kept;
}

}  // namespace

PlanResult Beam::plan(const PlanProblem& problem) const {
  BlockedNodes blocked;
  return search_beam(problem, options_,
                     [&blocked](const PlanProblem& p, const Lattice& lattice, const BeamOptions& options,
                                const BeamPaths& paths, BeamChecks& checks) {
                       return nearest_heads(p, lattice, options, paths, checks, blocked);
                     });
}

}  // namespace clearway
