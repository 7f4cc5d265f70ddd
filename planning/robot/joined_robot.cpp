#include "planning/robot/joined_robot.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

void append(Robot& all, const std::string& name, const Robot& robot) {
  const std::string prefix = name + "/";
  const auto links = static_cast<int>(all.links.size()), joints = static_cast<int>(all.joints.size()),
             bodies = static_cast<int>(all.bodies.size());
  for (Joint joint : robot.joints) {
    joint.name.insert(0, prefix);
    all.joints.push_back(std::move(joint));
  }
  for (Link link : robot.links) {
    link.name.insert(0, prefix);
    if (link.parent < 0) link.parent_from_link = robot.map_from_base * link.parent_from_link;
    link.parent = link.parent < 0 ? 0 : link.parent + links;
    if (link.joint >= 0) link.joint += joints;
    all.links.push_back(std::move(link));
  }
  for (Body body : robot.bodies) {
    body.part.insert(0, prefix);
    body.link += links;
    all.bodies.push_back(std::move(body));
  }
  for (const auto& [first, second] : robot.exempt) all.exempt.emplace_back(first + bodies, second + bodies);
  for (const std::string& part : robot.critical_parts) all.critical_parts.push_back(prefix + part);
}

}  // namespace

Robot joined_robot(const std::vector<std::pair<std::string, Robot>>& robots) {
  if (robots.empty()) throw std::invalid_argument("a team needs at least one robot");
  Robot all;
  Link root;
  root.name = "map";
  all.links.push_back(root);
  all.scale = robots.front().second.scale;
  std::set<std::string> names;
  for (const auto& [name, robot] : robots) {
    if (!names.insert(name).second)
      throw std::invalid_argument("two robots are called " + quote(name) + ": expected names that differ");
    all.name += (all.name.empty() ? "" : " + ") + robot.name;
    append(all, name, robot);
  }
  return all;
}

Configuration joined(const std::vector<Configuration>& configurations) {
  Eigen::Index size = 0;
  for (const Configuration& q : configurations) size += q.size();
  Configuration all(size);
  Eigen::Index at = 0;
  for (const Configuration& q : configurations) {
    all.segment(at, q.size()) = q;
    at += q.size();
  }
  return all;
}

}  // namespace clearway
