#include "apps/check/check_contract.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

#include "apps/check/recorded_terms.hpp"
#include "apps/check/robot_terms.hpp"
#include "apps/console/parse.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot/joint_names.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {

namespace {

/// Where joints stand, and which ones move where neither the plan nor flags hold any.
void take_held(const CheckOptions& options, const Robot& robot, RecordQuestion& question) {
  const auto is_asked = [](const HeldJoint& joint) { return joint.source == HoldSource::asked; };
  Robot usual = robot;
  if (std::any_of(robot.held.begin(), robot.held.end(), is_asked)) {
    RobotRequest request = robot_request(options.robot);
    request.group.clear();
    request.fixed.clear();
    request.fixed_states.clear();
    request.standing.clear();
    usual = load_robot(request);
  }
  question.usual_joints = joint_names(usual);
  for (const HeldJoint& joint : robot.held) {
    const auto moves = std::find_if(usual.joints.begin(), usual.joints.end(),
                                    [&](const Joint& each) { return each.name == joint.name; });
    const bool slides = moves != usual.joints.end() && moves->kind == JointKind::prismatic;
    question.held[joint.name] = joint.value * (slides ? question.scale : 1.0);
  }
}

/// The plan's terms that distinguish its query from others, or what flags state in their place.
RecordQuestion question_of(const CheckOptions& options, const Plan& plan, const Robot& robot) {
  RecordQuestion question{.query = plan.query,
                          .robot = robot.name,
                          .dof = robot.dof(),
                          .scale = options.robot.scale.value_or(robot.scale),
                          .start = plan.start,
                          .goals = plan.goals};
  question.joints = joint_names(robot);
  if (!robot.held.empty()) take_held(options, robot, question);
  const ChosenStops stops = choose_stops(
      options.start, options.goals, scaled(robot, question.scale / robot.scale), options.degrees, plan.start);
  question.start = turned_to(plan, robot, stops.start);
  if (!options.goals.empty()) question.goals = stops.goals;
  return question;
}

/// States a contract term by term.
class Statement {
 public:
  Statement(const CheckOptions& options, const Plan& plan, const Robot& robot, const Snapshot& map,
            const RecordedTerms& record)
      : options_(options),
        plan_(plan),
        robot_(robot),
        map_(map),
        record_(record),
        query_(record.query ? &*record.query : nullptr) {}

  Term<double> scale() const {
    if (options_.robot.scale) return {*options_.robot.scale, TermSource::flag};
    if (query_) return {query_->scale, TermSource::map};
    return {robot_.scale, TermSource::by_default};
  }

  Term<Eigen::Isometry3d> base(std::vector<std::string>& notes) const {
    if (!options_.robot.base.empty())
      return {pose_from_numbers(options_.robot.base, "--base"), TermSource::flag};
    if (query_) return {query_->map_from_base, TermSource::map};
    if (const auto recorded = record_.base_instead_of(plan_.map_from_base))
      return {*recorded, TermSource::map};
    if (!plan_.map_from_base.isApprox(robot_.map_from_base, contract_tolerance))
      notes.push_back("the base is the plan's; by its own settings " + quote(robot_.name) + " stands at " +
                      to_text(robot_.map_from_base));
    return {plan_.map_from_base, TermSource::plan};
  }

  /// What flags or record state; what the plan carries beyond that counts as well, since it asks for more.
  Term<std::vector<LegLoad>> loads(const std::optional<Pick>& pick, std::vector<std::string>& notes) const {
    Term<std::vector<LegLoad>> stated{{}, TermSource::plan};
    if (!options_.attach.empty())
      stated = {choose_loads(options_.attach, robot_), TermSource::flag};
    else if (query_)
      stated = {query_->loads, TermSource::map};
    else if (const auto recorded = record_.loads_instead_of(plan_); recorded && !pick)
      stated = {*recorded, TermSource::map};
    const auto is_known = [&](const std::string& name) {
      return std::any_of(stated.value.begin(), stated.value.end(),
                         [&](const LegLoad& load) { return load.load.name == name; });
    };
    const std::string picked = pick         ? pick->object.name
                               : plan_.pick ? plan_.pick->object.name
                                            : std::string();
    for (const LegLoad& load : plan_.loads) {
      if (load.load.name == picked || is_known(load.load.name)) continue;
      notes.push_back("that the robot carries " + describe_load(load) + " is what the plan says");
      stated.value.push_back(load);
    }
    return stated;
  }

  Term<std::optional<Pick>> pick() const {
    if (!options_.pick.empty()) return {choose_pick(options_.pick, options_.place, robot_), TermSource::flag};
    if (query_ && query_->pick) return {query_->pick, TermSource::map};
    return {};
  }

  /// @param loads of the contract, what it picks included
  std::map<std::string, Term<Policy>> policies(const std::vector<LegLoad>& loads,
                                               std::vector<std::string>& notes) const {
    const Robot loaded = with_all_loads(robot_, loads);
    const auto by_default = part_policies(loaded, map_, {});
    std::map<std::string, Term<Policy>> terms;
    for (const auto& [part, policy] : by_default) terms[part] = {policy, TermSource::by_default};
    const auto take = [&](const std::map<std::string, Policy>& policies, TermSource source) {
      for (const auto& [part, policy] : policies) {
        if (terms.contains(part)) terms[part] = {policy, source};
      }
    };
    take(of_plan(loaded), TermSource::plan);
    bound_plan(terms);
    if (query_) take(query_->policies, TermSource::map);
    const Policies flags = choose_policies(options_.robot.policies, loaded);
    if (!flags.critical_by_default) {  // --policy P, for all parts
      for (auto& [part, term] : terms) term = {flags.other.value_or(term.value), TermSource::flag};
    }
    take(flags.parts, TermSource::flag);
    state_loads(loaded, flags, terms);
    for (const auto& [part, term] : terms)
      if (term.source == TermSource::plan && term.value > by_default.at(part))
        notes.push_back("the policy of " + shortened(part) + " is the plan's, " +
                        std::string(to_string(term.value)) + "; by default it is " +
                        std::string(to_string(by_default.at(part))));
    return terms;
  }

  Term<double> payload() const {
    if (options_.dynamics.payload) return {*options_.dynamics.payload, TermSource::flag};
    if (query_ && query_->payload) return {*query_->payload, TermSource::map};
    if (const double least = record_.smallest_payload(); plan_.payload < least)
      return {least, TermSource::map};
    return {plan_.payload, TermSource::plan};
  }

  Term<Eigen::Vector3d> gravity() const {
    if (!options_.dynamics.gravity.empty())
      return {Eigen::Vector3d(options_.dynamics.gravity.data()), TermSource::flag};
    if (query_ && query_->gravity) return {*query_->gravity, TermSource::map};
    if (const auto recorded = record_.gravity_instead_of(plan_.gravity)) return {*recorded, TermSource::map};
    return {plan_.gravity, TermSource::plan};
  }

  Term<std::optional<double>> grip_time() const {
    if (!plan_.motion) return {std::nullopt, TermSource::plan};
    if (options_.grip_time) return {options_.grip_time, TermSource::flag};
    return {plan_.motion->grip_time, TermSource::plan};
  }

  /// At the contract's scale, metres: bit for bit as a robot of that scale has it.
  double position_accuracy() const { return robot_.position_accuracy * (scale().value / robot_.scale); }

  Term<double> padding() const {
    if (options_.robot.padding) return {*options_.robot.padding, TermSource::flag};
    if (query_) return {query_->padding, TermSource::map};
    const double usual = position_accuracy(), recorded = record_.smallest_padding().value_or(usual);
    const Term<double> least = recorded < usual ? Term<double>{recorded, TermSource::map}
                                                : Term<double>{usual, TermSource::by_default};
    return plan_.padding < least.value ? least : Term<double>{plan_.padding, TermSource::plan};
  }

  Term<double> seen_within() const {
    if (options_.robot.seen_within) return {*options_.robot.seen_within, TermSource::flag};
    if (query_) return {query_->seen_within, TermSource::map};
    const double longest = record_.longest_age();
    if (longest > 0.0 && !(plan_.seen_within > 0.0 && plan_.seen_within <= longest))
      return {longest, TermSource::map};
    return {plan_.seen_within, TermSource::plan};
  }

  /// What the flags say of start and goals; named states slide as far as the robot's size says.
  ChosenStops stops(const Configuration& before) const {
    const bool is_own = before.size() == static_cast<Eigen::Index>(robot_.dof());  // not of other joints
    return choose_stops(options_.start, options_.goals, scaled(robot_, scale().value / robot_.scale),
                        options_.degrees, is_own ? before : Configuration());
  }

  Term<Configuration> start() const {
    if (!options_.start.empty()) return {stops({}).start, TermSource::flag};
    if (query_) return {query_->start, TermSource::map};
    return {plan_.start, TermSource::plan};
  }

  /// Poses in place of goals, by flag, else by the record.
  std::pair<std::vector<GoalPose>, std::string> goal_poses() const {
    std::vector<GoalPose> poses;
    for (const NamedGoalPose& named :
         choose_goal_poses(options_.goal_poses, !options_.goals.empty(), !options_.pick.empty(), robot_))
      poses.push_back(named.pose);
    if (!poses.empty()) return {poses, options_.goal_poses.tip};
    if (!options_.goals.empty() || !query_ || query_->goal_poses.empty())
      return {poses, options_.goal_poses.tip};  // which a pick may have
    try {
      with_tip_of(robot_, query_->tip);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("query " + quote(query_->name) + " of the map's record: " + error.what());
    }
    return {query_->goal_poses, query_->tip};
  }

  /// Of a pick the plan says where its legs end, but for the last one to a goal that is stated; of goals that
  /// are poses it says which configurations they are.
  Term<std::vector<Configuration>> goals(bool picks, std::size_t poses) const {
    if (poses > 0)
      return {ends_of_legs(poses + (picks ? names_of_legs(false).size() : 0)),
              options_.goal_poses.poses.empty() ? TermSource::map : TermSource::flag};
    std::vector<Configuration> goals = stops(start().value).goals;
    if (picks) {
      const TermSource source = goals.empty() ? TermSource::plan : TermSource::flag;
      if (goals.empty() && query_) goals = query_->goals;
      std::vector<Configuration> ends = plan_.goals;
      if (!goals.empty()) ends.resize(std::min(ends.size(), names_of_legs(false).size()));
      ends.insert(ends.end(), goals.begin(), goals.end());
      return {ends, source};
    }
    if (!goals.empty()) return {goals, TermSource::flag};
    if (query_) return {query_->goals, TermSource::map};
    return {plan_.goals, TermSource::plan};
  }

 private:
  /// Of no size where the plan has neither a path nor a goal for the leg.
  std::vector<Configuration> ends_of_legs(std::size_t count) const {
    std::vector<Configuration> ends(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (i < plan_.legs.size() && !plan_.legs[i].waypoints.empty())
        ends[i] = plan_.legs[i].waypoints.back();
      else if (i < plan_.goals.size())
        ends[i] = plan_.goals[i];
    }
    return ends;
  }

  /// The map's record of other queries for this robot bounds the policies of a plan.
  void bound_plan(std::map<std::string, Term<Policy>>& terms) const {
    const std::map<std::string, Policy> recorded = record_.loosest_policies();
    for (const Body& body : robot_.bodies) {
      Term<Policy>& term = terms.at(body.part);
      const auto found = recorded.find(body.part);
      if (found != recorded.end() && term.value > found->second) term = {found->second, TermSource::map};
    }
  }

  /// A load that neither flags nor record name must lie in what its holders must; a plan does not loosen
  /// that.
  void state_loads(const Robot& loaded, const Policies& flags,
                   std::map<std::string, Term<Policy>>& terms) const {
    Policies of_parts{.other = Policy::not_occupied};  // as loaded_policies
    for (const Body& body : robot_.bodies) of_parts.parts[body.part] = terms.at(body.part).value;
    const auto usual = part_policies(loaded, map_, of_parts);
    const std::map<std::string, Policy> loosest = record_.loosest_policies();
    for (const Load& load : loaded.loads) {
      Term<Policy>& term = terms.at(load.name);
      if (flags.parts.contains(load.name) || term.source == TermSource::map) continue;
      if (term.source != TermSource::plan) term = {usual.at(load.name), TermSource::by_default};
      for (const std::string& holder : holders_of(loaded, load.name)) {
        const Term<Policy>& of_holder = terms.at(holder);
        if (of_holder.value < term.value ||
            (of_holder.value == term.value && term.source == TermSource::by_default))
          term = of_holder;
      }
      const auto of_record = loosest.find(load.name);  // of other queries
      if (of_record != loosest.end() && of_record->second < term.value)
        term = {of_record->second, TermSource::map};
    }
  }

  /// @param robot with the loads of contract and plan
  /// @throws std::invalid_argument for a part that it does not have.
  std::map<std::string, Policy> of_plan(Robot robot) const try {
    for (const LegLoad& load : plan_.loads) {
      const bool is_known = std::any_of(robot.loads.begin(), robot.loads.end(),
                                        [&](const Load& known) { return known.name == load.load.name; });
      if (!is_known) robot = with_load(robot, load.load);
    }
    part_policies(robot, map_, {.parts = plan_.policies});
    return plan_.policies;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(options_.plan.string() + ": field 'policy': " + error.what());
  }

  const CheckOptions& options_;
  const Plan& plan_;
  const Robot& robot_;
  const Snapshot& map_;
  const RecordedTerms& record_;
  const QueryTerms* query_;
};

}  // namespace

void state_tip(const Robot& robot, TermSource source, Contract& contract) {
  if (!contract.pick.value && contract.goal_poses.empty()) return;
  if (contract.tip.empty()) require_one_tip(robot);
  contract.tip_link = {tip_name(with_tip_of(robot, contract.tip)),
                       contract.tip.empty() ? TermSource::by_default : source};
}

std::string_view to_string(TermSource source) {
  switch (source) {
    case TermSource::flag:
      return "flag";
    case TermSource::map:
      return "map";
    case TermSource::plan:
      return "plan";
    case TermSource::by_default:
      break;
  }
  return "default";
}

namespace {

/// A start is the same one after whole turns of joints without limits.
void note_turns(Contract& contract, const Plan& plan, const Robot& robot) {
  const Configuration& start = contract.start.value;
  if (start.size() != static_cast<Eigen::Index>(robot.dof())) return;
  const Configuration turned = turned_to(plan, robot, start);
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    if (turned[at] == start[at]) continue;
    contract.notes.push_back("the start of joint " + shortened(robot.joints[j].name) + ", " +
                             significant(start[at]) + " rad, counts as " + significant(turned[at]) +
                             " rad: the joint has no limits, and whole turns lead to the same pose");
  }
}

}  // namespace

Configuration turned_to(const Plan& plan, const Robot& robot, const Configuration& start) {
  const auto dof = static_cast<Eigen::Index>(robot.dof());
  return start.size() == dof && plan.start.size() == dof ? by_whole_turns(robot, start, plan.start) : start;
}

Contract state_contract(const CheckOptions& options, const Plan& plan, const Robot& robot,
                        const Snapshot& map, const std::string& map_digest,
                        const std::optional<QueryRecord>& record, bool is_timed) {
  require_same_joints(robot, plan, options.plan);
  Contract contract;
  const RecordedTerms recorded =
      recorded_terms(record, question_of(options, plan, robot), map_digest, contract.notes);
  if (recorded.query) contract.query = recorded.query->name;
  contract.held_apart = recorded.apart;
  const Statement statement(options, plan, robot, map, recorded);
  state_robot(options, plan, robot, contract);
  contract.scale = statement.scale();
  contract.map_from_base = statement.base(contract.notes);
  contract.pick = statement.pick();
  contract.loads = statement.loads(contract.pick.value, contract.notes);
  if (contract.pick.value && !contract.loads.value.empty())
    throw std::invalid_argument("load " + quote(contract.loads.value.front().load.name) +
                                ": expected none beside a pick, whose object is the one load");
  const std::vector<LegLoad> loads = carried_under(contract);
  contract.policies = statement.policies(loads, contract.notes);
  contract.payload = statement.payload();
  contract.gravity = statement.gravity();
  contract.grip_time = statement.grip_time();
  if (is_timed && contract.gravity.source == TermSource::plan &&
      !contract.gravity.value.isApprox(Plan().gravity, contract_tolerance))
    contract.notes.push_back("the gravity is the plan's, " + to_text(Configuration(contract.gravity.value)) +
                             " m/s^2; by default it is " + to_text(Configuration(Plan().gravity)));
  const bool are_dynamics_stated =
      options.dynamics.payload || !options.dynamics.gravity.empty() ||
      (contract.payload.source == TermSource::map && contract.payload.value > 0.0);
  if (!is_timed && are_dynamics_stated)
    contract.notes.push_back(
        "payload and gravity are only compared with what the plan says: torques belong to a motion, which it "
        "does not have");
  contract.padding = statement.padding();
  contract.seen_within = statement.seen_within();
  contract.position_accuracy = statement.position_accuracy();
  contract.demands = options.survey;
  require_parts(contract.demands.allow_outside, with_all_loads(robot, loads), "--allow-outside");
  if (recorded.query) {
    const std::vector<std::string>& allowed = recorded.query->allow_outside;
    contract.demands.allow_outside.insert(contract.demands.allow_outside.end(), allowed.begin(),
                                          allowed.end());
  }
  contract.map_sha256 = {map_digest, TermSource::flag};
  contract.map_resolution = map.resolution();
  contract.start = statement.start();
  std::tie(contract.goal_poses, contract.tip) = statement.goal_poses();
  contract.goals = statement.goals(contract.pick.value.has_value(), contract.goal_poses.size());
  for (const std::string& note : statement.stops(contract.start.value).notes) contract.notes.push_back(note);
  note_turns(contract, plan, robot);
  state_tip(robot, options.goal_poses.tip.empty() ? TermSource::map : TermSource::flag, contract);
  return contract;
}

std::vector<LegLoad> carried_under(const Contract& contract) {
  if (!contract.pick.value) return contract.loads.value;
  return {{contract.pick.value->object, legs_that_carry()}};
}

Robot robot_of(const Contract& contract, const Robot& robot) {
  Robot placed = scaled(robot, contract.scale.value / robot.scale);
  placed.map_from_base = contract.map_from_base.value;
  return placed;
}

Robot tipped_robot_of(const Contract& contract, const Robot& robot) {
  const Robot placed = robot_of(contract, robot);
  const bool has_own_tip = !contract.pick.value || contract.pick.source == TermSource::map;
  return has_own_tip ? placed : with_tip_of(placed, contract.tip);
}

JointLoad joint_load_of(const Contract& contract) {
  return {.payload = contract.payload.value * std::pow(contract.scale.value, 3),
          .gravity = contract.gravity.value};
}

std::map<std::string, Policy> policies_of(const Contract& contract) {
  std::map<std::string, Policy> policies;
  for (const auto& [part, term] : contract.policies) policies[part] = term.value;
  return policies;
}

}  // namespace clearway
