#include "planning/picks/straight_legs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "planning/picks/straight_motion.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/can_on_table.hpp"

namespace clearway {
namespace straight_legs_test {

using can_on_table::anywhere, can_on_table::can, can_on_table::home, can_on_table::table;
using Path = std::vector<Configuration>;

class StraightLegsOfACan : public ::testing::Test {
 protected:
  Eigen::Vector3d tip(const Configuration& q) const { return tip_pose(space_.robot(), q).translation(); }

  Path at(const Eigen::Isometry3d& map_from_object) const {
    return goal_configurations(space_.robot(), map_from_object * pick_.object_from_tip, home);
  }

  /// The first grasp whose legs are free.
  Taking taking() {
    Farthest farthest;
    for (const Configuration& q : at(pick_.map_from_object))
      if (const auto found = legs_.take({q, 0.0}, farthest)) return *found;
    throw std::runtime_error(farthest.why);
  }

  /// Each waypoint lies between the ends, and the tip does not turn.
  void expect_straight(const Path& path, const Eigen::Vector3d& way) const {
    EXPECT_LT((tip(path.back()) - tip(path.front()) - way).norm(), 1e-5);
    for (const Configuration& q : path) {
      const Eigen::Vector3d gone = tip(q) - tip(path.front());
      EXPECT_LT(gone.cross(way.normalized()).norm(), 1e-5);
      const Eigen::Matrix3d turn =
          tip_pose(space_.robot(), q).linear() * tip_pose(space_.robot(), path.front()).linear().transpose();
      EXPECT_TRUE(turn.isIdentity(1e-5));
    }
  }

  const Pick pick_ = can();
  const ConfigurationSpace space_{load_robot("arm6"), table().snapshot(), anywhere(),
                                  SpaceOptions{.padding = 0.001}};
  PickScene scene_{space_, pick_, {}};
  StraightLegs legs_{scene_, space_, pick_};
};

TEST_F(StraightLegsOfACan, LeadToTheGraspAndUpFromIt) {
  const Taking taken = taking();
  EXPECT_EQ(taken.reach.back(), taken.grasp.q);
  EXPECT_EQ(taken.lift.front(), taken.grasp.q);
  expect_straight(taken.reach, pick_.approach);
  expect_straight(taken.lift, pick_.lift * Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(is_path_free(scene_.grasping(), taken.reach));
}

TEST_F(StraightLegsOfACan, LeadDownToThePlaceAndAwayFromIt) {
  const Taking taken = taking();
  Farthest farthest;
  std::optional<Putting> put;
  for (const Configuration& q : at(pick_.map_from_place))
    if ((put = legs_.put(taken, q, farthest))) break;
  ASSERT_TRUE(put) << farthest.why;
  EXPECT_EQ(put->lower.back(), put->retreat.front());
  expect_straight(put->lower, -pick_.lift * Eigen::Vector3d::UnitZ());
  expect_straight(put->retreat, put->back);
  EXPECT_TRUE(is_path_free(scene_.releasing(), put->retreat));
}

TEST_F(StraightLegsOfACan, GoWithTheLoadAsFarAsIsFree) {
  const Configuration lifted = taking().lift.back();
  const Path down = legs_.way_with_load(lifted, -0.3 * Eigen::Vector3d::UnitZ());  // the table is nearer
  EXPECT_EQ(down.front(), lifted);
  EXPECT_GT(down.size(), 1U);
  EXPECT_LT(tip(lifted).z() - tip(down.back()).z(), pick_.lift + 1e-6);
  EXPECT_TRUE(is_path_free(scene_.carrying(), down));
}

TEST(StraightLegs, SayWhatTheyFailOf) {
  Pick pick = can();
  pick.lift = 3.0;  // beyond the arm's reach
  const ConfigurationSpace space(load_robot("arm6"), table().snapshot(), anywhere(), {.padding = 0.001});
  PickScene scene(space, pick, {});
  StraightLegs legs(scene, space, pick);
  Path grasps = goal_configurations(space.robot(), pick.map_from_object * pick.object_from_tip, home);
  ASSERT_FALSE(grasps.empty());
  const Configuration nowhere = Configuration::Zero(6);  // straight up, the tip is not at the can
  grasps.push_back(nowhere);
  // A grasp that fails sooner does not hide how far another one came, whichever comes first.
  for (int order = 0; order < 2; ++order) {
    Farthest farthest;
    for (const Configuration& q : grasps) EXPECT_FALSE(legs.take({q, 0.0}, farthest));
    EXPECT_EQ(farthest.step, 1);
    EXPECT_EQ(farthest.why,
              "no arm configuration at the grasp can go the straight ways of approach and lift");
    std::reverse(grasps.begin(), grasps.end());
  }
  Farthest farthest;
  farthest.fail(2, "the way");
  farthest.fail(1, "no grasp");
  farthest.fail(2, "another way");
  EXPECT_EQ(farthest.why, "the way");
}

}  // namespace straight_legs_test
}  // namespace clearway
