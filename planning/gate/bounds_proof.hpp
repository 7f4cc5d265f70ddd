#pragma once

// Private to Gate: whether parts stay in the map's bounds.

#include <optional>
#include <string>
#include <vector>

#include "planning/space/configuration_space.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

/// Proves all along straight edges what survey_path asks at poses of a path: of each body whose part has the
/// policy `not_occupied` some is within the map's bounds. Bodies that cannot leave them, wherever the joints
/// are, are looked at once.
class BoundsProof {
 public:
  /// @param allow_outside parts that may leave, or "all"
  /// @throws std::invalid_argument when one is neither
  BoundsProof(const ConfigurationSpace& space, const std::vector<std::string>& allow_outside);

  /// A part that is outside somewhere on the edge, and where; its `distance` is 0 when it is not proved to be
  /// inside there, by a 64th of a voxel. None: all stay inside.
  /// @param robot that of the space
  std::optional<LeavingPart> leaving(const Robot& robot, const Configuration& from,
                                     const Configuration& to) const;

 private:
  struct Watched {
    std::size_t body = 0;
    Eigen::VectorXd levers;  ///< metres that any point moves at most per unit of each joint
  };
  struct Piece;
  bool is_inside(const Watched& watched, const Robot& robot, const LinkPoses& poses, double margin) const;
  LeavingPart left(const Watched& watched, const Robot& robot, const LinkPoses& poses,
                   double parameter) const;

  Eigen::AlignedBox3d bounds_;
  double finest_ = 0.0;  ///< metres that a body moves at most on a piece that is given up
  std::vector<Watched> watched_;
};

}  // namespace clearway
