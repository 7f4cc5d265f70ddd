#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "planning/robot/kinematics.hpp"
#include "planning/routes/end_effector.hpp"
#include "planning/routes/painted_route.hpp"

namespace clearway {

/// Leads two trees along a route for the hand, each from its end of it: the hand of a node that has come far
/// is brought one place farther by the least joint motion, from joint values spread about the node's: the
/// wider, the more such steps were blocked of late (in the manner of the exploring and exploiting trees of
/// Rickert, Sieverling and Brock 2014). Deterministic for the generator that is given.
class RouteWalk {
 public:
  enum End : std::size_t { start = 0, goal = 1 };

  /// A node of a tree whose hand is at a place of the route.
  struct From {
    int node = 0;
    int place = 0;
  };

  /// @param robot outlives this object  @param route two points or more, not all the same
  RouteWalk(const Robot& robot, const EndEffector& hand, const EndEffectorRoute& route);

  /// The tree at that end has a node at q: counted at the place of the route nearest to its hand, if that is
  /// near the route.
  void add(End end, int node, const Configuration& q);

  /// A node of those at the foremost place, or with less and less chance of those behind it; none while no
  /// node of that tree is near the route.
  std::optional<From> choose(End end, std::mt19937_64& random) const;

  /// A configuration whose hand is about the place after that one; none where the hand does not get there.
  std::optional<Configuration> step(End end, const From& from, const Configuration& q,
                                    std::mt19937_64& random);

  /// What became of the last step: whether the straight way to it was free.
  void learn(End end, bool is_free);

  int places() const { return static_cast<int>(way_.size()); }

 private:
  struct Front {
    std::vector<std::vector<int>> nodes;  ///< at each place
    int foremost = -1;                    ///< place; -1: none yet
    double spread = 0.1;                  ///< of joint values about a node's, rad; see step()
  };

  int next(End end, int place) const { return end == start ? place + 1 : place - 1; }
  int before(End end, int place) const { return end == start ? place - 1 : place + 1; }
  bool is_place(int place) const { return place >= 0 && place < places(); }

  const Robot* robot_;
  EndEffector hand_;
  std::vector<Eigen::Vector3d> way_;  ///< places, evenly spaced along the route
  double near_ = 0.0;                 ///< metres from the route's places within which a hand is near it
  std::array<Front, 2> fronts_;
};

}  // namespace clearway
