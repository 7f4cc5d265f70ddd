#include "planning/routes/painted_route.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace painted_route_test {

Snapshot painted(const std::vector<Sphere>& spheres) {
  FreeSpaceMap map({.resolution = 0.05});
  const int volume = map.add_volume("free", {"tool"});
  for (const Sphere& sphere : spheres) map.paint(volume, sphere);
  return map.snapshot();
}

std::vector<Sphere> random_spheres(Random& random, int count) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) spheres.push_back({random.point(0.6), random.between(0.05, 0.2)});
  return spheres;
}

double free_of_charge(const Eigen::Vector3d&) { return 1.0; }

double length(const EndEffectorRoute& route) {
  double sum = 0.0;
  for (std::size_t i = 1; i < route.points.size(); ++i) sum += (route.points[i] - route.points[i - 1]).norm();
  return sum;
}

/// Shortest length between two spheres' centres by relaxing every overlapping pair until nothing changes.
std::vector<double> lengths_by_brute_force(const std::vector<Sphere>& spheres, std::size_t from) {
  std::vector<double> length(spheres.size(), 1e300);
  length[from] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      for (std::size_t j = 0; j < spheres.size(); ++j) {
        const double apart = (spheres[i].center - spheres[j].center).norm();
        if (i == j || apart >= spheres[i].radius + spheres[j].radius) continue;
        if (length[i] + apart < length[j] - 1e-12) length[j] = length[i] + apart, changed = true;
      }
    }
  }
  return length;
}

TEST(PaintedGraph, NeighboursAreExactlyTheSpheresThatOverlap) {
  Random random(1);
  for (int round = 0; round < 5; ++round) {
    const std::vector<Sphere> spheres = random_spheres(random, 120);
    const PaintedGraph graph(painted(spheres), 0xffff, 0.0);
    ASSERT_EQ(graph.size(), spheres.size());
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      std::vector<int> expected;
      for (std::size_t j = 0; j < spheres.size(); ++j) {
        if (j != i && (spheres[i].center - spheres[j].center).norm() < spheres[i].radius + spheres[j].radius)
          expected.push_back(static_cast<int>(j));
      }
      EXPECT_EQ(graph.neighbours(i), expected);
    }
  }
}

TEST(PaintedGraph, ASphereOfThePassageRadiusFitsThroughWhereNeighboursMeet) {
  Random random(2);
  const std::vector<Sphere> spheres = random_spheres(random, 150);
  const double passage = 0.06;
  const PaintedGraph graph(painted(spheres), 0xffff, passage);
  int pairs = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (const int other : graph.neighbours(i)) {
      const Sphere &a = spheres[i], &b = spheres[static_cast<std::size_t>(other)];
      // Points of both spheres at that distance from the line of centres, all around, prove the circle.
      const Eigen::Vector3d axis = (b.center - a.center).normalized();
      const Eigen::Vector3d side = axis.unitOrthogonal();
      bool found = false;
      for (int k = 0; k <= 400 && !found; ++k) {
        const Eigen::Vector3d point = a.center + k / 400.0 * (b.center - a.center) + (passage - 1e-3) * side;
        found = (point - a.center).norm() < a.radius && (point - b.center).norm() < b.radius;
      }
      EXPECT_TRUE(found);
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 50);
}

TEST(PaintedGraph, RoutesAreAsShortAsBruteForceFindsAndEmptyBetweenPieces) {
  Random random(3);
  int joined = 0, apart = 0;
  for (int round = 0; round < 8; ++round) {
    const std::vector<Sphere> spheres = random_spheres(random, 40);
    const PaintedGraph graph(painted(spheres), 0xffff, 0.0);
    const std::vector<double> expected = lengths_by_brute_force(spheres, 0);
    for (std::size_t to = 1; to < spheres.size(); ++to) {
      const EndEffectorRoute route = graph.route(spheres[0].center, spheres[to].center, free_of_charge);
      EXPECT_EQ(route.points.empty(), graph.piece(0) != graph.piece(to));
      EXPECT_EQ(route.points.empty(), expected[to] > 1e200);
      if (route.points.empty()) {
        ++apart;
        continue;
      }
      ++joined;
      // The first and last sphere may be any that holds the end, so that the way may be shorter, never
      // longer.
      EXPECT_LE(length(route), expected[to] + 1e-9);
      EXPECT_EQ(route.points.front(), spheres[0].center);
      EXPECT_EQ(route.points.back(), spheres[to].center);
      EXPECT_EQ(route.points.size(), route.radii.size());
      for (std::size_t i = 1; i < route.points.size(); ++i) {  // a way within the paint
        for (int k = 0; k <= 20; ++k) {
          const Eigen::Vector3d at = route.points[i - 1] + k / 20.0 * (route.points[i] - route.points[i - 1]);
          EXPECT_TRUE(std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& sphere) {
            return (sphere.center - at).norm() <= sphere.radius + 1e-12;
          }));
        }
      }
    }
  }
  EXPECT_GT(joined, 20);
  EXPECT_GT(apart, 20);
}

TEST(PaintedGraph, ADearPlaceIsGoneRound) {
  std::vector<Sphere> ring;  // two ways round, the lower one a little shorter
  for (int i = 0; i < 24; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 24.0;
    ring.push_back(
        {{0.5 * std::cos(angle), (angle < std::numbers::pi ? 0.6 : 0.5) * std::sin(angle), 0.0}, 0.1});
  }
  const PaintedGraph graph(painted(ring), 0xffff, 0.0);
  const Eigen::Vector3d from(0.5, 0, 0), to(-0.5, 0, 0);
  const EndEffectorRoute shortest = graph.route(from, to, free_of_charge);
  const EndEffectorRoute round =
      graph.route(from, to, [](const Eigen::Vector3d& p) { return p.y() < -0.4 ? 20.0 : 1.0; });
  EXPECT_LT(shortest.points[shortest.points.size() / 2].y(), -0.4);
  EXPECT_GT(round.points[round.points.size() / 2].y(), 0.4);
}

/// Pieces of spheres that overlap, by joining sets.
std::vector<std::size_t> pieces_by_brute_force(const std::vector<Sphere>& spheres) {
  std::vector<std::size_t> leader(spheres.size());
  for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = i;
  const auto find = [&](std::size_t i) {
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((spheres[i].center - spheres[j].center).norm() < spheres[i].radius + spheres[j].radius)
        leader[find(i)] = find(j);
    }
  }
  for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = find(i);
  return leader;
}

TEST(PaintedGraph, OfThousandsOfSpheresItKnowsThePiecesAndAWayWithinEach) {
  Random random(7);
  std::vector<Sphere> spheres;  // six strokes that may or may not touch, as a hand at 60 Hz leaves them
  for (int stroke = 0; stroke < 6; ++stroke) {
    Eigen::Vector3d at = random.point(0.6), way = Eigen::Vector3d::UnitX();
    for (int i = 0; i < 700; ++i) {
      way = (way + 0.15 * random.point(1.0)).normalized();
      spheres.push_back({at += 0.002 * way, random.between(0.04, 0.06)});
    }
  }
  const PaintedGraph graph(painted(spheres), 0xffff, 0.0);
  EXPECT_LE(graph.size(), PaintedGraph::most_spheres);
  const std::vector<std::size_t> leader = pieces_by_brute_force(spheres);
  std::vector<std::size_t> leaders = leader;
  std::sort(leaders.begin(), leaders.end());
  leaders.erase(std::unique(leaders.begin(), leaders.end()), leaders.end());
  EXPECT_EQ(graph.piece_count(), static_cast<int>(leaders.size()));
  EXPECT_GT(graph.piece_count(), 1);
  int apart = 0;
  for (int i = 0; i < 60; ++i) {
    const auto a = static_cast<std::size_t>(random.below(static_cast<int>(spheres.size())));
    const auto b = static_cast<std::size_t>(random.below(static_cast<int>(spheres.size())));
    const EndEffectorRoute route = graph.route(spheres[a].center, spheres[b].center, free_of_charge);
    EXPECT_EQ(route.points.empty(), leader[a] != leader[b]);
    apart += leader[a] != leader[b];
    for (std::size_t k = 1; k < route.points.size(); ++k)  // from sphere to sphere of clusters that touch
      EXPECT_LT((route.points[k] - route.points[k - 1]).norm(), 0.2);
  }
  EXPECT_GT(apart, 5);
  EXPECT_LT(apart, 55);
}

TEST(PaintedGraph, OnceStoppedItIsEmpty) {
  Random random(8);
  const PaintedGraph graph(painted(random_spheres(random, 50)), 0xffff, 0.0, [] { return true; });
  EXPECT_EQ(graph.size(), 0U);
  EXPECT_TRUE(graph.holding(Eigen::Vector3d::Zero()).empty());
}

}  // namespace painted_route_test
}  // namespace clearway
