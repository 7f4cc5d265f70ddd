#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "apps/check/check_contract.hpp"
#include "apps/check/check_report.hpp"
#include "apps/check/trajectory_plan.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/table.hpp"
#include "apps/query/query.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {

namespace {

/// Where the plan says that the load rides; check_pick proves it.
Eigen::Isometry3d pose_of_load(const Plan& plan, const std::string& name) {
  for (const LegLoad& load : plan.loads)
    if (load.load.name == name) return load.load.link_from_load;
  return Eigen::Isometry3d::Identity();
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
    const Robot placed = robot_of(contract, robot);
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

/// Its motion, under the same terms and the limits of the robot's own files.
void check_motion_of(const Plan& plan, const Robot& robot, const Snapshot& map, CheckReport& report) {
  if (!plan.motion || plan.stops().empty() || !report.path.valid) return;
  const Contract& contract = report.contract;
  const Robot placed = robot_of(contract, robot);
  report.motion_duration = plan.motion->motion.duration();
  const MotionJudgement judged = judge_motion({placed, map, policies_of(contract), contract.padding.value,
                                               contract.seen_within.value, joint_load_of(contract)},
                                              plan_under(contract, plan));
  report.motion = judged.verdict;
  report.torques = judged.torques;
  if (const std::string missing = missing_masses(placed, contract.gravity.value); !missing.empty())
    report.torque_caveat = missing + ", so torques are of the masses that are known";
}

}  // namespace

int run_check(const CheckOptions& options, Console& console) {
  const std::optional<ForeignTrajectory> trajectory = read_trajectory(options.plan);
  Plan plan = trajectory ? Plan{} : load_plan(options.plan);
  const Robot robot = robot_to_check(options, plan);
  plan =
      trajectory ? plan_of_trajectory(*trajectory, robot, options.plan) : in_order_of(robot, std::move(plan));
  const Snapshot map = load_map(options.map, options.cloud_resolution);
  for (const std::string& note : srdf_notes(robot)) console.warn("note: " + note);
  if (const std::string remark = painted_csv_remark(options.map, map); !remark.empty())
    console.warn("note: " + remark);
  const std::string cloud = cloud_remark(options.map, map, options.cloud_resolution.has_value());
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) console.warn("warning: " + caveat);
  CheckReport report;
  report.contract =
      state_contract(options, plan, robot, map, map_sha256(options.map), load_query_record(options.map));
  if (trajectory) adopt_terms(report.contract, plan);
  report.deviations = deviations(report.contract, plan, robot, options.accepted);
  adopt_accepted(report.deviations, plan, report.contract);
  report.path = check_waypoints(report.contract, robot, map, plan);
  check_motion_of(plan, robot, map, report);
  // What a refused path sweeps is not worth the wait, and one that is malformed leads nowhere.
  std::vector<LegsToCheck> legs = legs_under(report.contract, robot, map, plan);
  if (!report.is_valid())
    for (LegsToCheck& part : legs) part.waypoints.clear();
  report.survey = survey_legs(legs, policies_of(report.contract));
  refuse_surveyed(report.survey, report.contract.demands, report.path);
  report.map_integration = to_string(integration_of(map));
  report.map_caveat = joined(map_caveat(map), cloud);
  report.plan_status = plan.status();
  report.waypoints = plan.waypoints().size();
  if (console.json) {
    console.out() << check_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
  } else {
    print_rows(console.out(), check_rows(report));
  }
  return report.is_valid() ? exit_done : exit_no;
}

}  // namespace clearway
