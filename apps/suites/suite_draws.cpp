#include "apps/suites/suite_draws.hpp"

#include <algorithm>
#include <numbers>
#include <stdexcept>

namespace clearway {

Configuration draw_configuration(const Robot& robot, SuiteDice& dice) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    q[static_cast<Eigen::Index>(j)] = dice.between(std::max(robot.joints[j].lower, -std::numbers::pi),
                                                   std::min(robot.joints[j].upper, std::numbers::pi));
  }
  return q;
}

SceneShape box_between(const std::string& name, const Eigen::Isometry3d& map_from_frame,
                       const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  SceneShape shape;
  shape.name = name;
  shape.geometry = BoxShape{high - low};
  shape.map_from_shape = map_from_frame * Eigen::Translation3d((low + high) / 2.0);
  return shape;
}

std::vector<StageProblem> draw_problems(const SuiteGenerator& generator, std::size_t index, std::size_t each,
                                        int most_draws, const std::string& scene, const Robot& robot,
                                        const std::function<std::optional<StageProblem>()>& draw) {
  std::vector<StageProblem> problems;
  const std::size_t count = std::min(static_cast<std::size_t>(generator.count) - index * each, each);
  for (int draws = 0; problems.size() < count; ++draws) {
    if (draws == most_draws) {
      throw std::runtime_error(generator.kind + ": no problem found for robot '" + robot.name + "' in " +
                               std::to_string(most_draws) + " draws");
    }
    auto problem = draw();
    if (!problem) continue;
    problem->name = scene + "." + std::to_string(problems.size() + 1);
    problems.push_back(std::move(*problem));
    draws = 0;
  }
  return problems;
}

}  // namespace clearway
