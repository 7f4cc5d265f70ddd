#include "planning/planned_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/files/joint_order.hpp"
#include "planning/leg_motions.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {

namespace {

/// What happens to loads between a leg and the next.
std::vector<TrajectoryEvent> events_after(const Plan& plan, int leg) {
  std::vector<TrajectoryEvent> events;
  for (const LegLoad& load : plan.loads) {
    const bool rides = load.rides_on(leg), will_ride = load.rides_on(leg + 1);
    if (rides == will_ride) continue;
    events.push_back(
        {will_ride ? TrajectoryEvent::Kind::attach : TrajectoryEvent::Kind::detach, load.load.name});
  }
  return events;
}

/// The least number of periods in which the time is.
std::size_t periods_of(double time, double period) {
  return static_cast<std::size_t>(std::ceil(time / period - 1e-9));
}

/// A file may hold fewer legs in its motion than its path has.
void require_ends_of_legs(const Plan& plan) {
  if (plan.motion->leg_ends.size() != plan.legs.size())
    throw std::invalid_argument("motion: it has the ends of " + counted(plan.motion->leg_ends.size(), "leg") +
                                ", expected as many as the path has, " + std::to_string(plan.legs.size()));
}

/// The motion with what happens to loads on it.
Trajectory with_events(const Plan& plan) {
  require_ends_of_legs(plan);
  const PlannedMotion& planned = *plan.motion;
  Trajectory trajectory = trajectory_of(planned.motion);
  const double period = planned.motion.period;
  for (std::size_t leg = 0; leg + 1 < planned.leg_ends.size(); ++leg) {
    std::size_t knot = planned.leg_ends[leg];
    for (TrajectoryEvent& event : events_after(plan, static_cast<int>(leg))) {
      const std::size_t periods = periods_of(planned.grip_time, period);
      event.time = period * static_cast<double>(knot);
      event.rest = period * static_cast<double>(periods);
      knot += periods;
      trajectory.events.push_back(std::move(event));
    }
  }
  return trajectory;
}

/// At rest where it is for so many periods.
void rest(Trajectory& trajectory, std::size_t periods) {
  const TrajectoryPoint at = trajectory.points.back();
  for (std::size_t k = 1; k <= periods; ++k) {
    trajectory.points.push_back(at);
    trajectory.points.back().time = at.time + static_cast<double>(k) * trajectory.sampling_period;
  }
}

/// Adds what begins where `joined` ends.
void join(const Trajectory& own, Trajectory& joined) {
  const double begin = joined.points.empty() ? 0.0 : joined.points.back().time;
  joined.sampling_period = own.sampling_period;
  for (std::size_t k = joined.points.empty() ? 0 : 1; k < own.points.size(); ++k) {
    joined.points.push_back(own.points[k]);
    joined.points.back().time += begin;
  }
}

/// A leg's edges in time; of a pick the robot rests before its hand moves, and after.
Trajectory timed_leg(const Robot& robot, const Plan& plan, std::size_t leg) {
  const std::vector<Configuration>& path = plan.legs[leg].waypoints;
  if (!plan.pick || path.empty()) return time_parameterize(robot, path);
  Trajectory joined;
  for (const auto& stretch : stretches_of(robot, *plan.pick, path))
    join(time_parameterize(robot, stretch), joined);
  return joined;
}

Trajectory timed_legs(const Robot& robot, const Plan& plan, double grip_time) {
  Trajectory joined;
  for (std::size_t leg = 0; leg < plan.legs.size(); ++leg) {
    join(timed_leg(robot, plan, leg), joined);
    if (leg + 1 == plan.legs.size()) break;
    for (TrajectoryEvent& event : events_after(plan, static_cast<int>(leg))) {
      event.time = joined.points.back().time;
      const std::size_t periods = periods_of(grip_time, joined.sampling_period);
      event.rest = static_cast<double>(periods) * joined.sampling_period;
      rest(joined, periods);
      joined.events.push_back(std::move(event));
    }
  }
  return joined;
}

constexpr std::array<double, 3> shares_of_reach = {1.0, 0.125, 0.0};

SmoothMotionOptions with_share(SmoothMotionOptions options, std::size_t level) {
  options.reach *= shares_of_reach[level];
  if (shares_of_reach[level] == 0.0) options.straighten = 0.0;
  return options;
}

MotionTerms terms_of(const ConfigurationSpace& space, const Plan& plan,
                     const std::map<std::string, Policy>& policies) {
  return {space.robot(),
          space.map(),
          policies,
          space.options().padding,
          space.options().seen_within,
          load_of(plan, space.robot())};
}

/// What the check takes to ride on the robot: of a pick what it states, where the plan has it.
std::vector<LegLoad> riding_on(const Plan& plan) {
  if (!plan.pick) return plan.loads;
  LegLoad picked{plan.pick->object, legs_that_carry()};
  for (const LegLoad& load : plan.loads)
    if (load.load.name == picked.load.name) picked.load.link_from_load = load.load.link_from_load;
  return {picked};
}

/// By KDL, each leg with the loads that ride on it.
void judge_torques(const MotionTerms& terms, const MotionToCheck& motion, const std::vector<LegLoad>& loads,
                   MotionJudgement& judged) {
  judged.torques.emplace();
  const std::vector<std::size_t> grips = grips_between(loads, motion.rests.size());
  const std::vector<KnotRange> knots = knots_of_legs(motion, grips);
  for (std::size_t leg = 0; leg < knots.size();) {
    std::size_t last = leg;
    while (last < grips.size() && grips[last] == 0) ++last;
    const Robot robot = robot_of_leg(terms.robot, loads, static_cast<int>(leg));
    const TorqueTerms torques = torque_terms(robot, terms.load);
    TorqueFinding found =
        greatest_torques(robot, stretch_of(motion.motion, knots[leg].first, knots[last].last), torques);
    found.place += static_cast<double>(knots[leg].first);
    const std::string fault = torque_fault(robot, motion.motion.period, torques, found);
    if (judged.verdict.fault.empty()) judged.verdict.fault = fault;
    std::set<std::string> overloaded(judged.torques->overloaded.begin(), judged.torques->overloaded.end());
    overloaded.insert(found.overloaded.begin(), found.overloaded.end());
    if (std::isnan(found.share) || found.share > judged.torques->share) *judged.torques = found;
    judged.torques->overloaded.assign(overloaded.begin(), overloaded.end());
    leg = last + 1;
  }
  judged.verdict.valid = judged.verdict.fault.empty();
}

/// Of a robot that carries nothing.
PlannedMotion plan_bare_motion(const ConfigurationSpace& space, const Plan& plan,
                               const SmoothMotionOptions& options) {
  std::vector<std::vector<Configuration>> legs;
  for (const PlanResult& leg : plan.legs) legs.push_back(leg.waypoints);
  const auto torques =
      std::make_shared<const TorqueTerms>(torque_terms(space.robot(), load_of(plan, space.robot())));
  Plan moved = plan;
  PlannedMotion& planned = moved.motion.emplace();
  planned.scales = options.scales;
  for (std::size_t level = 0; level < shares_of_reach.size(); ++level) {
    SmoothMotionOptions tried = with_share(options, level);
    tried.torques = torques;
    const double begin = thread_cpu_seconds();
    SmoothMotion made = smooth_motion(space, legs, tried);
    planned.cpu_s += thread_cpu_seconds() - begin;
    planned.motion = std::move(made.motion);
    planned.leg_ends = std::move(made.leg_ends);
    planned.blended = made.blended;
    planned.stops = made.stops;
    planned.validation = check_planned_motion(space, moved, space.policies());
    if (planned.validation.valid) break;
  }
  return planned;
}

/// Of legs on which the robot is not the same: one after the other, resting where loads are taken or left.
class LoadedMotion {
 public:
  LoadedMotion(const ConfigurationSpace& space, const Plan& plan, const SmoothMotionOptions& options,
               double grip_time)
      : space_(space), plan_(plan), options_(options), made_(plan.legs.size()), level_(plan.legs.size(), 0) {
    plan_.motion.emplace();
    plan_.motion->scales = options.scales;
    plan_.motion->grip_time = grip_time;
  }

  PlannedMotion run() {
    PlannedMotion& planned = *plan_.motion;
    const double begin = thread_cpu_seconds();
    const LegMotions legs(space_, plan_);
    planned.cpu_s += thread_cpu_seconds() - begin;
    do {
      const double made = thread_cpu_seconds();
      for (std::size_t leg = 0; leg < made_.size(); ++leg) {
        if (!made_[leg]) made_[leg] = legs.make(leg, with_share(options_, level_[leg]));
      }
      join();
      planned.cpu_s += thread_cpu_seconds() - made;
      planned.validation = check_planned_motion(space_, plan_, plan_.policies);
    } while (!planned.validation.valid && shorten(planned.validation.leg));
    return planned;
  }

 private:
  void join() {
    PlannedMotion& planned = *plan_.motion;
    planned.motion = {};
    planned.leg_ends.clear();
    planned.unblended.clear();
    planned.blended = planned.stops = 0;
    const std::vector<std::size_t> grips = grips_between(plan_.loads, made_.size());
    for (std::size_t leg = 0; leg < made_.size(); ++leg) {
      append(planned.motion, made_[leg]->motion);
      planned.leg_ends.push_back(planned.motion.positions.size() - 1);
      if (leg < grips.size())
        append_rest(planned.motion, grips[leg] * periods_of(planned.grip_time, planned.motion.period));
      planned.blended += made_[leg]->blended;
      planned.stops += made_[leg]->stops;
      if (shares_of_reach[level_[leg]] == 0.0) planned.unblended.push_back(leg);
    }
  }

  /// Blends of the leg that the check refuses, or of all, become shorter. False where none can.
  bool shorten(int refused) {
    bool is_shorter = false;
    for (std::size_t leg = 0; leg < level_.size(); ++leg) {
      if (refused >= 0 && leg != static_cast<std::size_t>(refused)) continue;
      if (level_[leg] + 1 == shares_of_reach.size()) continue;
      ++level_[leg];
      made_[leg].reset();
      is_shorter = true;
    }
    return is_shorter;
  }

  const ConfigurationSpace& space_;
  Plan plan_;
  const SmoothMotionOptions& options_;
  std::vector<std::optional<SmoothMotion>> made_;  ///< of each leg, unless its blends just became shorter
  std::vector<std::size_t> level_;                 ///< of shares_of_reach, of each leg
};

}  // namespace

PlannedMotion plan_motion(const ConfigurationSpace& space, const Plan& plan,
                          const SmoothMotionOptions& options, double grip_time) {
  require_joint_order(space.robot(), plan);
  if (!plan.is_proved())
    throw std::invalid_argument("motion: the plan is not proved, expected one that is solved and valid");
  if (!(grip_time >= 0.0 && grip_time <= most_grip_time))
    throw std::invalid_argument("motion: grip_time is " + short_text(grip_time) +
                                ", expected seconds from 0 to 60");
  if (plan.loads.empty() && !plan.pick) return plan_bare_motion(space, plan, options);
  return LoadedMotion(space, plan, options, grip_time).run();
}

void give_motion(const ConfigurationSpace& space, Plan& plan, const SmoothMotionOptions& options,
                 double grip_time) {
  plan.motion.reset();
  plan.motion_caveat.clear();
  if (!plan.is_proved()) return;
  try {
    plan.motion = plan_motion(space, plan, options, grip_time);
    if (plan.motion->validation.valid) return;
    plan.motion_caveat = "the check refuses it: " + plan.motion->validation.fault;
    plan.motion.reset();
  } catch (const std::invalid_argument& error) {
    plan.motion_caveat = error.what();
  }
}

namespace {

/// Of the robot's limits, of which those that the motion keeps may be a part (MotionScales).
MotionShares of_whole_limits(const MotionShares& shares, const MotionScales& scales) {
  return {shares.velocity * scales.speed, shares.acceleration * scales.acceleration,
          shares.jerk * scales.jerk};
}

}  // namespace

MotionJudgement judge_motion(const MotionTerms& terms, const Plan& plan) {
  require_joint_order(terms.robot, plan);
  const std::vector<LegLoad> loads = riding_on(plan);
  const MotionToCheck motion = motion_to_check(plan, terms.robot);
  MotionJudgement judged;
  judged.verdict = plan.pick ? check_pick_motion(pick_of(plan, *plan.pick, terms.robot, terms.map), motion,
                                                 terms.policies, terms.padding, terms.seen_within)
                             : check_motion(terms.robot, terms.map, terms.policies, terms.padding, motion,
                                            loads, terms.seen_within);
  if (judged.verdict.valid) judge_torques(terms, motion, loads, judged);
  judged.verdict.shares = of_whole_limits(judged.verdict.shares, plan.motion->scales);
  return judged;
}

MotionVerdict check_planned_motion(const ConfigurationSpace& space, const Plan& plan,
                                   const std::map<std::string, Policy>& policies) {
  return judge_motion(terms_of(space, plan, policies), plan).verdict;
}

JointLoad load_of(const Plan& plan, const Robot& robot) {
  return {.payload = plan.payload * std::pow(robot.scale, 3), .gravity = plan.gravity};
}

Trajectory trajectory_of(const Motion& motion) {
  Trajectory trajectory{motion.period, {}};
  for (std::size_t k = 0; k < motion.positions.size(); ++k)
    trajectory.points.push_back({static_cast<double>(k) * motion.period, motion.positions[k],
                                 motion.velocities[k], motion.accelerations[k]});
  return trajectory;
}

Trajectory trajectory_of(const Robot& robot, const Plan& plan, double grip_time) {
  require_joint_order(robot, plan);
  if (plan.motion) return with_events(plan);
  return plan.loads.empty() && !plan.pick ? time_parameterize(robot, plan.waypoints())
                                          : timed_legs(robot, plan, grip_time);
}

std::vector<Trajectory> leg_trajectories(const Robot& robot, const Plan& plan) {
  if (plan.motion) require_ends_of_legs(plan);
  std::vector<Trajectory> legs;
  std::size_t first = 0;
  for (std::size_t leg = 0; leg < plan.legs.size(); ++leg) {
    if (!plan.motion) {
      legs.push_back(timed_leg(robot, plan, leg));
      continue;
    }
    const std::size_t last = plan.motion->leg_ends[leg];
    legs.push_back(trajectory_of(stretch_of(plan.motion->motion, first, last)));
    first = last;
  }
  return legs;
}

}  // namespace clearway
