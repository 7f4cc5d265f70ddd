#include "planning/leg_motions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>

#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/can_on_table.hpp"

namespace clearway {
namespace leg_motions_test {

using can_on_table::can, can_on_table::edge, can_on_table::home, can_on_table::top;

constexpr double padding = 0.001;
constexpr std::size_t rest = 50;  ///< periods of 8 ms
enum Leg : std::size_t { approach, reach, lift, carry, lower, retreat };

class PickMotions : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    space_ = new ConfigurationSpace(load_robot("arm6"), can_on_table::table().snapshot(),
                                    can_on_table::anywhere(), {.padding = padding});
    plan_ =
        new Plan(plan_pick({.space = *space_, .start = home, .goals = {}, .survey = std::nullopt}, can()));
    plan_->motion = plan_motion(*space_, *plan_, {}, 0.4);
  }
  static void TearDownTestSuite() {
    delete plan_;
    delete space_;
  }

  static const PlannedMotion& planned() { return *plan_->motion; }
  static std::size_t begin_of(std::size_t leg) { return leg == 0 ? 0 : planned().leg_ends[leg - 1]; }

  /// The motion with `more`, which begins and ends at rest where it rests, put in at a knot.
  static void put_in(Plan& plan, std::size_t knot, const Motion& more) {
    Motion changed = stretch_of(plan.motion->motion, 0, knot);
    append(changed, more);
    append(changed, stretch_of(plan.motion->motion, knot, plan.motion->motion.positions.size() - 1));
    plan.motion->motion = changed;
    for (std::size_t& end : plan.motion->leg_ends)
      if (end >= knot) end += more.positions.size() - 1;
  }

  /// From one knot to another and back.
  static Motion there_and_back(std::size_t first, std::size_t last) {
    Motion there = stretch_of(planned().motion, first, last), back = there;
    std::reverse(back.positions.begin(), back.positions.end());
    std::reverse(back.velocities.begin(), back.velocities.end());
    std::reverse(back.accelerations.begin(), back.accelerations.end());
    for (Eigen::VectorXd& velocity : back.velocities) velocity = -velocity;
    append(there, back);
    return there;
  }

  /// From a place, by so much off and back, in 1.6 s.
  static Motion wave(const Configuration& at, const Eigen::VectorXd& off) {
    std::vector<Configuration> control;
    for (int k = -3; k <= 203; ++k) {
      const double s = std::clamp(k / 200.0, 0.0, 1.0);
      control.emplace_back(at + 16.0 * s * s * (1.0 - s) * (1.0 - s) * off);
    }
    return spline_motion(control, planned().motion.period);
  }

  static MotionVerdict verdict(const std::function<void(Plan&)>& change) {
    Plan plan = *plan_;
    change(plan);
    return check_planned_motion(*space_, plan, plan.policies);
  }

  static void refuses(const std::string& why, const std::function<void(Plan&)>& change) {
    const MotionVerdict found = verdict(change);
    EXPECT_FALSE(found.valid) << why;
    EXPECT_NE(found.fault.find(why), std::string::npos) << found.fault;
    EXPECT_EQ(found.min_clearance, 0.0) << why;
  }

  static ConfigurationSpace* space_;
  static Plan* plan_;
};
ConfigurationSpace* PickMotions::space_ = nullptr;
Plan* PickMotions::plan_ = nullptr;

/// By forward kinematics every two milliseconds: of the can's shape against the voxels of table and wall.
TEST_F(PickMotions, OfAPickAreSmoothAndKeepTheCanWhereItMayBe) {
  ASSERT_TRUE(plan_->is_proved()) << plan_->explanation() << plan_->validation.first_contact;
  ASSERT_TRUE(planned().validation.valid) << planned().validation.fault;
  EXPECT_GT(planned().validation.min_clearance, 0.0);
  EXPECT_TRUE(planned().unblended.empty());
  EXPECT_EQ(planned().leg_ends.size(), 6U);
  const Robot loaded = with_load(space_->robot(), plan_->loads.front().load);
  const double period = planned().motion.period;
  for (const Leg leg : {lift, carry, lower}) {
    for (double time = period * static_cast<double>(begin_of(leg));
         time <= period * static_cast<double>(planned().leg_ends[leg]); time += 0.002) {
      const Configuration q = planned().motion.at(time).position;
      const Eigen::Isometry3d pose = forward_kinematics(loaded, q).back();
      for (double x = 0.27; x < 0.7; x += edge)
        for (const double y : {-0.01, 0.01})
          for (double z = 0.11; z < 0.26; z += edge)
            ASSERT_GT(distance_to_cube(can().object.shape, pose, {x, y, z}, edge).lower, 0.0);
      ASSERT_GT(can().object.shape.bounds(pose).min().z(), top - 0.0011);
      if (leg == carry) continue;
      const Pick pick = can();
      const Eigen::Vector3d foot =
          (leg == lift ? pick.map_from_object : pick.map_from_place).translation() - pose.translation();
      ASSERT_LT(foot.head<2>().norm(), 0.003) << "it goes straight up and down";
    }
  }
  // It rests where the hand grasps and lets go.
  const Trajectory motion = trajectory_of(space_->robot(), *plan_);
  ASSERT_EQ(motion.events.size(), 2U);
  EXPECT_EQ(motion.events[0].time, period * static_cast<double>(planned().leg_ends[reach]));
  EXPECT_EQ(motion.events[1].time, period * static_cast<double>(planned().leg_ends[lower]));
  for (const TrajectoryEvent& event : motion.events)
    for (double time = event.time; time <= event.time + 0.4; time += 0.002)
      EXPECT_EQ(planned().motion.at(time).position, planned().motion.at(event.time).position);
  Plan timed = *plan_;
  timed.motion.reset();
  EXPECT_LT(planned().motion.duration(), trajectory_of(space_->robot(), timed, 0.4).points.back().time);
}

TEST_F(PickMotions, OfAPickAreTheSameAgainAndReadBackFromTheirFile) {
  const PlannedMotion again = plan_motion(*space_, *plan_, {}, 0.4);
  EXPECT_EQ(again.motion.positions, planned().motion.positions);
  const Plan read = parse_plan(to_json(*plan_), "plan");
  EXPECT_EQ(read.motion->motion.positions, planned().motion.positions);
  EXPECT_EQ(read.motion->grip_time, 0.4);
  EXPECT_TRUE(check_planned_motion(*space_, read, plan_->policies).valid);
}

/// What a leg permits is no other leg's.
TEST_F(PickMotions, AreRefusedWhereALegDoesWhatOnlyAnotherMay) {
  EXPECT_TRUE(verdict([](Plan&) {}).valid);
  const auto& ends = planned().leg_ends;
  refuses("leg approach", [&](Plan& plan) {  // to the can and back, before it may be touched
    put_in(plan, ends[approach], there_and_back(ends[approach], ends[reach]));
  });
  refuses("leg carry", [&](Plan& plan) {  // down onto the table and up again
    put_in(plan, ends[carry], there_and_back(ends[carry], ends[lower]));
  });
  const MotionVerdict both = verdict([&](Plan& plan) {
    put_in(plan, ends[carry], there_and_back(ends[carry], ends[lower]));
    put_in(plan, ends[approach], there_and_back(ends[approach], ends[reach]));
  });
  EXPECT_EQ(both.leg, 0) << "the first is named";
  EXPECT_TRUE(both.fault.starts_with("motion: leg approach, ")) << both.fault;
}

TEST_F(PickMotions, AreRefusedWhereTheHandDoesNotRest) {
  refuses("after leg 2 it does not rest for 0.5 s", [](Plan& plan) { plan.motion->grip_time = 0.5; });
  refuses("after leg 2 it does not rest for 0.4 s", [](Plan& plan) {
    // Up and down while the hand grasps: it stands where it should before and after.
    put_in(plan, begin_of(lift) + 10, there_and_back(begin_of(lift) + rest, planned().leg_ends[lift]));
  });
}

TEST_F(PickMotions, AreRefusedForAnotherPick) {
  refuses("can comes too near", [](Plan& plan) {  // a can that is wider than what was carried
    plan.pick->object.shape = Shape::cylinder(0.2, 0.12);
  });
  refuses("put down", [](Plan& plan) { plan.pick->map_from_place.translation().y() -= 0.01; });
  refuses("rides", [](Plan& plan) { plan.loads.front().load.link_from_load.translation().x() += 0.001; });
  refuses("lift", [](Plan& plan) { plan.pick->lift = 0.08; });
}

/// Below what it stood on: by as much as the can may not sink.
TEST_F(PickMotions, AreRefusedWhereTheCanSinksIntoWhatItStandsOn) {
  refuses("lift: cannot prove that the load stays above what it stands on", [](Plan& plan) {
    const Configuration at = planned().motion.positions[begin_of(lift) + rest];
    const Eigen::VectorXd centimetre = plan.legs[lift].waypoints[1] - plan.legs[lift].waypoints[0];
    put_in(plan, begin_of(lift) + rest, wave(at, -0.18 * centimetre));
  });
}

/// Sideways at the grasp, where the hand may touch the can: nothing else is in the way.
TEST_F(PickMotions, AreRefusedWhereAStraightWayBows) {
  const auto& ends = planned().leg_ends;
  refuses("reach: cannot prove that its way is straight", [&](Plan& plan) {
    put_in(plan, ends[reach],
           wave(planned().motion.positions[ends[reach]], 0.02 * Configuration::Unit(6, 0)));
  });
  EXPECT_TRUE(verdict([&](Plan& plan) {
                put_in(plan, ends[reach],
                       wave(planned().motion.positions[ends[reach]], 1e-3 * Configuration::Unit(6, 0)));
              }).valid);
}

}  // namespace leg_motions_test
}  // namespace clearway
