#include "planning/beam.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <tuple>

#include "planning/beam_search.hpp"
#include "planning/lattice_checks.hpp"
#include "planning/neighbour_queue.hpp"

namespace clearway {
namespace {

/// Lines 4-6 of Fig. 8 with the neighbours in the order of their distance, checked until k are kept. What it
/// keeps from step to step saves time and changes nothing.
class NearestHeads {
 public:
  NearestHeads(const PlanProblem& problem, const Lattice& lattice, const BeamOptions& options)
      : problem_(problem),
        lattice_(lattice),
        options_(options),
        checks_(problem.space, lattice),
        blocked_(static_cast<std::size_t>(lattice.dof())) {}

  std::vector<Head> operator()(const BeamPaths& paths, BeamChecks& counts);

 private:
  /// A head of the beam under expansion.
  struct Source {
    int head;
    Configuration q;
    KnownClearances clearances;
  };
  /// One way to a node.
  struct Way {
    double cost;
    std::size_t source;
  };

  void take_sources(const BeamPaths& paths);
  void take_nearest_group(NeighbourQueue& queue, BeamChecks& counts);
  std::optional<Head> admitted(const BeamPaths& paths, const LatticeIndex& node,
                               std::span<const Neighbour> ways, BeamChecks& counts);

  /// Nodes known to be blocked: so many a head, so that memory stays O(k h).
  static constexpr std::size_t most_blocked_a_head = 64;

  const PlanProblem& problem_;
  const Lattice& lattice_;
  const BeamOptions& options_;
  LatticeChecks checks_;
  /// Nodes found blocked, so that the neighbours of a beam that moves along a wall are not checked again and
  /// again. Bounded: when full it forgets everything.
  NodeSet blocked_;
  std::vector<Source> sources_;
  int first_kept_ = 0;                 ///< number of the first head kept by the last step
  std::vector<KnownClearances> kept_;  ///< clearances of the heads kept by it
  KnownClearances clearances_;         ///< of the node under test
  std::vector<Neighbour> group_;       ///< neighbours at one distance, the first group_size_
  std::size_t group_size_ = 0;
  std::vector<Way> ways_;
  double band_ = 0.0;  ///< of distances that the last step needed
};

/// Numbers in the queue are those of sources_.
void NearestHeads::take_sources(const BeamPaths& paths) {
  sources_.clear();
  for (const int head : paths.beam()) {
    const auto place = static_cast<std::size_t>(head - first_kept_);
    sources_.push_back({head, lattice_.configuration(paths.head(head).node),
                        kept_.empty() ? checks_.measure(paths.head(head).node) : std::move(kept_[place])});
  }
  kept_.clear();
  first_kept_ = paths.head_count();
}

/// All neighbours at the next smallest distance, sorted by node and then in the order of the beam.
void NearestHeads::take_nearest_group(NeighbourQueue& queue, BeamChecks& counts) {
  group_size_ = 0;
  const double distance = queue.next_squared_distance();
  while (!queue.empty() && queue.next_squared_distance() == distance) {
    if (group_size_ == group_.size()) group_.emplace_back();
    queue.pop(group_[group_size_++]);
  }
  counts.neighbours += group_size_;
  const std::span<Neighbour> group = std::span(group_).first(group_size_);
  const bool is_one_node = std::all_of(group.begin(), group.end(), [&](const Neighbour& neighbour) {
    return neighbour.node == group.front().node;
  });
  std::sort(group.begin(), group.end(), [is_one_node](const Neighbour& a, const Neighbour& b) {
    return is_one_node ? a.head < b.head : std::tie(a.node, a.head) < std::tie(b.node, b.head);
  });
}

/// Filters 1-4 for one node: the cheapest head with a free edge to it, or nothing.
std::optional<Head> NearestHeads::admitted(const BeamPaths& paths, const LatticeIndex& node,
                                           std::span<const Neighbour> ways, BeamChecks& counts) {
  if (blocked_.contains(node) || !lattice_.keeps_limits(node) || paths.was_visited(node)) return std::nullopt;
  const auto source = [&](std::size_t i) -> Source& { return sources_[i]; };
  const auto node_of = [&](const Source& from) -> const LatticeIndex& { return paths.head(from.head).node; };
  ++counts.configurations;
  const Source& near = source(static_cast<std::size_t>(ways.front().head));
  if (!checks_.is_free(node, node_of(near), near.clearances, clearances_)) {
    if (blocked_.size() >= most_blocked_a_head * static_cast<std::size_t>(paths.head_count() + 64))
      blocked_.clear();
    blocked_.insert(node);
    return std::nullopt;
  }
  const Configuration q = lattice_.configuration(node);
  const Eigen::VectorXd forces = problem_.cost.generalized_forces(q);
  ways_.clear();
  for (const Neighbour& way : ways) {
    const auto from = static_cast<std::size_t>(way.head);
    ways_.push_back({paths.cost_through(source(from).head, source(from).q, q, forces), from});
  }
  std::sort(ways_.begin(), ways_.end(), [](const Way& a, const Way& b) {
    return std::tie(a.cost, a.source) < std::tie(b.cost, b.source);
  });
  for (const Way& way : ways_) {
    Source& from = source(way.source);
    if (!options_.node_only) {
      ++counts.edges;
      if (!checks_.is_edge_free(node_of(from), from.clearances, node, clearances_)) continue;
    }
    return paths.extend(from.head, node, forces);
  }
  return std::nullopt;
}

std::vector<Head> NearestHeads::operator()(const BeamPaths& paths, BeamChecks& counts) {
  take_sources(paths);
  NeighbourQueue queue(lattice_, band_);
  for (std::size_t i = 0; i < sources_.size(); ++i)
    queue.add_head(static_cast<int>(i), paths.head(sources_[i].head).node);
  struct Candidate {
    Head head;
    KnownClearances clearances;
  };
  std::vector<Candidate> tied;  // equal distances
  const auto width = static_cast<std::size_t>(options_.width);
  std::vector<Head> kept;
  while (kept.size() < width && !queue.empty() && !problem_.out_of_time()) {
    take_nearest_group(queue, counts);
    tied.clear();
    for (std::size_t begin = 0, end = 0; begin < group_size_; begin = end) {
      while (end < group_size_ && group_[end].node == group_[begin].node) ++end;
      const std::span<const Neighbour> ways = std::span<const Neighbour>(group_).subspan(begin, end - begin);
      if (auto head = admitted(paths, group_[begin].node, ways, counts))
        tied.push_back({std::move(*head), clearances_});
    }
    std::sort(tied.begin(), tied.end(), [](const Candidate& a, const Candidate& b) {
      return std::tie(a.head.cost, a.head.node) < std::tie(b.head.cost, b.head.node);
    });
    for (Candidate& candidate : tied) {
      if (kept.size() == width) break;
      kept.push_back(std::move(candidate.head));
      kept_.push_back(std::move(candidate.clearances));
    }
  }
  band_ = kept.size() < width ? 0.0 : queue.band();  // all of them were wanted: no measure for the next step
  return kept;
}

}  // namespace

PlanResult Beam::plan(const PlanProblem& problem) const {
  std::optional<NearestHeads> nearest;
  return search_beam(problem, options_,
                     [&nearest](const PlanProblem& p, const Lattice& lattice, const BeamOptions& options,
                                const BeamPaths& paths, BeamChecks& counts) {
                       if (!nearest) nearest.emplace(p, lattice, options);
                       return (*nearest)(paths, counts);
                     });
}

}  // namespace clearway
