#include "planning/routes/free_route.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace free_route_test {

double free_of_charge(const Eigen::Vector3d&) { return 1.0; }

const Eigen::AlignedBox3d room = box_of(-1, -1, -1, 1, 1, 1);

std::shared_ptr<const BlockedSpace> with_walls(const std::vector<Eigen::AlignedBox3d>& walls) {
  const Snapshot map = VoxelScene{0.05, walls, {}, {}}.snapshot();
  return map.blocked_space({Policy::not_occupied, 0xffff}, room, 0.5);
}

double length(const EndEffectorRoute& route) {
  double sum = 0.0;
  for (std::size_t i = 1; i < route.points.size(); ++i) sum += (route.points[i] - route.points[i - 1]).norm();
  return sum;
}

/// A wall across the room with a hole of 0.4 m in one corner.
const std::vector<Eigen::AlignedBox3d> holed_wall = {box_of(-0.05, -1, -1, 0.05, 1, 0.5),
                                                     box_of(-0.05, -1, 0.5, 0.05, 0.5, 1)};

TEST(FreeRoute, GoesThroughTheOnlyHoleWithTheRoomAsked) {
  const auto space = with_walls(holed_wall);
  const Eigen::Vector3d from(-0.6, -0.6, -0.6), to(0.6, -0.6, -0.6);
  const EndEffectorRoute route = free_route(*space, room, from, to, 0.1, 0.05, free_of_charge);
  ASSERT_GT(route.points.size(), 10u);
  EXPECT_EQ(route.points.front(), from);
  EXPECT_EQ(route.points.back(), to);
  bool crossed = false;
  for (std::size_t i = 1; i + 1 < route.points.size(); ++i) {
    EXPECT_GE(space->clearance(route.points[i]), 0.1);
    if (std::abs(route.points[i].x()) < 0.03) {
      crossed = true;
      EXPECT_GT(route.points[i].y(), 0.5);
      EXPECT_GT(route.points[i].z(), 0.5);
    }
  }
  EXPECT_TRUE(crossed);
}

TEST(FreeRoute, ASphereTooLargeForTheHoleHasNoRoute) {
  const auto space =
      with_walls({box_of(-0.05, -1, -1, 0.05, 1, -0.2), box_of(-0.05, -1, 0.2, 0.05, 1, 1),
                  box_of(-0.05, -1, -0.2, 0.05, -0.2, 0.2), box_of(-0.05, 0.2, -0.2, 0.05, 1, 0.2)});
  const Eigen::Vector3d from(-0.6, 0.3, 0), to(0.6, 0, 0.3);
  const Eigen::AlignedBox3d inside = box_of(-0.9, -0.7, -0.7, 0.9, 0.7, 0.7);
  EXPECT_FALSE(free_route(*space, inside, from, to, 0.12, 0.05, free_of_charge).points.empty());
  EXPECT_TRUE(free_route(*space, inside, from, to, 0.25, 0.05, free_of_charge).points.empty());
}

TEST(FreeRoute, IsNoLongerThanTheGridMakesItAndKeepsTheBounds) {
  const auto space = with_walls({box_of(0.9, 0.9, 0.9, 0.95, 0.95, 0.95)});
  // With 26 neighbours a way on the grid is at most 12.6 % longer than the straight one.
  const Eigen::Vector3d from(-0.8, -0.71, 0.13), to(0.77, 0.4, -0.6);
  const EndEffectorRoute route = free_route(*space, room, from, to, 0.0, 0.05, free_of_charge);
  ASSERT_FALSE(route.points.empty());
  EXPECT_LE(length(route), 1.126 * (to - from).norm() + 0.1);
  const Eigen::AlignedBox3d half = box_of(-1, -1, -1, 1, 0, 1);
  for (const Eigen::Vector3d& point :
       free_route(*space, half, {-0.8, -0.5, 0}, {0.8, -0.5, 0}, 0.0, 0.05, free_of_charge).points) {
    EXPECT_LE(point.y(), 1e-9);
  }
}

TEST(FreeRoute, AnEndFarFromEveryFreeCellHasNoRoute) {
  const auto space = with_walls({box_of(0.2, -1, -1, 1, 1, 1)});
  EXPECT_TRUE(free_route(*space, room, {-0.5, 0, 0}, {0.7, 0, 0}, 0.05, 0.05, free_of_charge).points.empty());
}

TEST(FreeRoute, AsksForTheTimeAlsoWhileItLooksCellsUp) {
  const auto space = with_walls(holed_wall);
  const Eigen::Vector3d at(-0.6, -0.6, -0.6);
  int asked = 0;
  const auto ask = [&] { return ++asked > 3; };
  EXPECT_TRUE(free_route(*space, room, at, {0.6, 0.6, 0.6}, 0.1, 0.02, free_of_charge, ask).points.empty());
  EXPECT_LE(asked, 5);
  asked = -1000000;
  EXPECT_FALSE(free_route(*space, room, at, at, 0.1, 0.02, free_of_charge, ask).points.empty());
  EXPECT_GE(asked + 1000000, 100);  // of a million cells, though the way is none at all
}

}  // namespace free_route_test
}  // namespace clearway
