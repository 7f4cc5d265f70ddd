#include "planning/advice/paint_advice.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <memory>
#include <optional>
#include <sstream>

#include "mapping/system/plain_text.hpp"
#include "planning/beam/beam_guided.hpp"
#include "planning/beam/via_beam.hpp"
#include "planning/problem/held_to_task.hpp"
#include "planning/robot/reach.hpp"
#include "planning/routes/end_effector.hpp"
#include "planning/routes/free_route.hpp"
#include "planning/space/body_collision.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

using Path = std::vector<Configuration>;

/// The same space where unknown counts as free for every part.
ConfigurationSpace relaxed(const ConfigurationSpace& space) {
  Policies policies;
  for (const auto& [part, policy] : space.policies()) policies.parts[part] = Policy::not_occupied;
  SpaceOptions options = space.options();
  options.seen_within = 0.0;  // asked of known_free alone
  return {space.robot(), space.map(), policies, options};
}

/// A body that has to stay in painted or known space.
struct BoundBody {
  BodyCollision collision;
  double radius;  ///< of a sphere about the middle of its shape that holds it
};

std::vector<BoundBody> bound_bodies(const ConfigurationSpace& space) {
  const Robot& robot = space.robot();
  std::vector<BoundBody> bodies;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& body = robot.bodies[i];
    const BlockedSpace* blocked = space.blocked_space(static_cast<int>(i));
    if (blocked == nullptr || space.policies().at(body.part) == Policy::not_occupied) continue;
    const std::shared_ptr<const BlockedSpace> borrowed(std::shared_ptr<void>(), blocked);
    Eigen::AlignedBox3d reach = reach_box(robot, body);
    const double beyond = space.options().padding + space.map().resolution();
    reach.min().array() -= beyond, reach.max().array() += beyond;
    bodies.push_back({BodyCollision(body, borrowed, reach), body.shape.bounding_radius()});
  }
  return bodies;
}

/// Spheres that hold the bodies wherever they leave their space along the path, or come within half a voxel
/// of leaving it. A sphere that lies within a voxel of one advised before is left out: that one is made a
/// voxel larger for it.
std::vector<PaintHint> missing_paint(const ConfigurationSpace& space, const Path& path) {
  const Robot& robot = space.robot();
  const std::vector<BoundBody> bodies = bound_bodies(space);
  const double voxel = space.map().resolution(), margin = space.options().padding + 0.5 * voxel;
  const double larger = margin + (std::sqrt(3.0) + 1.0) * voxel;
  std::vector<PaintHint> hints;
  const auto look = [&](const Configuration& q) {
    const LinkPoses poses = forward_kinematics(robot, q);
    for (const auto& [collision, radius] : bodies) {
      const Body& body = collision.body();
      const Eigen::Isometry3d& pose = poses[static_cast<std::size_t>(body.link)];
      if (collision.is_clear(pose, margin)) continue;
      const Sphere sphere{pose * body.link_from_shape.translation(), radius + larger};
      const bool known = std::any_of(hints.begin(), hints.end(), [&](const PaintHint& hint) {
        return hint.part == body.part && hint.sphere.radius >= sphere.radius &&
               (hint.sphere.center - sphere.center).norm() <= voxel;
      });
      if (!known) hints.push_back({sphere, body.part});
    }
  };
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::VectorXd edge = path[i] - path[i - 1];
    const int pieces = 1 + static_cast<int>(space.motion_bound(edge.cwiseAbs()) / (0.5 * voxel));
    for (int k = 0; k < pieces; ++k) look(path[i - 1] + edge * (static_cast<double>(k) / pieces));
  }
  if (!path.empty()) look(path.back());
  return hints;
}

/// A path in the relaxed space along the route for the hand that keeps to the paint where it can.
Path path_near_paint(const PlanProblem& strict, const PlanProblem& free) {
  const Robot& robot = strict.space.robot();
  const EndEffector hand = find_end_effector(strict.space);
  const BlockedSpace& paint = hand.blocked(strict.space);
  const BlockedSpace& open = hand.blocked(free.space);
  const double voxel = strict.space.map().resolution();
  const Eigen::Vector3d from = hand.position(robot, strict.start), to = hand.position(robot, strict.goal);
  Eigen::AlignedBox3d bounds = reach_box(robot, robot.bodies[static_cast<std::size_t>(hand.body)]);
  Eigen::AlignedBox3d about = strict.space.map().bounds();
  about.extend(from).extend(to);
  about.min().array() -= 4.0 * hand.outer_radius, about.max().array() += 4.0 * hand.outer_radius;
  bounds = bounds.intersection(about);
  const EndEffectorRoute route = free_route(
      open, bounds, from, to, hand.inner_radius, 2.0 * voxel,
      [&](const Eigen::Vector3d& point, double) {
        const double clearance = paint.clearance(point), most = paint.max_distance();
        return clearance >= std::min(hand.outer_radius, most)   ? 1.0
               : clearance >= std::min(hand.inner_radius, most) ? 5.0
                                                                : 30.0;
      },
      free.out_of_time);
  if (route.points.empty()) return {};
  return search_via_regions(free, hand, route, joint_weights(free.space, 0.0), {}).waypoints;
}

/// Of the places from `first` to `last` those where a stroke has to turn: straight from one to the next it is
/// no farther than this from those between (Douglas and Peucker 1973). Without the first, with the last one.
void turns_between(const std::vector<PaintHint>& hints, std::size_t first, std::size_t last, double farthest,
                   std::vector<std::size_t>& turns) {
  const Eigen::Vector3d from = hints[first].sphere.center, way = hints[last].sphere.center - from;
  std::size_t worst = last;
  double most = farthest;
  for (std::size_t i = first + 1; i < last; ++i) {
    const Eigen::Vector3d beside = hints[i].sphere.center - from;
    const double share = way.isZero(0.0) ? 0.0 : std::clamp(beside.dot(way) / way.squaredNorm(), 0.0, 1.0);
    if (const double distance = (beside - share * way).norm(); distance > most) most = distance, worst = i;
  }
  if (worst != last) {
    turns_between(hints, first, worst, farthest, turns);
    turns_between(hints, worst, last, farthest, turns);
  } else {
    turns.push_back(last);
  }
}

/// The same, no more than a sentence takes.
std::vector<std::size_t> turns_of_stroke(const std::vector<PaintHint>& hints, std::size_t first,
                                         std::size_t last) {
  constexpr std::size_t most = 6;
  std::vector<std::size_t> turns;
  double farthest = 0.25 * hints[first].sphere.radius;
  do {
    turns.clear();
    turns_between(hints, first, last, farthest, turns);
    farthest *= 1.5;
  } while (turns.size() > most);
  return turns;
}

void write_place(std::ostream& text, const Eigen::Vector3d& place) {
  text << '(' << place.x() << ", " << place.y() << ", " << place.z() << ')';
}

void write_sphere(std::ostream& text, const Sphere& sphere) {
  text << std::lround(1000.0 * sphere.radius) << " mm around " << std::setprecision(3);
  write_place(text, sphere.center);
}

}  // namespace

std::string PaintAdvice::sentence() const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::fixed;
  if (way_exists) text << "beam_guided finds a path that needs no more paint";
  if (spheres.empty()) return text.str() + (way_exists ? "." : "");
  text << (way_exists ? "; for this planner painting would connect start and goal: "
                      : "Painting would connect start and goal: ");
  std::size_t strokes = 0;
  for (std::size_t i = 0; i < spheres.size();) {  // spheres that follow each other and overlap are one stroke
    std::size_t last = i;
    while (last + 1 < spheres.size() && spheres[last + 1].part == spheres[i].part &&
           (spheres[last + 1].sphere.center - spheres[last].sphere.center).norm() <
               spheres[last].sphere.radius) {
      ++last;
    }
    if (strokes++ > 0) text << "; ";
    write_sphere(text, spheres[i].sphere);
    if (last > i) {
      const std::vector<std::size_t> turns = turns_of_stroke(spheres, i, last);
      for (std::size_t turn = 0; turn < turns.size(); ++turn) {
        text << (turn + 1 < turns.size() ? (turn == 0 ? ", on through " : ", ")
                                         : (turns.size() > 1 ? " and to " : " and on to "));
        write_place(text, spheres[turns[turn]].sphere.center);
      }
    }
    text << " for " << shortened(spheres[i].part);
    i = last + 1;
    if (strokes == 4 && i < spheres.size()) {
      text << "; and " << spheres.size() - i << " balls more";
      break;
    }
  }
  text << '.';
  return text.str();
}

PaintAdvice advise_paint(const Planner& planner, const PlanProblem& problem, bool follows_lattice) {
  PaintAdvice advice;
  const auto is_bound = [](const auto& entry) { return entry.second != Policy::not_occupied; };
  const auto& policies = problem.space.policies();
  if (std::none_of(policies.begin(), policies.end(), is_bound)) return advice;
  const ConfigurationSpace open = relaxed(problem.space);
  const PlanProblem free{open, problem.cost, problem.start, problem.goal, problem.seed, problem.out_of_time};
  if (check_ends(free).status != PlanStatus::solved) return advice;

  if (dynamic_cast<const BeamGuided*>(&planner) == nullptr) {
    advice.way_exists = BeamGuided({.max_samples = 20000}).plan(problem).status == PlanStatus::solved;
  }
  const PlanResult own = held_to_task(planner, free);
  std::optional<std::vector<PaintHint>> ours, other;
  if (own.status == PlanStatus::solved) ours = missing_paint(problem.space, own.waypoints);
  const Path near_paint = path_near_paint(problem, free);
  if (!near_paint.empty()) other = missing_paint(problem.space, near_paint);
  const bool takes_other =
      other && !other->empty() && (!ours || (!follows_lattice && 2 * other->size() < ours->size()));
  if (takes_other || ours) advice.spheres = takes_other ? std::move(*other) : std::move(*ours);
  return advice;
}

}  // namespace clearway
