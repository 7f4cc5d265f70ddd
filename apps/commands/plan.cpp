#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <ostream>

#include "apps/commands/plan_query.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/option_meanings.hpp"
#include "apps/query/query.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"
#include "planning/pose_goals.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {

namespace {

int print_planner_options(const PlanOptions& options, Console& console) {
  const auto planner = make_planner(options.planner, choose_planner_options(options.settings));
  std::size_t width = 0;
  for (const auto& [key, value] : planner->options()) width = std::max(width, key.size() + value.size());
  for (const auto& [key, value] : planner->options())
    console.out() << key << ": " << value << std::string(width - key.size() - value.size() + 2, ' ') << "# "
                  << option_meaning(options.planner, key) << '\n';
  return exit_done;
}

bool wants_motion(const PlanOptions& options) {
  return !options.trajectories.empty() || !options.view.empty() || options.motion;
}

/// "; 'FILE' stays as it was": who sends it to the robot sends an earlier plan.
std::string older_trajectory(const PlanOptions& options) {
  for (const auto& [format, file] : options.trajectories)
    if (std::filesystem::exists(file)) return "; '" + file + "' stays as it was";
  return "";
}

/// Nothing but a proved path is given time: a controller would follow it.
void add_motion(const PlanOptions& options, const ConfigurationSpace& space, Plan& plan, Console& console) {
  if (!wants_motion(options)) return;
  give_motion(space, plan, {.scales = options.scales, .period = options.period}, options.grip_time);
  if (plan.is_proved()) {
    if (!plan.motion)
      console.warn("clearway: no trajectory was written: " + plan.motion_caveat + older_trajectory(options));
  } else if (!options.trajectories.empty() || options.motion) {
    console.warn("clearway: no trajectory was written, because the plan is " +
                 (plan.status() == PlanStatus::solved
                      ? "refused by the check"
                      : "not solved (" + std::string(to_string(plan.status())) + ")") +
                 older_trajectory(options));
  }
}

/// The motion is in the file when it was asked for, not for the page alone.
Plan plan_to_file(const PlanOptions& options, Plan plan) {
  if (options.trajectories.empty() && !options.motion) plan.motion.reset();
  return plan;
}

/// A file that was there before stays: who asked for a new one has to learn that it was not written.
bool lacks_trajectory(const PlanOptions& options, const Plan& plan) {
  return (!options.trajectories.empty() || options.motion) && !plan.motion;
}

/// A message alone, or a table, has no place for what rides on the robot all the way and what pulls it.
void note_unsaid_terms(const PlanOptions& options, const Plan& plan, Console& console) {
  std::vector<std::string> flags;
  if (!plan.loads.empty()) flags.emplace_back("--attach");
  if (plan.payload > 0.0) flags.emplace_back("--payload");
  const bool is_heavy = !flags.empty(), is_pulled = plan.gravity != Plan().gravity;
  if (is_pulled) flags.emplace_back("--gravity");
  const std::string unsaid = is_heavy && is_pulled ? "what the robot carries and its gravity"
                             : is_pulled           ? "the gravity"
                                                   : "what the robot carries";
  for (const auto& [format, file] : options.trajectories)
    if (!flags.empty() && (format == "ros-json" || format == "csv"))
      return console.note("a trajectory as " + format + " does not say " + unsaid +
                          ": clearway check needs " + listed(flags) + " for it");
}

void save_trajectories(const PlanOptions& options, const Robot& robot, const Plan& plan) {
  if (!plan.motion) return;
  const Trajectory trajectory = trajectory_of(robot, plan);
  for (const auto& [format, file] : options.trajectories) {
    save_file(file, trajectory_format(format, robot).write(robot, plan, trajectory));
  }
}

void report_degrees(const PlanOptions& options, const Robot& robot, const Configuration& start,
                    const std::vector<Configuration>& goals, Console& console) {
  if (options.degrees) {
    const bool has_turn =
        std::any_of(options.goal_poses.poses.begin(), options.goal_poses.poses.end(),
                    [](const std::string& pose) { return parse_numbers(pose, "").size() > 3; });
    if (has_turn) console.warn("--degrees is of joint values; the angles of --goal-pose are radians");
    return;
  }
  std::string hint = degrees_hint(robot, start, "--start");
  for (std::size_t i = 0; i < goals.size() && hint.empty(); ++i)
    hint = degrees_hint(robot, goals[i], "--goal");
  if (!hint.empty()) console.warn(hint);
}

/// A joint without limits is led where its goal says, whole turns included; who did not mean them is told.
void report_turns(const Robot& robot, const Configuration& start, const std::vector<Configuration>& goals,
                  Console& console) {
  for (std::size_t leg = 0; leg < goals.size(); ++leg)
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const Joint& joint = robot.joints[j];
      if (!repeats_after_turns(robot, j)) continue;
      const auto at = static_cast<Eigen::Index>(j);
      const double goal = goals[leg][at], from = (leg == 0 ? start : goals[leg - 1])[at];
      const double nearest = from + std::remainder(goal - from, 2.0 * std::numbers::pi);
      if (std::abs(goal - nearest) < 1e-6) continue;
      console.note("joint " + shortened(joint.name) + " turns without limits and is led from " +
                   significant(from) + " to " + significant(goal) + " rad, as the goal says; " +
                   significant(nearest) + " rad is the same place");
    }
}

/// Where no way was found, a joint without limits may come to the same place the other way round.
void report_other_way(const Robot& robot, const Plan& plan, const Configuration& start, Console& console) {
  const bool has_none = plan.status() == PlanStatus::no_path || plan.status() == PlanStatus::timed_out;
  const std::size_t leg = plan.legs.empty() ? 0 : plan.legs.size() - 1;
  if (!has_none || leg >= plan.goals.size()) return;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    const double from = (leg == 0 ? start : plan.goals[leg - 1])[at], goal = plan.goals[leg][at];
    if (!repeats_after_turns(robot, j) || goal == from) continue;
    const double other = goal + 2.0 * std::numbers::pi * (goal > from ? -1.0 : 1.0);
    console.note("joint " + shortened(robot.joints[j].name) + " turns without limits; " + significant(other) +
                 " rad is the same place, the other way round");
  }
}

/// Nobody chose `known_free` for a robot without critical parts, or for those that it has in a map that knows
/// nothing to be free: when it does not get through, that is reported.
void report_default_policy(const PlanOptions& options, const Plan& plan, const ConfigurationSpace& space,
                           Console& console) {
  if (!options.robot.policies.empty() || plan.status() == PlanStatus::solved) return;
  const auto strict = std::find_if(plan.policies.begin(), plan.policies.end(),
                                   [](const auto& part) { return part.second != Policy::not_occupied; });
  if (strict != plan.policies.end() &&
      !space.map().holds_any({VoxelState::painted, VoxelState::seen_free, VoxelState::conflict}))
    return console.log("note: nothing in the map is known to be free, as " + shortened(strict->first) +
                       " asks for by default; with --policy not_occupied unknown counts as free");
  if (!space.robot().critical_parts.empty()) return;
  const bool is_known_free = std::any_of(plan.policies.begin(), plan.policies.end(),
                                         [](const auto& part) { return part.second == Policy::known_free; });
  if (!is_known_free) return;
  const bool has_critical = std::any_of(plan.policies.begin(), plan.policies.end(),
                                        [](const auto& part) { return part.second == Policy::painted; });
  console.log("note: " + space.robot().name + " names no critical part, so " +
              (has_critical ? "what no painted volume names" : "all of it") +
              " must lie in known free space; with --policy not_occupied unknown counts as free");
}

/// A wheel on its floor, say: no planned joint moves what blocks the start.
void report_standing(const Plan& plan, const ConfigurationSpace& space, const Configuration& start,
                     Console& console) {
  if (plan.status() != PlanStatus::start_invalid) return;
  const Verdict verdict = space.check(start);
  if (verdict.obstruction != Obstruction::occupied && verdict.obstruction != Obstruction::conflict) return;
  const Robot& robot = space.robot();
  for (const Body& body : robot.bodies) {
    if (body.part != verdict.part || is_moved(robot, body.link)) continue;
    const std::string link = shortened(robot.links[static_cast<std::size_t>(body.link)].name);
    return console.log("note: no planned joint moves " + link + "; if the robot stands on it, --standing " +
                       link + " lets it touch the map");
  }
}

/// Who asks for poses or a grasp is told where the tip is by default.
void report_tip(const PlanOptions& options, const Robot& robot, Console& console) {
  if (!options.goal_poses.tip.empty()) return;
  console.note(tip_doubt(robot));
}

std::string plan_page(const PlanOptions& options, const Plan& plan, const ConfigurationSpace& space,
                      const Configuration& start) {
  ReportPage page = page_of_map(MapLeaves(space.map()), space.robot().name + ", " + plan.planner);
  page.subtitle = options.map.string();
  page.map_place = options.map.string();
  look_from(page, space.map(), space.robot().map_from_base.translation());
  show_robot(page, with_all_loads(space.robot(), plan.loads), start);
  page.plans.push_back(page_of_plan(plan, space, start, plan.planner));
  return render_report_page(page);
}

/// What query, robot and map leave in doubt.
void report_query(const PlanOptions& options, const AskedPlan& asked, const Snapshot& map, Console& console) {
  report_degrees(options, asked.robot, asked.stops.start, asked.stops.goals, console);
  report_turns(asked.robot, asked.stops.start, asked.stops.goals, console);
  console.note(hold_notes(asked.robot, asked.loads));
  console.note(asked.stops.notes);
  console.note(robot_notes(asked.loaded, robot_request(options.robot).packages));
  console.note(volume_notes(asked.robot, asked.riding, map));
  console.note(painted_csv_remark(options.map, map));
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) console.warn("warning: " + caveat);
}

/// To the goals, to poses or for the pick, where a goal may be a pose, too.
Plan make_plan(PlanQuery query, const AskedPlan& asked, const std::string& tip) {
  std::optional<PoseGoals> at_poses;
  try {
    if (!asked.goal_poses.empty()) at_poses.emplace(query.space, tip, asked.goal_poses, query.start);
    if (at_poses) query.goals = at_poses->goals();
  } catch (const UnreachablePose& error) {
    if (!asked.pick) return plan_out_of_reach(query, asked.goal_poses.size(), error);
  }
  if (asked.pick) return plan_pick(query, *asked.pick);
  return at_poses ? plan_to_poses(query, *at_poses) : plan_and_check(query);
}

/// What of the map a reader of the plan should know beside its own caveat.
void add_caveats(const PlanOptions& options, const AskedPlan& asked, const ConfigurationSpace& space,
                 Plan& plan) {
  const Snapshot& map = space.map();
  plan.map_caveat =
      joined(plan.map_caveat, cloud_remark(options.map, map, options.cloud_resolution.has_value()));
  if (!asked.pick) return;
  const PickToCheck picked = pick_of(plan, *asked.pick, asked.robot, map);
  for (const std::string& note : pick_notes(picked, space.options().padding))
    plan.map_caveat = joined(plan.map_caveat, note);
}

/// Why there is no path, where the answer is a flag.
void report_remedies(const PlanOptions& options, const AskedPlan& asked, const ConfigurationSpace& space,
                     const Plan& plan, Console& console) {
  report_default_policy(options, plan, space, console);
  if (!asked.pick) report_other_way(asked.robot, plan, asked.stops.start, console);
  report_standing(plan, space, asked.stops.start, console);
}

void print_plan(const PlanOptions& options, const Plan& plan, std::ostream& out) {
  print_rows(out, plan_figures(plan));
  if (!options.out.empty()) out << "  plan: " << options.out.string() << '\n';
  if (!options.view.empty()) out << "  page: " << options.view.string() << '\n';
  for (const auto& [format, file] : options.trajectories)
    if (plan.motion) out << "  trajectory: " << file << '\n';
}

}  // namespace

int run_plan(const PlanOptions& options, Console& console) {
  if (options.print_options) return print_planner_options(options, console);
  const AskedPlan asked = read_query(options);
  const LoadedMap loaded =
      load_map_with(options.map, {},
                    options.cloud_resolution);  // what is said before may be said again by the whole program
  const Snapshot& map = loaded.map;
  report_query(options, asked, map, console);
  const ConfigurationSpace space =
      padded_space(asked.robot, map, asked.policies, choose_padding(options.robot, asked.robot),
                   options.robot.seen_within.value_or(0.0));
  if (asked.pick || !asked.goal_poses.empty()) report_tip(options, asked.robot, console);
  Plan plan = make_plan(query_of(options, asked, space, loaded.sha256), asked, options.goal_poses.tip);
  add_caveats(options, asked, space, plan);
  add_motion(options, space, plan, console);
  report_remedies(options, asked, space, plan, console);

  const std::string text = to_json(plan_to_file(options, plan));
  if (!options.out.empty()) save_file(options.out, text);
  if (!options.csv.empty()) save_file(options.csv, to_csv(plan));
  if (!options.view.empty()) save_file(options.view, plan_page(options, plan, space, asked.stops.start));
  save_trajectories(options, asked.robot, plan);
  if (plan.motion) note_unsaid_terms(options, plan, console);
  if (console.json)
    console.out() << text << '\n';
  else
    print_plan(options, plan, console.out());
  return plan.is_proved() && !lacks_trajectory(options, plan) ? exit_done : exit_no;
}

}  // namespace clearway
