#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "planning/robot/load.hpp"

namespace clearway {

/// Where the ball was in a stroke that marks an object: map frame, metres.
struct MarkingBall {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double painted = 0.0;  ///< radius of what it surely swept (Chong 2008, eq. 3)
  double radius = 0.0;   ///< its own
  double bound = 0.0;    ///< how far the centre may be off
};

/// An object of which a stroke says where it is.
struct MarkedObject {
  Load load;  ///< its link is empty where nobody names one; its link_from_load is not used
  Eigen::Isometry3d map_from_object = Eigen::Isometry3d::Identity();
};

/// The body round a stroke: an upright prism of sixteen sides that holds every painted ball, and so each
/// voxel that lies in one, above the plane on which the object stands. Nothing of what it stands on may be
/// the object's: the support is no higher than the lowest point that the ball touched, by what it may be off;
/// the plane is in the row of voxels below the first one that is wholly above that, so that a pick takes no
/// lower row out of the map, and no lower than the support may be.
/// @param resolution of the map, metres
/// @throws std::invalid_argument in one clause when no ball is given, or none reaches above the plane
MarkedObject marked_object(const std::vector<MarkingBall>& balls, double resolution);

}  // namespace clearway
