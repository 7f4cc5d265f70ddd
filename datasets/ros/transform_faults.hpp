#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "datasets/ros/transform_tree.hpp"

namespace clearway {

/// A bag that is whole, but says of one time that things are in two places.
class ContradictoryBag : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The frames whose poses say where these are.
std::set<std::string> used_frames(const TransformTree& tree, const std::string& root,
                                  const std::set<std::string>& sensors);

/// Whether frames below this one drive while it stands in `root`, or moves less than they do, as below a map
/// and an odometry's frame: what is measured in it was put there, and not seen from its origin.
bool is_driven_in(const TransformTree& tree, const std::string& root, const std::string& frame);

/// @param sensors frames of sensors that are placed in `root`
/// @throws ContradictoryBag a clause: on the way from these to the root a frame is in a loop, has two parents
/// by which it leads there (or none does), or alternates between places.
void refuse_contradictions(const TransformTree& tree, const std::string& root,
                           const std::set<std::string>& sensors);

/// A clause for each thing that can be used, but is to be told: single poses that contradict others, fixed
/// frames that are moved, frames with a second parent.
std::vector<std::string> tell_contradictions(const TransformTree& tree, const std::string& root,
                                             const std::set<std::string>& sensors);

}  // namespace clearway
