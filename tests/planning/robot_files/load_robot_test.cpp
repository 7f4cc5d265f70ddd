#include "planning/robot_files/load_robot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "planning/check/path_check.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/same_robot.hpp"
#include "planning/space/configuration_space.hpp"
#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/hostile_robots.hpp"

namespace clearway {
namespace load_robot_test {

namespace fs = std::filesystem;

/// A folder of its own for each test.
class RobotFile : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    return folder_.write(name, text);
  }

  /// A URDF with a base, a link "arm" with this collision geometry, and this joint between them.
  std::string urdf(const std::string& geometry, const std::string& joint) const {
    return write("r.urdf", "<robot name='r'><link name='base'/><link name='arm'><collision><geometry>" +
                               geometry + "</geometry></collision></link>" + joint + "</robot>");
  }
  static std::string joint(const std::string& type, const std::string& inside) {
    return "<joint name='j' type='" + type + "'><parent link='base'/><child link='arm'/>" + inside +
           "</joint>";
  }

  /// The sentence with which loading is refused, without the folder.
  std::string refusal(const std::string& file) const { return folder_.refusal(RobotRequest{file}); }

  RobotFolder folder_;
  const std::string sphere = "<sphere radius='0.1'/>";
  const std::string turning =
      joint("revolute", "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/>");
};

TEST_F(RobotFile, CollisionGeometryThatUrdfdomDropsInSilenceIsRefused) {
  EXPECT_EQ(refusal(urdf("<sphere radius='nan'/>", turning)),
            "r.urdf: link 'arm': <sphere> needs radius with 1 finite number, got 'nan'");
  EXPECT_EQ(
      refusal(urdf("<cone radius='1'/>", turning)),
      "r.urdf: link 'arm': unknown collision shape <cone>, expected box, sphere, cylinder, capsule or mesh");
  EXPECT_EQ(refusal(urdf("", turning)),
            "r.urdf: link 'arm': <collision> has no <geometry> with a shape in it");
  EXPECT_EQ(refusal(urdf("<sphere radius='-0.1'/>", turning)),
            "r.urdf: link 'arm': <sphere> has radius '-0.1', expected sizes above 0");
  EXPECT_EQ(refusal(urdf("<box size='1 0 1'/>", turning)),
            "r.urdf: link 'arm': <box> has size '1 0 1', expected sizes above 0");
  EXPECT_EQ(refusal(urdf("<box size='1 1'/>", turning)),
            "r.urdf: link 'arm': <box> needs size with 3 finite numbers, got '1 1'");
  EXPECT_EQ(refusal(urdf("<mesh filename='none.stl'/>", turning)),
            "r.urdf: link 'arm': none.stl: no such mesh file");
}

TEST_F(RobotFile, ARobotOfWhichNoMovedLinkHasABodyIsRefusedForNothingOfItCouldBeChecked) {
  const std::string bare = "<robot name='r'><link name='base'/><link name='arm'><visual><geometry>" + sphere +
                           "</geometry></visual></link>" + turning + "</robot>";
  const std::string expected =
      "r.urdf: no link that a joint moves has a <collision> body, expected at least one: nothing could be "
      "checked against a map";
  EXPECT_EQ(refusal(write("r.urdf", bare)), expected);
  std::string standing = bare;
  standing.replace(standing.find("<link name='base'/>"), 19,
                   "<link name='base'><collision><geometry>" + sphere + "</geometry></collision></link>");
  EXPECT_EQ(refusal(write("r.urdf", standing)), expected);
}

TEST_F(RobotFile, ALimitOfAMimicJointHoldsThroughTheJointThatItFollows) {
  const auto limits = [&](const std::string& type, const std::string& mimic) {
    return load_robot(
               write("m.urdf",
                     "<robot name='m'><link name='base'/><link name='a'><collision><geometry>" + sphere +
                         "</geometry></collision></link><link name='b'/>"
                         "<joint name='j' type='revolute'><parent link='base'/><child link='a'/><axis xyz='0 "
                         "0 1'/>"
                         "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
                         "<joint name='k' type='" +
                         type +
                         "'><parent link='a'/><child link='b'/>"
                         "<axis xyz='0 0 -1'/><limit lower='-0.5' upper='1.5' effort='1' velocity='1'/>" +
                         mimic + "</joint></robot>"))
        .joints.at(0);
  };
  const Joint tight = limits("revolute", "<mimic joint='j' multiplier='-2' offset='0.5'/>");  // 0.5 - 2 q
  EXPECT_DOUBLE_EQ(tight.lower, -0.5);
  EXPECT_DOUBLE_EQ(tight.upper, 0.5);
  const Joint loose = limits("revolute", "<mimic joint='j' multiplier='0.25' offset='0'/>");
  EXPECT_DOUBLE_EQ(loose.lower, -1.0);
  EXPECT_DOUBLE_EQ(loose.upper, 1.0);
  const Joint turning_freely = limits("continuous", "<mimic joint='j' multiplier='-2' offset='0.5'/>");
  EXPECT_DOUBLE_EQ(turning_freely.upper, 1.0);
  EXPECT_THROW(limits("revolute", "<mimic joint='j' multiplier='1' offset='4'/>"), std::invalid_argument);
  EXPECT_THROW(limits("revolute", "<mimic joint='j' multiplier='0' offset='2'/>"), std::invalid_argument);
}

TEST_F(RobotFile, JointsThatCannotBeUsedAreRefused) {
  const auto with = [&](const std::string& type, const std::string& inside) {
    return refusal(urdf(sphere, joint(type, inside)));
  };
  EXPECT_EQ(with("revolute", "<axis xyz='0 0 0'/><limit lower='0' upper='1' effort='1' velocity='1'/>"),
            "r.urdf: joint 'j': the axis is zero, expected a direction");
  EXPECT_EQ(with("revolute", "<limit lower='2' upper='1' effort='1' velocity='1'/>"),
            "r.urdf: joint 'j': the lower limit is above the upper limit");
  EXPECT_EQ(with("revolute", "<limit lower='nan' upper='1' effort='1' velocity='1'/>"),
            "r.urdf: joint 'j': <limit> needs lower with 1 finite number, got 'nan'");
  EXPECT_EQ(with("revolute", ""), "r.urdf: joint 'j': a revolute joint needs <limit lower=… upper=…>");
  for (const char* free : {"planar", "floating", "fixed"})
    EXPECT_EQ(with(free, ""), "r.urdf: no joint can move, expected at least one revolute or prismatic joint");
  EXPECT_EQ(with("continuous", "<origin xyz='0 nan 0'/>"),
            "r.urdf: joint 'j': <origin> needs xyz with 3 finite numbers, got '0 nan 0'");
}

TEST_F(RobotFile, FilesThatAreNoTreeOfLinksAreRefused) {
  EXPECT_EQ(refusal((folder_ / "none.urdf").string()),
            "robot file 'none.urdf' cannot be read: No such file or directory");
  EXPECT_EQ(refusal(write("r.urdf", "hello")), "r.urdf: is not well-formed XML, line 1");
  EXPECT_EQ(refusal(write("r.urdf", "<sdf/>")), "r.urdf: is not a URDF: it has no <robot> element");
  EXPECT_EQ(refusal(write("r.urdf", "<robot name='r'><link name='a'/></robot>")), "r.urdf: has no joints");
  EXPECT_EQ(refusal(write("r.urdf", "<robot name='r'><link name='a'/><link name='a'/></robot>")),
            "r.urdf: link 'a' is defined twice");
  EXPECT_EQ(refusal(write("r.urdf", "<robot name='r'><link name='a'/><link name='b'/></robot>")),
            "r.urdf: links 'a' and 'b' both have no parent joint, expected one root");
  const auto fixed = [](const std::string& name, const std::string& from, const std::string& to) {
    return "<joint name='" + name + "' type='fixed'><parent link='" + from + "'/><child link='" + to +
           "'/></joint>";
  };
  const std::string links = "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>";
  EXPECT_EQ(refusal(write("r.urdf", links + fixed("x", "b", "c") + fixed("y", "c", "b") + "</robot>")),
            "r.urdf: the joints above link 'b' form a loop, expected a tree");
  EXPECT_EQ(refusal(write("r.urdf", links + fixed("x", "a", "c") + fixed("y", "b", "c") + "</robot>")),
            "r.urdf: joint 'y': link 'c' already has a parent joint, expected a tree");
  std::string chain = "<robot name='r'><link name='0'/>";
  for (int i = 1; i <= 600; ++i) {
    chain += "<link name='" + std::to_string(i) + "'/>" +
             fixed(std::to_string(i), std::to_string(i - 1), std::to_string(i));
  }
  EXPECT_EQ(refusal(write("r.urdf", chain + "</robot>")), "r.urdf: has more than 500 joints");
  EXPECT_EQ(refusal(write("r.urdf", links + fixed("x", "a", "d") + "</robot>")),
            "r.urdf: joint 'x': there is no link 'd'");
}

TEST_F(RobotFile, SettingsWithMistakesAreRefusedByKey) {
  urdf(sphere, turning);
  EXPECT_EQ(refusal(write("r.yaml", "frictoin: 0.1")),
            "r.yaml: unknown key 'frictoin', did you mean 'friction'?");
  for (const char* scale : {"-1", "0", "1e300", ".inf", "1001"})
    EXPECT_EQ(refusal(write("r.yaml", std::string("scale: ") + scale)),
              std::string(scale) == ".inf" ? "r.yaml: 'scale' must be a finite number"
                                           : "r.yaml: 'scale' must be a factor from 0.000001 to 1000");
  EXPECT_EQ(refusal(write("r.yaml", "base: {xyz: [1e300, 0, 0]}")),
            "r.yaml: 'base.xyz' must be three numbers, metres in [-1000, 1000]");
  EXPECT_EQ(refusal(write("r.yaml", "tip: {rpy: [0, 0, 13]}")),
            "r.yaml: 'tip.rpy' must be three numbers, radians in [-12.6, 12.6]");
  EXPECT_EQ(refusal(write("r.yaml", "friction: 1e300")),
            "r.yaml: 'friction' must be a number of at most 1000000000");
  EXPECT_EQ(refusal(write("r.yaml", "position_accuracy: 0")),
            "r.yaml: 'position_accuracy' must be a length above 0 and of at most 1 (metres)");
  EXPECT_EQ(refusal(write("r.yaml", "tip: {link: nose}")),
            "r.yaml: 'tip.link' names 'nose', which r does not have");
  EXPECT_EQ(refusal(write("r.yaml", "critical_parts: [nose]")),
            "r.yaml: 'critical_parts' names 'nose', which r does not have");
  EXPECT_EQ(refusal(write("r.yaml", "friction: {k: 0.2}")),
            "r.yaml: 'friction' names 'k', which r does not have");
  EXPECT_EQ(refusal(write("r.yaml", "base: {xyz: [0, 1]}")),
            "r.yaml: 'base.xyz' must be three numbers [x, y, z]");
  EXPECT_EQ(refusal(write("r.yaml", "inverse_kinematics: magic")),
            "r.yaml: 'inverse_kinematics' must be numeric or puma");
  EXPECT_TRUE(refusal(write("r.yaml", "a: [")).starts_with("r.yaml is not valid YAML at line 1, column "));
  EXPECT_TRUE(
      refusal(write("r.yaml", "description: \"open\ntip: a\n")).starts_with("r.yaml is not valid YAML at"));
  EXPECT_TRUE(refusal("no_such_robot")
                  .starts_with("unknown robot 'no_such_robot': expected one of arm5, arm6, panda, "));
}

TEST_F(RobotFile, SettingsGiveLimitsOfAccelerationAndJerk) {
  urdf(sphere, turning);
  const Robot none = load_robot(write("r.yaml", "friction: 0.1"));
  EXPECT_EQ(none.joints[0].max_acceleration, 0.0);
  EXPECT_EQ(none.joints[0].max_jerk, 0.0);
  const std::string name = none.joints[0].name;
  const Robot robot = load_robot(write("r.yaml", "max_acceleration: 7.5\nmax_jerk: {" + name + ": 150}"));
  EXPECT_EQ(robot.joints[0].max_acceleration, 7.5);
  EXPECT_EQ(robot.joints[0].max_jerk, 150.0);
  EXPECT_EQ(refusal(write("r.yaml", "max_jerk: 0")), "r.yaml: 'max_jerk' must be a finite number above 0");
  EXPECT_EQ(refusal(write("r.yaml", "max_acceleration: {k: 0.2}")),
            "r.yaml: 'max_acceleration' names 'k', which r does not have");
}

TEST_F(RobotFile, SoftLimitsNarrowTheRange) {
  const auto with = [&](const std::string& type, const std::string& limit, const std::string& soft) {
    return urdf(sphere, joint(type, "<axis xyz='0 0 1'/>" + limit + "<safety_controller " + soft + "/>"));
  };
  const auto range = [](const Robot& robot) {
    return std::pair(robot.joints.front().lower, robot.joints.front().upper);
  };
  const std::string hard = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
  const std::string soft = "soft_lower_limit='-0.5' soft_upper_limit='2' k_velocity='10'";
  EXPECT_EQ(range(load_robot(with("revolute", hard, soft))), std::pair(-0.5, 1.0));
  EXPECT_EQ(range(load_robot(with("prismatic", hard, soft))), std::pair(-0.5, 1.0));
  EXPECT_EQ(range(scaled(load_robot(with("prismatic", hard, soft)), 0.5)), std::pair(-0.25, 0.5));
  EXPECT_EQ(range(load_robot(with("continuous", "", soft))), std::pair(-0.5, 2.0));
  EXPECT_EQ(range(load_robot(
                with("revolute", "<limit lower='-1e16' upper='1e16' effort='1' velocity='1'/>", soft))),
            std::pair(-0.5, 2.0));
  EXPECT_EQ(range(load_robot(with("revolute", hard, "k_velocity='10'"))), std::pair(-1.0, 1.0));
  EXPECT_EQ(range(load_robot(with("revolute", hard, "soft_lower_limit='0' soft_upper_limit='0'"))),
            std::pair(-1.0, 1.0));
  EXPECT_EQ(range(load_robot(with("revolute", hard, "soft_lower_limit='-1e16' soft_upper_limit='1e16'"))),
            std::pair(-1.0, 1.0));
  EXPECT_EQ(refusal(with("revolute", hard, "soft_lower_limit='-0.5'")),
            "r.urdf: joint 'j': <safety_controller> has soft_lower_limit alone, expected soft_lower_limit "
            "and soft_upper_limit");
  EXPECT_EQ(refusal(with("revolute", hard, "soft_lower_limit='2' soft_upper_limit='3'")),
            "r.urdf: joint 'j': no value is within its limits and its soft limits");
  EXPECT_EQ(refusal(with("revolute", hard, "soft_lower='-0.5' soft_upper_limit='3'")),
            "r.urdf: joint 'j': <safety_controller> has soft_upper_limit alone, expected soft_lower_limit "
            "and soft_upper_limit");
}

TEST_F(RobotFile, LimitsOfAccelerationAndJerkMayStandInTheUrdf) {
  const std::string file = urdf(sphere, joint("revolute",
                                              "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' "
                                              "velocity='1' acceleration='5' deceleration='3' jerk='40'/>"));
  const Robot robot = load_robot(file);
  EXPECT_EQ(robot.joints.front().max_acceleration, 3.0);
  EXPECT_EQ(robot.joints.front().max_jerk, 40.0);
  write("r.yaml", "max_acceleration: 2\n");  // the settings say otherwise
  const Robot settled = load_robot(file);
  EXPECT_EQ(settled.joints.front().max_acceleration, 2.0);
  EXPECT_EQ(settled.joints.front().max_jerk, 40.0);
  for (const char* none :
       {"acceleration='0'", "acceleration='-1' jerk='-1'", "deceleration='1e16' jerk='1e16'"}) {
    const Robot bare = load_robot(urdf(
        sphere, joint("revolute", "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1' " +
                                      std::string(none) + "/>")));
    EXPECT_EQ(bare.joints.front().max_acceleration, 2.0) << none;  // of the settings
    EXPECT_EQ(bare.joints.front().max_jerk, 0.0) << none;
  }
}

TEST_F(RobotFile, UnlimitedAndMimicJointsAndUnnormalisedAxesAreUnderstood) {
  const Robot robot = load_robot(write(
      "r.urdf",
      "<robot name='r'><link name='base'/><link name='a'><collision><geometry><capsule radius='0.1' "
      "length='0.3'/></geometry>"
      "</collision></link><link name='b'><inertial><origin xyz='1 0 0'/><mass value='2'/>"
      "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
      "<joint name='j' type='continuous'><parent link='base'/><child link='a'/><axis xyz='0 0 10'/></joint>"
      "<joint name='k' type='continuous'><parent link='a'/><child link='b'/><origin xyz='1 0 0'/><axis "
      "xyz='0 1 0'/>"
      "<mimic joint='j' multiplier='-2' offset='0.5'/></joint></robot>"));
  ASSERT_EQ(robot.dof(), 1u);
  EXPECT_TRUE(std::isinf(robot.joints[0].lower) && std::isinf(robot.joints[0].upper));
  EXPECT_EQ(robot.joints[0].axis, Eigen::Vector3d::UnitZ());
  ASSERT_EQ(robot.bodies.size(), 1u);
  EXPECT_EQ(robot.bodies[0].shape.kind(), Shape::Kind::capsule);
  EXPECT_DOUBLE_EQ(robot.bodies[0].shape.length(), 0.3);
  // b turns about its own y by 0.5 - 2 q, whatever frame stands for it.
  const double q = 0.7;
  const LinkPoses poses = forward_kinematics(robot, Configuration::Constant(1, q));
  const Eigen::Vector3d expected =
      Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ()) *
      (Eigen::Vector3d::UnitX() +
       Eigen::AngleAxisd(0.5 - 2 * q, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitX());
  EXPECT_LT((poses[2] * robot.links[2].center_of_mass - expected).norm(), 1e-12);
}

TEST_F(RobotFile, MeshesBecomeTheirHullsAndPackagesAreSearchedUpwards) {
  fs::create_directories(folder_ / "my_robot" / "meshes");
  fs::create_directories(folder_ / "my_robot" / "urdf");
  std::ofstream(folder_ / "my_robot/meshes/box.obj")
      << "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nf 1 2 3\nf 1 3 "
         "4\nf 5 6 7\nf 5 7 8\nf 1 2 6\n";
  std::ofstream(folder_ / "my_robot/urdf/r.urdf")
      << "<robot name='r'><link name='base'/><link name='arm'><collision><geometry>"
         "<mesh filename='package://my_robot/meshes/box.obj' scale='0.1 0.2 "
         "0.3'/></geometry></collision></link>"
      << turning << "</robot>";
  const Robot robot = load_robot((folder_ / "my_robot/urdf/r.urdf").string());
  ASSERT_EQ(robot.bodies.size(), 1u);
  EXPECT_EQ(robot.bodies[0].shape.vertices().size(), 8u);
  EXPECT_LT((robot.bodies[0].shape.edges() - Eigen::Vector3d(0.2, 0.4, 0.6)).norm(), 1e-6);
}

/// A ball that slides into the mouth of a channel, which the hull of the channel's mesh fills.
TEST_F(RobotFile, AConcaveMeshCountsAsSeveralConvexBodiesWhereItsSettingsSaySo) {
  const double outline[8][2] = {{0, 0},      {1, 0},      {1, 1},    {0.75, 1},
                                {0.75, 0.2}, {0.25, 0.2}, {0.25, 1}, {0, 1}};
  std::ofstream mesh(folder_ / "channel.obj");
  for (const double z : {0.0, 1.0})
    for (const auto& [x, y] : outline) mesh << "v " << x << " " << y << " " << z << "\n";
  for (int i = 0; i < 8; ++i)
    mesh << "f " << i + 1 << " " << (i + 1) % 8 + 1 << " " << (i + 1) % 8 + 9 << " " << i + 9 << "\n";
  for (const int from : {0, 8})
    for (const auto& [a, b, c, d] : {std::array{1, 2, 5, 6}, std::array{2, 3, 4, 5}, std::array{1, 6, 7, 8}})
      mesh << "f " << from + a << " " << from + b << " " << from + c << " " << from + d << "\n";
  mesh.close();
  std::ofstream(folder_ / "r.urdf")
      << "<robot name='r'><link name='base'><collision><geometry><mesh filename='channel.obj'/></geometry>"
      << "</collision></link><link name='rod'/><link name='ball'><collision><geometry><sphere radius='0.1'/>"
      << "</geometry></collision></link><joint name='lift' type='prismatic'><parent link='base'/>"
      << "<child link='rod'/><origin xyz='0.5 3 0.5'/><axis xyz='0 0 1'/>"
      << "<limit lower='0' upper='1' effort='1' velocity='1'/></joint><joint name='slide' type='prismatic'>"
      << "<parent link='rod'/><child link='ball'/><axis xyz='0 -1 0'/>"
      << "<limit lower='0' upper='3' effort='1' velocity='1'/></joint></robot>";
  const auto deepest = [&](const std::string& settings) {
    std::ofstream(folder_ / "r.yaml") << settings;
    const Robot robot = load_robot((folder_ / "r.urdf").string());
    EXPECT_EQ(robot.bodies.size() > 2, settings != "{}");
    const ConfigurationSpace space(robot, Snapshot(), {.critical_by_default = false});
    double reached = 0.0;
    for (double q = 0.0; q < 3.0 && space.is_free(Eigen::Vector2d(0.0, q)); q += 0.01) reached = q;
    for (const double scale : {1.0, 0.5}) {  // the check, which reads the file itself, agrees
      const auto verdict_to = [&](double slide) {
        return check_path(scaled(robot, scale), Snapshot(), {}, 0.0,
                          {Eigen::Vector2d(0.0, 0.0), scale * Eigen::Vector2d(0.0, slide)});
      };
      EXPECT_TRUE(verdict_to(reached - 0.01).valid) << verdict_to(reached - 0.01).first_contact;
      EXPECT_FALSE(verdict_to(reached + 0.1).valid);
    }
    for (Shape shape : {Shape::sphere(0.1), Shape::capsule(0.1, 0.2)}) {
      Robot other = robot;  // not what its file says
      other.bodies.front().shape = shape;
      EXPECT_NE(check_path(other, Snapshot(), {}, 0.0, {Eigen::Vector2d(0.0, 0.0)})
                    .first_contact.find("a body of link 'base' is a mesh"),
                std::string::npos);
    }
    return reached;
  };
  EXPECT_NEAR(deepest("{}"), 3.0 - 1.1, 0.02);                // the hull's top
  EXPECT_NEAR(deepest("mesh_pieces: 8\n"), 3.0 - 0.3, 0.06);  // the mouth's ground
  EXPECT_NEAR(deepest("mesh_pieces: {base: 8}\n"), 3.0 - 0.3, 0.06);
  for (const char* wrong : {"mesh_pieces: 0\n", "mesh_pieces: 1.5\n", "mesh_pieces: 65\n",
                            "mesh_pieces: {ball: 2}\n", "mesh_pieces: {bal: 2}\n"}) {
    std::ofstream(folder_ / "r.yaml") << wrong;
    EXPECT_THROW(load_robot((folder_ / "r.urdf").string()), std::invalid_argument) << wrong;
  }
}

/// As of a gripper whose two fingers have the same limits though one is to run against the other.
TEST_F(RobotFile, LimitsThatAFollowerSetsAreTold) {
  const auto notes = [&](const std::string& limits) {
    std::ofstream(folder_ / "r.urdf")
        << "<robot name='r'><link name='base'/><link name='left'><collision><geometry><sphere radius='0.01'/>"
        << "</geometry></collision></link><link name='right'/>"
        << "<joint name='l' type='prismatic'><parent link='base'/><child link='left'/><axis xyz='0 1 0'/>"
        << "<limit lower='0' upper='0.025' effort='1' velocity='1'/></joint>"
        << "<joint name='r' type='prismatic'><parent link='base'/><child link='right'/><axis xyz='0 1 0'/>"
        << "<mimic joint='l' multiplier='-1'/><limit " << limits
        << " effort='1' velocity='1'/></joint></robot>";
    return robot_notes(load_robot((folder_ / "r.urdf").string()));
  };
  EXPECT_EQ(
      notes("lower='0' upper='0.025'"),
      (std::vector<std::string>{"joint 'l' keeps from 0 to 0: joint 'r', which mimics it, has such limits"}));
  EXPECT_TRUE(notes("lower='-0.025' upper='0'").empty());
}

TEST_F(RobotFile, LimitsInDegreesAndMeshesInMillimetresAreTold) {
  const auto notes = [&](double turn, double size) {
    const std::string limit = std::to_string(turn), side = std::to_string(size);
    std::ofstream(folder_ / "r.urdf")
        << "<robot name='r'><link name='base'/><link name='arm'><collision><geometry><box size='" << side
        << " 0.1 0.1'/></geometry></collision></link><joint name='j' type='revolute'>"
        << "<parent link='base'/><child link='arm'/><axis xyz='0 0 1'/><limit lower='-" << limit
        << "' upper='" << limit << "' effort='1' velocity='1'/></joint></robot>";
    return robot_notes(load_robot((folder_ / "r.urdf").string()));
  };
  EXPECT_TRUE(notes(12.6, 15.0).empty());
  EXPECT_EQ(notes(0.0, 1.0),
            (std::vector<std::string>{"joint 'j' cannot move: its lower and upper limit are both 0"}));
  const auto told = notes(170.0, 240.0);
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0], "joint 'j' turns by 340 rad: are its limits in degrees? URDF has radians");
  EXPECT_NE(told[1].find("part 'arm' has a body 240 m across"), std::string::npos) << told[1];
}

TEST_F(RobotFile, LineEndsAndTabsInAttributesAreBlanksAndUrisAreDecoded) {
  std::filesystem::create_directories(folder_ / "my_robot/meshes");
  std::ofstream(folder_ / "my_robot/meshes/a box.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
  std::ofstream(folder_ / "my_robot/meshes/100%25.obj")
      << "v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
  const auto loaded = [&](const std::string& geometry) {
    std::ofstream(folder_ / "my_robot/r.urdf")
        << "<robot name='r'><!-- it's -->\n<link name='base'/><link name='arm'><collision><origin\n "
           "xyz='0.1\t0.2\n  0.3'/>"
           "<geometry>"
        << geometry << "</geometry></collision></link>" << turning << "</robot>";
    return load_robot((folder_ / "my_robot/r.urdf").string()).bodies.at(0);
  };
  const Body box = loaded("<box size='0.2\r\n0.4\t0.6'/>");
  EXPECT_LT((box.shape.edges() - Eigen::Vector3d(0.2, 0.4, 0.6)).norm(), 1e-12);
  EXPECT_LT((box.link_from_shape.translation() - Eigen::Vector3d(0.1, 0.2, 0.3)).norm(), 1e-12);
  EXPECT_EQ(loaded("<mesh filename='package://my_robot/meshes/a%20box.obj'/>").shape.vertices().size(), 4U);
  // A file of that very name comes first.
  const Body odd = loaded("<mesh filename='package://my_robot/meshes/100%25.obj'/>");
  EXPECT_NEAR(odd.shape.bounds(Eigen::Isometry3d::Identity()).sizes().x(), 2.0, 1e-6);
  EXPECT_THROW(loaded("<mesh filename='package://my_robot/meshes/a%2box.obj'/>"), std::invalid_argument);
}

TEST_F(RobotFile, SrdfPairsNeighboursAndDesignOverlapsAreExemptAndNothingElse) {
  // Four links in a row along x; b and d overlap always (d reaches back over c), a and d never.
  const auto link = [](const std::string& name, const std::string& x, const std::string& size) {
    return "<link name='" + name + "'><collision><origin xyz='" + x + " 0 0'/><geometry><box size='" + size +
           " 0.1 0.1'/></geometry></collision></link>";
  };
  const auto hinge = [](const std::string& name, const std::string& from, const std::string& to) {
    return "<joint name='" + name + "' type='revolute'><parent link='" + from + "'/><child link='" + to +
           "'/><origin xyz='0.2 0 0'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' "
           "velocity='1'/></joint>";
  };
  const std::string text = "<robot name='r'>" + link("a", "0", "0.1") + link("b", "0", "0.1") +
                           link("c", "0", "0.1") + link("d", "-0.2", "0.5") + hinge("1", "a", "b") +
                           hinge("2", "b", "c") + hinge("3", "c", "d") + "</robot>";
  using Pairs = std::vector<std::pair<int, int>>;
  EXPECT_EQ(load_robot(write("r.urdf", text)).exempt, (Pairs{{0, 1}, {1, 2}, {1, 3}, {2, 3}}));
  write("r.srdf", "<robot name='r'><disable_collisions link1='a' link2='c' reason='Never'/></robot>");
  EXPECT_EQ(load_robot(write("r.urdf", text)).exempt, (Pairs{{0, 1}, {0, 2}, {1, 2}, {2, 3}}));
  write("r.srdf", "<robot name='r'><disable_collisions link1='a' link2='z'/></robot>");  // a hand not mounted
  EXPECT_EQ(load_robot(write("r.urdf", text)).exempt, (Pairs{{0, 1}, {1, 2}, {2, 3}}));
  write("r.srdf",
        "<robot name='r'><group name='arm'/><enable_collisions/><disable_collision link1='a' "
        "link2='c'/></robot>");
  EXPECT_EQ(refusal((folder_ / "r.urdf").string()),
            "r.srdf: unknown element <disable_collision>, did you mean <disable_collisions>?");
}

/// In a locale in which "0.5" is no number, or another one.
TEST(LoadRobot, NumbersOfFilesMeanTheSameInEveryLocale) {
  for (const char* name : {"puma560", "panda", "arm5", "planar2", "point", "puma560_miniature"}) {
    const Robot robot = load_robot(name);
    const CommaLocale commas;
    EXPECT_TRUE(is_same(load_robot(name), robot)) << name;
    EXPECT_EQ(load_robot(name).position_accuracy, robot.position_accuracy) << name;
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const Joint joint = load_robot(name).joints[j], expected = robot.joints[j];
      EXPECT_EQ(joint.friction, expected.friction) << name;
      EXPECT_EQ(joint.step, expected.step) << name;
      EXPECT_EQ(joint.max_acceleration, expected.max_acceleration) << name;
    }
  }
}

}  // namespace load_robot_test
}  // namespace clearway
