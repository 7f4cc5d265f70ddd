#include "planning/sampling/ompl_planners.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/samplers/InformedStateSampler.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "planning/problem/option_reader.hpp"
#include "planning/sampling/ompl_query.hpp"
#include "planning/space/joint_weights.hpp"

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

// The ranges that several of the planners share.

double read_range(OptionReader& reader, double initial) {
  return reader.number_or_auto("range", initial, 0.0, 1e3);
}
double read_prismatic_scale(OptionReader& reader, double initial) {
  return reader.number_or_auto("prismatic_scale", initial, 0.0, 1e6);
}
int read_max_samples(OptionReader& reader, int initial) {
  return reader.integer("max_samples", initial, 1, 100000000);
}
int read_shortcuts(OptionReader& reader, int initial) {
  return reader.integer("shortcuts", initial, 0, 1000000);
}

}  // namespace

RrtConnectOmplOptions read_options(OptionReader& reader, RrtConnectOmplOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .simplify = reader.flag("simplify", initial.simplify)};
}

EstOptions read_options(OptionReader& reader, EstOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

PrmOptions read_options(OptionReader& reader, PrmOptions initial) {
  return {.prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

RrtStarOptions read_options(OptionReader& reader, RrtStarOptions initial) {
  return {.range = read_range(reader, initial.range),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

BitStarOptions read_options(OptionReader& reader, BitStarOptions initial) {
  return {.batch = reader.integer("batch", initial.batch, 1, 1000000),
          .prismatic_scale = read_prismatic_scale(reader, initial.prismatic_scale),
          .max_samples = read_max_samples(reader, initial.max_samples),
          .shortcuts = read_shortcuts(reader, initial.shortcuts)};
}

OmplPlanner::OmplPlanner(std::string_view name, PlannerOptions in_force, const Settings& settings)
    : Planner(name, std::move(in_force)), settings_(settings) {}

RrtConnectOmpl::RrtConnectOmpl(const RrtConnectOmplOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = Algorithm::rrtconnect,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .simplify = options.simplify}) {}

Est::Est(const EstOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = Algorithm::est,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

Prm::Prm(const PrmOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = Algorithm::prm,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

RrtStar::RrtStar(const RrtStarOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = Algorithm::rrtstar,
                   .range = options.range,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

BitStar::BitStar(const BitStarOptions& options)
    : OmplPlanner(table_name, text_of_options(table_name, options),
                  {.algorithm = Algorithm::bitstar,
                   .batch = options.batch,
                   .prismatic_scale = options.prismatic_scale,
                   .max_samples = options.max_samples,
                   .shortcuts = options.shortcuts}) {}

PlanResult OmplPlanner::plan(const PlanProblem& problem) const {
  const PlanResult ends = check_ends(problem);
  if (ends.status != PlanStatus::solved) return ends;
  const Algorithm algorithm = settings_.algorithm;
  OmplQuery query{
      problem, joint_weights(problem.space, settings_.prismatic_scale), std::mt19937_64(problem.seed), {}};
  if (problem.start == problem.goal)  // there is nothing to improve on
    return result_of(problem, ends, {.waypoints = {problem.start, problem.goal}}, query.weight, 0);
  const ob::SpaceInformationPtr information = certified_space(query);
  const ob::ProblemDefinitionPtr definition = problem_definition(query, information);
  TreePath found;
  const std::function<bool()> is_over = [&] {
    found.out_of_time = problem.out_of_time();
    return found.out_of_time || query.samples >= settings_.max_samples;
  };
  if (algorithm == Algorithm::rrtstar || algorithm == Algorithm::bitstar)  // the others take the first path
    definition->setOptimizationObjective(std::make_shared<ShortPath>(information, query, is_over));
  ob::PlannerPtr planner;
  if (algorithm == Algorithm::rrtconnect) {
    const auto trees = std::make_shared<og::RRTConnect>(information);
    trees
        ->setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default draws from OMPL's own generator
    trees->setRange(settings_.range);
    planner = trees;
  } else if (algorithm == Algorithm::est) {
    const auto est = std::make_shared<Seeded<og::EST>>(information, problem.seed);
    est->setRange(settings_.range);
    planner = est;
  } else if (algorithm == Algorithm::prm) {
    planner = std::make_shared<Roadmap>(information, problem.seed);
  } else if (algorithm == Algorithm::rrtstar) {
    const auto rrtstar = std::make_shared<Seeded<og::RRTstar>>(information, problem.seed);
    rrtstar->setRange(settings_.range);
    planner = rrtstar;
  } else {
    const auto bitstar = std::make_shared<og::BITstar>(information);
    bitstar->setSamplesPerBatch(static_cast<unsigned>(settings_.batch));
    planner = bitstar;
  }
  planner->setProblemDefinition(definition);
  planner->setup();
  planner->solve(ob::PlannerTerminationCondition(is_over));
  if (settings_.simplify) simplify(query, information, *definition);
  found.waypoints = waypoints(query, *definition);
  found.samples = query.samples;
  found.configurations = query.configurations;
  found.edges = query.edges;
  return result_of(problem, ends, std::move(found), query.weight, settings_.shortcuts);
}

}  // namespace clearway
