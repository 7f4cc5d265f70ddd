#include "planning/check/pick_terms.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_shape.hpp"

namespace clearway::check {
namespace {

/// The pose without its turn about its own z axis where the shape does not show it.
Eigen::Isometry3d without_turn(const Shape& shape, Eigen::Isometry3d pose) {
  if (!shape.is_axial()) return pose;
  const Eigen::Matrix3d turn = pose.linear();
  const double angle = std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
  pose.linear() = turn * Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

/// How far apart two poses of the object are, as a length and an angle.
std::pair<double, double> apart(const Shape& shape, const Eigen::Isometry3d& expected,
                                const Eigen::Isometry3d& found) {
  const Eigen::Isometry3d off = without_turn(shape, expected.inverse() * found);
  return {off.translation().norm(), angle_of(off.linear())};
}

std::string lengths(const std::pair<double, double>& off) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << off.first << " m and " << off.second << " rad";
  return text.str();
}

/// With the object's: where none is given the strictest of what holds it.
std::map<std::string, Policy> with_object(const PickToCheck& plan, std::map<std::string, Policy> policies) {
  const Load& object = plan.pick.object;
  if (policies.contains(object.name)) return policies;
  Policy strictest = Policy::not_occupied;
  for (const std::string& holder : holders_of(with_load(plan.robot, object), object.name))
    if (const auto found = policies.find(holder); found != policies.end())
      strictest = std::min(strictest, found->second);
  policies[object.name] = strictest;
  return policies;
}

}  // namespace

std::string hold_note(const PickTerms& terms) {
  constexpr double held_within = 0.005, near_within = 0.02;  // m: of a hand that closes, of any other
  const Pick& pick = terms.pick;
  const std::string object = quote(pick.object.name);
  const auto away = terms.from_hand(pick.object.shape);
  if (away && *away > (pick.grip.empty() ? near_within : held_within))
    return "nothing of the hand (link " + quote(pick.object.link) + " and what touches) is nearer to " +
           object + " at the grasp than " + short_text(1e3 * *away, 3) + " mm: what holds it?";
  const std::optional<Shape> core = core_of(pick);
  if (core && terms.from_hand(*core) == 0.0)
    return "the hand closes deeper than " + short_text(1e3 * pick.depth) + " mm into " + object +
           ", where a real one stops before";
  return {};
}

double lowest(const Shape& shape, const Eigen::Isometry3d& pose) {
  return -farthest(shape, pose, -Eigen::Vector3d::UnitZ());
}

double angle_of(const Eigen::Matrix3d& turn) {
  return std::atan2(
      0.5 * Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)).norm(),
      0.5 * (turn.trace() - 1.0));
}

PickTerms::PickTerms(const PickToCheck& to_check, const std::map<std::string, Policy>& stated, double padding,
                     double seen_within)
    : plan(to_check),
      pick(plan.pick),
      shape(pick.object.shape),
      policies(with_object(plan, stated)),
      padding(padding),
      seen_within(seen_within),
      arm_(plan.robot) {}

std::vector<std::size_t> PickTerms::grips() const {
  std::vector<std::size_t> grips(plan.legs.size() - 1, 0);
  grips[reach] = grips[lower] = 1;
  return grips;
}

void PickTerms::refuse(const std::string& what) const {
  throw PickRefusal{"pick " + quote(pick.object.name) + ": " + what};
}

void PickTerms::refuse_on(Leg index, const std::string& what) const {
  throw PickRefusal{"pick " + quote(pick.object.name) + ": " + names_of_legs(true)[index] + what,
                    static_cast<int>(index)};
}

void PickTerms::require_rigid_hold() const {
  std::size_t carrier = plan.robot.links.size();
  for (std::size_t i = 0; i < plan.robot.links.size(); ++i)
    if (plan.robot.links[i].name == pick.object.link) carrier = i;
  if (carrier == plan.robot.links.size()) refuse("the robot has no link " + quote(pick.object.link));
  const auto tip = static_cast<std::size_t>(plan.robot.tip_link);
  const std::string joint = arm_.joint_between_links(carrier, tip);
  if (!joint.empty())
    refuse("joint " + quote(joint) + " moves link " + quote(pick.object.link) +
           ", which carries the object, against the tip, link " + quote(plan.robot.links[tip].name) +
           ", expected a link that is fixed to the tip");
}

void PickTerms::require_legs() const {
  const std::size_t count = plan.legs.size();
  if (count != names_of_legs(false).size() && count != names_of_legs(true).size())
    refuse("the plan has " + std::to_string(count) + " solved legs, expected 6, or 7 with a goal");
  const auto dof = static_cast<Eigen::Index>(plan.robot.dof());
  for (std::size_t i = 0; i < count; ++i) {
    if (leg(i).empty()) refuse("leg " + std::to_string(i + 1) + " has no waypoints");
    for (const Configuration& q : leg(i))
      if (q.size() != dof || !q.allFinite())
        refuse("leg " + std::to_string(i + 1) + " has a waypoint that is no configuration");
    if (i > 0 && leg(i).front() != leg(i - 1).back())
      refuse("leg " + std::to_string(i + 1) + " starts elsewhere than the one before ends");
  }
}

void PickTerms::require_grasp() const {
  const Configuration &grasp = leg(reach).back(), &placed = leg(lower).back();
  if (!plan.link_from_load.matrix().allFinite()) refuse("the load's pose is not finite");
  const auto tip =
      apart(shape, pick.object_from_tip.inverse(), tip_at(grasp).inverse() * pick.map_from_object);
  if (!(tip.first <= same_tip && tip.second <= same_tip))
    refuse("the tip takes the object " + lengths(tip) + " from the grasp that is stated");
  const auto taken = apart(shape, pick.map_from_object, object_at(grasp));
  if (!(taken.first <= same_place && taken.second <= same_place))
    refuse("the load rides " + lengths(taken) + " from where the object stood");
  const auto put = apart(shape, pick.map_from_place, object_at(placed));
  if (!(put.first <= same_place && put.second <= same_place))
    refuse("the object is put down " + lengths(put) + " from its place");
}

const PickTerms::Hand& PickTerms::hand() const {
  if (!hand_) hand_ = hand_at_grasp();
  return *hand_;
}

PickTerms::Hand PickTerms::hand_at_grasp() const {
  Hand hand;
  std::size_t named = 0;
  const Robot carrying = loaded();
  const std::vector<int> holding = arm_.joints_that_hold(plan.robot, carrying.loads.back());
  const Configuration& grasp = leg(reach).back();
  for (std::size_t i = 0; i < plan.robot.joints.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (const auto grip = pick.grip.find(plan.robot.joints[i].name); grip != pick.grip.end()) {
      hand.emplace_back(at, grip->second);
      ++named;
    } else if (std::find(holding.begin(), holding.end(), static_cast<int>(i)) != holding.end()) {
      hand.emplace_back(at, Pick::Grip{grasp[at], grasp[at]});
    }
  }
  if (named != pick.grip.size()) refuse("the robot lacks a joint of its grip");
  return hand;
}

void PickTerms::require_hand(Leg index, const std::vector<std::vector<Configuration>>& pieces) const {
  if (index == approach || index == leave) return;
  const Hand& joints = hand();
  const auto near = [](double a, double b) { return std::abs(a - b) <= same_joint; };
  const auto is_hand = [&](const Configuration& q, double Pick::Grip::*state) {
    return std::all_of(joints.begin(), joints.end(),
                       [&](const auto& joint) { return near(q[joint.first], joint.second.*state); });
  };
  const auto require = [&](const Configuration& q, double Pick::Grip::*state, const char* what) {
    for (const auto& [joint, grip] : joints)
      if (!near(q[joint], grip.*state))
        refuse_on(index, std::string(what) + quote(plan.robot.joints[static_cast<std::size_t>(joint)].name) +
                             (state == &Pick::Grip::open ? " not open" : " not closed"));
  };
  if (index == reach) require(pieces.front().front(), &Pick::Grip::open, " begins with joint ");
  if (index == reach) require(pieces.back().back(), &Pick::Grip::closed, " ends with joint ");
  if (index == retreat) require(pieces.front().front(), &Pick::Grip::closed, " begins with joint ");
  if (index == retreat) require(pieces.back().back(), &Pick::Grip::open, " ends with joint ");
  const Configuration still = index == reach ? pieces.back().back() : pieces.front().front();
  const auto stands = [&](const Configuration& q) {  // but for the hand
    Configuration rest = q;
    for (const auto& [joint, grip] : joints) rest[joint] = still[joint];
    return (rest - still).lpNorm<Eigen::Infinity>() <= same_joint;
  };
  for (const std::vector<Configuration>& piece : pieces) {
    if (index != reach && index != retreat) {
      for (const Configuration& q : piece) require(q, &Pick::Grip::closed, " has joint ");
    } else if (!std::all_of(piece.begin(), piece.end(), stands) &&
               !std::all_of(piece.begin(), piece.end(),
                            [&](const Configuration& q) { return is_hand(q, &Pick::Grip::open); })) {
      refuse_on(index, ": away from the object the hand is not open, or something else moves with it");
    }
  }
}

Eigen::Isometry3d PickTerms::link_pose(const Configuration& q, const std::string& name) const {
  std::vector<Eigen::Isometry3d> links;
  BodyPoses bodies;
  arm_.place_on_base(q, links, bodies);
  for (std::size_t i = 0; i < plan.robot.links.size(); ++i)
    if (plan.robot.links[i].name == name) return plan.robot.map_from_base * links[i];
  refuse("the robot has no link " + quote(name));
}

Eigen::Isometry3d PickTerms::tip_at(const Configuration& q) const {
  const Link& link = plan.robot.links[static_cast<std::size_t>(plan.robot.tip_link)];
  return link_pose(q, link.name) * plan.robot.link_from_tip;
}

Eigen::Isometry3d PickTerms::object_at(const Configuration& q) const {
  return link_pose(q, pick.object.link) * plan.link_from_load;
}

/// The way of the approach, turned as the object was on its way.
Eigen::Vector3d PickTerms::back() const {
  const Eigen::Isometry3d before = tip_at(leg(reach).back()), after = tip_at(leg(lower).back());
  return -(after.linear() * before.linear().transpose() * pick.approach);
}

std::array<std::pair<PickTerms::Leg, Eigen::Vector3d>, 4> PickTerms::ways() const {
  const Eigen::Vector3d up = pick.lift * Eigen::Vector3d::UnitZ();
  return {{{reach, pick.approach}, {lift, up}, {lower, -up}, {retreat, back()}}};
}

Robot PickTerms::standing(const Eigen::Isometry3d& map_from_object, bool may_be_touched) const {
  std::vector<Eigen::Isometry3d> links;
  BodyPoses bodies;
  arm_.place_on_base(Configuration::Zero(static_cast<Eigen::Index>(plan.robot.dof())), links, bodies);
  Load load = pick.object;
  load.link = plan.robot.links.front().name;
  load.link_from_load = (plan.robot.map_from_base * links.front()).inverse() * map_from_object;
  if (may_be_touched)
    load.touches.push_back(pick.object.link);
  else
    load.touches.clear();
  return with_load(plan.robot, load);
}

std::optional<Robot> PickTerms::standing_core(const Eigen::Isometry3d& map_from_object) const {
  const std::optional<Shape> core = core_of(pick);
  if (!core) return std::nullopt;
  Load load = standing(map_from_object, false).loads.back();
  load.name = core_name(pick);
  load.shape = *core;
  return with_load(plan.robot, load);
}

std::optional<double> PickTerms::from_hand(const Shape& of) const {
  Load load = standing(pick.map_from_object, false).loads.back();
  load.shape = of;
  const Robot robot = with_load(plan.robot, load);
  const KdlArm arm(robot);
  const FclBodies bodies(robot);
  const std::size_t last = robot.bodies.size() - 1;
  const Configuration& grasp = leg(reach).back();
  std::optional<double> nearest;
  for (std::size_t i = 0; i < last; ++i) {
    const std::string& link = robot.links[static_cast<std::size_t>(robot.bodies[i].link)].name;
    const auto& touches = pick.object.touches;
    if (link != pick.object.link && std::find(touches.begin(), touches.end(), link) == touches.end())
      continue;
    const double away = bodies.distance(i, arm.place(grasp, i), last, arm.place(grasp, last), HUGE_VAL);
    nearest = std::min(nearest.value_or(HUGE_VAL), std::max(0.0, away));
  }
  return nearest;
}

bool PickTerms::is_open(const Configuration& q) const {
  for (const auto& [joint, grip] : hand())
    if (std::abs(q[joint] - grip.open) > same_joint) return false;
  return true;
}

Robot PickTerms::loaded() const {
  Load load = pick.object;
  load.link_from_load = plan.link_from_load;
  return with_load(plan.robot, load);
}

/// Where the contact with what the object stands on ends.
double PickTerms::contact_height(const Eigen::Isometry3d& map_from_object) const {
  return lowest(shape, map_from_object) + contact_length(pick, plan.map.resolution(), padding);
}

std::size_t PickTerms::first_past_contact(const std::vector<Configuration>& path) const {
  const double contact = contact_height(pick.map_from_object);
  for (std::size_t i = 0; i < path.size(); ++i)
    if (height_at(path[i]) >= contact - same_place) return i;
  refuse_on(lift, ": no waypoint is past its contact");
}

std::size_t PickTerms::last_before_contact(const std::vector<Configuration>& path) const {
  const double contact = contact_height(pick.map_from_place);
  for (std::size_t i = path.size(); i-- > 0;)
    if (height_at(path[i]) >= contact - same_place) return i;
  refuse_on(lower, ": no waypoint is before its contact");
}

bool PickTerms::is_beyond_contact(const Eigen::Isometry3d& map_from_object, const Configuration& q) const {
  return height_at(q) > contact_height(map_from_object) + same_place;
}

}  // namespace clearway::check
