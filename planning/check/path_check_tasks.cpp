#include <algorithm>
#include <cmath>

#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"

namespace clearway::check {

namespace {

/// The painted volumes that name the body's part; of a load that none names those of the first part that
/// holds it: on the links from its own towards the root, then of those that it touches.
std::uint16_t volumes_of_body(const Robot& robot, const Snapshot& map, std::size_t body) {
  const std::uint16_t own = map.volumes_of_part(robot.bodies[body].part);
  if (own != 0 || body < own_bodies(robot)) return own;
  const Load& load = robot.loads[body - own_bodies(robot)];
  const auto of_link = [&](int link) {
    std::optional<std::uint16_t> volumes;  // none: the link has no body
    for (const Body& other : robot.bodies) {
      if (other.link != link) continue;
      if (volumes.value_or(0) == 0) volumes = map.volumes_of_part(other.part);
    }
    return volumes;
  };
  std::optional<std::uint16_t> carrier;
  for (int i = robot.links[static_cast<std::size_t>(robot.bodies[body].link)].parent; i >= 0 && !carrier;
       i = robot.links[static_cast<std::size_t>(i)].parent)
    carrier = of_link(i);
  if (carrier.value_or(0) != 0) return *carrier;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const auto& touched = load.touches;
    if (std::find(touched.begin(), touched.end(), robot.links[i].name) == touched.end()) continue;
    if (const auto volumes = of_link(static_cast<int>(i)); volumes.value_or(0) != 0) return *volumes;
  }
  return 0;
}

}  // namespace

Tasks list_tasks(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                 const KdlArm& arm, const FclBodies& bodies) {
  Tasks tasks;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    if (!arm.is_policed(i)) continue;
    const std::string& part = robot.bodies[i].part;
    Group group;
    if (const auto policy = policies.find(part); policy != policies.end()) group.policy = policy->second;
    const std::uint16_t volumes = volumes_of_body(robot, map, i);
    if (group.policy == Policy::painted && volumes != 0) group.volumes = volumes;
    auto known = std::find(tasks.groups.begin(), tasks.groups.end(), group);
    if (known == tasks.groups.end()) known = tasks.groups.insert(tasks.groups.end(), group);
    tasks.items.push_back({i, std::nullopt, static_cast<std::size_t>(known - tasks.groups.begin())});
  }
  const auto exempt = justified_exemptions(robot, arm, bodies);
  for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < robot.bodies.size(); ++b) {
      const bool is_exempt = is_held(robot, a, b).value_or(exempt.contains({a, b}));
      if (!is_exempt && arm.may_touch(a, b)) tasks.items.push_back({a, b, 0});
    }
  }
  return tasks;
}

Eigen::AlignedBox3d swept_box(const KdlArm& arm, const FclBodies& bodies, const Tasks& tasks,
                              std::size_t group, const Eigen::VectorXd& start, const Eigen::VectorXd& step,
                              double spacing) {
  const auto counts = [&](const Item& item) { return !item.other && item.group == group; };
  double motion = 0.0;
  for (const Item& item : tasks.items) {
    if (counts(item)) motion = std::max(motion, arm.motion(item.body, step.cwiseAbs()));
  }
  const int pieces = std::clamp(static_cast<int>(std::ceil(motion / spacing)), 1, 10000);
  Eigen::AlignedBox3d box;
  BodyPoses poses;
  for (int k = 0; k <= pieces; ++k) {
    arm.place(start + step * k / pieces, poses);
    for (const Item& item : tasks.items) {
      if (counts(item)) box.extend(bounds(bodies, item.body, poses[item.body], motion / (2 * pieces)));
    }
  }
  return box;
}

}  // namespace clearway::check
