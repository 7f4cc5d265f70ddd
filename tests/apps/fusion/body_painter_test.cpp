// A robot that is led by hand paints where it was, against its exact bodies at the joints that were true.

#include "apps/fusion/body_painter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "mapping/snapshot.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/datasets/complaint.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace body_painter_test {

TEST(InnerBalls, OfASphereAreTheSphereLessTheMargin) {
  const auto spheres = inner_spheres(Shape::sphere(0.1), 0.02);
  ASSERT_EQ(spheres.size(), 1U);
  EXPECT_LT(spheres[0].center.norm(), 1e-12);
  EXPECT_NEAR(spheres[0].radius, 0.08, 1e-8);
  EXPECT_TRUE(inner_spheres(Shape::sphere(0.02), 0.02).empty());
}

TEST(InnerBalls, LieInsideByTheMarginAndFillMostOfTheShape) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (const Shape& shape : {Shape::capsule(0.05, 0.2), Shape::cylinder(0.05, 0.2),
                             Shape::cylinder(0.1, 0.03), Shape::box({0.1, 0.2, 0.3})}) {
    for (const double margin : {0.0, 0.004}) {
      const auto spheres = inner_spheres(shape, margin);
      const Eigen::Vector3d reach = 0.5 * shape.bounds(Eigen::Isometry3d::Identity()).sizes();
      std::size_t inside = 0, filled = 0;
      for (int i = 0; i < 20000; ++i) {
        const Eigen::Vector3d way = Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
        const Sphere& sphere = spheres[static_cast<std::size_t>(i) % spheres.size()];
        EXPECT_LE(shape.signed_distance(sphere.center + sphere.radius * way), -margin);
        const Eigen::Vector3d point =
            reach.cwiseProduct(Eigen::Vector3d(unit(random), unit(random), unit(random)));
        if (shape.signed_distance(point) > -margin) continue;
        ++inside;
        filled += std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& other) {
          return (point - other.center).norm() <= other.radius;
        });
      }
      EXPECT_GT(filled, inside * 6 / 10) << static_cast<int>(shape.kind()) << ' ' << margin;
    }
  }
}

TEST(BodyPainter, PaintsOnlyWhereEachJointWasReadItself) {
  const Robot robot = load_robot("arm5");
  std::vector<std::string> rest;
  for (std::size_t i = 1; i < robot.dof(); ++i) rest.push_back(robot.joints[i].name);
  JointStream joints;  // the first joint has a publisher of its own
  for (const double time : {0.0, 0.4}) joints.add(time, {robot.joints[0].name}, {0.0});
  for (const double time : {0.0, 0.2, 0.4}) joints.add(time, rest, std::vector<double>(rest.size(), 0.1));
  for (const double time : {0.1, 0.2, 0.3}) joints.add(time, {"gripper"}, {0.5});
  clearway::Setup setup;
  setup.robot = RobotSetup{};
  setup.robot->name = "arm5";
  setup.robot->joint_error = setup.robot->place_error = 0.0;
  setup.robot->paints = {robot.bodies.back().part};
  setup.volumes = {{.label = "led", .critical_parts = {}}};
  const MovingRobot moving(*setup.robot, joints);
  EXPECT_EQ(moving.times({robot.bodies.size() - 1}), (std::vector<double>{0.0, 0.4}));
  FreeSpaceMap map(MapOptions{});
  map.add_volume("led", {});
  BodyPainter painter(setup, moving, map);
  painter.paint_until(0.0, 0.0, {});
  const std::size_t first = painter.spheres();
  EXPECT_GT(first, 0U);
  painter.paint_until(0.3, 0.0, {});
  EXPECT_EQ(painter.spheres(), first);
  painter.paint_until(1.0, 0.0, {});
  EXPECT_EQ(painter.spheres(), 2 * first);
}

class LedRobots : public ::testing::TestWithParam<const char*> {
 protected:
  LedRobots() : robot_(load_robot(GetParam())) {
    for (const Joint& joint : robot_.joints) names_.push_back(joint.name);
  }
  /// A slow way of the joints.
  Configuration place_at(double time) const {
    Configuration q(static_cast<Eigen::Index>(robot_.dof()));
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Joint& joint = robot_.joints[static_cast<std::size_t>(j)];
      const double low = std::max(joint.lower, -1.0), high = std::min(joint.upper, 1.0);
      q[j] = 0.5 * (low + high) + 0.3 * (high - low) * std::sin(0.5 * time + static_cast<double>(j));
    }
    return q;
  }
  /// The last part whose bodies have exact distances.
  std::string part() const {
    std::string part;
    for (const Body& body : robot_.bodies)
      if (body.shape.has_exact_distance() && body.shape.bounding_radius() > 0.04) part = body.part;
    return part;
  }

  const Robot robot_;
  std::vector<std::string> names_;
};

TEST_P(LedRobots, PaintOnlyWhatTheirPartTrulyFilledAndMostOfIt) {
  RobotSetup robot;
  robot.name = GetParam();
  robot.joint_error = 0.05 * std::numbers::pi / 180.0;
  robot.place_error = 0.002;
  robot.paints = {part()};
  clearway::Setup setup;
  setup.robot = robot;
  setup.volumes = {{.label = "led", .critical_parts = {}}};
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  JointStream joints;
  std::vector<LinkPoses> truth;
  std::vector<Eigen::Vector3d> shifts;
  for (int i = 0; i < 12; ++i) {
    const Configuration q = place_at(0.3 * i);
    Configuration is = q;
    for (double& joint : is) joint += robot.joint_error * unit(random);
    joints.add(10.0 + 0.3 * i, names_, {q.begin(), q.end()});
    truth.push_back(forward_kinematics(robot_, is));
    shifts.push_back(robot.place_error *
                     Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized());
  }
  MapOptions options;
  options.resolution = 0.01;
  FreeSpaceMap map(options);
  map.add_volume("led", {});
  const MovingRobot moving(robot, joints);
  BodyPainter painter(setup, moving, map);
  painter.paint_until(11.0, 10.0, std::nullopt);
  painter.paint_until(100.0, 10.0, std::nullopt);
  EXPECT_GT(painter.spheres(), 12U);
  const auto is_filled = [&](const Eigen::Vector3d& point) {
    for (std::size_t i = 0; i < truth.size(); ++i)
      for (const Body& body : robot_.bodies)
        if (body.part == part() &&
            body.shape.signed_distance(
                (truth[i][static_cast<std::size_t>(body.link)] * body.link_from_shape).inverse() *
                (point - shifts[i])) <= 1e-9)
          return true;
    return false;
  };
  std::size_t painted = 0;
  const Snapshot snapshot = map.snapshot();
  snapshot.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::painted) return;
    painted += static_cast<std::size_t>(std::pow(std::lround(leaf.size / options.resolution), 3));
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d side(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      EXPECT_TRUE(is_filled(leaf.center + leaf.size * side)) << leaf.center.transpose();
    }
  });
  EXPECT_GT(painted, 20U);
}

INSTANTIATE_TEST_SUITE_P(Shipped, LedRobots, ::testing::Values("puma560", "arm5", "arm6"));

TEST(BodyPainter, PaintsOnlyInTheTimeOfAVolumeOrOfABrush) {
  const Robot robot = load_robot("arm5");
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  JointStream joints;
  for (int i = 0; i <= 10; ++i) joints.add(i, names, std::vector<double>(robot.dof(), 0.02 * i));
  clearway::Setup setup;
  setup.robot = RobotSetup{};
  setup.robot->name = "arm5";
  setup.robot->joint_error = 0.0;
  setup.robot->paints = {robot.bodies.back().part};
  setup.volumes = {{.label = "led", .critical_parts = {}, .from = 3.0, .to = 5.0}};
  const MovingRobot moving(*setup.robot, joints);
  const auto spheres = [&](const std::optional<Brush>& brush) {
    FreeSpaceMap map(MapOptions{});
    map.add_volume("led", {});
    BodyPainter painter(setup, moving, map);
    painter.paint_until(8.5, 0.0, brush);
    return painter.spheres();
  };
  EXPECT_GT(spheres({}), 0U);
  EXPECT_EQ(spheres({}) % 3, 0U);  // at 3, 4 and 5 s
  EXPECT_EQ(spheres(Brush{Brush::Use::paints, 0}), 3 * spheres({}));
  EXPECT_EQ(spheres(Brush{}), 0U);
}

TEST(BodyPainter, NamesAPartThatCannotPaint) {
  const Robot robot = load_robot("arm5");
  JointStream joints;
  for (const Joint& joint : robot.joints) joints.add(0.0, {joint.name}, {0.0});
  clearway::Setup setup;
  setup.robot = RobotSetup{};
  setup.robot->name = "arm5";
  const auto complaint_of = [&](const std::string& part, double error) {
    setup.robot->paints = {part};
    setup.robot->place_error = error;
    const MovingRobot moving(*setup.robot, joints);
    FreeSpaceMap map(MapOptions{});
    return complaint([&] { const BodyPainter painter(setup, moving, map); });
  };
  EXPECT_NE(complaint_of("elbow_pad", 0.0).find("'elbow_pad' is none of robot"), std::string::npos);
  EXPECT_NE(complaint_of(robot.bodies.back().part, 1.0).find("larger than place_error"), std::string::npos);
  const std::string without_joints =
      complaint([] { parse_setup("robot: {name: arm5, paints: [hand]}", "s.yaml"); });
  EXPECT_NE(without_joints.find("joint_file or joint_topic"), std::string::npos) << without_joints;
}

}  // namespace body_painter_test
}  // namespace clearway
