// Robots that keep start and goal apart by themselves, and such that do not.
#include "planning/advice/without_map.hpp"

#include <gtest/gtest.h>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace without_map_test {

/// A hand that slides in the plane on both sides of a beam along y, 6 m long, which belongs to its base.
struct Gantry {
  explicit Gantry(const std::string& limit)
      : robot(load_robot(folder.write(
            "gantry.urdf",
            "<robot name='gantry'><link name='base'><collision><geometry><box size='0.2 6 0.2'/></geometry>"
            "</collision></link><link name='slide'/><link name='hand'><collision><geometry><sphere "
            "radius='0.1'/></geometry></collision></link>" +
                joint("x", "base", "slide", "1 0 0", limit) + joint("y", "slide", "hand", "0 1 0", limit) +
                "</robot>"))) {}

  static std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                           const std::string& axis, const std::string& limit) {
    return "<joint name='" + name + "' type='prismatic'><parent link='" + parent + "'/><child link='" +
           child + "'/><axis xyz='" + axis + "'/><limit lower='-" + limit + "' upper='" + limit +
           "' effort='10' velocity='1'/></joint>";
  }

  /// From one side of the beam to the other in the map of a room whose walls are `reach` from the middle.
  bool is_without_path(double reach) const {
    FreeSpaceMap room({.resolution = 0.1});
    Scan walls;
    walls.has_hits_only = true;
    for (double along = -reach; along <= reach; along += 0.1)
      for (const double side : {-reach, reach}) {
        walls.points.emplace_back(static_cast<float>(along), static_cast<float>(side), 0.0F);
        walls.points.emplace_back(static_cast<float>(side), static_cast<float>(along), 0.0F);
      }
    room.insert(walls);
    const ConfigurationSpace space(robot, room.snapshot(),
                                   {.other = Policy::not_occupied, .critical_by_default = false});
    const PathCost cost(robot);
    return is_without_path_in_empty_map(
        {space, cost, Eigen::Vector2d(-0.5, 0.0), Eigen::Vector2d(0.5, 0.0), 1});
  }

  TemporaryFolder folder;
  Robot robot;
};

TEST(WithoutMap, ABodyOfTheRobotKeepsStartAndGoalApartWhereLimitsAllowNoWayRoundIt) {
  EXPECT_TRUE(Gantry("2.5").is_without_path(5.0));
  EXPECT_FALSE(Gantry("4").is_without_path(5.0));
}

/// A sliding joint is sampled as far as the map goes, and so it is without what is in that.
TEST(WithoutMap, TheWayRoundMayBeFarFromStartAndGoal) { EXPECT_FALSE(Gantry("50").is_without_path(5.0)); }

}  // namespace without_map_test
}  // namespace clearway
