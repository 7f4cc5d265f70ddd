#include "planning/batch/sphere_tree.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace sphere_tree_test {

std::vector<SphereTree::Leaf> draw(Random& random, int count) {
  std::vector<SphereTree::Leaf> leaves;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f at = random.point(1.0).cast<float>();
    const auto radius = static_cast<float>(random.between(0.01, 0.2));
    leaves.push_back({{at.x(), at.y(), at.z(), radius}, static_cast<float>(random.between(-0.1, 0.1)), i, i});
  }
  return leaves;
}

double beyond(const SphereTree::FloatSphere& bound, const SphereTree::FloatSphere& sphere) {
  const Eigen::Vector3d way(double(sphere.x) - bound.x, double(sphere.y) - bound.y,
                            double(sphere.z) - bound.z);
  return way.norm() + double(sphere.radius) - double(bound.radius);
}

/// All leaves below the node, which has to hold them; marks each as seen.
void expect_held(const SphereTree& tree, int index, std::vector<int>& seen, float& core) {
  const SphereTree::Node& node = tree.nodes[static_cast<std::size_t>(index)];
  std::vector<int> below(tree.leaves.size(), 0);
  float best = -1.0F;
  for (int i = node.first; i < node.last; ++i) {
    if (node.holds_leaves) {
      ++below[static_cast<std::size_t>(i)];
      best = std::max(best, tree.leaves[static_cast<std::size_t>(i)].inner);
      continue;
    }
    float core_below = -1.0F;
    expect_held(tree, i, below, core_below);
    best = std::max(best, core_below);
  }
  EXPECT_EQ(tree.leaves[static_cast<std::size_t>(node.core)].inner, best);
  core = best;
  for (std::size_t i = 0; i < below.size(); ++i) {
    seen[i] += below[i];
    if (below[i] == 0) continue;
    EXPECT_LE(beyond(node.bound, tree.leaves[i].sphere), 0.0);
    EXPECT_TRUE(node.body < 0 || node.body == tree.leaves[i].body);
  }
}

TEST(SphereTree, EveryNodeHoldsWhatIsBelowItAndEverySphereIsInOnce) {
  Random random(1);
  SphereTree tree;
  for (int count = 1; count < 80; count += 3) {
    const std::size_t before = tree.leaves.size();
    const int root = tree.add(draw(random, count));
    std::vector<int> seen(tree.leaves.size(), 0);
    float core = 0.0F;
    expect_held(tree, root, seen, core);
    for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i], i < before ? 0 : 1);
  }
}

TEST(SphereTree, ASphereAroundSpheresHoldsThemAndIsNotMuchLargerThanItMustBe) {
  Random random(2);
  for (int round = 0; round < 100; ++round) {
    std::vector<SphereTree::FloatSphere> spheres;
    for (const SphereTree::Leaf& leaf : draw(random, 1 + round % 9)) spheres.push_back(leaf.sphere);
    const SphereTree::FloatSphere bound = sphere_around(spheres);
    double widest = 0.0;  // of any two: no sphere around them is narrower
    for (const SphereTree::FloatSphere& a : spheres) {
      EXPECT_LE(beyond(bound, a), 0.0);
      for (const SphereTree::FloatSphere& b : spheres)
        widest = std::max(widest, beyond({a.x, a.y, a.z, 0.0F}, b) + double(a.radius));
    }
    EXPECT_LT(bound.radius, 0.5 * widest * 1.3);
  }
  EXPECT_LT(sphere_around({}).radius, 0.0F);
}

/// The least radius of a sphere around all, by many small steps toward the farthest.
double least_radius(const std::vector<SphereTree::FloatSphere>& spheres) {
  Eigen::Vector3d middle(spheres[0].x, spheres[0].y, spheres[0].z);
  double least = 1e9;
  for (int step = 1; step < 1'500; ++step) {
    double radius = 0.0;
    Eigen::Vector3d farthest = middle;
    for (const SphereTree::FloatSphere& sphere : spheres) {
      const Eigen::Vector3d at(sphere.x, sphere.y, sphere.z);
      const double reach = (at - middle).norm() + double(sphere.radius);
      if (reach > radius) radius = reach, farthest = at;
    }
    least = std::min(least, radius);
    if (farthest == middle) return least;
    middle += (farthest - middle).normalized() * (radius / (step + 1));
  }
  return least;
}

TEST(SphereTree, ASphereAroundSpheresIsNearlyTheLeastOne) {
  Random random(3);
  double sum = 0.0, worst = 1.0;
  constexpr int rounds = 200;
  for (int round = 0; round < rounds; ++round) {
    std::vector<SphereTree::FloatSphere> spheres;
    for (const SphereTree::Leaf& leaf : draw(random, 2 + round % 9)) spheres.push_back(leaf.sphere);
    const double ratio = double(sphere_around(spheres).radius) / least_radius(spheres);
    EXPECT_GT(ratio, 0.998);
    worst = std::max(worst, ratio);
    sum += ratio;
  }
  EXPECT_LT(sum / rounds, 1.0145);  // of a dozen steps
  EXPECT_LT(worst, 1.045);
}

TEST(SphereTree, HalvesDifferByOneSphereAtMostSoThatLeavesAreFull) {
  Random random(2);
  for (const auto& [balls, nodes] :
       {std::pair(4, 1U), std::pair(8, 3U), std::pair(16, 5U), std::pair(64, 21U)}) {
    SphereTree tree;
    tree.add(draw(random, balls));
    EXPECT_EQ(tree.nodes.size(), nodes) << balls;  // four below each, but for the root of eight
    for (const SphereTree::Node& node : tree.nodes) {
      EXPECT_EQ(node.count(), balls == 8 && !node.holds_leaves ? 2 : 4) << balls;
    }
  }
}

}  // namespace sphere_tree_test
}  // namespace clearway
