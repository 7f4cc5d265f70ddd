// Many configurations at once against one at a time, and against exact shapes alone.

#include <gtest/gtest.h>

#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace batch_checks_test {

TEST(BatchChecks, ManyConfigurationsAreJudgedAsEachAlone) {
  int free = 0, all = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const Snapshot map = worlds::voxels_about(robot, 7);
    for (const Policies& policies : {Policies{.critical_by_default = false}, Policies{}}) {
      const ConfigurationSpace space(robot, map, policies, {.padding = 0.003});
      Random random(17);
      std::vector<Configuration> qs;
      for (int i = 0; i < 333; ++i) {  // not a multiple of a batch
        qs.push_back(random.configuration(robot));
        if (i % 10 == 0) qs.back()[0] = i % 20 == 0 ? std::nan("") : 1e3;
        if (i % 50 == 7) qs.back() = Eigen::VectorXd::Zero(1 + (robot.dof() == 1 ? 1 : 0));
      }
      const std::vector<bool> together = space.is_free(qs);
      ASSERT_EQ(together.size(), qs.size());
      for (std::size_t i = 0; i < qs.size(); ++i) {
        ASSERT_EQ(together[i], space.collision_model().is_free_by_shapes(qs[i])) << robot.name << " " << i;
        ASSERT_EQ(together[i], space.is_free(qs[i])) << robot.name << " " << i;
        free += together[i];
        ++all;
      }
      for (const std::size_t count : {0, 1, 16, 17})
        ASSERT_TRUE(std::equal(together.begin(), together.begin() + static_cast<std::ptrdiff_t>(count),
                               space.is_free(std::span(qs).first(count)).begin()));
    }
  }
  EXPECT_GT(free, all / 10);
  EXPECT_LT(free, all * 9 / 10);
}

/// Ends of ways from free to blocked configurations, halved until they all but touch.
std::vector<Configuration> near_contact(const CollisionModel& model, int ways) {
  Random random(19);
  std::vector<Configuration> ends;
  for (int i = 0; i < 100 * ways && ends.size() < static_cast<std::size_t>(2 * ways); ++i) {
    Configuration free = random.configuration(model.robot), blocked = random.configuration(model.robot);
    if (!model.is_free_by_shapes(free) || model.is_free_by_shapes(blocked)) continue;
    for (int k = 0; k < 4 + i % 24; ++k) {
      const Configuration middle = (free + blocked) / 2;
      (model.is_free_by_shapes(middle) ? free : blocked) = middle;
    }
    ends.push_back(free);
    ends.push_back(blocked);
  }
  return ends;
}

TEST(BatchChecks, NextToContactTheAnswersAreThoseOfExactShapes) {
  std::size_t judged = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
    const std::vector<Configuration> qs = near_contact(space.collision_model(), 60);
    const std::vector<bool> together = space.is_free(qs);
    for (std::size_t i = 0; i < qs.size(); ++i) {
      EXPECT_EQ(together[i], i % 2 == 0) << robot.name << " " << i;
      EXPECT_EQ(space.is_free(qs[i]), i % 2 == 0) << robot.name << " " << i;
    }
    judged += qs.size();
  }
  EXPECT_GT(judged, 800U);
}

TEST(BatchChecks, ManyEdgesAreJudgedAsEachAlone) {
  const Robot robot = load_robot("arm5");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 8), {.critical_by_default = false});
  Random random(18);
  std::vector<Edge> edges;
  for (int i = 0; i < 100; ++i) {
    const Configuration from = random.configuration(robot);
    edges.push_back({from, from + 0.2 * (random.configuration(robot) - from)});
  }
  const std::vector<bool> together = space.is_edge_free(edges);
  ASSERT_EQ(together.size(), edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i)
    EXPECT_EQ(together[i], space.is_edge_free(edges[i].from, edges[i].to));
}

}  // namespace batch_checks_test
}  // namespace clearway
