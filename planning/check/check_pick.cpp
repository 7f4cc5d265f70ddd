#include "planning/check/check_pick.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>

#include "mapping/maps/freed_voxels.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/check/path_check_shape.hpp"

namespace clearway {
namespace {

constexpr double same_place = 1e-5;  ///< m, rad: of the load on its link and at its place
constexpr double same_tip = 1e-3;    ///< m, rad: of the tip on its way
constexpr double skin = 1e-6;        ///< m that the object reaches into a voxel that is its own
constexpr double least_sinking = 1e-4, most_sinking = 1e-3;  ///< m
constexpr double finest_advance = 1e-9;                      ///< of an edge

constexpr int no_leg = -1;

/// A reason to refuse, with the leg that it is of.
struct Refusal {
  std::string sentence;
  int leg = no_leg;
};

double lowest(const Shape& shape, const Eigen::Isometry3d& pose) {
  return -check::farthest(shape, pose, -Eigen::Vector3d::UnitZ());
}

double angle_of(const Eigen::Matrix3d& turn) {
  return std::atan2(
      0.5 * Eigen::Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1)).norm(),
      0.5 * (turn.trace() - 1.0));
}

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

class PickCheck {
 public:
  PickCheck(const PickToCheck& plan, std::map<std::string, Policy> policies, double padding,
            double seen_within)
      : plan_(plan),
        pick_(plan.pick),
        shape_(plan.pick.object.shape),
        policies_(std::move(policies)),
        padding_(padding),
        seen_within_(seen_within),
        arm_(plan.robot) {}

  PathVerdict run() {
    try {
      require_legs();
      require_grasp();
      require_ways();
      check_all();
    } catch (const Refusal& refusal) {
      verdict_.valid = false;
      verdict_.first_contact = refusal.sentence;
    }
    if (!verdict_.valid) verdict_.min_clearance = 0.0;
    return verdict_;
  }

  MotionVerdict run(const MotionToCheck& motion) {
    MotionVerdict verdict;
    try {
      require_legs();
      require_grasp();
      verdict = check_rates(plan_.robot, motion, grips());
      if (!verdict.valid) return verdict;
      if (motion.rests.size() != plan_.legs.size())
        refuse("its motion has " + std::to_string(motion.rests.size()) + " legs, its path " +
               std::to_string(plan_.legs.size()));
      check_motion_legs(motion, verdict);
    } catch (const Refusal& refusal) {
      verdict.valid = false;
      verdict.fault = "motion: " + refusal.sentence;
      verdict.leg = refusal.leg;
    }
    if (!verdict.valid) verdict.min_clearance = 0.0;
    return verdict;
  }

 private:
  enum Leg : std::size_t { approach, reach, lift, carry, lower, retreat, leave };

  const std::vector<Configuration>& leg(std::size_t index) const { return plan_.legs[index]; }

  /// The object is taken after `reach` and left after `lower`, whatever the plan says.
  std::vector<std::size_t> grips() const {
    std::vector<std::size_t> grips(plan_.legs.size() - 1, 0);
    grips[reach] = grips[lower] = 1;
    return grips;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Refusal{"pick " + quote(pick_.object.name) + ": " + what};
  }

  [[noreturn]] void refuse_on(Leg index, const std::string& what) const {
    throw Refusal{"pick " + quote(pick_.object.name) + ": " + names_of_legs(true)[index] + what,
                  static_cast<int>(index)};
  }

  std::string lengths(const std::pair<double, double>& off) const {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << off.first << " m and " << off.second << " rad";
    return text.str();
  }

  /// As many as a pick has, each beginning where the one before ends.
  void require_legs() const {
    const std::size_t count = plan_.legs.size();
    if (count != names_of_legs(false).size() && count != names_of_legs(true).size())
      refuse("the plan has " + std::to_string(count) + " solved legs, expected 6, or 7 with a goal");
    const auto dof = static_cast<Eigen::Index>(plan_.robot.dof());
    for (std::size_t i = 0; i < count; ++i) {
      if (leg(i).empty()) refuse("leg " + std::to_string(i + 1) + " has no waypoints");
      for (const Configuration& q : leg(i))
        if (q.size() != dof || !q.allFinite())
          refuse("leg " + std::to_string(i + 1) + " has a waypoint that is no configuration");
      if (i > 0 && leg(i).front() != leg(i - 1).back())
        refuse("leg " + std::to_string(i + 1) + " starts elsewhere than the one before ends");
    }
  }

  Eigen::Isometry3d link_pose(const Configuration& q, const std::string& name) const {
    std::vector<Eigen::Isometry3d> links;
    check::BodyPoses bodies;
    arm_.place_on_base(q, links, bodies);
    for (std::size_t i = 0; i < plan_.robot.links.size(); ++i)
      if (plan_.robot.links[i].name == name) return plan_.robot.map_from_base * links[i];
    refuse("the robot has no link " + quote(name));
  }

  Eigen::Isometry3d tip_at(const Configuration& q) const {
    const Link& link = plan_.robot.links[static_cast<std::size_t>(plan_.robot.tip_link)];
    return link_pose(q, link.name) * plan_.robot.link_from_tip;
  }

  Eigen::Isometry3d object_at(const Configuration& q) const {
    return link_pose(q, pick_.object.link) * plan_.link_from_load;
  }

  /// The tip is where the pick states it; the load rides where the object stood, and ends at its place.
  void require_grasp() const {
    const Configuration &grasp = leg(reach).back(), &placed = leg(lower).back();
    if (!plan_.link_from_load.matrix().allFinite()) refuse("the load's pose is not finite");
    const auto tip =
        apart(shape_, pick_.object_from_tip.inverse(), tip_at(grasp).inverse() * pick_.map_from_object);
    if (!(tip.first <= same_tip && tip.second <= same_tip))
      refuse("the tip takes the object " + lengths(tip) + " from the grasp that is stated");
    const auto taken = apart(shape_, pick_.map_from_object, object_at(grasp));
    if (!(taken.first <= same_place && taken.second <= same_place))
      refuse("the load rides " + lengths(taken) + " from where the object stood");
    const auto put = apart(shape_, pick_.map_from_place, object_at(placed));
    if (!(put.first <= same_place && put.second <= same_place))
      refuse("the object is put down " + lengths(put) + " from its place");
  }

  /// The waypoints of a leg lie on the straight way of the tip that is stated, its attitude kept.
  void require_straight(std::size_t index, const Eigen::Vector3d& way) const {
    const Eigen::Isometry3d begin = tip_at(leg(index).front());
    const double length = way.norm();
    const Eigen::Vector3d along = way / length;
    const std::string name = names_of_legs(true)[index];
    for (const Configuration& q : leg(index)) {
      const Eigen::Isometry3d tip = tip_at(q);
      const Eigen::Vector3d moved = tip.translation() - begin.translation();
      const double on = moved.dot(along);
      const double aside = (moved - on * along).norm(),
                   turned = angle_of(begin.linear().transpose() * tip.linear());
      if (!(on >= -same_tip && on <= length + same_tip && aside <= same_tip && turned <= same_tip))
        refuse("a waypoint of " + name + " is off its straight way");
    }
    const Eigen::Vector3d whole = tip_at(leg(index).back()).translation() - begin.translation();
    if (!((whole - way).norm() <= same_tip)) refuse(name + " is not of the length that is stated");
  }

  /// The way of the approach, turned as the object was on its way.
  Eigen::Vector3d back() const {
    const Eigen::Isometry3d before = tip_at(leg(reach).back()), after = tip_at(leg(lower).back());
    return -(after.linear() * before.linear().transpose() * pick_.approach);
  }

  /// The straight legs and their ways.
  std::array<std::pair<Leg, Eigen::Vector3d>, 4> ways() const {
    const Eigen::Vector3d up = pick_.lift * Eigen::Vector3d::UnitZ();
    return {{{reach, pick_.approach}, {lift, up}, {lower, -up}, {retreat, back()}}};
  }

  void require_ways() const {
    for (const auto& [index, way] : ways()) require_straight(index, way);
    for (const auto& [index, way] : ways()) require_no_bow(index, way, {leg(index), {}});
  }

  /// How far the body may be from where it is on a chord.
  static double aside(const check::KdlArm& arm, std::size_t body, const MotionTubes& curve, std::size_t i) {
    return curve.deviations.empty() ? 0.0 : arm.motion(body, curve.deviations[i]) * (1.0 + 1e-9);
  }

  /// Between waypoints, too: conservative advancement over points of the load as it is held.
  void require_no_bow(Leg index, const Eigen::Vector3d& way, const MotionTubes& curve) const {
    const Robot carrying = loaded();
    const check::KdlArm arm(carrying);
    const std::size_t body = carrying.bodies.size() - 1;
    const double length = way.norm(), most = same_tip * (2.0 + check::extent(shape_));
    const Eigen::Vector3d along = way / length;
    std::vector<Eigen::Vector3d> points;
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0})
        points.push_back(shape_.support(sign * Eigen::Vector3d::Unit(axis)));
    const std::vector<Configuration>& path = curve.chords;
    const Eigen::Isometry3d begin = arm.place(path.front(), body);
    const auto off = [&](const Eigen::Isometry3d& pose) {
      double farthest = 0.0;
      for (const Eigen::Vector3d& point : points) {
        const Eigen::Vector3d moved = pose * point - begin * point;
        const double on = moved.dot(along);
        farthest = std::max({farthest, (moved - on * along).norm(), -on, on - length});
      }
      return farthest;
    };
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const Eigen::VectorXd step = path[i + 1] - path[i];
      const double rate = arm.motion(body, step.cwiseAbs()) * (1.0 + 1e-9);
      for (double t = 0.0;;) {
        const double room = most - off(arm.place(path[i] + t * step, body)) - aside(arm, body, curve, i);
        if (!(room > 0.0)) refuse_on(index, " leaves its straight way between waypoints");
        const double ahead = rate > 0.0 ? 0.9 * room / rate : 1.0;
        if (!(t + ahead < 1.0)) break;
        if (!(ahead > finest_advance)) refuse_on(index, ": cannot prove that its way is straight");
        t += ahead;
      }
    }
  }

  /// The object on the robot's root.
  Robot standing(const Eigen::Isometry3d& map_from_object, bool may_be_touched) const {
    std::vector<Eigen::Isometry3d> links;
    check::BodyPoses bodies;
    arm_.place_on_base(Configuration::Zero(static_cast<Eigen::Index>(plan_.robot.dof())), links, bodies);
    Load load = pick_.object;
    load.link = plan_.robot.links.front().name;
    load.link_from_load = (plan_.robot.map_from_base * links.front()).inverse() * map_from_object;
    if (may_be_touched)
      load.touches.push_back(pick_.object.link);
    else
      load.touches.clear();
    return with_load(plan_.robot, load);
  }

  Robot loaded() const {
    Load load = pick_.object;
    load.link_from_load = plan_.link_from_load;
    return with_load(plan_.robot, load);
  }

  Eigen::AlignedBox3d box_of(const Eigen::Isometry3d& pose, double margin) const {
    Eigen::AlignedBox3d box;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
      box.min()[axis] = -check::farthest(shape_, pose, -unit) - margin;
      box.max()[axis] = check::farthest(shape_, pose, unit) + margin;
    }
    return box;
  }

  /// Centres of the voxels that meet a box and pass `test`.
  template <class Test>
  std::vector<Eigen::Vector3d> voxels_in(const Eigen::AlignedBox3d& box, const Test& test) const {
    const double edge = plan_.map.resolution();
    const auto cell = [&](double x) { return static_cast<int>(std::floor(x / edge)); };
    std::vector<Eigen::Vector3d> voxels;
    for (int x = cell(box.min().x()); x <= cell(box.max().x()); ++x)
      for (int y = cell(box.min().y()); y <= cell(box.max().y()); ++y)
        for (int z = cell(box.min().z()); z <= cell(box.max().z()); ++z) {
          const Eigen::Vector3d center = (Eigen::Array3d(x, y, z) + 0.5) * edge;
          if (test(center)) voxels.push_back(center);
        }
    return voxels;
  }

  /// The map without the object's own voxels.
  Snapshot without_object() const {
    const double edge = plan_.map.resolution(), plane = lowest(shape_, pick_.map_from_object);
    const Robot robot = standing(pick_.map_from_object, true);
    const check::FclBodies bodies(robot);
    const std::size_t body = robot.bodies.size() - 1;
    const auto is_own = [&](const Eigen::Vector3d& center) {
      if (!(center.z() - edge / 2 >= plane - skin)) return false;
      if (pick_.margin > 0.0)
        return bodies.cube_distance(body, pick_.map_from_object, center, edge) <= pick_.margin;
      return bodies.touches_cube(body, pick_.map_from_object, center, edge - 2.0 * skin);
    };
    return with_free_voxels(plan_.map, voxels_in(box_of(pick_.map_from_object, pick_.margin), is_own), false);
  }

  Snapshot without_layer(const Snapshot& map, const Eigen::Isometry3d& map_from_object) const {
    const double edge = plan_.map.resolution(), wide = layer_reach(edge, padding_);
    const double plane = lowest(shape_, map_from_object);
    const Eigen::AlignedBox3d about = box_of(map_from_object, wide);
    const auto is_layer = [&](const Eigen::Vector3d& center) {
      const Eigen::Array3d low = center.array() - edge / 2, high = center.array() + edge / 2;
      return (low.head<2>() >= about.min().array().head<2>() - skin).all() &&
             (high.head<2>() <= about.max().array().head<2>() + skin).all() &&
             low.z() >= plane - wide - skin && high.z() <= plane + edge + skin;
    };
    return with_free_voxels(map, voxels_in(about, is_layer), true);
  }

  void check_all() {
    verdict_.valid = true;
    verdict_.min_clearance = HUGE_VAL;
    const Snapshot freed = without_object();
    const Robot carrying = loaded();
    const std::size_t up = first_past_contact(leg(lift)), down = last_before_contact(leg(lower));
    add(standing(pick_.map_from_object, false), plan_.map, approach, leg(approach));
    add(standing(pick_.map_from_object, true), freed, reach, leg(reach));
    const auto first = leg(lift).begin();
    const std::vector<Configuration> on_support(first, first + static_cast<std::ptrdiff_t>(up) + 1);
    check_contact(carrying, freed, pick_.map_from_object, lift, on_support, 0);
    add(carrying, freed, lift, {first + static_cast<std::ptrdiff_t>(up), leg(lift).end()}, up);
    add(carrying, freed, carry, leg(carry));
    const auto begin = leg(lower).begin();
    add(carrying, freed, lower, {begin, begin + static_cast<std::ptrdiff_t>(down) + 1});
    check_contact(carrying, freed, pick_.map_from_place, lower,
                  {begin + static_cast<std::ptrdiff_t>(down), leg(lower).end()}, down);
    add(standing(pick_.map_from_place, true), freed, retreat, leg(retreat));
    if (plan_.legs.size() > leave) add(standing(pick_.map_from_place, false), freed, leave, leg(leave));
  }

  double height_at(const Configuration& q) const { return lowest(shape_, object_at(q)); }

  /// The first place of the lift that is `contact` above the plane.
  std::size_t first_past_contact(const std::vector<Configuration>& path) const {
    const double contact = contact_length(pick_, plan_.map.resolution(), padding_);
    const double plane = lowest(shape_, pick_.map_from_object);
    for (std::size_t i = 0; i < path.size(); ++i)
      if (height_at(path[i]) >= plane + contact - same_place) return i;
    refuse_on(lift, ": no waypoint is past its contact");
  }

  /// The last place of lowering that is.
  std::size_t last_before_contact(const std::vector<Configuration>& path) const {
    const double contact = contact_length(pick_, plan_.map.resolution(), padding_);
    const double plane = lowest(shape_, pick_.map_from_place);
    for (std::size_t i = path.size(); i-- > 0;)
      if (height_at(path[i]) >= plane + contact - same_place) return i;
    refuse_on(lower, ": no waypoint is before its contact");
  }

  bool is_beyond_contact(const Eigen::Isometry3d& map_from_object, const Configuration& q) const {
    const double contact = contact_length(pick_, plan_.map.resolution(), padding_);
    return height_at(q) > lowest(shape_, map_from_object) + contact + same_place;
  }

  /// The first or last metres of a leg, on which the load may touch the layer and nothing else may.
  void check_contact(const Robot& carrying, const Snapshot& freed, const Eigen::Isometry3d& map_from_object,
                     Leg index, const std::vector<Configuration>& path, std::size_t offset) {
    add(plan_.robot, freed, index, path, offset);
    add(carrying, without_layer(freed, map_from_object), index, path, offset);
    if (verdict_.valid) require_heights(carrying, map_from_object, index, {path, {}});
  }

  /// How low and high the load comes where it may touch what it stands on.
  void require_heights(const Robot& carrying, const Eigen::Isometry3d& map_from_object, Leg index,
                       const MotionTubes& curve) const {
    const double plane = lowest(shape_, map_from_object);
    const double contact = contact_length(pick_, plan_.map.resolution(), padding_);
    const double sinking = std::clamp(padding_, least_sinking, most_sinking);
    const check::KdlArm arm(carrying);
    const std::size_t body = carrying.bodies.size() - 1;
    for (std::size_t i = 0; i + 1 < curve.chords.size(); ++i) {
      const double off = aside(arm, body, curve, i);
      require_height(arm, body, curve.chords[i], curve.chords[i + 1], plane - sinking + off,
                     plane + contact + sinking - off, index);
    }
  }

  /// Conservative advancement: on by less than the room there is above `low` and below `high`.
  void require_height(const check::KdlArm& arm, std::size_t body, const Configuration& from,
                      const Configuration& to, double low, double high, Leg index) const {
    const Eigen::VectorXd step = to - from;
    const double rate = arm.motion(body, step.cwiseAbs()) * (1.0 + 1e-9);
    for (double t = 0.0;;) {
      const double height = lowest(shape_, arm.place(from + t * step, body));
      const double room = std::min(height - low, high - height);
      if (!(room > 0.0))
        refuse_on(index, ": the load leaves the height at which it may touch what it stands on");
      const double ahead = rate > 0.0 ? 0.9 * room / rate : 1.0;
      if (!(t + ahead < 1.0)) return;
      if (!(ahead > finest_advance))
        refuse_on(index, ": cannot prove that the load stays above what it stands on");
      t += ahead;
    }
  }

  /// The curve of each leg, as check_all has the path.
  void check_motion_legs(const MotionToCheck& motion, MotionVerdict& verdict) const {
    const std::vector<KnotRange> knots = knots_of_legs(motion, grips());
    const Snapshot freed = without_object();
    const Robot carrying = loaded();
    const auto prove = [&](const Robot& robot, const Snapshot& map, Leg index, KnotRange range) {
      if (!verdict.valid) return;
      prove_tubes(robot, map, policies_, padding_, seen_within_, motion.motion, range, verdict);
      if (verdict.valid) return;
      verdict.leg = index;
      verdict.fault = "motion: leg " + names_of_legs(true)[index] + ", " +
                      verdict.fault.substr(std::string("motion: ").size());
    };
    const auto prove_contact = [&](const Eigen::Isometry3d& map_from_object, Leg index, KnotRange range) {
      prove(plan_.robot, freed, index, range);
      prove(carrying, without_layer(freed, map_from_object), index, range);
      if (verdict.valid) require_heights(carrying, map_from_object, index, tubes_of(motion.motion, range, 1));
    };
    const auto positions = [&](Leg index) {
      return stretch_of(motion.motion, knots[index].first, knots[index].last).positions;
    };
    // Between two knots the curve may pass the end of the contact: that piece is proved with the layer.
    const std::vector<Configuration> lifted = positions(lift), lowered = positions(lower);
    std::size_t up = first_past_contact(lifted), down = last_before_contact(lowered);
    if (up > 0 && is_beyond_contact(pick_.map_from_object, lifted[up])) --up;
    if (down + 1 < lowered.size() && is_beyond_contact(pick_.map_from_place, lowered[down])) ++down;
    up += knots[lift].first;
    down += knots[lower].first;
    for (const auto& [index, way] : ways())
      require_no_bow(index, way, tubes_of(motion.motion, knots[index], 1));
    prove(standing(pick_.map_from_object, false), plan_.map, approach, knots[approach]);
    prove(standing(pick_.map_from_object, true), freed, reach, knots[reach]);
    prove_contact(pick_.map_from_object, lift, {knots[lift].first, up});
    prove(carrying, freed, lift, {up, knots[lift].last});
    prove(carrying, freed, carry, knots[carry]);
    prove(carrying, freed, lower, {knots[lower].first, down});
    prove_contact(pick_.map_from_place, lower, {down, knots[lower].last});
    prove(standing(pick_.map_from_place, true), freed, retreat, knots[retreat]);
    if (plan_.legs.size() > leave) prove(standing(pick_.map_from_place, false), freed, leave, knots[leave]);
  }

  /// The check of a part of a leg; what follows the first refusal is not looked at.
  void add(const Robot& robot, const Snapshot& map, Leg index, const std::vector<Configuration>& path,
           std::size_t offset = 0) {
    if (!verdict_.valid) return;
    const PathVerdict part = check_path(robot, map, policies_, padding_, path, 0.0, seen_within_);
    verdict_.checker = part.checker;
    note_clearance(index, offset, part.clearance);
    if (part.valid) {
      verdict_.min_clearance = std::min(verdict_.min_clearance, part.min_clearance);
      return;
    }
    verdict_.valid = false;
    verdict_.undecided = part.undecided;
    verdict_.edge = part.edge < 0 ? -1 : part.edge + static_cast<int>(first_waypoint(index) + offset);
    verdict_.parameter = part.parameter;
    verdict_.first_contact = "leg " + names_of_legs(true)[index] + ", its " + part.first_contact;
  }

  std::size_t first_waypoint(Leg index) const {
    std::size_t first = 0;
    for (std::size_t i = 0; i < index; ++i) first += leg(i).size() - 1;
    return first;
  }

  void note_clearance(Leg index, std::size_t offset, const std::vector<double>& clearance) {
    const std::size_t first = first_waypoint(index) + offset;
    for (std::size_t i = 0; i < clearance.size(); ++i) {
      if (first + i >= verdict_.clearance.size()) verdict_.clearance.push_back(clearance[i]);
      double& known = verdict_.clearance[std::min(first + i, verdict_.clearance.size() - 1)];
      known = std::min(known, clearance[i]);
    }
  }

  const PickToCheck& plan_;
  const Pick& pick_;
  const Shape& shape_;
  std::map<std::string, Policy> policies_;
  double padding_, seen_within_;
  check::KdlArm arm_;
  PathVerdict verdict_;
};

/// With the object's: where none is given the strictest of what holds it.
std::map<std::string, Policy> stated_policies(const PickToCheck& plan,
                                              std::map<std::string, Policy> policies) {
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

PathVerdict check_pick(const PickToCheck& plan, const std::map<std::string, Policy>& policies, double padding,
                       double seen_within) {
  require_sound(plan.pick, plan.map.resolution(), padding);
  try {
    return PickCheck(plan, stated_policies(plan, policies), padding, seen_within).run();
  } catch (const check::FileDisagrees& error) {
    PathVerdict verdict;
    verdict.first_contact = error.what();
    return verdict;
  }
}

MotionVerdict check_pick_motion(const PickToCheck& plan, const MotionToCheck& motion,
                                const std::map<std::string, Policy>& policies, double padding,
                                double seen_within) {
  require_sound(plan.pick, plan.map.resolution(), padding);
  try {
    return PickCheck(plan, stated_policies(plan, policies), padding, seen_within).run(motion);
  } catch (const check::FileDisagrees& error) {
    MotionVerdict verdict;
    verdict.fault = "motion: " + std::string(error.what());
    return verdict;
  }
}

}  // namespace clearway
