#include "apps/check/trajectory_slack.hpp"

#include <gtest/gtest.h>

#include <random>

#include "apps/check/trajectory_plan.hpp"
#include "planning/robot/held_joints.hpp"
#include "planning/robot/kinematics.hpp"
#include "tests/apps/check/check_command.hpp"
#include "tests/worlds/urdf_robots.hpp"

namespace clearway {
namespace check_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

/// A tower that turns, on it an arm of two links, the second of which follows the first five times as far.
const worlds::UrdfRobot& crane() {
  static const std::string rod = "<capsule radius='0.05' length='0.8'/>";
  static const worlds::UrdfRobot robot(
      "crane", urdf_link("foot", "0 0 0", "<sphere radius='0.1'/>") + urdf_link("tower", "0.2 0 0", rod) +
                   urdf_link("boom", "0.5 0.1 0", rod) + urdf_link("jib", "0.5 0 0", rod) +
                   urdf_joint("slew", "revolute", "foot", "tower", "0 0 0.2", "0 0 1", urdf_limit(-3, 3)) +
                   urdf_joint("luff", "revolute", "tower", "boom", "0.3 0 0.5", "0 1 0", urdf_limit(-1, 1)) +
                   urdf_joint("follow", "revolute", "boom", "jib", "1 0 0", "0 1 0",
                              urdf_limit(-6, 6) + "<mimic joint='luff' multiplier='5' offset='0.1'/>"));
  return robot;
}

/// How far the centres of bodies are apart.
double apart(const Robot& a, const Configuration& qa, const Robot& b, const Configuration& qb) {
  const LinkPoses here = forward_kinematics(a, qa), there = forward_kinematics(b, qb);
  double most = 0.0;
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const auto link = static_cast<std::size_t>(a.bodies[i].link);
    const Eigen::Vector3d ours = here[link] * a.bodies[i].link_from_shape.translation(),
                          theirs = there[link] * b.bodies[i].link_from_shape.translation();
    most = std::max(most, (ours - theirs).norm());
  }
  return most;
}

TEST(TrajectorySlack, BoundsHowFarBodiesAreFromWhereAHeldJointIsJudged) {
  const Robot& whole = crane().robot();
  const Robot judged = with_held_joints(whole, {{"slew", 0.3}}, "test");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> angle(-1.0, 1.0), beside(-1e-4, 1e-4);
  for (int i = 0; i < 100; ++i) {
    const double slew = 0.3 + beside(random), luff = angle(random);
    const ForeignTrajectory trajectory{{"slew", "luff"}, {{slew, luff}}};
    const double slack = slack_of({trajectory}, judged, judged.map_from_base);
    const double moved =
        apart(judged, Eigen::VectorXd::Constant(1, luff), whole, Eigen::Vector2d(slew, luff));
    EXPECT_GE(slack, moved);
    EXPECT_LE(slack, 4.0 * std::abs(slew - 0.3));  // the jib's end is 2.3 m from the tower
    ForeignTrajectory before{{"luff"}, {{luff}}};
    before.start = {{"slew", slew}};
    EXPECT_EQ(slack_of({before}, judged, judged.map_from_base), slack);
  }
}

TEST(TrajectorySlack, IsOfFollowersAndTheirRatesAndOfTheBase) {
  const Robot& robot = crane().robot();
  ForeignTrajectory exact{{"luff", "slew", "follow"}, {{0.2, 0.0, 1.1}, {0.4, 0.0, 2.1}}};
  EXPECT_LT(slack_of({exact}, robot, robot.map_from_base), 1e-12);
  ForeignTrajectory beside = exact;
  beside.points[1][2] += 3e-4;
  const double slack = slack_of({exact, beside}, robot, robot.map_from_base);
  EXPECT_GE(slack, 3e-4);  // the jib's end is 0.95 m from its joint
  EXPECT_LE(slack, 4e-4);
  ForeignTrajectory before = exact;  // where both stand before it, and where the file says it of one alone
  before.stated_start = {{"luff", 0.3}, {"follow", 1.6 - 3e-4}};
  EXPECT_NEAR(slack_of({before}, robot, robot.map_from_base), slack, 1e-9);
  before.stated_start = {{"follow", 1.1 - 3e-4}};
  EXPECT_NEAR(slack_of({before}, robot, robot.map_from_base), slack, 1e-9);
  // A cubic between equal points whose ends run 1e-3 too fast, apart, is 1e-3 * 2 s / 4 beside at most.
  ForeignTrajectory faster = exact;
  faster.times = {0.0, 2.0};
  faster.velocities = {{0.0, 0.0, 1e-3}, {0.0, 0.0, -1e-3}};
  EXPECT_GE(slack_of({faster}, robot, robot.map_from_base), 1e-3 * 2.0 / 4.0);
  // With their accelerations 1e-3 beside, equal, the quintic is 1e-3 * (2 s)^2 / 32 beside half way.
  ForeignTrajectory bent = faster;
  bent.velocities = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  bent.accelerations = {{0.0, 0.0, 1e-3}, {0.0, 0.0, 1e-3}};
  EXPECT_GE(slack_of({bent}, robot, robot.map_from_base), 1e-3 * 4.0 / 32.0);
  // From rest to the first point, which it passes 1e-3 too fast after 2 s: the cubic is 4 / 27 of both
  // beside.
  ForeignTrajectory late = faster;
  late.times = {2.0, 2.001};
  EXPECT_GE(slack_of({late}, robot, robot.map_from_base), 1e-3 * 2.0 * 4.0 / 27.0);
  ForeignTrajectory elsewhere = exact;
  elsewhere.map_from_base =
      Eigen::Translation3d(0, 0, 5e-5) * Eigen::AngleAxisd(5e-5, Eigen::Vector3d::UnitZ());
  EXPECT_GE(slack_of({elsewhere}, robot, robot.map_from_base), 5e-5 + 5e-5 * 2.3);
  EXPECT_LT(slack_of({elsewhere}, robot, *elsewhere.map_from_base), 1e-12);
}

TEST(TrajectorySlack, OfABaseInOneTrajectoryAndAJointInTheNextIsBoth) {
  const Robot& robot = crane().robot();
  ForeignTrajectory first{{"luff", "slew", "follow"}, {{0.2, 0.0, 1.1}}}, second = first;
  first.map_from_base = Eigen::Isometry3d(Eigen::Translation3d(0, 0, 5e-5));
  second.points[0][2] += 3e-4;
  const double both = slack_of({first, second}, robot, robot.map_from_base);
  EXPECT_NEAR(both,
              slack_of({first}, robot, robot.map_from_base) + slack_of({second}, robot, robot.map_from_base),
              1e-12);
}

TEST(TrajectorySlack, OfAJointThatRoundingTookBeyondItsLimitIsThatOfAllThatFollows) {
  const Robot& robot = crane().robot();
  const double beyond = robot.joints[1].upper + 3e-7;
  ForeignTrajectory trajectory{{"slew", "luff"}, {{0.1, beyond}, {0.1, 0.5}}};
  draw_to_limits(trajectory, robot);
  EXPECT_EQ(trajectory.points[0][1], robot.joints[1].upper);
  EXPECT_NE(drawn_notes({trajectory}).at(0).find("joint luff is beyond its limit by up to 3e-07"),
            std::string::npos);
  const double slack = slack_of({trajectory}, robot, robot.map_from_base);
  EXPECT_GE(slack,
            apart(robot, Eigen::Vector2d(0.1, beyond), robot, Eigen::Vector2d(0.1, robot.joints[1].upper)));
  EXPECT_LE(slack, 1e-5);
  trajectory = {{"slew", "luff"}, {{0.1, robot.joints[1].upper + 2e-6}}};
  draw_to_limits(trajectory, robot);
  EXPECT_TRUE(drawn_notes({trajectory}).empty());
}

TEST_F(Check, ATrajectoryALittleBesideIsPaddedByWhatThatMoves) {
  const std::string urdf = folder_.write("arm.urdf", worlds::arm_with_finger());
  const auto run = [&](double grip) {
    const Json message{{"joint_names", {"shoulder", "elbow", "grip"}},
                       {"points", {{{"positions", {0.0, 0.0, grip}}}, {{"positions", {0.1, 0.0, grip}}}}}};
    return run_command({"check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"),
                        "--robot", urdf, "--policy", "not_occupied", "--allow-outside", "all", "--fix",
                        "grip=0.05", "--json"});
  };
  const Json there = Json::parse(run(0.05).out), beside = Json::parse(run(0.05008).out);
  EXPECT_EQ(there["padding_m"], 0.001);
  EXPECT_NEAR(beside["padding_m"].get<double>(), 0.00108, 1e-9);
  EXPECT_NE(beside.dump().find("the padding is 0.08 mm larger"), std::string::npos) << beside.dump(1);
  EXPECT_EQ(run(0.0502).status, exit_bad_input);
}

}  // namespace check_test
}  // namespace clearway
