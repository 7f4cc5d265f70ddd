#include "planning/routes/route_guide.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace route_guide_test {

using Eigen::Vector2d;

/// A sphere of 8 cm that slides in x and y, before a wall along y with a gap in it.
struct Gap {
  Robot robot = sphere_that_slides();
  ConfigurationSpace space;
  PathCost cost{robot};
  EndEffector hand = find_end_effector(space);

  Gap(double low, double high)
      : space(robot,
              VoxelScene{voxel,
                         {box_of(0.5, -1.0, -0.2, 0.54, low, 0.2), box_of(0.5, high, -0.2, 0.54, 1.0, 0.2)},
                         {},
                         {}}
                  .snapshot(),
              Policies{.parts = {}, .other = Policy::not_occupied, .critical_by_default = false}) {}

  static constexpr double voxel = 0.02;

  static Robot sphere_that_slides() {
    Robot robot = load_robot("point");
    robot.bodies[0].shape = Shape::sphere(0.08);
    robot.joints[1].lower = -0.8, robot.joints[1].upper = 0.8;  // not round the wall
    return robot;
  }
  EndEffectorRoute route() const {
    return find_end_effector_route({space, cost, Vector2d(0.3, 0.0), Vector2d(0.74, 0.0), 1}, hand);
  }
};

double longest_step(const EndEffectorRoute& route) {
  double longest = 0.0;
  for (std::size_t i = 2; i + 1 < route.points.size(); ++i)
    longest = std::max(longest, (route.points[i] - route.points[i - 1]).norm());
  return longest;
}

TEST(EndEffectorRoute, LooksAtCoarseCellsAndForAGapThatTheyMissAtFineOnes) {
  int coarse = 0, fine = 0;
  for (int shift = 0; shift < 8; ++shift) {
    const double low = -0.1 + Gap::voxel * shift;
    const Gap gap(low, low + 0.22);
    const EndEffectorRoute route = gap.route();
    ASSERT_FALSE(route.points.empty()) << shift;
    // A cell's diagonal: of 2 voxels, or of 4.
    (longest_step(route) < 2.0 * std::sqrt(3.0) * Gap::voxel + 1e-9 ? fine : coarse)++;
    for (std::size_t i = 1; i + 1 < route.points.size(); ++i)
      EXPECT_GE(gap.hand.blocked(gap.space).clearance(route.points[i]), gap.hand.inner_radius);
  }
  EXPECT_GT(coarse, 0);
  EXPECT_GT(fine, 0);
}

TEST(EndEffectorRoute, IsEmptyWhereTheGapIsNarrowerThanTheHand) {
  for (const double wide : {0.0, 0.14}) EXPECT_TRUE(Gap(-0.5 * wide, 0.5 * wide).route().points.empty());
}

}  // namespace route_guide_test
}  // namespace clearway
