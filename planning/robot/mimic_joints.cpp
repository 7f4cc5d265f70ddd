#include "planning/robot/mimic_joints.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const MimicJoint& mimic, const std::string& why) {
  throw std::invalid_argument(file.string() + ": joint " + quote(mimic.joint.name) + " mimics " +
                              quote(mimic.master) + why);
}

const MimicJoint* mimic_called(const std::string& name, const std::vector<MimicJoint>& mimics) {
  const auto found =
      std::find_if(mimics.begin(), mimics.end(), [&](const MimicJoint& m) { return m.joint.name == name; });
  return found == mimics.end() ? nullptr : &*found;
}

/// The joint that moves `mimic`, over those between that follow it too. Makes the link's multiplier and
/// offset those of that joint.
std::string first_master(const std::filesystem::path& file, const MimicJoint& mimic,
                         const std::vector<MimicJoint>& mimics, const std::vector<Link>& as_written,
                         Link& link) {
  if (mimic.master == mimic.joint.name) refuse(file, mimic, ", itself: expected another joint");
  std::string master = mimic.master;
  for (std::size_t steps = 0; const MimicJoint* next = mimic_called(master, mimics); ++steps) {
    if (steps > mimics.size()) refuse(file, mimic, ", which in turn follows it: expected one that moves");
    const Link& between = as_written[static_cast<std::size_t>(next->link)];
    link.offset += link.multiplier * between.offset;
    link.multiplier *= between.multiplier;
    master = next->master;
  }
  return master;
}

/// Index of the joint that `mimic` follows.
std::size_t master_of(const std::filesystem::path& file, const MimicJoint& mimic, const std::string& master,
                      const Robot& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  const auto found = std::find(names.begin(), names.end(), master);
  if (found == names.end()) {
    if (std::any_of(robot.links.begin(), robot.links.end(),
                    [&](const Link& link) { return link.joint_name == master; }))
      refuse(file, mimic, ", which is fixed: expected a joint that moves");
    refuse(file, mimic, ", which is no joint that moves, " + suggestion(master, names));
  }
  return static_cast<std::size_t>(found - names.begin());
}

/// Narrows the master's limits so that multiplier * q + offset keeps the mimic joint's own, and its speed,
/// acceleration and jerk the mimic joint's own.
void keep_mimic_limits(const std::filesystem::path& file, const MimicJoint& mimic, const Link& link,
                       Joint& master) {
  double lower = (mimic.joint.lower - link.offset) / link.multiplier;
  double upper = (mimic.joint.upper - link.offset) / link.multiplier;
  if (link.multiplier < 0.0) std::swap(lower, upper);
  lower += 0.0, upper += 0.0;  // no "-0"
  if (lower > master.lower) master.lower = lower, master.lower_follower = mimic.joint.name;
  if (upper < master.upper) master.upper = upper, master.upper_follower = mimic.joint.name;
  for (double Joint::*limit : {&Joint::max_velocity, &Joint::max_acceleration, &Joint::max_jerk}) {
    if (!(mimic.joint.*limit > 0.0)) continue;
    const double most = mimic.joint.*limit / std::abs(link.multiplier);
    master.*limit = master.*limit > 0.0 ? std::min(master.*limit, most) : most;
  }
  if (master.lower > master.upper) refuse(file, mimic, " and is never within its own limits");
}

/// A mimic joint moves along or about its own axis, in its own link's frame: the values that multiplier and
/// offset give are those of the file.
void keep_own_motion(const Joint& master, const Joint& own, Link& link) {
  if (!master.axis.isApprox(own.axis, 1e-12)) link.own_axis = own.axis;
  if (master.kind != own.kind) link.own_kind = own.kind;
}

}  // namespace

void resolve_mimics(const std::filesystem::path& file, const std::vector<MimicJoint>& mimics, Robot& robot) {
  const std::vector<Link> as_written = robot.links;
  for (const MimicJoint& mimic : mimics) {
    Link& link = robot.links[static_cast<std::size_t>(mimic.link)];
    const std::string moving = first_master(file, mimic, mimics, as_written, link);
    const std::size_t master = master_of(file, mimic, moving, robot);
    link.joint = static_cast<int>(master);
    keep_mimic_limits(file, mimic, link, robot.joints[master]);
    keep_own_motion(robot.joints[master], mimic.joint, link);
  }
}

}  // namespace clearway
