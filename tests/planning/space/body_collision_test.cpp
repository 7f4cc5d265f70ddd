#include "planning/space/body_collision.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "tests/worlds/random_world.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace guarded_body_test {

Body body_of(const Shape& shape) {
  Body body{"body", 0, Eigen::Isometry3d::Identity(), shape, shape.sphere_cover()};
  return body;
}

std::vector<Shape> shapes() {
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? 0.1 : -0.08, i & 2 ? 0.06 : -0.06, i & 4 ? 0.09 : -0.05);
  return {Shape::sphere(0.08), Shape::capsule(0.05, 0.2), Shape::cylinder(0.06, 0.15),
          Shape::box({0.1, 0.15, 0.2}), Shape::convex(corners)};
}

struct Cubes {
  std::shared_ptr<const BlockedSpace> space;
  std::vector<Eigen::Vector3d> centers;
};

Cubes random_cubes(Random& random, double resolution) {
  FreeSpaceMap map({.resolution = resolution});
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d at = random.point(0.4);
    occupy(map, ((at / resolution).array().floor() + 0.5) * resolution);
  }
  Cubes cubes;
  const Eigen::AlignedBox3d region(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Constant(1.0));
  cubes.space = map.snapshot().blocked_space({Policy::not_occupied, 0}, region, 0.5);
  cubes.space->visit_blocked(region, [&](const Eigen::Vector3d& cube) {
    cubes.centers.push_back(cube);
    return true;
  });
  return cubes;
}

const Eigen::AlignedBox3d everywhere(Eigen::Vector3d::Constant(-2.0), Eigen::Vector3d::Constant(2.0));

TEST(BodyCollision, IsClearAgreesWithEveryCubeAndWithWhatWasMetLately) {
  Random random(21);
  int clear = 0, blocked = 0, close = 0;
  for (const Shape& shape : shapes()) {
    const Cubes cubes = random_cubes(random, 0.03);
    const Body body = body_of(shape);
    const BodyCollision collision(body, cubes.space, everywhere);
    RecentCubes recent;
    Eigen::Isometry3d pose = random.pose(0.5);
    for (int i = 0; i < 1500; ++i) {
      if (i % 10 == 0) pose = random.pose(0.5);  // else a small step, as a search makes them
      pose.translation() += random.point(0.01);
      const double margin = i % 3 == 0 ? 0.0 : random.between(0.0, 0.02);
      double lower = 1.0, upper = 1.0;
      for (const Eigen::Vector3d& cube : cubes.centers) {
        const DistanceBounds bounds = distance_to_cube(shape, pose, cube, 0.03);
        lower = std::min(lower, bounds.lower), upper = std::min(upper, bounds.upper);
      }
      const bool is_clear = collision.is_clear(pose, margin);
      ASSERT_EQ(is_clear, collision.is_clear(pose, margin, &recent)) << i;
      ASSERT_FALSE(is_clear && collision.is_met(pose, margin, recent)) << i;
      if (lower > margin + 1e-7) {
        ASSERT_TRUE(is_clear) << lower - margin;
        ASSERT_GT(collision.quick_clearance(pose), -1.0);
        ++clear;
      } else if (upper <= margin) {
        ASSERT_FALSE(is_clear) << upper;
        ++blocked;
      } else {
        ++close;
      }
      const double beyond = collision.clearance_beyond(pose, margin, margin + 0.005, recent);
      ASSERT_EQ(beyond >= margin, is_clear) << i;
      ASSERT_LE(beyond, lower + 1e-12);
      ASSERT_EQ(beyond >= margin + 0.005, collision.is_clear(pose, margin + 0.005)) << i;
      ASSERT_LE(collision.coarse_clearance(pose), lower + 1e-12);
      const double quick = collision.quick_clearance(pose);
      ASSERT_LE(quick, lower + 1e-12);
      ASSERT_TRUE(quick < 1e-9 || collision.is_quickly_clear(pose, quick - 1e-9)) << i;
      ASSERT_FALSE(collision.is_quickly_clear(pose, upper)) << i;
      for (std::size_t k = 0; k < recent.size(); ++k) {
        ASSERT_EQ(collision.is_clear_of(pose, recent[k], margin),
                  distance_to_cube(shape, pose, recent[k], 0.03, margin).lower > margin);
      }
    }
    EXPECT_GT(recent.size(), 4u);
  }
  EXPECT_GT(clear, 1000);
  EXPECT_GT(blocked, 1000);
  EXPECT_LT(close, 20);
}

TEST(BodyCollision, AHullAwayFromItsOriginIsNotClearDeepInsideWhatIsBlocked) {
  const Snapshot map = VoxelScene{0.05, {box_of(-0.5, -0.5, -0.5, 0.5, 0.5, 0.5)}, {}, {}}.snapshot();
  const Eigen::AlignedBox3d region(Eigen::Vector3d::Constant(-2.0), Eigen::Vector3d::Constant(2.0));
  const auto space = map.blocked_space({Policy::not_occupied, 0}, region, 0.5);
  for (const double away : {0.0, 1.2}) {  // mesh hulls keep the vertices of their files
    std::vector<Eigen::Vector3d> corners;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(away + (i & 1 ? 0.1 : -0.1), i & 2 ? 0.1 : -0.1, i & 4 ? 0.1 : -0.1);
    const Body body = body_of(Shape::convex(corners));
    const BodyCollision collision(body, space, everywhere);
    Random random(5);
    for (int i = 0; i < 50; ++i) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation() = random.point(0.2) - Eigen::Vector3d(away, 0.0, 0.0);
      EXPECT_FALSE(collision.is_clear(pose, 0.0)) << away;
      pose.translation().y() += 1.0;
      EXPECT_TRUE(collision.is_clear(pose, 0.0)) << away;
    }
  }
}

TEST(BodyCollision, ASweepThatIsClearKeepsItsMarginFromEveryCubeAllTheWay) {
  Random random(22);
  int clear = 0, refused = 0, refused_with_room = 0;
  for (const Shape& shape : shapes()) {
    const Cubes cubes = random_cubes(random, 0.03);
    const Body body = body_of(shape);
    const BodyCollision collision(body, cubes.space, everywhere);
    for (int i = 0; i < 600; ++i) {
      const Eigen::Isometry3d begin = random.pose(0.5);
      Eigen::Isometry3d end = begin;
      end.translation() += random.point(0.03);
      end.linear() =
          Eigen::AngleAxisd(random.between(-0.05, 0.05), random.point(1.0).normalized()) * end.linear();
      RecentCubes recent;
      Eigen::Isometry3d middle = begin;
      middle.translation() = (begin.translation() + end.translation()) / 2;
      const double margin = random.between(0.0, 0.01);
      const bool is_clear = collision.is_sweep_clear(begin, i % 2 == 0 ? begin : middle, end, margin, recent);
      (is_clear ? clear : refused)++;
      double least = 1.0;  // of the hull of both poses
      for (const Eigen::Vector3d& cube : cubes.centers)
        least = std::min(least, swept_distance_to_cube(shape, begin, end, cube, 0.03).lower);
      if (is_clear) {
        ASSERT_GT(least, margin - 2e-4);  // between the chords of the body's points and the hull
        ASSERT_TRUE(collision.is_clear(begin, margin) && collision.is_clear(end, margin));
      } else {
        refused_with_room += least > margin + 1e-6;
        ASSERT_TRUE(recent.size() > 0 || cubes.space->is_blocked(begin.translation()) || least == 0.0);
      }
    }
  }
  EXPECT_GT(clear, 500);
  EXPECT_GT(refused, 500);
  EXPECT_EQ(refused_with_room, 0);
}

TEST(RecentCubes, KeepTheLatestFirstAndEachOnce) {
  RecentCubes recent;
  for (int i = 0; i < 20; ++i) recent.remember(Eigen::Vector3d::Constant(i));
  ASSERT_EQ(recent.size(), RecentCubes::most);
  for (std::size_t i = 0; i < recent.size(); ++i) EXPECT_EQ(recent[i].x(), 19.0 - static_cast<double>(i));
  recent.remember(Eigen::Vector3d::Constant(17));
  ASSERT_EQ(recent.size(), RecentCubes::most);
  EXPECT_EQ(recent[0].x(), 17.0);
  EXPECT_EQ(recent[1].x(), 19.0);
  EXPECT_EQ(recent[2].x(), 18.0);
  EXPECT_EQ(recent[3].x(), 16.0);
  recent.clear();
  EXPECT_EQ(recent.size(), 0u);
}

/// What is kept from look to look, per thread, is of another body or pose each time here, and of none in a
/// new thread.
TEST(BodyCollision, LooksOfOtherBodiesAndPosesBeforeChangeNothing) {
  Random random(25);
  int clear = 0;
  for (int i = 0; i < 200; ++i) {
    const Cubes cubes = random_cubes(random, 0.03);
    const Body body = body_of(shapes()[static_cast<std::size_t>(i) % 5]);
    const auto collision =
        std::make_unique<BodyCollision>(body, cubes.space, everywhere);  // where one was before
    const BodyCollision copy = *collision;
    const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // as before, too
    const double margin = random.between(0.0, 0.05);
    const bool is_quickly_clear = collision->is_quickly_clear(pose, margin);
    const bool is_clear = copy.is_clear(pose, margin);
    const double coarse = collision->coarse_clearance(pose);
    clear += is_clear;
    std::thread anew([&] {
      EXPECT_EQ(collision->coarse_clearance(pose), coarse);
      EXPECT_EQ(collision->is_clear(pose, margin), is_clear);
    });
    anew.join();
    std::thread quickly([&] { EXPECT_EQ(collision->is_quickly_clear(pose, margin), is_quickly_clear); });
    quickly.join();
  }
  EXPECT_GT(clear, 20);
  EXPECT_LT(clear, 180);
}

}  // namespace guarded_body_test
}  // namespace clearway
