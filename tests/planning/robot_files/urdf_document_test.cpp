#include "planning/robot_files/urdf_document.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <locale>

#include "planning/check/path_check_links.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/hostile_robots.hpp"
#include "tests/worlds/mesh_samples.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace urdf_document_test {

class UrdfDocumentFile : public testing::Test {
 protected:
  std::string with_joint(const std::string& type, const std::string& inside) const {
    return folder_.refusal(two_links(sphere_collision(), type, inside));
  }
  std::string with_shape(const std::string& shape) const {
    return folder_.refusal(
        two_links("<collision><geometry>" + shape + "</geometry></collision>", "revolute", free_turn()));
  }
  std::string with_collision(const std::string& collision) const {
    return folder_.refusal(two_links(collision, "revolute", free_turn()));
  }

  RobotFolder folder_;
  const std::string limit_ = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
};

TEST_F(UrdfDocumentFile, AnAxisThatNormalisesToNothingIsRefused) {
  const std::string rest = ", expected a direction of length 1, at least 0.001 and at most 1000";
  for (const std::string& axis :
       {std::string("0 0 1e200"), std::string("1e-200 0 0"), std::string("0 1e-5 0")}) {
    const std::string sentence = with_joint("revolute", "<axis xyz='" + axis + "'/>" + limit_);
    EXPECT_EQ(sentence.find("r.urdf: joint 'j': <axis> has xyz '" + axis + "', expected"), 0u) << sentence;
  }
  EXPECT_EQ(with_joint("revolute", "<axis xyz='0 0 -5000'/>" + limit_),
            "r.urdf: joint 'j': <axis> has xyz '0 0 -5000'" + rest);
  EXPECT_EQ(with_joint("continuous", "<axis/>"), "r.urdf: joint 'j': <axis> needs xyz with 3 finite numbers");
  EXPECT_EQ(with_joint("revolute", "<axis xyz='0 0 10'/>" + limit_), "accepted");
  EXPECT_EQ(with_joint("revolute", limit_), "accepted");  // URDF: about x
}

TEST_F(UrdfDocumentFile, NumbersThatNoRobotHasAreRefusedWithTheirRange) {
  const std::string start = "r.urdf: joint 'j': ";
  EXPECT_EQ(with_joint("revolute", "<origin xyz='0 1e9 0'/>" + free_turn()),
            start + "<origin> has xyz '0 1e9 0', expected metres in [-1000, 1000]");
  EXPECT_EQ(with_joint("revolute", "<origin rpy='90 0 0'/>" + free_turn()),
            start + "<origin> has rpy '90 0 0', expected radians in [-12.6, 12.6]");
  EXPECT_EQ(with_joint("revolute", "<limit lower='-1e7' upper='1' effort='1' velocity='1'/>"),
            start + "<limit> has lower '-1e7', expected radians in [-1000, 1000]");
  EXPECT_EQ(with_joint("prismatic", "<limit lower='-1' upper='2000' effort='1' velocity='1'/>"),
            start + "<limit> has upper '2000', expected metres in [-1000, 1000]");
  EXPECT_EQ(with_joint("revolute", "<limit lower='-1' upper='1' effort='1' velocity='-2'/>"),
            start + "<limit> has velocity '-2', expected rad/s or m/s in [0, 1e+06]");
  EXPECT_EQ(with_joint("revolute", "<limit lower='-1' upper='1' velocity='1'/>"),
            start + "<limit> needs effort with 1 finite number, 0 where there is none to keep");
  EXPECT_EQ(with_joint("revolute", "<limit effort='1' velocity='1'/>"),
            start + "a revolute joint needs <limit lower=… upper=…>");
  EXPECT_EQ(with_shape("<sphere radius='1e-9'/>"),
            "r.urdf: link 'arm': <sphere> has radius '1e-9', expected metres in [1e-06, 1000]");
  EXPECT_EQ(with_shape("<box size='1 1 1e300'/>").find("r.urdf: link 'arm': <box> has size '1 1 1e300'"), 0u);
  EXPECT_EQ(with_shape("<cylinder radius='1' length='5000'/>"),
            "r.urdf: link 'arm': <cylinder> has length '5000', expected metres in [1e-06, 1000]");
  EXPECT_EQ(with_shape("<capsule radius='1' length='-5'/>"),
            "r.urdf: link 'arm': <capsule> has length '-5', expected sizes above 0");
  EXPECT_EQ(with_shape("<capsule radius='0.1' length='0'/>"), "accepted");
  EXPECT_EQ(with_shape("<mesh filename='m.stl' scale='1 0 1'/>"),
            "r.urdf: link 'arm': <mesh> has scale '1 0 1', expected factors of at least 0.000001, or as far "
            "below 0");
  EXPECT_EQ(with_shape("<mesh filename='m.stl' scale='1 1 1e12'/>"),
            "r.urdf: link 'arm': <mesh> has scale '1 1 1e12', expected factors in [-1e+06, 1e+06]");
  const std::string inertia = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
  EXPECT_EQ(with_collision(sphere_collision() + "<inertial><mass value='-2'/>" + inertia + "</inertial>"),
            "r.urdf: link 'arm': <mass> has value '-2', expected kilograms in [0, 1e+06]");
  EXPECT_EQ(with_collision(sphere_collision() + "<inertial><mass value='2'/></inertial>"),
            "r.urdf: link 'arm': <inertial> needs <mass> and <inertia>");
}

TEST_F(UrdfDocumentFile, ARevoluteJointWithGazebosLimitsTurnsWithoutEnd) {
  for (const std::string huge : {"1e+16", "1e10", "1.79769e+308"}) {
    EXPECT_EQ(
        with_joint("revolute", "<limit lower='-" + huge + "' upper='" + huge + "' effort='0' velocity='0'/>"),
        "accepted");
    const Robot robot = load_robot((folder_.path() / "r.urdf").string());
    EXPECT_TRUE(std::isinf(robot.joints[0].lower) && std::isinf(robot.joints[0].upper));
    EXPECT_EQ(check::model_of_file(robot).links.size(), 2u);
  }
}

TEST_F(UrdfDocumentFile, OnlyWholeDecimalNumbersCountWhateverTheLocale) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
  };
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  for (const std::string text : {"0,1", "0x1p-3", "1e999", "0.1m", "+-0.1", "0.1.1", "0.1 0.2", "", "inf"}) {
    EXPECT_EQ(
        with_shape("<sphere radius='" + std::string(text) + "'/>"),
        "r.urdf: link 'arm': <sphere> needs radius with 1 finite number, got '" + std::string(text) + "'");
  }
  for (const std::string text : {"${r}", "$(arg r)"})
    EXPECT_EQ(with_shape("<sphere radius='" + text + "'/>"),
              "r.urdf: link 'arm': <sphere> needs radius with 1 finite number, got '" + text +
                  "', which is xacro's: expected the file's name to end in .xacro, or what 'xacro FILE' "
                  "makes of it");
  EXPECT_EQ(
      with_shape("<sphere radius='0.1 '/>"),  // urdfdom would drop the body
      "r.urdf: link 'arm': <sphere> needs radius with 1 finite number and no blank after it, got '0.1 '");
  EXPECT_EQ(with_shape("<sphere radius=' 0.1'/>"), "accepted");
  EXPECT_EQ(with_joint("revolute",
                       "<limit lower='-1' upper='1' velocity='1' effort='1' acceleration='3 ' jerk='9 '/>"),
            "accepted");  // which urdfdom does not read
  EXPECT_EQ(with_shape("<box size='0.1 0.2.3'/>"),
            "r.urdf: link 'arm': <box> needs size with 3 finite numbers, got '0.1 0.2.3'");
  EXPECT_EQ(with_shape("<box size='0.1,0.2 3'/>"),  // urdfdom would drop the body
            "r.urdf: link 'arm': <box> needs size with 3 finite numbers, got '0.1,0.2 3'");
  EXPECT_EQ(with_shape("<box size=' +.1  2e-1 3. '/>"), "accepted");
  EXPECT_EQ(load_robot((folder_.path() / "r.urdf").string()).bodies[0].shape.edges(),
            Eigen::Vector3d(0.1, 0.2, 3.0));
  std::locale::global(before);
}

TEST_F(UrdfDocumentFile, WhatIsGivenTwiceOrHalfIsRefused) {
  EXPECT_EQ(with_joint("revolute", "<axis xyz='1 0 0'/>" + free_turn()),
            "r.urdf: joint 'j': two different <axis>, expected one");
  EXPECT_EQ(with_joint("revolute", "<axis xyz='0 0 1'/>" + free_turn()), "accepted");  // twice the same
  EXPECT_EQ(with_shape("<sphere radius='1'/><box size='1 1 1'/>"),
            "r.urdf: link 'arm': <geometry> holds two shapes, expected one");
  EXPECT_EQ(with_collision("<collision><origin xyz='0 0 1'/><origin xyz='0 0 2'/><geometry><sphere "
                           "radius='1'/></geometry></collision>"),
            "r.urdf: link 'arm': two different <origin>, expected one");
  EXPECT_EQ(folder_.refusal("<robot name='r'><link name='a'/><xacro:include filename='b'/></robot>"),
            "r.urdf: holds <xacro:include>, expected a URDF that xacro has expanded");
}

TEST_F(UrdfDocumentFile, EndlessFilesEndInASentenceSoon) {
  const auto begin = std::chrono::steady_clock::now();
  std::string nested = "<robot name='r'>";
  for (int i = 0; i < 200'000; ++i) nested += "<a>";
  EXPECT_EQ(folder_.refusal(nested), "r.urdf: nests its elements too deeply for a URDF");
  std::string chain = "<robot name='r'><link name='0'/>";
  for (int i = 1; i <= 50'000; ++i) {
    const std::string at = std::to_string(i), from = std::to_string(i - 1);
    chain += "<link name='" + at + "'/><joint name='" + at + "' type='fixed'><parent link='" + from +
             "'/><child link='" + at + "'/></joint>";
  }
  EXPECT_EQ(folder_.refusal(chain + "</robot>"), "r.urdf: has more than 500 joints");
  std::string bodies;
  for (int i = 0; i < 2'000; ++i) bodies += sphere_collision();
  EXPECT_EQ(with_collision(bodies), "r.urdf: has more than 1000 <collision> bodies");
  std::string vendor = "<robot name='r'>";
  for (int i = 0; i < 100'000; ++i) vendor += "<gazebo/>";
  EXPECT_EQ(folder_.refusal(vendor + two_links(sphere_collision(), "revolute", free_turn()).substr(16)),
            "accepted");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(seconds.count(), 10.0);
}

TEST_F(UrdfDocumentFile, WhatIsEchoedFromTheFileIsShortAndPlain) {
  const std::string name = std::string(5'000, 'n') + "\x1b[2J";
  const std::string sentence =
      folder_.refusal("<robot name='r'><link name='" + name + "'/><link name='" + name + "'/></robot>");
  EXPECT_LT(sentence.size(), 200u);
  EXPECT_EQ(sentence.find('\x1b'), std::string::npos);
  EXPECT_LT(with_joint("revolute", "<origin xyz='" + std::string(5'000, '1') + "'/>" + free_turn()).size(),
            250u);
}

TEST_F(UrdfDocumentFile, ADamagedMeshIsReportedWithItsLinkAndAsDamage) {
  folder_.write("m.stl", as_stl(ellipsoid(6, 8, {1, 1, 1})).substr(0, 300));
  EXPECT_EQ(with_shape("<mesh filename='m.stl'/>"),
            "damaged: r.urdf: link 'arm': 'm.stl' is damaged: its header counts other facets than it "
            "holds");
  EXPECT_EQ(with_shape("<mesh filename='r.urdf'/>"),
            "r.urdf: link 'arm': r.urdf: is not a mesh of a known kind, expected .dae, .obj, .ply or .stl");
}

// What robots of the field carry, in one file: comments, vendor elements, unused materials and visuals of all
// kinds, leftovers of xacro, mirrored meshes, a gripper that mimics, frames without bodies.
TEST_F(UrdfDocumentFile, RobotsOfTheFieldLoad) {
  folder_.write("hand.STL", as_stl(ellipsoid(6, 8, {100, 200, 300})));
  const std::string text = R"(<?xml version="1.0" ?>
<!-- =================== | generated by xacro from arm.xacro | EDITING THIS FILE BY HAND IS NOT RECOMMENDED -->
<robot name="arm" version="1.1" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="pi" value="3.14"/>
  <xacro:macro name="finger" params="side"><link name="${side}"/></xacro:macro>
  <material name="white"><color rgba="1 1 1 1"/></material>
  <gazebo reference="base_link"><material>Gazebo/White</material><collision/><limits/></gazebo>
  <gazebo><plugin filename="libgazebo_ros_control.so" name="control"/></gazebo>
  <ros2_control name="arm" type="system"><joint name="j1"><command_interface name="position"/></joint></ros2_control>
  <transmission name="t1"><type>transmission_interface/SimpleTransmission</type><joint name="j1"/></transmission>
  <sensor name="camera" type="camera" update_rate="20"><parent link="hand"/></sensor>
  <joint_properties damping="0.0" friction="0.0"/>
  <link name="world"/>
  <link name="base_link">
    <inertial><mass value="4.0"/><origin rpy="0 0 0" xyz="0 0 0"/>
      <inertia ixx="0.01" ixy="0.0" ixz="0.0" iyy="0.01" iyz="0.0" izz="0.01"/></inertial>
    <visual><origin xyz="0 0 0"/><geometry><mesh filename="package://nowhere/base.dae"/></geometry><material name="white"/></visual>
    <visual><geometry><capsule radius="0.1" length="0.2"/></geometry><material name="undefined"/></visual>
    <collision name="base_collision"><geometry><cylinder length="0.2" radius="0.1"/></geometry><verbose value="Yes"/></collision>
    <contact><lateral_friction value="1.0"/></contact>
    <self_collision_checking><origin xyz="0 0 0"/></self_collision_checking>
  </link>
  <link name="upper"><collision><origin xyz="0 0 0.3"/><geometry><box size="0.1 0.1 0.4"/></geometry></collision>
    <collision><geometry><sphere radius="0.06"/></geometry><contact_coefficients mu="0" kp="1000.0" kd="1.0"/></collision></link>
  <link name="hand"><collision><geometry><mesh filename="file://FOLDER/hand.STL" scale="0.001 -0.001 0.001"/></geometry></collision></link>
  <link name="left"><collision><geometry><box size="0.01 0.01 0.04"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.01 0.01 0.04"/></geometry></collision></link>
  <link name="tool0"/>
  <joint name="fix" type="fixed"><origin rpy="0 0 0" xyz="0 0 0"/><parent link="world"/><child link="base_link"/><axis xyz="0 0 0"/></joint>
  <joint name="j1" type="revolute"><parent link="base_link"/><child link="upper"/><origin rpy="1.5707963267948966 0 -3.14" xyz="0 0 0.089"/>
    <axis xyz="0 0 1"/><limit effort="150.0" lower="-6.283" upper="6.283" velocity="3.15" acceleration="2"/>
    <dynamics/><safety_controller k_velocity="0.0" k_position="20" soft_lower_limit="-6" soft_upper_limit="6"/>
    <calibration rising="0.0"/><joint_properties friction="1.0"/></joint>
  <joint name="j2" type="continuous"><parent link="upper"/><child link="hand"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit effort="150.0" velocity="3.15"/></joint>
  <joint name="finger" type="prismatic"><parent link="hand"/><child link="left"/><origin xyz="0 0.05 0.3"/><axis xyz="0 1 0"/>
    <limit effort="20" upper="0.04" velocity="0.2"/></joint>
  <joint name="finger2" type="prismatic"><parent link="hand"/><child link="right"/><origin xyz="0 -0.05 0.3"/><axis xyz="0 -1 0"/>
    <limit effort="20" lower="0.0" upper="0.04" velocity="0.2"/><mimic joint="finger"/></joint>
  <joint name="tip" type="fixed"><parent link="hand"/><child link="tool0"/></joint>
</robot>)";
  std::string placed = text;
  placed.replace(placed.find("FOLDER"), 6, folder_.path().string());
  EXPECT_EQ(folder_.refusal(placed), "accepted");
  const Robot robot = load_robot((folder_.path() / "r.urdf").string());
  EXPECT_EQ(robot.dof(), 3u);
  EXPECT_EQ(check::model_of_file(robot).links.size(), robot.links.size());  // the check's own reader
  ASSERT_EQ(robot.bodies.size(), 6u);
  EXPECT_NEAR(robot.bodies[3].shape.edges().z(), 0.6, 1e-6);
  EXPECT_EQ(robot.joints[2].lower, 0.0);
  // The right finger goes the other way.
  Configuration closed = Configuration::Zero(3), open = closed;
  open[2] = 0.04;
  const auto moved = [&](const std::string& part) {
    const auto body =
        std::find_if(robot.bodies.begin(), robot.bodies.end(), [&](const Body& b) { return b.part == part; });
    const auto link = static_cast<std::size_t>(body->link);
    return Eigen::Vector3d(forward_kinematics(robot, open)[link].translation() -
                           forward_kinematics(robot, closed)[link].translation());
  };
  EXPECT_NEAR((moved("left") + moved("right")).norm(), 0.0, 1e-12);
  EXPECT_NEAR(moved("left").norm(), 0.04, 1e-12);
}

/// The base of a humanoid or of a mobile robot hangs on a joint that no arm plans: it stands.
TEST_F(UrdfDocumentFile, ABaseThatFloatsOrDrivesStandsAndNothingElseMayFloat) {
  using namespace worlds;
  const auto text = [](const std::string& base, const std::string& wrist) {
    const std::string ball = "<sphere radius='0.1'/>";
    return "<robot name='r'><link name='map'/>" + urdf_link("torso", "0 0 0", ball) +
           urdf_link("upper", "0.3 0 0", ball) + urdf_link("hand", "0 0 0", ball) +
           urdf_joint("wrist", wrist, "upper", "hand", "0.6 0 0", "0 0 1", "") +
           urdf_joint("shoulder", "revolute", "torso", "upper", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
           urdf_joint("base", base, "map", "torso", "0 0 0.7", "0 0 1", "") + "</robot>";
  };
  for (const char* base : {"floating", "planar"}) {
    const Robot robot = load_robot(folder_.write("r.urdf", text(base, "fixed")));
    ASSERT_EQ(robot.dof(), 1U);
    EXPECT_EQ(robot.joints[0].name, "shoulder");
    EXPECT_EQ(forward_kinematics(robot, Configuration::Zero(1))[1].translation(), Eigen::Vector3d(0, 0, 0.7));
    EXPECT_EQ(check::model_of_file(robot).links.size(), robot.links.size());  // the check's own reader
    EXPECT_EQ(folder_.refusal(text("fixed", base)),
              "r.urdf: joint 'wrist': type '" + std::string(base) +
                  "' is supported of a base alone, where it stands still: expected no joint above it that "
                  "moves");
  }
}

/// As mobile robots have it: world, a fixed joint, the floor, a planar joint, the base.
TEST_F(UrdfDocumentFile, ABaseMayFloatOrDriveBehindJointsThatStand) {
  using namespace worlds;
  const std::string ball = "<sphere radius='0.1'/>";
  const auto text = [&](const std::string& first, const std::string& second) {
    return "<robot name='r'>" + urdf_link("torso", "0 0 0", ball) + urdf_link("upper", "0.3 0 0", ball) +
           "<link name='world'/><link name='floor'/>" +
           urdf_joint("shoulder", "revolute", "torso", "upper", "0 0 0", "0 0 1", urdf_limit(-1, 1)) +
           urdf_joint("drive", second, "floor", "torso", "0 0 0.7", "0 0 1", "") +
           urdf_joint("room", first, "world", "floor", "1 0 0", "0 0 1", urdf_limit(-1, 1)) + "</robot>";
  };
  for (const char* first : {"fixed", "planar", "floating"})
    for (const char* second : {"planar", "floating"}) {
      const Robot robot = load_robot(folder_.write("r.urdf", text(first, second)));
      ASSERT_EQ(robot.dof(), 1U);
      EXPECT_EQ(forward_kinematics(robot, Configuration::Zero(1))[2].translation(),
                Eigen::Vector3d(1, 0, 0.7));
      EXPECT_EQ(check::model_of_file(robot).links.size(), robot.links.size());  // the check's own reader
    }
  EXPECT_NE(folder_.refusal(text("prismatic", "planar"))
                .find("joint 'drive': type 'planar' is supported of a base"),
            std::string::npos);
}

/// As the URDF of the PR2 has it, which ROS ships in its tests.
TEST_F(UrdfDocumentFile, WhatOldAndConvertedFilesHoldIsRead) {
  using namespace worlds;
  const auto text = [](const std::string& limit) {
    return "<robot name='r'><link name='base'/>" + urdf_link("arm", "0.3 0 0", "<sphere radius='0.1'/>") +
           urdf_joint("j", "revolute", "base", "arm", "0 0 0", "0 0 1", limit) + "</robot>";
  };
  const std::string plain = "<limit lower='-1' upper='1' effort='9' velocity='2'/>";
  const auto speed = [&](const std::string& before, const std::string& limit) {
    const Robot robot = load_robot(folder_.write("r.urdf", before + text(limit)));
    EXPECT_EQ(check::model_of_file(robot).links.size(), robot.links.size());  // the check's own reader
    return robot.joints[0].max_velocity;
  };
  EXPECT_EQ(speed("<!-- | made by xacro | -->\n<!-- by hand: <robot> -->\n<?xml version=\"1.0\" ?>\n", plain),
            2.0);
  EXPECT_EQ(speed("", "<limit lower='-1' upper='1' effort='9' velocity='2' k_velocity='5'/>"), 2.0);
  EXPECT_EQ(speed("", "<limit lower='-1' upper='1' effort='-1' velocity='-1'/>"), 0.0);  // Gazebo: none
  EXPECT_EQ(folder_.refusal(text("<limit lower='-1' upper='1' effort='9' k_velocity='5'/>")),
            "r.urdf: joint 'j': <limit> has an unknown attribute 'k_velocity', did you mean 'velocity'?");
  EXPECT_EQ(folder_.refusal(text(plain) + "<?xml version=\"1.0\" ?>"),
            "r.urdf: is not well-formed XML, line 1");
  EXPECT_EQ(folder_.refusal("<robot\n name='\n\nr'>\n<link></robot>"),
            "r.urdf: is not well-formed XML, line 5");
}

}  // namespace urdf_document_test
}  // namespace clearway
