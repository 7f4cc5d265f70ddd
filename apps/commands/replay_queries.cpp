#include "apps/commands/replay_queries.hpp"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "apps/console/flag_names.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/query/query.hpp"
#include "apps/query/setup_robot.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

Configuration configuration(const std::vector<double>& values) {
  return Eigen::Map<const Configuration>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::vector<Configuration> configurations(const std::vector<std::vector<double>>& list) {
  std::vector<Configuration> result;
  for (const auto& values : list) result.push_back(configuration(values));
  return result;
}

GoalPose goal_pose(const GoalPoseSetup& goal) {
  return {goal.map_from_tip, goal.position_tolerance, goal.turn_tolerance, goal.free_axis};
}

std::vector<std::string> policy_texts(const QuerySetup& query) {
  std::vector<std::string> texts;
  for (const auto& [part, policy] : query.policies)
    texts.push_back(part == "default" ? policy : part + "=" + policy);
  return texts;
}

void require_size(const std::vector<double>& q, const Robot& robot, const QuerySetup& query,
                  const char* field) {
  if (q.size() == robot.dof()) return;
  throw std::invalid_argument("setup, query '" + query.name + "', field '" + field + "': got " +
                              counted(q.size(), "value") + ", expected " + std::to_string(robot.dof()) +
                              " (robot '" + robot.name + "')");
}

/// The field whose values look like degrees; empty: none.
std::string field_of_degrees(const QuerySetup& query, const Robot& robot) {
  if (looks_like_degrees(robot, configuration(query.start))) return "start";
  const auto is_odd = [&](const auto& goal) { return looks_like_degrees(robot, configuration(goal)); };
  return std::any_of(query.goals.begin(), query.goals.end(), is_odd) ? "goals" : "";
}

void require_policies(const QuerySetup& query, const Robot& robot) try {
  choose_policies(policy_texts(query), robot);
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument("setup, query '" + query.name + "', " + with_keys(error.what()));
}

/// A query's name becomes the name of its plans' files.
void require_file_name(const std::string& name) {
  const bool plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (!name.empty() && plain && name.front() != '.') return;
  throw std::invalid_argument("setup, query '" + name +
                              "', field 'name': expected letters, digits, '_', '-' and '.' only");
}

}  // namespace

QueryRunner::QueryRunner(const ReplayOptions& options, const std::filesystem::path& folder,
                         const Fusion& fusion, const Snapshot& map)
    : options_(options),
      folder_(folder),
      setup_(fusion.setup),
      map_(map),
      robot_(planned_robot(*setup_.robot)) {
  for (const QuerySetup& asked : setup_.queries) {
    require_file_name(asked.name);
    const QuerySetup& query = queries_.emplace_back(in_numbers(asked));
    require_tip(query);
    loads_.push_back(loads_of(query));
    picks_.push_back(pick_of(query));
    const std::vector<LegLoad> riding = riding_of(loads_.size() - 1);
    const Robot loaded = with_all_loads(robot_, riding);
    require_policies(query, loaded);
    require_seen_within(query, riding);
    require_parts(query.allow_outside, loaded, "setup, query '" + query.name + "', field 'allow_outside'");
    require_size(query.start, robot_, query, "start");
    for (const auto& goal : query.goals) require_size(goal, robot_, query, "goals");
    for (const std::string& planner : planners(query)) make_planner(planner, planner_options(query, planner));
  }
}

std::vector<ReplayPlan> QueryRunner::run(Console& console) {
  for (const std::string& note : notes_) console.note(note);
  for (const QuerySetup& query : queries_)
    if (const std::string field = field_of_degrees(query, robot_); !field.empty())
      console.note("setup, query '" + query.name + "', field '" + field +
                   "' is far outside of the joint limits in radians and within them in degrees: '" + field +
                   "_deg' reads it so");
  QueryRecord record{map_sha256(folder_), {}};
  for (std::size_t i = 0; i < queries_.size(); ++i) record.queries.push_back(prepare(i));
  save_file(folder_ / "queries.json", to_json(record));
  std::vector<ReplayPlan> plans;
  for (std::size_t i = 0; i < queries_.size(); ++i)
    for (const std::string& planner : planners(queries_[i])) {
      console.log("planning '" + queries_[i].name + "' with " + planner);
      plans.push_back(plan(i, planner, record.map_sha256));
    }
  return plans;
}

std::vector<double> QueryRunner::place_of(const QuerySetup& query, const std::string& field,
                                          const std::string& state, const std::vector<double>& before) {
  const std::string where = "setup, query '" + query.name + "', field '" + field + "': ";
  std::vector<std::string> known;
  for (const NamedState& of_robot : robot_.states) known.push_back(of_robot.name);
  if (std::find(known.begin(), known.end(), state) == known.end())
    throw std::invalid_argument(
        where + "robot " + quote(robot_.name) + " has no state " + quote(state) + ", " +
        (known.empty() ? "expected a number for each joint" : suggestion(state, known)));
  try {
    const bool is_start = field == "start";
    const ChosenStops stops = is_start ? choose_stops(state, {}, robot_, false)
                                       : choose_stops("", {state}, robot_, false, configuration(before));
    for (const std::string& note : stops.notes) notes_.push_back(where + note.substr(note.find(": ") + 2));
    const Configuration& q = is_start ? stops.start : stops.goals.front();
    return {q.begin(), q.end()};
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(where + error.what());
  }
}

QuerySetup QueryRunner::in_numbers(QuerySetup query) {
  if (!query.start_state.empty()) query.start = place_of(query, "start", query.start_state, {});
  for (std::size_t i = 0; i < query.goals.size(); ++i)
    if (!query.goal_states[i].empty())
      query.goals[i] = place_of(query, "goals[" + std::to_string(i) + "]", query.goal_states[i],
                                i == 0 ? query.start : query.goals[i - 1]);
  return query;
}

QueryTerms QueryRunner::prepare(std::size_t index) {
  const QuerySetup& query = queries_[index];
  const auto [own, of_loads] = policies_of(query, riding_of(index));
  spaces_.push_back(std::make_unique<ConfigurationSpace>(
      robot_, map_, own,
      SpaceOptions{.padding = query.padding.value_or(robot_.position_accuracy),
                   .seen_within = seen_within(query)}));
  poses_.push_back(poses_of(query, *spaces_.back()));
  goals_.push_back(poses_.back() ? poses_.back()->goals() : configurations(query.goals));
  QueryTerms terms = terms_of(query, *spaces_.back(), goals_.back());
  terms.loads = loads_[index];
  terms.pick = picks_[index];
  terms.policies = loaded_policies(*spaces_.back(), riding_of(index), of_loads);
  return terms;
}

ReplayPlan QueryRunner::plan(std::size_t index, const std::string& planner, const std::string& map_digest) {
  const QuerySetup& query = queries_[index];
  const Configuration start = configuration(query.start);
  const PlanQuery asked{.space = *spaces_[index],
                        .start = start,
                        .goals = goals_[index],
                        .planner = make_planner(planner, planner_options(query, planner)),
                        .seed = options_.seed,
                        .time_limit = options_.time_limit,
                        .loads = loads_[index],
                        .load_policies = policies_of(query, riding_of(index)).second,
                        .payload = setup_.robot->payload,
                        .gravity = setup_.robot->gravity,
                        .survey = SurveyDemands{.allow_outside = query.allow_outside},
                        .robot_name = setup_.robot->name,
                        .map_file = "map.ot",
                        .map_digest = map_digest,
                        .name = query.name};
  Plan plan = picks_[index]   ? plan_pick(asked, *picks_[index])
              : poses_[index] ? plan_to_poses(asked, *poses_[index])
                              : plan_and_check(asked);
  {
    const Stopwatch watch(motion_s_);
    give_motion(*spaces_[index], plan);
  }
  const std::filesystem::path file = std::filesystem::path("plans") / (query.name + "-" + planner + ".json");
  save_file(folder_ / file, to_json(plan));
  return {query.name, std::move(plan), start, file, spaces_[index].get()};
}

std::vector<LegLoad> QueryRunner::loads_of(const QuerySetup& query) try {
  std::vector<LegLoad> loads;
  for (const LoadSetup& load : query.loads) {
    loads.push_back(leg_load(load));
    for (const int leg : load.legs)
      if (const std::size_t legs = query.goals.size() + query.goal_poses.size(); leg > static_cast<int>(legs))
        throw std::invalid_argument("load '" + load.name + "': leg " + std::to_string(leg) +
                                    ", expected legs from 1 to " + std::to_string(legs));
  }
  return loads;
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument("setup, query '" + query.name + "': " + error.what());
}

std::optional<Pick> QueryRunner::pick_of(const QuerySetup& query) const try {
  if (!query.pick) return std::nullopt;
  const Pick pick = stated_pick(*query.pick, *query.pick->map_from_place, robot_);
  require_sound(pick, map_.resolution(), query.padding.value_or(robot_.position_accuracy));
  return pick;
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument("setup, query '" + query.name + "': " + error.what());
}

std::vector<LegLoad> QueryRunner::riding_of(std::size_t query) const {
  return picks_[query] ? std::vector<LegLoad>{{picks_[query]->object, {}}} : loads_[query];
}

std::pair<Policies, std::map<std::string, Policy>> QueryRunner::policies_of(
    const QuerySetup& query, const std::vector<LegLoad>& loads) const {
  return parted_policies(choose_policies(policy_texts(query), with_all_loads(robot_, loads)), loads);
}

void QueryRunner::require_tip(const QuerySetup& query) const try {
  if (!query.tip.empty()) with_tip(robot_, link_of_tip(robot_, query.tip));
} catch (const std::invalid_argument& error) {
  throw std::invalid_argument("setup, query '" + query.name + "', field 'tip': " + error.what());
}

std::optional<PoseGoals> QueryRunner::poses_of(const QuerySetup& query, const ConfigurationSpace& space) {
  if (query.goal_poses.empty()) return std::nullopt;
  std::vector<NamedGoalPose> poses;
  for (const GoalPoseSetup& goal : query.goal_poses)
    poses.push_back({goal_pose(goal),
                     "setup, query '" + query.name + "', goal_poses[" + std::to_string(poses.size()) + "]"});
  return PoseGoals(space, query.tip, poses, configuration(query.start));
}

QueryTerms QueryRunner::terms_of(const QuerySetup& query, const ConfigurationSpace& space,
                                 const std::vector<Configuration>& goals) const {
  std::vector<GoalPose> goal_poses;
  for (const GoalPoseSetup& goal : query.goal_poses) goal_poses.push_back(goal_pose(goal));
  return {.name = query.name,
          .robot = setup_.robot->name,
          .scale = robot_.scale,
          .map_from_base = robot_.map_from_base,
          .policies = space.policies(),
          .padding = space.options().padding,
          .seen_within = space.options().seen_within,
          .allow_outside = query.allow_outside,
          .start = configuration(query.start),
          .goals = goals,
          .goal_poses = goal_poses,
          .tip = query.tip,
          .payload = setup_.robot->payload,
          .gravity = setup_.robot->gravity,
          .joints = joint_names(robot_)};
}

std::vector<std::string> QueryRunner::planners(const QuerySetup& query) const {
  if (!options_.planners.empty()) return options_.planners;
  return query.planners.empty() ? std::vector<std::string>{"beam", "boundary"} : query.planners;
}

double QueryRunner::seen_within(const QuerySetup& query) const {
  return options_.seen_within.value_or(query.seen_within);
}

void QueryRunner::require_seen_within(const QuerySetup& query, const std::vector<LegLoad>& loads) const {
  try {
    const Policies policies = policies_of(query, loads).first;
    clearway::require_seen_within(seen_within(query), map_, part_policies(robot_, map_, policies));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("setup, query '" + query.name + "': " + error.what());
  }
}

PlannerOptions QueryRunner::planner_options(const QuerySetup& query, const std::string& planner) {
  PlannerOptions options;
  for (const auto& [key, value] : query.options) {
    const std::size_t dot = key.find('.');
    if (dot == std::string::npos) {
      options[key] = value;
    } else if (key.substr(0, dot) == planner) {
      options[key.substr(dot + 1)] = value;
    }
  }
  return options;
}

}  // namespace clearway
