#pragma once

#include <functional>
#include <string>

#include "datasets/sources/recording.hpp"

namespace mrpt::obs {
class CObservation;
}
namespace mrpt::poses {
class CPose3D;
}

namespace clearway {

Eigen::Isometry3d isometry(const mrpt::poses::CPose3D& pose);

/// Turns one MRPT observation, made by a robot at `world_from_robot`, into frame contents (a range camera may
/// yield two), or says in one sentence what was left out and why ("" for a kind we have no use for).
void decode_observation(const mrpt::obs::CObservation& observation,
                        const mrpt::poses::CPose3D& world_from_robot,
                        const std::function<void(decltype(Frame::content)&&)>& content,
                        const std::function<void(const std::string&)>& skipped);

}  // namespace clearway
