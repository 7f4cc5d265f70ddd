#include "apps/overlay/mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <tuple>

namespace mesh_test {

using namespace clearway;
using Eigen::Vector3d;

/// By the divergence theorem.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += mesh.corners[a].dot(mesh.corners[b].cross(mesh.corners[c])) / 6.0;
  return sum;
}

/// Each edge is met once in either direction.
bool is_closed(const Mesh& mesh) {
  const auto key = [&](std::uint32_t i) {
    const Vector3d p = (mesh.corners[i] * 1e7).array().round();
    return std::tuple(p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
  };
  std::map<std::pair<decltype(key(0)), decltype(key(0))>, int> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{key(t[i]), key(t[(i + 1) % 3])}];
      --edges[{key(t[(i + 1) % 3]), key(t[i])}];
    }
  return std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
}

void expect_surface(const Shape& shape, double exact_volume, double share) {
  const Mesh mesh = mesh_of(shape);
  ASSERT_FALSE(mesh.triangles.empty());
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_GT(volume(mesh), share * exact_volume);
  EXPECT_LE(volume(mesh), exact_volume * (1.0 + 1e-9));
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) {
    EXPECT_NEAR(shape.signed_distance(mesh.corners[i]), 0.0, 1e-9);
    EXPECT_NEAR(mesh.normals[i].norm(), 1.0, 1e-9);
  }
}

TEST(Mesh, shapes_have_closed_surfaces_of_their_volume) {
  const double r = 0.07, l = 0.2;
  const double ball = 4.0 / 3.0 * M_PI * r * r * r, rod = M_PI * r * r * l;
  expect_surface(Shape::sphere(r), ball, 0.96);
  expect_surface(Shape::capsule(r, l), ball + rod, 0.96);
  expect_surface(Shape::cylinder(r, l), rod, 0.98);
  expect_surface(Shape::box({0.1, 0.2, 0.3}), 0.006, 1.0 - 1e-9);
}

TEST(Mesh, hulls_are_closed_and_hold_their_corners) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 20; ++i) {
    std::vector<Vector3d> points;
    for (int k = 0; k < 30; ++k) points.emplace_back(any(random), any(random), any(random));
    const Mesh mesh = mesh_of(Shape::convex(points));
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_GT(volume(mesh), 0.5);
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vector3d normal = (mesh.corners[b] - mesh.corners[a]).cross(mesh.corners[c] - mesh.corners[a]);
      for (const Vector3d& point : points) EXPECT_LE(normal.dot(point - mesh.corners[a]), 1e-9);
    }
  }
}

TEST(Mesh, round_shapes_have_the_normals_of_the_surface_and_boxes_those_of_their_faces) {
  const Mesh ball = mesh_of(Shape::sphere(0.5));
  for (std::size_t i = 0; i < ball.corners.size(); ++i)
    EXPECT_GT(ball.normals[i].dot(ball.corners[i].normalized()), 0.995);
  const Mesh box = mesh_of(Shape::box({1, 2, 3}));
  for (const Vector3d& normal : box.normals) EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0, 1e-12);
}

TEST(Mesh, voxel_faces_are_a_closed_surface_in_the_map) {
  PageVoxels voxels{"painted", 0.1};
  for (const Vector3d& center :
       {Vector3d(0.05, 0.05, 0.05), Vector3d(0.15, 0.05, 0.05), Vector3d(0.05, 0.15, 0.05)})
    voxels.add(center, 0.1);
  const Mesh mesh = mesh_of(exposed_faces(voxels), voxels.size);
  EXPECT_NEAR(volume(mesh), 3e-3, 1e-9);
  Eigen::AlignedBox3d box;
  for (const Vector3d& corner : mesh.corners) box.extend(corner);
  EXPECT_LT((box.min() - Vector3d::Zero()).norm(), 1e-9);
  EXPECT_LT((box.max() - Vector3d(0.2, 0.2, 0.1)).norm(), 1e-9);
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_GT(
        (mesh.corners[b] - mesh.corners[a]).cross(mesh.corners[c] - mesh.corners[a]).dot(mesh.normals[a]),
        0.0);
}

TEST(Mesh, moves_with_its_frame) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Vector3d(1, 2, 3);
  const Mesh box = mesh_of(Shape::box({1, 2, 3}));
  Mesh two = transformed(box, pose);
  EXPECT_LT((two.corners[5] - pose * box.corners[5]).norm(), 1e-12);
  append(two, box);
  EXPECT_TRUE(is_closed(two));
  EXPECT_NEAR(volume(two), 12.0, 1e-9);
}

}  // namespace mesh_test
