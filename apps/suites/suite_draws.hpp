#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_stages.hpp"

namespace clearway {

/// A generator that finds no problem for its robot in as many draws as it takes: one sentence that names
/// both.
class DrawnInVain : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Evenly within the joint limits, turning joints within a turn.
Configuration draw_configuration(const Robot& robot, SuiteDice& dice);

/// A box between two corners of a frame, axes as those of the frame. Metres.
SceneShape box_between(const std::string& name, const Eigen::Isometry3d& map_from_frame,
                       const Eigen::Vector3d& low, const Eigen::Vector3d& high);

/// "for robot 'arm6' under tool painted, other parts not_occupied", for a sentence about draws in vain.
std::string drawn_for(const ConfigurationSpace& space);

/// The problems of scene number `index` of a generator that draws `each` a scene, the last one with what is
/// left of its count. They are called SCENE.1, SCENE.2 and so on.
/// @param space the robot in the scene's map
/// @param draw a problem without a name, or nothing when this draw gave none
/// @throws DrawnInVain when `most_draws` in a row gave none, naming generator, scene, robot and
/// policies; at once where a part must lie in what the map has none of
std::vector<StageProblem> draw_problems(const SuiteGenerator& generator, std::size_t index, std::size_t each,
                                        int most_draws, const std::string& scene,
                                        const ConfigurationSpace& space,
                                        const std::function<std::optional<StageProblem>()>& draw);

}  // namespace clearway
