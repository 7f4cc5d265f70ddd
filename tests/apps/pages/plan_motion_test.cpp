#include "apps/pages/plan_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "planning/check/motion_torques.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {
namespace plan_motion_test {

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// A disc that slides at 1 m/s at most.
Robot disc() { return load_robot("point"); }

TEST(PlanMotion, IsTheTrajectoryThatAControllerIsGiven) {
  PagePlan plan;
  const std::vector<Configuration> path{at(0, 0), at(1, 0.2), at(1.5, -0.5)};
  const auto shown = show_motion(plan, disc(), path);
  const auto points = time_parameterize(disc(), path).points;
  ASSERT_EQ(shown.size(), points.size());
  ASSERT_EQ(plan.waypoints.size(), points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_EQ(shown[k], k);
    EXPECT_EQ(plan.waypoints[k], points[k].position);
    EXPECT_EQ(plan.speeds[k], points[k].velocity);
  }
  EXPECT_EQ(plan.period, 0.008);
  EXPECT_DOUBLE_EQ(plan.duration, points.back().time);
  EXPECT_EQ(plan.max_speed, (std::vector{1.0, 1.0}));
  EXPECT_EQ(plan.max_acceleration, (std::vector{5.0, 5.0}));
}

TEST(PlanMotion, OfManySamplesShowsSomeInTimeAndTheGreatestAccelerations) {
  PagePlan plan;
  const std::vector<Configuration> path{at(-90, 0), at(90, 1), at(20, 40)};
  const auto shown = show_motion(plan, disc(), path);
  const Trajectory trajectory = time_parameterize(disc(), path);
  const auto& points = trajectory.points;
  ASSERT_GT(points.size(), 20000U);
  ASSERT_LE(shown.size(), 1501U);
  ASSERT_EQ(plan.accelerations.size(), shown.size());
  EXPECT_EQ(shown.back() + 1, points.size());
  const std::size_t stride = shown[1];
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (i + 1 < shown.size()) {
      EXPECT_EQ(shown[i], i * stride);
    }
    EXPECT_EQ(plan.waypoints[i], points[shown[i]].position);
    double greatest = 0.0;
    for (std::size_t k = i > 0 ? shown[i - 1] + 1 : 1; k <= shown[i]; ++k)
      greatest = std::max(greatest, std::abs(points[k].velocity[0] - points[k - 1].velocity[0]) / 0.008);
    EXPECT_NEAR(std::abs(plan.accelerations[i][0]), greatest, 1e-9);
  }
  EXPECT_DOUBLE_EQ(plan.period, 0.008 * static_cast<double>(stride));
  EXPECT_DOUBLE_EQ(plan.duration, points.back().time);
}

/// Beside KDL, which the page does not ask.
TEST(PlanMotion, ShowsTheTorquesOfASmoothMotionUnderItsLoad) {
  const Robot robot = load_robot("panda");
  Eigen::VectorXd from(7), to(7);
  from << 0, -0.5, 0, -2.0, 0, 1.6, 0;
  to << 1.2, 0.2, 0.3, -1.2, 0.4, 2.2, 0.5;
  std::vector<Configuration> control(5, from);
  for (int i = 0; i <= 100; ++i) control.push_back(from + (to - from) * (i * i * (300 - 2 * i) / 1e6));
  control.insert(control.end(), 5, to);
  PlannedMotion planned;
  planned.motion = spline_motion(control, 0.02);
  const JointLoad load{.payload = 2.0, .gravity = {0.0, -3.0, -9.0}};
  const TorqueTerms terms = torque_terms(robot, load);
  PagePlan plan;
  const auto shown = show_smooth_motion(plan, robot, planned, load);
  ASSERT_EQ(plan.torques.size(), shown.size());
  ASSERT_EQ(shown.size(), planned.motion.positions.size());
  EXPECT_EQ(plan.max_torque, std::vector<double>(terms.limits.begin(), terms.limits.end()));
  for (const std::size_t k : shown)
    EXPECT_TRUE(
        plan.torques[k].isApprox(kdl_torques(robot, planned.motion.positions[k], planned.motion.velocities[k],
                                             planned.motion.accelerations[k], terms),
                                 1e-6))
        << k;
  EXPECT_EQ(plan.figures.back().first, "top torque");
  EXPECT_NE(plan.figures.back().second.find("payload 2 kg and gravity (0, -3, -9) m/s^2"), std::string::npos)
      << plan.figures.back().second;
}

/// On the second of two legs the hand holds 3 kg more.
TEST(PlanMotion, ShowsTheTorquesOfALoadWhereItRides) {
  const Robot robot = load_robot("panda");
  Eigen::VectorXd from(7);
  from << 0, -0.5, 0, -2.0, 0, 1.6, 0;
  PlannedMotion planned;
  planned.motion = spline_motion(std::vector<Configuration>(9, from), 0.02);
  planned.leg_ends = {3, 6};
  LegLoad brick;
  brick.load.name = "brick";
  brick.load.link = robot.links.back().name;
  brick.load.mass = 3.0;
  brick.load.shape = Shape::sphere(0.02);
  brick.legs = {1};
  PagePlan plan;
  show_smooth_motion(plan, robot, planned, {}, {brick});
  ASSERT_EQ(plan.torques.size(), 7U);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(7);
  const Robot loaded = with_load(robot, brick.load);
  for (std::size_t k = 0; k < 7; ++k) {
    const Robot& held = k > 3 ? loaded : robot;
    EXPECT_TRUE(plan.torques[k].isApprox(kdl_torques(held, from, rest, rest, torque_terms(held)), 1e-6)) << k;
  }
}

TEST(PlanMotion, ShowsNoTorquesWhereNoneHasALimit) {
  Robot robot = disc();
  for (Link& link : robot.links) link.mass = 0.0;
  PlannedMotion planned;
  planned.motion = spline_motion(std::vector<Configuration>(9, at(0, 0)), 0.02);
  PagePlan plan;
  EXPECT_FALSE(show_smooth_motion(plan, robot, planned, {}).empty());
  EXPECT_TRUE(plan.max_torque.empty());
  EXPECT_TRUE(plan.torques.empty());
}

TEST(PlanMotion, LeavesPathsAsTheyAreThatHaveNoTime) {
  PagePlan plan;
  EXPECT_TRUE(show_motion(plan, disc(), {}).empty());
  EXPECT_TRUE(show_motion(plan, disc(), {at(1, 1), at(1, 1)}).empty());
  std::vector<Configuration> to_and_fro;  // half an hour at 1 m/s
  for (int i = 0; i < 20; ++i) to_and_fro.push_back(at(i % 2 == 0 ? -50 : 50, 0));
  EXPECT_TRUE(show_motion(plan, disc(), to_and_fro).empty());
  EXPECT_TRUE(plan.waypoints.empty());
  EXPECT_EQ(plan.period, 0.0);
}

}  // namespace plan_motion_test
}  // namespace clearway
