// Edges: ConfigurationSpace::is_edge_free and what belongs to it. Spheres decide most, shapes
// (edge_proof.cpp) the rest.

#include <algorithm>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// ConfigurationSpace::free_share; a share below the least that is of use may be reported as 0.
double proved_share(const CollisionModel& model, const Configuration& from, const Configuration& to,
                    double least_share) {
  if (!model.is_within_limits(from) || !model.is_within_limits(to)) return 0.0;
  if (model.spheres && model.spheres->suits(from) && model.spheres->suits(to)) {
    EdgePieces& pieces = of_this_thread<EdgePieces>(*model.spheres);
    const EdgePieces::Finding finding = pieces.examine(from, to, least_share);
    if (finding == EdgePieces::Finding::free ||
        (finding == EdgePieces::Finding::open &&
         model.are_pieces_free(from, to, pieces.open_pieces(), pieces.open_members())))
      return 1.0;
    return pieces.proved_share();
  }
  return model.is_edge_free_by_shapes(from, to) ? 1.0 : 0.0;
}

}  // namespace

bool ConfigurationSpace::is_edge_free(const Configuration& from, const Configuration& to) const {
  const WorkMeter::Scope scope(meter_, PlanWork::proofs);
  return proved_share(*model_, from, to, 1.0) == 1.0;
}

bool ConfigurationSpace::is_edge_quickly_free(const Configuration& from, const Configuration& to) const {
  const WorkMeter::Scope scope(meter_, PlanWork::proofs);
  const CollisionModel& model = *model_;
  if (!model.spheres) return is_edge_free(from, to);
  if (!model.is_within_limits(from) || !model.is_within_limits(to)) return false;
  if (!model.spheres->suits(from) || !model.spheres->suits(to)) return is_edge_free(from, to);
  return of_this_thread<EdgePieces>(*model.spheres).is_free(from, to);
}

double ConfigurationSpace::free_share(const Configuration& from, const Configuration& to) const {
  constexpr double of_use = 0.25;
  const WorkMeter::Scope scope(meter_, PlanWork::proofs);
  return proved_share(*model_, from, to, of_use);
}

double ConfigurationSpace::motion_bound(const Eigen::VectorXd& abs_dq) const {
  const auto dof = static_cast<Eigen::Index>(model_->robot.dof());
  if (abs_dq.size() != dof)
    throw std::invalid_argument("motion bound: expected " + counted(dof, "value") +
                                ", one for each joint of " + model_->robot.name + ", got " +
                                std::to_string(abs_dq.size()));
  if (!abs_dq.allFinite() || (abs_dq.array() < 0.0).any())
    throw std::invalid_argument("motion bound: expected finite values, none below 0");
  double largest = 0.0;
  for (const Eigen::VectorXd& levers : model_->levers) largest = std::max(largest, levers.dot(abs_dq));
  return largest;
}

}  // namespace clearway
