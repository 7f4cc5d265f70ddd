// Swept voxels against marking by brute force: every voxel near every body, at poses far closer than asked
// for, by the exact distance of shape and cube.
#include "planning/survey/swept_voxels.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/survey/voxel_marks.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace swept_voxels_test {

using Key = std::tuple<std::int64_t, std::int64_t, std::int64_t>;

Eigen::Vector3d center_of(const Key& key, double edge) {
  return edge * Eigen::Vector3d(static_cast<double>(std::get<0>(key)) + 0.5,
                                static_cast<double>(std::get<1>(key)) + 0.5,
                                static_cast<double>(std::get<2>(key)) + 0.5);
}

/// The voxels whose cubes, grown by `margin` on each side, a placed shape touches.
void mark_slowly(const Shape& shape, const Eigen::Isometry3d& pose, double edge, double margin,
                 std::set<Key>& marked) {
  const Eigen::AlignedBox3d box = shape.bounds(pose);
  const auto cell = [&](double value) { return static_cast<std::int64_t>(std::floor(value / edge)); };
  for (std::int64_t x = cell(box.min().x()) - 2; x <= cell(box.max().x()) + 2; ++x) {
    for (std::int64_t y = cell(box.min().y()) - 2; y <= cell(box.max().y()) + 2; ++y) {
      for (std::int64_t z = cell(box.min().z()) - 2; z <= cell(box.max().z()) + 2; ++z) {
        const Key key(x, y, z);
        if (distance_to_cube(shape, pose, center_of(key, edge), edge + 2.0 * margin).lower <= 0.0)
          marked.insert(key);
      }
    }
  }
}

std::set<Key> cells_of(const VoxelMarks& marks) {
  std::set<Key> cells;
  marks.visit([](const Cell&, std::size_t) { return true; },
              [&](const Cell& cell) { cells.emplace(cell.x(), cell.y(), cell.z()); });
  return cells;
}

std::vector<Shape> shapes() {
  return {Shape::sphere(0.07),
          Shape::capsule(0.03, 0.2),
          Shape::cylinder(0.05, 0.16),
          Shape::box(Eigen::Vector3d(0.2, 0.05, 0.11)),
          Shape::convex({{0.1, 0, 0}, {-0.1, 0.02, 0}, {0, 0.12, 0.03}, {0, 0, 0.15}, {0.05, -0.08, -0.06}}),
          Shape::box(Eigen::Vector3d(0.9, 0.7, 0.8))};
}

TEST(VoxelMarks, marks_exactly_the_voxels_that_a_shape_touches) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double edge = 0.04;
  for (const Shape& shape : shapes()) {
    for (int i = 0; i < 5; ++i) {
      const Eigen::Isometry3d pose =
          Eigen::Translation3d(uniform(random), uniform(random), uniform(random)) *
          Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
      VoxelMarks marks(edge);
      ASSERT_TRUE(marks.mark(MarkedShape(shape), pose));
      std::set<Key> slow;
      mark_slowly(shape, pose, edge, 0.0, slow);
      EXPECT_EQ(cells_of(marks), slow);
      EXPECT_EQ(marks.count(), slow.size());
    }
  }
}

TEST(VoxelMarks, a_body_of_too_many_voxels_is_not_marked_at_all) {
  VoxelMarks marks(0.01, 1000.0);
  EXPECT_FALSE(marks.mark(MarkedShape(Shape::sphere(10.0)), Eigen::Isometry3d::Identity()));
  EXPECT_EQ(marks.count(), 0u);
  EXPECT_FALSE(
      marks.mark(MarkedShape(Shape::sphere(0.1)), Eigen::Isometry3d(Eigen::Translation3d(1e300, 0, 0))));
}

TEST(VoxelMarks, bodies_at_so_many_poses_that_it_takes_too_long_are_not_marked_either) {
  VoxelMarks marks(0.01, 5e5, 1000.0);                 // looks
  const MarkedShape box(Shape::box({0.4, 0.4, 0.4}));  // in 6 x 6 x 6 bricks
  int marked = 0;
  while (marked < 10 && marks.mark(box, Eigen::Isometry3d(Eigen::Translation3d(0.01, 0.01, 0.01)))) ++marked;
  EXPECT_EQ(marked, 4);
  EXPECT_FALSE(marks.mark(box, Eigen::Isometry3d::Identity()));
}

Configuration configuration(std::initializer_list<double> values) {
  Configuration q(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), q.begin());
  return q;
}

TEST(SweptVoxels, of_an_arm_are_what_brute_force_marks_but_for_half_a_voxel_at_the_skin) {
  const Robot robot = load_robot("puma560");
  const double edge = 0.04;
  const Snapshot map = VoxelScene{edge, {}, {}, {}}.snapshot();
  const std::vector<Configuration> path{configuration({0.1, -1.0, 0.4, 0.2, 0.3, 0.0}),
                                        configuration({0.4, -0.8, 0.2, 0.2, 0.5, 0.1}),
                                        configuration({0.45, -0.8, 0.2, 0.0, 0.5, 0.1})};
  const auto swept = swept_voxels(robot, map, path);
  ASSERT_TRUE(swept);
  std::set<Key> touched, deep;
  LinkPoses poses;
  for (std::size_t edge_index = 0; edge_index + 1 < path.size(); ++edge_index) {
    for (int i = 0; i <= 60; ++i) {
      forward_kinematics(robot, path[edge_index] + i / 60.0 * (path[edge_index + 1] - path[edge_index]),
                         poses);
      for (const Body& body : robot.bodies) {
        if (!is_moved(robot, body.link)) continue;
        const Eigen::Isometry3d pose = poses[static_cast<std::size_t>(body.link)] * body.link_from_shape;
        mark_slowly(body.shape, pose, edge, 1e-3, touched);            // the poses are not the same ones
        mark_slowly(body.shape, pose, edge, -edge / 2 * 0.999, deep);  // the voxels' middles alone
      }
    }
  }
  EXPECT_LE(swept->total(), touched.size());
  EXPECT_GE(static_cast<double>(swept->total()), 0.9 * static_cast<double>(touched.size()));
  EXPECT_GT(swept->total(), deep.size());
  EXPECT_EQ(swept->unknown, swept->total());  // the map is empty
  EXPECT_EQ(swept->beyond, swept->total());
}

TEST(SweptVoxels, of_a_disc_that_slides_are_those_of_the_strip_that_it_covers) {
  const Robot robot = load_robot("point");  // radius 0.2 m
  const double edge = 0.1;
  FreeSpaceMap scans({.resolution = edge});
  Scan scan;  // sees along the strip's middle, one ray: a line of voxels that were seen once
  scan.map_from_sensor.translation() = Eigen::Vector3d(-1.95, 0.05, 0.05);
  scan.points = {Eigen::Vector3f(3.9f, 0.0f, 0.0f)};
  scans.insert(scan);
  const std::vector<Configuration> path{configuration({-0.9, 0.05}), configuration({0.9, 0.05})};
  const auto once = swept_voxels(robot, scans.snapshot(), path);
  ASSERT_TRUE(once);
  // All of x from -1.1 to 1.1 (22 voxels and the two that are touched at -1.1 and 1.1), y from -0.15 to 0.25.
  EXPECT_GT(once->seen_free, 15u);
  EXPECT_EQ(once->seen_once, once->seen_free);
  EXPECT_EQ(once->painted, 0u);
  EXPECT_EQ(once->occupied, 0u);
  EXPECT_EQ(once->total(), once->seen_free + once->unknown);
  const double strip = (1.8 * 0.4 + std::numbers::pi * 0.04) / (edge * edge);  // voxels, without the borders
  const double layers = static_cast<double>(once->total()) / strip;
  EXPECT_GT(layers, 1.0);
  EXPECT_LT(layers, 3.0);
  scans.insert(scan);
  const auto twice = swept_voxels(robot, scans.snapshot(), path);
  EXPECT_EQ(twice->seen_free, once->seen_free);
  EXPECT_EQ(twice->seen_once, 0u);
  EXPECT_NEAR(twice->litres(twice->total()), 1e3 * edge * edge * edge * static_cast<double>(twice->total()),
              1e-9);
  EXPECT_NEAR(twice->share(twice->unknown) + twice->share(twice->seen_free), 1.0, 1e-12);
}

TEST(SweptVoxels, distinguish_paint_obstacles_and_what_lies_beyond_the_map) {
  const Robot robot = load_robot("point");
  const double edge = 0.05;
  const Snapshot map = VoxelScene{
      edge,
      {box_of(0.9, -0.5, -0.2, 1.0, 0.5, 0.2)},
      {{Eigen::Vector3d::Zero(), 0.5}},
      {}}.snapshot();
  const auto inside = swept_voxels(robot, map, {configuration({0.0, 0.0})});
  ASSERT_TRUE(inside);
  EXPECT_EQ(inside->painted, inside->total());
  const auto far = swept_voxels(robot, map, {configuration({10.0, 0.0})});
  EXPECT_EQ(far->beyond, far->total());
  EXPECT_EQ(far->unknown, far->total());
  const auto across = swept_voxels(robot, map, {configuration({0.0, 0.0}), configuration({2.0, 0.0})});
  EXPECT_GT(across->occupied, 0u);
  EXPECT_GT(across->beyond, 0u);
  EXPECT_GT(across->unknown, across->beyond);
  EXPECT_GE(across->painted, inside->painted);
}

TEST(SweptVoxels, do_not_depend_on_the_number_of_waypoints_by_more_than_the_skin) {
  const Robot robot = load_robot("puma560");
  const Snapshot map = VoxelScene{0.04, {}, {}, {}}.snapshot();
  const Configuration from = configuration({0.0, -1.0, 0.4, 0.0, 0.3, 0.0});
  const Configuration to = configuration({0.8, -0.6, 0.1, 0.0, 0.3, 0.0});
  std::vector<Configuration> fine;
  for (int i = 0; i <= 500; ++i) fine.push_back(from + i / 500.0 * (to - from));
  const double coarse = static_cast<double>(swept_voxels(robot, map, {from, to})->total());
  EXPECT_NEAR(static_cast<double>(swept_voxels(robot, map, fine)->total()), coarse, 0.03 * coarse);
}

TEST(StandingContacts, name_the_body_that_no_joint_moves_and_count_its_occupied_voxels) {
  const Robot robot = load_robot("puma560");
  const double edge = 0.05;
  const Snapshot beside = VoxelScene{edge, {box_of(1.0, 1.0, 0.0, 1.2, 1.2, 0.2)}, {}, {}}.snapshot();
  EXPECT_TRUE(standing_contacts(robot, beside).empty());
  const Snapshot under = VoxelScene{edge, {box_of(-0.5, -0.5, 0.0, 0.5, 0.5, 0.2)}, {}, {}}.snapshot();
  const auto contacts = standing_contacts(robot, under);
  ASSERT_FALSE(contacts.empty());
  std::set<Key> touched;
  const LinkPoses poses = forward_kinematics(robot, Configuration::Zero(6));
  for (const StandingContact& contact : contacts) {
    for (const Body& body : robot.bodies) {
      if (body.part != contact.part) continue;
      mark_slowly(body.shape, poses[static_cast<std::size_t>(body.link)] * body.link_from_shape, edge, 0.0,
                  touched);
    }
    std::size_t occupied = 0;
    for (const Key& key : touched) occupied += under.state(center_of(key, edge)) == VoxelState::occupied;
    EXPECT_EQ(contact.voxels, occupied);
    EXPECT_NEAR(contact.lowest.z(), 0.025, 1e-9);
  }
}

TEST(StandingContacts, count_each_voxel_of_a_pruned_leaf) {
  Robot robot = load_robot("puma560");
  robot.map_from_base.translation() = Eigen::Vector3d(0.03, -0.02, -0.21);
  for (const double edge : {0.05, 0.1}) {  // 8 x 8 x 8 equal voxels are one leaf
    const Snapshot map = VoxelScene{edge, {box_of(-0.8, -0.8, -0.8, 0.8, 0.8, 0.0)}, {}, {}}.snapshot();
    ASSERT_GT(map.voxel(Eigen::Vector3d(0.01, 0.01, -0.01)).size, edge);
    const auto contacts = standing_contacts(robot, map);
    std::set<Key> touched;
    const LinkPoses poses = forward_kinematics(robot, Configuration::Zero(6));
    std::size_t counted = 0, occupied = 0;
    for (const StandingContact& contact : contacts) counted += contact.voxels;
    for (const Body& body : robot.bodies) {
      if (robot.links[static_cast<std::size_t>(body.link)].parent >= 0) continue;
      mark_slowly(body.shape, poses[0] * body.link_from_shape, edge, 0.0, touched);
    }
    for (const Key& key : touched) occupied += map.state(center_of(key, edge)) == VoxelState::occupied;
    EXPECT_EQ(counted, occupied);
    EXPECT_GT(counted, 10u);
  }
}

/// A box whose faces lie in those of voxels, of which both sides are touched.
TEST(StandingContacts, count_the_voxels_that_a_face_touches_on_either_side) {
  constexpr double edge = 0.125;  // without rounding
  Robot robot = load_robot("puma560");
  robot.bodies.resize(1);
  ASSERT_EQ(robot.bodies[0].link, 0);
  robot.bodies[0].shape = Shape::box({0.5, 0.25, 0.25});
  robot.bodies[0].link_from_shape.setIdentity();
  robot.bodies[0].cover = robot.bodies[0].shape.sphere_cover();
  for (const double reach : {1.0, 0.375}) {  // one leaf an octant, or single voxels
    const Snapshot map =
        VoxelScene{edge, {box_of(-reach, -reach, -reach, reach, reach, reach)}, {}, {}}.snapshot();
    const auto contacts = standing_contacts(robot, map);
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_EQ(contacts[0].voxels, 6U * 4U * 4U);
    EXPECT_TRUE(contacts[0].lowest.isApprox(Eigen::Vector3d(-2.5 * edge, -1.5 * edge, -1.5 * edge)));
  }
}

}  // namespace swept_voxels_test
}  // namespace clearway
