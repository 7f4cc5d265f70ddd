// Many configurations or edges at once: ConfigurationSpace::is_free and is_edge_free of spans.

#include <algorithm>
#include <cstdint>
#include <optional>

#include "planning/batch/piece_lanes.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// Of this thread, for the robot that it looked at last.
PieceLanes& lanes_of(const SphereRobot& robot) {
  thread_local std::optional<PieceLanes> lanes;
  thread_local std::uint64_t id = 0;
  if (!lanes || id != robot.id) lanes.emplace(robot);
  id = robot.id;
  lanes->moving = false;
  return *lanes;
}

/// One lane each; idle lanes repeat the first.
void put(std::span<const Configuration> qs, PieceLanes& lanes) {
  for (std::size_t lane = 0; lane < PieceLanes::count; ++lane) {
    const Configuration& q = qs[lane < qs.size() ? lane : 0];
    for (std::size_t j = 0; j < lanes.q.size(); ++j) lanes.q[j].at[lane] = q[static_cast<Eigen::Index>(j)];
  }
  lanes.want_all(static_cast<int>(qs.size()));
}

/// What spheres could not tell of a lane, by shapes.
bool is_free_by_shapes(const CollisionModel& model, const Configuration& q, const PieceLanes& lanes,
                       std::size_t lane) {
  const LinkPoses poses = forward_kinematics(model.robot, q);
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
  PieceLanes& lanes = lanes_of(*model.spheres);
  std::vector<Configuration> batch;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i <= qs.size(); ++i) {
    if (batch.size() == PieceLanes::count || (i == qs.size() && !batch.empty())) {
      put(batch, lanes);
      look(*model.spheres, lanes);
      for (std::size_t lane = 0; lane < batch.size(); ++lane) {
        free[places[lane]] =
            (lanes.blocked >> lane & 1U) == 0 && is_free_by_shapes(model, batch[lane], lanes, lane);
      }
      batch.clear();
      places.clear();
    }
    if (i == qs.size() || !model.is_within_limits(qs[i])) continue;
    if (!model.spheres->suits(qs[i])) {
      free[i] = is_free(qs[i]);
      continue;
    }
    batch.push_back(qs[i]);
    places.push_back(i);
  }
  return free;
}

std::vector<bool> ConfigurationSpace::is_edge_free(std::span<const Edge> edges) const {
  std::vector<bool> free;
  for (const Edge& edge : edges) free.push_back(is_edge_free(edge.from, edge.to));
  return free;
}

}  // namespace clearway
