#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/problem_sets/problem_set.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {

/// What becomes a suite.
struct SuiteImport {
  RobotRequest robot;       ///< as the user asks for it
  double resolution = 0.0;  ///< m, edge of a voxel
  std::filesystem::path out;
  std::optional<double> padding = 0.0;  ///< m, of the experiments; none: the robot's position accuracy
};

/// What was written.
struct ImportOutcome {
  std::size_t worlds = 0, problems = 0, experiments = 0;
  std::size_t poses = 0;              ///< problems whose goal was a pose
  std::filesystem::path suite;        ///< empty: there are no problems
  std::vector<std::string> notes;     ///< on the robot, see robot_notes
  std::vector<std::string> left_out;  ///< the set's, and what did not fit the robot
};

/// Which scene a request goes with: the one whose name ends in the same digits, or any when it is alone; of
/// several the one in the same folder. @throws std::invalid_argument naming the request where none or several
/// would do.
std::size_t scene_of(const std::filesystem::path& request, std::span<const ForeignWorld> scenes);

/// Gives a problem its world, and what its request does not say of the robot and its scene does: joints, and
/// the hand. A body in the hand without shapes is the scene's object of its name: then the world is another
/// one of the set, which lacks that object.
void take_scene(std::size_t scene, ForeignProblem& problem, ForeignSet& set);

/// Writes OUT/maps/WORLD for each world, OUT/suite.yaml with OUT/problems/EXPERIMENT.yaml, OUT/hulls/LOAD.txt
/// for loads of many corners, and OUT/import.json, which names objects, groups and what was left out.
/// Problems that move other joints, or hold others elsewhere, make experiments of their own. Joints that a
/// goal does not name stand where the start has them. Goals beyond limits, and of joints that stand
/// elsewhere, are left out, as any other counts. A goal that is a pose becomes joint values, and of several
/// goals one is chosen: see choose_goal. What is in the hand becomes loads.
/// @throws std::invalid_argument when no problem is left or none fits the robot, std::runtime_error when a
/// file cannot be written.
ImportOutcome write_suite(const ForeignSet& set, const SuiteImport& import);

}  // namespace clearway
