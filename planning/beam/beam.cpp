#include "planning/beam/beam.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <tuple>

#include "planning/beam/beam_search.hpp"
#include "planning/beam/lattice_checks.hpp"
#include "planning/beam/lattice_poses.hpp"
#include "planning/beam/neighbour_queue.hpp"
#include "planning/problem/option_reader.hpp"

namespace clearway {
namespace {

/// Lines 4-6 of Chong 2008, Fig. 8, with the neighbours in the order of their distance, checked until k are
/// kept. What it keeps from step to step saves time and changes nothing.
class NearestHeads {
 public:
  NearestHeads(const PlanProblem& problem, const Lattice& lattice, const BeamOptions& options,
               const BeamPaths& paths)
      : problem_(problem),
        lattice_(lattice),
        options_(options),
        paths_(paths),
        checks_(problem.space, lattice),
        cost_poses_(problem.cost.robot(), lattice, problem.cost.scale()),
        deciding_(checks_.deciding_joints()),
        closed_(static_cast<std::size_t>(lattice.dof()), paths.visited()),
        queue_(lattice, 0.0, &closed_, [&problem] { return problem.out_of_time(); }),
        free_(deciding_),
        edges_(2 * deciding_) {}

  std::vector<Head> operator()(BeamChecks& counts);

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
  struct Candidate {
    Head head;
    KnownClearances clearances;
  };

  void take_sources();
  void take_nearest(std::vector<Candidate>& tied, BeamChecks& counts);
  std::optional<Head> admitted(const LatticeIndex& node, std::span<const int> sources, BeamChecks& counts);
  bool is_free(const LatticeIndex& node, const Source& near, BeamChecks& counts);
  bool is_edge_free(Source& from, const LatticeIndex& node, BeamChecks& counts);
  const LatticeIndex& node_of(const Source& source) const { return paths_.head(source.head).node; }
  /// What is known of nodes and edges is bounded by that for each head kept so far, so that memory stays
  /// O(k h): when there is more, it is forgotten and begun anew.
  std::size_t most(std::size_t a_head) const {
    return a_head * static_cast<std::size_t>(paths_.head_count() + 64);
  }

  const PlanProblem& problem_;
  const Lattice& lattice_;
  const BeamOptions& options_;
  const BeamPaths& paths_;
  LatticeChecks checks_;
  LatticePoses cost_poses_;
  std::size_t deciding_;  ///< joints
  BlockedNodes closed_;   ///< so that the neighbours of a beam along a wall are not checked again and again
  NeighbourQueue queue_;
  NodeSet free_;  ///< by the deciding joints
  std::vector<KnownClearances> free_clearances_;
  NodeSet edges_;                   ///< by the deciding joints of both ends
  std::vector<bool> is_edge_free_;  ///< of these
  std::vector<Source> sources_;
  int first_kept_ = 0;                 ///< number of the first head kept by the last step
  std::vector<KnownClearances> kept_;  ///< clearances of the heads kept by it
  KnownClearances clearances_;         ///< of the node under test
  Neighbour neighbour_;
  LatticeIndex edge_;
  std::vector<Way> ways_;
  double band_ = 0.0;  ///< of distances that the last step needed
};

/// Numbers in the queue are those of sources_.
void NearestHeads::take_sources() {
  sources_.clear();
  queue_.restart(band_);
  for (const int head : paths_.beam()) {
    if (sources_.size() % 256 == 255 && problem_.out_of_time()) break;  // a wide beam's heads take a while
    const auto place = static_cast<std::size_t>(head - first_kept_);
    const LatticeIndex& node = paths_.head(head).node;
    queue_.add_head(static_cast<int>(sources_.size()), node);
    sources_.push_back({head, lattice_.configuration(node),
                        kept_.empty() ? checks_.measure(node) : std::move(kept_[place])});
  }
  kept_.clear();
  first_kept_ = paths_.head_count();
}

/// The node itself, by what is known or by a look; `clearances_` are then its own.
bool NearestHeads::is_free(const LatticeIndex& node, const Source& near, BeamChecks& counts) {
  if (const std::uint32_t known = free_.find(node.data()); known != NodeSet::none) {
    clearances_ = free_clearances_[known];
    return true;
  }
  ++counts.configurations;
  if (!checks_.is_free(node, node_of(near), near.clearances, clearances_)) {
    closed_.block(node.data(), checks_.blocking_joints(), most(64));
    return false;
  }
  if (free_.size() >= most(2)) {
    free_.clear();
    free_clearances_.clear();
  }
  free_.insert(node);
  free_clearances_.push_back(clearances_);
  return true;
}

bool NearestHeads::is_edge_free(Source& from, const LatticeIndex& node, BeamChecks& counts) {
  const auto look = [&] {
    ++counts.edges;
    return checks_.is_edge_free(node_of(from), from.clearances, node, clearances_);
  };
  if (deciding_ == node.size()) return look();  // no two edges are alike
  const auto deciding = static_cast<std::ptrdiff_t>(deciding_);
  edge_.assign(node_of(from).begin(), node_of(from).begin() + deciding);
  edge_.insert(edge_.end(), node.begin(), node.begin() + deciding);
  if (const std::uint32_t known = edges_.find(edge_.data()); known != NodeSet::none)
    return is_edge_free_[known];
  if (edges_.size() >= most(8)) {
    edges_.clear();
    is_edge_free_.clear();
  }
  edges_.insert(edge_);
  is_edge_free_.push_back(look());
  return is_edge_free_.back();
}

/// Filters 1-4 for one node: the cheapest head with a free edge to it, or nothing.
std::optional<Head> NearestHeads::admitted(const LatticeIndex& node, std::span<const int> sources,
                                           BeamChecks& counts) {
  // The queue leaves off what was visited, and what was blocked when its band began.
  if (closed_.is_blocked(node) || !lattice_.keeps_limits(node)) return std::nullopt;
  if (!is_free(node, sources_[static_cast<std::size_t>(sources.front())], counts)) return std::nullopt;
  const Configuration q = lattice_.configuration(node);
  const Eigen::VectorXd forces = problem_.cost.generalized_forces(cost_poses_.all_at(node));
  ways_.clear();
  for (const int source : sources) {
    const Source& from = sources_[static_cast<std::size_t>(source)];
    ways_.push_back({paths_.cost_through(from.head, from.q, q, forces), static_cast<std::size_t>(source)});
  }
  std::sort(ways_.begin(), ways_.end(), [](const Way& a, const Way& b) {
    return std::tie(a.cost, a.source) < std::tie(b.cost, b.source);
  });
  for (const Way& way : ways_) {
    Source& from = sources_[way.source];
    if (options_.node_only || is_edge_free(from, node, counts)) return paths_.extend(from.head, node, forces);
  }
  return std::nullopt;
}

/// All at the next smallest distance that pass, the preferred ones first; fewer once out of time.
void NearestHeads::take_nearest(std::vector<Candidate>& tied, BeamChecks& counts) {
  tied.clear();
  const double distance = queue_.next_squared_distance();
  constexpr std::size_t checks_a_look = 16;  // at the time
  for (std::size_t i = 1; !queue_.empty() && queue_.next_squared_distance() == distance; ++i) {
    if (i % checks_a_look == 0 && problem_.out_of_time()) break;
    queue_.pop(neighbour_);
    if (auto head = admitted(neighbour_.node, neighbour_.heads, counts))
      tied.push_back({std::move(*head), clearances_});
  }
  std::sort(tied.begin(), tied.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.head.cost, a.head.node) < std::tie(b.head.cost, b.head.node);
  });
}

std::vector<Head> NearestHeads::operator()(BeamChecks& counts) {
  take_sources();
  std::vector<Candidate> tied;
  const auto width = static_cast<std::size_t>(options_.width);
  std::vector<Head> kept;
  while (kept.size() < width && !queue_.empty() && !problem_.out_of_time()) {
    take_nearest(tied, counts);
    for (Candidate& candidate : tied) {
      if (kept.size() == width) break;
      kept.push_back(std::move(candidate.head));
      kept_.push_back(std::move(candidate.clearances));
    }
  }
  counts.neighbours += queue_.popped();
  band_ = kept.size() < width ? 0.0 : queue_.band();  // all of them were wanted: no measure for the next step
  return kept;
}

}  // namespace

Beam::Beam(const BeamOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult Beam::plan(const PlanProblem& problem) const {
  std::optional<NearestHeads> nearest;
  return search_beam(problem, options_,
                     [&nearest](const PlanProblem& p, const Lattice& lattice, const BeamOptions& options,
                                const BeamPaths& paths, BeamChecks& counts) {
                       if (!nearest) nearest.emplace(p, lattice, options, paths);
                       return (*nearest)(counts);
                     });
}

}  // namespace clearway
