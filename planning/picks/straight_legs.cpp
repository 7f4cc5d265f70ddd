#include "planning/picks/straight_legs.hpp"

#include <algorithm>

#include "planning/picks/straight_motion.hpp"

namespace clearway {
namespace {

constexpr double straight_step = 0.01;                       ///< m of the tip, full size
constexpr double least_sinking = 1e-4, most_sinking = 1e-3;  ///< m; as Pick says

using Path = std::vector<Configuration>;

/// Whether a way is free; else `farthest` hears what stands in it, of its first waypoint that is not.
bool require_free(bool is_free, const std::string& what, const ConfigurationSpace& space, const Path& path,
                  int step, Farthest& farthest) {
  if (is_free) return true;
  if (step <= farthest.step) return false;  // a sentence that nobody reads
  const auto blocked =
      std::find_if(path.begin(), path.end(), [&](const Configuration& q) { return !space.is_free(q); });
  farthest.fail(step, what + ": " +
                          (blocked == path.end() ? "it cannot be proved between waypoints"
                                                 : space.check(*blocked).sentence()));
  return false;
}

Path joined(Path first, const Path& rest) {
  first.insert(first.end(), rest.begin() + 1, rest.end());
  return first;
}

}  // namespace

StraightLegs::StraightLegs(PickScene& scene, const ConfigurationSpace& space, const Pick& pick)
    : scene_(scene),
      robot_(space.robot()),
      pick_(pick),
      padding_(space.options().padding),
      contact_(contact_length(pick, space.map().resolution(), padding_)),
      step_(straight_step * robot_.scale) {}

std::optional<Taking> StraightLegs::take(const Hold& grasp, Farthest& farthest) {
  const Configuration open = with_grip(robot_, pick_, grasp.q, false),
                      closed = with_grip(robot_, pick_, grasp.q, true);
  for (const auto& [space, q] : {std::pair(&scene_.reaching(), &open), {&scene_.grasping(), &closed}})
    if (!require_free(space->is_free(*q), "no grasp is free", *space, {*q}, 0, farthest)) return std::nullopt;
  const auto back = straight_motion(robot_, open, -pick_.approach, step_);
  const auto up = upwards(closed);
  if (!back || !up) {
    farthest.fail(1, "no arm configuration at the grasp can go the straight ways of approach and lift");
    return std::nullopt;
  }
  Path reach(back->rbegin(), back->rend());
  const ConfigurationSpace &before = scene_.before(), &reaching = scene_.reaching(),
                           &grasping = scene_.grasping();
  if (!require_free(before.is_free(reach.front()), "no free configuration before the grasp", before,
                    {reach.front()}, 2, farthest) ||
      !require_free(is_path_free(reaching, reach), "the straight way to the grasp is not free", reaching,
                    reach, 3, farthest) ||
      !require_free(grasping.is_edge_free(open, closed), "the hand cannot close", grasping, {open, closed}, 4,
                    farthest))
    return std::nullopt;
  if (closed != open) reach.push_back(closed);
  const Eigen::Isometry3d turned =
      pick_.map_from_object * Eigen::AngleAxisd(grasp.turn, Eigen::Vector3d::UnitZ());
  scene_.hold(link_pose(closed).inverse() * turned, closed);
  const std::string lift = "the straight way up from the grasp is not free" + margin_hint();
  const ConfigurationSpace &lifting = scene_.lifting(), &carrying = scene_.carrying();
  if (!require_free(is_contact_free(lifting, pick_.map_from_object, up->first), lift, lifting, up->first, 5,
                    farthest) ||
      !require_free(is_path_free(carrying, up->second), lift, carrying, up->second, 5, farthest))
    return std::nullopt;
  return Taking{grasp, reach, joined(up->first, up->second)};
}

std::optional<Putting> StraightLegs::put(const Taking& taking, const Configuration& placed,
                                         Farthest& farthest) {
  const auto up = upwards(placed);
  const Eigen::Matrix3d turned =
      tip_pose(robot_, placed).linear() * tip_pose(robot_, taking.grasp.q).linear().transpose();
  const Eigen::Vector3d back = -(turned * pick_.approach);
  const Configuration open = with_grip(robot_, pick_, placed, false);
  auto retreat = straight_motion(robot_, open, back, step_);
  if (!up || !retreat) {
    farthest.fail(0, "no arm configuration at the place can go the straight ways of lowering and retreat");
    return std::nullopt;
  }
  const std::string down = "the straight way down to the place is not free";
  const ConfigurationSpace &lowering = scene_.lowering(), &carrying = scene_.carrying(),
                           &releasing = scene_.releasing(), &retreating = scene_.retreating();
  if (!require_free(is_contact_free(lowering, pick_.map_from_place, up->first), down, lowering, up->first, 1,
                    farthest) ||
      !require_free(is_path_free(carrying, up->second), down, carrying, up->second, 1, farthest) ||
      !require_free(releasing.is_edge_free(placed, open), "the hand cannot open", releasing, {placed, open},
                    2, farthest) ||
      !require_free(is_path_free(retreating, *retreat), "the straight way back from the place is not free",
                    retreating, *retreat, 3, farthest))
    return std::nullopt;
  if (open != placed) retreat->insert(retreat->begin(), placed);
  const Path upward = joined(up->first, up->second);
  return Putting{{upward.rbegin(), upward.rend()}, *retreat, back};
}

Path StraightLegs::way_with_load(const Configuration& from, const Eigen::Vector3d& way) {
  const auto straight = straight_motion(robot_, from, way, step_);
  Path free = {from};
  for (std::size_t i = 1; straight && i < straight->size(); ++i) {
    if (!scene_.carrying().is_edge_free(free.back(), (*straight)[i])) break;
    free.push_back((*straight)[i]);
  }
  return free;
}

/// Voxels beside the object that are of it and in the way.
std::string StraightLegs::margin_hint() const {
  return pick_.margin > 0.0 ? "" : " (voxels beside the object are its own with a `margin`)";
}

/// The pose of the link that carries the object.
Eigen::Isometry3d StraightLegs::link_pose(const Configuration& q) const {
  const LinkPoses poses = forward_kinematics(robot_, q);
  for (std::size_t i = 0; i < robot_.links.size(); ++i)
    if (robot_.links[i].name == pick_.object.link) return poses[i];
  return poses.front();
}

/// Straight up from where the object stands: on the support first, with a waypoint where that ends.
std::optional<std::pair<Path, Path>> StraightLegs::upwards(const Configuration& from) const {
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  auto first = straight_motion(robot_, from, contact_ * up, step_);
  if (!first) return std::nullopt;
  Path rest = {first->back()};
  if (pick_.lift > contact_) {
    auto more = straight_motion(robot_, first->back(), (pick_.lift - contact_) * up, step_);
    if (!more) return std::nullopt;
    rest = std::move(*more);
  }
  return std::pair(std::move(*first), std::move(rest));
}

/// Whether the part of a straight way on the support is free: of the robot alone, of the robot with the
/// object where the support's layer is, and at a height at which the object neither sinks in nor leaves it.
bool StraightLegs::is_contact_free(const ConfigurationSpace& on_layer,
                                   const Eigen::Isometry3d& map_from_object, const Path& on_support) {
  const double plane = pick_.object.shape.bounds(map_from_object).min().z();
  const double sinking = std::clamp(padding_, least_sinking, most_sinking);
  return is_path_free(scene_.bare(), on_support) && is_path_free(on_layer, on_support) &&
         keeps_height(on_layer.robot(), on_layer.robot().bodies.size() - 1, on_support, plane - sinking,
                      plane + contact_ + sinking);
}

}  // namespace clearway
