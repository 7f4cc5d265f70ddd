#include "planning/sampling/rrtconnect_fcl.hpp"

#include <ompl/base/ProblemDefinition.h>
#include <ompl/datastructures/NearestNeighborsLinear.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include <algorithm>
#include <mutex>

#include "planning/problem/option_reader.hpp"
#include "planning/robot/same_robot.hpp"
#include "planning/sampling/fcl_octree_space.hpp"
#include "planning/sampling/ompl_query.hpp"
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
  information->setup();  // OMPL's discrete motion validator
  return information;
}

}  // namespace

/// The trees made last, for whoever plans in these maps again.
class RrtConnectFcl::Scenes {
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

RrtConnectFclOptions read_options(OptionReader& reader, RrtConnectFclOptions initial) {
  return {.resolution = reader.number("resolution", initial.resolution, 1e-6, 1.0),
          .simplify = reader.flag("simplify", initial.simplify),
          .range = reader.number_or_auto("range", initial.range, 0.0, 1e3),
          .prismatic_scale = reader.number_or_auto("prismatic_scale", initial.prismatic_scale, 0.0, 1e6),
          .max_samples = reader.integer("max_samples", initial.max_samples, 1, 100000000)};
}

RrtConnectFcl::RrtConnectFcl(const RrtConnectFclOptions& options)
    : Planner(table_name, text_of_options(table_name, options)),
      options_(options),
      scenes_(std::make_unique<Scenes>()) {}

RrtConnectFcl::~RrtConnectFcl() = default;

PlanResult RrtConnectFcl::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  if (result.status != PlanStatus::solved) return result;
  const auto scene = scenes_->of(problem.space);
  OmplQuery query{
      problem, joint_weights(problem.space, options_.prismatic_scale), std::mt19937_64(problem.seed), {}};
  const ob::SpaceInformationPtr information = sampled_checks(query, *scene, options_.resolution);
  const ob::ProblemDefinitionPtr definition = problem_definition(query, information);
  ompl::geometric::RRTConnect planner(information);
  planner.setNearestNeighbors<ompl::NearestNeighborsLinear>();  // the default draws from OMPL's own generator
  planner.setRange(options_.range);
  planner.setProblemDefinition(definition);
  planner.setup();
  bool out_of_time = false;
  planner.solve(ob::PlannerTerminationCondition([&] {
    out_of_time = problem.out_of_time();
    return out_of_time || query.samples >= options_.max_samples;
  }));
  if (options_.simplify) simplify(query, information, *definition);
  std::vector<Configuration> path = waypoints(query, *definition);
  result.configurations_checked += query.configurations;
  result.edges_checked = information->getMotionValidator()->getCheckedMotionCount();
  result.statistics = {{"samples", query.samples}};
  if (path.empty()) {
    result.status = out_of_time ? PlanStatus::timed_out : PlanStatus::no_path;
    result.final_distance = (problem.goal - problem.start).norm();
    result.explanation = "No path found with " + std::to_string(query.samples) + " samples.";
    return result;
  }
  result.explanation = "Joined start and goal with " + std::to_string(query.samples) +
                       " samples; between the looks at its edges the path is not certified.";
  result.search_steps = static_cast<int>(path.size()) - 1;
  result.cost = problem.cost(path);
  result.waypoints = std::move(path);
  return result;
}

}  // namespace clearway
