#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "apps/check/check_contract.hpp"
#include "apps/check/check_report.hpp"
#include "apps/check/trajectory_entries.hpp"
#include "apps/check/trajectory_plan.hpp"
#include "apps/check/trajectory_slack.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/joint_order.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {

namespace {

/// Where the plan says that the load rides; check_pick proves it.
Eigen::Isometry3d pose_of_load(const Plan& plan, const std::string& name) {
  for (const LegLoad& load : plan.loads)
    if (load.load.name == name) return load.load.link_from_load;
  return Eigen::Isometry3d::Identity();
}

/// What is judged: a plan of ours, or trajectories of another program as one.
struct Candidate {
  Plan plan;
  Robot robot;                             ///< robot_to_check()
  std::vector<ForeignTrajectory> entries;  ///< none: a plan of ours
  std::optional<StatedTerms> stated;       ///< by the first of them
  std::vector<std::string> unnamed;        ///< joints that it does not name

  bool is_trajectory() const { return !entries.empty(); }
};

void add_notes(const std::vector<std::string>& notes, Contract& contract) {
  contract.notes.insert(contract.notes.end(), notes.begin(), notes.end());
}

/// The plan with the loads and the pick of the contract.
Plan plan_under(const Contract& contract, Plan plan) {
  std::vector<LegLoad> loads = carried_under(contract);
  for (LegLoad& load : loads)
    if (contract.pick.value) load.load.link_from_load = pose_of_load(plan, load.load.name);
  plan.loads = std::move(loads);
  plan.pick = contract.pick.value;
  if (plan.motion) plan.motion->grip_time = contract.grip_time.value.value_or(0.0);
  return plan;
}

/// The plan's legs with the loads of the contract.
std::vector<LegsToCheck> legs_under(const Contract& contract, const Robot& robot, const Snapshot& map,
                                    const Plan& plan) {
  return legs_of(plan_under(contract, plan), robot_of(contract, robot), map);
}

/// The path itself, under the contract's terms.
PathVerdict check_waypoints(const Contract& contract, const Robot& robot, const Snapshot& map,
                            const Plan& plan) {
  if (contract.pick.value && !plan.waypoints().empty()) {
    const Robot placed = tipped_robot_of(contract, robot);
    return check_pick(pick_of(plan, *contract.pick.value, placed, map), policies_of(contract),
                      contract.padding.value, contract.seen_within.value);
  }
  if (!plan.waypoints().empty()) {
    return check_legs(legs_under(contract, robot, map, plan), policies_of(contract), contract.padding.value,
                      0.0, contract.seen_within.value);
  }
  PathVerdict none;
  none.first_contact = "the plan has no path (status " + std::string(to_string(plan.status())) + ")";
  return none;
}

/// Notes of a pick's tip and place, and of a tip that nobody chose.
void note_tip_and_place(const Robot& robot, const Snapshot& map, const Plan& plan, Contract& contract) {
  if (!contract.pick.value && contract.goal_poses.empty()) return;
  if (contract.tip.empty()) {
    if (const std::string doubt = tip_doubt(robot); !doubt.empty()) contract.notes.push_back(doubt);
  }
  const std::string& tip = contract.tip_link.value;
  if (!plan.tip.empty() && plan.tip != tip)
    contract.notes.push_back("the plan was made for the tip " + quote(plan.tip) + "; it is judged for " +
                             quote(tip));
  if (!contract.pick.value) return;
  const Robot placed = tipped_robot_of(contract, robot);
  require_grip(placed, *contract.pick.value);
  add_notes(pick_notes(pick_of(plan, *contract.pick.value, placed, map), contract.padding.value), contract);
}

void note_missing_masses(const Robot& robot, CheckReport& report) {
  if (const std::string missing = missing_masses(robot, report.contract.gravity.value); !missing.empty())
    report.torque_caveat = missing + ", so torques are of the masses that are known";
}

/// Trajectories with times, as a controller runs them; their chords stand for the plan's waypoints in the
/// survey.
void check_timed_of(const std::vector<TimedTrajectory>& entries, const Snapshot& map,
                    std::vector<LegsToCheck>& legs, CheckReport& report) {
  Contract& contract = report.contract;
  report.splines = check_timed(entries, legs.front().robot, map, policies_of(contract),
                               contract.padding.value, contract.seen_within.value);
  report.path = report.splines->path;
  report.motion_duration = duration_of(entries);
  legs.front().waypoints = report.splines->chords;
  const Robot& robot = legs.front().robot;
  if (report.splines->is_valid()) {
    report.torques = torques_of(entries, robot, joint_load_of(contract), *report.splines);
    note_missing_masses(robot, report);
  }
  report.unjudged = unjudged_rates(*report.splines, robot);
  add_notes(notes_of(entries, *report.splines), contract);
}

/// Its motion, under the same terms and the limits of the robot's own files.
void check_motion_of(const Plan& plan, const Robot& robot, const Snapshot& map, CheckReport& report) {
  if (!plan.motion || plan.stops().empty() || !report.path.valid) return;
  Contract& contract = report.contract;
  const Robot placed = tipped_robot_of(contract, robot);
  if (const std::string note = usual_limits_note(robot); !note.empty()) contract.notes.push_back(note);
  report.motion_duration = plan.motion->motion.duration();
  const MotionJudgement judged = judge_motion({placed, map, policies_of(contract), contract.padding.value,
                                               contract.seen_within.value, joint_load_of(contract)},
                                              plan_under(contract, plan));
  report.motion = judged.verdict;
  report.torques = judged.torques;
  note_missing_masses(placed, report);
}

/// Where the robot is before a trajectory that says nothing of it, and comes to its first point in some time.
void take_start(const CheckOptions& options, const Robot& robot, ForeignTrajectory& trajectory) {
  const bool has_time = !trajectory.times.empty() && trajectory.times.front() > 0.0;
  const bool is_known = std::all_of(trajectory.joints.begin(), trajectory.joints.end(),
                                    [&](const std::string& name) { return trajectory.start.contains(name); });
  if (options.start.empty() || !has_time || is_known) return;
  const Configuration q =
      choose_stops(options.start, {}, scaled(robot, options.robot.scale.value_or(robot.scale) / robot.scale),
                   options.degrees)
          .start;
  if (q.cwiseAbs().maxCoeff() > largest_joint_value)
    throw std::invalid_argument("--start: expected joint values of at most " +
                                significant(largest_joint_value) + ", beyond which angles lose their digits");
  for (std::size_t j = 0; j < robot.dof(); ++j)
    trajectory.start.try_emplace(robot.joints[j].name, q[static_cast<Eigen::Index>(j)]);
}

/// What a trajectory has a little beside where it is judged counts against its distance to what is blocked.
void pad_by_slack(double slack, Contract& contract, Plan& plan) {
  constexpr double rounding = 1e-9;  // metres
  if (slack <= rounding) return;
  contract.padding.value += slack;
  plan.padding = contract.padding.value;
  contract.notes.push_back(
      "the trajectory has its base, or joints that stand still, follow others or are at a limit, a little "
      "beside where they are judged: the padding is " +
      significant(1000.0 * slack, 3) + " mm larger, by which that may move the robot");
}

/// Where start or goals that flags state look like degrees, without the flag for them; else empty.
std::string hint_of_degrees(const CheckOptions& options, const Contract& contract, const Robot& robot) {
  std::string hint;
  if (options.degrees) return hint;
  if (contract.start.source == TermSource::flag) hint = degrees_hint(robot, contract.start.value, "--start");
  if (contract.goals.source != TermSource::flag) return hint;
  for (const Configuration& goal : contract.goals.value)
    if (hint.empty() && static_cast<std::size_t>(goal.size()) == robot.dof())
      hint = degrees_hint(robot, goal, "--goal");
  return hint;
}

/// Whether the robot's SRDF has the group; without one, the joints that an export holds tell.
bool has_group(const CheckOptions& options, const std::string& group) {
  RobotRequest request = robot_request(options.robot);
  request.group.clear();
  request.fixed.clear();
  request.fixed_states.clear();
  request.standing.clear();
  const Robot whole = load_robot(request);
  return group.empty() || (!whole.srdf.empty() && read_srdf(whole.srdf).groups.contains(group));
}

Candidate candidate_of_plan(const CheckOptions& options) {
  Candidate read;
  read.plan = load_plan(options.plan);
  read.robot = robot_to_check(options, read.plan);
  read.plan = in_order_of(read.robot, std::move(read.plan));
  return read;
}

Candidate candidate_of_trajectories(const CheckOptions& options, std::vector<ForeignTrajectory> entries) {
  Candidate read;
  read.entries = std::move(entries);
  ForeignTrajectory& first = read.entries.front();
  read.stated = first.stated;
  if (read.stated) {  // for the robot's group and held joints
    state_terms(*read.stated, read.plan);
    if (!has_group(options, read.plan.group)) read.plan.group.clear();
  }
  read.robot = robot_to_check(options, read.plan);
  if (!options.pick.empty())
    throw std::invalid_argument("--pick: " + quote_path(options.plan.string()) +
                                " is a trajectory, which does not say where its legs end; expected the "
                                "plan's JSON, which holds the motion, too (plan --out --motion)");
  for (ForeignTrajectory& entry : read.entries) {
    const std::vector<std::string> held = hold_unnamed_joints(entry, read.robot);
    if (&entry == &first) read.unnamed = held;
  }
  take_start(options, read.robot, first);
  for (ForeignTrajectory& entry : read.entries) draw_to_limits(entry, read.robot);
  read.plan = plan_of_trajectories(read.entries, read.robot, options.plan);
  if (read.stated) state_terms(*read.stated, read.plan);
  return read;
}

Candidate read_candidate(const CheckOptions& options) {
  std::vector<ForeignTrajectory> entries = read_trajectories(options.plan);
  return entries.empty() ? candidate_of_plan(options)
                         : candidate_of_trajectories(options, std::move(entries));
}

/// What the robot, what rides on it and the map leave in doubt.
void report_inputs(const CheckOptions& options, const Candidate& read, const Snapshot& map,
                   Console& console) {
  console.note(robot_notes(read.robot, robot_request(options.robot).packages));
  const std::vector<LegLoad> riding =
      read.plan.pick ? std::vector<LegLoad>{{read.plan.pick->object, {}}} : read.plan.loads;
  for (const LegLoad& load : riding) console.note(size_note(load.load));
  console.note(volume_notes(read.robot, riding, map));
  console.note(painted_csv_remark(options.map, map));
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) console.warn("warning: " + caveat);
}

/// What a trajectory leaves open is the contract's, which says so.
void complete_trajectory(const CheckOptions& options, bool is_timed, Candidate& read, Contract& contract) {
  cut_at_goals(contract, read.plan);
  adopt_terms(read.stated, is_timed, contract, read.plan);
  const ForeignTrajectory& first = read.entries.front();
  const Eigen::Isometry3d& map_from_base = contract.map_from_base.value;
  require_base(first, map_from_base, options.plan);
  pad_by_slack(slack_of(read.entries, with_all_loads(read.robot, contract.loads.value), map_from_base),
               contract, read.plan);
  add_notes(drawn_notes(read.entries), contract);
  if (const std::string note = model_note(first, read.robot); !note.empty()) contract.notes.push_back(note);
  if (!read.unnamed.empty())
    contract.notes.push_back("the trajectory does not name " + listed(read.unnamed) +
                             ": judged where trajectory_start" +
                             (read.entries.size() > 1 ? ", or a later one," : "") + " has " +
                             (read.unnamed.size() == 1 ? "it" : "them"));
}

/// What the plan loosens, of which the contract takes over what the user accepts.
void judge_terms(const CheckOptions& options, const Candidate& read,
                 const std::vector<TimedTrajectory>& timed, CheckReport& report) {
  const auto& accepted = options.accepted;
  report.deviations = deviations(report.contract, read.plan, read.robot, accepted);
  if (const auto group = group_deviation(read.stated, report.contract, accepted))
    report.deviations.push_back(*group);
  const auto add_moving = [&](AcceptedTerm term, const std::string& sentence) {
    if (!sentence.empty()) report.deviations.push_back({term, sentence, accepted.contains(term)});
  };
  if (!timed.empty()) add_moving(AcceptedTerm::moving_start, timed.front().moving_start);
  if (!timed.empty()) add_moving(AcceptedTerm::moving_end, timed.back().moving_end);
  adopt_accepted(report.deviations, read.plan, read.robot, report.contract);
}

/// The path, its motion, and what the map knows of where they lead.
void judge_path(const Candidate& read, const std::vector<TimedTrajectory>& timed, const Snapshot& map,
                CheckReport& report) {
  const Contract& contract = report.contract;
  std::vector<LegsToCheck> legs = legs_under(contract, read.robot, map, read.plan);
  if (!timed.empty() && !contract.pick.value)
    check_timed_of(timed, map, legs, report);
  else
    report.path = check_waypoints(contract, read.robot, map, read.plan);
  check_motion_of(read.plan, read.robot, map, report);
  // What a refused path sweeps is not worth the wait, and one that is malformed leads nowhere.
  if (!report.is_valid())
    for (LegsToCheck& part : legs) part.waypoints.clear();
  report.survey = survey_legs(legs, policies_of(contract));
  refuse_surveyed(report.survey, contract.demands, report.path);
}

}  // namespace

int run_check(const CheckOptions& options, Console& console) {
  Candidate read = read_candidate(options);
  if (read.is_trajectory()) console.note(degrees_note(read.plan, read.robot));
  const RecordedMap recorded = load_recorded_map(options.map, options.cloud_resolution);
  const Snapshot& map = recorded.map;
  report_inputs(options, read, map, console);
  const std::vector<TimedTrajectory> timed = timed_trajectories(read.entries, read.robot, options.plan);

  CheckReport report;
  Contract& contract = report.contract;
  contract = state_contract(options, read.plan, read.robot, map, recorded.sha256, recorded.record,
                            read.plan.motion || !timed.empty());
  if (const std::string aside = record_aside(options.map); !aside.empty()) contract.notes.push_back(aside);
  if (read.is_trajectory()) complete_trajectory(options, !timed.empty(), read, contract);
  if (const std::string hint = hint_of_degrees(options, contract, read.robot); !hint.empty())
    console.warn(hint);
  judge_terms(options, read, timed, report);
  note_tip_and_place(read.robot, map, read.plan, contract);
  if (!contract.pick.value) add_notes(hold_notes(read.robot, carried_under(contract)), contract);
  judge_path(read, timed, map, report);

  report.map_integration = to_string(integration_of(map));
  report.map_caveat =
      joined(map_caveat(map), cloud_remark(options.map, map, options.cloud_resolution.has_value()));
  report.plan_status = read.plan.status();
  report.waypoints = read.plan.waypoints().size();
  if (console.json)
    console.out() << check_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  else
    print_rows(console.out(), check_rows(report));
  return report.is_valid() ? exit_done : exit_no;
}

}  // namespace clearway
