#include "planning/path/trajectory.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace trajectory_test {

/// A robot of `revolute` turning and `sliding` prismatic joints; every third has no velocity limit.
Robot robot_of(int revolute, int sliding) {
  Robot robot;
  robot.links.push_back({});
  for (int j = 0; j < revolute + sliding; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.kind = j < revolute ? JointKind::revolute : JointKind::prismatic;
    joint.lower = -3.0;
    joint.upper = 3.0;
    joint.max_velocity = j % 3 == 2 ? 0.0 : 0.4 + 0.7 * j;
    robot.joints.push_back(joint);
  }
  return robot;
}

double scaled_limit(const Robot& robot, std::size_t j, const TrajectoryOptions& options) {
  const double given = robot.joints[j].max_velocity;
  return options.velocity_scale * (given > 0.0 ? given : options.default_max_velocity);
}

/// Random steps of lengths from 1e-9 to 3, with repeats, reversals and straight runs among them.
std::vector<Configuration> random_path(const Robot& robot, Random& random) {
  std::vector<Configuration> path{random.configuration(robot)};
  Eigen::VectorXd step = Eigen::VectorXd::Zero(path[0].size());
  const double finest = random.between(0.0, 9.0);
  for (int i = random.below(60); i >= 0; --i) {
    const int kind = random.below(8);
    if (kind == 0) step.setZero();
    if (kind == 1) step = -step;
    if (kind == 2) step *= random.unit();
    if (kind > 2) {
      const Configuration to = random.configuration(robot);
      step = std::pow(10.0, -finest * random.unit()) * (to - path.back());
    }
    const Configuration next = path.back() + step;
    path.push_back(next.cwiseMax(-3.0).cwiseMin(3.0));
  }
  return path;
}

/// Distance of q from the segment a-b, the share of the segment where it is nearest.
std::pair<double, double> off_edge(const Configuration& q, const Configuration& a, const Configuration& b) {
  const Eigen::VectorXd d = b - a;
  const double share = d.isZero(0.0) ? 1.0 : std::clamp((q - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
  return {(q - a - share * d).norm(), share};
}

void expect_promises(const Robot& robot, const std::vector<Configuration>& path,
                     const TrajectoryOptions& options) {
  const Trajectory trajectory = time_parameterize(robot, path, options);
  const auto& points = trajectory.points;
  const double period = options.sampling_period, a = options.max_acceleration;
  ASSERT_FALSE(points.empty());
  EXPECT_EQ(trajectory.sampling_period, period);
  EXPECT_EQ(points.front().position, path.front());
  EXPECT_EQ(points.back().position, path.back());
  EXPECT_TRUE(points.front().velocity.isZero(0.0));
  EXPECT_TRUE(points.back().velocity.isZero(0.0));
  std::size_t edge = 0;  // samples walk along the path and never back
  for (std::size_t k = 0; k < points.size(); ++k) {
    EXPECT_DOUBLE_EQ(points[k].time, static_cast<double>(k) * period);
    while (edge + 2 < path.size() && off_edge(points[k].position, path[edge], path[edge + 1]).first > 1e-9)
      ++edge;
    if (path.size() > 1) {
      ASSERT_LE(off_edge(points[k].position, path[edge], path[edge + 1]).first, 1e-9) << "sample " << k;
    }
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const double limit = scaled_limit(robot, j, options) * (1.0 + 1e-9) + 1e-9;
      ASSERT_LE(std::abs(points[k].velocity[i]), limit);
      if (k == 0) continue;
      const double moved = points[k].position[i] - points[k - 1].position[i];
      ASSERT_LE(std::abs(moved), limit * period);
      ASSERT_LE(std::abs(points[k].velocity[i] - points[k - 1].velocity[i]), a * period + 1e-9);
      if (k == 1) continue;
      const double before = points[k - 1].position[i] - points[k - 2].position[i];
      ASSERT_LE(std::abs(moved - before), a * period * period * (1.0 + 1e-6) + 1e-11) << "sample " << k;
    }
  }
}

TEST(Trajectory, KeepsItsPromisesOnRandomPaths) {
  Random random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const Robot robot = robot_of(random.below(7), 1 + random.below(3));
    TrajectoryOptions options;
    options.sampling_period = random.between(0.002, 0.05);
    options.velocity_scale = random.between(0.2, 1.0);
    options.default_max_velocity = random.between(0.3, 2.0);
    options.max_acceleration = random.between(0.5, 20.0);
    expect_promises(robot, random_path(robot, random), options);
    if (HasFatalFailure()) FAIL() << "trial " << trial;
  }
}

TEST(Trajectory, NoneIsShorterThanTheLeastDuration) {
  Random random(12);
  for (int trial = 0; trial < 100; ++trial) {
    const Robot robot = robot_of(random.below(7), 1 + random.below(3));
    const std::vector<Configuration> path = random_path(robot, random);
    EXPECT_LE(least_duration(robot, path), time_parameterize(robot, path).points.back().time + 1e-9);
  }
  const Robot two = robot_of(2, 0);  // 0.4 and 1.1 rad/s
  EXPECT_DOUBLE_EQ(
      least_duration(two, {Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 1), Eigen::Vector2d(2, 3.2)}),
      5.0 + 2.0);
}

TEST(Trajectory, UsesWhatItMayWhereNoCornerForbidsIt) {
  Robot robot = robot_of(2, 0);
  const LimitShares free =
      limit_shares(robot, time_parameterize(robot, {Eigen::Vector2d(-2, -2), Eigen::Vector2d(2, 2)}));
  EXPECT_NEAR(free.velocity, 1.0, 0.02);
  EXPECT_NEAR(free.acceleration, 1.0, 0.02);
  TrajectoryOptions half;
  half.velocity_scale = 0.5;
  const LimitShares slow = limit_shares(
      robot, time_parameterize(robot, {Eigen::Vector2d(-2, -2), Eigen::Vector2d(2, 2)}, half), half);
  EXPECT_NEAR(slow.velocity, 0.5, 0.01);
}

TEST(Trajectory, SharesAreThoseOfTheFastestJoint) {
  const Robot robot = robot_of(2, 0);  // 0.4 and 1.1 rad/s
  Trajectory trajectory{0.1, {}};
  for (const double speed : {0.0, 0.2, 0.1}) {
    const auto k = static_cast<double>(trajectory.points.size());
    trajectory.points.push_back({0.1 * k, Eigen::Vector2d::Zero(), Eigen::Vector2d(speed, -2.0 * speed)});
  }
  const LimitShares shares = limit_shares(robot, trajectory);
  EXPECT_DOUBLE_EQ(shares.velocity, 0.5);
  EXPECT_DOUBLE_EQ(shares.acceleration, 0.4 / (0.1 * 5.0));
  EXPECT_THROW(limit_shares(robot_of(3, 0), trajectory), std::invalid_argument);
}

/// Edges long enough for many samples each, with sharp corners between them.
TEST(Trajectory, KeepsTheAccelerationAlongEdgesAndAcrossCorners) {
  Random random(3);
  const TrajectoryOptions options;
  const double step = options.max_acceleration * options.sampling_period;
  for (int trial = 0; trial < 100; ++trial) {
    const Robot robot = robot_of(3, 1);
    const std::vector<Configuration> path{random.configuration(robot), random.configuration(robot),
                                          random.configuration(robot)};
    const auto points = time_parameterize(robot, path, options).points;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double change = (points[k].velocity - points[k - 1].velocity).cwiseAbs().maxCoeff();
      EXPECT_LE(change, step + 1e-9);
    }
  }
}

TEST(Trajectory, ALoneEdgeIsTheTextbookTrapezoid) {
  Robot robot = robot_of(1, 0);
  robot.joints[0].max_velocity = 1.0;
  TrajectoryOptions options;
  options.max_acceleration = 2.0;
  options.sampling_period = 0.01;
  const auto at = [](double q) { return Configuration::Constant(1, q); };
  // 0.5 s up over 0.25, 1.5 s level, 0.5 s down
  const auto points = time_parameterize(robot, {at(0.0), at(2.0)}, options).points;
  ASSERT_NEAR(points.back().time, 2.5, 0.0101);
  const double pace = 2.5 / points.back().time;
  EXPECT_NEAR(points[25].velocity[0], pace * pace * 0.5, 1e-9);
  EXPECT_NEAR(points[25].position[0], 0.25 * 0.25 * pace * pace, 1e-9);
  EXPECT_NEAR(points[100].velocity[0], pace, 1e-9);
  // too short to reach the limit: 2 sqrt(d / a)
  EXPECT_NEAR(time_parameterize(robot, {at(0.0), at(-0.32)}, options).points.back().time, 0.8, 0.0101);
  // a waypoint on a straight line costs nothing
  EXPECT_EQ(time_parameterize(robot, {at(0.0), at(0.5), at(2.0)}, options).points.size(), points.size());
}

TEST(Trajectory, HalfTheVelocityScaleTakesLongerAndKeepsHalfTheLimit) {
  const Robot robot = robot_of(2, 0);
  const std::vector<Configuration> path{Eigen::Vector2d(-2, -2), Eigen::Vector2d(2, 1)};
  TrajectoryOptions half;
  half.velocity_scale = 0.5;
  const double whole_time = time_parameterize(robot, path).points.back().time;
  EXPECT_GT(time_parameterize(robot, path, half).points.back().time, 1.7 * whole_time);
}

TEST(Trajectory, APathOfOnePointIsOneSampleAtRest) {
  const Robot robot = robot_of(2, 1);
  const Configuration q = Eigen::Vector3d(1, -1, 0.5);
  for (const auto& path : {std::vector{q}, std::vector{q, q, q}}) {
    const auto points = time_parameterize(robot, path).points;
    ASSERT_EQ(points.size(), 1u);
    EXPECT_EQ(points[0].position, q);
    EXPECT_EQ(points[0].time, 0.0);
    EXPECT_TRUE(points[0].velocity.isZero(0.0));
  }
}

TEST(Trajectory, EqualWaypointsInARowChangeNothing) {
  const Robot robot = robot_of(2, 0);
  const Configuration a = Eigen::Vector2d(0, 0), b = Eigen::Vector2d(1, 0.3), c = Eigen::Vector2d(1, 1);
  const auto once = time_parameterize(robot, {a, b, c}).points,
             twice = time_parameterize(robot, {a, a, b, b, b, c, c}).points;
  ASSERT_EQ(once.size(), twice.size());
  for (std::size_t k = 0; k < once.size(); ++k) {
    EXPECT_EQ(once[k].position, twice[k].position);
    EXPECT_EQ(once[k].velocity, twice[k].velocity);
    EXPECT_EQ(once[k].time, twice[k].time);
  }
}

std::string refusal(const std::vector<Configuration>& path, const TrajectoryOptions& options = {}) {
  try {
    time_parameterize(robot_of(2, 0), path, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Trajectory, RefusesWhatItCannotTimeAndNamesIt) {
  const std::vector<Configuration> path{Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 1)};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(path), "accepted");
  EXPECT_NE(refusal({}).find("no waypoints"), std::string::npos);
  EXPECT_NE(refusal({path[0], Eigen::Vector3d(0, 0, 0)}).find("waypoint 1 is 3, expected 2"),
            std::string::npos);
  EXPECT_NE(refusal({Eigen::Vector2d(nan, 0)}).find("waypoint 0 is nan"), std::string::npos);
  const double huge = std::numeric_limits<double>::max();
  EXPECT_NE(refusal({Eigen::Vector2d(-huge, 0), Eigen::Vector2d(huge, 0)}), "accepted");
  EXPECT_NE(refusal({Eigen::Vector2d(0, 0), Eigen::Vector2d(1e9, 0)}).find("ten million"), std::string::npos);
  for (double TrajectoryOptions::*field :
       {&TrajectoryOptions::sampling_period, &TrajectoryOptions::velocity_scale,
        &TrajectoryOptions::default_max_velocity, &TrajectoryOptions::max_acceleration}) {
    for (const double value : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
      TrajectoryOptions options;
      options.*field = value;
      EXPECT_NE(refusal(path, options).find("expected a"), std::string::npos) << value;
    }
  }
}

}  // namespace trajectory_test
}  // namespace clearway
