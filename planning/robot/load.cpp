#include "planning/robot/load.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <stdexcept>

#include "mapping/rigid_pose.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
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
  throw std::invalid_argument(what + ": robot " + quote(robot.name) + " has no link " + quote(name) +
                              ", did you mean " + quote(nearest_name(name.substr(0, 100), names)) + "?");
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

/// The first link on the way from the root to this one that the joint moves; -1: it does not move it.
int nearest_moved_by(const Robot& robot, int joint, int at) {
  int first = -1;
  for (; at >= 0; at = robot.links[static_cast<std::size_t>(at)].parent)
    if (robot.links[static_cast<std::size_t>(at)].joint == joint) first = at;
  return first;
}

}  // namespace

bool LegLoad::rides_on(int leg) const {
  return legs.empty() || std::find(legs.begin(), legs.end(), leg) != legs.end();
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

std::vector<int> grip_joints(const Robot& robot, const Load& load) {
  const auto link = [&](int i) -> const Link& { return robot.links[static_cast<std::size_t>(i)]; };
  const auto index_of = [&](const std::string& name) {
    for (int i = 0; i < static_cast<int>(robot.links.size()); ++i)
      if (link(i).name == name) return i;
    return -1;
  };
  const auto moves = [&](int joint, int at) {
    for (; at >= 0; at = link(at).parent)
      if (link(at).joint == joint && link(at).multiplier != 0.0) return true;
    return false;
  };
  std::set<int> holding = {index_of(load.link)};
  for (const std::string& name : load.touches) holding.insert(index_of(name));
  const auto is_a_load = [&](const Body& body) {
    return std::any_of(robot.loads.begin(), robot.loads.end(),
                       [&](const Load& known) { return known.name == body.part; });
  };
  std::vector<int> grip;
  bool is_carried = false;
  for (int j = 0; j < static_cast<int>(robot.dof()); ++j) {
    is_carried = is_carried || moves(j, index_of(load.link));
    const auto moved = std::count_if(holding.begin(), holding.end(), [&](int i) { return moves(j, i); });
    const bool moves_others = std::any_of(robot.bodies.begin(), robot.bodies.end(), [&](const Body& body) {
      return !holding.contains(body.link) && !is_a_load(body) && moves(j, body.link);
    });
    // Fingers that close on one another move all that holds it, and each another way.
    const bool is_alike =
        moved == static_cast<std::ptrdiff_t>(holding.size()) && moves(j, index_of(load.link)) &&
        std::all_of(holding.begin(), holding.end(), [&](int i) {
          return nearest_moved_by(robot, j, i) == nearest_moved_by(robot, j, index_of(load.link));
        });
    const bool is_tip_a_finger = holding.contains(robot.tip_link) && robot.tip_link != index_of(load.link);
    const bool moves_tip = moves(j, robot.tip_link) && !is_tip_a_finger;
    if (moved > 0 && !is_alike && !moves_others && !moves_tip) grip.push_back(j);
  }
  return is_carried ? grip : std::vector<int>{};
}

Robot with_still_grip(const Robot& robot, const Eigen::VectorXd& q) {
  Robot still = robot;
  for (const Load& load : robot.loads)
    for (const int j : grip_joints(robot, load)) {
      Joint& joint = still.joints[static_cast<std::size_t>(j)];
      joint.lower = joint.upper = q[j];
    }
  return still;
}

std::string grip_violation(const Robot& robot, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  for (const Load& load : robot.loads)
    for (const int j : grip_joints(robot, load))
      if (from[j] != to[j])
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
