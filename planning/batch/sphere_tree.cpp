#include "planning/batch/sphere_tree.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace clearway {
namespace {

constexpr std::size_t leaves_a_node = 4;
constexpr double rounded_up = 1.0 + 2.4e-7;  ///< by a few roundings to float

Eigen::Vector3d middle_of(const SphereTree::FloatSphere& sphere) { return {sphere.x, sphere.y, sphere.z}; }

SphereTree::FloatSphere sphere_around_leaves(std::span<const SphereTree::Leaf> leaves) {
  std::vector<SphereTree::FloatSphere> spheres;
  for (const SphereTree::Leaf& leaf : leaves) spheres.push_back(leaf.sphere);
  return sphere_around(spheres);
}

/// Two halves of the spheres, cut across the longest side of the box around their middles.
std::array<std::span<SphereTree::Leaf>, 2> halves(std::span<SphereTree::Leaf> spheres) {
  Eigen::AlignedBox3d box;
  for (const SphereTree::Leaf& leaf : spheres) box.extend(middle_of(leaf.sphere));
  int longest = 0;
  box.sizes().maxCoeff(&longest);
  std::stable_sort(spheres.begin(), spheres.end(), [&](const SphereTree::Leaf& a, const SphereTree::Leaf& b) {
    return middle_of(a.sphere)[longest] < middle_of(b.sphere)[longest];
  });
  const std::size_t half = (spheres.size() + 1) / 2;
  return {spheres.first(half), spheres.subspan(half)};
}

}  // namespace

SphereTree::FloatSphere sphere_around(std::span<const SphereTree::FloatSphere> spheres) {
  SphereTree::FloatSphere bound{0, 0, 0, -1};
  if (spheres.empty()) return bound;
  Eigen::AlignedBox3d box;
  for (const SphereTree::FloatSphere& sphere : spheres) {
    box.extend((middle_of(sphere).array() - sphere.radius).matrix());
    box.extend((middle_of(sphere).array() + sphere.radius).matrix());
  }
  const auto radius_about = [&](const Eigen::Vector3d& middle, const SphereTree::FloatSphere** farthest) {
    double radius = -1.0;
    for (const SphereTree::FloatSphere& sphere : spheres) {
      const double reach = (middle_of(sphere) - middle).norm() + sphere.radius;
      if (reach > radius && farthest != nullptr) *farthest = &sphere;
      radius = std::max(radius, reach);
    }
    return radius;
  };
  Eigen::Vector3d best = box.center(), middle = best;
  double least = radius_about(middle, nullptr);
  for (int step = 2; step < 14; ++step) {  // draws near to the middle of the smallest (Badoiu, Clarkson 2003)
    const SphereTree::FloatSphere* farthest = &spheres.front();
    const double radius = radius_about(middle, &farthest);
    if (radius < least) best = middle;
    least = std::min(least, radius);
    const double gap = (middle_of(*farthest) - middle).norm();
    if (gap == 0.0) break;
    middle += (middle_of(*farthest) - middle) * (radius / gap / (step + 1));
  }
  const Eigen::Vector3f at = best.cast<float>();
  const double radius = radius_about(at.cast<double>(), nullptr);
  return {at.x(), at.y(), at.z(), static_cast<float>(radius * rounded_up)};
}

int SphereTree::add(std::vector<Leaf> spheres) {
  const int root = static_cast<int>(nodes.size());
  nodes.emplace_back();
  fill(root, spheres);
  return root;
}

void SphereTree::fill(int node, std::span<Leaf> spheres) {
  Node filled;
  filled.bound = sphere_around_leaves(spheres);
  const bool is_one_body = std::all_of(spheres.begin(), spheres.end(),
                                       [&](const Leaf& leaf) { return leaf.body == spheres.front().body; });
  if (is_one_body) filled.body = spheres.front().body;
  if (spheres.size() <= leaves_a_node) {
    filled.first = static_cast<int>(leaves.size());
    leaves.insert(leaves.end(), spheres.begin(), spheres.end());
    filled.last = static_cast<int>(leaves.size());
    filled.core = core_of(filled);
    nodes[static_cast<std::size_t>(node)] = filled;
    return;
  }
  filled.holds_leaves = false;
  filled.first = static_cast<int>(nodes.size());
  const auto [low, high] = halves(spheres);
  std::vector<std::span<Leaf>> parts;
  for (const std::span<Leaf> half : {low, high}) {
    if (spheres.size() <= 2 * leaves_a_node) {
      parts.push_back(half);
      continue;
    }
    for (const std::span<Leaf> part : halves(half)) parts.push_back(part);
  }
  nodes.resize(nodes.size() + parts.size());
  filled.last = static_cast<int>(nodes.size());
  nodes[static_cast<std::size_t>(node)] = filled;
  for (std::size_t i = 0; i < parts.size(); ++i) fill(filled.first + static_cast<int>(i), parts[i]);
  nodes[static_cast<std::size_t>(node)].core = core_of(filled);
}

int SphereTree::core_of(const Node& node) const {
  const auto leaf_of = [&](int i) { return node.holds_leaves ? i : nodes[static_cast<std::size_t>(i)].core; };
  int core = leaf_of(node.first);
  for (int i = node.first + 1; i < node.last; ++i) {
    if (leaves[static_cast<std::size_t>(leaf_of(i))].inner > leaves[static_cast<std::size_t>(core)].inner)
      core = leaf_of(i);
  }
  return core;
}

}  // namespace clearway
