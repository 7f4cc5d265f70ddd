#include "datasets/descriptions/probe_motion.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace probe_motion_test {

SceneStroke sample_stroke() {
  SceneStroke stroke;
  const auto turned = [](double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized()));
  };
  stroke.waypoints = {{{0, 0, 0}, turned(0)},
                      {{0.1, 0.02, 0}, turned(0.3)},
                      {{0.15, 0.1, 0.05}, turned(-0.2)},
                      {{0.3, 0.1, 0}, turned(1)}};
  stroke.speed = 0.05;
  return stroke;
}

ProbeSetup probe_setup() {
  ProbeSetup setup;
  setup.board = "probe";
  setup.ball_center = {0.01, 0.02, -0.1};
  setup.ball_radius = 0.02;
  return setup;
}
const ProbeSetup probe = probe_setup();

TEST(ProbeMotion, GoesThroughTheWaypointsInOrderAtConstantSpeed) {
  const SceneStroke stroke = sample_stroke();
  const ProbeMotion motion(stroke, probe);
  size_t next = 0;
  constexpr int steps = 20000;
  double length = 0;
  Eigen::Vector3d last = motion.at(0).map_ball;
  for (int i = 0; i <= steps; ++i) {
    const Eigen::Vector3d ball = motion.at(motion.duration() * i / steps).map_ball;
    const double step = (ball - last).norm();
    length += step;
    if (i > 0) {
      EXPECT_NEAR(step, motion.length() / steps, 1e-4 * motion.length() / steps + 1e-9);
    }
    if (next < stroke.waypoints.size() && (ball - stroke.waypoints[next].ball).norm() < 2e-5) ++next;
    last = ball;
  }
  EXPECT_EQ(next, stroke.waypoints.size());
  EXPECT_NEAR(length, motion.length(), 1e-6);
  EXPECT_NEAR(motion.duration(), motion.length() / 0.05, 1e-12);
}

TEST(ProbeMotion, IsSmooth) {
  const ProbeMotion motion(sample_stroke(), probe);
  const double step = 1e-2;  // s
  for (double time = 2 * step; time < motion.duration() - 2 * step; time += step) {
    const Eigen::Vector3d before = motion.at(time).map_ball - motion.at(time - step).map_ball;
    const Eigen::Vector3d after = motion.at(time + step).map_ball - motion.at(time).map_ball;
    EXPECT_LT(std::acos(std::min(1.0, before.normalized().dot(after.normalized()))), 0.05) << time;
  }
}

TEST(ProbeMotion, TheBallIsWhereTheBoardSaysEvenWhenTheHandWobbles) {
  SceneStroke stroke = sample_stroke();
  stroke.wobble = 0.1;
  const ProbeMotion motion(stroke, probe), still(sample_stroke(), probe);
  double largest = 0;
  for (double time = 0; time <= motion.duration(); time += 0.05) {
    const auto state = motion.at(time);
    EXPECT_LT((state.map_from_probe * probe.ball_center - state.map_ball).norm(), 1e-12);
    EXPECT_EQ(state.map_ball, still.at(time).map_ball);
    const Eigen::Matrix3d sway =
        still.at(time).map_from_probe.linear().transpose() * state.map_from_probe.linear();
    largest = std::max(largest, Eigen::AngleAxisd(sway).angle());
  }
  EXPECT_GT(largest, 0.1);
  EXPECT_LT(largest, 0.1 * std::sqrt(3) + 1e-9);
}

SceneStroke timed_stroke() {
  SceneStroke stroke = sample_stroke();
  stroke.speed.reset();
  stroke.waypoints.insert(stroke.waypoints.begin() + 2, stroke.waypoints[1]);  // it rests there
  const double times[] = {0.5, 1.5, 4.0, 4.5, 7.0};
  for (std::size_t i = 0; i < 5; ++i) stroke.waypoints[i].time = times[i];
  return stroke;
}

TEST(ProbeMotion, WithTimesTheBallIsAtEachWaypointAtItsTimeAndRestsBetweenEqualOnes) {
  const SceneStroke stroke = timed_stroke();
  const ProbeMotion motion(stroke, probe);
  EXPECT_EQ(motion.begin(), 0.5);
  EXPECT_EQ(motion.duration(), 7.0);
  for (const auto& waypoint : stroke.waypoints)
    EXPECT_LT((motion.at(waypoint.time).map_ball - waypoint.ball).norm(), 1e-9) << waypoint.time;
  for (double time = 1.5; time <= 4.0; time += 0.1)
    EXPECT_LT((motion.at(time).map_ball - stroke.waypoints[1].ball).norm(), 1e-9) << time;
  Eigen::Vector3d last = motion.at(0.0).map_ball;
  for (double time = 0.0; time <= 7.5; time += 1e-3) {
    const Eigen::Vector3d ball = motion.at(time).map_ball;
    EXPECT_LE((ball - last).norm(), 0.25e-3) << time;  // never jumps: the fastest leg goes at 0.2 m/s
    last = ball;
  }
}

TEST(ProbeMotion, TremblesAboutItsWayByWhatTheStrokeSays) {
  SceneStroke stroke = sample_stroke();
  stroke.tremor = {0.0004, 0.01, 6, 12};
  stroke.seed = 5;
  const ProbeMotion motion(stroke, probe), calm(sample_stroke(), probe);
  double squares = 0.0, turns = 0.0;
  int count = 0;
  for (double time = 0.0; time <= motion.duration(); time += 0.003, ++count) {
    const auto state = motion.at(time), still = calm.at(time);
    EXPECT_LT((state.map_from_probe * probe.ball_center - state.map_ball).norm(), 1e-12);
    squares += (state.map_ball - still.map_ball).squaredNorm();
    const Eigen::Matrix3d turn = still.map_from_probe.linear().transpose() * state.map_from_probe.linear();
    turns += std::pow(Eigen::AngleAxisd(turn).angle(), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / count / 3.0), 0.0004, 0.00004);
  EXPECT_NEAR(std::sqrt(turns / count / 3.0), 0.01, 0.001);
}

TEST(ProbeMotion, StandsStillOutsideItsTime) {
  const ProbeMotion motion(sample_stroke(), probe);
  EXPECT_EQ(motion.at(-1).map_ball, motion.at(0).map_ball);
  EXPECT_TRUE(motion.at(1e9).map_ball.isApprox(Eigen::Vector3d(0.3, 0.1, 0), 1e-12));
}

}  // namespace probe_motion_test
}  // namespace clearway
