#include "apps/pages/plan_motion.hpp"

#include <algorithm>
#include <cmath>

#include "apps/console/parse.hpp"
#include "planning/robot/inverse_dynamics.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_waypoints = 1500;
constexpr double longest_motion = 1200.0;  ///< s

/// Of samples `first` to `last` the greatest change of velocity of each joint since the sample before, over
/// the period.
Eigen::VectorXd greatest_acceleration(const std::vector<Eigen::VectorXd>& velocities, std::size_t first,
                                      std::size_t last, double period) {
  Eigen::VectorXd greatest = Eigen::VectorXd::Zero(velocities.front().size());
  for (std::size_t k = first; k <= last; ++k) {
    const Eigen::VectorXd before = k > 0 ? velocities[k - 1] : Eigen::VectorXd::Zero(greatest.size()).eval();
    const Eigen::VectorXd change = (velocities[k] - before) / period;
    greatest = (change.cwiseAbs().array() > greatest.cwiseAbs().array()).select(change, greatest);
  }
  return greatest;
}

/// Of samples `first` to `last` the greatest value of each joint, either way.
Eigen::VectorXd greatest_of(const std::vector<Eigen::VectorXd>& values, std::size_t first, std::size_t last) {
  Eigen::VectorXd greatest = values[first];
  for (std::size_t k = first; k <= last; ++k)
    greatest = (values[k].cwiseAbs().array() > greatest.cwiseAbs().array()).select(values[k], greatest);
  return greatest;
}

std::string percent(double share) { return significant(100.0 * share, 3) + " % of limit"; }

/// The torques at each knot, with the loads that ride on the leg that ends there or later.
std::vector<Eigen::VectorXd> torques_of(const Robot& robot, const PlannedMotion& planned,
                                        const JointLoad& load, const std::vector<LegLoad>& loads) {
  const Motion& motion = planned.motion;
  std::vector<Eigen::VectorXd> torques;
  std::size_t k = 0;
  const auto add = [&](std::size_t end, const Robot& loaded) {
    const TorqueTerms terms = torque_terms(loaded, load);
    for (; k < end; ++k)
      torques.push_back(
          joint_torques(loaded, motion.positions[k], motion.velocities[k], motion.accelerations[k], terms));
  };
  for (std::size_t leg = 0; !loads.empty() && leg < planned.leg_ends.size(); ++leg)
    add(planned.leg_ends[leg] + 1, robot_of_leg(robot, loads, static_cast<int>(leg)));
  add(motion.positions.size(), robot);
  return torques;
}

/// "payload 0 kg", or "can 0.5 kg and payload 0.2 kg".
std::string carried(const JointLoad& load, const std::vector<LegLoad>& loads) {
  std::string text;
  for (const LegLoad& one : loads)
    text += (text.empty() ? "" : ", ") + one.load.name + " " + significant(one.load.mass) + " kg";
  if (text.empty() || load.payload != 0.0)
    text += (text.empty() ? "" : " and ") + ("payload " + significant(load.payload) + " kg");
  return text;
}

void show_torques(PagePlan& plan, const Robot& robot, const PlannedMotion& planned,
                  const std::vector<std::size_t>& shown, const JointLoad& load,
                  const std::vector<LegLoad>& loads) {
  Robot loaded = robot;
  for (const LegLoad& one : loads) loaded = with_load(loaded, one.load);
  const TorqueTerms terms = torque_terms(loaded, load);
  if (terms.limits.size() == 0 || !std::isfinite(terms.limits.minCoeff())) return;
  plan.max_torque.assign(terms.limits.begin(), terms.limits.end());
  const std::vector<Eigen::VectorXd> torques = torques_of(robot, planned, load, loads);
  double greatest = 0.0;
  for (const Eigen::VectorXd& at_knot : torques)
    greatest = std::max(greatest, at_knot.cwiseAbs().cwiseQuotient(terms.limits).maxCoeff());
  std::size_t next = 0;
  for (const std::size_t k : shown) {
    plan.torques.push_back(greatest_of(torques, next, k));
    next = k + 1;
  }
  plan.figures.emplace_back("top torque", percent(greatest) + ", with " + carried(load, loads) +
                                              " and gravity (" + significant(load.gravity.x()) + ", " +
                                              significant(load.gravity.y()) + ", " +
                                              significant(load.gravity.z()) + ") m/s^2");
  if (const std::string missing = missing_masses(robot, load.gravity); !missing.empty())
    plan.figures.emplace_back("torques", missing + ", so they are of the masses that are known");
}

}  // namespace

std::vector<std::size_t> show_motion(PagePlan& plan, const Robot& robot,
                                     const std::vector<Configuration>& positions,
                                     const std::vector<Eigen::VectorXd>& velocities, double period,
                                     double max_acceleration) {
  const std::size_t last = positions.size() - 1;
  const std::size_t stride = last / most_waypoints + 1;
  plan.period = period * static_cast<double>(stride);
  plan.duration = period * static_cast<double>(last);
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    plan.max_speed.push_back(velocity_limit(robot, j));
    plan.max_acceleration.push_back(max_acceleration);
  }
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < last; k += stride) shown.push_back(k);
  shown.push_back(last);
  std::size_t next = 0;
  for (const std::size_t k : shown) {
    plan.waypoints.push_back(positions[k]);
    plan.speeds.push_back(velocities[k]);
    plan.accelerations.push_back(greatest_acceleration(velocities, next, k, period));
    next = k + 1;
  }
  return shown;
}

std::vector<std::size_t> show_smooth_motion(PagePlan& plan, const Robot& robot, const PlannedMotion& planned,
                                            const JointLoad& load, const std::vector<LegLoad>& loads) {
  const Motion& motion = planned.motion;
  if (motion.positions.size() < 2 || motion.duration() > longest_motion) return {};
  const RateLimits limits = rate_limits(robot);
  const auto shown = show_motion(plan, robot, motion.positions, motion.velocities, motion.period, 1.0);
  const auto list = [](const Eigen::VectorXd& values) {
    return std::vector<double>(values.begin(), values.end());
  };
  plan.max_speed = list(limits.velocity);
  plan.max_acceleration = list(limits.acceleration);
  plan.max_jerk = list(limits.jerk);
  plan.accelerations.clear();
  std::size_t next = 0;
  for (const std::size_t k : shown) {
    plan.accelerations.push_back(greatest_of(motion.accelerations, next, k));
    plan.jerks.push_back(greatest_acceleration(motion.accelerations, next, k, motion.period));
    next = k + 1;
  }
  const MotionShares shares = shares_of(greatest_rates(motion), limits);
  plan.figures.emplace_back("top joint speed", percent(shares.velocity));
  plan.figures.emplace_back("top acceleration", percent(shares.acceleration));
  plan.figures.emplace_back("top jerk", percent(shares.jerk));
  show_torques(plan, robot, planned, shown, load, loads);
  return shown;
}

std::vector<std::size_t> show_motion(PagePlan& plan, const Robot& robot,
                                     const std::vector<Configuration>& path) {
  const double least = least_duration(robot, path);
  if (least == 0.0 || least > longest_motion) return {};
  return show_trajectory(plan, robot, time_parameterize(robot, path));
}

std::vector<std::size_t> show_trajectory(PagePlan& plan, const Robot& robot, const Trajectory& trajectory) {
  const TrajectoryOptions options;
  if (trajectory.points.size() < 2 || trajectory.points.back().time > longest_motion) return {};
  std::vector<Configuration> positions;
  std::vector<Eigen::VectorXd> velocities;
  for (const TrajectoryPoint& point : trajectory.points) {
    positions.push_back(point.position);
    velocities.push_back(point.velocity);
  }
  const auto shown =
      show_motion(plan, robot, positions, velocities, options.sampling_period, options.max_acceleration);
  const LimitShares shares = limit_shares(robot, trajectory, options);
  plan.figures.emplace_back("motion", significant(plan.duration) + " s");
  plan.figures.emplace_back("sampled every", significant(1000.0 * options.sampling_period) + " ms");
  plan.figures.emplace_back("top joint speed", percent(shares.velocity));
  plan.figures.emplace_back("top acceleration", percent(shares.acceleration));
  return shown;
}

}  // namespace clearway
