#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/beam/beam.hpp"
#include "planning/beam/beam_guided.hpp"
#include "planning/beam/beam_reference.hpp"
#include "planning/boundary/boundary.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/boundary/boundary_sides.hpp"
#include "planning/boundary/constraint.hpp"
#include "planning/planner_table.hpp"
#include "planning/sampling/ompl_planners.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "planning/sampling/rrtconnect_fcl.hpp"

namespace clearway {
namespace {

template <typename P>
std::unique_ptr<Planner> make(const PlannerOptions& options) {
  return std::make_unique<P>(options);
}

template <OmplAlgorithm algorithm>
std::unique_ptr<Planner> make_of_ompl(const PlannerOptions& options) {
  return std::make_unique<OmplPlanner>(algorithm, options);
}

}  // namespace

const std::vector<PlannerEntry>& planner_table() {
  static const std::vector<PlannerEntry> table = {
      {"beam", "beam search on a joint lattice (Chong et al. 2008, Fig. 8)", make<Beam>},
      {"beam_guided", "beam search led by a route through paint or free voxels, then straightened (ours)",
       make<BeamGuided>},
      {"beam_reference", "beam with every neighbour checked: slow and obvious, for comparison",
       make<BeamReference>},
      {"bitstar", "BIT* of OMPL, with certified edges: improves its path until samples or time are out",
       make_of_ompl<OmplAlgorithm::bitstar>},
      {"boundary", "constraint method with boundary following (Lahouar et al. 2006)", make<Boundary>},
      {"boundary_plus",
       "local method and boundary following in several planes, then a hand-over to sampled trees (ours)",
       make<BoundaryPlus>},
      {"boundary_sides", "boundary on both sides and with both leave ratios, until one succeeds (ours)",
       make<BoundarySides>},
      {"constraint", "the local step of boundary alone: stops at the first deadlock", make<Constraint>},
      {"est", "EST of OMPL, with certified edges", make_of_ompl<OmplAlgorithm::est>},
      {"prm", "PRM of OMPL, with certified edges", make_of_ompl<OmplAlgorithm::prm>},
      {"rrtconnect", "RRT-Connect of OMPL, with certified edges", make<RrtConnect>},
      {"rrtconnect_fcl", "RRT-Connect of OMPL as most people run it: FCL on an octree, edges not certified",
       make<RrtConnectFcl>},
      {"rrtstar", "RRT* of OMPL, with certified edges: improves its path until samples or time are out",
       make_of_ompl<OmplAlgorithm::rrtstar>},
  };
  return table;
}

std::unique_ptr<Planner> make_planner(std::string_view name, const PlannerOptions& options) {
  std::vector<std::string> known;
  for (const PlannerEntry& entry : planner_table()) {
    if (entry.name == name) return entry.make(options);
    known.emplace_back(entry.name);
  }
  throw std::invalid_argument("unknown planner " + quote(name) + ": did you mean '" +
                              nearest_name(name, known) + "'?");
}

}  // namespace clearway
