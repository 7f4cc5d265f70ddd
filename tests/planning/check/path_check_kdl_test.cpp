// The bounds on motion that the independent check proves edges with, against bodies that move.
#include <gtest/gtest.h>

#include <set>

#include "planning/check/path_check_model.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/survey/path_poses.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway::check {
namespace path_check_kdl_test {

/// Moves joints a little, as far as each random number says, and compares the way of a body's outermost
/// points with their bound. @return the largest share of the bound
double largest_share(const Robot& robot) {
  const KdlArm arm(robot);
  Random random(3);
  BodyPoses from, to;
  double largest = 0.0;
  for (int i = 0; i < 3'000; ++i) {
    const Configuration q = random.configuration(robot);
    const Configuration moved = q + 1e-3 * random.unit() * (random.configuration(robot) - q);
    arm.place(q, from);
    arm.place(moved, to);
    for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
      const Eigen::Vector3d point = robot.bodies[b].shape.support(random.point(1.0).normalized());
      const double way = (to[b] * point - from[b] * point).norm();
      const double bound = arm.motion(b, (moved - q).cwiseAbs());
      EXPECT_LE(way, bound * (1.0 + 1e-9) + 1e-12) << robot.name << " " << robot.bodies[b].part;
      if (bound > 1e-9) largest = std::max(largest, way / bound);
    }
  }
  return largest;
}

/// Bodies whose places against each other differ from one configuration to another, and no others.
TEST(PathCheckKdl, OnlyBodiesThatMoveAgainstEachOtherMayTouch) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  int rigid = 0;
  for (const Robot& robot : {load_robot("puma560"), load_robot("panda"), load_robot("arm6"), whip.robot(),
                             telescope.robot(), rack.robot()}) {
    const KdlArm arm(robot);
    Random random(8);
    BodyPoses first, other;
    arm.place(random.configuration(robot), first);
    arm.place(random.configuration(robot), other);
    for (std::size_t a = 0; a < robot.bodies.size(); ++a)
      for (std::size_t b = 0; b < robot.bodies.size(); ++b) {
        const Eigen::Matrix4d apart = (first[a].inverse() * first[b]).matrix();
        const bool moves = !apart.isApprox((other[a].inverse() * other[b]).matrix(), 1e-9);
        EXPECT_EQ(arm.may_touch(a, b), moves)
            << robot.name << " " << robot.bodies[a].part << " " << robot.bodies[b].part;
        rigid += !moves && a != b;
      }
  }
  EXPECT_GT(rigid, 3);
}

TEST(PathCheckKdl, NoPointOfABodyMovesFartherThanItsBound) {
  for (const char* name : {"puma560", "panda", "arm5", "arm6", "planar2", "point"})
    EXPECT_GT(largest_share(load_robot(name)), 0.3) << name;
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  for (const Robot& robot : {whip.robot(), telescope.robot(), rack.robot()}) {
    EXPECT_GT(largest_share(robot), 0.3);
    EXPECT_GT(largest_share(without_file(robot)), 0.3);
  }
}

/// Each link in turn follows each joint in its own way; what a fixed link has of that means nothing.
TEST(PathCheckKdl, PlacesTheBodiesOfRobotsMadeInMemoryWhereTheirLinksSay) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  Random random(6);
  for (const Robot& given :
       {load_robot("arm5"), load_robot("puma560"), whip.robot(), telescope.robot(), rack.robot()}) {
    for (std::size_t i = 0; i < given.links.size(); ++i) {
      Robot robot = without_file(given);
      robot.links[i].offset = 0.3;
      robot.links[i].multiplier = -0.5;
      const KdlArm arm(robot);
      BodyPoses placed;
      for (int round = 0; round < 5; ++round) {
        const Configuration q = random.configuration(robot);
        arm.place(q, placed);
        const LinkPoses poses = forward_kinematics(robot, q);
        for (std::size_t b = 0; b < placed.size(); ++b) {
          const Body& body = robot.bodies[b];
          const Eigen::Isometry3d truth = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
          ASSERT_LT((placed[b].matrix() - truth.matrix()).norm(), 1e-9) << given.name << " link " << i;
          ASSERT_LT((arm.place(q, b).matrix() - truth.matrix()).norm(), 1e-9) << given.name << " link " << i;
        }
      }
    }
  }
}

/// Which bodies are proved, and which pairs, is what planners have, whichever joint is held and whatever
/// stands on the ground.
TEST(PathCheckKdl, HeldJointsAndStandingLinksCountAsForPlanners) {
  const worlds::UrdfRobot whip = worlds::whip(), telescope = worlds::telescope(),
                          rack = worlds::rack_and_pinion();
  int standing = 0, held_apart = 0;
  for (const Robot& given :
       {load_robot("arm5"), load_robot("panda"), whip.robot(), telescope.robot(), rack.robot()}) {
    const std::size_t free_pairs = self_collision_pairs(without_file(given)).size();
    for (std::size_t held = 1; held < given.links.size(); ++held) {
      Robot robot = without_file(given);
      robot.exempt.clear();
      for (std::size_t i = 1; i <= held; ++i)
        if (robot.links[i].joint >= 0) robot.links[i].joint = -1, robot.links[i].is_held = true;
      robot.standing = {robot.links[held].name};
      const KdlArm arm(robot);
      std::set<std::pair<int, int>> pairs, expected;
      for (const BodyPair& pair : self_collision_pairs(robot)) expected.emplace(pair.first, pair.second);
      for (std::size_t a = 0; a < robot.bodies.size(); ++a) {
        EXPECT_EQ(arm.is_policed(a), is_policed(robot, robot.bodies[a].link)) << robot.name << held;
        standing += !arm.is_policed(a);
        for (std::size_t b = a + 1; b < robot.bodies.size(); ++b)
          if (arm.may_touch(a, b)) pairs.emplace(static_cast<int>(a), static_cast<int>(b));
      }
      EXPECT_EQ(pairs, expected) << robot.name << held;
      held_apart += pairs.size() >= free_pairs;
    }
  }
  EXPECT_GT(standing, 10);
  EXPECT_GT(held_apart, 5);
}

TEST(PathCheckKdl, ABodyAboutTheOriginOfItsLinkMovesByItsOwnExtent) {
  for (const char* shape : {"<cylinder radius='0.01' length='2'/>", "<box size='0.02 0.02 2'/>"}) {
    const worlds::UrdfRobot rod("rod", "<link name='base'/>" + worlds::urdf_link("rod", "0 0 0", shape) +
                                           worlds::urdf_joint("turn", "revolute", "base", "rod", "0 0 0",
                                                              "0 0 1", worlds::urdf_limit(-3, 3)));
    const double extent = KdlArm(rod.robot()).motion(0, Configuration::Ones(1));
    EXPECT_GE(extent, 1.0) << shape;
    EXPECT_LE(extent, 1.02) << shape;
    EXPECT_GT(largest_share(rod.robot()), 0.9) << shape;
  }
}

}  // namespace path_check_kdl_test
}  // namespace clearway::check
