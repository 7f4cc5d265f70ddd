#include "tests/evidence/pick_evidence.hpp"

#include <cmath>
#include <optional>

#include "apps/suites/suite_cells.hpp"
#include "apps/suites/suite_dice.hpp"
#include "apps/suites/suite_draws.hpp"
#include "planning/picks/pick_scene.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "planning/robot/follow_tip.hpp"
#include "planning/robot/goal_configurations.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::evidence {
namespace {

constexpr double resolution = 0.02;

/// An arm, how high its shoulder is, and how its hand takes things. Metres.
struct Arm {
  const char* name;
  double shoulder;
  double widest;  ///< radius of what fits between its fingers
  double depth;   ///< how far the tip reaches past the object's near face
};
constexpr Arm arms[] = {
    {"puma560", 0.6718, 0.035, 0.0}, {"panda", 0.333, 0.03, 0.02}, {"arm6", 0.0892, 0.03, 0.02}};

struct Problem {
  std::string what;
  std::vector<SceneShape> solids;
  Pick pick;
  Configuration start;
};

SceneShape solid_of(const Pick& pick) {
  SceneShape solid;
  solid.name = pick.object.name;
  solid.map_from_shape = pick.map_from_object;
  if (pick.object.shape.kind() == Shape::Kind::box)
    solid.geometry = BoxShape{pick.object.shape.edges()};
  else
    solid.geometry = CylinderShape{pick.object.shape.radius(), pick.object.shape.length()};
  return solid;
}

void draw_object(const Arm& arm, SuiteDice& dice, Pick& pick) {
  const double height = dice.between(0.08, 0.14);
  pick.object.name = "object";
  pick.object.mass = dice.between(0.1, 1.0);
  if (dice.whole(0, 1) == 0)
    pick.object.shape = Shape::cylinder(dice.between(0.015, arm.widest), height);
  else
    pick.object.shape =
        Shape::box({dice.between(0.03, 1.4 * arm.widest), dice.between(0.03, 1.4 * arm.widest), height});
}

double height_of(const Shape& shape) { return shape.bounds(Eigen::Isometry3d::Identity()).sizes().z(); }

/// A table with things on it; the hand comes from above.
void draw_table(const Arm& arm, SuiteDice& dice, Problem& problem) {
  const double top = arm.shoulder - dice.between(0.05, 0.3);
  problem.solids.push_back(
      box_between("table", Eigen::Isometry3d::Identity(), {0.28, -0.6, top - 0.04}, {0.95, 0.6, top}));
  Pick& pick = problem.pick;
  const auto place = [&](double y_low, double y_high) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() << dice.between(0.38, 0.6), dice.between(y_low, y_high),
        top + height_of(pick.object.shape) / 2.0;
    pose.linear() = Eigen::AngleAxisd(dice.between(-1.0, 1.0), Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return pose;
  };
  const double side = dice.whole(0, 1) == 0 ? 1.0 : -1.0;
  pick.map_from_object = side > 0 ? place(0.15, 0.35) : place(-0.35, -0.15);
  pick.map_from_place = side > 0 ? place(-0.35, -0.15) : place(0.15, 0.35);
  for (int i = dice.whole(1, 3); i > 0; --i) {  // between both
    const double x = dice.between(0.35, 0.7), y = dice.between(-0.06, 0.06), half = dice.between(0.02, 0.04);
    problem.solids.push_back(box_between("thing", Eigen::Isometry3d::Identity(), {x - half, y - half, top},
                                         {x + half, y + half, top + dice.between(0.05, 0.25)}));
  }
  const double down = height_of(pick.object.shape) / 2.0 - arm.depth;
  pick.object_from_tip =
      Eigen::Translation3d(0.0, 0.0, down) * Eigen::AngleAxisd(180.0 * degree, Eigen::Vector3d::UnitX());
  pick.approach = {0.0, 0.0, -0.12};
  pick.lift = dice.between(0.06, 0.12);
}

/// A shelf of two boards before the arm; the hand comes from the front.
void draw_shelf(const Arm& arm, SuiteDice& dice, Problem& problem) {
  const double row = dice.between(0.36, 0.44), front = dice.between(0.42, 0.5), back = front + 0.3;
  const double low = arm.shoulder - dice.between(0.2, 0.35), column = 0.45;
  const Eigen::Isometry3d map = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 3; ++i)
    problem.solids.push_back(
        box_between("board", map, {front, -column, low + i * row - 0.02}, {back, column, low + i * row}));
  for (const double y : {-column, 0.0, column})
    problem.solids.push_back(
        box_between("side", map, {front, y - 0.01, low}, {back, y + 0.01, low + 2 * row}));
  problem.solids.push_back(
      box_between("back", map, {back, -column, low}, {back + 0.02, column, low + 2 * row}));
  Pick& pick = problem.pick;
  const auto place = [&](int compartment) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const double y = (compartment % 2 == 0 ? -0.5 : 0.5) * column + dice.between(-0.08, 0.08);
    pose.translation() << front + dice.between(0.06, 0.12), y,
        low + (compartment / 2) * row + height_of(pick.object.shape) / 2.0;
    return pose;
  };
  const int from = dice.whole(0, 3), to = (from + dice.whole(1, 3)) % 4;
  pick.map_from_object = place(from);
  pick.map_from_place = place(to);
  const double half = pick.object.shape.bounds(map).sizes().x() / 2.0;
  // The tip's z axis points into the shelf, its fingers close along y.
  Eigen::Matrix3d turn;
  turn.col(2) = Eigen::Vector3d::UnitX();
  turn.col(1) = Eigen::Vector3d::UnitY();
  turn.col(0) = turn.col(1).cross(turn.col(2));
  pick.object_from_tip.linear() = turn;
  pick.object_from_tip.translation() << -half + arm.depth, 0.0, 0.02;
  pick.approach = {0.15, 0.0, 0.0};
  pick.lift = dice.between(0.05, 0.07);
}

/// Whether the tip can be led straight there, without a joint at its limit, free of obstacles every 5 mm; the
/// first `contact` metres in `first`, the others in `then`. `robot` holds nothing.
bool can_go(const Robot& robot, Configuration q, const Eigen::Vector3d& way, const ConfigurationSpace& first,
            double contact, const ConfigurationSpace& then) {
  const Eigen::Isometry3d begin = tip_pose(robot, q);
  const int steps = static_cast<int>(std::ceil(way.norm() / 0.005));
  for (int i = 1; i <= steps; ++i) {
    const FollowedTip next = follow_tip(robot, Eigen::Translation3d(way * i / steps) * begin, q);
    const double gone = way.norm() * i / steps;
    if (!next.is_reached || !(gone <= contact ? first : then).is_free(next.q)) return false;
    q = next.q;
  }
  return true;
}

/// Whether at both ends some configuration holds the object there, from which the straight ways are free. The
/// planner has to find two of them, and the ways to and between them, which may not exist.
bool are_ends_possible(const ConfigurationSpace& space, const Pick& pick, const Configuration& start) {
  PickScene scene(space, pick, {});
  const Robot& robot = space.robot();
  const double contact = contact_length(pick, space.map().resolution(), space.options().padding);
  const Eigen::Vector3d up = pick.lift * Eigen::Vector3d::UnitZ();
  const auto can = [&](const ConfigurationSpace& there, const Eigen::Isometry3d& object,
                       const Eigen::Vector3d& back, bool is_grasp) {
    for (const Configuration& q : goal_configurations(robot, object * pick.object_from_tip, start, 128, 7)) {
      if (!there.is_free(q) || !can_go(robot, q, back, there, 0.0, there)) continue;
      const LinkPoses poses = forward_kinematics(robot, q);
      scene.hold(poses[static_cast<std::size_t>(robot.tip_link)].inverse() * object, q);
      if (can_go(robot, q, up, is_grasp ? scene.lifting() : scene.lowering(), contact, scene.carrying()))
        return true;
    }
    return false;
  };
  const Eigen::Matrix3d turned = pick.map_from_place.linear() * pick.map_from_object.linear().transpose();
  return can(scene.grasping(), pick.map_from_object, -pick.approach, true) &&
         can(scene.releasing(), pick.map_from_place, -(turned * pick.approach), false);
}

/// A free configuration with the hand before the furniture, pointing as it grasps.
std::optional<Configuration> draw_start(const ConfigurationSpace& space, const Problem& problem,
                                        SuiteDice& dice) {
  const Eigen::Vector3d object = problem.pick.map_from_object.translation();
  Eigen::Isometry3d tip = problem.pick.map_from_object * problem.pick.object_from_tip;
  tip.translation() << dice.between(0.25, 0.35), dice.between(-0.3, 0.3),
      object.z() + dice.between(0.1, 0.35);
  const std::vector<Configuration> found =
      goal_configurations(space.robot(), tip, draw_configuration(space.robot(), dice));
  for (const Configuration& q : found)
    if (space.is_free(q)) return q;
  return std::nullopt;
}

void judge_motion_of(const ConfigurationSpace& space, Plan plan, const std::string& name,
                     PickEvidence& evidence) {
  PickMotions& motions = evidence.motions;
  const double timed = trajectory_of(space.robot(), plan, 0.0).points.back().time;
  const PlannedMotion planned = plan_motion(space, plan, {}, 0.0);
  ++motions.made;
  motions.stops += planned.stops;
  for (const std::size_t leg : planned.unblended) ++motions.unblended[names_of_legs(true)[leg]];
  motions.ratio.push_back(planned.motion.duration() / timed);
  motions.cpu.push_back(planned.cpu_s);
  if (planned.validation.valid) return;
  ++motions.refused;
  evidence.broken.push_back(name + planned.validation.fault);
}

}  // namespace

void PickEvidence::add(const PickEvidence& other) {
  for (const auto& [name, tally] : other.tallies) {
    PickTally& sum = tallies[name];
    sum.asked += tally.asked;
    sum.planned += tally.planned;
    sum.refused += tally.refused;
    sum.seconds.insert(sum.seconds.end(), tally.seconds.begin(), tally.seconds.end());
  }
  for (const auto& [why, count] : other.failures) failures[why] += count;
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
  motions.made += other.motions.made;
  motions.refused += other.motions.refused;
  motions.stops += other.motions.stops;
  for (const auto& [leg, count] : other.motions.unblended) motions.unblended[leg] += count;
  motions.ratio.insert(motions.ratio.end(), other.motions.ratio.begin(), other.motions.ratio.end());
  motions.cpu.insert(motions.cpu.end(), other.motions.cpu.begin(), other.motions.cpu.end());
}

PickEvidence pick_and_place(std::uint64_t seed, std::uint64_t index) {
  const Arm& arm = arms[index % 3];
  const bool is_shelf = index / 3 % 2 == 1;
  const Robot robot = load_robot(arm.name);
  PickEvidence evidence;
  for (std::uint64_t attempt = 0; attempt < 200; ++attempt) {
    SuiteDice dice(seed, 1000 * index + attempt);
    Problem problem;
    problem.pick.object.link = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
    draw_object(arm, dice, problem.pick);
    is_shelf ? draw_shelf(arm, dice, problem) : draw_table(arm, dice, problem);
    std::vector<SceneShape> solids = problem.solids;
    solids.push_back(solid_of(problem.pick));
    const ConfigurationSpace space(robot, map_of_solids(solids, resolution),
                                   {.other = Policy::not_occupied, .critical_by_default = false},
                                   {.padding = robot.position_accuracy});
    const auto start = draw_start(space, problem, dice);
    if (!start || !are_ends_possible(space, problem.pick, *start)) continue;
    PickTally& tally = evidence.tallies[std::string(arm.name) + (is_shelf ? ", shelf" : ", table")];
    const Plan plan =
        plan_pick({.space = space, .start = *start, .goals = {}, .time_limit = 10.0, .survey = std::nullopt},
                  problem.pick);
    ++tally.asked;

    const std::string name = std::string(arm.name) + " " + std::to_string(index) + ": ";
    if (plan.status() != PlanStatus::solved) {
      ++evidence.failures[std::string(arm.name) + ": " + plan.explanation().substr(0, 110)];
    } else if (!plan.validation.valid) {
      ++tally.refused;
      evidence.broken.push_back(name + plan.validation.first_contact);
    } else {
      ++tally.planned;
      tally.seconds.push_back(plan.cpu_s);
      judge_motion_of(space, plan, name, evidence);
    }
    return evidence;
  }
  evidence.broken.push_back(std::string(arm.name) + " " + std::to_string(index) +
                            ": 200 draws gave no problem");
  return evidence;
}

}  // namespace clearway::evidence
