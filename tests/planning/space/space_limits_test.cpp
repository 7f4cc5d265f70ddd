// Where a configuration space begins to refuse, to the last bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/body_collision.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/slide_robot.hpp"

namespace clearway {
namespace space_limits_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

Policies not_occupied() { return {.critical_by_default = false}; }

double above(double value) { return std::nextafter(value, infinity); }
double below(double value) { return std::nextafter(value, -infinity); }

TEST(SpaceLimits, OptionsBeginWhereTheirWordsSay) {
  const Robot robot = load_robot("planar2");
  const auto is_refused = [&](const SpaceOptions& options) {
    try {
      ConfigurationSpace(robot, Snapshot(), not_occupied(), options);
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  };
  for (const double bad : {-1e-9, infinity, -infinity, std::nan("")}) {
    EXPECT_TRUE(is_refused({.padding = bad})) << bad;
    EXPECT_TRUE(is_refused({.max_distance = bad})) << bad;
    EXPECT_TRUE(is_refused({.edge_resolution = bad})) << bad;
  }
  EXPECT_TRUE(is_refused({.edge_resolution = 0.0}));
  EXPECT_FALSE(is_refused({.padding = 0.0, .max_distance = 0.0, .edge_resolution = 1e-9}));
  EXPECT_FALSE(is_refused({.padding = 0.01, .max_distance = 0.3, .edge_resolution = 0.1}));
}

TEST(SpaceLimits, RobotsOfNoPoseOrLimitsAreRefused) {
  const Robot good = load_robot("planar2");
  const auto is_refused = [](const Robot& robot) {
    try {
      ConfigurationSpace(robot, Snapshot(), not_occupied());
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  };
  EXPECT_FALSE(is_refused(good));
  Robot robot = good;
  robot.map_from_base.linear() *= 1.1;
  EXPECT_TRUE(is_refused(robot));
  robot = good;
  robot.map_from_base.linear().col(0) *= -1.0;
  EXPECT_TRUE(is_refused(robot));
  for (const double bad : {infinity, std::nan("")}) {
    robot = good;
    robot.map_from_base.translation().y() = bad;
    EXPECT_TRUE(is_refused(robot)) << bad;
    robot = good;
    robot.joints[1].lower = robot.joints[1].upper = std::nan("");
    EXPECT_TRUE(is_refused(robot));
  }
  robot = good;
  robot.joints[1].lower = robot.joints[1].upper = 0.5;  // stands still
  EXPECT_FALSE(is_refused(robot));
  robot.joints[1].lower = above(0.5);
  EXPECT_TRUE(is_refused(robot));
}

TEST(SpaceLimits, AConfigurationIsWithinItsLimitsUpToTheLastBit) {
  Robot robot = load_robot("planar2");
  robot.joints[0].lower = -0.5, robot.joints[0].upper = 0.25;
  robot.joints[1].lower = 1.0, robot.joints[1].upper = 1.5;
  const ConfigurationSpace space(robot, Snapshot(), not_occupied());
  const auto is_within = [&](double first, double second) {
    const Eigen::Vector2d q(first, second), inside(0.0, 1.25);
    const bool is_free = space.is_free(q);
    EXPECT_EQ(space.check(q).is_free(), is_free);
    EXPECT_EQ(space.is_edge_free(q, inside), is_free);
    EXPECT_EQ(space.is_edge_free(inside, q), is_free);
    EXPECT_EQ(space.is_edge_free(inside, q, Eigen::Vector2d::Zero()), is_free);
    EXPECT_EQ(space.is_edge_quickly_free(q, inside), is_free);
    EXPECT_EQ(space.is_edge_quickly_free(inside, q), is_free);
    EXPECT_EQ(space.free_share(inside, q) == 1.0, is_free);
    EXPECT_EQ(space.clearance(q) > 0.0, is_free);
    return is_free;
  };
  for (const double first : {-0.5, 0.0, 0.25})
    for (const double second : {1.0, 1.25, 1.5}) EXPECT_TRUE(is_within(first, second)) << first << second;
  for (const double bad : {below(-0.5), above(0.25), -infinity, infinity, std::nan("")})
    EXPECT_FALSE(is_within(bad, 1.25)) << bad;
  for (const double bad : {below(1.0), above(1.5), -infinity, infinity, std::nan("")})
    EXPECT_FALSE(is_within(0.0, bad)) << bad;
  EXPECT_FALSE(space.is_free(Eigen::VectorXd::Zero(1)));
  EXPECT_FALSE(space.is_free(Eigen::Vector3d(0.0, 1.25, 0.0)));
  Robot endless = robot;
  endless.joints[0].lower = -infinity, endless.joints[0].upper = infinity;
  const ConfigurationSpace open(endless, Snapshot(), not_occupied());
  EXPECT_TRUE(open.is_free(Eigen::Vector2d(100.0, 1.25)));
  EXPECT_FALSE(open.is_free(Eigen::Vector2d(infinity, 1.25)));
}

TEST(SpaceLimits, EveryBodyHasTheSpaceOfItsOwnRequirementAndNoOtherIndexHas) {
  const Robot robot = load_robot("puma560");
  FreeSpaceMap map({.resolution = 0.05});
  map.paint(map.add_volume("free", {"tool"}), {Eigen::Vector3d(0.4, 0.0, 0.2), 0.3});
  const ConfigurationSpace space(robot, map.snapshot());
  for (int i = 0; i < static_cast<int>(robot.bodies.size()); ++i) {
    const BlockedSpace* const blocked = space.blocked_space(i);
    if (blocked == nullptr) continue;  // no configuration moves it
    EXPECT_EQ(blocked->requirement().policy,
              space.policies().at(robot.bodies[static_cast<std::size_t>(i)].part));
  }
  EXPECT_NE(space.blocked_space(static_cast<int>(robot.bodies.size()) - 1), nullptr);
  EXPECT_EQ(space.blocked_space(-1), nullptr);
  EXPECT_EQ(space.blocked_space(static_cast<int>(robot.bodies.size())), nullptr);
}

TEST(SpaceLimits, FieldsEndWhereTheLargestBodyDoesOrEightVoxelsAway) {
  const Robot robot = load_robot("point");  // a disc
  const double largest = robot.bodies[0].shape.bounding_radius();
  for (const double resolution : {0.01, 0.02, 0.05, 0.1}) {
    const ConfigurationSpace space(robot, FreeSpaceMap({.resolution = resolution}).snapshot(),
                                   not_occupied());
    EXPECT_DOUBLE_EQ(space.options().max_distance, largest > 8.0 * resolution ? largest : 8.0 * resolution);
    EXPECT_DOUBLE_EQ(space.clearance(Eigen::Vector2d(0.0, 0.0)), space.options().max_distance);
  }
}

/// At the end of its way the box just touches a voxel, by its padding or without: contact to the last bit,
/// with what no configuration passes.
TEST(SpaceLimits, WhatTouchesAtTheEndOfAllThatIsReachedIsMet) {
  Robot robot = worlds::slide_robot();
  robot.bodies[0].shape = Shape::box({0.25, 0.25, 0.25});
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  for (const double padding : {0.0, 0.125}) {
    for (const double side : {1.0, -1.0}) {
      robot.joints[0].lower = side > 0.0 ? 0.0 : -1.0;
      robot.joints[0].upper = side > 0.0 ? 1.0 : 0.0;
      FreeSpaceMap map({.resolution = 0.125});
      occupy(map, {side * (1.0 + 0.125 + padding + 0.0625), 0.0625, 0.0625});
      const ConfigurationSpace space(robot, map.snapshot(), not_occupied(), {.padding = padding});
      const Configuration end = Configuration::Constant(1, side);
      EXPECT_FALSE(space.is_free(end)) << side << " " << padding;
      EXPECT_TRUE(space.is_free((1.0 - 1e-6) * end));
      EXPECT_FALSE(space.is_edge_free(Configuration::Zero(1), end));
    }
  }
}

/// A body, not in the middle of its link, among voxels that are looked at one by one.
struct Among {
  static constexpr double edge = 0.03;
  Body body;
  std::vector<Eigen::Vector3d> cubes;
  Eigen::AlignedBox3d all{Eigen::Vector3d::Constant(-1.5), Eigen::Vector3d::Constant(1.5)};
  std::unique_ptr<BodyCollision> collision;

  Among(Random& random, const Shape& shape, int count) {
    body = {"body", 0, random.pose(0.1), shape, shape.sphere_cover()};
    for (Sphere& sphere : body.cover) sphere.center = body.link_from_shape * sphere.center;
    FreeSpaceMap map({.resolution = edge});
    for (int i = 0; i < count; ++i) {
      cubes.push_back(((random.point(0.4) / edge).array().floor() + 0.5) * edge);
      occupy(map, cubes.back());
    }
    collision = std::make_unique<BodyCollision>(
        body, map.snapshot().blocked_space({Policy::not_occupied, 0}, all, 0.5), all);
  }
  double gap(const Eigen::Isometry3d& pose, const Eigen::Vector3d& cube) const {
    return distance_to_cube(body.shape, pose * body.link_from_shape, cube, edge).lower;
  }
};

std::vector<Shape> shapes() {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? 0.1 : -0.08, i & 2 ? 0.06 : -0.06, i & 4 ? 0.19 : -0.05);
  return {Shape::sphere(0.08), Shape::capsule(0.05, 0.3), Shape::cylinder(0.06, 0.15),
          Shape::box({0.1, 0.15, 0.3}), Shape::convex(corners)};
}

/// Coarse clearances are too small by 1.75 voxels at most, of the spheres that hold the body; far away the
/// sphere around all of it may stand for them.
TEST(SpaceLimits, ClearancesAreTightBesideWhatBlocks) {
  Random random(14);
  int near = 0;
  for (const Shape& shape : shapes()) {
    const Among among(random, shape, 12);
    const BodyCollision& collision = *among.collision;
    RecentCubes recent;
    for (int i = 0; i < 300; ++i) {
      const Eigen::Isometry3d pose = random.pose(0.5);
      double by_spheres = 0.5, exact = 0.5;
      for (const Eigen::Vector3d& cube : among.cubes) {
        exact = std::min(exact, among.gap(pose, cube));
        for (const Sphere& sphere : among.body.cover) {
          const Eigen::Vector3d beside =
              ((pose * sphere.center - cube).cwiseAbs().array() - 0.5 * Among::edge).max(0.0);
          by_spheres = std::min(by_spheres, beside.norm() - sphere.radius);
        }
      }
      const double radius = 0.5 * shape.bounds(Eigen::Isometry3d::Identity()).sizes().maxCoeff();
      const double least = std::min(by_spheres - 1.75 * Among::edge, radius);
      near += least > 0.0 && by_spheres < radius;
      EXPECT_GE(collision.coarse_clearance(pose), least) << i;
      EXPECT_LE(collision.coarse_clearance(pose), exact + 1e-12) << i;
      EXPECT_GE(collision.quick_clearance(pose), std::min(by_spheres - 0.9 * Among::edge, 0.3)) << i;
      EXPECT_LE(collision.quick_clearance(pose), exact + 1e-12) << i;
      const double beyond = collision.clearance_beyond(pose, 0.0, 0.02, recent);
      EXPECT_GE(beyond, exact > 0.02 + 1e-9 ? std::max(0.02, least) : -1.0) << i;
      const double limit = random.between(0.0, 0.4);
      EXPECT_NEAR(collision.exact_clearance(pose, limit), std::min(limit, exact), 1e-6) << i;
    }
  }
  EXPECT_GT(near, 50);
}

TEST(SpaceLimits, EveryVoxelWithinTheMarginIsVisitedWithABoundThatIsNoMoreThanItsDistance) {
  Random random(15);
  int inside = 0, visits = 0, wanted = 0;
  for (const Shape& shape : shapes()) {
    const Among among(random, shape, 60);
    for (int i = 0; i < 100; ++i) {
      const Eigen::Isometry3d pose = random.pose(0.4);
      const double margin = i % 3 == 0 ? 0.0 : random.between(0.0, 0.1);
      std::vector<Eigen::Vector3d> visited;
      const bool whole =
          among.collision->visit_near(pose, margin, [&](const Eigen::Vector3d& cube, double bound) {
            EXPECT_GE(bound, 0.0);
            EXPECT_LE(bound, among.gap(pose, cube) + 1e-9);
            EXPECT_LE(bound, margin);
            visited.push_back(cube);
            return true;
          });
      EXPECT_TRUE(whole);
      visits += static_cast<int>(visited.size());
      const auto is_visited = [&](const Eigen::Vector3d& cube) {
        return std::any_of(visited.begin(), visited.end(),
                           [&](const Eigen::Vector3d& other) { return (other - cube).norm() < 1e-9; });
      };
      bool is_met = false;
      for (const Eigen::Vector3d& cube : among.cubes) {
        const double gap = among.gap(pose, cube);
        is_met = is_met || gap <= margin;
        if (gap > margin) continue;
        ++wanted;
        inside += gap <= 0.0;
        EXPECT_TRUE(is_visited(cube)) << i << " " << gap;
      }
      if (!visited.empty()) {  // who has seen enough is heard
        int count = 0;
        EXPECT_FALSE(among.collision->visit_near(
            pose, margin, [&](const Eigen::Vector3d&, double) { return ++count < 1; }));
        EXPECT_EQ(count, 1);
      }
      const auto met = among.collision->met_cube(pose, margin);
      EXPECT_EQ(met.has_value(), is_met) << i;
      RecentCubes recent;
      EXPECT_FALSE(among.collision->is_met(pose, margin, recent));  // nothing yet
      if (met) {
        EXPECT_LE(among.gap(pose, *met), margin + 1e-9) << i;
        recent.remember(*met);
        EXPECT_TRUE(!among.body.shape.has_exact_distance() || among.gap(pose, *met) > margin - 1e-6 ||
                    among.collision->is_met(pose, margin, recent))
            << i;
      }
    }
  }
  EXPECT_GT(inside, 200);
  EXPECT_GT(wanted, inside + 100);
  EXPECT_LT(visits, 4 * wanted);
}

/// A bridge of 18 m before one voxel of 2 cm: its field need not reach as far as the bridge is wide.
TEST(SpaceLimits, AFieldIsNoLargerThanItKnowsDistances) {
  Robot robot = worlds::slide_robot();
  robot.joints[0].upper = 15.0;
  robot.bodies[0].shape = Shape::box({0.2, 18.0, 0.2});
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  FreeSpaceMap map({.resolution = 0.02});
  occupy(map, {7.01, 3.01, 0.01});
  const ConfigurationSpace space(robot, map.snapshot(), not_occupied());
  for (double x = 0.0; x <= 15.0; x += 0.0737) {
    const bool is_met = x + 0.1 >= 7.0 && x - 0.1 <= 7.02;
    EXPECT_EQ(space.is_free(Configuration::Constant(1, x)), !is_met) << x;
  }
}

}  // namespace space_limits_test
}  // namespace clearway
