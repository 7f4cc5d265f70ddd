#include "planning/routes/free_route.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace free_route_test {

double free_of_charge(const Eigen::Vector3d&, double) { return 1.0; }

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

TEST(FreeRoute, AsksForTheTimeAsItGoesAndStopsWhenItIsOver) {
  const auto space = with_walls(holed_wall);
  const Eigen::Vector3d from(-0.6, -0.6, -0.6), to(0.6, 0.6, 0.6);
  int asked = 0;
  const auto ask = [&] { return ++asked > 3; };
  EXPECT_TRUE(free_route(*space, room, from, to, 0.1, 0.02, free_of_charge, ask).points.empty());
  EXPECT_EQ(asked, 4);
  asked = -1000000;
  EXPECT_FALSE(free_route(*space, room, from, to, 0.1, 0.02, free_of_charge, ask).points.empty());
  EXPECT_GE(asked + 1000000, 10);
}

TEST(FreeRoute, CostsNoMoreThanAskedBesideDijkstraOnEveryCell) {
  const auto space = with_walls(holed_wall);
  const double edge = 0.1, radius = 0.06;
  const auto price = [](const Eigen::Vector3d& point, double clearance) {
    return 1.0 + 20.0 * std::max(0.0, 0.3 - clearance) + std::abs(point.y());
  };
  const auto center = [&](int i) {
    return Eigen::Vector3d(room.min() + edge * Eigen::Vector3d(i % 21, i / 21 % 21, i / 441));
  };
  const auto is_open = [&](int i) { return space->clearance(center(i)) >= radius; };
  const auto index = [](int x, int y, int z) { return (z * 21 + y) * 21 + x; };
  const int first = index(4, 4, 4), last = index(17, 3, 4);
  std::vector<double> cost(21 * 21 * 21, std::numeric_limits<double>::infinity());
  std::set<std::pair<double, int>> open{{0.0, first}};
  cost[static_cast<std::size_t>(first)] = 0.0;
  while (!open.empty()) {
    const auto [so_far, at] = *open.begin();
    open.erase(open.begin());
    for (int next = 0; next < 21 * 21 * 21; ++next) {
      const double step = (center(next) - center(at)).norm() / edge;
      if (next == at || step > 1.8 || !is_open(next)) continue;
      double& known = cost[static_cast<std::size_t>(next)];
      const double longer = so_far + step * price(center(next), space->clearance(center(next)));
      if (longer >= known) continue;
      open.erase({known, next});
      known = longer;
      open.insert({known, next});
    }
  }
  const double least = cost[static_cast<std::size_t>(last)];
  for (const double most_times : {1.0, 1.5, 4.0}) {
    const EndEffectorRoute route = free_route(
        *space, room, center(first), center(last), radius, edge, price, [] { return false; }, most_times);
    ASSERT_GT(route.points.size(), 3u);
    double sum = 0.0;  // the ends stand twice
    for (std::size_t i = 2; i + 1 < route.points.size(); ++i) {
      const Eigen::Vector3d& at = route.points[i];
      sum += (at - route.points[i - 1]).norm() / edge * price(at, space->clearance(at));
    }
    EXPECT_GE(sum, least - 1e-9);
    EXPECT_LE(sum, most_times * least + 1e-9);
  }
}

}  // namespace free_route_test
}  // namespace clearway
