#include "planning/plan_pick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "mapping/maps/map_difference.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/can_on_table.hpp"

namespace clearway {
namespace plan_pick_test {

using can_on_table::anywhere, can_on_table::can, can_on_table::edge, can_on_table::home, can_on_table::table,
    can_on_table::top;

class PlanPick : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    space_ = new ConfigurationSpace(load_robot("arm6"), table().snapshot(), anywhere(), {.padding = 0.001});
    plan_ =
        new Plan(plan_pick({.space = *space_, .start = home, .goals = {}, .survey = std::nullopt}, can()));
  }
  static void TearDownTestSuite() {
    delete plan_;
    delete space_;
  }

  /// The verdict of the check on a plan and a pick that were changed.
  static PathVerdict verdict(
      const std::function<void(Plan&)>& change_plan,
      const std::function<void(Pick&)>& change_pick = [](Pick&) {}) {
    Plan plan = *plan_;
    Pick pick = can();
    change_plan(plan);
    change_pick(pick);
    return check_pick(pick_of(plan, pick, space_->robot(), space_->map()), plan.policies, plan.padding);
  }

  static ConfigurationSpace* space_;
  static Plan* plan_;
};
ConfigurationSpace* PlanPick::space_ = nullptr;
Plan* PlanPick::plan_ = nullptr;

TEST_F(PlanPick, CarriesACanOverAWallAndPutsItDown) {
  const Plan& plan = *plan_;
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  ASSERT_EQ(plan.legs.size(), 6U);
  EXPECT_EQ(plan.goals.size(), 6U);
  EXPECT_EQ(plan.waypoints().front(), home);
  const Robot& robot = space_->robot();
  const auto tip = [&](std::size_t leg) { return tip_pose(robot, plan.legs[leg].waypoints.back()); };
  const Eigen::Isometry3d grasp = can().map_from_object * can().object_from_tip;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  EXPECT_NEAR((tip(0).translation() - grasp.translation() - 0.1 * up).norm(), 0.0, 1e-5);
  EXPECT_NEAR((tip(1).translation() - grasp.translation()).norm(), 0.0, 1e-5);
  EXPECT_NEAR((tip(2).translation() - grasp.translation() - 0.1 * up).norm(), 0.0, 1e-5);
  const Eigen::Vector3d moved = can().map_from_place.translation() - can().map_from_object.translation();
  EXPECT_NEAR((tip(4).translation() - grasp.translation() - moved).norm(), 0.0, 1e-5);
  EXPECT_EQ(plan.legs.front().waypoints.front(), home);
  for (std::size_t leg = 1; leg < 6; ++leg)
    EXPECT_EQ(plan.legs[leg].waypoints.front(), plan.legs[leg - 1].waypoints.back());
  ASSERT_EQ(plan.loads.size(), 1U);
  EXPECT_EQ(plan.loads.front().legs, (std::vector<int>{2, 3, 4}));
  // The carried can never meets the wall: its voxels are met by none of many places on the way.
  const Robot loaded = with_load(robot, plan.loads.front().load);
  for (std::size_t leg = 2; leg < 5; ++leg)
    for (std::size_t i = 0; i + 1 < plan.legs[leg].waypoints.size(); ++i)
      for (int k = 0; k <= 10; ++k) {
        const Configuration q = plan.legs[leg].waypoints[i] +
                                k / 10.0 * (plan.legs[leg].waypoints[i + 1] - plan.legs[leg].waypoints[i]);
        const Eigen::Isometry3d pose = forward_kinematics(loaded, q).back();
        for (double x = 0.27; x < 0.7; x += edge)
          for (double y : {-0.01, 0.01})
            for (double z = 0.11; z < 0.26; z += edge)
              ASSERT_GT(distance_to_cube(can().object.shape, pose, {x, y, z}, edge).lower, 0.0);
        ASSERT_GT(can().object.shape.bounds(pose).min().z(), top - 0.001);
      }
}

/// The start is asked for by touching voxels of its own: nothing of the map is changed for it.
TEST_F(PlanPick, LeavesTheMapAsItIs) {
  EXPECT_FALSE(difference(space_->map(), table().snapshot()).any());
  EXPECT_EQ(space_->map().state({0.43, 0.17, 0.15}), VoxelState::occupied);
}

TEST_F(PlanPick, IsTheSameAgain) {
  const Plan again = plan_pick({.space = *space_, .start = home, .goals = {}, .survey = std::nullopt}, can());
  ASSERT_EQ(again.waypoints().size(), plan_->waypoints().size());
  for (std::size_t i = 0; i < again.waypoints().size(); ++i)
    EXPECT_EQ(again.waypoints()[i], plan_->waypoints()[i]);
}

TEST_F(PlanPick, LeavesToAGoal) {
  const Plan plan =
      plan_pick({.space = *space_, .start = home, .goals = {home}, .survey = std::nullopt}, can());
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  EXPECT_EQ(plan.legs.size(), 7U);
  EXPECT_EQ(plan.waypoints().back(), home);
}

TEST_F(PlanPick, SaysWhatIsInTheWay) {
  Pick far = can();
  far.map_from_object.translation().x() = 3.0;
  const auto plan = [&](const Pick& pick, double time_limit = 1.0) {
    return plan_pick(
        {.space = *space_, .start = home, .goals = {}, .time_limit = time_limit, .survey = std::nullopt},
        pick);
  };
  const Robot& robot = space_->robot();
  const std::string tip = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
  const Plan out_of_reach = plan(far);
  EXPECT_NE(
      out_of_reach.explanation().find(
          "no configuration within the limits was found that puts the tip, link '" + tip + "', at the grasp"),
      std::string::npos)
      << out_of_reach.explanation();
  EXPECT_FALSE(out_of_reach.is_proved());
  Pick in_the_wall = can();
  in_the_wall.map_from_place.translation().y() = 0.0;
  const Plan refused = plan(in_the_wall, 3.0);
  EXPECT_EQ(refused.legs.size(), 4U);
  EXPECT_NE(refused.explanation().find("cannot be put down"), std::string::npos) << refused.explanation();
  Pick sunken = can();
  sunken.map_from_object.translation().z() -= 0.03;  // the table is no part of the can
  EXPECT_FALSE(plan(sunken).is_proved());
  Pick unsound = can();
  unsound.lift = 0.01;
  EXPECT_THROW(plan(unsound), std::invalid_argument);
  for (const double contact : {std::nan(""), -0.05}) {
    Pick no_length = can();
    no_length.contact = contact;
    EXPECT_THROW(plan(no_length), std::invalid_argument) << contact;
  }
}

/// Not that the object cannot be taken: with more time it is.
TEST_F(PlanPick, SaysThatItsTimeLimitEndedTheSearch) {
  const auto plan = [&](double time_limit) {
    return plan_pick(
        {.space = *space_, .start = home, .goals = {}, .time_limit = time_limit, .survey = std::nullopt},
        can());
  };
  const Plan at_once = plan(1e-6);
  EXPECT_NE(at_once.explanation().find("The object cannot be taken within the time limit of 1e-06 s "
                                       "(--time-limit gives more): so far, no configuration"),
            std::string::npos)
      << at_once.explanation();
  for (double limit = 1e-3; limit < 1.0; limit *= 1.5) {  // wherever it ends
    const Plan cut = plan(limit);
    if (cut.status() == PlanStatus::solved) continue;
    EXPECT_EQ(cut.status(), PlanStatus::timed_out) << cut.explanation();
    EXPECT_NE(cut.explanation().find(" s (--time-limit gives more)"), std::string::npos) << cut.explanation();
  }
}

TEST_F(PlanPick, RefusesAnObjectOnALinkThatMovesAgainstTheTip) {
  const Robot& robot = space_->robot();
  const Link& tip = robot.links[static_cast<std::size_t>(robot.tip_link)];
  for (const Link& link : robot.links) {
    const LinkPoses here = forward_kinematics(robot, home),
                    there = forward_kinematics(robot, home + Configuration::Constant(6, 0.1));
    const auto index = static_cast<std::size_t>(&link - robot.links.data());
    const auto seen = [&](const LinkPoses& poses) {
      return Eigen::Isometry3d(poses[static_cast<std::size_t>(robot.tip_link)].inverse() * poses[index]);
    };
    Pick pick = can();
    pick.object.link = link.name;
    if (seen(here).isApprox(seen(there), 1e-9)) {
      EXPECT_NO_THROW(require_rigid_hold(robot, pick)) << link.name;
      continue;
    }
    try {
      plan_pick({.space = *space_, .start = home, .goals = {}, .survey = std::nullopt}, pick);
      FAIL() << link.name;
    } catch (const std::invalid_argument& refusal) {
      const std::string text = refusal.what();
      EXPECT_NE(text.find("moves link '" + link.name + "'"), std::string::npos) << text;
      EXPECT_NE(text.find("the tip, link '" + tip.name + "'"), std::string::npos) << text;
    }
  }
}

/// Whatever a plan loosens the check refuses: it asks the pick as it is stated.
TEST_F(PlanPick, IsRefusedWhereItLoosensThePick) {
  const auto nothing = [](Plan&) {};
  ASSERT_TRUE(verdict(nothing).valid) << verdict(nothing).first_contact;
  const auto refuses = [&](
                           const std::string& words, const std::function<void(Plan&)>& plan,
                           const std::function<void(Pick&)>& pick = [](Pick&) {}) {
    const PathVerdict found = verdict(plan, pick);
    EXPECT_FALSE(found.valid) << words;
    EXPECT_NE(found.first_contact.find(words), std::string::npos) << found.first_contact;
    EXPECT_EQ(found.min_clearance, 0.0);
  };
  refuses("the load rides",
          [](Plan& plan) { plan.loads.front().load.link_from_load.translation().z() -= 0.05; });
  refuses("pose is not finite", [](Plan& plan) {
    plan.loads.front().load.link_from_load.translation().z() = std::numeric_limits<double>::quiet_NaN();
  });
  refuses("solved legs", [](Plan& plan) { plan.legs.pop_back(); });
  refuses("starts elsewhere", [](Plan& plan) { plan.legs[3].waypoints.front()[0] += 1e-9; });
  refuses("no configuration",
          [](Plan& plan) { plan.legs[3].waypoints[1][0] = std::numeric_limits<double>::quiet_NaN(); });
  refuses("from its place", nothing, [](Pick& pick) { pick.map_from_place.translation().x() += 0.001; });
  refuses("from the grasp", nothing, [](Pick& pick) { pick.map_from_object.translation().z() += 0.01; });
  refuses("reach", nothing, [](Pick& pick) { pick.approach.z() = -0.08; });
  refuses("retreat", [](Plan& plan) { plan.legs[5].waypoints.pop_back(); });
  refuses("off its straight way", [](Plan& plan) { plan.legs[2].waypoints[2][0] += 0.01; });
}

/// A can that is larger, or a table that is higher, than the planner knew.
TEST_F(PlanPick, IsRefusedWhereAStraightWayBowsBetweenItsWaypoints) {
  for (const std::size_t leg : {1U, 2U, 4U, 5U}) {
    const PathVerdict bowed = verdict([&](Plan& plan) {
      std::vector<Configuration>& path = plan.legs[leg].waypoints;
      ASSERT_GT(path.size(), 2U);
      path.erase(path.begin() + 1, path.end() - 1);
    });
    EXPECT_FALSE(bowed.valid) << leg;
    EXPECT_NE(bowed.first_contact.find("straight"), std::string::npos) << bowed.first_contact;
  }
  EXPECT_TRUE(verdict([](Plan&) {}).valid);
}

TEST_F(PlanPick, IsRefusedWhereALegBeginsElsewhere) {
  const PathVerdict apart = verdict([](Plan& plan) {
    std::vector<Configuration>& carry = plan.legs[3].waypoints;
    carry.front()[0] += 1e-6;
  });
  EXPECT_FALSE(apart.valid);
  EXPECT_NE(apart.first_contact.find("leg 4 starts elsewhere"), std::string::npos) << apart.first_contact;
}

TEST_F(PlanPick, IsRefusedInAnotherWorld) {
  const auto nothing = [](Plan&) {};
  const PathVerdict wide =
      verdict(nothing, [](Pick& pick) { pick.object.shape = Shape::cylinder(0.2, 0.12); });
  EXPECT_FALSE(wide.valid);
  const auto in = [&](const Eigen::AlignedBox3d& more) {
    VoxelScene scene = table();
    scene.occupied.push_back(more);
    const Snapshot map = scene.snapshot();
    const Pick pick = can();
    return check_pick(pick_of(*plan_, pick, space_->robot(), map), plan_->policies, plan_->padding);
  };
  ASSERT_TRUE(in(box_of(5.0, 5.0, 5.0, 5.1, 5.1, 5.1)).valid);
  // One voxel over the layer of the place, which the layer's own voxels do not excuse.
  const PathVerdict higher = in(box_of(0.42, -0.22, top + edge, 0.44, -0.18, top + 2 * edge));
  EXPECT_FALSE(higher.valid);
  EXPECT_NE(higher.first_contact.find("leg "), std::string::npos);
  // Above the can at its first place: lift and hand.
  EXPECT_FALSE(in(box_of(0.40, 0.12, 0.34, 0.44, 0.2, 0.38)).valid);
}

/// From bodies that joints move to the voxels of boxes, each asked; at most the check's cap.
double distance_to_voxels(const Robot& robot, const Configuration& q,
                          const std::vector<Eigen::AlignedBox3d>& boxes) {
  const LinkPoses poses = forward_kinematics(robot, q), others = forward_kinematics(robot, home);
  double least = 0.2;
  for (const Body& body : robot.bodies) {
    const auto link = static_cast<std::size_t>(body.link);
    if (poses[link].isApprox(others[link], 1e-12)) continue;
    for (const Eigen::AlignedBox3d& box : boxes)
      for (double x = box.min().x() + edge / 2; x < box.max().x(); x += edge)
        for (double y = box.min().y() + edge / 2; y < box.max().y(); y += edge)
          for (double z = box.min().z() + edge / 2; z < box.max().z(); z += edge)
            least = std::min(
                least,
                distance_to_cube(body.shape, poses[link] * body.link_from_shape, {x, y, z}, edge).lower);
  }
  return least;
}

/// The clearance of a waypoint that two legs share is the lesser of both.
TEST_F(PlanPick, NotesOfAWaypointOfTwoLegsTheLesserClearance) {
  const PathVerdict found = verdict([](Plan&) {});
  ASSERT_TRUE(found.valid) << found.first_contact;
  ASSERT_EQ(found.clearance.size(), plan_->waypoints().size());
  // Voxels of the scene, as boxes of them.
  const Eigen::AlignedBox3d slab = box_of(0.24, -0.46, 0.04, 0.7, 0.46, top),
                            wall = box_of(0.26, -0.02, top, 0.7, 0.02, 0.26),
                            stood = box_of(0.38, 0.12, top, 0.46, 0.2, 0.24);
  const std::size_t before = plan_->legs[0].waypoints.size() - 1;  // where the object still is in the map
  const double beside_it =
      distance_to_voxels(space_->robot(), plan_->waypoints()[before], {slab, wall, stood});
  EXPECT_LT(beside_it, distance_to_voxels(space_->robot(), plan_->waypoints()[before], {slab, wall}) - 0.01);
  EXPECT_NEAR(found.clearance[before], beside_it, 1e-4);
  // Where it is taken, the load is 10 mm beside the support's voxels that are none of the layer.
  const std::size_t taken = before + plan_->legs[1].waypoints.size() - 1;
  EXPECT_GT(distance_to_voxels(space_->robot(), plan_->waypoints()[taken], {slab, wall}), 0.011);
  EXPECT_NEAR(found.clearance[taken], 0.01, 1e-4);
}

/// On the lift the load's clearance is that from every voxel once its contact is over, at every waypoint's
/// own place in the list; before, that from all but the layer.
TEST_F(PlanPick, NotesTheClearanceOfEachWaypointOfTheLift) {
  const PathVerdict found = verdict([](Plan&) {});
  ASSERT_TRUE(found.valid) << found.first_contact;
  const std::vector<Configuration>& lift = plan_->legs[2].waypoints;
  const Robot loaded = with_load(space_->robot(), plan_->loads.front().load);
  const Eigen::AlignedBox3d slab = box_of(0.24, -0.46, 0.04, 0.7, 0.46, top),
                            wall = box_of(0.26, -0.02, top, 0.7, 0.02, 0.26);
  const std::size_t taken = plan_->legs[0].waypoints.size() + plan_->legs[1].waypoints.size() - 2;
  const double contact = contact_length(can(), edge, plan_->padding);
  std::size_t in_contact = 0;
  for (std::size_t i = 1; i < lift.size(); ++i) {
    const double from_all = distance_to_voxels(loaded, lift[i], {slab, wall});
    if (from_all < contact - 1e-6) {
      EXPECT_GT(found.clearance[taken + i], from_all + 1e-4) << i;
      ++in_contact;
    } else {
      EXPECT_NEAR(found.clearance[taken + i], from_all, 1e-4) << i;
    }
  }
  EXPECT_GT(in_contact, 2U);
}

}  // namespace plan_pick_test
}  // namespace clearway
