#include "planning/sampling/ompl_algorithm.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/samplers/InformedStateSampler.h>
#include <ompl/base/spaces/RealVectorStateProjections.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/util/RandomNumbers.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace clearway {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;

/// A planner whose own generator is the query's: OMPL seeds one after the other from the process's.
template <class Algorithm>
class Seeded : public Algorithm {
 public:
  Seeded(const ob::SpaceInformationPtr& information, std::uint64_t seed) : Algorithm(information) {
    this->rng_.setLocalSeed(static_cast<std::uint_fast32_t>(seed));
  }
};

/// PRM's solve() looks for a way in a second thread while it samples, so that when it ends is a matter of
/// luck. This looks every so many samples; of three such rounds two grow the roadmap and one expands it, as
/// PRM::constructRoadmap has it by time.
class Roadmap : public Seeded<og::PRM> {
 public:
  using Seeded::Seeded;

  ob::PlannerStatus solve(const ob::PlannerTerminationCondition& end) override {
    constexpr int tries_a_round = 64;
    checkValidity();
    while (const ob::State* start = pis_.nextStart()) startM_.push_back(addMilestone(si_->cloneState(start)));
    while (const ob::State* goal = pis_.nextGoal()) goalM_.push_back(addMilestone(si_->cloneState(goal)));
    if (startM_.empty() || goalM_.empty()) return ob::PlannerStatus::INVALID_START;
    for (int round = 0;; ++round) {
      ob::PathPtr path;
      if (maybeConstructSolution(startM_, goalM_, path)) {
        pdef_->addSolutionPath(path);
        return ob::PlannerStatus::EXACT_SOLUTION;
      }
      if (end()) return ob::PlannerStatus::TIMEOUT;
      int tries = 0;
      const ob::PlannerTerminationCondition enough([&] { return ++tries > tries_a_round || end(); });
      if (round % 3 == 2)
        expandRoadmap(enough);
      else
        growRoadmap(enough);
    }
  }
};

/// Samples that can shorten a path of given length: of the ellipsoid about start and goal (Gammell et al.
/// 2014), drawn by the query's generator; before there is a path, as the space's own sampler draws them.
/// OMPL's own draw from generators that nobody can seed.
class EllipsoidSampler : public ob::InformedSampler {
 public:
  /// @param is_over asked before each try, as OMPL asks only between batches
  EllipsoidSampler(const ob::ProblemDefinitionPtr& definition, unsigned most_tries, OmplQuery& query,
                   const std::function<bool()>& is_over)
      : ob::InformedSampler(definition, most_tries),
        query_(query),
        is_over_(is_over),
        uniform_(space_->allocStateSampler()),
        middle_(query.weight.cwiseProduct(query.problem.start + query.problem.goal) / 2),
        between_(query.weight.cwiseProduct(query.problem.goal - query.problem.start)) {}

  bool sampleUniform(ob::State* state, const ob::Cost& below) override {
    return draw(state, ob::Cost(0.0), below);
  }
  bool sampleUniform(ob::State* state, const ob::Cost& from, const ob::Cost& below) override {
    return draw(state, from, below);
  }
  bool hasInformedMeasure() const override { return true; }
  double getInformedMeasure(const ob::Cost& cost) const override {
    if (!opt_->isFinite(cost)) return space_->getMeasure();
    const double n = static_cast<double>(between_.size());
    const double ball = std::pow(std::numbers::pi, n / 2) / std::tgamma(n / 2 + 1);
    return std::min(space_->getMeasure(), ball * cost.value() / 2 * std::pow(half_width(cost), n - 1));
  }

 private:
  /// Of the ellipsoid of all points by which a path from end to end of that length can lead.
  double half_width(const ob::Cost& cost) const {
    return std::sqrt(std::max(0.0, cost.value() * cost.value() - between_.squaredNorm())) / 2;
  }

  /// Uniform in that ellipsoid: a point of the unit ball, stretched along the first axis, which a reflection
  /// then puts on the line between the ends.
  Configuration inside(const ob::Cost& cost) {
    std::normal_distribution<double> normal;
    Configuration point(between_.size());
    for (double& value : point) value = normal(query_.random);
    const double radius = std::pow(std::uniform_real_distribution<double>()(query_.random),
                                   1.0 / static_cast<double>(point.size()));
    point *= radius / point.norm();
    point[0] *= cost.value() / 2;
    point.tail(point.size() - 1) *= half_width(cost);
    const double distance = between_.norm();
    if (distance > 0.0) {
      Configuration mirror = between_ / distance;
      mirror[0] -= 1.0;
      if (mirror.squaredNorm() > 0.0) point -= 2.0 * mirror.dot(point) / mirror.squaredNorm() * mirror;
    }
    return middle_ + point;
  }

  bool draw(ob::State* state, const ob::Cost& from, const ob::Cost& below) {
    const bool in_ellipsoid = getInformedMeasure(below) < space_->getMeasure();
    for (unsigned i = 0; i < numIters_ && !is_over_(); ++i) {
      if (in_ellipsoid) {
        ++query_.samples;
        query_.set(state, inside(below).cwiseQuotient(query_.weight));
        if (!space_->satisfiesBounds(state)) continue;
      } else {
        uniform_->sampleUniform(state);
      }
      const ob::Cost at_least = heuristicSolnCost(state);
      if (opt_->isCostBetterThan(at_least, below) && !opt_->isCostBetterThan(at_least, from)) return true;
    }
    return false;
  }

  OmplQuery& query_;
  const std::function<bool()>& is_over_;
  ob::StateSamplerPtr uniform_;
  Eigen::VectorXd middle_, between_;  ///< of start and goal, weighted
};

/// Path length, sampled so.
class ShortPath : public ob::PathLengthOptimizationObjective {
 public:
  ShortPath(const ob::SpaceInformationPtr& information, OmplQuery& query,
            const std::function<bool()>& is_over)
      : ob::PathLengthOptimizationObjective(information), query_(query), is_over_(is_over) {}
  ob::InformedSamplerPtr allocInformedStateSampler(const ob::ProblemDefinitionPtr& definition,
                                                   unsigned most_tries) const override {
    return std::make_shared<EllipsoidSampler>(definition, most_tries, query_, is_over_);
  }

 private:
  OmplQuery& query_;
  const std::function<bool()>& is_over_;
};

/// The first two joints, as MoveIt's files have it, in twenty cells each; OMPL's own projection is drawn at
/// random.
ob::ProjectionEvaluatorPtr first_joints(const ob::StateSpacePtr& space) {
  constexpr double cells = 20.0;
  const ob::RealVectorBounds& bounds = space->as<ob::RealVectorStateSpace>()->getBounds();
  std::vector<unsigned> joints(std::min(2U, space->getDimension()));
  std::iota(joints.begin(), joints.end(), 0U);
  std::vector<double> sizes;
  for (const unsigned j : joints) sizes.push_back(std::max(1e-9, (bounds.high[j] - bounds.low[j]) / cells));
  return std::make_shared<ob::RealVectorOrthogonalProjectionEvaluator>(space, sizes, joints);
}

ob::PlannerPtr make(const OmplAlgorithmOptions& options, const OmplQuery& query,
                    const ob::SpaceInformationPtr& information) {
  const std::uint64_t seed = query.problem.seed;
  switch (options.algorithm) {
    case OmplAlgorithm::rrtconnect: {
      const auto trees = std::make_shared<og::RRTConnect>(information);
      trees->setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default draws from OMPL's generator
      trees->setRange(options.range);
      return trees;
    }
    case OmplAlgorithm::est: {
      const auto est = std::make_shared<Seeded<og::EST>>(information, seed);
      est->setRange(options.range);
      return est;
    }
    case OmplAlgorithm::prm:
      return std::make_shared<Roadmap>(information, seed);
    case OmplAlgorithm::rrtstar: {
      const auto rrtstar = std::make_shared<Seeded<og::RRTstar>>(information, seed);
      rrtstar->setRange(options.range);
      return rrtstar;
    }
    case OmplAlgorithm::bitstar: {
      const auto bitstar = std::make_shared<og::BITstar>(information);
      bitstar->setSamplesPerBatch(static_cast<unsigned>(options.batch));
      return bitstar;
    }
    case OmplAlgorithm::kpiece: {
      ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(1 + seed % 0xFFFFFFFFU));  // 0 is none
      const auto kpiece = std::make_shared<Seeded<og::KPIECE1>>(information, seed);
      kpiece->setRange(options.range);
      kpiece->setProjectionEvaluator(first_joints(information->getStateSpace()));
      return kpiece;
    }
  }
  return nullptr;
}

}  // namespace

ob::PlannerPtr make_algorithm(const OmplAlgorithmOptions& options, OmplQuery& query,
                              const ob::SpaceInformationPtr& information,
                              const ob::ProblemDefinitionPtr& definition,
                              const std::function<bool()>& is_over) {
  // These improve their path; the others take the first one.
  if (options.algorithm == OmplAlgorithm::rrtstar || options.algorithm == OmplAlgorithm::bitstar)
    definition->setOptimizationObjective(std::make_shared<ShortPath>(information, query, is_over));
  const std::lock_guard lock(ompl_seeds());
  ob::PlannerPtr planner = make(options, query, information);
  planner->setProblemDefinition(definition);
  planner->setup();
  return planner;
}

}  // namespace clearway
