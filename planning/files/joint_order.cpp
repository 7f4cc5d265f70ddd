#include "planning/files/joint_order.hpp"

#include <algorithm>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"
#include "planning/robot/joint_names.hpp"

namespace clearway {
Plan in_order_of(const Robot& robot, Plan plan) {
  const std::vector<std::string> own = joint_names(robot);
  if (own == plan.joints ||
      !std::is_permutation(own.begin(), own.end(), plan.joints.begin(), plan.joints.end()))
    return plan;
  std::vector<Eigen::Index> places;
  for (const std::string& name : own)
    places.push_back(std::find(plan.joints.begin(), plan.joints.end(), name) - plan.joints.begin());
  const auto reorder = [&](std::vector<Configuration>& list) {
    for (Configuration& q : list) q = Configuration(q(places));
  };
  if (plan.start.size() > 0) plan.start = Configuration(plan.start(places));
  reorder(plan.goals);
  for (PlanResult& leg : plan.legs) {
    reorder(leg.waypoints);
    reorder(leg.explored);
  }
  if (plan.motion)
    for (auto* list : {&plan.motion->motion.positions, &plan.motion->motion.velocities,
                       &plan.motion->motion.accelerations})
      reorder(*list);
  plan.joints = own;
  return plan;
}

void require_joint_order(const Robot& robot, const Plan& plan) {
  const std::vector<std::string> own = joint_names(robot);
  if (plan.joints.empty() || plan.joints == own) return;
  const bool has_all = std::is_permutation(own.begin(), own.end(), plan.joints.begin(), plan.joints.end());
  throw std::invalid_argument(
      "plan: its joints " + listed(plan.joints) +
      (has_all ? " stand in another order than those of robot " : " are not those of robot ") +
      quote(robot.name) + ", expected " + listed(own));
}

}  // namespace clearway
