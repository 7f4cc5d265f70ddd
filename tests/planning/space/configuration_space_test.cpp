#include "planning/space/configuration_space.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/fcl_truth.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace configuration_space_test {

constexpr double edge = 0.05;

Policies not_occupied() { return {.critical_by_default = false}; }

/// Of voxels that no configuration reaches as well, which cannot be hit.
TEST(ConfigurationSpace, NoClearanceExceedsTheDistanceToAnyBlockedVoxel) {
  Random random(5);
  int beyond_reach = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const worlds::UrdfRobot arm("arm", "<link name='base'/>" +
                                           worlds::urdf_link("hand", "0.5 0 0", "<sphere radius='0.05'/>") +
                                           worlds::urdf_joint("turn", "revolute", "base", "hand", "0 0 0",
                                                              "0 0 1", worlds::urdf_limit(-0.3, 0.3)));
    FreeSpaceMap builder({.resolution = edge});
    Scan scan;
    for (int i = 0; i < 3; ++i)
      scan.points.push_back((Eigen::Vector3d(0.5, 0.0, 0.0) + random.point(0.5)).cast<float>());
    builder.insert(scan);
    const Snapshot map = builder.snapshot();
    const ConfigurationSpace space(arm.robot(), map, not_occupied(), {.max_distance = 0.6});
    for (int i = 0; i < 20; ++i) {
      const Configuration q = random.configuration(arm.robot());
      const Eigen::Vector3d middle(0.5 * std::cos(q[0]), 0.5 * std::sin(q[0]), 0.0);
      double nearest = 0.6;
      map.visit_leaves([&](const Voxel& voxel) {
        if (voxel.state != VoxelState::occupied) return;
        const Eigen::Array3d gap = ((middle - voxel.center).array().abs() - voxel.size / 2).max(0.0);
        nearest = std::min(nearest, gap.matrix().norm() - 0.05);
      });
      const double clearance = space.clearance(q);
      EXPECT_LE(clearance, std::max(nearest, 0.0) + 1e-9);
      beyond_reach += clearance > 0.0 && clearance < 0.2;
    }
  }
  EXPECT_GT(beyond_reach, 50);
}

/// A member of a vector that grows, or of a class that is moved, leaves nothing behind that crashes.
TEST(ConfigurationSpace, CopiesAnswerAlikeAndWhatWasMovedFromStillAnswers) {
  const Robot robot = load_robot("puma560");
  ConfigurationSpace first(robot, worlds::voxels_about(robot, 9), not_occupied());
  Random random(17);
  std::vector<Configuration> qs;
  for (int i = 0; i < 40; ++i) qs.push_back(random.configuration(robot));
  const std::vector<bool> answers = first.is_free(qs);
  EXPECT_TRUE(std::count(answers.begin(), answers.end(), true) > 0);
  EXPECT_TRUE(std::count(answers.begin(), answers.end(), false) > 0);
  std::vector<ConfigurationSpace> spaces;
  spaces.push_back(first);
  spaces.push_back(std::move(first));
  ConfigurationSpace other(load_robot("planar2"), Snapshot(), not_occupied());
  other = spaces.front();
  EXPECT_EQ(spaces.back().is_free(qs), answers);
  EXPECT_EQ(first.is_free(qs), answers);  // NOLINT(bugprone-use-after-move): it promises so
  spaces.clear();
  EXPECT_EQ(other.is_free(qs), answers);
  EXPECT_EQ(other.robot().name, robot.name);
}

TEST(ConfigurationSpace, CriticalPartsMustLieInsideTheirPaintedVolume) {
  const Robot robot = load_robot("puma560");
  Random random(31);
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("free", {"tool"});
  for (int i = 0; i < 12; ++i)
    builder.paint(volume, {tip_pose(robot, random.configuration(robot)).translation(), 0.35});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace space(robot, map);
  EXPECT_EQ(space.policies().at("tool"), Policy::painted);
  EXPECT_EQ(space.policies().at("link2"), Policy::not_occupied);
  const FclTruth alone(robot, {}, edge);
  const Body& tool = robot.bodies.back();
  const auto cylinder = fcl_geometry(tool.shape);
  const fcl::Boxd cube(edge, edge, edge);
  int free = 0;
  for (int i = 0; i < 1'500; ++i) {
    const Configuration q = random.configuration(robot);
    const LinkPoses poses = forward_kinematics(robot, q);
    const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(tool.link)] * tool.link_from_shape;
    const Eigen::AlignedBox3d box = tool.shape.bounds(pose);
    bool expected = !alone.touches_itself(poses);
    for (double x = std::floor(box.min().x() / edge); expected && x <= box.max().x() / edge; ++x) {
      for (double y = std::floor(box.min().y() / edge); expected && y <= box.max().y() / edge; ++y) {
        for (double z = std::floor(box.min().z() / edge); expected && z <= box.max().z() / edge; ++z) {
          const Eigen::Vector3d center = (Eigen::Vector3d(x, y, z).array() + 0.5) * edge;
          if (map.state(center) == VoxelState::painted) continue;
          expected =
              !fcl_collide(cylinder.get(), pose, &cube, Eigen::Isometry3d(Eigen::Translation3d{center}));
        }
      }
    }
    ASSERT_EQ(space.is_free(q), expected);
    free += expected;
    if (!expected && !alone.touches_itself(poses)) {
      ASSERT_EQ(space.check(q).obstruction, Obstruction::outside_painted);
    }
  }
  EXPECT_GT(free, 20);
}

TEST(ConfigurationSpace, VolumesOfOtherPartsDoNotCountAndAMapWithoutPaintFallsBackToKnownFree) {
  const Robot robot = load_robot("point");
  const auto space_with = [&](const std::vector<std::string>& first, const std::vector<std::string>& second) {
    FreeSpaceMap builder({.resolution = edge});
    builder.paint(builder.add_volume("here", first), {Eigen::Vector3d::Zero(), 0.5});
    builder.paint(builder.add_volume("there", second), {Eigen::Vector3d(2.0, 0.0, 0.0), 0.5});
    return ConfigurationSpace(robot, builder.snapshot());
  };
  const Eigen::Vector2d here(0.0, 0.0), there(2.0, 0.0);
  const ConfigurationSpace named = space_with({"base"}, {"hand"});
  EXPECT_TRUE(named.is_free(here));
  EXPECT_EQ(named.check(there).obstruction, Obstruction::outside_painted);
  const ConfigurationSpace unnamed = space_with({}, {"hand"});
  EXPECT_TRUE(unnamed.is_free(here));
  EXPECT_TRUE(unnamed.is_free(there));
  EXPECT_FALSE(unnamed.is_edge_free(here, there));
  const ConfigurationSpace bare(robot, FreeSpaceMap({.resolution = edge}).snapshot());
  EXPECT_EQ(bare.policies().at("base"), Policy::known_free);
  EXPECT_EQ(bare.check(here).obstruction, Obstruction::unknown);
}

TEST(ConfigurationSpace, PaddingKeepsItsDistanceAndVerdictsNamePartPlaceAndDepth) {
  const Robot robot = load_robot("point");  // a disc of radius 0.2
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {1.025, 0.025, 0.025});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace tight(robot, map, not_occupied()),
      padded(robot, map, not_occupied(), {.padding = 0.1});
  const Eigen::Vector2d near(0.75, 0.025), touching(0.81, 0.025);  // the cube begins at x = 1
  EXPECT_TRUE(tight.is_free(near));
  EXPECT_NEAR(tight.clearance(near), 0.05, 1e-9);
  EXPECT_FALSE(padded.is_free(near));
  EXPECT_NEAR(padded.clearance(near), -0.05, 1e-9);
  // The shortest way out of the cube, whose lower face is z = 0, is downwards: half the disc's thickness.
  EXPECT_EQ(tight.check(touching).sentence(),
            "base touches an occupied voxel at (1.025, 0.025, 0.025), 5 mm deep");
  EXPECT_EQ(
      padded.check(near).sentence(),
      "base touches an occupied voxel at (1.025, 0.025, 0.025), with its padding alone: it is 50 mm away");
  EXPECT_EQ(tight.check(Eigen::Vector2d(0.0, 100.5)).sentence(), "joint y is 0.5 (rad or m) past its limit");
  EXPECT_EQ(tight.check(Eigen::Vector2d(0.0, NAN)).obstruction, Obstruction::not_finite);
  EXPECT_EQ(tight.check(Eigen::Vector3d::Zero()).obstruction, Obstruction::not_finite);
  EXPECT_FALSE(tight.is_edge_free(near, Eigen::Vector2d(0.75, NAN)));
  EXPECT_FALSE(tight.is_edge_free(Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(2.0, 0.0)));
  EXPECT_TRUE(tight.is_edge_free(Eigen::Vector2d(0.0, 0.0), near));
  EXPECT_TRUE(tight.is_edge_free(near, near));
}

TEST(ConfigurationSpace, PaddingBeyondTheFieldsReachStillCountsWhereTheRobotCannotGo) {
  Robot robot = load_robot("point");  // a disc of radius 0.2
  robot.joints[0].upper = 1.0;
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {1.675, 0.025, 0.025});  // 0.45 m beyond the farthest that the disc gets
  const Snapshot map = builder.snapshot();
  for (const double max_distance : {0.0, 0.1, 1.0}) {
    const auto padded = [&](double padding) {
      return ConfigurationSpace(robot, map, not_occupied(),
                                {.padding = padding, .max_distance = max_distance});
    };
    const Eigen::Vector2d far(0.0, 0.025), end(1.0, 0.025);
    EXPECT_FALSE(padded(0.451).is_free(end));
    EXPECT_FALSE(padded(0.451).is_edge_free(far, end));
    EXPECT_LE(padded(0.451).clearance(end), 0.0);
    EXPECT_TRUE(padded(0.449).is_edge_free(far, end));
  }
}

TEST(ConfigurationSpace, AMapOutOfTheRobotsReachIsAsGoodAsNone) {
  Robot robot = load_robot("point");  // a disc of radius 0.2
  FreeSpaceMap builder({.resolution = edge});
  builder.paint(builder.add_volume("far", {}), {{0.0, 0.4, 0.0}, 0.3});
  occupy(builder, {0.025, 0.025, 0.025});
  const Snapshot far = builder.snapshot(), none = FreeSpaceMap({.resolution = edge}).snapshot();
  for (Joint& joint : robot.joints) std::tie(joint.lower, joint.upper) = std::pair(-1.0, 1.0);
  for (const double away : {-1e7, -90.0, -4.0, 4.0, 90.0, 1e7}) {
    robot.map_from_base.translation() = Eigen::Vector3d(away, away, 0.0);
    for (const Policy policy : {Policy::not_occupied, Policy::known_free, Policy::painted}) {
      const ConfigurationSpace in_far(robot, far, {.other = policy, .critical_by_default = false}),
          in_none(robot, none, {.other = policy, .critical_by_default = false});
      Random random(61);
      for (int i = 0; i < 10; ++i) {
        const Configuration from = random.configuration(robot), to = random.configuration(robot);
        ASSERT_EQ(in_far.is_free(from), policy == Policy::not_occupied);
        ASSERT_EQ(in_far.is_edge_free(from, to), policy == Policy::not_occupied);
        ASSERT_EQ(in_far.clearance(from), in_none.clearance(from));
        ASSERT_EQ(in_far.check(from).sentence(), in_none.check(from).sentence());
        ASSERT_EQ(in_far.proximity_constraints(from, 1.0).size(),
                  in_none.proximity_constraints(from, 1.0).size());
      }
    }
  }
}

// So its fields can be brought up to date. Where the reach is too large for a field, it is the map's.
TEST(ConfigurationSpace, WhereItKnowsBlockedSpaceDoesNotGrowWithTheMap) {
  for (const double resolution : {0.02, 0.002}) {
    FreeSpaceMap map({.resolution = resolution});
    const auto see = [&](const Eigen::Vector3d& point) {
      Scan scan;
      scan.points = {point.cast<float>()};
      map.insert(scan);
      const ConfigurationSpace space(load_robot("puma560"), map.snapshot(), {}, {.max_distance = 0.1});
      return space.blocked_space(static_cast<int>(space.robot().bodies.size()) - 1)->region();
    };
    const Eigen::AlignedBox3d before = see({0.1, 0.1, 0.1}), after = see({0.4, 0.3, 0.4});
    EXPECT_EQ(before.isApprox(after), resolution == 0.02);
    EXPECT_EQ(before.contains(Eigen::Vector3d(0.4, 0.3, 0.4)), resolution == 0.02);
    EXPECT_TRUE(after.contains(Eigen::Vector3d(0.4, 0.3, 0.4)));
  }
}

TEST(ConfigurationSpace, APartThatAPaintedVolumeNamesIsCriticalThoughTheRobotDoesNotSaySo) {
  Robot robot = load_robot("point");
  robot.critical_parts.clear();  // as a bare URDF is
  FreeSpaceMap builder({.resolution = edge});
  builder.paint(builder.add_volume("free", {"base"}), {Eigen::Vector3d::Zero(), 0.5});
  const Snapshot map = builder.snapshot();
  const ConfigurationSpace space(robot, map);
  EXPECT_EQ(space.policies().at("base"), Policy::painted);
  EXPECT_TRUE(space.is_free(Eigen::Vector2d(0.0, 0.0)));
  EXPECT_FALSE(space.is_free(Eigen::Vector2d(2.0, 0.0)));
  EXPECT_EQ(ConfigurationSpace(robot, map, not_occupied()).policies().at("base"), Policy::not_occupied);
}

TEST(ConfigurationSpace, SelfContactIsNamed) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, Snapshot(), not_occupied());
  const FclTruth truth(robot, {}, edge);
  Random random(41);
  int contacts = 0;
  for (int i = 0; i < 3'000; ++i) {
    const Configuration q = random.configuration(robot);
    const Verdict verdict = space.check(q);
    ASSERT_EQ(verdict.is_free(), !truth.touches_itself(forward_kinematics(robot, q)));
    if (verdict.is_free()) continue;
    ++contacts;
    EXPECT_EQ(verdict.obstruction, Obstruction::self_collision);
    EXPECT_EQ(verdict.part, "base");
  }
  EXPECT_GT(contacts, 5);
}

TEST(ConfigurationSpace, NoPointOfTheRobotMovesFartherThanTheMotionBound) {
  for (const char* name : {"puma560", "arm5", "planar2", "point"}) {
    const Robot robot = load_robot(name);
    const ConfigurationSpace space(robot, Snapshot(), not_occupied());
    Random random(51);
    double tightest = 0.0;
    for (int i = 0; i < 2'000; ++i) {
      const Configuration from = random.configuration(robot);
      Configuration to = random.configuration(robot);
      if (i % 2 == 0) to = from + 0.01 * (to - from);
      const double bound = space.motion_bound((to - from).cwiseAbs());
      const LinkPoses a = forward_kinematics(robot, from), b = forward_kinematics(robot, to);
      for (const Body& body : robot.bodies) {
        const Eigen::Vector3d point = body.link_from_shape * body.shape.support(random.point(1.0));
        const auto link = static_cast<std::size_t>(body.link);
        const double moved = (b[link] * point - a[link] * point).norm();
        ASSERT_LE(moved, bound * (1 + 1e-9));
        tightest = std::max(tightest, moved / bound);
      }
    }
    EXPECT_GT(tightest, 0.5) << name;
  }
}

TEST(ConfigurationSpace, AMotionBoundOfOtherNumbersOfJointsIsRefused) {
  const ConfigurationSpace space(load_robot("planar2"), Snapshot(), not_occupied());
  for (const Eigen::Index count : {0, 1, 3, 40}) {
    try {
      space.motion_bound(Eigen::VectorXd::Ones(count));
      ADD_FAILURE() << count;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(
          std::string(error.what()),
          "motion bound: expected 2 values, one for each joint of planar2, got " + std::to_string(count));
    }
  }
  EXPECT_GT(space.motion_bound(Eigen::Vector2d(1.0, 1.0)), 0.0);
  EXPECT_THROW(space.motion_bound(Eigen::Vector2d(1.0, std::nan(""))), std::invalid_argument);
  EXPECT_THROW(space.motion_bound(Eigen::Vector2d(1.0, -1.0)), std::invalid_argument);
}

TEST(ConfigurationSpace, ASlideWithoutLimitsBelowATurningJointIsRefused) {
  // How far the turning joint moves it has no bound: no edge could be judged by bounds.
  Robot robot = load_robot("planar2");
  robot.joints[1].kind = JointKind::prismatic;
  robot.joints[1].axis = Eigen::Vector3d::UnitX();
  robot.joints[1].lower = -1.0, robot.joints[1].upper = 1.0;
  EXPECT_NO_THROW(ConfigurationSpace(robot, Snapshot(), not_occupied()));
  for (const bool up : {true, false}) {
    Robot unlimited = robot;
    (up ? unlimited.joints[1].upper : unlimited.joints[1].lower) =
        (up ? 1.0 : -1.0) * std::numeric_limits<double>::infinity();
    try {
      ConfigurationSpace(unlimited, Snapshot(), not_occupied());
      FAIL() << "expected a refusal";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("'" + robot.joints[1].name + "' slides without limits"),
                std::string::npos)
          << error.what();
    }
  }
  robot.joints[0].lower = -std::numeric_limits<double>::infinity();  // turning without limits is no harm
  EXPECT_NO_THROW(ConfigurationSpace(robot, Snapshot(), not_occupied()));
}

/// A robot made in memory: what would lead out of its lists, round in a circle or to no body at all.
TEST(ConfigurationSpace, RobotsThatNoFileCanSayAreRefusedBeforeAnythingIsAsked) {
  const Robot arm = load_robot("planar2");
  const Snapshot map = FreeSpaceMap({.resolution = edge}).snapshot();
  const auto refusal = [&](const std::function<void(Robot&)>& change) -> std::string {
    Robot robot = arm;
    robot.source.clear();
    change(robot);
    try {
      const ConfigurationSpace space(robot, map, {.other = Policy::not_occupied});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal([](Robot&) {}), "");
  const double infinity = std::numeric_limits<double>::infinity();
  const std::pair<std::function<void(Robot&)>, const char*> wrong[] = {
      {[](Robot& r) { r.bodies[0].cover.clear(); }, "has no cover"},
      {[](Robot& r) { r.bodies[0].link = 99; }, "on a link that it does not have"},
      {[](Robot& r) { r.bodies[0].link = -1; }, "on a link that it does not have"},
      {[](Robot& r) { r.bodies[0].link_from_shape.linear() *= 2.0; }, "link_from_shape of a body"},
      {[](Robot& r) { r.links[1].parent = 1; }, "expected parents first"},
      {[](Robot& r) { r.links[1].parent = -1; }, "expected parents first"},
      {[](Robot& r) { r.links[0].parent = 1; }, "expected parents first"},
      {[](Robot& r) { r.links[1].joint = 7; }, "a joint that it does not have"},
      {[](Robot& r) { r.links[1].parent_from_link.linear() *= 0.5; }, "parent_from_link of link"},
      {[&](Robot& r) { r.links[1].multiplier = infinity; }, "not finite"},
      {[&](Robot& r) { r.links[1].offset = std::nan(""); }, "not finite"},
      {[](Robot& r) {
         r.links[1].own_axis = {0.0, 0.0, 2.0};
       },
       "no unit vector"},
      {[](Robot& r) { r.joints[0].axis.setZero(); }, "no unit vector"},
      {[](Robot& r) { r.joints.clear(); }, "no joints"},
      {[](Robot& r) { r.tip_link = 50; }, "tip_link"},
      {[](Robot& r) { r.link_from_tip.translation().x() = std::nan(""); }, "link_from_tip"},
      {[](Robot& r) { r.exempt.emplace_back(0, 50); }, "`exempt`"},
  };
  for (const auto& [change, words] : wrong) {
    const std::string sentence = refusal(change);
    EXPECT_NE(sentence.find(words), std::string::npos) << words << ": " << sentence;
  }
}

TEST(ConfigurationSpace, UnknownPartsAndImpossibleOptionsAreRefused) {
  const Robot robot = load_robot("planar2");
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {.parts = {{"nose", Policy::painted}}}),
               std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {}, {.padding = -0.1}), std::invalid_argument);
  EXPECT_THROW(ConfigurationSpace(robot, Snapshot(), {}, {.edge_resolution = 0.0}), std::invalid_argument);
}

}  // namespace configuration_space_test
}  // namespace clearway
