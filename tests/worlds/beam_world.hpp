#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string>

#include "planning/planner_table.hpp"
#include "planning/problem/planner.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {

inline Policies anywhere_but_occupied() {
  Policies policies;
  policies.critical_by_default = false;
  return policies;
}

/// A robot in a map with everything a query needs.
struct BeamWorld {
  ConfigurationSpace space;
  PathCost cost;
  BeamWorld(const Robot& robot, const VoxelScene& scene, const Policies& policies = anywhere_but_occupied())
      : space(robot, scene.snapshot(), policies), cost(robot) {}

  PlanResult plan(const std::string& planner, const Configuration& start, const Configuration& goal,
                  const PlannerOptions& options) const {
    return make_planner(planner, options)->plan({space, cost, start, goal});
  }
};

inline Configuration vector_of(std::initializer_list<double> values) {
  Configuration q(static_cast<Eigen::Index>(values.size()));
  std::copy(values.begin(), values.end(), q.begin());
  return q;
}

/// Same status, path, cost and steps, bit for bit.
inline void expect_equal(const PlanResult& a, const PlanResult& b, const std::string& what) {
  EXPECT_EQ(a.status, b.status) << what;
  EXPECT_EQ(a.waypoints, b.waypoints) << what;
  EXPECT_EQ(a.explored, b.explored) << what;
  EXPECT_EQ(a.cost, b.cost) << what;
  EXPECT_EQ(a.last_segment_cost, b.last_segment_cost) << what;
  EXPECT_EQ(a.search_steps, b.search_steps) << what;
  EXPECT_EQ(a.explanation, b.explanation) << what;
  EXPECT_EQ(a.statistics.at("heads"), b.statistics.at("heads")) << what;
}

}  // namespace clearway
