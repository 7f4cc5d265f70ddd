#include "planning/plan_pick.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/auto_planner.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/path/shortcut.hpp"
#include "planning/picks/pick_scene.hpp"
#include "planning/picks/straight_legs.hpp"
#include "planning/problem/held_to_task.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot_files/tip_choice.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int turns_of_axial = 12;
constexpr int most_starts = 1152;       ///< of inverse kinematics for a pose, a sixth for each turn
constexpr std::size_t most_tried = 48;  ///< grasps that lead on, and places of each
constexpr int shortcuts = 100;

class PickPlanner {
 public:
  PickPlanner(const PlanQuery& query, const Pick& pick, std::shared_ptr<const Planner> planner)
      : query_(query),
        pick_(pick),
        is_growing_(planner->name() == AutoPlanner::table_name),
        round_(is_growing_ ? Round::of_trees(1000, 6, 72) : Round{std::move(planner)}),
        robot_(query.space.robot()),
        scene_(query.space, pick, query.load_policies),
        straight_(scene_, query.space, pick) {}

  /// The legs, up to the first that fails.
  std::vector<PlanResult> run() {
    Farthest taken{"no configuration within the limits was found that puts the tip, link " +
                   quote(robot_.links[static_cast<std::size_t>(robot_.tip_link)].name) + ", at the grasp"};
    for (;;) {
      if (join_any(taken)) return best_;
      if (!is_growing_ || is_end_blocked() || is_hopeless() || is_out_of_time()) break;
      round_ = Round::after(round_);
    }
    if (best_.empty()) return {not_done("taken", taken.why)};
    note_time(best_.back());
    return best_;
  }

  const Load& load() const { return scene_.load(); }
  std::map<std::string, Policy> policies() { return scene_.carrying().policies(); }

 private:
  /// Who is asked for the legs that are not straight, how many grasps, and places of each, are tried, and
  /// how many starts of inverse kinematics look for them.
  struct Round {
    std::shared_ptr<const Planner> planner;
    int samples = 0;
    std::size_t most = most_tried;
    int starts = most_starts / 4;
    int failed = 0;  ///< so many times did the planner find no way between ends that are free

    static Round of_trees(int samples, std::size_t most, int starts) {
      return {std::make_shared<const RrtConnect>(RrtConnectOptions{.max_samples = samples}), samples, most,
              starts};
    }
    static Round after(const Round& round) {
      return of_trees(std::min(4 * round.samples, 100'000'000), std::min(2 * round.most, most_tried),
                      std::min(4 * round.starts, most_starts));
    }
  };

  /// Whether some grasp leads to a plan; else the legs that came farthest are kept.
  bool join_any(Farthest& taken) {
    const std::vector<Hold> places =
        holds(pick_.map_from_place, with_grip(robot_, pick_, query_.start, true));
    std::size_t tried = 0;
    for (const Hold& grasp : holds(pick_.map_from_object, with_grip(robot_, pick_, query_.start, false))) {
      if (tried == round_.most || is_out_of_time()) return false;
      const auto taking = straight_.take(grasp, taken);
      if (!taking) continue;
      Farthest put{"no configuration within the limits was found that puts the object at its place"};
      const std::vector<Putting> puttings = putting_ways(*taking, places, put);
      if (puttings.empty() && !best_.empty()) continue;  // why is known already
      tried += !puttings.empty();
      std::vector<PlanResult> legs = plan_from(*taking, puttings, put.why);
      const bool is_solved = legs.back().status == PlanStatus::solved;
      if (is_solved || legs.size() >= best_.size()) best_ = std::move(legs);
      if (is_solved) return true;
      if (is_end_blocked()) return false;
    }
    return false;
  }

  /// The start of the first leg or the goal of the last, which no other grasp changes.
  bool is_end_blocked() const {
    return !best_.empty() &&
           (best_.front().status == PlanStatus::start_invalid ||
            (best_.size() == names_of_legs(true).size() && best_.back().status == PlanStatus::goal_invalid));
  }

  /// A larger round would try the same grasps and places again, and there is no way that it would look longer
  /// for.
  bool is_hopeless() const {
    return round_.failed == 0 && round_.starts == most_starts && round_.most == most_tried;
  }

  static PlanResult failure(PlanStatus status, const std::string& explanation) {
    PlanResult result;
    result.status = status;
    result.explanation = explanation;
    return result;
  }

  /// The leg that nothing led to.
  PlanResult not_done(const std::string& what, const std::string& why) const {
    if (!is_out_of_time())
      return failure(PlanStatus::no_path, "The object cannot be " + what + ": " + why + ".");
    return failure(PlanStatus::timed_out, "The object cannot be " + what + " within the time limit of " +
                                              limit_text() + ": so far, " + why + ".");
  }

  /// Where the clock ended the search, a leg without a path is not the last word.
  void note_time(PlanResult& leg) const {
    const bool has_path = leg.status != PlanStatus::no_path && leg.status != PlanStatus::timed_out;
    if (has_path || !is_out_of_time() || leg.explanation.find(limit_text()) != std::string::npos) return;
    leg.status = PlanStatus::timed_out;
    leg.explanation += " The search ended at its time limit of " + limit_text() + ".";
  }

  std::string limit_text() const { return short_text(query_.time_limit) + " s (--time-limit gives more)"; }

  bool is_out_of_time() const { return seconds_since(begin_) > query_.time_limit; }

  /// Configurations that hold the object where it is, nearest to `near` first.
  std::vector<Hold> holds(const Eigen::Isometry3d& map_from_object, const Configuration& near) const {
    const int turns = pick_.object.shape.is_axial() ? turns_of_axial : 1;
    std::vector<Hold> found;
    for (int i = 0; i < turns && !is_out_of_time(); ++i) {
      const double turn = 2.0 * std::numbers::pi * i / turns;
      const Eigen::Isometry3d tip =
          map_from_object * Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) * pick_.object_from_tip;
      for (Configuration& q :
           goal_configurations(robot_, tip, near, round_.starts / (turns > 1 ? 6 : 1), query_.seed))
        found.push_back({std::move(q), turn});
    }
    sort_by_nearness(found, near);
    return found;
  }

  static void sort_by_nearness(std::vector<Hold>& holds, const Configuration& near) {
    std::stable_sort(holds.begin(), holds.end(), [&](const Hold& a, const Hold& b) {
      return (a.q - near).lpNorm<Eigen::Infinity>() < (b.q - near).lpNorm<Eigen::Infinity>();
    });
  }

  PlanResult plan_leg(const ConfigurationSpace& space, const Configuration& from, const Configuration& to) {
    const PathCost cost = path_cost(query_, space.robot());
    PlanResult leg = held_to_task(*round_.planner,
                                  {space, cost, from, to, query_.seed, [this] { return is_out_of_time(); }});
    round_.failed += leg.status == PlanStatus::no_path || leg.status == PlanStatus::timed_out;
    if (leg.status == PlanStatus::solved && leg.waypoints.back() != to) {
      leg.status = PlanStatus::no_path;
      leg.explanation = "The planner ends short of where the straight way begins.";
      leg.explored = std::move(leg.waypoints);
      leg.waypoints.clear();
    }
    return leg;
  }

  /// The same, with the leg's name before why it fails.
  PlanResult plan_named_leg(std::size_t index, const ConfigurationSpace& space, const Configuration& from,
                            const Configuration& to) {
    PlanResult leg = plan_leg(space, from, to);
    if (leg.status != PlanStatus::solved)
      leg.explanation = "On " + names_of_legs(true)[index] + ": " + leg.explanation;
    return leg;
  }

  /// From the lifted object to above its place; out of a compartment and into one as the hand came and goes,
  /// where trees do not find the way.
  PlanResult plan_transfer(const Taking& taking, const Putting& putting) {
    const ConfigurationSpace& space = scene_.carrying();
    const Configuration &from = taking.lift.back(), &to = putting.lower.front();
    PlanResult leg = plan_leg(space, from, to);
    if (leg.status == PlanStatus::solved || is_out_of_time()) return leg;
    std::vector<Configuration> path = straight_.way_with_load(from, -pick_.approach);
    const std::vector<Configuration> in = straight_.way_with_load(to, putting.back);
    if (path.size() == 1 && in.size() == 1) return leg;
    PlanResult between = plan_leg(space, path.back(), in.back());
    if (between.status != PlanStatus::solved) return leg;
    path.insert(path.end(), between.waypoints.begin() + 1, between.waypoints.end());
    path.insert(path.end(), in.rbegin() + 1, in.rend());
    between.waypoints = shortcut(space, std::move(path), joint_weights(space, 0.0), query_.seed, shortcuts,
                                 [this] { return is_out_of_time(); });
    between.origins.clear();
    between.cost = path_cost(query_, space.robot())(between.waypoints);
    return between;
  }

  PlanResult straight_leg(const ConfigurationSpace& space, const std::vector<Configuration>& path) const {
    PlanResult leg;
    leg.status = PlanStatus::solved;
    leg.waypoints = path;
    leg.cost = path_cost(query_, space.robot())(path);
    leg.search_steps = static_cast<int>(path.size()) - 1;
    return leg;
  }

  /// The ways that put the object down, the nearest to where it is lifted first.
  std::vector<Putting> putting_ways(const Taking& taking, std::vector<Hold> places, Farthest& farthest) {
    sort_by_nearness(places, taking.lift.back());
    std::vector<Putting> found;
    for (const Hold& place : places) {
      if (found.size() == round_.most || is_out_of_time()) break;
      if (auto putting = straight_.put(taking, place.q, farthest)) found.push_back(std::move(*putting));
    }
    return found;
  }

  std::vector<PlanResult> plan_from(const Taking& taking, const std::vector<Putting>& puttings,
                                    std::string why) {
    std::vector<PlanResult> legs = {plan_named_leg(0, scene_.before(), query_.start, taking.reach.front())};
    if (legs.back().status != PlanStatus::solved) return legs;
    legs.push_back(straight_leg(scene_.bare(), taking.reach));
    legs.push_back(straight_leg(scene_.carrying(), taking.lift));
    const std::size_t taken = legs.size();
    PlanResult failed;
    for (const Putting& putting : puttings) {
      if (is_out_of_time()) break;
      legs.resize(taken);
      legs.push_back(plan_transfer(taking, putting));
      if (legs.back().status != PlanStatus::solved) {
        failed = legs.back();
        why = "on carry: " + failed.explanation;
        continue;
      }
      legs.push_back(straight_leg(scene_.carrying(), putting.lower));
      legs.push_back(straight_leg(scene_.bare(), putting.retreat));
      if (!query_.goals.empty())
        legs.push_back(plan_named_leg(names_of_legs(false).size(), scene_.after(), putting.retreat.back(),
                                      query_.goals.front()));
      return legs;
    }
    legs.resize(taken);
    PlanResult end = not_done("put down", why);
    failed.status = end.status;
    failed.waypoints.clear();
    failed.explanation = std::move(end.explanation);
    legs.push_back(failed);
    return legs;
  }

  const PlanQuery& query_;
  const Pick& pick_;
  bool is_growing_;  ///< `auto` does not end before its time is out: rounds of trees, each larger, instead
  Round round_;
  const Robot& robot_;
  PickScene scene_;
  StraightLegs straight_;
  Clock::time_point begin_ = Clock::now();
  std::vector<PlanResult> best_;
};

void require_query(const PlanQuery& query) {
  if (query.goals.size() > 1)
    throw std::invalid_argument("plan query: goals are " + std::to_string(query.goals.size()) +
                                ": expected at most one with a pick");
  if (!query.loads.empty()) throw std::invalid_argument("plan query: loads: expected none with a pick");
}

/// The query that names what it asks of the object as of any load.
PlanQuery with_object(PlanQuery query, const Pick& pick) {
  query.loads = {{pick.object, {}}};
  return query;
}

void check_legs_of(const ConfigurationSpace& space, const Pick& pick, Plan& plan) {
  const auto begin = Clock::now();
  const ThreadStopwatch cpu(plan.check_cpu_s);
  plan.validation = check_pick(pick_of(plan, pick, space.robot(), space.map()), plan.policies, plan.padding,
                               plan.seen_within);
  plan.check_s = seconds_since(begin);
}

void report_ends(const PlanQuery& query, Plan& plan) {
  plan.goals.clear();
  for (const PlanResult& leg : plan.legs)
    if (!leg.waypoints.empty()) plan.goals.push_back(leg.waypoints.back());
  if (plan.legs.size() == names_of_legs(true).size()) {
    plan.goals.resize(names_of_legs(false).size());
    plan.goals.push_back(query.goals.front());
  }
}

}  // namespace

void require_rigid_hold(const Robot& robot, const Pick& pick) {
  require_one_tip(robot);
  const auto tip = static_cast<std::size_t>(robot.tip_link);
  std::vector<int> above(robot.links.size(), 0);
  std::vector<std::size_t> ends{tip};
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == pick.object.link) ends.push_back(i);
  for (const std::size_t end : ends)
    for (int i = static_cast<int>(end); i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent)
      ++above[static_cast<std::size_t>(i)];
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    if (ends.size() < 2 || above[i] != 1 || link.joint < 0 || link.multiplier == 0.0) continue;
    const std::string joint = robot.joints[static_cast<std::size_t>(link.joint)].name;
    throw std::invalid_argument(
        "pick " + quote(pick.object.name) + ": joint " +
        quote(link.joint_name.empty() ? joint : link.joint_name) + " moves link " + quote(pick.object.link) +
        ", which carries the object, against the tip, link " + quote(robot.links[tip].name) +
        ", expected a link that is fixed to the tip (--tip chooses another tip)");
  }
}

Plan plan_pick(const PlanQuery& query, const Pick& pick) {
  require_query(query);
  const auto planner = query.planner ? query.planner : std::make_shared<const AutoPlanner>();
  const ConfigurationSpace& space = query.space;
  require_sound(pick, space.map().resolution(), space.options().padding);
  require_rigid_hold(space.robot(), pick);
  require_grip(space.robot(), pick);
  Plan plan = empty_plan(with_object(query, pick), *planner);
  const auto begin = Clock::now();
  {
    const ThreadStopwatch cpu(plan.cpu_s);
    PickPlanner legs(query, pick, planner);
    plan.legs = legs.run();
    plan.loads = {{legs.load(), legs_that_carry()}};
    plan.policies = legs.policies();
  }
  plan.pick = pick;
  plan.tip = tip_name(space.robot());
  report_ends(query, plan);
  plan.time_s = seconds_since(begin);
  if (plan.status() == PlanStatus::solved) check_legs_of(space, pick, plan);
  if (query.survey) {
    plan.survey = survey_legs(legs_of(plan, space.robot(), space.map()), plan.policies);
    plan.allow_outside = query.survey->allow_outside;
    refuse_surveyed(*plan.survey, *query.survey, plan.validation);
  }
  return plan;
}

}  // namespace clearway
