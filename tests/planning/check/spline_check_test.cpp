// Trajectories as controllers interpolate them, against samples of polynomials that the tests evaluate by
// ros_control's own coefficients.
#include "planning/check/spline_check.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace spline_check_test {

constexpr double edge_length = 0.05, radius = 0.2;

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// The disc, without a file, whose limits a test may change.
Robot disc(double max_velocity = 0.0, double max_acceleration = 0.0) {
  Robot robot = load_robot("point");
  robot.source.clear();
  for (Joint& joint : robot.joints) {
    joint.max_velocity = max_velocity;
    joint.max_acceleration = max_acceleration;
  }
  return robot;
}

/// One voxel each, and its twin below the plane of the disc.
Snapshot with_voxels(const std::vector<Eigen::Vector2i>& cells) {
  VoxelScene scene{edge_length, {box_of(5, 5, -0.05, 5.1, 5.1, 0.05)}, {}, {}};
  for (const Eigen::Vector2i& cell : cells) {
    const Eigen::Vector2d low = edge_length * cell.cast<double>();
    scene.occupied.push_back(
        box_of(low.x(), low.y(), -edge_length, low.x() + edge_length, low.y() + edge_length, edge_length));
  }
  return scene.snapshot();
}

double distance_to(const std::vector<Eigen::Vector2i>& cells, const Eigen::Vector2d& center) {
  double least = HUGE_VAL;
  for (const Eigen::Vector2i& cell : cells) {
    const Eigen::Array2d low = edge_length * cell.cast<double>().array();
    const Eigen::Array2d beyond = (low - center.array()).max(center.array() - low - edge_length).max(0.0);
    least = std::min(least, beyond.matrix().norm());
  }
  return least - radius;
}

/// Position, velocity and acceleration on the way from one point to the next, `t` seconds after the first.
std::array<Eigen::Vector2d, 3> sample(const SplinePoint& from, const SplinePoint& to, double t) {
  const double T = to.time - from.time;
  const bool has_rates = from.velocity.size() > 0 && to.velocity.size() > 0;
  const bool is_quintic = has_rates && from.acceleration.size() > 0 && to.acceleration.size() > 0;
  std::array<Eigen::Vector2d, 6> c;
  c.fill(Eigen::Vector2d::Zero());
  const Eigen::Vector2d p0 = from.position, way = to.position - from.position;
  c[0] = p0;
  if (!has_rates) {
    c[1] = way / T;
  } else {
    const Eigen::Vector2d v0 = from.velocity, v1 = to.velocity;
    c[1] = v0;
    if (is_quintic) {
      const Eigen::Vector2d a0 = from.acceleration, a1 = to.acceleration;
      c[2] = 0.5 * a0;
      c[3] = (20.0 * way - (8.0 * v1 + 12.0 * v0) * T - (3.0 * a0 - a1) * T * T) / (2.0 * T * T * T);
      c[4] = (-30.0 * way + (14.0 * v1 + 16.0 * v0) * T + (3.0 * a0 - 2.0 * a1) * T * T) /
             (2.0 * std::pow(T, 4));
      c[5] = (12.0 * way - 6.0 * (v0 + v1) * T + (a1 - a0) * T * T) / (2.0 * std::pow(T, 5));
    } else {
      c[2] = (3.0 * way / T - 2.0 * v0 - v1) / T;
      c[3] = (-2.0 * way / T + v0 + v1) / (T * T);
    }
  }
  std::array<Eigen::Vector2d, 3> state;
  state.fill(Eigen::Vector2d::Zero());
  for (int i = 0; i < 6; ++i) {
    state[0] += c[static_cast<std::size_t>(i)] * std::pow(t, i);
    if (i > 0) state[1] += i * c[static_cast<std::size_t>(i)] * std::pow(t, i - 1);
    if (i > 1) state[2] += i * (i - 1) * c[static_cast<std::size_t>(i)] * std::pow(t, i - 2);
  }
  return state;
}

constexpr int samples = 600;  ///< of an edge

template <class Look>
void look_along(const std::vector<SplinePoint>& points, const Look& look) {
  for (std::size_t edge = 0; edge + 1 < points.size(); ++edge)
    for (int k = 0; k <= samples; ++k)
      look(edge, k / static_cast<double>(samples),
           sample(points[edge], points[edge + 1], (points[edge + 1].time - points[edge].time) * k / samples));
}

/// Points within some 1 m, with or without velocities and accelerations.
std::vector<SplinePoint> drawn(Random& random) {
  std::vector<SplinePoint> points;
  const int count = 2 + static_cast<int>(random.between(0.0, 3.0));
  double time = random.between(0.0, 0.5);
  for (int i = 0; i < count; ++i) {
    SplinePoint point{time, random.point(1.0).head<2>()};
    const double kind = random.between(0.0, 1.0);
    if (kind > 0.2) point.velocity = random.point(1.0).head<2>();
    if (kind > 0.6) point.acceleration = random.point(2.0).head<2>();
    points.push_back(point);
    time += random.between(0.2, 3.0);
  }
  return points;
}

SplineVerdict check(const Robot& robot, const Snapshot& map, const std::vector<SplinePoint>& points) {
  return check_splines(robot, map, {}, 0.0, points);
}

/// What is called valid has no sample in a voxel, and what is refused has one.
TEST(SplineCheck, AgreesWithSamplesOfRandomTrajectories) {
  Random random(5);
  const Robot robot = disc();
  int valid = 0, refused = 0;
  for (int i = 0; i < 160; ++i) {
    const std::vector<SplinePoint> points = drawn(random);
    std::vector<Eigen::Vector2i> cells;
    for (int k = 0; k < 3; ++k)
      cells.emplace_back((random.point(1.4).head<2>() / edge_length).array().floor().matrix().cast<int>());
    const SplineVerdict found = check(robot, with_voxels(cells), points);
    double least = HUGE_VAL;
    look_along(points, [&](std::size_t edge, double share, const auto& state) {
      const double distance = distance_to(cells, state[0]);
      least = std::min(least, distance);
      const auto place = std::pair(static_cast<int>(edge), share + 0.01);
      if (!found.path.valid && place < std::pair(found.path.edge, found.path.parameter)) {
        EXPECT_GT(distance, -1e-9) << i << " before " << found.path.first_contact;
      }
    });
    if (least > 2e-3) {
      EXPECT_TRUE(found.path.valid) << i << " " << least << " " << found.path.first_contact;
      EXPECT_LE(found.path.min_clearance, least + 1e-9) << i;
      ++valid;
    } else if (least < -1e-6) {
      EXPECT_FALSE(found.path.valid) << i << " " << least;
      ++refused;
    }
    const bool is_at_start = found.path.edge == 0 && found.path.parameter == 0.0;
    if (found.path.valid || is_at_start) continue;
    const auto edge = static_cast<std::size_t>(found.path.edge);
    const double T = points[edge + 1].time - points[edge].time;
    const auto contact = sample(points[edge], points[edge + 1], T * found.path.parameter);
    EXPECT_NEAR(distance_to(cells, contact[0]), 0.0, 5e-3) << i << " " << found.path.first_contact;
  }
  EXPECT_GT(valid, 30);
  EXPECT_GT(refused, 30);
}

TEST(SplineCheck, ComparesTheGreatestRatesOfRandomTrajectories) {
  Random random(6);
  const Snapshot empty = with_voxels({});
  int kept = 0, exceeded = 0;
  for (int i = 0; i < 200; ++i) {
    const std::vector<SplinePoint> points = drawn(random);
    double speed = 0.0, pull = 0.0;
    look_along(points, [&](std::size_t, double, const auto& state) {
      speed = std::max(speed, state[1].cwiseAbs().maxCoeff());
      pull = std::max(pull, state[2].cwiseAbs().maxCoeff());
    });
    const double of_speed = random.between(0.99, 1.01), of_pull = random.between(0.99, 1.01);
    if (pull == 0.0) pull = 1.0;  // straight lines alone
    const SplineVerdict found = check(disc(of_speed * speed, of_pull * pull), empty, points);
    ASSERT_TRUE(found.path.valid) << found.path.first_contact;
    EXPECT_NEAR(found.velocity_share.value(), 1.0 / of_speed, 1e-4);
    const bool is_exceeded = of_speed < 0.9999 || (of_pull < 0.9999 && pull != 1.0);
    if (of_speed > 1.0001 && of_pull > 1.0001) {
      EXPECT_EQ(found.fault, "") << i;
      ++kept;
    } else if (is_exceeded) {
      EXPECT_NE(found.fault.find("its limit"), std::string::npos) << i;
      ++exceeded;
    }
  }
  EXPECT_GT(kept, 20);
  EXPECT_GT(exceeded, 50);
}

TEST(SplineCheck, RatesWithoutALimitAreTheGreatestOfRandomTrajectories) {
  Random random(23);
  for (int i = 0; i < 60; ++i) {
    const std::vector<SplinePoint> points = drawn(random);
    double speed = 0.0, pull = 0.0, jerk = 0.0;
    std::pair<std::size_t, Eigen::Vector2d> before{points.size(), {}};
    look_along(points, [&](std::size_t edge, double, const auto& state) {
      speed = std::max(speed, state[1].cwiseAbs().maxCoeff());
      pull = std::max(pull, state[2].cwiseAbs().maxCoeff());
      const double step = (points[edge + 1].time - points[edge].time) / samples;
      if (before.first == edge)
        jerk = std::max(jerk, (state[2] - before.second).cwiseAbs().maxCoeff() / step);
      before = {edge, state[2]};
    });
    const SplineVerdict found = check(disc(), with_voxels({}), points);
    EXPECT_EQ(found.fault, "");
    EXPECT_FALSE(found.velocity_share);
    EXPECT_NEAR(found.free_velocity.value().value, speed, 1e-4);
    EXPECT_EQ(found.free_acceleration.has_value(), found.cubics + found.quintics > 0);
    if (!found.free_acceleration) continue;
    EXPECT_NEAR(found.free_acceleration->value, pull, 1e-3);
    EXPECT_NEAR(found.jerk.value().value, jerk, 0.02 * (1.0 + jerk));
    const SplineVerdict limited = check(disc(1e3, 1e3), with_voxels({}), points);
    EXPECT_FALSE(limited.free_velocity || limited.free_acceleration);
    EXPECT_EQ(limited.jerk->value, found.jerk->value);
  }
}

/// As learned policies give them: straight lines at the limit of velocity, whose ends are rounded.
TEST(SplineCheck, PositionsOfSinglePrecisionMayBeAtTheLimit) {
  const Snapshot empty = with_voxels({});
  Random random(17);
  for (const double speed : {1.0, 1.0005}) {
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<SplinePoint> points;
      for (int i = 0; i < 10; ++i) {
        SplinePoint& point = points.emplace_back();
        point.time = 0.02 * i;
        point.position = Eigen::Vector2d(random.between(1.9, 2.1) + speed * point.time, 0.0);
        if (i > 0) point.position[0] = points.front().position[0] + speed * point.time;
        point.position = point.position.cast<float>().cast<double>();
      }
      EXPECT_EQ(check(disc(1.0), empty, points).fault.empty(), speed == 1.0) << trial;
    }
  }
}

/// The chords that are surveyed are as near to the curve as they are said to be.
TEST(SplineCheck, ItsChordsHoldTheCurve) {
  Random random(7);
  for (int i = 0; i < 20; ++i) {
    const std::vector<SplinePoint> points = drawn(random);
    const SplineVerdict found = check(disc(), with_voxels({}), points);
    ASSERT_TRUE(found.path.valid);
    look_along(points, [&](std::size_t, double, const auto& state) {
      double least = HUGE_VAL;
      for (std::size_t k = 0; k + 1 < found.chords.size(); ++k) {
        const Eigen::Vector2d from = found.chords[k], way = found.chords[k + 1] - found.chords[k];
        const double share = std::clamp(way.dot(state[0] - from) / way.squaredNorm(), 0.0, 1.0);
        least = std::min(least, (state[0] - from - share * way).cwiseAbs().maxCoeff());
      }
      EXPECT_LE(least, 5.1e-4) << i;
    });
  }
}

TEST(SplineCheck, SeesASwingBetweenEqualPoints) {
  const Eigen::Vector2d along(1.0, 0.0);
  const std::vector<SplinePoint> swing{{0.0, at(0, 0), along}, {4.0, at(0, 0), -along}};
  // It goes to h v / 4 = 1 m and back.
  const SplineVerdict free = check(disc(), with_voxels({{26, 0}}), swing),
                      met = check(disc(), with_voxels({{23, 0}}), swing);
  EXPECT_TRUE(free.path.valid) << free.path.first_contact;
  EXPECT_EQ(free.cubics, 1U);
  EXPECT_NEAR(free.path.min_clearance, 0.1, 0.02);
  EXPECT_FALSE(met.path.valid);
  EXPECT_NE(met.path.first_contact.find("edge 0, 1.55"), std::string::npos) << met.path.first_contact;
  EXPECT_NEAR(met.path.parameter, 0.5 - std::sqrt(0.05) / 2.0, 2e-3);  // x = 0.95
  // Within joint limits as far as it goes, to the last micrometre.
  Robot narrow = disc();
  narrow.joints[0].upper = 1.000001;
  EXPECT_TRUE(check(narrow, with_voxels({}), swing).path.valid);
  narrow.joints[0].upper = 0.999999;
  const SplineVerdict beyond = check(narrow, with_voxels({}), swing);
  EXPECT_FALSE(beyond.path.valid);
  EXPECT_NE(beyond.path.first_contact.find("2 s after the start: joint x is 1, outside its limits -100 to"),
            std::string::npos)
      << beyond.path.first_contact;
}

TEST(SplineCheck, KindsAreOfTheHighestDegreeThatBothPointsAllow) {
  const Eigen::Vector2d none = Eigen::Vector2d::Zero();
  const std::vector<SplinePoint> points{{0.0, at(0, 0), none, none},
                                        {1.0, at(0.1, 0), none, none},
                                        {2.0, at(0.2, 0), none},
                                        {3.0, at(0.3, 0)},
                                        {4.0, at(0.4, 0), none}};
  const SplineVerdict found = check(disc(0.2, 1.0), with_voxels({}), points);
  EXPECT_TRUE(found.is_valid()) << found.fault;
  EXPECT_EQ((std::array{found.quintics, found.cubics, found.lines}), (std::array<std::size_t, 3>{1, 1, 2}));
  EXPECT_NEAR(found.velocity_share.value(), 0.1 * 1.875 / 0.2, 1e-9);  // of the quintic from rest to rest
  EXPECT_NEAR(found.acceleration_share.value(), 0.6, 1e-9);            // of the cubic
  const SplineVerdict fast = check(disc(0.18), with_voxels({}), points);
  EXPECT_TRUE(fast.path.valid);
  EXPECT_FALSE(fast.is_valid());
  EXPECT_EQ(fast.fault,
            "motion: edge 0, 0.5 s after the start: the velocity of joint x is 0.1875, its limit 0.18");
}

/// Text of nine decimals exceeds a limit by what it leaves out, and no more is let pass.
TEST(SplineCheck, LimitsMayBeExceededByRoundingAlone) {
  const Eigen::Vector2d v(1.0, 0.0);
  const auto fault = [&](double way, double limit) {
    return check(disc(limit), with_voxels({}), {{0.0, at(0, 0), v}, {0.01, at(way, 0), v}}).fault;
  };
  EXPECT_EQ(fault(0.01 + 1e-9, 1.0), "");
  EXPECT_NE(fault(0.01 + 1e-7, 1.0), "");
  EXPECT_EQ(fault(0.01, 1.0 / (1.0 + 9e-7)), "");
  EXPECT_NE(fault(0.01, 0.999), "");
}

/// However short the edges are: what points state is compared as it stands, the rest to 1 %.
TEST(SplineCheck, ShortEdgesHideNoSpeed) {
  for (const double h : {1e-3, 1e-5, 1e-7, 1e-9}) {
    for (const double speed : {0.999, 1.02}) {
      const Eigen::Vector2d v(speed, 0.0);
      std::vector<SplinePoint> stated, lines;
      for (int i = 0; i < 20; ++i) {
        stated.push_back({h * i, at(speed * h * i, 0), v});
        lines.push_back({h * i, at(speed * h * i, 0)});
      }
      EXPECT_EQ(check(disc(1.0), with_voxels({}), stated).fault.empty(), speed < 1.0) << h << " " << speed;
      EXPECT_EQ(check(disc(1.0), with_voxels({}), lines).fault.empty(), speed < 1.0) << h << " " << speed;
    }
  }
}

/// Whichever side of the point the straight line is on.
TEST(SplineCheck, AStatedSpeedIsComparedWhereACurveTakesItOnEitherSide) {
  constexpr double brief = 1e-7;
  for (const double speed : {0.999, 1.005}) {
    const Configuration rate = at(speed, 0.0), slower = at(0.9, 0.0),
                        there = at(0.5 * (speed + 0.9) * brief, 0.0);
    const std::vector<SplinePoint> line_first{
        {-1.0, at(-0.5, 0.0)}, {0.0, at(0.0, 0.0), rate}, {brief, there, slower}},
        line_last{{0.0, at(0.0, 0.0), slower}, {brief, there, rate}, {1.0, at(0.5, 0.0)}};
    for (const auto& points : {line_first, line_last})
      EXPECT_EQ(check(disc(1.0), with_voxels({}), points).fault.empty(), speed < 1.0) << speed;
  }
}

/// Between two equal points the cubic of velocities 1 and -1 goes 0.25 m beyond: past either limit.
TEST(SplineCheck, ACurveThatSwingsPastALimitBetweenItsPointsIsRefused) {
  Robot robot = disc();
  for (Joint& joint : robot.joints) joint.lower = -1.0, joint.upper = 1.0;
  for (const double side : {-1.0, 1.0})
    for (const bool is_first : {true, false})
      for (const double from : {0.74, 0.76}) {
        const double p = side * from;
        const Configuration place = is_first ? at(p, 0.0) : at(0.0, p),
                            rate = is_first ? at(side, 0.0) : at(0.0, side);
        const SplineVerdict verdict =
            check_splines(robot, with_voxels({}), {}, 0.0, {{0.0, place, rate}, {1.0, place, -rate}});
        EXPECT_EQ(verdict.path.valid, from < 0.75) << p << ' ' << verdict.path.first_contact;
        if (from > 0.75) {
          EXPECT_NE(verdict.path.first_contact.find("outside its limits"), std::string::npos);
        }
      }
}

TEST(SplineCheck, OnePointIsCheckedWhereItIs) {
  EXPECT_TRUE(check(disc(), with_voxels({{6, 0}}), {{1.0, at(0, 0)}}).is_valid());
  const SplineVerdict met = check(disc(), with_voxels({{3, 0}}), {{1.0, at(0, 0)}});
  EXPECT_FALSE(met.path.valid);
  EXPECT_NE(met.path.first_contact.find("1 s after the start"), std::string::npos) << met.path.first_contact;
  EXPECT_FALSE(check(disc(), with_voxels({}), {{0.0, at(0, 200)}}).path.valid);
}

TEST(SplineCheck, WhatIsNoTrajectoryIsRefused) {
  const Eigen::Vector2d v(1.0, 0.0);
  const auto refuses = [&](const std::vector<SplinePoint>& points) {
    EXPECT_THROW(check(disc(), with_voxels({}), points), std::invalid_argument);
  };
  refuses({});
  refuses({{0.0, at(0, 0)}, {0.0, at(1, 0)}});
  refuses({{1.0, at(0, 0)}, {0.5, at(1, 0)}});
  refuses({{std::nan(""), at(0, 0)}});
  refuses({{0.0, at(0, std::nan(""))}});
  refuses({{0.0, Configuration(Eigen::Vector3d::Zero())}});
  refuses({{0.0, at(0, 0), Eigen::Vector3d::Zero()}});
  refuses({{0.0, at(0, 0), {}, v}});
  Robot endless = disc();
  endless.joints[0].lower = -HUGE_VAL;
  endless.joints[0].upper = HUGE_VAL;
  const SplineVerdict far = check(endless, with_voxels({}), {{0.0, at(0, 0), 1e6 * v}, {1e9, at(0, 0), v}});
  EXPECT_NE(far.path.first_contact.find("have lost their digits"), std::string::npos)
      << far.path.first_contact;
}

/// Between points with accelerations of 0, however near to each other, lie others.
TEST(SplineCheck, StatesLieBetweenPointsThatAreNear) {
  const auto one = [](double value) { return Eigen::VectorXd::Constant(1, value).eval(); };
  const std::vector<SplinePoint> points{{0.0, one(0.0), one(0.0), one(0.0)},
                                        {0.004, one(1e-4), one(0.0), one(0.0)}};
  double greatest = 0.0;
  for (const auto& [time, state] : spline_states(points))
    greatest = std::max(greatest, std::abs(state.acceleration[0]));
  EXPECT_NEAR(greatest, 10.0 / std::sqrt(3.0) * 1e-4 / (0.004 * 0.004), 0.03 * greatest);  // of the quintic
}

}  // namespace spline_check_test
}  // namespace clearway
