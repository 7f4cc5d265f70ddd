#include "planning/boundary/boundary_following.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

namespace clearway {
namespace boundary_following_test {

using Eigen::Vector2d;
using Eigen::VectorXd;

TEST(BypassPlane, IsSpannedByTheGoalAndTheLimitAndIsOrthonormal) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Index n = 2 + static_cast<Eigen::Index>(random() % 6);
    const auto draw = [&] { return VectorXd(VectorXd::NullaryExpr(n, [&] { return uniform(random); })); };
    const VectorXd lock = draw(), goal = draw(), limit = draw();
    const BypassPlane plane = bypass_plane(lock, goal, limit);
    EXPECT_NEAR(plane.u1.norm(), 1.0, 1e-12);
    EXPECT_NEAR(plane.u2.norm(), 1.0, 1e-12);
    EXPECT_NEAR(plane.u1.dot(plane.u2), 0.0, 1e-12);
    EXPECT_GT(plane.u1.dot(goal - lock), 0.0);
    EXPECT_GT(plane.u2.dot(limit - lock), 0.0);
    for (const VectorXd& point : {goal, limit}) {  // both lie in the plane
      EXPECT_LE((plane.lift(plane.coordinates(point)) - (point - lock)).norm(), 1e-9);
    }
  }
}

TEST(BypassPlane, TakesTheNextAxisWhenTheLimitLiesStraightAhead) {
  const Eigen::Vector3d lock(0.1, 0.2, 0.3), along(1.0, 0.0, 0.0);
  for (const double sense : {1.0, -1.0}) {
    const BypassPlane plane = bypass_plane(lock, lock + along, lock + sense * 3.0 * along);
    EXPECT_EQ(plane.u2, Eigen::Vector3d(0.0, 1.0, 0.0));
  }
}

TEST(BypassPlane, UnlimitedJointsAreTakenToReachHalfATurn) {
  Robot robot;
  robot.joints.resize(2);
  robot.joints[0].lower = -1.0, robot.joints[0].upper = 2.0;
  robot.joints[1].lower = -INFINITY, robot.joints[1].upper = INFINITY;
  const Eigen::Vector2d lock(0.5, 0.25);
  EXPECT_EQ(side_limits(robot, lock, true), Vector2d(2.0, 0.25 + std::numbers::pi));
  EXPECT_EQ(side_limits(robot, lock, false), Vector2d(-1.0, 0.25 - std::numbers::pi));
}

TEST(Project, KeepsTheMeaningOfEveryConstraintInThePlane) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Index n = 2 + static_cast<Eigen::Index>(random() % 5),
                       m = static_cast<Eigen::Index>(random() % 6);
    const auto draw = [&](Eigen::Index size) {
      return VectorXd(VectorXd::NullaryExpr(size, [&] { return uniform(random); }));
    };
    StepConstraints constraints;
    constraints.matrix = Eigen::MatrixXd::NullaryExpr(m, n, [&] { return uniform(random); });
    constraints.bounds = draw(m);
    constraints.lower = -draw(n).cwiseAbs(), constraints.upper = draw(n).cwiseAbs();
    const BypassPlane plane = bypass_plane(draw(n), draw(n), draw(n));
    const auto projected = project(constraints, plane, 0.1);
    ASSERT_EQ(static_cast<Eigen::Index>(projected.size()), m + 2 * n);
    const Vector2d du(uniform(random), uniform(random));
    const VectorXd dq = plane.lift(du);  // Lahouar 2006, eq. 13
    for (const ProjectedConstraint& constraint : projected) {
      const Eigen::Index i = constraint.source;
      const double full = i < m       ? constraints.bounds[i] - constraints.matrix.row(i).dot(dq)
                          : i < m + n ? constraints.upper[i - m] - dq[i - m]
                                      : dq[i - m - n] - constraints.lower[i - m - n];
      EXPECT_NEAR(constraint.direction.norm(), 1.0, 1e-12);
      EXPECT_EQ(full >= 0.0, constraint.bound - constraint.direction.dot(du) >= 0.0);  // Lahouar 2006, eq. 18
    }
  }
}

std::vector<ProjectedConstraint> random_constraints(std::mt19937_64& random, int count, double nearest) {
  std::uniform_real_distribution<double> angle(-std::numbers::pi, std::numbers::pi), bound(nearest, 0.3);
  std::vector<ProjectedConstraint> projected;
  for (int i = 0; i < count; ++i) {
    const double a = angle(random);
    projected.push_back({Vector2d(std::cos(a), std::sin(a)), bound(random), i, true});
  }
  return projected;
}

/// The farthest feasible point of the line along S among all its crossings with the other lines and the disc.
std::optional<double> by_enumeration(const std::vector<ProjectedConstraint>& projected, int followed,
                                     double max_step) {
  const ProjectedConstraint& line = projected[static_cast<std::size_t>(followed)];
  const Vector2d S(-line.direction[1], line.direction[0]);
  const double offset = std::min(line.bound, max_step / std::sqrt(2.0));
  const Vector2d foot = offset * line.direction;
  std::vector<double> places;
  if (std::abs(offset) <= max_step) {
    places = {std::sqrt(max_step * max_step - offset * offset),
              -std::sqrt(max_step * max_step - offset * offset)};
  }
  for (const ProjectedConstraint& constraint : projected) {
    const double slope = constraint.direction.dot(S);
    if (std::abs(slope) > 1e-12)
      places.push_back((constraint.bound - constraint.direction.dot(foot)) / slope);
  }
  std::optional<double> best;
  for (const double place : places) {
    const Vector2d du = foot + place * S;
    bool is_feasible = du.norm() <= max_step + 1e-9;
    for (std::size_t i = 0; i < projected.size(); ++i) {
      is_feasible = is_feasible && (static_cast<int>(i) == followed ||
                                    projected[i].direction.dot(du) <= projected[i].bound + 1e-9);
    }
    if (is_feasible && (!best || place > *best)) best = place;
  }
  return best;
}

TEST(Vertex, IsTheFarthestFeasiblePointOfTheLine) {
  std::mt19937_64 random(3);
  int found = 0, none = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const auto projected = random_constraints(random, 1 + static_cast<int>(random() % 8), -0.1);
    const int followed = static_cast<int>(random() % projected.size());
    const Vertex vertex = vertex_on(projected, followed, 0.2);
    const auto expected = by_enumeration(projected, followed, 0.2);
    ASSERT_EQ(vertex.exists, expected.has_value()) << trial;
    ++(vertex.exists ? found : none);
    if (!vertex.exists) continue;
    ASSERT_NEAR(vertex.advance, *expected, 1e-8) << trial;
    ASSERT_LE(vertex.du.norm(), 0.2 + 1e-9);
    for (const ProjectedConstraint& constraint : projected)
      ASSERT_LE(constraint.direction.dot(vertex.du), constraint.bound + 1e-9);
  }
  EXPECT_GT(found, 2000);
  EXPECT_GT(none, 200);
}

TEST(Vertex, NamesTheConstraintThatEndsTheWay) {
  // A wall ahead (+x), followed upwards (S = +y); a ceiling at y = 0.05.
  const std::vector<ProjectedConstraint> projected = {{Vector2d(1, 0), 0.01, 0, true},
                                                      {Vector2d(0, 1), 0.05, 1, true}};
  const Vertex vertex = vertex_on(projected, 0, 0.1);
  EXPECT_EQ(vertex.blocking, 1);
  EXPECT_NEAR((vertex.du - Vector2d(0.01, 0.05)).norm(), 0.0, 1e-12);
  EXPECT_EQ(vertex_on({projected[0]}, 0, 0.1).blocking, -1);
  EXPECT_NEAR(vertex_on({projected[0]}, 0, 0.1).du.norm(), 0.1, 1e-12);
}

TEST(BoundaryStep, SwitchesToTheConstraintThatBlocks) {
  // Fig. 10: in the corner of a wall and a ceiling the vertex is null; the ceiling is followed backwards.
  const std::vector<ProjectedConstraint> projected = {{Vector2d(1, 0), 0.0, 0, true},
                                                      {Vector2d(0, 1), 0.0, 1, true}};
  const BoundaryStep step = boundary_step(projected, 0, 0.1);
  EXPECT_FALSE(step.is_null);
  EXPECT_EQ(step.followed, 1);
  EXPECT_EQ(step.switches, 1);
  EXPECT_NEAR((step.vertex.du - Vector2d(-0.1, 0.0)).norm(), 0.0, 1e-12);
}

TEST(BoundaryStep, AClosedCellHasNoWay) {
  const std::vector<ProjectedConstraint> projected = {{Vector2d(1, 0), 0.0, 0, true},
                                                      {Vector2d(0, 1), 0.0, 1, true},
                                                      {Vector2d(-1, 0), 0.0, 2, true},
                                                      {Vector2d(0, -1), 0.0, 3, true}};
  EXPECT_TRUE(boundary_step(projected, 0, 0.1).is_null);
}

TEST(BoundaryStep, NeverBreaksAConstraintThatDoesNotDemandSeparation) {
  std::mt19937_64 random(4);
  for (int trial = 0; trial < 5000; ++trial) {
    const auto projected = random_constraints(random, 2 + static_cast<int>(random() % 10), -0.02);
    const BoundaryStep step = boundary_step(projected, 0, 0.1);
    if (step.is_null) continue;
    for (const ProjectedConstraint& constraint : projected) {
      ASSERT_LE(constraint.direction.dot(step.vertex.du),
                (step.relaxed ? std::max(constraint.bound, 0.0) : constraint.bound) + 1e-9);
    }
  }
}

TEST(Followed, FirstIsTheActiveConstraintMostAlongTheGoal) {
  const std::vector<ProjectedConstraint> projected = {{Vector2d(1, 0), 0.1, 0, true},
                                                      {Vector2d(0.6, 0.8), 0.0, 1, true},
                                                      {Vector2d(0.8, 0.6), 0.0, 2, true},
                                                      {Vector2d(0.9, 0.1), 0.0, 3, false}};
  EXPECT_EQ(first_followed(projected, Eigen::Vector4d(0.0, 1.0, 2.0, 1.0)), 2);
  EXPECT_EQ(first_followed(projected, Eigen::Vector4d::Zero()),
            0);  // none active: of all that can be followed
  EXPECT_EQ(first_followed({}, Eigen::VectorXd(0)), -1);
}

TEST(Followed, ThenTheConstraintMostLikeTheLastAndTheNearerOfEquals) {
  const std::vector<ProjectedConstraint> projected = {{Vector2d(0, 1), 0.0, 0, true},
                                                      {Vector2d(1, 0), 0.2, 1, true},
                                                      {Vector2d(1, 0), 0.1, 2, true},
                                                      {Vector2d(1, 0), 0.0, 3, false}};
  EXPECT_EQ(tracked(projected, Vector2d(0.8, 0.6)), 2);
  EXPECT_EQ(tracked(projected, Vector2d(0.0, 1.0)), 0);
}

}  // namespace boundary_following_test
}  // namespace clearway
