// Why a configuration is not free: ConfigurationSpace::check and its sentence.

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

/// How far the body reaches into a cube: the shortest way out along a map axis, metres.
double overlap(const Eigen::AlignedBox3d& body, const Eigen::Vector3d& cube, double edge) {
  const Eigen::Array3d half = Eigen::Array3d::Constant(edge / 2);
  const Eigen::Array3d up = body.max().array() - (cube.array() - half);
  const Eigen::Array3d down = (cube.array() + half) - body.min().array();
  return std::max(0.0, up.min(down).minCoeff());
}

Obstruction obstruction_of(const Snapshot& map, const Requirement& requirement, const Eigen::Vector3d& cube) {
  switch (map.state(cube)) {
    case VoxelState::occupied:
      return Obstruction::occupied;
    case VoxelState::conflict:
      return Obstruction::conflict;
    case VoxelState::seen_free:
      if (requirement.policy == Policy::known_free) return Obstruction::stale;
      break;
    default:
      break;
  }
  return requirement.policy == Policy::painted ? Obstruction::outside_painted : Obstruction::unknown;
}

constexpr double most_cubes = 1e7;  ///< that are looked at for the deepest one

/// The deepest blocked cube of a body that is not clear; of one so large that there are too many of them, one
/// that it meets.
Verdict blocked_by(const BodyCollision& collision, const Eigen::Isometry3d& pose, const Snapshot& map,
                   double padding) {
  const Shape& shape = collision.body().shape;
  const Eigen::Isometry3d map_from_shape = pose * collision.body().link_from_shape;
  const Eigen::AlignedBox3d bounds = shape.bounds(map_from_shape);
  const double edge = collision.space().resolution();
  Verdict verdict;
  verdict.part = collision.body().part;
  const double across = (bounds.sizes().array() + 2.0 * padding).prod();
  if (across > most_cubes * edge * edge * edge) {
    const auto cube = collision.met_cube(pose, padding);
    if (!cube) return verdict;
    verdict.obstruction = obstruction_of(map, collision.space().requirement(), *cube);
    verdict.point = *cube;
    verdict.depth = padding + overlap(bounds, *cube, edge);
    return verdict;
  }
  bool is_met = false;
  collision.visit_near(pose, padding, [&](const Eigen::Vector3d& cube, double) {
    const double reach = overlap(bounds, cube, edge);
    if (is_met && padding + reach <= verdict.depth) return true;  // no distance makes it a deeper one
    const double lower = distance_to_cube(shape, map_from_shape, cube, edge, padding).lower;
    if (lower > padding) return true;
    const double depth = padding - lower + (lower > 0.0 ? 0.0 : reach);
    if (is_met && depth <= verdict.depth) return true;
    is_met = true;
    verdict.point = cube;
    verdict.depth = depth;
    verdict.gap = std::max(lower, 0.0);
    return true;
  });
  if (is_met) verdict.obstruction = obstruction_of(map, collision.space().requirement(), verdict.point);
  return verdict;
}

Verdict limit_verdict(const Robot& robot, const Configuration& q) {
  Verdict verdict;
  if (q.size() != static_cast<Eigen::Index>(robot.dof()) || !q.allFinite()) {
    verdict.obstruction = Obstruction::not_finite;
    return verdict;
  }
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const double value = q[static_cast<Eigen::Index>(j)];
    const double past = std::max(robot.joints[j].lower - value, value - robot.joints[j].upper);
    if (past <= verdict.depth) continue;
    verdict.obstruction = Obstruction::joint_limit;
    verdict.other = robot.joints[j].name;
    verdict.depth = past;
  }
  return verdict;
}

}  // namespace

std::string_view to_string(Obstruction obstruction) {
  switch (obstruction) {
    case Obstruction::none:
      return "none";
    case Obstruction::not_finite:
      return "not_finite";
    case Obstruction::joint_limit:
      return "joint_limit";
    case Obstruction::self_collision:
      return "self_collision";
    case Obstruction::occupied:
      return "occupied";
    case Obstruction::conflict:
      return "conflict";
    case Obstruction::unknown:
      return "unknown";
    case Obstruction::stale:
      return "stale";
    case Obstruction::outside_painted:
      return "outside_painted";
  }
  throw std::logic_error("an obstruction without a word");
}

Verdict ConfigurationSpace::check(const Configuration& q) const {
  const CollisionModel& model = *model_;
  if (Verdict verdict = limit_verdict(model.robot, q); !verdict.is_free()) return verdict;
  const LinkPoses poses = forward_kinematics(model.robot, q);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].is_clear(model.pose(poses, i), model.options.padding)) continue;
    Verdict verdict = blocked_by(model.bodies[i], model.pose(poses, i), model.map, model.options.padding);
    if (!verdict.is_free()) return verdict;
  }
  for (const BodyPair& pair : model.pairs) {
    if (is_apart(model.robot, pair, poses, 0.0)) continue;
    Verdict verdict;
    verdict.obstruction = Obstruction::self_collision;
    verdict.part = model.robot.bodies[static_cast<std::size_t>(pair.first)].part;
    verdict.other = model.robot.bodies[static_cast<std::size_t>(pair.second)].part;
    verdict.point = pair_distance(model.robot, pair, poses).point_a;
    return verdict;
  }
  return {};
}

std::string Verdict::sentence() const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  const auto place = [&] {
    text << " at (" << place_text(point.x()) << ", " << place_text(point.y()) << ", " << place_text(point.z())
         << "), " << std::setprecision(3);
    if (gap > 0.0)
      text << "with its padding alone: it is " << gap * 1000.0 << " mm away";
    else
      text << depth * 1000.0 << " mm deep";
  };
  switch (obstruction) {
    case Obstruction::none:
      text << "free";
      break;
    case Obstruction::not_finite:
      text << "the configuration has the wrong size or is not finite";
      break;
    case Obstruction::joint_limit:
      text << "joint " << shortened(other) << " is " << depth << " (rad or m) past its limit";
      break;
    case Obstruction::self_collision:
      text << shortened(part) << " touches " << shortened(other);
      break;
    case Obstruction::occupied:
      text << shortened(part) << " touches an occupied voxel";
      break;
    case Obstruction::conflict:
      text << shortened(part) << " touches a voxel that is painted free but sensed occupied";
      break;
    case Obstruction::unknown:
      text << shortened(part) << " reaches into unknown space";
      break;
    case Obstruction::stale:
      text << shortened(part) << " reaches into space that was not seen lately enough";
      break;
    case Obstruction::outside_painted:
      text << shortened(part) << " leaves its painted volume";
      break;
  }
  if (!part.empty() && obstruction != Obstruction::self_collision) place();
  return text.str();
}

}  // namespace clearway
