#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/auto_planner.hpp"
#include "planning/beam/beam.hpp"
#include "planning/beam/beam_guided.hpp"
#include "planning/beam/beam_reference.hpp"
#include "planning/boundary/boundary.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/boundary/boundary_sides.hpp"
#include "planning/boundary/constraint.hpp"
#include "planning/planner_table.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/sampling/fcl_planners.hpp"
#include "planning/sampling/ompl_planners.hpp"
#include "planning/sampling/rrtconnect.hpp"

namespace clearway {
namespace {

template <typename P>
std::unique_ptr<Planner> make(const PlannerOptions& text) {
  return std::make_unique<P>(options_of_text<typename P::Options>(P::table_name, text));
}

template <typename P>
PlannerEntry entry(std::string_view description) {
  return {P::table_name, description, make<P>, !std::is_base_of_v<FclPlanner, P>};
}

}  // namespace

const std::vector<PlannerEntry>& planner_table() {
  static const std::vector<PlannerEntry> table = {
      entry<AutoPlanner>(
          "the one to call: trees, local method and guided search in turn, until one succeeds"),
      entry<Beam>("beam search on a joint lattice (Chong et al. 2008, Fig. 8)"),
      entry<BeamGuided>("beam search led by a route through paint or free voxels, then straightened (ours)"),
      entry<BeamReference>("beam with every neighbour checked: slow and obvious, for comparison"),
      entry<BitStar>("BIT* of OMPL, with certified edges: improves its path until samples or time are out"),
      entry<BitStarFcl>("BIT* of OMPL with FCL on an octree, edges not certified"),
      entry<Boundary>("constraint method with boundary following (Lahouar et al. 2006)"),
      entry<BoundaryPlus>(
          "local method and boundary following in several planes, then a hand-over to sampled trees (ours)"),
      entry<BoundarySides>("boundary on both sides and with both leave ratios, until one succeeds (ours)"),
      entry<Constraint>("the local step of boundary alone: stops at the first deadlock"),
      entry<Est>("EST of OMPL, with certified edges"),
      entry<KpieceFcl>("KPIECE of OMPL with FCL on an octree, edges not certified"),
      entry<Prm>("PRM of OMPL, with certified edges"),
      entry<PrmFcl>("PRM of OMPL with FCL on an octree, edges not certified"),
      entry<RrtConnect>("RRT-Connect on certified edges, many pieces of them at once, then shortcuts (ours)"),
      entry<RrtConnectFcl>(
          "RRT-Connect of OMPL as most people run it: FCL on an octree, edges not certified"),
      entry<RrtConnectOmpl>("RRT-Connect of OMPL, with certified edges and OMPL's simplification"),
      entry<RrtStar>("RRT* of OMPL, with certified edges: improves its path until samples or time are out"),
  };
  return table;
}

std::unique_ptr<Planner> make_planner(std::string_view name, const PlannerOptions& options) {
  std::vector<std::string> known;
  for (const PlannerEntry& planner : planner_table()) {
    if (planner.name == name) return planner.make(options);
    known.emplace_back(planner.name);
  }
  throw std::invalid_argument("unknown planner " + quote(name) + ": " + suggestion(name, known));
}

}  // namespace clearway
