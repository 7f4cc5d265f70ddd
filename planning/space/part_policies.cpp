#include "planning/space/part_policies.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "mapping/field/seen_within.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool has_paint(const Snapshot& map) {
  // A bare tree knows painted voxels, no spheres.
  return !map.volumes().empty() || map.holds_any({VoxelState::painted, VoxelState::conflict});
}

bool has_free_space(const Snapshot& map) {
  return map.holds_any({VoxelState::painted, VoxelState::seen_free});
}

/// Of parts that are neither critical nor named.
Policy usual_policy(const Robot& robot, const Snapshot& map, const Policies& policies) {
  if (policies.other) return *policies.other;
  const bool is_cautious = policies.critical_by_default && robot.critical_parts.empty();
  return is_cautious && has_free_space(map) ? Policy::known_free : Policy::not_occupied;
}

/// The painted volumes that count for a part; of a load that none names its holders'.
std::uint16_t volumes_of(const Robot& robot, const Snapshot& map, const std::string& part) {
  std::uint16_t volumes = map.volumes_of_part(part);
  for (const std::string& holder : holders_of(robot, part))
    if (volumes == 0) volumes = map.volumes_of_part(holder);
  return volumes;
}

/// Loads must lie in what their holders must. A load may hold another: the later one.
void restrict_loads(const Robot& robot, const Policies& policies, std::map<std::string, Policy>& chosen) {
  for (const Load& load : robot.loads) {
    if (policies.parts.contains(load.name)) continue;
    Policy& policy = chosen.at(load.name);
    for (const std::string& holder : holders_of(robot, load.name))
      policy = std::min(policy, chosen.at(holder));
  }
}

bool has_sphere(const Snapshot& map, std::uint16_t volumes) {
  for (std::size_t v = 0; v < map.volumes().size(); ++v) {
    if ((volumes >> v & 1U) != 0 && !map.volumes()[v].spheres.empty()) return true;
  }
  return map.volumes().empty() && has_paint(map);
}

}  // namespace

std::map<std::string, Policy> part_policies(const Robot& robot, const Snapshot& map,
                                            const Policies& policies) {
  // Of a bare tree only a walk through all of it shows: not in a control loop's map if no part wants to know.
  std::optional<Policy> critical;
  const auto of_critical_parts = [&] {
    if (!critical) critical = has_paint(map) ? Policy::painted : Policy::known_free;
    return *critical;
  };
  const Policy usual = usual_policy(robot, map, policies);
  std::map<std::string, Policy> chosen;
  for (const Body& body : robot.bodies) {
    const auto& list = robot.critical_parts;
    const bool is_critical =
        policies.critical_by_default &&
        (std::find(list.begin(), list.end(), body.part) != list.end() || map.volumes_of_part(body.part) != 0);
    const bool is_given = policies.parts.contains(body.part);
    chosen[body.part] = is_critical && !is_given ? of_critical_parts() : usual;
  }
  const auto given = [&](const std::string& part, Policy otherwise) {
    const auto found = policies.parts.find(part);
    return found == policies.parts.end() ? otherwise : found->second;
  };
  for (auto& [part, policy] : chosen) policy = given(part, policy);
  restrict_loads(robot, policies, chosen);
  for (const auto& [part, policy] : policies.parts) {
    if (chosen.contains(part)) continue;
    std::vector<std::string> names;
    for (const auto& entry : chosen) names.push_back(entry.first);
    throw std::invalid_argument("policy names the part " + quote(part) + ", expected a part of " +
                                robot.name + ": " + listed(names));
  }
  return chosen;
}

Requirement part_requirement(const Robot& robot, const Snapshot& map, const std::string& part, Policy policy,
                             double seen_within) {
  Requirement requirement;
  requirement.policy = policy;
  if (policy == Policy::known_free) requirement.seen_within = seen_within;
  if (policy == Policy::painted) {
    if (const std::uint16_t volumes = volumes_of(robot, map, part); volumes != 0)
      requirement.volumes = volumes;
  }
  return requirement;
}

void require_seen_within(double seen_within, const Snapshot& map,
                         const std::map<std::string, Policy>& policies) {
  require_seen_within(seen_within, map.seen());
  if (seen_within == 0.0) return;
  for (const auto& [part, policy] : policies) {
    if (policy == Policy::known_free) return;
  }
  throw std::invalid_argument(
      "seen within: asks parts under known_free when their voxels were last seen, and no part is under it; "
      "expected a policy known_free");
}

namespace {

/// Whether any of a part's bodies does: others are not looked for in the map.
bool moves(const Robot& robot, const std::string& part) {
  return std::any_of(robot.bodies.begin(), robot.bodies.end(), [&](const Body& body) {
    int link = body.part == part ? body.link : -1;
    while (link >= 0 && robot.links[static_cast<std::size_t>(link)].joint < 0)
      link = robot.links[static_cast<std::size_t>(link)].parent;
    return link >= 0;
  });
}

}  // namespace

std::string empty_volume_sentence(const ConfigurationSpace& space) {
  for (const auto& [part, policy] : space.policies()) {
    if (policy != Policy::painted || !moves(space.robot(), part) ||
        has_sphere(space.map(), part_requirement(space.robot(), space.map(), part, policy).volumes))
      continue;
    return "the part " + quote(part) +
           " must lie in painted space (policy painted), but no ball is painted in a volume that counts for "
           "it";
  }
  return {};
}

}  // namespace clearway
