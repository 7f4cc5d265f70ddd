#include "planning/robot/load.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/voxels/rigid_pose.hpp"
#include "planning/robot/robot.hpp"

namespace clearway {
namespace {

constexpr double same_length = 1e-6;  ///< m, kg

bool is_plain_name(const std::string& name) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  };
  return !name.empty() && name.size() <= 80 && std::all_of(name.begin(), name.end(), is_plain);
}

int link_of(const Robot& robot, const std::string& name, const std::string& what) {
  std::vector<std::string> names;
  for (const Link& link : robot.links) names.push_back(link.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return static_cast<int>(found - names.begin());
  throw std::invalid_argument(what + ": robot " + quote(robot.name) + " has no link " + quote(name) + ", " +
                              suggestion(name, names));
}

void require_sound(const Robot& robot, const Load& load) {
  const std::string what = "load " + quote(load.name);
  if (!is_plain_name(load.name))
    throw std::invalid_argument(what + ": expected a name of letters, digits, '_', '-' and '.'");
  for (const Link& link : robot.links)
    if (link.name == load.name)
      throw std::invalid_argument(what + ": robot " + quote(robot.name) +
                                  " has a link of that name, expected another one");
  for (const Body& body : robot.bodies)
    if (body.part == load.name)
      throw std::invalid_argument(what + ": robot " + quote(robot.name) +
                                  " has a part of that name, expected another one");
  if (!is_rotation(load.link_from_load.linear()) || !load.link_from_load.translation().allFinite())
    throw std::invalid_argument(what + ", pose: expected finite numbers and a rotation");
  if (!std::isfinite(load.mass) || load.mass < 0.0)
    throw std::invalid_argument(what + ", mass: expected a finite number of kg from 0");
}

/// Farthest along each axis and each diagonal of the axes: distinguishes shapes with equal boxes.
bool are_alike(const Shape& a, const Shape& b) {
  if (a.kind() != b.kind()) return false;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        const Eigen::Vector3d n(x, y, z);
        if (!(std::abs(n.dot(a.support(n)) - n.dot(b.support(n))) <= same_length)) return false;
      }
  if (a.vertices().size() != b.vertices().size()) return false;
  for (std::size_t i = 0; i < a.vertices().size(); ++i)
    if (!((a.vertices()[i] - b.vertices()[i]).norm() <= same_length)) return false;
  return true;
}

/// For each link the joints that move it, each with the first link on the way from the root that it moves.
std::vector<std::map<int, int>> ways_of_links(const Robot& robot) {
  std::vector<std::map<int, int>> ways(robot.links.size());
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Link& link = robot.links[i];
    if (link.parent >= 0) ways[i] = ways[static_cast<std::size_t>(link.parent)];
    if (link.joint >= 0 && link.multiplier != 0.0) ways[i].emplace(link.joint, static_cast<int>(i));
  }
  return ways;
}

/// Who holds a load, and by which joints.
class Grip {
 public:
  Grip(const Robot& robot, const Load& load) : robot_(robot), ways_(ways_of_links(robot)) {
    for (std::size_t i = 0; i < robot.links.size(); ++i) {
      const std::string& name = robot.links[i].name;
      if (name == load.link) carrier_ = i;
      if (std::find(load.touches.begin(), load.touches.end(), name) != load.touches.end()) touched_.insert(i);
    }
    touched_.erase(carrier_);
  }

  std::vector<int> joints() const {
    std::vector<int> held;
    if (ways_[carrier_].empty()) return held;
    for (int j = 0; j < static_cast<int>(robot_.dof()); ++j)
      if (slides(j) && is_of_the_hand(j)) held.push_back(j);
    return held;
  }

 private:
  int way(std::size_t link, int joint) const {
    const auto found = ways_[link].find(joint);
    return found == ways_[link].end() ? -1 : found->second;
  }
  /// Whether all that moves the carrier moves the link, the joint aside.
  bool rides_along(std::size_t link, int joint) const {
    return std::all_of(ways_[carrier_].begin(), ways_[carrier_].end(),
                       [&](const auto& of) { return of.first == joint || ways_[link].contains(of.first); });
  }
  bool slides(int joint) const {
    return std::any_of(touched_.begin(), touched_.end(), [&](std::size_t link) {
      return rides_along(link, joint) && way(link, joint) != way(carrier_, joint);
    });
  }
  /// Whether it moves fingers: what rides along with the carrier; if that moves too nothing that holds
  /// nothing; and not the tip, unless several fingers.
  bool is_of_the_hand(int joint) const {
    for (std::size_t i = 0; i < ways_.size(); ++i)
      if (way(i, joint) >= 0 && !rides_along(i, joint)) return false;
    if (way(carrier_, joint) >= 0)
      for (const Body& body : robot_.bodies) {
        const auto link = static_cast<std::size_t>(body.link);
        if (way(link, joint) >= 0 && link != carrier_ && !touched_.contains(link) && !is_load(body))
          return false;
      }
    if (way(static_cast<std::size_t>(robot_.tip_link), joint) < 0) return true;
    std::set<int> fingers;
    for (const std::size_t link : touched_) fingers.insert(way(link, joint));
    fingers.insert(way(carrier_, joint));
    fingers.erase(-1);
    return fingers.size() > 1;
  }
  bool is_load(const Body& body) const {
    return std::any_of(robot_.loads.begin(), robot_.loads.end(),
                       [&](const Load& known) { return known.name == body.part; });
  }

  const Robot& robot_;
  std::vector<std::map<int, int>> ways_;
  std::size_t carrier_ = 0;
  std::set<std::size_t> touched_;
};

constexpr double same_grip = 1e-6;  ///< rad, m

}  // namespace

bool LegLoad::rides_on(int leg) const {
  return legs.empty() || std::find(legs.begin(), legs.end(), leg) != legs.end();
}

std::string size_note(const Load& load) {
  constexpr double largest = 20.0;  // m
  const double across = 2.0 * load.shape.bounding_radius();
  if (across <= largest) return {};
  return "load " + quote(load.name) + " is " + short_text(across, 3) +
         " m across: is it in millimetres? Loads are in metres, `scale: 0.001` makes a mesh so";
}

Robot with_load(const Robot& robot, const Load& load) {
  require_sound(robot, load);
  const std::string what = "load " + quote(load.name);
  Robot result = robot;
  Link link;
  link.name = load.name;
  link.parent = link_of(robot, load.link, what);
  link.parent_from_link = load.link_from_load;
  link.mass = load.mass * std::pow(robot.scale, 3);
  Body body;
  body.part = load.name;
  body.link = static_cast<int>(robot.links.size());
  body.shape = load.shape;
  body.cover = load.shape.sphere_cover();
  std::set<int> holding = {link.parent};
  for (const std::string& name : load.touches) holding.insert(link_of(robot, name, what + ", touches"));
  const int index = static_cast<int>(robot.bodies.size());
  for (int other = 0; other < index; ++other)
    if (holding.contains(robot.bodies[static_cast<std::size_t>(other)].link))
      result.exempt.emplace_back(other, index);
  std::sort(result.exempt.begin(), result.exempt.end());
  result.links.push_back(std::move(link));
  result.bodies.push_back(std::move(body));
  result.loads.push_back(load);
  return result;
}

Robot robot_of_leg(const Robot& robot, const std::vector<LegLoad>& loads, int leg) {
  Robot result = robot;
  for (const LegLoad& load : loads)
    if (load.rides_on(leg)) result = with_load(result, load.load);
  return result;
}

std::vector<int> grip_joints(const Robot& robot, const Load& load) { return Grip(robot, load).joints(); }

Robot with_still_grip(const Robot& robot, const Eigen::VectorXd& q) {
  Robot still = robot;
  for (const Load& load : robot.loads)
    for (const int j : grip_joints(robot, load)) {
      Joint& joint = still.joints[static_cast<std::size_t>(j)];
      if (q[j] >= joint.lower && q[j] <= joint.upper) joint.lower = joint.upper = q[j];
    }
  return still;
}

std::string grip_violation(const Robot& robot, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  for (const Load& load : robot.loads)
    for (const int j : grip_joints(robot, load))
      if (!(std::abs(from[j] - to[j]) <= same_grip))
        return "joint " + quote(robot.joints[static_cast<std::size_t>(j)].name) + " holds load " +
               quote(load.name) + " and cannot move from " + short_text(from[j]) + " to " +
               short_text(to[j]) + " while it rides";
  return {};
}

std::vector<std::string> holders_of(const Robot& robot, const std::string& part) {
  const auto load = std::find_if(robot.loads.begin(), robot.loads.end(),
                                 [&](const Load& known) { return known.name == part; });
  if (load == robot.loads.end()) return {};
  std::vector<std::string> holders;
  const auto add_parts_of = [&](int link) {
    for (const Body& body : robot.bodies)
      if (body.link == link && body.part != part) holders.push_back(body.part);
  };
  const auto found = std::find_if(robot.links.begin(), robot.links.end(),
                                  [&](const Link& link) { return link.name == load->link; });
  for (auto i = static_cast<int>(found - robot.links.begin());
       i >= 0 && i < static_cast<int>(robot.links.size()) && holders.empty();
       i = robot.links[static_cast<std::size_t>(i)].parent)
    add_parts_of(i);
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (std::find(load->touches.begin(), load->touches.end(), robot.links[i].name) != load->touches.end())
      add_parts_of(static_cast<int>(i));
  return holders;
}

bool is_same(const Load& a, const Load& b) {
  const auto names = [](const Load& load) {
    return std::set<std::string>(load.touches.begin(), load.touches.end());
  };
  const double apart = (a.link_from_load.matrix() - b.link_from_load.matrix()).cwiseAbs().maxCoeff();
  return a.name == b.name && a.link == b.link && names(a) == names(b) && apart <= same_length &&
         std::abs(a.mass - b.mass) <= same_length && are_alike(a.shape, b.shape);
}

}  // namespace clearway
