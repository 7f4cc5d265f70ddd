#pragma once

#include <string>

#include "apps/teach/virtual_robot.hpp"

namespace clearway {

/// Radius of the narrowest cylinder along an axis of the tip's frame W' that holds the robot's parts which
/// have to stay in paint (Chong et al. 2008, section 3: the bounding cylinder of the critical part), where
/// its joints stand in the middle; with padding, metres. 0: it has none of these.
double hand_radius(const VirtualRobot& robot);

/// What is to be told of a probe's ball that is not sure to hold a voxel as a whole, which alone paints it;
/// empty of a larger one. Lengths in metres.
std::string ball_for_voxels(double ball_radius, double resolution);

/// What is to be told of a ball of which a stroke is narrower than the robot's hand; empty of a larger one.
std::string ball_for_hand(double ball_radius, const VirtualRobot& robot);

}  // namespace clearway
