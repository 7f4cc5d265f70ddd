#pragma once

#include <string>
#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/load.hpp"

namespace clearway {

/// What a problem asks of a robot whose values are known: any of the goals.
struct GoalQuestion {
  std::string name;  ///< of the problem, for sentences
  Configuration start;
  std::vector<LegLoad> loads;
  std::vector<ForeignGoal> goals;  ///< joint values in the robot's order, or poses
};

struct GoalChoice {
  Configuration q;
  std::size_t goal = 0;  ///< which of the question's
  bool is_free = false;  ///< false: none of them is
};

/// The joints that move a link.
std::vector<std::string> joints_above(const Robot& robot, const std::string& link);

/// The first goal that is free in the map where all that is not occupied is, `padding` (metres) away, else
/// the first that the robot can take. Of a pose it is, among the configurations that PoseGoals finds, the
/// free one nearest to the start. Deterministic.
/// @throws std::invalid_argument when the robot has no configuration at any of the goals, or not the link
GoalChoice choose_goal(const GoalQuestion& question, const Robot& robot, const Snapshot& map, double padding);

}  // namespace clearway
