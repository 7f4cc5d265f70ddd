// Goals of motion requests against what MoveIt's constraints mean (moveit_core/kinematic_constraints),
// written out here.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

#include "apps/problem_sets/planning_scene.hpp"

namespace clearway {
namespace motion_request_test {

constexpr double pi = std::numbers::pi;

ForeignProblem request_of(const std::string& goal, std::vector<std::string>& left_out) {
  ForeignWorld scene;
  scene.frames.place(
      "mount", Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.5 * pi, Eigen::Vector3d::UnitZ()));
  return read_motion_request("goal_constraints: [" + goal + "]", "r.yaml", {}, scene, left_out);
}

struct Asked {
  std::string region;     ///< "sphere", "box", "cylinder"
  Eigen::Vector3d sizes;  ///< as MoveIt has them
  Eigen::Vector3d center, offset;
  Eigen::Quaterniond turn;
  Eigen::Array3d tolerance;
  bool is_vector = false;
};

std::string list(std::initializer_list<double> values) {
  std::ostringstream text;
  text.precision(17);
  for (const double value : values) text << (text.tellp() > 0 ? ", " : "") << value;
  return "[" + text.str() + "]";
}

std::string goal_text(const Asked& asked) {
  const std::size_t count = asked.region == "sphere" ? 1 : asked.region == "cylinder" ? 2 : 3;
  std::string sizes = count == 1   ? list({asked.sizes[0]})
                      : count == 2 ? list({asked.sizes[0], asked.sizes[1]})
                                   : list({asked.sizes[0], asked.sizes[1], asked.sizes[2]});
  std::ostringstream text;
  text.precision(17);
  text << "{position_constraints: [{link_name: hand, header: {frame_id: world}, target_point_offset: "
       << list({asked.offset.x(), asked.offset.y(), asked.offset.z()})
       << ", constraint_region: {primitives: [{type: " << asked.region << ", dimensions: " << sizes
       << "}], primitive_poses: [{position: " << list({asked.center.x(), asked.center.y(), asked.center.z()})
       << "}]}}], orientation_constraints: [{link_name: hand, orientation: "
       << list({asked.turn.x(), asked.turn.y(), asked.turn.z(), asked.turn.w()})
       << ", absolute_x_axis_tolerance: " << asked.tolerance[0]
       << ", absolute_y_axis_tolerance: " << asked.tolerance[1]
       << ", absolute_z_axis_tolerance: " << asked.tolerance[2]
       << ", parameterization: " << (asked.is_vector ? 1 : 0) << "}]}";
  return text.str();
}

bool is_in_region(const Asked& asked, const Eigen::Vector3d& point) {
  constexpr double slack = 1e-9;
  const Eigen::Vector3d p = point - asked.center;
  if (asked.region == "sphere") return p.norm() <= asked.sizes[0] + slack;
  if (asked.region == "box") return (p.cwiseAbs() - 0.5 * asked.sizes).maxCoeff() <= slack;
  return std::hypot(p.x(), p.y()) <= asked.sizes[1] + slack &&
         std::abs(p.z()) <= 0.5 * asked.sizes[0] + slack;
}

/// The angles of R = Rx Ry Rz, or its vector.
Eigen::Array3d turned_by(const Eigen::Matrix3d& r, bool is_vector) {
  if (is_vector) {
    const Eigen::AngleAxisd turn(r);
    return turn.angle() * turn.axis().array();
  }
  return {std::atan2(-r(1, 2), r(2, 2)), std::asin(std::clamp(r(0, 2), -1.0, 1.0)),
          std::atan2(-r(0, 1), r(0, 0))};
}

Asked random_goal(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const std::array<const char*, 3> regions{"sphere", "box", "cylinder"};
  Asked asked;
  asked.region = regions[random() % 3];
  for (int i = 0; i < 3; ++i) {
    asked.sizes[i] = uniform(0.001, 0.4);
    asked.center[i] = uniform(-2.0, 2.0);
    asked.offset[i] = random() % 2 == 0 ? 0.0 : uniform(-0.3, 0.3);
    const double kinds[] = {0.0, uniform(0.001, 0.3), uniform(0.3, 3.1), pi, 2.0 * pi};
    asked.tolerance[i] = kinds[random() % 5];
  }
  asked.turn = Eigen::Quaterniond::UnitRandom();
  asked.is_vector = random() % 2 == 0;
  return asked;
}

TEST(MotionRequest, PosesThatAGoalOfConstraintsAllowsKeepAllOfThem) {
  std::mt19937 random(5);
  int free_axes = 0, looked_at = 0;
  for (int i = 0; i < 400; ++i) {
    const Asked asked = random_goal(random);
    std::vector<std::string> left_out;
    const ForeignProblem problem = request_of(goal_text(asked), left_out);
    ASSERT_EQ(problem.goals.size(), 1U);
    ASSERT_TRUE(problem.goals[0].pose);
    EXPECT_TRUE(left_out.empty());
    const ForeignPose& pose = *problem.goals[0].pose;
    EXPECT_EQ(pose.link, "hand");
    free_axes += pose.pose.free_axis.has_value();
    for (const Eigen::Isometry3d& map_from_tip : poses_of(pose.pose, 40)) {
      const Eigen::Isometry3d map_from_link = map_from_tip * Eigen::Translation3d(-pose.point);
      EXPECT_TRUE(is_in_region(asked, map_from_link * asked.offset)) << goal_text(asked);
      const Eigen::Array3d turn =
          turned_by(asked.turn.toRotationMatrix().transpose() * map_from_link.linear(), asked.is_vector);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(asked.tolerance[axis] >= pi || std::abs(turn[axis]) <= asked.tolerance[axis] + 1e-6)
            << goal_text(asked) << "\n"
            << turn.transpose();
      ++looked_at;
    }
  }
  EXPECT_GT(free_axes, 100);
  EXPECT_GT(looked_at, 10'000);
}

/// What is allowed is found: an axis that is free, tolerances as wide as they are stated.
TEST(MotionRequest, ToleranceOfARegionAndOfAxesAreAsWideAsTheyAre) {
  Asked asked{"sphere",          {0.02, 0, 0}, {1, 0, 0}, {0, 0, 0.1}, Eigen::Quaterniond::Identity(),
              {0.1, 0.2, 2 * pi}};
  std::vector<std::string> left_out;
  const ForeignPose upright = *request_of(goal_text(asked), left_out).goals[0].pose;
  EXPECT_EQ(upright.pose.position_tolerance, 0.02);
  EXPECT_EQ(upright.pose.free_axis, 2);
  EXPECT_EQ(upright.pose.turn_tolerance, 0.1);
  EXPECT_EQ(upright.point, Eigen::Vector3d(0, 0, 0.1));
  asked.tolerance = {pi, pi, pi};
  const ForeignPose any = *request_of(goal_text(asked), left_out).goals[0].pose;
  EXPECT_FALSE(any.pose.free_axis);
  EXPECT_EQ(any.pose.turn_tolerance, pi);
  asked.tolerance = {0.3, 0.1, 0.2};
  EXPECT_EQ(request_of(goal_text(asked), left_out).goals[0].pose->pose.turn_tolerance, 0.1);
}

TEST(MotionRequest, FramesThatStandStillAreTheMaps) {
  std::vector<std::string> left_out;
  const std::string goal =
      "{position_constraints: [{link_name: hand, header: {frame_id: /mount}, constraint_region: {primitives: "
      "[{type: 2, dimensions: [0.01]}], primitive_poses: [{position: {x: 1, y: 0, z: 0.5}}]}}], "
      "orientation_constraints: [{link_name: hand, header: {frame_id: mount}, orientation: {w: 1}}]}";
  const ForeignPose pose = *request_of(goal, left_out).goals[0].pose;
  EXPECT_TRUE(pose.pose.map_from_tip.translation().isApprox(Eigen::Vector3d(1.0, 3.0, 3.5), 1e-12));
  EXPECT_TRUE(
      (pose.pose.map_from_tip.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(MotionRequest, GoalsThatAreNoPoseOfALinkAreLeftOutAndSaidToBe) {
  const std::string region =
      "constraint_region: {primitives: [{type: sphere, dimensions: [0.1]}], primitive_poses: [{}]}";
  const std::string at = "{link_name: hand, " + region + "}";
  for (const auto& [goal, expected] :
       {std::pair<std::string, std::string>{"{orientation_constraints: [{link_name: hand}]}",
                                            "r.yaml: a goal of an orientation alone"},
        {"{position_constraints: [" + at + ", {link_name: arm, " + region + "}]}",
         "r.yaml: a goal that places several links, or one link twice"},
        {"{position_constraints: [" + at + "], orientation_constraints: [{link_name: arm}]}",
         "r.yaml: a goal that places several links, or one link twice"},
        {"{position_constraints: [{link_name: hand, header: {frame_id: tray}, " + region + "}]}",
         "r.yaml: a goal in frame 'tray', which is unknown, expected one of mount, map, odom, world"},
        {"{position_constraints: [{link_name: hand, constraint_region: {meshes: [{}]}}]}",
         "r.yaml: a goal whose region is no box, sphere or cylinder"},
        {"{visibility_constraints: [{sensor: a}], position_constraints: [" + at + "]}",
         "r.yaml: visibility_constraints of a goal"},
        {"{joint_constraints: [{joint_name: a, position: 1}], orientation_constraints: [{link_name: hand}]}",
         "r.yaml: a goal of an orientation and of joint values"}}) {
    std::vector<std::string> left_out;
    const ForeignProblem problem = request_of(goal, left_out);
    ASSERT_EQ(left_out.size(), 1U) << goal;
    EXPECT_EQ(left_out[0], expected);
    EXPECT_EQ(problem.goals.size(), expected.ends_with("constraints of a goal") ? 1U : 0U);
  }
}

TEST(MotionRequest, JointsAndAPoseAndAllRegionsOfAPositionAreRead) {
  std::vector<std::string> left_out;
  const ForeignProblem problem = request_of(
      "{joint_constraints: [{joint_name: a, position: 1, tolerance_below: 0.1, tolerance_above: 0.2}, "
      "{joint_name: a, position: 1.1}], position_constraints: [{link_name: hand, constraint_region: "
      "{primitives: [{type: sphere, dimensions: [0.1]}, {type: box, dimensions: [1, 0.4, 2]}], "
      "primitive_poses: [{position: [1, 0, 0]}, {position: [0, 2, 0]}]}}]}",
      left_out);
  EXPECT_EQ(left_out, std::vector<std::string>{
                          "r.yaml: tolerance_below and tolerance_above of goal_constraints[0] for a: "
                          "its position alone is the goal, or the nearest that is allowed"});
  left_out.clear();
  request_of(
      "{joint_constraints: [{joint_name: a, position: 1, tolerance_below: 0.001, tolerance_above: 1e-4}]}",
      left_out);
  EXPECT_TRUE(left_out.empty());
  ASSERT_EQ(problem.goals.size(), 2U);
  for (const ForeignGoal& goal : problem.goals) {
    EXPECT_EQ(goal.joints.by_joint, (std::map<std::string, double>{{"a", 1.0}}));
    ASSERT_EQ(goal.bands.size(), 2U);
    EXPECT_EQ(goal.bands[0].below, 0.1);
    EXPECT_EQ(goal.bands[0].above, 0.2);
    EXPECT_EQ(goal.bands[1].position, 1.1);
    ASSERT_TRUE(goal.pose);
  }
  EXPECT_EQ(problem.goals[0].pose->pose.map_from_tip.translation(), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(problem.goals[0].pose->pose.position_tolerance, 0.1);
  EXPECT_EQ(problem.goals[1].pose->pose.map_from_tip.translation(), Eigen::Vector3d(0, 2, 0));
  EXPECT_EQ(problem.goals[1].pose->pose.position_tolerance, 0.2);
}

}  // namespace motion_request_test
}  // namespace clearway
