// Whether a space, or a robot, is the one that a plan was made for.
#include "apps/python/plan_terms.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/files/map_digest.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/joint_order.hpp"

namespace clearway {
namespace {

[[noreturn]] void refuse(const std::string& expected, const std::string& got) {
  throw std::invalid_argument("plan: expected one " + expected + ", got " + got);
}

/// x, y, z; roll, pitch, yaw.
std::string place_text(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d at = pose.translation(), turn = pose.linear().eulerAngles(2, 1, 0).reverse();
  const auto text = [](Eigen::Vector3d v) {
    v.array() += 0.0;  // no -0
    return short_text(v.x(), 9) + ", " + short_text(v.y(), 9) + ", " + short_text(v.z(), 9);
  };
  return "(" + text(at) + "; " + text(turn) + ")";
}

std::string digest_text(const std::string& digest) { return "with the sha256 " + digest.substr(0, 16) + "…"; }

std::string age_text(double seconds) { return seconds > 0.0 ? short_text(seconds) + " s" : "ever"; }

void require_held(const Robot& robot, const Plan& plan, const std::string& whose) {
  for (const HeldJoint& joint : robot.held) {
    const auto said = plan.held.find(joint.name);
    if (said != plan.held.end() && std::abs(said->second - joint.value) <= contract_tolerance) continue;
    refuse("with joint " + quote(joint.name) + " held at " + short_text(joint.value) + ", as in the " + whose,
           said == plan.held.end() ? "none" : short_text(said->second));
  }
}

}  // namespace

void require_own_robot(const Robot& robot, const std::string& asked, const Plan& plan,
                       const std::string& whose) {
  require_joint_order(robot, plan);
  const auto name = [](const std::string& text) { return std::filesystem::path(text).stem().string(); };
  const std::string own = asked.empty() ? robot.name : asked;
  if (!plan.robot.empty() && name(plan.robot) != name(own))
    refuse("for the " + whose + "'s robot, " + quote(own), "one for " + quote(plan.robot));
  if (!(std::abs(plan.robot_scale - robot.scale) <= contract_tolerance * robot.scale))
    refuse("for a robot at scale " + short_text(robot.scale) + ", as the " + whose + "'s is",
           short_text(plan.robot_scale));
  if (!((plan.map_from_base.matrix() - robot.map_from_base.matrix()).cwiseAbs().maxCoeff() <=
        contract_tolerance))
    refuse("for a robot whose base is where the " + whose + "'s is, " + place_text(robot.map_from_base),
           place_text(plan.map_from_base));
  require_held(robot, plan, whose);
}

Robot placed_by(const Plan& plan, Robot robot) {
  if (robot.map_from_base.matrix() == Eigen::Matrix4d::Identity()) robot.map_from_base = plan.map_from_base;
  return robot;
}

void require_own_map(const NamedSpace& space, const Plan& plan) {
  if (!plan.map_sha256.empty()) {
    const std::string own = space.map_digest.empty() ? map_sha256(space->map()) : space.map_digest;
    if (own != plan.map_sha256)
      refuse("that was made on the space's map, " + digest_text(own),
             "one made on another, " + digest_text(plan.map_sha256) + "; accept_map=True lets it");
  }
  const double edge = space->map().resolution();
  if (plan.map_resolution > 0.0 && std::abs(plan.map_resolution - edge) > contract_tolerance)
    refuse("that was made on voxels of " + short_text(edge) + " m, as the space's are",
           short_text(plan.map_resolution) + " m");
}

void require_own_space(const NamedSpace& space, const Plan& plan, bool accept_map) {
  require_own_robot(space->robot(), space.asked, plan, "space");
  if (!accept_map) require_own_map(space, plan);
  for (const auto& [part, policy] : space->policies())
    if (const auto said = plan.policies.find(part); said != plan.policies.end() && said->second < policy)
      refuse("that lets part " + quote(part) + " be where the space does, " + std::string(to_string(policy)),
             "one that demands " + std::string(to_string(said->second)));
  const auto& [padding, seen_within] = std::pair(space->options().padding, space->options().seen_within);
  if (plan.padding > padding + contract_tolerance)
    refuse("with at most the space's padding, " + short_text(padding) + " m",
           short_text(plan.padding) + " m");
  if (plan.seen_within > 0.0 && !(seen_within > 0.0 && seen_within <= plan.seen_within))
    refuse("that accepts what the space does, seen within " + age_text(seen_within),
           "one that demands within " + age_text(plan.seen_within));
}

}  // namespace clearway
