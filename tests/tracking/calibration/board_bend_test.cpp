#include "tracking/calibration/board_bend.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace clearway {
namespace board_bend_test {

BoardBend drawn_bend() {
  BoardBend bend;
  bend.board_from_plane = Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, -0.5, 1.0).normalized());
  bend.board_from_plane.translation() << 0.03, -0.02, 0.01;
  bend.curvatures << 0.8, -0.3, 0.5;
  bend.stretch = 0.02;
  return bend;
}

/// Paper on a cylinder: arcs along the bent way, straight lines across it, whichever way that is.
TEST(BoardBend, board_bent_about_one_axis_lies_on_its_cylinder) {
  constexpr double radius = 1.2;
  for (const double way : {0.0, 0.4, 1.3, 2.5}) {
    BoardBend bend;
    const Eigen::Vector2d along(std::cos(way), std::sin(way)), across(-along.y(), along.x());
    bend.curvatures << along.x() * along.x(), along.x() * along.y(), along.y() * along.y();
    bend.curvatures /= radius;
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.12, 0.05), Eigen::Vector2d(-0.1, 0.1)}) {
      const double angle = along.dot(p) / radius;
      Eigen::Vector3d exact;
      exact << radius * std::sin(angle) * along + across.dot(p) * across, radius * (1.0 - std::cos(angle));
      EXPECT_LT((bend.bent({p.x(), p.y(), 0.0}) - exact).norm(), 2e-5) << way;
    }
  }
}

TEST(BoardBend, derivatives_equal_their_numeric_twins_and_no_bend_moves_nothing) {
  const BoardBend bend = drawn_bend();
  const Eigen::Vector3d point(0.09, 0.11, 0.002);
  constexpr double step = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(i);
    const Eigen::Vector3d by = (bend.bent(point + shift) - bend.bent(point - shift)) / (2.0 * step);
    EXPECT_LT((by - bend.by_point(point).col(i)).norm(), 1e-8) << i;
    BoardBend more = bend, less = bend;
    more.curvatures += shift;
    less.curvatures -= shift;
    const Eigen::Vector3d by_bend = (more.bent(point) - less.bent(point)) / (2.0 * step);
    EXPECT_LT((by_bend - bend.by_curvatures(point).col(i)).norm(), 1e-8) << i;
  }
  BoardBend longer = bend, shorter = bend;
  longer.stretch += step;
  shorter.stretch -= step;
  const Eigen::Vector3d by_stretch = (longer.bent(point) - shorter.bent(point)) / (2.0 * step);
  EXPECT_LT((by_stretch - bend.by_stretch(point)).norm(), 1e-8);
  const BoardBend flat{bend.board_from_plane};
  EXPECT_EQ(flat.bent(point), point);
  EXPECT_TRUE(flat.by_point(point).isIdentity(1e-12));
}

TEST(BoardBend, stretched_print_is_longer_along_one_side_and_shorter_along_the_other) {
  BoardBend bend;
  bend.stretch = 0.01;
  EXPECT_LT((bend.bent({0.2, 0.1, 0.0}) - Eigen::Vector3d(0.201, 0.0995, 0.0)).norm(), 1e-12);
}

}  // namespace board_bend_test
}  // namespace clearway
