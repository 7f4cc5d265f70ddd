#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/check/check_contract.hpp"
#include "apps/console/parse.hpp"
#include "apps/query/goal_poses.hpp"
#include "apps/query/loads.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/problem/planner.hpp"
#include "planning/robot_files/tip_choice.hpp"

namespace clearway {

namespace {

std::string by(TermSource source) {
  switch (source) {
    case TermSource::flag:
      return "";
    case TermSource::map:
      return " by the map's record";
    case TermSource::plan:
      return " by the plan itself";
    case TermSource::by_default:
      break;
  }
  return " by default";
}

/// Every sentence says what was expected, and what the plan says or does.
class Comparison {
 public:
  Comparison(const Contract& contract, const Plan& plan, const Robot& robot,
             const std::set<AcceptedTerm>& accepted)
      : contract_(contract), plan_(plan), robot_(robot), accepted_(accepted) {}

  std::vector<Deviation> run() {
    compare_robot();
    compare_held();
    compare_policies();
    compare_padding();
    compare_seen_within();
    compare_loads();
    compare_pick();
    compare_dynamics();
    compare_map();
    compare_start();
    compare_goals();
    compare_goal_poses();
    return std::move(found_);
  }

 private:
  void add(AcceptedTerm term, const std::string& sentence) {
    found_.push_back({term, sentence, accepted_.contains(term)});
  }

  void compare_robot() {
    const auto name = [](const std::string& robot) { return std::filesystem::path(robot).stem(); };
    if (name(contract_.robot.value) != name(plan_.robot))
      add(AcceptedTerm::robot,
          "robot: expected " + quote(contract_.robot.value) + ", the plan is for " + quote(plan_.robot));
    const auto& [scale, source] = contract_.scale;
    if (!(std::abs(plan_.robot_scale - scale) <= contract_tolerance * scale))
      add(AcceptedTerm::scale, "scale: expected " + significant(scale, 7) + by(source) + ", the plan says " +
                                   significant(plan_.robot_scale, 7));
    const Eigen::Isometry3d& base = contract_.map_from_base.value;
    const double moved = (base.matrix() - plan_.map_from_base.matrix()).cwiseAbs().maxCoeff();
    if (!(moved <= contract_tolerance))
      add(AcceptedTerm::base, "base: expected " + to_text(base) + by(contract_.map_from_base.source) +
                                  ", the plan says " + to_text(plan_.map_from_base));
  }

  void compare_held() {
    for (const auto& [joint, term] : contract_.held) {
      const auto said = plan_.held.find(joint);
      if (said != plan_.held.end() && std::abs(said->second - term.value) <= contract_tolerance) continue;
      add(AcceptedTerm::held,
          "joint " + shortened(joint) + ": expected to stand at " + significant(term.value, 7) +
              by(term.source) + ", the plan says " +
              (said == plan_.held.end() ? std::string("nothing of it") : significant(said->second, 7)));
    }
    const auto is_of_record = [](TermSource source) { return source == TermSource::map; };
    if (!is_of_record(contract_.start.source) && !is_of_record(contract_.goals.source)) return;
    for (const std::string& sentence : contract_.held_apart) add(AcceptedTerm::held, sentence);
  }

  void compare_policies() {
    for (const auto& [part, term] : contract_.policies) {
      if (term.source == TermSource::plan) continue;
      const auto said = plan_.policies.find(part);
      if (said != plan_.policies.end() && said->second <= term.value) continue;
      if (said == plan_.policies.end() && (term.source == TermSource::by_default || is_missing_load(part)))
        continue;  // the usual one counts, or it is reported as such
      const std::string says =
          said == plan_.policies.end() ? "nothing of it" : std::string(to_string(said->second));
      add(AcceptedTerm::policy, "policy of " + shortened(part) + ": expected " +
                                    std::string(to_string(term.value)) + by(term.source) +
                                    ", the plan says " + says);
    }
  }

  /// One of the contract's that the plan does not carry.
  bool is_missing_load(const std::string& part) const {
    const auto is_it = [&](const LegLoad& load) { return load.load.name == part; };
    const std::vector<LegLoad> loads = carried_under(contract_);
    return std::any_of(loads.begin(), loads.end(), is_it) &&
           std::none_of(plan_.loads.begin(), plan_.loads.end(), is_it);
  }

  void compare_padding() {
    const auto& [padding, source] = contract_.padding;
    if (plan_.padding >= padding) return;
    add(AcceptedTerm::padding, "padding: expected " + significant(padding * 1000.0) + " mm" + by(source) +
                                   ", the plan says " + significant(plan_.padding * 1000.0) + " mm");
  }

  /// By a flag alone the path is checked: whoever planned without it may have kept it all the same.
  void compare_seen_within() {
    const auto& [seconds, source] = contract_.seen_within;
    if (source != TermSource::map || seconds == 0.0) return;
    if (plan_.seen_within > 0.0 && plan_.seen_within <= seconds) return;
    add(AcceptedTerm::policy,
        "seen within: expected " + significant(seconds) + " s" + by(source) + ", the plan says " +
            (plan_.seen_within > 0.0 ? significant(plan_.seen_within) + " s" : std::string("ever")));
  }

  /// What the plan carries beyond the contract only makes its way narrower.
  void compare_loads() {
    const auto& [loads, source] = contract_.loads;
    for (const LegLoad& load : loads) {
      const auto said = std::find_if(plan_.loads.begin(), plan_.loads.end(),
                                     [&](const LegLoad& other) { return other.load.name == load.load.name; });
      const std::string expected = "load: expected " + describe_load(load) + by(source) + ", the plan ";
      if (said == plan_.loads.end()) {
        add(AcceptedTerm::load, expected + "says nothing of it");
        continue;
      }
      if (!is_same(load.load, said->load))
        add(AcceptedTerm::load, expected + "says another shape, place, mass or touching links of it");
      require_legs(load, source);
      for (std::size_t leg = 0; leg < contract_.goals.value.size(); ++leg) {
        if (!load.rides_on(static_cast<int>(leg)) || said->rides_on(static_cast<int>(leg))) continue;
        add(AcceptedTerm::load, expected + "leaves it off on leg " + std::to_string(leg + 1));
      }
    }
  }

  /// A load that rides on single legs rides on none that the plan cut away or numbered anew.
  void require_legs(const LegLoad& load, TermSource source) {
    if (load.legs.empty() || source == TermSource::plan) return;
    const std::string expected = "load: expected " + describe_load(load) + by(source) + ", ";
    if (contract_.goals.source == TermSource::plan)
      add(AcceptedTerm::load, expected + "and --goal for each leg: the plan alone says which leg is which");
    const int legs = static_cast<int>(std::min(contract_.goals.value.size(), plan_.legs.size()));
    for (const int leg : load.legs)
      if (leg >= legs) add(AcceptedTerm::load, expected + "the plan has no leg " + std::to_string(leg + 1));
  }

  /// A pick frees voxels, and lets some things touch.
  void compare_pick() {
    const auto& [pick, source] = contract_.pick;
    if (!pick && !plan_.pick) return;
    if (!pick)
      return add(AcceptedTerm::load, "pick: expected --pick, because the plan takes the voxels of " +
                                         quote(plan_.pick->object.name) + " out of the map and touches it");
    const std::string expected =
        "pick: expected that " + quote(pick->object.name) + " is picked" + by(source);
    if (!plan_.pick) return add(AcceptedTerm::load, expected + ", the plan says nothing of it");
    if (!is_same(*pick, *plan_.pick))
      add(AcceptedTerm::load,
          expected + ", the plan says another shape, pose, grasp, place, way or grip of it");
  }

  /// With more than is stated at the tip, costs are higher and motions slower.
  void compare_dynamics() {
    const auto& [payload, source] = contract_.payload;
    if (plan_.payload < payload)
      add(AcceptedTerm::payload, "payload: expected " + significant(payload) + " kg" + by(source) +
                                     ", the plan says " + significant(plan_.payload) + " kg");
    const Eigen::Vector3d& gravity = contract_.gravity.value;
    if (!((plan_.gravity - gravity).cwiseAbs().maxCoeff() <= contract_tolerance))
      add(AcceptedTerm::payload, "gravity: expected " + to_text(Configuration(gravity)) + " m/s^2" +
                                     by(contract_.gravity.source) + ", the plan says " +
                                     to_text(Configuration(plan_.gravity)) + " m/s^2");
  }

  void compare_map() {
    const double voxel = contract_.map_resolution, of_plan = plan_.map_resolution;  // 0: an export says none
    if (contract_.map_sha256.value == plan_.map_sha256) {
      if (of_plan > 0.0 && std::abs(of_plan - voxel) > contract_tolerance)
        add(AcceptedTerm::map, "map: expected voxels of " + significant(1e3 * voxel) +
                                   " mm, the plan was made on those of " + significant(1e3 * of_plan) +
                                   " mm (--cloud-resolution)");
      return;
    }
    add(AcceptedTerm::map, "map: expected one with the sha256 " + contract_.map_sha256.value.substr(0, 16) +
                               "…, the plan was made on another, " + plan_.map_sha256.substr(0, 16) + "…");
  }

  void compare_start() {
    auto [start, source] = contract_.start;
    if (start.size() == 0) {
      add(AcceptedTerm::goals, "start: expected --start, because neither the map nor the plan says it");
      return;
    }
    start = turned_to(plan_, robot_, start);
    if (plan_.start.size() > 0) require_near(start, plan_.start, "start", by(source), "the plan says ");
    const std::vector<Configuration> path = plan_.waypoints();
    if (!path.empty()) require_near(start, path.front(), "start", by(source), "the path begins at ");
  }

  void compare_goals() {
    const auto& [goals, source] = contract_.goals;
    if (goals.empty()) {
      add(AcceptedTerm::goals, "goals: expected --goal, because neither the map nor the plan says one");
      return;
    }
    const std::string count = std::to_string(goals.size());
    if (!plan_.goals.empty() && plan_.goals.size() != goals.size())
      add(AcceptedTerm::goals,
          "goals: expected " + count + by(source) + ", the plan says " + std::to_string(plan_.goals.size()));
    if (plan_.legs.size() > goals.size())
      add(AcceptedTerm::goals, "legs: expected " + count + ", one for each goal, the plan has " +
                                   std::to_string(plan_.legs.size()));
    for (std::size_t i = 0; i < goals.size(); ++i) {
      const std::string what = "goal " + std::to_string(i + 1) + " of " + count;
      if (i < plan_.goals.size()) require_near(goals[i], plan_.goals[i], what, by(source), "the plan says ");
      const bool is_there = i < plan_.legs.size() && !plan_.legs[i].waypoints.empty();
      if (is_there) {
        require_near(goals[i], plan_.legs[i].waypoints.back(), what, by(source), "the path ends its leg at ");
      } else {
        add(AcceptedTerm::goals, what + ": is not reached, the plan has no leg to it");
      }
    }
  }

  /// Where the legs end, which compare_goals() calls missing where there is none.
  void compare_goal_poses() {
    const std::vector<GoalPose>& poses = contract_.goal_poses;
    const auto& [goals, source] = contract_.goals;
    if (poses.empty()) return;
    const Robot robot = with_tip_of(robot_of(contract_, robot_), contract_.tip);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const std::size_t leg = goals.size() - poses.size() + i;
      if (goals[leg].size() != static_cast<Eigen::Index>(robot.dof())) continue;
      const Eigen::Isometry3d end = tip_pose(robot, goals[leg]);
      if (reaches(poses[i], end)) continue;
      const Eigen::Isometry3d off = poses[i].map_from_tip.inverse() * end;
      add(AcceptedTerm::goals,
          "goal " + std::to_string(leg + 1) + " of " + std::to_string(goals.size()) + ": expected " +
              describe_goal_pose(contract_.tip, poses[i]) + by(source) + ", the path ends its leg " +
              significant(1000.0 * off.translation().norm(), 3) + " mm and " +
              significant(Eigen::AngleAxisd(off.linear()).angle(), 3) + " rad from there");
    }
  }

  void require_near(const Configuration& expected, const Configuration& found, const std::string& what,
                    const std::string& source, const std::string& verb) {
    const double apart = largest_difference(expected, found);
    if (apart <= contract_tolerance) return;
    add(AcceptedTerm::goals, what + ": expected " + to_text(expected) + source + ", " + verb +
                                 to_text(found) + ", " + significant(apart, 3) + " from it");
  }

  const Contract& contract_;
  const Plan& plan_;
  const Robot& robot_;
  const std::set<AcceptedTerm>& accepted_;
  std::vector<Deviation> found_;
};

}  // namespace

std::vector<Deviation> deviations(const Contract& contract, const Plan& plan, const Robot& robot,
                                  const std::set<AcceptedTerm>& accepted) {
  return Comparison(contract, plan, robot, accepted).run();
}

namespace {

/// With their policies: who names a load that nothing else names, names what it must lie in, too.
/// @throws std::invalid_argument for a pick beside other loads, which nobody plans.
void adopt_loads(const Plan& plan, const Robot& robot, Contract& contract) {
  if (plan.pick)
    for (const LegLoad& load : plan.loads)
      if (load.load.name != plan.pick->object.name)
        throw std::invalid_argument(
            "load " + quote(load.load.name) +
            " of the plan: expected none beside a pick, whose object is the one load");
  contract.loads = {plan.loads, TermSource::plan};
  contract.pick = {plan.pick, TermSource::plan};
  if (contract.tip.empty() && contract.goal_poses.empty() && !is_own_tip_name(plan.tip) &&
      plan.tip != tip_name(robot))
    contract.tip = plan.tip;
  state_tip(robot, contract.tip_link.source == TermSource::flag ? TermSource::flag : TermSource::plan,
            contract);
  for (const LegLoad& load : plan.loads) {
    const auto said = plan.policies.find(load.load.name);
    const Policy policy = said == plan.policies.end() ? Policy::painted : said->second;
    contract.policies.insert({load.load.name, {policy, TermSource::plan}});
  }
}

void adopt_dynamics(const Plan& plan, Contract& contract) {
  if (plan.payload < contract.payload.value) contract.payload = {plan.payload, TermSource::plan};
  if (plan.gravity != contract.gravity.value) contract.gravity = {plan.gravity, TermSource::plan};
}

}  // namespace

void adopt_accepted(const std::vector<Deviation>& found, const Plan& plan, const Robot& robot,
                    Contract& contract) {
  for (const Deviation& deviation : found) {
    if (!deviation.is_accepted) continue;
    if (deviation.term == AcceptedTerm::scale) contract.scale = {plan.robot_scale, TermSource::plan};
    if (deviation.term == AcceptedTerm::base) contract.map_from_base = {plan.map_from_base, TermSource::plan};
    if (deviation.term == AcceptedTerm::padding) contract.padding = {plan.padding, TermSource::plan};
    if (deviation.term == AcceptedTerm::load) adopt_loads(plan, robot, contract);
    if (deviation.term == AcceptedTerm::payload) adopt_dynamics(plan, contract);
    if (deviation.term != AcceptedTerm::policy) continue;
    Term<double>& seen_within = contract.seen_within;
    const bool is_looser = plan.seen_within == 0.0 || plan.seen_within > seen_within.value;
    if (seen_within.source == TermSource::map && is_looser)
      seen_within = {plan.seen_within, TermSource::plan};
    for (auto& [part, term] : contract.policies) {
      const auto said = plan.policies.find(part);
      if (said != plan.policies.end() && said->second > term.value) term = {said->second, TermSource::plan};
    }
  }
}

}  // namespace clearway
