#include "planning/sampling/fcl_planners.hpp"

#include <ompl/base/Planner.h>

#include <algorithm>
#include <mutex>

#include "mapping/system/number_text.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/robot/same_robot.hpp"
#include "planning/sampling/fcl_octree_space.hpp"
#include "planning/sampling/ompl_algorithm.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

namespace ob = ompl::base;

ob::SpaceInformationPtr sampled_checks(OmplQuery& query, const FclOctreeSpace& scene, double resolution) {
  const auto information = std::make_shared<ob::SpaceInformation>(state_space(query));
  information->setStateValidityChecker([&query, &scene](const ob::State* state) {
    ++query.configurations;
    return scene.is_free(query.configuration(state));
  });
  information->setStateValidityCheckingResolution(resolution);
  const std::lock_guard lock(ompl_seeds());
  information->setup();  // OMPL's discrete motion validator
  return information;
}

}  // namespace

/// The trees made last, for whoever plans in these maps again.
class FclPlanner::Scenes {
 public:
  std::shared_ptr<const FclOctreeSpace> of(const ConfigurationSpace& space) {
    const std::shared_ptr<Entry> entry = entry_of(space);
    std::call_once(entry->made, [&] { entry->scene = std::make_shared<FclOctreeSpace>(space); });
    return entry->scene;
  }

 private:
  struct Entry {
    Robot robot;
    Snapshot map;  ///< held, so that its tree's address stays its own
    std::map<std::string, Policy> policies;
    double padding = 0.0, seen_within = 0.0;
    std::once_flag made;
    std::shared_ptr<const FclOctreeSpace> scene;

    explicit Entry(const ConfigurationSpace& space)
        : robot(space.robot()),
          map(space.map()),
          policies(space.policies()),
          padding(space.options().padding),
          seen_within(space.options().seen_within) {}
    bool is_of(const ConfigurationSpace& space) const {
      return &map.tree() == &space.map().tree() && map.seen() == space.map().seen() &&
             padding == space.options().padding && seen_within == space.options().seen_within &&
             policies == space.policies() && is_same(robot, space.robot());
    }
  };

  std::shared_ptr<Entry> entry_of(const ConfigurationSpace& space) {
    constexpr std::size_t kept = 8;
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const auto& entry) { return entry->is_of(space); });
    if (found != entries_.end()) {
      std::rotate(found, found + 1, entries_.end());
    } else {
      if (entries_.size() == kept) entries_.erase(entries_.begin());
      entries_.push_back(std::make_shared<Entry>(space));
    }
    return entries_.back();
  }

  std::mutex mutex_;
  std::vector<std::shared_ptr<Entry>> entries_;  ///< used last at the end
};

namespace {

double read_resolution(OptionReader& reader, double initial) {
  return reader.number("resolution", initial, 1e-6, 1.0);
}
double read_length(OptionReader& reader, const char* name, double initial, double most) {
  return reader.number_or_auto(name, initial, 0.0, most);
}
int read_samples(OptionReader& reader, int initial) {
  return reader.integer("max_samples", initial, 1, 100000000);
}

}  // namespace

RrtConnectFclOptions read_options(OptionReader& reader, RrtConnectFclOptions initial) {
  return {.resolution = read_resolution(reader, initial.resolution),
          .simplify = reader.flag("simplify", initial.simplify),
          .range = read_length(reader, "range", initial.range, 1e3),
          .prismatic_scale = read_length(reader, "prismatic_scale", initial.prismatic_scale, 1e6),
          .max_samples = read_samples(reader, initial.max_samples)};
}

KpieceFclOptions read_options(OptionReader& reader, KpieceFclOptions initial) {
  return {.resolution = read_resolution(reader, initial.resolution),
          .simplify = reader.flag("simplify", initial.simplify),
          .range = read_length(reader, "range", initial.range, 1e3),
          .prismatic_scale = read_length(reader, "prismatic_scale", initial.prismatic_scale, 1e6),
          .max_samples = read_samples(reader, initial.max_samples)};
}

PrmFclOptions read_options(OptionReader& reader, PrmFclOptions initial) {
  return {.resolution = read_resolution(reader, initial.resolution),
          .simplify = reader.flag("simplify", initial.simplify),
          .prismatic_scale = read_length(reader, "prismatic_scale", initial.prismatic_scale, 1e6),
          .max_samples = read_samples(reader, initial.max_samples)};
}

BitStarFclOptions read_options(OptionReader& reader, BitStarFclOptions initial) {
  return {.resolution = read_resolution(reader, initial.resolution),
          .simplify = reader.flag("simplify", initial.simplify),
          .batch = reader.integer("batch", initial.batch, 1, 1000000),
          .prismatic_scale = read_length(reader, "prismatic_scale", initial.prismatic_scale, 1e6),
          .max_samples = read_samples(reader, initial.max_samples)};
}

FclPlanner::FclPlanner(std::string_view name, PlannerOptions in_force, const Settings& settings)
    : Planner(name, std::move(in_force)), settings_(settings), scenes_(std::make_unique<Scenes>()) {}

FclPlanner::~FclPlanner() = default;

RrtConnectFcl::RrtConnectFcl(const RrtConnectFclOptions& options)
    : FclPlanner(table_name, text_of_options(table_name, options),
                 {.algorithm = OmplAlgorithm::rrtconnect,
                  .resolution = options.resolution,
                  .simplify = options.simplify,
                  .range = options.range,
                  .prismatic_scale = options.prismatic_scale,
                  .max_samples = options.max_samples}) {}

KpieceFcl::KpieceFcl(const KpieceFclOptions& options)
    : FclPlanner(table_name, text_of_options(table_name, options),
                 {.algorithm = OmplAlgorithm::kpiece,
                  .resolution = options.resolution,
                  .simplify = options.simplify,
                  .range = options.range,
                  .prismatic_scale = options.prismatic_scale,
                  .max_samples = options.max_samples}) {}

PrmFcl::PrmFcl(const PrmFclOptions& options)
    : FclPlanner(table_name, text_of_options(table_name, options),
                 {.algorithm = OmplAlgorithm::prm,
                  .resolution = options.resolution,
                  .simplify = options.simplify,
                  .prismatic_scale = options.prismatic_scale,
                  .max_samples = options.max_samples}) {}

BitStarFcl::BitStarFcl(const BitStarFclOptions& options)
    : FclPlanner(table_name, text_of_options(table_name, options),
                 {.algorithm = OmplAlgorithm::bitstar,
                  .resolution = options.resolution,
                  .simplify = options.simplify,
                  .batch = options.batch,
                  .prismatic_scale = options.prismatic_scale,
                  .max_samples = options.max_samples}) {}

PlanResult FclPlanner::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  if (problem.start == problem.goal) {  // there is nothing to improve on
    result.waypoints = {problem.start, problem.goal};
    result.search_steps = 1;
    result.cost = problem.cost(result.waypoints);
    return result;
  }
  const auto scene = scenes_->of(problem.space);
  OmplQuery query{
      problem, joint_weights(problem.space, settings_.prismatic_scale), std::mt19937_64(problem.seed), {}};
  const ob::SpaceInformationPtr information = sampled_checks(query, *scene, settings_.resolution);
  const ob::ProblemDefinitionPtr definition = problem_definition(query, information);
  bool out_of_time = false;
  bool has_path = false;
  definition->setIntermediateSolutionCallback(
      [&](const ob::Planner*, const std::vector<const ob::State*>&, ob::Cost) { has_path = true; });
  const bool improves = improves_path(settings_.algorithm);
  const std::function<bool()> is_over = [&] {
    out_of_time = problem.out_of_time();
    return out_of_time || (query.samples >= settings_.max_samples && (has_path || !improves));
  };
  const ob::PlannerPtr planner =
      make_algorithm({.algorithm = settings_.algorithm, .range = settings_.range, .batch = settings_.batch},
                     query, information, definition, is_over);
  planner->solve(ob::PlannerTerminationCondition(is_over));
  if (settings_.simplify) simplify(query, information, *definition);
  std::vector<Configuration> path = waypoints(query, *definition);
  result.configurations_checked += query.configurations;
  result.edges_checked = information->getMotionValidator()->getCheckedMotionCount();
  result.statistics = {{"samples", query.samples}};
  if (path.empty()) {
    result.status = out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
    result.final_distance = (problem.goal - problem.start).norm();
    result.explanation = "No path found with " + counted(query.samples, "sample") + ".";
    return result;
  }
  result.explanation = "Joined start and goal with " + counted(query.samples, "sample") +
                       "; between the looks at its edges the path is not certified.";
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = sampled_cost(problem.cost, path, query.weight, AnyAngleOptions().cost_step);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
