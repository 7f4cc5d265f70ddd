#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/commands.hpp"
#include "apps/parse.hpp"
#include "apps/query.hpp"
#include "apps/table.hpp"
#include "mapping/map_file.hpp"
#include "planning/part_policies.hpp"
#include "planning/path_check.hpp"
#include "planning/plan_file.hpp"

namespace clearway {

namespace {

/// The robot as the plan used it, unless a flag says otherwise.
Robot robot_of_plan(const CheckOptions& options, const Plan& plan) {
  RobotChoice choice = options.robot;
  if (!choice.scale) choice.scale = plan.robot_scale;
  if (choice.base.empty()) choice.base = numbers_from_pose(plan.map_from_base);
  Robot robot = choose_robot(choice);
  if (options.robot.base.empty()) robot.map_from_base = plan.map_from_base;
  return robot;
}

void require_same_joints(const Robot& robot, const Plan& plan, const std::filesystem::path& file) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  if (names == plan.joints) return;
  throw std::invalid_argument(file.string() + ": field 'joints': the plan is for " +
                              std::to_string(plan.joints.size()) + " joints that are not those of robot '" +
                              robot.name + "' (" + std::to_string(names.size()) + " joints)");
}

/// The plan's policies, unless a flag says otherwise. A part that the plan does not name gets what it would
/// get by default: a plan file cannot loosen a policy by leaving it out.
std::map<std::string, Policy> policies_of(const CheckOptions& options, const Plan& plan, const Robot& robot,
                                          const Snapshot& map) {
  const Policies chosen = choose_policies(options.robot.policies, robot);
  std::map<std::string, Policy> policies;
  try {
    policies = part_policies(robot, map, {.parts = plan.policies});
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options.plan.string() + ": field 'policy': " + error.what());
  }
  for (const std::string& text : options.robot.policies) {
    if (text.find('=') != std::string::npos) continue;
    for (const Body& body : robot.bodies) policies[body.part] = chosen.other;
  }
  for (const auto& [part, policy] : chosen.parts) policies[part] = policy;
  return policies;
}

}  // namespace

int run_check(const CheckOptions& options, Console& console) {
  const Plan plan = load_plan(options.plan);
  const Robot robot = robot_of_plan(options, plan);
  require_same_joints(robot, plan, options.plan);
  const Snapshot map = load_map(options.map);
  const std::string digest = map_sha256(options.map);
  if (digest != plan.map_sha256) console.log("note: the plan was made on another map (its sha256 differs)");

  if (options.robot.robot != plan.robot && robot.name != plan.robot) {
    console.log("note: the plan was made for robot '" + plan.robot + "'; scale " + significant(robot.scale) +
                " is used");
  }

  const double padding = std::max(options.robot.padding, plan.padding);
  const std::vector<Configuration> waypoints = plan.waypoints();
  const auto policies = policies_of(options, plan, robot, map);
  PathVerdict verdict;
  if (waypoints.empty()) {
    verdict.first_contact = "the plan has no path (status " + std::string(to_string(plan.status())) + ")";
  } else {
    verdict = check_path(robot, map, policies, padding, waypoints);
  }
  const std::string word = verdict.valid ? "valid" : verdict.undecided ? "undecided" : "refused";
  if (console.json) {
    nlohmann::ordered_json json;
    json["verdict"] = word;
    json["first_contact"] = verdict.first_contact;
    json["edge"] = verdict.edge;
    json["parameter"] = verdict.parameter;
    json["min_clearance_m"] = verdict.min_clearance;
    for (const auto& [part, policy] : policies) json["policy"][part] = to_string(policy);
    json["padding_m"] = padding;
    json["waypoints"] = waypoints.size();
    json["plan_status"] = to_string(plan.status());
    json["scale"] = robot.scale;
    json["base"] = numbers_from_pose(robot.map_from_base);
    json["same_map"] = digest == plan.map_sha256;
    json["checker"] = verdict.checker;
    console.out() << json.dump(2) << '\n';
  } else {
    std::vector<std::pair<std::string, std::string>> rows{{"verdict", word}};
    if (!verdict.first_contact.empty()) rows.emplace_back("first contact", verdict.first_contact);
    if (verdict.valid)
      rows.emplace_back("min. clearance", significant(verdict.min_clearance * 1000.0, 3) + " mm");
    rows.emplace_back("policy", describe_policies(policies));
    rows.emplace_back("waypoints", std::to_string(waypoints.size()));
    if (plan.status() != PlanStatus::solved)
      rows.emplace_back("plan", std::string(to_string(plan.status())) + ": not all legs have a path");
    rows.emplace_back("padding", significant(padding * 1000.0, 3) + " mm");
    rows.emplace_back("robot", options.robot.robot + " at scale " + significant(robot.scale));
    rows.emplace_back("checker", verdict.checker);
    print_rows(console.out(), rows);
  }
  return verdict.valid ? exit_done : exit_no;
}

}  // namespace clearway
