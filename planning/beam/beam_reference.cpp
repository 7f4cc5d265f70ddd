#include "planning/beam/beam_reference.hpp"

#include <algorithm>
#include <tuple>

#include "planning/beam/beam_search.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// Chong 2008, eq. 5: the next of the 3^n perturbations, counting with digits -1, 0, 1. False after the last.
bool next_perturbation(std::vector<int>& change) {
  for (int& digit : change) {
    if (++digit <= 1) return true;
    digit = -1;
  }
  return false;
}

bool is_edge_free(const ConfigurationSpace& space, const Configuration& from, const Configuration& to) {
  const WorkMeter::Scope scope(space.meter(), PlanWork::proofs);
  return space.collision_model().is_edge_free_by_shapes(from, to);
}

/// Lines 4-6 of Chong 2008, Fig. 8. Heads are numbered in the order in which they were kept, so that the
/// first of two parents of equal cost stays.
std::vector<Head> all_heads(const PlanProblem& problem, const Lattice& lattice, const BeamOptions& options,
                            const BeamPaths& paths, BeamChecks& checks) {
  std::map<LatticeIndex, Head> found;
  for (const int parent : paths.beam()) {
    const Configuration from = lattice.configuration(paths.head(parent).node);
    std::vector<int> change(static_cast<std::size_t>(lattice.dof()), -1);
    do {
      LatticeIndex node = paths.head(parent).node;
      for (std::size_t j = 0; j < node.size(); ++j) node[j] += change[j];
      ++checks.neighbours;
      if (!lattice.keeps_limits(node) || paths.visited().contains(node)) continue;  // filters 2 and 3
      const Configuration q = lattice.configuration(node);
      ++checks.configurations;
      if (!problem.space.is_free(q)) continue;  // filter 1: node
      ++checks.edges;
      if (!options.node_only && !is_edge_free(problem.space, from, q)) continue;  // filter 1: edge
      const Head head = paths.extend(parent, node, problem.cost.generalized_forces(q));
      const auto [place, is_new] = found.try_emplace(node, head);
      if (!is_new && head.cost < place->second.cost) place->second = head;  // filter 4
    } while (next_perturbation(change));
  }
  std::vector<Head> heads;
  for (auto& [node, head] : found) heads.push_back(std::move(head));
  std::sort(heads.begin(), heads.end(), [](const Head& a, const Head& b) {
    return std::tie(a.squared_distance, a.cost, a.node) < std::tie(b.squared_distance, b.cost, b.node);
  });
  heads.resize(std::min(heads.size(), static_cast<std::size_t>(options.width)));
  return heads;
}

}  // namespace

BeamReference::BeamReference(const BeamOptions& options)
    : Planner(table_name, text_of_options(table_name, options)), options_(options) {}

PlanResult BeamReference::plan(const PlanProblem& problem) const {
  return search_beam(problem, options_, all_heads);
}

}  // namespace clearway
