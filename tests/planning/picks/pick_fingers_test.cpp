// Picks by a hand whose fingers stand still, or close and open.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include "planning/check/check_pick.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "tests/worlds/can_on_table.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace pick_fingers_test {

using can_on_table::anywhere, can_on_table::edge, can_on_table::top;

/// A can on a table with a wall, and a gripper above it whose tip is the frame between its fingers.
class PickFingers : public ::testing::Test {
 protected:
  PickFingers() {
    for (std::size_t i = 0; i < robot_.links.size(); ++i)
      if (robot_.links[i].name == "tcp") robot_.tip_link = static_cast<int>(i);
    pick_.object.name = "can";
    pick_.object.link = "palm";
    pick_.object.touches = {"left", "right"};
    pick_.object.shape = Shape::cylinder(0.015, 0.1);
    pick_.map_from_object.translation() << 0.3, 0.2, top + 0.05;
    pick_.map_from_place.translation() << 0.4, -0.2, top + 0.05;
    pick_.margin = 0.01;
  }

  static Snapshot map() {
    return VoxelScene{
        edge,
        {box_of(0.1, -0.5, top - edge, 0.6, 0.5, top - 0.001),
         box_of(0.28, 0.18, top, 0.32, 0.22, top + 0.099), box_of(0.1, -0.02, top, 0.6, 0.02, top + 0.19)},
        {},
        {}}
        .snapshot();
  }
  static Configuration start(double grip) {
    return (Configuration(5) << -0.3, 0.0, 0.5, 0.4, grip).finished();
  }
  Plan plan_from(const Configuration& q, std::uint64_t seed) const {
    return plan_pick({.space = space(), .start = q, .goals = {}, .seed = seed, .survey = std::nullopt},
                     pick_);
  }
  const ConfigurationSpace& space() const {
    if (!space_) space_ = std::make_unique<ConfigurationSpace>(robot_, map(), anywhere(), options_);
    return *space_;
  }
  PathVerdict verdict(const Plan& plan) const {
    return check_pick(pick_of(plan, pick_, robot_, space().map()), plan.policies, plan.padding);
  }

  const worlds::UrdfRobot made_ = worlds::gripper();
  Robot robot_ = made_.robot();
  Pick pick_;
  SpaceOptions options_{.padding = 0.001};
  mutable std::unique_ptr<ConfigurationSpace> space_;
};

/// Fingers that no tip asks for stay as the start has them, and as they are while the can rides.
TEST_F(PickFingers, TheyStandStillAndWhoMovesThemIsRefused) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Plan plan = plan_from(start(0.012), seed);
    ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
    for (const PlanResult& leg : plan.legs)
      for (const Configuration& q : leg.waypoints) EXPECT_EQ(q[4], leg.waypoints.front()[4]) << seed;
    EXPECT_EQ(plan.waypoints().back()[4], 0.012);
    Plan opened = plan;
    std::vector<Configuration>& carry = opened.legs[3].waypoints;
    carry.insert(carry.begin() + 1, (carry[0] + carry[1]) / 2);
    EXPECT_TRUE(verdict(opened).valid);
    carry[1][4] += 0.004;
    EXPECT_FALSE(verdict(opened).valid) << seed;
    EXPECT_NE(verdict(opened).first_contact.find("carry has joint 'grip' not closed"), std::string::npos)
        << verdict(opened).first_contact;
  }
}

/// Open on the way there and back, closed round the can while it rides; they close and open at rest.
TEST_F(PickFingers, TheyCloseAtTheGraspAndOpenAtThePlace) {
  pick_.grip["grip"] = {0.03, 0.0};
  Plan plan = plan_from(start(0.012), 1);
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  const auto tip_of = [&](const Configuration& q) -> Eigen::Vector3d {
    return tip_pose(robot_, q).translation();
  };
  const Eigen::Vector3d grasp = pick_.map_from_object.translation(),
                        place = pick_.map_from_place.translation();
  const auto has_grip = [&](std::size_t leg, double first, double last) {
    const std::vector<Configuration>& path = plan.legs[leg].waypoints;
    return path.front()[4] == first && path.back()[4] == last;
  };
  EXPECT_TRUE(has_grip(0, 0.012, 0.03) && has_grip(1, 0.03, 0.0) && has_grip(2, 0.0, 0.0));
  EXPECT_TRUE(has_grip(3, 0.0, 0.0) && has_grip(4, 0.0, 0.0) && has_grip(5, 0.0, 0.03));
  give_motion(space(), plan);
  ASSERT_TRUE(plan.motion.has_value()) << plan.motion_caveat;
  const Motion& motion = plan.motion->motion;
  int closing = 0;
  for (std::size_t k = plan.motion->leg_ends[0]; k + 1 < motion.positions.size(); ++k) {
    const Configuration& q = motion.positions[k];
    if (std::abs(motion.positions[k + 1][4] - q[4]) < 1e-9) continue;
    ++closing;
    EXPECT_LT(std::min((tip_of(q) - grasp).norm(), (tip_of(q) - place).norm()), 1e-6) << k;
  }
  EXPECT_GT(closing, 10);
}

TEST_F(PickFingers, WhoClosesThemTooEarlyOrNotAtAllIsRefused) {
  pick_.grip["grip"] = {0.03, 0.0};
  const Plan plan = plan_from(start(0.012), 1);
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  const auto refusal = [&](const std::function<void(std::vector<PlanResult>&)>& change) {
    Plan changed = plan;
    change(changed.legs);
    const PathVerdict found = verdict(changed);
    return found.valid ? "valid" : found.first_contact;
  };
  EXPECT_EQ(refusal([](auto&) {}), "valid");
  const auto all = [](std::vector<PlanResult>& legs, std::size_t from, std::size_t to, double grip) {
    for (std::size_t leg = from; leg <= to; ++leg)
      for (Configuration& q : legs[leg].waypoints) q[4] = grip;
  };
  EXPECT_NE(
      refusal([&](auto& legs) { all(legs, 0, 5, 0.0); }).find("reach begins with joint 'grip' not open"),
      std::string::npos);
  EXPECT_NE(
      refusal([&](auto& legs) { all(legs, 0, 5, 0.03); }).find("reach ends with joint 'grip' not closed"),
      std::string::npos);
  EXPECT_NE(
      refusal([&](auto& legs) { all(legs, 5, 5, 0.0); }).find("retreat ends with joint 'grip' not open"),
      std::string::npos);
  const std::string moving = ": away from the object the hand is not open, or something else moves with it";
  EXPECT_NE(refusal([&](auto& legs) { legs[1].waypoints.end()[-2][4] = 0.02; }).find("reach" + moving),
            std::string::npos);
  EXPECT_NE(refusal([&](auto& legs) { legs[5].waypoints[1][4] = 0.02; }).find("retreat" + moving),
            std::string::npos);
  // The tip is where it was; the palm turns while the fingers close.
  EXPECT_NE(refusal([&](auto& legs) {
              Configuration turned = legs[1].waypoints.end()[-2];
              turned[3] += 0.01;
              legs[1].waypoints.insert(legs[1].waypoints.end() - 1, turned);
            }).find(moving),
            std::string::npos);
}

/// As someone edits it who knows where the check looks: closed hands that go away from the object and come
/// back, a hand that closes by steps too small to see, one that opens on the way and closes again.
TEST_F(PickFingers, WhoDrivesWithAClosedHandOrOpensItOnTheWayIsRefused) {
  for (const bool names_fingers : {true, false}) {  // those that it does not touch hold nothing
    space_.reset();
    pick_.object.touches =
        names_fingers ? std::vector<std::string>{"left", "right"} : std::vector<std::string>{};
    pick_.grip["grip"] = {0.03, 0.008};
    pick_.object.shape = Shape::cylinder(names_fingers ? 0.015 : 0.01, 0.1);
    const Plan plan = plan_from(start(0.012), 1);
    ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
    const auto is_refused = [&](const std::function<void(std::vector<PlanResult>&)>& change) {
      Plan changed = plan;
      change(changed.legs);
      const PathVerdict found = verdict(changed);
      return !found.valid;
    };
    EXPECT_TRUE(is_refused([](auto& legs) {  // away, closed, and back
      auto& path = legs[5].waypoints;
      Configuration away = path.back();
      away[4] = path.front()[4];
      path.insert(path.begin() + 1, {away, path.front()});
    })) << names_fingers;
    EXPECT_TRUE(is_refused([](auto& legs) {
      auto& path = legs[1].waypoints;
      Configuration away = path.front();
      away[4] = path.back()[4];
      path.insert(path.end(), {away, path.back()});
    })) << names_fingers;
    EXPECT_TRUE(is_refused([](auto& legs) {
      const auto path = legs[1].waypoints;
      legs[1].waypoints.clear();
      for (std::size_t i = 0; i + 1 < path.size(); ++i)
        for (int k = 0; k < 3000; ++k) {
          Configuration q = path[i] + k / 3000.0 * (path[i + 1] - path[i]);
          const double way = (static_cast<double>(i) + k / 3000.0) / static_cast<double>(path.size() - 1);
          q[4] = path.front()[4] + way * (path.back()[4] - path.front()[4]);
          legs[1].waypoints.push_back(q);
        }
      legs[1].waypoints.push_back(path.back());
    })) << names_fingers;
    for (const std::size_t leg : {2U, 3U, 4U})
      EXPECT_TRUE(is_refused([&](auto& legs) {
        auto& path = legs[leg].waypoints;
        Configuration opened = path.front();
        opened[4] = 0.03;
        path.insert(path.begin() + 1, {opened, path.front()});
      })) << names_fingers
          << leg;
  }
}

/// Between knots, too; of a motion whose hand is open at each knot of the arm's way.
TEST_F(PickFingers, AMotionIsLookedAtBetweenItsKnots) {
  pick_.grip["grip"] = {0.03, 0.0};
  Plan plan = plan_from(start(0.012), 1);
  give_motion(space(), plan);
  ASSERT_TRUE(plan.motion.has_value()) << plan.motion_caveat;
  const auto fault = [&] { return check_planned_motion(space(), plan, plan.policies).fault; };
  EXPECT_EQ(fault(), "");
  Motion& motion = plan.motion->motion;
  const std::size_t knot = plan.motion->leg_ends[0] + 3;
  ASSERT_EQ(motion.positions[knot][4], 0.03);
  motion.velocities[knot][4] = 1e-3;
  EXPECT_NE(fault(), "");
  motion.velocities[knot][4] = 0.0;
  std::size_t closing = knot;
  while (motion.positions[closing][4] > 0.015) ++closing;
  motion.positions[closing][3] += 1e-5;  // the palm turns
  EXPECT_NE(fault(), "");
}

/// Without a motion, edge by edge, the arm stands as well while the hand moves.
TEST_F(PickFingers, EdgesInTimeRestBeforeTheHandMoves) {
  pick_.grip["grip"] = {0.03, 0.0};
  const Plan plan = plan_from(start(0.012), 1);
  ASSERT_TRUE(plan.is_proved());
  const std::vector<Trajectory> legs = leg_trajectories(robot_, plan);
  for (const std::size_t leg : {1U, 5U}) {
    int moved = 0;
    for (std::size_t k = 0; k + 1 < legs[leg].points.size(); ++k) {
      const Configuration step = legs[leg].points[k + 1].position - legs[leg].points[k].position;
      if (step[4] == 0.0) continue;
      ++moved;
      EXPECT_EQ(step.head(4).lpNorm<Eigen::Infinity>(), 0.0) << leg << ' ' << k;
    }
    EXPECT_GT(moved, 3) << leg;
  }
}

/// A hand that no grip names stays as it was.
TEST_F(PickFingers, AHandWithoutAGripStays) {
  const Plan plan = plan_from(start(0.012), 1);
  ASSERT_TRUE(plan.is_proved());
  Plan closes = plan;
  for (Configuration& q : closes.legs[1].waypoints) q[4] += 0.004;
  closes.legs[0].waypoints.back()[4] += 0.004;
  closes.legs[1].waypoints.back() = plan.legs[1].waypoints.back();
  EXPECT_NE(verdict(closes).first_contact.find("reach begins with joint 'grip' not open"), std::string::npos)
      << verdict(closes).first_contact;
}

/// Behind a wall: fingers that hold nothing do not move either while the can rides.
TEST_F(PickFingers, WhateverTouchesIsPlannedAsItIsChecked) {
  pick_.object.touches = {};
  pick_.object.shape = Shape::cylinder(0.01, 0.1);
  pick_.grip["grip"] = {0.03, 0.008};
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const Plan plan = plan_from(start(0.012), seed);
    EXPECT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  }
}

/// A box between whose sides an open hand fits or not: the fingers' inner faces are 0.015 m and the grip from
/// the middle.
TEST_F(PickFingers, AnOpenHandMayReachIntoTheObjectByItsDepthAlone) {
  pick_.object.shape = Shape::box({0.04, 0.06, 0.1});
  const auto plan_with = [&](double open, double depth) {
    pick_.grip["grip"] = {open, 0.0};
    pick_.depth = depth;
    return plan_from(start(0.03), 1);
  };
  EXPECT_TRUE(plan_with(0.02, 0.0).is_proved());     // 5 mm beside it
  EXPECT_TRUE(plan_with(0.012, 0.005).is_proved());  // 3 mm in it
  const Plan narrow = plan_with(0.007, 0.005);
  EXPECT_EQ(narrow.status(), PlanStatus::no_path);
  EXPECT_NE(narrow.explanation().find("can-deeper-than-5mm"), std::string::npos) << narrow.explanation();
  EXPECT_EQ(plan_with(0.012, 0.002).status(), PlanStatus::no_path);

  Plan deep = plan_with(0.007, 0.0095);  // 8 mm in it
  ASSERT_TRUE(deep.is_proved()) << deep.explanation();
  give_motion(space(), deep);
  ASSERT_TRUE(deep.motion.has_value()) << deep.motion_caveat;
  EXPECT_TRUE(verdict(deep).valid);
  const auto judged = [&] {
    MotionToCheck motion{deep.motion->motion,
                         deep.motion->leg_ends,
                         {deep.legs.front().waypoints.front()},
                         rate_limits(robot_)};
    for (const PlanResult& leg : deep.legs) motion.stops.push_back(leg.waypoints.back());
    return check_pick_motion(pick_of(deep, pick_, robot_, space().map()), motion, deep.policies,
                             deep.padding);
  };
  EXPECT_TRUE(judged().valid) << judged().fault;
  pick_.depth = 0.005;
  EXPECT_NE(verdict(deep).first_contact.find("leg reach"), std::string::npos) << verdict(deep).first_contact;
  EXPECT_NE(verdict(deep).first_contact.find("can-deeper-than-5mm"), std::string::npos);
  EXPECT_FALSE(judged().valid);
  EXPECT_NE(judged().fault.find("can-deeper-than-5mm"), std::string::npos) << judged().fault;
}

/// From the side on which a finger is, that finger would go through the object to its other side.
TEST_F(PickFingers, NoFingerGoesThroughTheObject) {
  pick_.object.shape = Shape::box({0.03, 0.03, 0.1});
  pick_.grip["grip"] = {0.03, 0.0};
  pick_.approach << 0.12, 0.0, 0.0;
  EXPECT_TRUE(plan_from(start(0.03), 1).is_proved());
  pick_.approach << 0.0, 0.12, 0.0;
  const Plan through = plan_from(start(0.03), 1);
  EXPECT_EQ(through.status(), PlanStatus::no_path) << through.explanation();
}

TEST_F(PickFingers, NotesAHandThatHoldsNothingOrClosesDeepAndAnObjectThatIsNotThere) {
  const auto notes = [&](double radius, double closed, const Snapshot& map) {
    pick_.object.shape = Shape::cylinder(radius, 0.1);
    pick_.grip["grip"] = {0.03, closed};
    pick_.margin = 0.0;
    const Plan plan = plan_from(start(0.03), 1);
    EXPECT_EQ(plan.status(), PlanStatus::solved) << plan.explanation();
    std::string all;
    for (const std::string& note : pick_notes(pick_of(plan, pick_, robot_, map), 0.001)) all += note + "\n";
    return all;
  };
  pick_.map_from_place = pick_.map_from_object;
  pick_.map_from_place.translation().x() += 0.1;
  EXPECT_EQ(notes(0.015, 0.0, space().map()), "");
  EXPECT_NE(notes(0.015, 0.008, space().map()).find("at the grasp than 8 mm: what holds it?"),
            std::string::npos)
      << notes(0.015, 0.008, space().map());
  EXPECT_NE(notes(0.03, 0.0, space().map()).find("closes deeper than 5 mm into 'can'"), std::string::npos);
  const Snapshot table =
      VoxelScene{edge, {box_of(0.1, -0.5, top - edge, 0.6, 0.5, top - 0.001)}, {}, {}}.snapshot();
  EXPECT_EQ(notes(0.015, 0.0, table), "nothing that the map knows stands where 'can' is taken\n");
}

TEST_F(PickFingers, AGripThatTheRobotDoesNotHaveIsRefused) {
  const auto refusal = [&](const std::string& joint, const Pick::Grip& grip) -> std::string {
    pick_.grip = {{joint, grip}};
    try {
      plan_from(start(0.012), 1);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("grasp", {0.03, 0.0}),
            "pick 'can', grip, joint 'grasp': expected a joint that robot 'gripper' plans for");
  Robot held = robot_;
  held.held.push_back({.name = "thumb"});
  pick_.grip = {{"thumb", {0.03, 0.0}}};
  EXPECT_THROW(require_grip(held, pick_), std::invalid_argument);
  EXPECT_EQ(refusal("turn", {0.03, 0.0}),
            "pick 'can', grip, joint 'turn': expected a joint of the hand, this one moves the tip, link '" +
                robot_.links[static_cast<std::size_t>(robot_.tip_link)].name + "' (--tip chooses another)");
  EXPECT_EQ(refusal("grip", {0.05, 0.0}),
            "pick 'can', grip, joint 'grip': expected values within its limits, 0 to 0.04, got 0.05");
}

}  // namespace pick_fingers_test
}  // namespace clearway
