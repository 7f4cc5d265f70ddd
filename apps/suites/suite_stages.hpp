#pragma once

#include <string>
#include <vector>

#include "datasets/descriptions/suite.hpp"
#include "mapping/snapshot.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot/load.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// A problem of a suite, ready to be planned.
struct StageProblem {
  std::string name;
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<LegLoad> loads = {};
  SuiteView view = {};
};

/// A map of a suite and the problems in it.
struct SuiteStage {
  std::string world;
  Snapshot map;
  std::string map_file;  ///< empty when the world is made, not loaded
  std::string digest;    ///< SHA-256 of the map's file form, as map_sha256
  std::vector<StageProblem> problems;
};

/// The policies of an experiment for this robot; "default" is that of every part that is not named.
/// @throws std::invalid_argument naming a part that the robot does not have.
Policies suite_policies(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot);

/// What a reader should know of a world's map that is a cloud, a sentence; else empty. @param map its own
std::string note_on_cloud(const SuiteWorld& world, const Snapshot& map);

/// The stages of one experiment, each made when asked for: worlds may be large and many.
class SuiteStages {
 public:
  /// Keeps references to all three. @param robot scaled and placed as the experiment wants it
  /// @throws std::invalid_argument naming the suite, the experiment, the field and what was expected: a world
  /// or generator that is not there or that the robot does not suit, a number of joints that does not fit the
  /// robot, an unknown part, a load that the robot cannot carry.
  SuiteStages(const Suite& suite, const SuiteExperiment& experiment, const Robot& robot);

  std::size_t size() const;
  /// What a reader should know of maps that are clouds (cloud_remark), a sentence each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// How many problems a stage has, at most, without making it.
  std::size_t problems(std::size_t index) const;
  /// Deterministic, may be called from any thread. Worlds that are made take up to some seconds each.
  /// @throws std::invalid_argument or DamagedFile when a map cannot be loaded, DrawnInVain (suite_draws.hpp)
  /// when a generator finds no problem for this robot.
  SuiteStage make(std::size_t index) const;

 private:
  const Suite& suite_;
  const SuiteExperiment& experiment_;
  const Robot& robot_;
  std::vector<std::string> worlds_;  ///< of explicit problems, a stage each
  std::vector<std::string> notes_;
};

/// Joint values of a suite file as a configuration.
Configuration configuration(const std::vector<double>& values);

}  // namespace clearway
