// Many configurations or edges at once: ConfigurationSpace::is_free and is_edge_free of spans.

#include <algorithm>
#include <cstddef>

#include "planning/batch/piece_lanes.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// The configurations at some places of a list, one lane each; idle lanes repeat the first.
void put(std::span<const Configuration> qs, std::span<const std::size_t> places, PieceLanes& lanes) {
  for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) {
    const Configuration& q = qs[places[lane < places.size() ? lane : 0]];
    for (std::size_t j = 0; j < lanes.q.size(); ++j) lanes.q[j].at[lane] = q[static_cast<Eigen::Index>(j)];
  }
  lanes.want_all(static_cast<int>(places.size()));
}

/// What spheres could not tell of a lane, by shapes.
bool is_free_by_shapes(const CollisionModel& model, const Configuration& q, const PieceLanes& lanes,
                       std::size_t lane) {
  thread_local LinkPoses poses;
  forward_kinematics(model.robot, q, poses);
  const std::size_t bodies = model.bodies.size();
  return std::all_of(lanes.members.begin(), lanes.members.end(), [&](int member) {
    const auto i = static_cast<std::size_t>(member);
    if ((lanes.failed[i] >> lane & 1U) == 0) return true;
    return i < bodies ? model.bodies[i].is_clear(model.pose(poses, i), model.options.padding)
                      : is_apart(model.robot, model.pairs[i - bodies], poses, 0.0);
  });
}

}  // namespace

std::vector<bool> ConfigurationSpace::is_free(std::span<const Configuration> qs) const {
  const CollisionModel& model = *model_;
  std::vector<bool> free(qs.size(), false);
  if (!model.spheres) {
    for (std::size_t i = 0; i < qs.size(); ++i) free[i] = is_free(qs[i]);
    return free;
  }
  PieceLanes& lanes = of_this_thread<PieceLanes>(*model.spheres);
  lanes.moving = false;
  std::vector<std::size_t> places;  // of the configurations that are looked at together
  const auto judge = [&] {
    put(qs, places, lanes);
    look(*model.spheres, lanes);
    const unsigned failing = lanes.failing();
    for (std::size_t lane = 0; lane < places.size(); ++lane) {
      const bool is_open = (failing >> lane & 1U) != 0, is_blocked = (lanes.blocked >> lane & 1U) != 0;
      const Configuration& q = qs[places[lane]];
      free[places[lane]] = !is_open || (!is_blocked && is_free_by_shapes(model, q, lanes, lane));
    }
    places.clear();
  };
  for (std::size_t i = 0; i < qs.size(); ++i) {
    if (!model.is_within_limits(qs[i])) continue;
    if (!model.spheres->suits(qs[i])) {
      free[i] = is_free(qs[i]);
      continue;
    }
    places.push_back(i);
    if (places.size() == PieceLanes::count) judge();
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
