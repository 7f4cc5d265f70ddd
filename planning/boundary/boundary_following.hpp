#pragma once

#include <Eigen/Core>
#include <vector>

#include "planning/constraint/local_step.hpp"

namespace clearway {

/// The bypassing plane (P) through q_lock, q_goal and q_lim, Lahouar et al. 2006, eq. 10-13, in weighted
/// joint units (see DamperOptions).
struct BypassPlane {
  Eigen::VectorXd lock;    ///< q_lock
  Eigen::VectorXd u1, u2;  ///< orthonormal; u1 points to the goal, u2 towards q_lim

  Eigen::Vector2d coordinates(const Eigen::VectorXd& y) const { return {u1.dot(y - lock), u2.dot(y - lock)}; }
  /// Lahouar 2006, eq. 13.
  Eigen::VectorXd lift(const Eigen::Vector2d& du) const { return du[0] * u1 + du[1] * u2; }
};

/// Lahouar 2006, eq. 10-12. When V is parallel to U1, the first joint axis that is not takes its place.
/// @pre lock != goal and at least two joints.
BypassPlane bypass_plane(const Eigen::VectorXd& lock, const Eigen::VectorXd& goal,
                         const Eigen::VectorXd& limit);

/// q_lim of Lahouar 2006, eq. 11: all upper (or all lower) joint limits; a joint without one: q_lock +- pi.
Configuration side_limits(const Robot& robot, const Configuration& lock, bool upper);

/// A constraint in the plane, Lahouar 2006, eq. 14-20, scaled to unit normal: direction . du <= bound.
struct ProjectedConstraint {
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< A_i / ||A_i||
  double bound = 0.0;                                    ///< b_i / ||A_i||
  int source = 0;                ///< constraint number: pairs, then upper, then lower limits (as LocalStep)
  bool can_be_followed = false;  ///< a near pair, or a joint limit within one step
};

/// All constraints projected; those that the plane's motion cannot change (||A_i|| = 0) are left out.
std::vector<ProjectedConstraint> project(const StepConstraints& constraints, const BypassPlane& plane,
                                         double max_step);

/// The first A_lock: of the constraints that are active in the local step, the one most along [1, 0]; without
/// an active constraint, of all constraints that can be followed. -1 when there is none.
int first_followed(const std::vector<ProjectedConstraint>& projected, const Eigen::VectorXd& multipliers);

/// The constraint whose direction has the largest scalar product with the last A_lock (Lahouar 2006, eq. 23);
/// of equals the nearer one.
int tracked(const std::vector<ProjectedConstraint>& projected, const Eigen::Vector2d& last);

/// The vertex of Lahouar 2006, Fig. 9: the point on constraint `followed`'s line that is farthest along S =
/// [-A_2, A_1] (Lahouar 2006, eq. 22), keeps all constraints and ||du|| <= max_step. A line out of reach is
/// drawn in to max_step / sqrt(2).
struct Vertex {
  bool exists = false;  ///< false: no point of the line keeps all constraints
  Eigen::Vector2d du = Eigen::Vector2d::Zero();
  double advance = 0.0;  ///< along S; may be negative
  int blocking = -1;     ///< the constraint that ends the way along S; -1: the step length
  int behind = -1;  ///< the one that ends it the other way; nothing is left when the two exclude each other
};
Vertex vertex_on(const std::vector<ProjectedConstraint>& projected, int followed, double max_step);

/// The vertex to move to, after following the blocking constraint instead as often as the vertex is null
/// (Lahouar 2006, Fig. 10).
struct BoundaryStep {
  Vertex vertex;
  int followed = -1;     ///< constraint followed in the end
  int switches = 0;      ///< constraint switches: another constraint blocked the way along the followed one
  int skipped = 0;       ///< those whose whole line a nearer one excludes (a convex corner ahead)
  bool is_null = true;   ///< no constraint gives a way along S: the motion stops
  bool relaxed = false;  ///< demanded separations were given up (bounds < 0 taken as 0) to find a way
};
BoundaryStep boundary_step(std::vector<ProjectedConstraint> projected, int followed, double max_step);

}  // namespace clearway
