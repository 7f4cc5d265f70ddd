#include "planning/planned_motion.hpp"

#include <cmath>
#include <memory>
#include <stdexcept>

#include "mapping/system/thread_time.hpp"
#include "planning/check/motion_torques.hpp"
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

/// At rest where it is for so many periods.
void rest(Trajectory& trajectory, std::size_t periods) {
  const TrajectoryPoint at = trajectory.points.back();
  for (std::size_t k = 1; k <= periods; ++k) {
    trajectory.points.push_back(at);
    trajectory.points.back().time = at.time + static_cast<double>(k) * trajectory.sampling_period;
  }
}

Trajectory timed_legs(const Robot& robot, const Plan& plan, double grip_time) {
  Trajectory joined;
  for (std::size_t leg = 0; leg < plan.legs.size(); ++leg) {
    const Trajectory own = time_parameterize(robot, plan.legs[leg].waypoints);
    const double begin = joined.points.empty() ? 0.0 : joined.points.back().time;
    joined.sampling_period = own.sampling_period;
    for (std::size_t k = joined.points.empty() ? 0 : 1; k < own.points.size(); ++k) {
      joined.points.push_back(own.points[k]);
      joined.points.back().time += begin;
    }
    if (leg + 1 == plan.legs.size()) break;
    for (TrajectoryEvent& event : events_after(plan, static_cast<int>(leg))) {
      event.time = joined.points.back().time;
      const auto periods = static_cast<std::size_t>(std::ceil(grip_time / joined.sampling_period - 1e-9));
      event.rest = static_cast<double>(periods) * joined.sampling_period;
      rest(joined, periods);
      joined.events.push_back(std::move(event));
    }
  }
  return joined;
}

/// By the check of paths, then of torques.
MotionVerdict verdict_on(const ConfigurationSpace& space, const std::vector<Configuration>& stops,
                         const PlannedMotion& planned, const TorqueTerms& torques) {
  MotionVerdict verdict = check_motion(
      space.robot(), space.map(), space.policies(), space.options().padding, planned.motion, planned.leg_ends,
      stops, rate_limits(space.robot(), planned.scales), space.options().seen_within);
  if (!verdict.valid) return verdict;
  verdict.fault = torque_fault(space.robot(), planned.motion, torques,
                               greatest_torques(space.robot(), planned.motion, torques));
  verdict.valid = verdict.fault.empty();
  return verdict;
}

}  // namespace

PlannedMotion plan_motion(const ConfigurationSpace& space, const Plan& plan,
                          const SmoothMotionOptions& options) {
  if (!plan.is_proved())
    throw std::invalid_argument("motion: the plan is not proved, expected one that is solved and valid");
  if (!plan.loads.empty() || plan.pick)
    throw std::invalid_argument(
        "motion: the plan carries loads, expected one without: edges alone are proved with them");
  std::vector<std::vector<Configuration>> legs;
  for (const PlanResult& leg : plan.legs) legs.push_back(leg.waypoints);
  PlannedMotion planned;
  planned.scales = options.scales;
  const auto torques =
      std::make_shared<const TorqueTerms>(torque_terms(space.robot(), load_of(plan, space.robot())));
  for (const double share : {1.0, 0.125, 0.0}) {
    SmoothMotionOptions tried = options;
    tried.torques = torques;
    tried.reach *= share;
    if (share == 0.0) tried.straighten = 0.0;
    const double begin = thread_cpu_seconds();
    SmoothMotion made = smooth_motion(space, legs, tried);
    planned.cpu_s += thread_cpu_seconds() - begin;
    planned.motion = std::move(made.motion);
    planned.leg_ends = std::move(made.leg_ends);
    planned.blended = made.blended;
    planned.stops = made.stops;
    planned.validation = verdict_on(space, plan.stops(), planned, *torques);
    if (planned.validation.valid) break;
  }
  return planned;
}

void give_motion(const ConfigurationSpace& space, Plan& plan, const SmoothMotionOptions& options) {
  plan.motion.reset();
  plan.motion_caveat.clear();
  if (!plan.is_proved()) return;
  if (!plan.loads.empty() || plan.pick) {
    plan.motion_caveat =
        "with loads the robot goes edge by edge and rests where legs end: blends are proved without";
    return;
  }
  try {
    plan.motion = plan_motion(space, plan, options);
    if (plan.motion->validation.valid) return;
    plan.motion_caveat = "the check refuses it: " + plan.motion->validation.fault;
    plan.motion.reset();
  } catch (const std::invalid_argument& error) {
    plan.motion_caveat = error.what();
  }
}

MotionVerdict check_planned_motion(const ConfigurationSpace& space, const Plan& plan) {
  if (plan.loads.empty() && !plan.pick)
    return verdict_on(space, plan.stops(), *plan.motion,
                      torque_terms(space.robot(), load_of(plan, space.robot())));
  MotionVerdict verdict;
  verdict.fault = "motions of robots that carry loads are not checked, expected a plan without `motion`";
  return verdict;
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
  if (plan.motion) return trajectory_of(plan.motion->motion);
  return plan.loads.empty() && !plan.pick ? time_parameterize(robot, plan.waypoints())
                                          : timed_legs(robot, plan, grip_time);
}

}  // namespace clearway
