#pragma once

#include <map>
#include <string>

#include "planning/space/configuration_space.hpp"

namespace clearway {

/// The policy of every part of the robot: as given; else `painted` for critical parts (of the robot, or named
/// by a painted volume) when the map holds any paint and `known_free` when it holds none; else
/// `policies.other`; else, for a robot that names no critical part in a map that holds free voxels,
/// `known_free`; else `not_occupied`. A load must lie in what each of its holders must: the strictest of
/// their policies, unless one is given.
/// @throws std::invalid_argument when a policy names a part that the robot does not have.
std::map<std::string, Policy> part_policies(const Robot& robot, const Snapshot& map,
                                            const Policies& policies);

/// What a part with this policy must lie in. For `painted`: the volumes that name the part (of a load that
/// none names: its holders'), or all volumes when none does. For `known_free`: seen within so many seconds
/// before the newest look (0: ever).
Requirement part_requirement(const Robot& robot, const Snapshot& map, const std::string& part, Policy policy,
                             double seen_within = 0.0);

/// Refuses a `seen_within` (seconds, 0: ever) that the map cannot answer, or that no part is asked.
/// @param policies of the parts
/// @throws std::invalid_argument
void require_seen_within(double seen_within, const Snapshot& map,
                         const std::map<std::string, Policy>& policies);

/// A part whose policy is `painted` although the volumes that count for it hold no painted sphere (its CFV is
/// empty): one sentence; empty when there is none. No configuration of such a robot is free.
std::string empty_volume_sentence(const ConfigurationSpace& space);

}  // namespace clearway
