// Configurations, one or many, and many edges: ConfigurationSpace::is_free, and is_edge_free of spans.

#include <algorithm>
#include <cstddef>

#include "planning/batch/configuration_block.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// What spheres left undecided of a configuration of the block, by shapes.
bool is_rest_free(const CollisionModel& model, const Configuration& q, const ConfigurationBlock& block,
                  std::size_t place) {
  thread_local LinkPoses poses;
  forward_kinematics(model.robot, q, poses);
  const std::size_t bodies = model.bodies.size();
  return std::all_of(block.members.begin(), block.members.end(), [&](int member) {
    const auto i = static_cast<std::size_t>(member);
    if (!ConfigurationBlock::holds(block.failed[i], place)) return true;
    return i < bodies ? model.bodies[i].is_clear(model.pose(poses, i), model.options.padding)
                      : is_apart(model.robot, model.pairs[i - bodies], poses, 0.0);
  });
}

/// What a look at the block found of a configuration in it, and what shapes say where that does not decide.
bool is_found_free(const CollisionModel& model, const Configuration& q, const ConfigurationBlock& block,
                   const ConfigurationBlock::Places& failing, std::size_t place) {
  if (ConfigurationBlock::holds(block.blocked, place)) return false;
  return !ConfigurationBlock::holds(failing, place) || is_rest_free(model, q, block, place);
}

}  // namespace

bool ConfigurationSpace::is_free(const Configuration& q) const {
  const CollisionModel& model = *model_;
  if (!model.is_within_limits(q)) return false;
  if (!model.spheres || !model.spheres->suits(q)) return model.is_free_by_shapes(q);
  ConfigurationBlock& block = of_this_thread<ConfigurationBlock>(*model.spheres);
  block.clear();
  block.add(q);
  look(*model.spheres, block);
  return is_found_free(model, q, block, block.failing(), 0);
}

std::vector<bool> ConfigurationSpace::is_free(std::span<const Configuration> qs) const {
  const CollisionModel& model = *model_;
  std::vector<bool> free(qs.size(), false);
  if (!model.spheres) {
    for (std::size_t i = 0; i < qs.size(); ++i) free[i] = model.is_free_by_shapes(qs[i]);
    return free;
  }
  ConfigurationBlock& block = of_this_thread<ConfigurationBlock>(*model.spheres);
  block.clear();
  std::vector<std::size_t> places;  // of the configurations that are looked at together
  const auto judge = [&] {
    look(*model.spheres, block);
    const ConfigurationBlock::Places failing = block.failing();
    for (std::size_t i = 0; i < places.size(); ++i)
      free[places[i]] = is_found_free(model, qs[places[i]], block, failing, i);
    places.clear();
    block.clear();
  };
  for (std::size_t i = 0; i < qs.size(); ++i) {
    if (!model.is_within_limits(qs[i])) continue;
    if (!model.spheres->suits(qs[i])) {
      free[i] = model.is_free_by_shapes(qs[i]);
      continue;
    }
    places.push_back(i);
    block.add(qs[i]);
    if (places.size() == ConfigurationBlock::most) judge();
  }
  if (!places.empty()) judge();
  return free;
}

std::vector<bool> ConfigurationSpace::is_edge_free(std::span<const Edge> edges) const {
  std::vector<bool> free;
  for (const Edge& edge : edges) free.push_back(is_edge_free(edge.from, edge.to));
  return free;
}

}  // namespace clearway
