#include "planning/sampling/ompl_query.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/util/Console.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace clearway {
namespace {

namespace ob = ompl::base;
using State = ob::RealVectorStateSpace::StateType;

/// Samples from the query's own generator: OMPL's are seeded once for the whole process. Where there is a
/// guide, it is asked first.
class SeededSampler : public ob::StateSampler {
 public:
  SeededSampler(const ob::StateSpace* space, OmplQuery* query) : ob::StateSampler(space), query_(query) {}

  void sampleUniform(ob::State* state) override {
    if (query_->guide) {
      if (const auto q = query_->guide(query_->random)) {
        ++query_->samples;
        query_->set(state, *q);
        space_->enforceBounds(state);
        return;
      }
    }
    draw(state, nullptr, 0.0);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    draw(state, near, distance);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    draw(state, mean, deviation);
  }

 private:
  void draw(ob::State* state, const ob::State* near, double distance) {
    ++query_->samples;
    const ob::RealVectorBounds& bounds = space_->as<ob::RealVectorStateSpace>()->getBounds();
    for (unsigned j = 0; j < space_->getDimension(); ++j) {
      const double centre = near ? near->as<State>()->values[j] : 0.0;
      const double low = near ? std::max(bounds.low[j], centre - distance) : bounds.low[j];
      const double high = near ? std::min(bounds.high[j], centre + distance) : bounds.high[j];
      state->as<State>()->values[j] =
          std::uniform_real_distribution<double>(low, std::max(low, high))(query_->random);
    }
  }
  OmplQuery* query_;
};

/// OMPL's own simplifier with the query's seed.
class SeededSimplifier : public ompl::geometric::PathSimplifier {
 public:
  SeededSimplifier(const ob::SpaceInformationPtr& information, OmplQuery& query)
      : ompl::geometric::PathSimplifier(information) {
    rng_.setLocalSeed(static_cast<std::uint_fast32_t>(query.random()));
  }
};

class CertifiedMotions : public ob::MotionValidator {
 public:
  CertifiedMotions(const ob::SpaceInformationPtr& si, OmplQuery* query)
      : ob::MotionValidator(si), query_(query) {}

  bool checkMotion(const ob::State* a, const ob::State* b) const override {
    ++query_->edges;
    return query_->problem.space.is_edge_free(query_->configuration(a), query_->configuration(b));
  }
  bool checkMotion(const ob::State* a, const ob::State* b,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(a, b)) return true;
    if (last_valid.first) si_->copyState(last_valid.first, a);
    last_valid.second = 0.0;
    return false;
  }

 private:
  OmplQuery* query_;
};

/// Joint limits, weighted; where a joint may go much farther than the map and the ends, only as far as these.
ob::RealVectorBounds sampling_bounds(const OmplQuery& query) {
  const PlanProblem& problem = query.problem;
  const Robot& robot = problem.space.robot();
  const Eigen::AlignedBox3d map = problem.space.map().bounds();
  const double map_size = map.isEmpty() ? 0.0 : map.diagonal().norm();
  ob::RealVectorBounds bounds(static_cast<unsigned>(robot.dof()));
  for (std::size_t i = 0; i < robot.dof(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const double low = std::min(problem.start[j], problem.goal[j]),
                 high = std::max(problem.start[j], problem.goal[j]);
    const double margin = robot.joints[i].kind == JointKind::revolute
                              ? 2.0 * std::numbers::pi
                              : map_size + (problem.goal - problem.start).norm();
    bounds.setLow(static_cast<unsigned>(i), query.weight[j] * std::max(robot.joints[i].lower, low - margin));
    bounds.setHigh(static_cast<unsigned>(i),
                   query.weight[j] * std::min(robot.joints[i].upper, high + margin));
  }
  return bounds;
}

}  // namespace

Configuration OmplQuery::configuration(const ob::State* state) const {
  const double* values = state->as<State>()->values;
  return Eigen::Map<const Eigen::VectorXd>(values, weight.size()).cwiseQuotient(weight);
}

void OmplQuery::set(ob::State* state, const Configuration& q) const {
  Eigen::Map<Eigen::VectorXd>(state->as<State>()->values, weight.size()) = weight.cwiseProduct(q);
}

std::mutex& ompl_seeds() {
  static std::mutex mutex;
  return mutex;
}

ob::StateSpacePtr state_space(OmplQuery& query) {
  ompl::msg::noOutputHandler();
  const auto space = std::make_shared<ob::RealVectorStateSpace>(static_cast<unsigned>(query.weight.size()));
  space->setBounds(sampling_bounds(query));
  space->setStateSamplerAllocator(
      [&query](const ob::StateSpace* s) { return std::make_shared<SeededSampler>(s, &query); });
  return space;
}

ob::SpaceInformationPtr certified_space(OmplQuery& query) {
  const auto information = std::make_shared<ob::SpaceInformation>(state_space(query));
  information->setStateValidityChecker([&query](const ob::State* state) {
    ++query.configurations;
    return query.problem.space.is_free(query.configuration(state));
  });
  information->setMotionValidator(std::make_shared<CertifiedMotions>(information, &query));
  const std::lock_guard lock(ompl_seeds());
  information->setup();
  return information;
}

ob::ProblemDefinitionPtr problem_definition(const OmplQuery& query,
                                            const ob::SpaceInformationPtr& information) {
  auto definition = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<ob::RealVectorStateSpace> start(information), goal(information);
  query.set(start.get(), query.problem.start);
  query.set(goal.get(), query.problem.goal);
  definition->setStartAndGoalStates(start, goal);
  return definition;
}

void simplify(OmplQuery& query, const ob::SpaceInformationPtr& information,
              const ob::ProblemDefinition& definition) {
  if (!definition.hasExactSolution()) return;
  const WorkMeter::Scope scope(query.problem.space.meter(), PlanWork::shortcuts);
  std::optional<SeededSimplifier> simplifier;
  {
    const std::lock_guard lock(ompl_seeds());
    simplifier.emplace(information, query);
  }
  simplifier->simplify(*definition.getSolutionPath()->as<ompl::geometric::PathGeometric>(),
                       ob::PlannerTerminationCondition([&query] { return query.problem.out_of_time(); }),
                       false);
}

std::vector<Configuration> waypoints(const OmplQuery& query, const ob::ProblemDefinition& definition) {
  std::vector<Configuration> path;
  if (!definition.hasExactSolution()) return path;
  auto& found = *definition.getSolutionPath()->as<ompl::geometric::PathGeometric>();
  for (const ob::State* state : found.getStates()) path.push_back(query.configuration(state));
  path.front() = query.problem.start;
  path.back() = query.problem.goal;
  return path;
}

}  // namespace clearway
