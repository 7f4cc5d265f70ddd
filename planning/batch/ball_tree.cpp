#include "planning/batch/ball_tree.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace clearway {
namespace {

constexpr std::size_t leaves_a_node = 4;
constexpr double rounded_up = 1.0 + 2.4e-7;  ///< by a few roundings to float

Eigen::Vector3d middle_of(const BallTree::Ball& ball) { return {ball.x, ball.y, ball.z}; }

BallTree::Ball sphere_around_leaves(std::span<const BallTree::Leaf> leaves) {
  std::vector<BallTree::Ball> balls;
  for (const BallTree::Leaf& leaf : leaves) balls.push_back(leaf.ball);
  return sphere_around(balls);
}

/// Two halves of the balls, cut across the longest side of the box around their middles.
std::array<std::span<BallTree::Leaf>, 2> halves(std::span<BallTree::Leaf> balls) {
  Eigen::AlignedBox3d box;
  for (const BallTree::Leaf& leaf : balls) box.extend(middle_of(leaf.ball));
  int longest = 0;
  box.sizes().maxCoeff(&longest);
  std::stable_sort(balls.begin(), balls.end(), [&](const BallTree::Leaf& a, const BallTree::Leaf& b) {
    return middle_of(a.ball)[longest] < middle_of(b.ball)[longest];
  });
  const std::size_t half = (balls.size() + 1) / 2;
  return {balls.first(half), balls.subspan(half)};
}

}  // namespace

BallTree::Ball sphere_around(std::span<const BallTree::Ball> balls) {
  BallTree::Ball bound{0, 0, 0, -1};
  if (balls.empty()) return bound;
  Eigen::AlignedBox3d box;
  for (const BallTree::Ball& ball : balls) {
    box.extend((middle_of(ball).array() - ball.radius).matrix());
    box.extend((middle_of(ball).array() + ball.radius).matrix());
  }
  const auto radius_about = [&](const Eigen::Vector3d& middle, const BallTree::Ball** farthest) {
    double radius = -1.0;
    for (const BallTree::Ball& ball : balls) {
      const double reach = (middle_of(ball) - middle).norm() + ball.radius;
      if (reach > radius && farthest != nullptr) *farthest = &ball;
      radius = std::max(radius, reach);
    }
    return radius;
  };
  Eigen::Vector3d best = box.center(), middle = best;
  double least = radius_about(middle, nullptr);
  for (int step = 2; step < 14; ++step) {  // draws near to the middle of the smallest (Badoiu, Clarkson 2003)
    const BallTree::Ball* farthest = &balls.front();
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

int BallTree::add(std::vector<Leaf> balls) {
  const int root = static_cast<int>(nodes.size());
  nodes.emplace_back();
  fill(root, balls);
  return root;
}

void BallTree::fill(int node, std::span<Leaf> balls) {
  Node filled;
  filled.bound = sphere_around_leaves(balls);
  const bool is_one_body = std::all_of(balls.begin(), balls.end(),
                                       [&](const Leaf& leaf) { return leaf.body == balls.front().body; });
  if (is_one_body) filled.body = balls.front().body;
  if (balls.size() <= leaves_a_node) {
    filled.first = static_cast<int>(leaves.size());
    leaves.insert(leaves.end(), balls.begin(), balls.end());
    filled.last = static_cast<int>(leaves.size());
    filled.core = core_of(filled);
    nodes[static_cast<std::size_t>(node)] = filled;
    return;
  }
  filled.holds_leaves = false;
  filled.first = static_cast<int>(nodes.size());
  const auto [low, high] = halves(balls);
  std::vector<std::span<Leaf>> parts;
  for (const std::span<Leaf> half : {low, high}) {
    if (balls.size() <= 2 * leaves_a_node) {
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

int BallTree::core_of(const Node& node) const {
  const auto leaf_of = [&](int i) { return node.holds_leaves ? i : nodes[static_cast<std::size_t>(i)].core; };
  int core = leaf_of(node.first);
  for (int i = node.first + 1; i < node.last; ++i) {
    if (leaves[static_cast<std::size_t>(leaf_of(i))].inner > leaves[static_cast<std::size_t>(core)].inner)
      core = leaf_of(i);
  }
  return core;
}

}  // namespace clearway
