#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planning/picks/pick_scene.hpp"

namespace clearway {

/// A configuration that holds the object, by a turn about the object's axis.
struct Hold {
  Configuration q;
  double turn = 0.0;
};

/// The straight legs at the object, each as the robot goes it.
struct Taking {
  Hold grasp;
  std::vector<Configuration> reach, lift;
};

/// The straight legs at the object's place.
struct Putting {
  std::vector<Configuration> lower, retreat;
  Eigen::Vector3d back;  ///< away from the place as the hand retreats, map frame
};

/// Why nothing was found: of all that was tried, what the first of those that got farthest failed of.
struct Farthest {
  std::string why;
  int step = -1;  ///< how far it got

  void fail(int at, const std::string& reason) {
    if (at <= step) return;
    step = at;
    why = reason;
  }
};

/// The straight legs of a pick, where they are free.
class StraightLegs {
 public:
  /// @param scene of the same pick; outlives this one, as do `space`, of the robot without loads, and `pick`
  StraightLegs(PickScene& scene, const ConfigurationSpace& space, const Pick& pick);

  /// Reach and lift with that grasp; `farthest` hears what they fail of. From where they are tried for being
  /// free with the object, the scene's robot holds it so.
  std::optional<Taking> take(const Hold& grasp, Farthest& farthest);

  /// Lower and retreat where the robot at `placed` has the object at its place; `farthest` hears what they
  /// fail of.
  /// @pre the scene's robot holds the object as in `taking`
  std::optional<Putting> put(const Taking& taking, const Configuration& placed, Farthest& farthest);

  /// As far straight `way` (metres, map frame) as the robot with the object is free; `from` alone where it
  /// cannot move.
  std::vector<Configuration> way_with_load(const Configuration& from, const Eigen::Vector3d& way);

 private:
  using Path = std::vector<Configuration>;

  std::string margin_hint() const;
  Eigen::Isometry3d link_pose(const Configuration& q) const;
  std::optional<std::pair<Path, Path>> upwards(const Configuration& from) const;
  bool is_contact_free(const ConfigurationSpace& on_layer, const Eigen::Isometry3d& map_from_object,
                       const Path& on_support);

  PickScene& scene_;
  const Robot& robot_;
  const Pick& pick_;
  double padding_, contact_, step_;
};

}  // namespace clearway
