#include "apps/check/rate_terms.hpp"

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/path/motion.hpp"

namespace clearway {
namespace {

std::vector<std::string> joints_without(const Robot& robot, double Joint::*limit) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints)
    if (!(joint.*limit > 0.0)) names.push_back(joint.name);
  return names;
}

std::string told(const std::vector<std::string>& joints, const Robot& robot) {
  return joints.size() == robot.dof() && joints.size() > 1 ? "any joint" : listed(joints);
}

/// "12.3 rad/s^2"
std::string with_unit(double value, const Joint& joint, const std::string& per) {
  return significant(value, 3) + (joint.kind == JointKind::prismatic ? " m/" : " rad/") + per;
}

std::string peak_text(const RatePeak& peak, const Robot& robot, const std::string& per) {
  const Joint& joint = robot.joints[peak.joint];
  return "peak " + with_unit(peak.value, joint, per) + " of joint " + shortened(joint.name) + " at " +
         significant(peak.time) + " s" + (peak.part.empty() ? "" : " of " + peak.part);
}

/// @param per "s" or "s^2"
void add_rate(const std::string& rate, const std::string& per, double Joint::*limit, double usual,
              const std::optional<RatePeak>& peak, const Robot& robot, std::vector<UnjudgedRate>& rates) {
  if (!peak) return;
  const std::vector<std::string> joints = joints_without(robot, limit);
  rates.push_back({rate, joints, *peak, robot.joints[peak->joint].name, usual,
                   "not judged: the robot states no " + rate + " limit of " + told(joints, robot) + "; " +
                       peak_text(*peak, robot, per) + ", where plan keeps " + significant(usual)});
}

}  // namespace

std::vector<UnjudgedRate> unjudged_rates(const SplineVerdict& verdict, const Robot& robot) {
  const MotionScales usual;
  std::vector<UnjudgedRate> rates;
  add_rate("velocity", "s", &Joint::max_velocity, usual.default_velocity, verdict.free_velocity, robot,
           rates);
  add_rate("acceleration", "s^2", &Joint::max_acceleration, usual.default_acceleration,
           verdict.free_acceleration, robot, rates);
  if (!verdict.jerk) return rates;
  std::vector<std::string> all;
  for (const Joint& joint : robot.joints) all.push_back(joint.name);
  const double limit = robot.joints[verdict.jerk->joint].max_jerk;
  rates.push_back({"jerk", all, *verdict.jerk, robot.joints[verdict.jerk->joint].name, 0.0,
                   "not judged: controllers of ROS do not limit it; " +
                       peak_text(*verdict.jerk, robot, "s^3") + ", between points" +
                       (limit > 0.0 ? ", where the robot states a limit of " + significant(limit) : "")});
  return rates;
}

std::string usual_limits_note(const Robot& robot) {
  const MotionScales usual;
  std::string terms;
  const auto add_term = [&](double Joint::*limit, const std::string& rate, const std::string& value) {
    const std::vector<std::string> joints = joints_without(robot, limit);
    if (joints.empty()) return;
    terms += (terms.empty() ? "" : "; ") + rate + " of " + told(joints, robot) + ", " + value;
  };
  add_term(&Joint::max_velocity, "velocity", significant(usual.default_velocity) + " rad/s (m/s)");
  add_term(&Joint::max_acceleration, "acceleration",
           significant(usual.default_acceleration) + " rad/s^2 (m/s^2)");
  add_term(
      &Joint::max_jerk, "jerk",
      "what builds up the whole acceleration in " + significant(1000.0 * usual.default_rise_time) + " ms");
  if (terms.empty()) return {};
  return "the motion is judged by the usual limits where the robot states none: " + terms;
}

}  // namespace clearway
