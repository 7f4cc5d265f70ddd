#pragma once

#include <string>
#include <vector>

#include "datasets/suite.hpp"
#include "mapping/snapshot.hpp"
#include "planning/kinematics.hpp"

namespace clearway {

/// A problem of a suite, ready to be planned.
struct StageProblem {
  std::string name;
  Configuration start;
  std::vector<Configuration> goals;
};

/// A map of a suite and the problems in it.
struct SuiteStage {
  std::string world;
  Snapshot map;
  std::string map_file;  ///< empty when the world is made, not loaded
  std::string digest;    ///< SHA-256 of the map's file form
  std::vector<StageProblem> problems;
};

/// The stages of one experiment, each made when asked for: worlds may be large and many.
class SuiteStages {
 public:
  /// @throws std::invalid_argument naming the suite's file, the field and what was expected: a world or
  /// generator that is not there, a number of joints that does not fit the robot.
  SuiteStages(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot);

  std::size_t size() const;
  /// Deterministic, may be called from any thread.
  SuiteStage make(std::size_t index) const;

 private:
  const Suite& suite_;
  const SuiteExperiment& experiment_;
  const Robot& robot_;
};

}  // namespace clearway
