#pragma once

#include <Eigen/Geometry>
#include <map>

#include "tracking/tag_body.hpp"

namespace clearway {

/// How the places of a board's tags as measured compare with those that were stated.
struct PlacesScale {
  double scale = 1.0;  ///< distances between tags as measured over those that were stated
  double sigma = 0.0;  ///< relative, by the errors of stated places alone
  double place =
      0.0;  ///< metres along each axis: how far stated places are off, as stated or as they scatter
  Eigen::Isometry3d stated_from_scaled = Eigen::Isometry3d::Identity();    ///< of places divided by `scale`
  Eigen::Isometry3d stated_from_measured = Eigen::Isometry3d::Identity();  ///< of places as they are
  std::map<int, Eigen::Vector3d> by_place;  ///< how log(scale) grows with each measured place, per metre

  /// Where a tag is in the stated frame, the common scale left out.
  Eigen::Isometry3d scaled(const Eigen::Isometry3d& measured) const;
};

/// The similarity, and the rigid motion, that bring most measured tags to where they were stated: Cauchy
/// weights about the best of all pairs of tags (as RANSAC would draw them). Middles and normals of the tags
/// count, not how they are turned in their planes.
/// @param place metres along each axis that stated places may be off, one standard deviation, > 0
/// @param size relative, that the scale may be off, one standard deviation, > 0
/// @pre both have the same tags, two or more
PlacesScale scale_of_places(const TagBody& stated, const TagBody& measured, double place, double size);

}  // namespace clearway
