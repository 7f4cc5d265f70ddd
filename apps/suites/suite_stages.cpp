#include "apps/suites/suite_stages.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

#include "apps/query/loads.hpp"
#include "apps/suites/suite_furniture.hpp"
#include "apps/suites/suite_hand.hpp"
#include "apps/suites/suite_holes.hpp"
#include "apps/suites/suite_reaching.hpp"
#include "apps/suites/suite_shelves.hpp"
#include "apps/suites/suite_tunnels.hpp"
#include "apps/suites/suite_world.hpp"
#include "mapping/files/cloud_file.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/held_joints.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse(const Suite& suite, const SuiteExperiment& experiment, const std::string& what) {
  throw std::invalid_argument("suite '" + suite.name + "', experiment '" + experiment.name + "', " + what);
}

const SuiteWorld& world_of(const Suite& suite, const SuiteExperiment& experiment, const std::string& name) {
  const auto found = std::find_if(suite.worlds.begin(), suite.worlds.end(),
                                  [&](const SuiteWorld& world) { return world.name == name; });
  if (found == suite.worlds.end()) {
    refuse(suite, experiment, "field 'world': expected the name of one of the worlds, got '" + name + "'");
  }
  return *found;
}

const std::string& world_name(const SuiteExperiment& experiment, const SuiteProblem& problem) {
  return problem.world.empty() ? experiment.world : problem.world;
}

/// The worlds of the explicit problems, each once, as the problems come to them.
std::vector<std::string> world_names(const SuiteExperiment& experiment) {
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const SuiteProblem& problem : experiment.problems)
    if (known.insert(world_name(experiment, problem)).second)
      names.push_back(world_name(experiment, problem));
  return names;
}

void require_hand(const SuiteGenerator& generator, const Robot& robot) { SuiteHand(robot, generator.kind); }

void require_six_joints(const SuiteGenerator&, const Robot& robot) { require_cells(robot); }

/// Draws the worlds and problems of one kind of generator.
struct Generator {
  std::string_view kind;
  std::size_t problems_of_a_stage;
  SuiteStage (*draw)(const SuiteGenerator&, std::size_t index, const Robot&, const Policies&, double padding);
  void (*require)(const SuiteGenerator&, const Robot&) = nullptr;  ///< throws when the robot does not suit it
};

SuiteStage tunnel_stage(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                        const Policies& policies, double padding) {
  const Tunnel tunnel = draw_tunnel(generator, index, robot, policies, padding);
  return {
      tunnel.world.name, tunnel.map, "", "", {{tunnel.world.name, tunnel.way.front(), {tunnel.way.back()}}}};
}

SuiteStage hole_stage(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                      const Policies& policies, double padding) {
  const Hole hole = draw_hole(generator, index, robot, policies, padding);
  return {hole.world.name, hole.map, "", "", {{hole.world.name, hole.start, {hole.goal}}}};
}

SuiteStage shelf_stage(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                       const Policies& policies, double padding) {
  Shelf shelf = draw_shelf(generator, index, robot, policies, padding);
  return {shelf.world.name, shelf.map, "", "", std::move(shelf.problems)};
}

SuiteStage reaching_stage(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                          const Policies& policies, double padding) {
  ReachingScene scene = draw_reaching(generator, index, robot, policies, padding);
  return {scene.world.name, scene.map, "", "", std::move(scene.problems)};
}

SuiteStage furniture_stage(const SuiteGenerator& generator, std::size_t index, const Robot& robot,
                           const Policies& policies, double padding) {
  FurnitureScene scene = draw_cells(generator, index, robot, policies, padding);
  return {scene.name, scene.map, "", "", std::move(scene.problems)};
}

/// All kinds.
constexpr Generator generators[] = {
    {"tunnels", 1, tunnel_stage, require_hand},
    {"holes", 1, hole_stage, require_hand},
    {"large_holes", 1, hole_stage, require_hand},
    {"shelves", problems_of_a_shelf, shelf_stage},
    {"shelf", problems_of_a_scene, reaching_stage},
    {"table", problems_of_a_scene, reaching_stage},
    {"ladder", problems_of_a_scene, reaching_stage},
    {"cage", problems_of_a_scene, reaching_stage},
    {"boxes", problems_of_a_scene, reaching_stage},
    {"cells", problems_of_furniture, furniture_stage, require_six_joints},
};

std::string generator_kinds() {
  std::string kinds;
  for (const Generator& generator : generators)
    kinds += (kinds.empty() ? "" : ", ") + std::string(generator.kind);
  return kinds;
}

const Generator& generator_of(const Suite& suite, const SuiteExperiment& experiment) {
  for (const Generator& generator : generators)
    if (generator.kind == experiment.generate->kind) return generator;
  refuse(suite, experiment,
         "field 'generate': expected one of the kinds " + generator_kinds() + ", got '" +
             experiment.generate->kind + "'");
}

void require_robot(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  const Generator& generator = generator_of(suite, experiment);
  try {
    if (generator.require != nullptr) generator.require(*experiment.generate, robot);
  } catch (const std::runtime_error& error) {
    refuse(suite, experiment, std::string("field 'generate': ") + error.what());
  }
}

/// These numbers, or those of the robot's state of that name.
Configuration place_of(const Robot& robot, const std::vector<double>& values, const std::string& state) {
  if (state.empty()) return configuration(values);
  if (const auto q = named_configuration(robot, state)) return *q;
  std::vector<std::string> names;
  for (const NamedState& known : robot.states) names.push_back(known.name);
  throw std::invalid_argument("robot " + quote(robot.name) + " has no state " + quote(state) + ", expected " +
                              (names.empty() ? "a number for each joint" : "one of " + listed(names)));
}

/// Empty: the goal has numbers.
std::string state_of_goal(const SuiteProblem& problem, std::size_t goal) {
  return goal < problem.goal_states.size() ? problem.goal_states[goal] : std::string();
}

StageProblem stage_problem(const SuiteProblem& problem, const Robot& robot) {
  StageProblem ready{problem.name, place_of(robot, problem.start, problem.start_state), {}};
  for (std::size_t i = 0; i < problem.goals.size(); ++i)
    ready.goals.push_back(place_of(robot, problem.goals[i], state_of_goal(problem, i)));
  for (const LoadSetup& load : problem.loads) ready.loads.push_back(leg_load(load));
  ready.view = problem.view;
  return ready;
}

/// A world of the suite without problems.
SuiteStage stage_of(const SuiteWorld& world, const Robot& robot) {
  if (!world.map.empty()) {
    LoadedMap loaded = load_map_with(world.map, {});
    return {world.name, std::move(loaded.map), world.map.string(), std::move(loaded.sha256), {}};
  }
  const Snapshot map = make_map(world, robot.critical_parts);
  return {world.name, map, "", map_sha256(map), {}};
}

void require_sizes(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  const auto check = [&](const SuiteProblem& problem, const std::vector<double>& values,
                         const std::string& state, const std::string& field) {
    const std::string where = "problem '" + problem.name + "', field '" + field + "': ";
    std::size_t size = 0;
    try {
      size = static_cast<std::size_t>(place_of(robot, values, state).size());
    } catch (const std::invalid_argument& error) {
      refuse(suite, experiment, where + error.what());
    }
    if (size == robot.dof()) return;
    refuse(suite, experiment,
           where + "got " + counted(size, "value") + ", expected " + std::to_string(robot.dof()) +
               ", one for each joint of robot '" + robot.name + "'");
  };
  for (const SuiteProblem& problem : experiment.problems) {
    check(problem, problem.start, problem.start_state, "start");
    for (std::size_t i = 0; i < problem.goals.size(); ++i)
      check(problem, problem.goals[i], state_of_goal(problem, i), "goals[" + std::to_string(i) + "]");
  }
}

void require_loads(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  for (const SuiteProblem& problem : experiment.problems) {
    try {
      with_all_loads(robot, stage_problem(problem, robot).loads);
    } catch (const std::invalid_argument& error) {
      refuse(suite, experiment, "problem '" + problem.name + "', field 'loads': " + error.what());
    }
  }
}

}  // namespace

Configuration configuration(const std::vector<double>& values) {
  return Eigen::Map<const Configuration>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Policies suite_policies(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot) {
  Policies policies;
  for (const auto& [part, policy] : experiment.policies) {
    if (part == "default") {
      policies.other = parse_policy(policy);
      policies.critical_by_default = false;
      continue;
    }
    if (std::none_of(robot.bodies.begin(), robot.bodies.end(),
                     [&](const Body& body) { return body.part == part; })) {
      refuse(suite, experiment, "field 'policies': robot '" + robot.name + "' has no part '" + part + "'");
    }
    policies.parts[part] = parse_policy(policy);
  }
  return policies;
}

std::string note_on_cloud(const SuiteWorld& world, const Snapshot& map) {
  std::string remark = cloud_remark(world.map, map, false);
  if (remark.empty()) return "";
  const std::string flag = "--cloud-resolution chooses others";  // of commands that a suite has no part in
  if (const std::size_t at = remark.find(flag); at != std::string::npos)
    remark.replace(at, flag.size(),
                   "`clearway inspect` with --cloud-resolution and --save makes a map of others");
  return "world " + quote(world.name) + ", " + quote_path(world.map.string()) + ": " + remark;
}

SuiteStages::SuiteStages(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot)
    : suite_(suite), experiment_(experiment), robot_(robot) {
  static_cast<void>(suite_policies(suite, experiment, robot));
  if (experiment.generate) {
    require_robot(suite, experiment, robot);
  } else {
    // A cloud that cannot be read is reported before anything runs; see also hand_over.cpp.
    worlds_ = world_names(experiment);
    for (const std::string& name : worlds_) {
      const SuiteWorld& world = world_of(suite, experiment, name);
      if (!is_cloud_file(world.map)) continue;
      if (std::string note = note_on_cloud(world, load_map(world.map)); !note.empty())
        notes_.push_back(std::move(note));
    }
    require_sizes(suite, experiment, robot);
    require_loads(suite, experiment, robot);
  }
}

std::size_t SuiteStages::size() const {
  if (!experiment_.generate) return worlds_.size();
  const auto count = static_cast<std::size_t>(experiment_.generate->count);
  const std::size_t each = generator_of(suite_, experiment_).problems_of_a_stage;
  return (count + each - 1) / each;
}

std::size_t SuiteStages::problems(std::size_t index) const {
  if (experiment_.generate) {
    const auto count = static_cast<std::size_t>(experiment_.generate->count);
    const std::size_t each = generator_of(suite_, experiment_).problems_of_a_stage;
    return std::min(each, count - std::min(count, index * each));
  }
  return static_cast<std::size_t>(std::count_if(
      experiment_.problems.begin(), experiment_.problems.end(),
      [&](const SuiteProblem& problem) { return world_name(experiment_, problem) == worlds_[index]; }));
}

SuiteStage SuiteStages::make(std::size_t index) const {
  if (index >= size()) throw std::out_of_range("a stage beyond the last one");
  if (experiment_.generate) {
    const Policies policies = suite_policies(suite_, experiment_, robot_);
    const double padding = experiment_.padding.value_or(robot_.position_accuracy);
    SuiteStage stage =
        generator_of(suite_, experiment_).draw(*experiment_.generate, index, robot_, policies, padding);
    stage.digest = map_sha256(stage.map);
    return stage;
  }
  SuiteStage stage = stage_of(world_of(suite_, experiment_, worlds_[index]), robot_);
  for (const SuiteProblem& problem : experiment_.problems)
    if (world_name(experiment_, problem) == worlds_[index])
      stage.problems.push_back(stage_problem(problem, robot_));
  return stage;
}

}  // namespace clearway
