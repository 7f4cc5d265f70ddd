#include "planning/robot/load.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>
#include <set>

#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/problem/path_cost.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot/self_collision.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/part_policies.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace load_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

Load can(const std::string& link) {
  Load load;
  load.name = "can";
  load.link = link;
  load.link_from_load =
      Eigen::Translation3d(0.0, 0.02, 0.2) * Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX());
  load.shape = Shape::cylinder(0.03, 0.12);
  load.mass = 0.4;
  return load;
}

TEST(Load, RidesWhereItsLinkTakesIt) {
  Random random(1);
  const Robot robot = load_robot("panda"), loaded = with_load(robot, can("hand"));
  ASSERT_EQ(loaded.bodies.size(), robot.bodies.size() + 1);
  ASSERT_EQ(loaded.links.back().name, "can");
  const Body& body = loaded.bodies.back();
  for (int i = 0; i < 20; ++i) {
    const Configuration q = random.configuration(robot);
    const LinkPoses before = forward_kinematics(robot, q), after = forward_kinematics(loaded, q);
    for (std::size_t link = 0; link < before.size(); ++link)
      ASSERT_EQ(before[link].matrix(), after[link].matrix());
    const Eigen::Isometry3d expected = before.back() * can("hand").link_from_load;
    EXPECT_TRUE((after.back() * body.link_from_shape).isApprox(expected, 1e-12));
  }
  for (int i = 0; i < 2000; ++i) {  // the spheres hold the shape
    const Eigen::Vector3d point = body.shape.support(random.point(1.0)) * random.unit();
    bool is_held = false;
    for (const Sphere& sphere : body.cover)
      is_held = is_held || (sphere.center - point).norm() <= sphere.radius * (1.0 + 1e-9);
    ASSERT_TRUE(is_held);
  }
}

TEST(Load, MayTouchWhatHoldsItAndNothingElse) {
  const Robot robot = load_robot("arm6");
  for (const bool touches : {false, true}) {
    Load load = can("hand");
    if (touches) load.touches = {"link5"};
    const Robot loaded = with_load(robot, load);
    const int index = static_cast<int>(loaded.bodies.size()) - 1;
    std::set<std::string> tested, own;
    for (const BodyPair& pair : self_collision_pairs(loaded))
      if (pair.second == index) tested.insert(loaded.bodies[static_cast<std::size_t>(pair.first)].part);
    for (const Body& body : robot.bodies) own.insert(body.part);
    own.erase("hand");
    own.erase("link6");  // the hand is fixed on it: nothing moves the load against it
    if (touches) own.erase("link5");
    EXPECT_EQ(tested, own);
  }
}

int index_of(const Robot& robot, const std::string& link) {
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == link) return static_cast<int>(i);
  return -1;
}

TEST(Load, IsHeldByTheJointsThatMoveFingersAlone) {
  const worlds::UrdfRobot made = worlds::gripper();
  Robot robot = made.robot();
  robot.tip_link = index_of(robot, "tcp");
  ASSERT_EQ(robot.joints[4].name, "grip");
  const auto grip = [&](const std::string& link, const std::vector<std::string>& touches) {
    Load load = can(link);
    load.touches = touches;
    return grip_joints(robot, load);
  };
  const std::vector<int> fingers{4}, none;
  EXPECT_EQ(grip("palm", {"left", "right"}), fingers);
  EXPECT_EQ(grip("tcp", {"left"}), fingers);  // the other one moves with it, whatever it holds
  EXPECT_EQ(grip("tcp", {"left", "right"}), fingers);
  EXPECT_EQ(grip("left", {"right", "palm"}), fingers);
  EXPECT_EQ(grip("palm", {"mast", "left", "right"}), fingers);
  EXPECT_EQ(grip("palm", {}), none);
  EXPECT_EQ(grip("palm", {"mast"}), none);
  EXPECT_EQ(grip("base", {"left", "right"}), none);  // it stands
  robot.tip_link = index_of(robot, "left");          // as the last link of a file may be
  EXPECT_EQ(grip("palm", {"left", "right"}), fingers);
  EXPECT_EQ(grip("palm", {"mast"}), none);
  robot.tip_link = index_of(robot, "tcp");
  Load load = can("palm");
  load.touches = {"left", "right"};
  const Robot loaded = with_load(robot, load);
  const Configuration q = Configuration::Constant(5, 0.03);
  const Robot still = with_still_grip(loaded, q);
  EXPECT_EQ(still.joints[4].lower, 0.03);
  EXPECT_EQ(still.joints[4].upper, 0.03);
  EXPECT_EQ(still.joints[3].lower, robot.joints[3].lower);
  const Configuration too_wide = Configuration::Constant(5, 0.0401);  // stays out of limits
  EXPECT_EQ(with_still_grip(loaded, too_wide).joints[4].upper, robot.joints[4].upper);
  Configuration other = q;
  other[2] = 0.5;
  EXPECT_EQ(grip_violation(loaded, q, other), "");
  EXPECT_EQ(grip_violation(robot, q, other), "");
  other[4] = 0.02;
  EXPECT_EQ(grip_violation(loaded, q, other),
            "joint 'grip' holds load 'can' and cannot move from 0.03 to 0.02 while it rides");
}

/// A gripper whose knuckles bear the fingers, as Robotiq's do, on one of two arms; the other one has the tip.
TEST(Load, IsHeldByJointsThatMoveMoreThanFingersAndByNoWrist) {
  const std::string ball = "<sphere radius='0.02'/>";
  std::string text = urdf_link("base", "0 0 0", ball);
  const auto add = [&](const std::string& joint, const std::string& type, const std::string& parent,
                       const std::string& child, const std::string& inside = "") {
    text += urdf_link(child, "0 0 0", ball) + urdf_joint(joint, type, parent, child, "0 0 0.1", "0 1 0",
                                                         type == "fixed" ? "" : urdf_limit(-1, 1) + inside);
  };
  for (const std::string side : {"l", "r"}) {
    add(side + "j1", "revolute", "base", side + "1");
    add(side + "j2", "revolute", side + "1", side + "2");
    add(side + "j3", "revolute", side + "2", side + "3");
  }
  add("mount", "fixed", "l3", "hand");
  add("finger_joint", "revolute", "hand", "knuckle");
  add("other_joint", "revolute", "hand", "other_knuckle", "<mimic joint='finger_joint' multiplier='-1'/>");
  add("f1", "fixed", "knuckle", "finger");
  add("f2", "fixed", "other_knuckle", "other_finger");
  add("p1", "revolute", "finger", "pad", "<mimic joint='finger_joint' multiplier='-1'/>");
  add("p2", "revolute", "other_finger", "other_pad", "<mimic joint='finger_joint' multiplier='1'/>");
  const worlds::UrdfRobot made("two_arms", text);
  Robot robot = made.robot();
  const auto joint_called = [&](const std::string& name) {
    for (std::size_t j = 0; j < robot.dof(); ++j)
      if (robot.joints[j].name == name) return static_cast<int>(j);
    return -1;
  };
  const auto grip = [&](const std::string& link, const std::vector<std::string>& touches) {
    Load load = can(link);
    load.touches = touches;
    const std::vector<int> found = grip_joints(robot, load);
    const Robot loaded = with_load(robot, load);
    EXPECT_EQ(check::KdlArm(loaded).joints_that_hold(loaded, load), found) << link;
    return found;
  };
  const std::vector<int> fingers{joint_called("finger_joint")}, none;
  for (const char* tip : {"r3", "hand", "pad", "l3"}) {
    robot.tip_link = index_of(robot, tip);
    EXPECT_EQ(grip("hand", {"pad", "other_pad"}), fingers) << tip;
    EXPECT_EQ(grip("l3", {"pad", "other_pad", "finger", "other_finger"}), fingers) << tip;
    EXPECT_EQ(grip("hand", {}), none);
    EXPECT_EQ(grip("l3", {"r3"}), none) << tip;  // handed over from arm to arm
    EXPECT_EQ(grip("l3", {"base"}), none) << tip;
  }
  EXPECT_EQ(grip("l2", {"l3"}), none);  // the wrist moves the tip and no second finger
}

/// The planner's way to find them and the check's own.
TEST(Load, IsHeldByTheSameJointsForTheCheck) {
  Random random(7);
  const worlds::UrdfRobot gripper = worlds::gripper(), scissors = worlds::scissors(), whip = worlds::whip();
  std::vector<Robot> robots{gripper.robot(), scissors.robot(), whip.robot()};
  for (const char* name : {"panda", "arm6"}) robots.push_back(load_robot(name));
  std::size_t held = 0;
  for (int i = 0; i < 400; ++i) {
    Robot robot = robots[static_cast<std::size_t>(i) % robots.size()];
    const auto any = [&] {
      return static_cast<std::size_t>(random.between(0.0, static_cast<double>(robot.links.size()) - 1e-9));
    };
    if (i % 3 == 0) robot.tip_link = static_cast<int>(any());
    Load load = can(robot.links[any()].name);
    for (double share = random.unit(); random.unit() < 0.7 && share < 0.9;)
      load.touches.push_back(robot.links[any()].name);
    const Robot loaded = with_load(robot, load);
    const std::vector<int> expected = grip_joints(loaded, load);
    EXPECT_EQ(check::KdlArm(loaded).joints_that_hold(loaded, load), expected) << i << " " << robot.name;
    EXPECT_EQ(grip_joints(robot, load), expected);
    held += expected.size();
  }
  EXPECT_GT(held, 20U);
}

/// A load whose centre is at the tip costs what a payload there costs, whatever the scale.
/// However the hand moves: it opens or it closes.
TEST(Load, IsHeldWhileTheFingersMoveByRoundingAtMostEitherWay) {
  Load held = can("palm");
  held.touches = {"left", "right"};
  const Robot robot = with_load(worlds::gripper().robot(), held);
  const auto moved = [&](double grip, double along) {
    const Configuration from = (Configuration(5) << 0.0, 0.0, 0.3, 0.0, 0.02).finished();
    Configuration to = from;
    to[4] += grip, to[0] += along;
    return grip_violation(robot, from, to);
  };
  for (const double grip : {0.0, 0.9e-6, -0.9e-6}) EXPECT_EQ(moved(grip, 0.3), "") << grip;
  for (const double grip : {1.1e-6, -1.1e-6, 0.01, -0.01})
    EXPECT_NE(moved(grip, 0.0).find("joint 'grip' holds load 'can' and cannot move"), std::string::npos)
        << grip;
}

/// Within 1e-6 m and kg.
TEST(Load, IsTheSameByNameHoldersPlaceShapeAndMass) {
  const auto same = [](const std::function<void(Load&)>& change) {
    Load other = can("hand");
    change(other);
    EXPECT_EQ(is_same(can("hand"), other), is_same(other, can("hand")));
    return is_same(can("hand"), other);
  };
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(same([&](Load& load) { load.mass += sign * 0.9e-6; }));
    EXPECT_FALSE(same([&](Load& load) { load.mass += sign * 1.1e-6; }));
    EXPECT_TRUE(same([&](Load& load) { load.link_from_load.translation().y() += sign * 0.9e-6; }));
    EXPECT_FALSE(same([&](Load& load) { load.link_from_load.translation().y() += sign * 1.1e-6; }));
    EXPECT_FALSE(same([&](Load& load) { load.shape = Shape::cylinder(0.03 + sign * 3e-6, 0.12); }));
  }
  EXPECT_FALSE(same([](Load& load) { load.name = "jar"; }));
  EXPECT_FALSE(same([](Load& load) { load.link = "palm"; }));
  EXPECT_FALSE(same([](Load& load) { load.touches = {"palm"}; }));
  EXPECT_FALSE(same([](Load& load) { load.shape = Shape::capsule(0.03, 0.12); }));
}

/// Hulls of which one corner is elsewhere, or is missing, and which are as wide along each axis and diagonal.
TEST(Load, OfAnotherHullIsAnother) {
  const auto hull = [](std::optional<double> inside) {
    std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {0.3, 0.1, 0}, {0.1, 0.3, 0}, {0, 0, 0.1}};
    if (inside) corners.emplace_back(0.15, *inside, 0.0);  // the line from corner to corner is at 0.05
    Load load = can("hand");
    load.shape = Shape::convex(corners);
    return load;
  };
  EXPECT_TRUE(is_same(hull(0.04), hull(0.04)));
  EXPECT_FALSE(is_same(hull(0.04), hull(0.035)));
  EXPECT_FALSE(is_same(hull(0.04), hull(std::nullopt)));
}

TEST(Load, WeighsAsAPayloadAtItsPlace) {
  Random random(2);
  for (const double scale : {1.0, 0.1}) {
    const Robot robot = scaled(load_robot("puma560"), scale);
    Load load = can("tool");
    load.link_from_load = robot.link_from_tip;
    const PathCost with_payload(robot, {.payload_mass = 0.4}), loaded(with_load(robot, load));
    for (int i = 0; i < 20; ++i) {
      const Configuration q = random.configuration(robot);
      EXPECT_TRUE(with_payload.generalized_forces(q).isApprox(loaded.generalized_forces(q), 1e-9));
    }
  }
}

TEST(Load, ScalesWithItsRobotThereAndBack) {
  const Robot loaded = with_load(load_robot("arm6"), can("hand"));
  const Robot back = scaled(scaled(loaded, 0.1), 10.0);
  EXPECT_TRUE(is_same(back.loads.front(), loaded.loads.front()));
  EXPECT_NEAR(scaled(loaded, 0.1).loads.front().shape.radius(), 0.003, 1e-15);
  EXPECT_NEAR(back.bodies.back().shape.length(), 0.12, 1e-12);
}

TEST(Load, LiesInWhatItsHoldersMustLieIn) {
  const VoxelScene scene{0.05, {}, {{{0.0, 0.0, 0.0}, 0.5}}, {"hand"}};
  const Snapshot map = scene.snapshot();
  const Robot loaded = with_load(load_robot("arm6"), can("hand"));
  EXPECT_EQ(part_policies(loaded, map, {}).at("can"), Policy::painted);
  EXPECT_EQ(part_requirement(loaded, map, "can", Policy::painted).volumes, map.volumes_of_part("hand"));
  EXPECT_EQ(part_policies(loaded, map, {.parts = {{"hand", Policy::known_free}}}).at("can"),
            Policy::known_free);
  EXPECT_EQ(part_policies(loaded, map, {.parts = {{"can", Policy::not_occupied}}}).at("can"),
            Policy::not_occupied);
  Load touching = can("link3");
  touching.touches = {"hand"};
  EXPECT_EQ(part_policies(with_load(load_robot("arm6"), touching), map, {}).at("can"), Policy::painted);
  EXPECT_EQ(part_policies(with_load(load_robot("arm6"), can("link3")), map, {}).at("can"),
            Policy::not_occupied);
  const Robot gripper = worlds::gripper().robot();  // whose tcp is a frame on the palm
  EXPECT_EQ(
      part_policies(with_load(gripper, can("tcp")), map, {.parts = {{"palm", Policy::painted}}}).at("can"),
      Policy::painted);
}

TEST(Load, RidesOnItsLegsAlone) {
  const Robot robot = load_robot("arm6");
  const std::vector<LegLoad> loads = {{can("hand"), {1}}};
  EXPECT_EQ(robot_of_leg(robot, loads, 0).loads.size(), 0U);
  EXPECT_EQ(robot_of_leg(robot, loads, 1).loads.size(), 1U);
  EXPECT_EQ(robot_of_leg(robot, {{can("hand"), {}}}, 7).loads.size(), 1U);
}

/// A sentence names what is wrong.
TEST(Load, RefusesWhatNoRobotCanCarry) {
  const Robot robot = load_robot("arm6");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto sentence = [&](const std::function<void(Load&)>& spoil) {
    Load load = can("hand");
    spoil(load);
    try {
      with_load(robot, load);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto names = [&](const std::string& word, const std::function<void(Load&)>& spoil) {
    EXPECT_NE(sentence(spoil).find(word), std::string::npos) << sentence(spoil);
  };
  names("did you mean 'hand'?", [](Load& load) { load.link = "hadn"; });
  names("touches: robot 'arm6' has no link 'fingr'", [](Load& load) { load.touches = {"fingr"}; });
  names("has a link of that name", [](Load& load) { load.name = "link3"; });
  names("expected a name of letters", [](Load& load) { load.name = "a can"; });
  names("expected a name of letters", [](Load& load) { load.name = ""; });
  names("mass", [&](Load& load) { load.mass = nan; });
  names("mass", [](Load& load) { load.mass = -1.0; });
  names("pose", [&](Load& load) { load.link_from_load.translation().x() = nan; });
  names("pose", [](Load& load) { load.link_from_load.linear() *= 1.1; });
  names("pose", [](Load& load) { load.link_from_load.linear().col(0) *= -1.0; });
  EXPECT_THROW(with_load(with_load(robot, can("hand")), can("hand")), std::invalid_argument);
}

TEST(Load, OneInMillimetresIsTold) {
  Load load = can("hand");
  EXPECT_EQ(size_note(load), "");
  load.shape = Shape::box({60.0, 60.0, 120.0});
  EXPECT_EQ(size_note(load),
            "load 'can' is 147 m across: is it in millimetres? Loads are in metres, `scale: 0.001` makes a "
            "mesh so");
  const std::vector<std::string> notes = robot_notes(with_load(load_robot("arm6"), load));
  ASSERT_FALSE(notes.empty());
  EXPECT_EQ(notes.back(), size_note(load));
}

}  // namespace load_test
}  // namespace clearway
