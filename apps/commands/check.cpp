#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/check/check_contract.hpp"
#include "apps/check/check_report.hpp"
#include "apps/console/commands.hpp"
#include "apps/console/table.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {

namespace {

/// The path itself, under the contract's terms.
PathVerdict check_waypoints(const Contract& contract, const Robot& robot, const Snapshot& map,
                            const Plan& plan) {
  const std::vector<Configuration> waypoints = plan.waypoints();
  if (!waypoints.empty()) {
    return check_path(robot_of(contract, robot), map, policies_of(contract), contract.padding.value,
                      waypoints, 0.0, contract.seen_within.value);
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
  report.motion = check_motion(placed, map, policies_of(contract), contract.padding.value,
                               plan.motion->motion, plan.motion->leg_ends, plan.stops(),
                               rate_limits(placed, plan.motion->scales), contract.seen_within.value);
  const TorqueTerms terms = torque_terms(placed, load_of(plan, placed));
  if (!report.motion->valid) return;
  report.torques = greatest_torques(placed, plan.motion->motion, terms);
  report.motion->fault = torque_fault(placed, plan.motion->motion, terms, *report.torques);
  report.motion->valid = report.motion->fault.empty();
}

}  // namespace

int run_check(const CheckOptions& options, Console& console) {
  const Plan plan = load_plan(options.plan);
  const Robot robot = robot_to_check(options, plan);
  const Snapshot map = load_map(options.map);
  if (const std::string remark = painted_csv_remark(options.map, map); !remark.empty())
    console.warn("note: " + remark);
  if (const std::string caveat = damage_caveat(map); !caveat.empty()) console.warn("warning: " + caveat);
  CheckReport report;
  report.contract =
      state_contract(options, plan, robot, map, map_sha256(options.map), load_query_record(options.map));
  report.deviations = deviations(report.contract, plan, options.accepted);
  adopt_accepted(report.deviations, plan, report.contract);
  report.path = check_waypoints(report.contract, robot, map, plan);
  check_motion_of(plan, robot, map, report);
  // A path that is malformed (its clearances were not measured) leads nowhere.
  const auto path = report.path.clearance.empty() ? std::vector<Configuration>{} : plan.waypoints();
  report.survey = survey_path(robot_of(report.contract, robot), map, policies_of(report.contract), path);
  refuse_surveyed(report.survey, report.contract.demands, report.path);
  report.map_integration = to_string(integration_of(map));
  report.map_caveat = map_caveat(map);
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
