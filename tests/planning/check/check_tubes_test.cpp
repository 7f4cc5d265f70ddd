// Tubes about edges: how wide each may be, by arithmetic, and curves within them.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "mapping/free_space_map.hpp"
#include "planning/check/path_check.hpp"
#include "planning/robot/load.hpp"
#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/slide_robot.hpp"

namespace clearway {
namespace check_tubes_test {

/// A carriage of 0.1 m that stands at 0.2 and at 0.3 m before a voxel whose near face is at 0.5 m.
TEST(CheckTubes, AreProvedAsWideAsTheyAreAndNoWider) {
  FreeSpaceMap builder({.resolution = 0.1});
  occupy(builder, {0.55, 0.05, 0.05});
  const Snapshot map = builder.snapshot();
  const Robot robot = worlds::slide_robot();
  const auto at = [](double x) { return Configuration::Constant(1, x); };
  const auto width = [&](const std::vector<Configuration>& path, std::size_t edge, double padding) {
    double valid = 0.0, refused = 1.0;
    while (refused - valid > 1e-5) {
      const double middle = (valid + refused) / 2;
      std::vector<Eigen::VectorXd> deviations(std::max<std::size_t>(path.size(), 2) - 1, at(0.0));
      deviations[edge] = at(middle);
      (check_tubes(robot, map, {}, padding, path, deviations).valid ? valid : refused) = middle;
    }
    return valid;
  };
  for (const double padding : {0.0, 0.02}) {
    const std::vector<Configuration> way{at(0.2), at(0.3), at(0.1)};
    EXPECT_NEAR(width(way, 0, padding), 0.15 - padding, 1e-3);
    EXPECT_LE(width(way, 0, padding), 0.15 - padding);
    EXPECT_NEAR(width(way, 1, padding), 0.15 - padding, 1e-3);
    EXPECT_NEAR(width({at(0.32), at(0.32)}, 0, padding), 0.13 - padding, 1e-3);
    EXPECT_NEAR(width({at(0.3)}, 0, padding), 0.15 - padding, 1e-3);
  }
}

TEST(CheckTubes, NoCurveInOneThatIsValidTouchesAnything) {
  int valid = 0;
  for (const char* name : {"puma560", "arm5"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
    Random random(3);
    for (int i = 0; i < 60; ++i) {
      const Configuration from = random.configuration(robot);
      const Configuration to = from + 0.05 * (random.configuration(robot) - from);
      const Eigen::VectorXd deviation =
          Eigen::VectorXd::NullaryExpr(from.size(), [&] { return 0.05 * random.unit(); });
      if (!check_tubes(robot, space.map(), {}, 0.0, {from, to}, {deviation}).valid) continue;
      ++valid;
      EXPECT_TRUE(check_path(robot, space.map(), {}, 0.0, {from, to}).valid);
      for (int k = 0; k < 100; ++k) {
        Configuration q = from + random.unit() * (to - from);
        for (Eigen::Index j = 0; j < q.size(); ++j)
          q[j] += (random.below(3) == 0        ? random.between(-1.0, 1.0)
                   : random.below(2) - 0.5 > 0 ? 1.0
                                               : -1.0) *
                  deviation[j];
        q = q.cwiseMax(Eigen::VectorXd::NullaryExpr(q.size(), [&](Eigen::Index j) {
               return robot.joints[static_cast<std::size_t>(j)].lower;
             })).cwiseMin(Eigen::VectorXd::NullaryExpr(q.size(), [&](Eigen::Index j) {
          return robot.joints[static_cast<std::size_t>(j)].upper;
        }));
        EXPECT_TRUE(space.is_free(q)) << name << ' ' << i;
      }
    }
  }
  EXPECT_GT(valid, 20);
}

TEST(CheckTubes, WhatHoldsALoadMayNotMoveOnAnyEdgeNotEvenByWhatACurveIsAside) {
  const worlds::UrdfRobot hand = worlds::gripper();
  Load load;
  load.name = "box";
  load.link = "palm";
  load.link_from_load.translation().z() = -0.3;
  load.shape = Shape::sphere(0.01);
  load.touches = {"left", "right"};
  Load another = load;  // that no joint holds
  another.name = "tag";
  another.link_from_load.translation().z() = -0.5;
  another.touches.clear();
  const Robot robot = with_load(with_load(hand.robot(), another), load);
  Eigen::Index grip = 0;
  while (robot.joints[static_cast<std::size_t>(grip)].name != "grip") ++grip;
  const Configuration begin = Configuration::Constant(5, 0.02), step = 0.1 * Configuration::Unit(5, 0);
  const auto sentence = [&](std::size_t edge, double aside, double moved) {
    std::vector<Configuration> path{begin, begin + step, begin + 2 * step, begin + 3 * step};
    path[edge][grip] += moved;
    std::vector<Eigen::VectorXd> deviations(3, Eigen::VectorXd::Zero(5));
    deviations[std::min<std::size_t>(edge, 2)][grip] = aside;
    return check_tubes(robot, Snapshot(), {}, 0.0, path, deviations).first_contact;
  };
  for (const std::size_t edge : {0, 1, 2}) {
    EXPECT_EQ(sentence(edge, 0.9e-6, 0.0), "") << edge;
    EXPECT_NE(sentence(edge, 1.1e-6, 0.0).find("joint 'grip' moves by 1.1e-06 while it holds load 'box'"),
              std::string::npos)
        << edge << sentence(edge, 1.1e-6, 0.0);
  }
  expect_same_in_every_locale([&] { return sentence(1, 0.25, 0.0); }, "'grip' moves by 0.25 while");
  for (const std::size_t waypoint : {1, 2, 3}) {
    EXPECT_EQ(sentence(waypoint, 0.0, 0.9e-6), "") << waypoint;
    for (const double sign : {1.0, -1.0})
      EXPECT_NE(sentence(waypoint, 0.6e-6, sign * 0.5e-6).find("while it holds"), std::string::npos)
          << waypoint;
    for (const double sign : {1.0, -1.0}) {
      std::vector<Configuration> straight{begin, begin + step, begin + 2 * step, begin + 3 * step};
      straight[waypoint][grip] += sign * 0.9e-6;
      EXPECT_EQ(check_path(robot, Snapshot(), {}, 0.0, straight).first_contact, "") << waypoint;
      straight[waypoint][grip] += sign * 0.2e-6;
      const std::string contact = check_path(robot, Snapshot(), {}, 0.0, straight).first_contact;
      EXPECT_NE(contact.find("'grip' moves by 1.1e-06 while it holds"), std::string::npos) << contact;
    }
  }
}

TEST(CheckTubes, DeviationsThatAreNoneAreRefused) {
  const Robot robot = worlds::slide_robot();
  const Configuration q = Configuration::Constant(1, 0.5);
  const auto check = [&](const std::vector<Eigen::VectorXd>& deviations) {
    return check_tubes(robot, Snapshot(), {}, 0.0, {q, q, q}, deviations).valid;
  };
  const Eigen::VectorXd one = Eigen::VectorXd::Constant(1, 0.1);
  EXPECT_TRUE(check({}));
  EXPECT_TRUE(check({one, 0.0 * one}));
  EXPECT_THROW(check({one}), std::invalid_argument);
  EXPECT_THROW(check({one, one, one}), std::invalid_argument);
  EXPECT_THROW(check({one, -one}), std::invalid_argument);
  EXPECT_THROW(check({one, one / 0.0}), std::invalid_argument);
  EXPECT_THROW(check({one, Eigen::VectorXd::Zero(2)}), std::invalid_argument);
}

}  // namespace check_tubes_test
}  // namespace clearway
