#include <algorithm>
#include <kdl/frames.hpp>
#include <kdl/segment.hpp>

#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_links.hpp"

namespace clearway::check {
namespace {

[[noreturn]] void refuse_load(const Robot& robot, const Load& load, const std::string& what) {
  throw FileDisagrees("robot " + quote(robot.name) + " does not carry its load " + quote(load.name) +
                      " as it is stated: " + what);
}

int link_called(const Robot& robot, const std::string& name) {
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].name == name) return static_cast<int>(i);
  return -1;
}

KDL::Frame load_frame(const Eigen::Isometry3d& pose) {
  KDL::Frame frame;
  for (int i = 0; i < 3; ++i) {
    frame.p(i) = pose(i, 3);
    for (int k = 0; k < 3; ++k) frame.M(i, k) = pose(i, k);
  }
  return frame;
}

/// The load that a body is; null for one of the robot's own.
const Load* load_of(const Robot& robot, std::size_t body) {
  return body < own_bodies(robot) ? nullptr : &robot.loads[body - own_bodies(robot)];
}

bool holds(const Robot& robot, const Load& load, std::size_t body) {
  const std::string& link = robot.links[static_cast<std::size_t>(robot.bodies[body].link)].name;
  return link == load.link || std::find(load.touches.begin(), load.touches.end(), link) != load.touches.end();
}

}  // namespace

std::size_t own_links(const Robot& robot) {
  return robot.links.size() - std::min(robot.links.size(), robot.loads.size());
}

std::size_t own_bodies(const Robot& robot) {
  return robot.bodies.size() - std::min(robot.bodies.size(), robot.loads.size());
}

Robot with_stated_loads(const Robot& robot) {
  Robot stated = robot;
  for (std::size_t i = 0; i < robot.loads.size(); ++i) {
    const Load& load = robot.loads[i];
    const std::size_t link = own_links(robot) + i, body = own_bodies(robot) + i;
    if (robot.links.size() < robot.loads.size() || robot.links[link].name != load.name)
      refuse_load(robot, load, "there is no link of it");
    if (robot.bodies.size() < robot.loads.size() || robot.bodies[body].part != load.name ||
        robot.bodies[body].link != static_cast<int>(link))
      refuse_load(robot, load, "there is no body of it");
    const int carrier = link_called(robot, load.link);
    if (carrier < 0 || carrier >= static_cast<int>(link))
      refuse_load(robot, load, "there is no link " + quote(load.link));
    if (!load.link_from_load.matrix().allFinite()) refuse_load(robot, load, "its pose is not finite");
    stated.bodies[body].shape = load.shape;
  }
  return stated;
}

void add_loads(const Robot& robot, KdlModel& model) {
  for (const Load& load : robot.loads) {
    model.links.push_back(
        {.segment = std::make_shared<KDL::Segment>(load.name, KDL::Joint(load.name, KDL::Joint::None),
                                                   load_frame(load.link_from_load)),
         .parent = link_called(robot, load.link)});
    model.link_from_body.push_back(Eigen::Isometry3d::Identity());
  }
}

std::optional<bool> is_held(const Robot& robot, std::size_t a, std::size_t b) {
  const Load *first = load_of(robot, a), *second = load_of(robot, b);
  if (!first && !second) return std::nullopt;
  return (first && holds(robot, *first, b)) || (second && holds(robot, *second, a));
}

}  // namespace clearway::check
