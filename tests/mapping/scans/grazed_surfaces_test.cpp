// Boards, boxes and things that move, seen along their surfaces, against where they truly are.
#include "mapping/scans/grazed_surfaces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/free_space_map.hpp"
#include "mapping/snapshot.hpp"

namespace clearway {
namespace grazed_surfaces_test {

using Eigen::Vector3d;

/// A solid box, and a wall at x = 3 behind it.
struct Box {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Vector3d edges = Vector3d::Zero();

  double range(const Vector3d& origin, const Vector3d& way) const {
    const Vector3d from = pose.inverse() * origin, along = pose.linear().transpose() * way;
    double near = 0.0, far = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const double a = (-edges[i] / 2 - from[i]) / along[i], b = (edges[i] / 2 - from[i]) / along[i];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near < far ? near : std::numeric_limits<double>::infinity();
  }
};

/// Looks of a camera whose rays are 0.4 degrees apart, within 12 degrees of where it is turned to.
class Camera {
 public:
  explicit Camera(FreeSpaceMap& map) : map_(map) {}

  void look(const Vector3d& origin, const Vector3d& at, const Box* box) {
    Scan scan;
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), at - origin);
    scan.map_from_sensor = Eigen::Translation3d(origin) * turn;
    for (int i = -30; i <= 30; ++i) {
      for (int k = -30; k <= 30; ++k) {
        const Vector3d ray =
            Vector3d(1.0, std::tan(i * 0.4 * M_PI / 180), std::tan(k * 0.4 * M_PI / 180)).normalized();
        const Vector3d way = turn * ray;
        double range = way.x() > 0.1 ? (3.007 - origin.x()) / way.x() : 4.0;
        if (box != nullptr) range = std::min(range, box->range(origin, way));
        if (range < 4.0) scan.points.push_back((range * ray).cast<float>());
      }
    }
    scan.time = time_++;
    map_.insert(scan);
  }

 private:
  FreeSpaceMap& map_;
  double time_ = 0.0;
};

/// Of places on a grid over the box's larger faces: the share where a line across the box meets nothing
/// occupied.
double share_open(const FreeSpaceMap& map, const Box& box) {
  const Snapshot snapshot = map.snapshot();
  int open = 0, count = 0;
  for (double x = -box.edges.x() / 2 + 0.03; x < box.edges.x() / 2 - 0.03; x += 0.02) {
    for (double y = -box.edges.y() / 2 + 0.03; y < box.edges.y() / 2 - 0.03; y += 0.02, ++count) {
      bool is_blocked = false;
      for (double z = -0.03; z <= 0.03 && !is_blocked; z += 0.005)
        is_blocked = snapshot.state(box.pose * Vector3d(x, y, z)) == VoxelState::occupied;
      open += !is_blocked;
    }
  }
  return static_cast<double>(open) / count;
}

Vector3d swaying(int i, double far) {
  return {far * std::sin(i), far * std::cos(2 * i), far * std::sin(3 * i)};
}

TEST(GrazedSurfaces, ABoardStandsWhenItIsSeenEdgeOn) {
  for (const double tilt : {0.0, 0.3, 1.1}) {
    for (const double thickness : {0.008, 0.015}) {
      Box board;
      board.pose = Eigen::Translation3d(2.007, 0.003, 0.4095) * Eigen::AngleAxisd(tilt, Vector3d::UnitX());
      board.edges = {0.8, 0.6, thickness};
      FreeSpaceMap map({.resolution = 0.02});
      Camera camera(map);
      const Vector3d up = board.pose.linear().col(2), middle = board.pose.translation();
      for (int i = 0; i < 12; ++i)
        camera.look(middle - Vector3d(1.7, 0, 0) + 0.6 * up + swaying(i, 0.1), middle, &board);
      const double missed = share_open(map, board);
      EXPECT_LT(missed, 0.03) << tilt;
      for (int i = 0; i < 20; ++i)  // 3 to 13 mm above it
        camera.look(middle - Vector3d(1.9, 0, 0) + (thickness / 2 + 0.008 + 0.005 * std::sin(i)) * up, middle,
                    &board);
      EXPECT_LT(share_open(map, board), missed + 0.05) << tilt << " " << thickness;
    }
  }
}

/// It is seen again from where it was hit: from there it is free after five looks.
TEST(GrazedSurfaces, ABoardThatLeftIsFreeAgainUnlessItIsOnlySeenEdgeOn) {
  Box board;
  board.pose = Eigen::Translation3d(2.007, 0.003, 0.4095);
  board.edges = {0.8, 0.6, 0.015};
  for (const double height : {0.6, 0.0}) {
    FreeSpaceMap map({.resolution = 0.02});
    Camera camera(map);
    const Vector3d middle = board.pose.translation();
    for (int i = 0; i < 12; ++i) camera.look(Vector3d(0.1, 0, 1.0) + swaying(i, 0.05), middle, &board);
    for (int i = 0; i < 5; ++i)
      camera.look(Vector3d(0.1, 0, 0.41 + height) + swaying(i, 0.005), middle, nullptr);
    const double open = share_open(map, board);
    EXPECT_EQ(open > 0.9, height > 0.0) << open;
    EXPECT_EQ(open < 0.1, height == 0.0) << open;
  }
}

/// Its sides lie nearly along the rays of a camera that stands still.
TEST(GrazedSurfaces, ABoxThatLeftBeforeACameraThatStandsStillIsFreeAgain) {
  Box box;
  box.pose = Eigen::Translation3d(2.0, 0.2, 0.4);
  box.edges = {0.5, 0.2, 0.2};
  FreeSpaceMap map({.resolution = 0.02});
  Camera camera(map);
  for (int i = 0; i < 12; ++i) camera.look(Vector3d(0.1, 0, 0.45) + swaying(i, 0.01), {2, 0, 0.4}, &box);
  for (int i = 0; i < 9; ++i) camera.look(Vector3d(0.1, 0, 0.45) + swaying(i, 0.01), {2, 0, 0.4}, nullptr);
  int left = 0;
  map.snapshot().visit_leaves(
      [&](const Voxel& leaf) { left += leaf.state == VoxelState::occupied && leaf.center.x() < 2.9; });
  EXPECT_EQ(left, 0);
}

/// What goes away along the line of sight leaves a trail that is as long, but no layer.
TEST(GrazedSurfaces, WhatGoesAwayLeavesNoTrail) {
  FreeSpaceMap map({.resolution = 0.02});
  Camera camera(map);
  Box person;
  person.edges = {0.2, 0.3, 0.5};
  for (int i = 0; i < 50; ++i) {
    person.pose = Eigen::Isometry3d(Eigen::Translation3d(1.0 + 0.02 * i, 0.0, 0.4));
    camera.look({0.1 + 0.002 * i, 0.2 * std::sin(0.2 * i), 0.4}, {2, 0, 0.4}, &person);
  }
  for (int i = 0; i < 9; ++i) camera.look(Vector3d(0.2, 0, 0.4) + swaying(i, 0.1), {2, 0, 0.4}, nullptr);
  int left = 0;
  map.snapshot().visit_leaves(
      [&](const Voxel& leaf) { left += leaf.state == VoxelState::occupied && leaf.center.x() < 2.9; });
  EXPECT_LT(left, 10);  // of thousands that were hit
}

}  // namespace grazed_surfaces_test
}  // namespace clearway
