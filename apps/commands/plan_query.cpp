#include "apps/commands/plan_query.hpp"

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <tuple>

#include "apps/console/named_places.hpp"
#include "apps/console/parse.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planner_table.hpp"

namespace clearway {

namespace {

std::vector<NamedPlace> places_read(const PlanOptions& options) {
  std::vector<NamedPlace> inputs = {
      {"--map", options.map}, {"--srdf", options.robot.srdf}, {"--pick", options.pick}};
  for (NamedPlace& place : places_of_robot("--robot", options.robot.robot))
    inputs.push_back(std::move(place));
  for (const auto& file : options.attach) inputs.push_back({"--attach", file});
  return inputs;
}

/// Where the plan is written to: every file once, and over nothing that is read.
void require_files(const PlanOptions& options) {
  std::vector<NamedPlace> files = {{"--out", options.out}, {"--csv", options.csv}, {"--view", options.view}};
  for (const auto& [format, file] : options.trajectories) files.push_back({"--trajectory", file});
  require_apart(files, places_read(options));
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto& [flag, file] = files[i];
    if (file.empty()) continue;
    require_writable(file);
    for (std::size_t j = 0; j < i; ++j) {
      const auto same = [](const std::filesystem::path& path) {
        return std::filesystem::weakly_canonical(path);
      };
      if (same(files[j].path) != same(file)) continue;
      throw std::invalid_argument(flag + ": '" + file.string() + "' is the file of " + files[j].flag +
                                  ", too");
    }
  }
}

/// What --pick asks for. Other flags that do not go with it are refused.
std::optional<Pick> pick_of(const PlanOptions& options, const Robot& robot) {
  if (options.pick.empty()) {
    if (options.place.empty()) return std::nullopt;
    throw std::invalid_argument("--place: expected --pick with it");
  }
  if (!options.attach.empty())
    throw std::invalid_argument("--attach: expected either --attach or --pick, got both");
  if (options.goals.size() + options.goal_poses.poses.size() > 1)
    throw std::invalid_argument("--goal: expected at most one with --pick");
  Pick pick = choose_pick(options.pick, options.place, robot);
  require_rigid_hold(robot, pick);
  return pick;
}

/// A controller of Universal Robots takes no new position between two of its steps.
void require_steps_of_controller(const PlanOptions& options) {
  constexpr double step = 0.002;
  const double steps = options.period / step;
  for (const auto& [format, file] : options.trajectories)
    if (format == "urscript" && std::abs(steps - std::round(steps)) > 1e-6)
      throw std::invalid_argument(
          "--period: urscript needs a multiple of 0.002 s, the controller's step, got " +
          significant(options.period));
}

}  // namespace

AskedPlan read_query(const PlanOptions& options) {
  AskedPlan asked;
  asked.planner = make_planner(options.planner, choose_planner_options(options.settings));
  asked.robot = choose_robot(options.robot);
  if (!options.pick.empty()) asked.robot = with_tip_of(asked.robot, options.goal_poses.tip);
  for (const auto& [format, file] : options.trajectories) trajectory_format(format, asked.robot);
  require_steps_of_controller(options);
  rate_limits(asked.robot, options.scales);
  asked.stops = choose_stops(options.start, options.goals, asked.robot, options.degrees);
  asked.goal_poses =
      choose_goal_poses(options.goal_poses, !options.goals.empty(), !options.pick.empty(), asked.robot);
  asked.loads = choose_loads(options.attach, asked.robot);
  asked.pick = pick_of(options, asked.robot);
  asked.riding = asked.pick ? std::vector<LegLoad>{{asked.pick->object, {}}} : asked.loads;
  asked.loaded = with_all_loads(asked.robot, asked.riding);
  std::tie(asked.policies, asked.load_policies) =
      parted_policies(choose_policies(options.robot.policies, asked.loaded), asked.riding);
  require_parts(options.survey.allow_outside, asked.loaded, "--allow-outside");
  require_files(options);
  return asked;
}

PlanQuery query_of(const PlanOptions& options, const AskedPlan& asked, const ConfigurationSpace& space,
                   const std::string& map_digest) {
  PlanQuery query{.space = space,
                  .start = asked.stops.start,
                  .goals = asked.stops.goals,
                  .planner = asked.planner,
                  .seed = options.seed,
                  .time_limit = options.time_limit,
                  .loads = asked.loads,
                  .load_policies = asked.load_policies,
                  .payload = options.dynamics.payload.value_or(0.0),
                  .survey = options.survey,
                  .robot_name = options.robot.robot,
                  .map_file = options.map,
                  .map_digest = map_digest};
  if (!options.dynamics.gravity.empty()) query.gravity = Eigen::Vector3d(options.dynamics.gravity.data());
  return query;
}

}  // namespace clearway
