#include "apps/suites/suite_draws.hpp"

#include <algorithm>
#include <numbers>

#include "apps/query/query.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

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

std::string drawn_for(const ConfigurationSpace& space) {
  return "for robot " + quote(space.robot().name) + " under " + describe_policies(space.policies(), 0.0);
}

namespace {

/// Why no configuration can be free, however many are drawn; else empty.
std::string hopeless(const ConfigurationSpace& space) {
  const VoxelCounts counts = space.map().counts();
  const std::size_t painted = counts.painted + counts.conflict;
  for (const auto& [part, policy] : space.policies()) {
    const bool needs_paint = policy == Policy::painted, needs_known = policy == Policy::known_free;
    if ((needs_paint && painted == 0) || (needs_known && painted + counts.seen_free == 0))
      return "part " + quote(part) + " must lie in " + (needs_paint ? "paint" : "what is known to be free") +
             ", of which its map has none; expected other `policies`, such as {default: not_occupied}";
  }
  return {};
}

}  // namespace

std::vector<StageProblem> draw_problems(const SuiteGenerator& generator, std::size_t index, std::size_t each,
                                        int most_draws, const std::string& scene,
                                        const ConfigurationSpace& space,
                                        const std::function<std::optional<StageProblem>()>& draw) {
  const std::string none = generator.kind + ": no problem found " + drawn_for(space) + " in " + quote(scene);
  if (const std::string why = hopeless(space); !why.empty()) throw DrawnInVain(none + ": " + why);
  std::vector<StageProblem> problems;
  const std::size_t count = std::min(static_cast<std::size_t>(generator.count) - index * each, each);
  for (int draws = 0; problems.size() < count; ++draws) {
    if (draws == most_draws) throw DrawnInVain(none + ", in " + grouped(most_draws) + " draws");
    auto problem = draw();
    if (!problem) continue;
    problem->name = scene + "." + std::to_string(problems.size() + 1);
    problems.push_back(std::move(*problem));
    draws = 0;
  }
  return problems;
}

}  // namespace clearway
