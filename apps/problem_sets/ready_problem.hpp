#pragma once

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "apps/problem_sets/goal_choice.hpp"

namespace clearway {

/// What moves in an experiment, and with it where the rest stands.
struct ExperimentMotion {
  std::string name, group;
  std::map<std::string, double> fixed;  ///< joints by name, radians or metres
  bool operator<(const ExperimentMotion& other) const {
    return std::tie(name, group, fixed) < std::tie(other.name, other.group, other.fixed);
  }
};

/// A problem whose robot is known; its goal is chosen when its map is there.
struct ReadyProblem {
  std::size_t index = 0;  ///< in the set
  ExperimentMotion motion;
  GoalQuestion question;
  GoalChoice choice{};
  std::string experiment{}, name{};  ///< in the suite
};

/// The problems of a set that fit the robot, and its worlds, whose maps are written.
struct ReadySuite {
  std::vector<ReadyProblem> problems;
  std::vector<std::string> world_words;         ///< folders below maps/, in the order of the set's worlds
  std::vector<std::vector<std::size_t>> cells;  ///< of each world's solids, voxels
};

}  // namespace clearway
