#include <algorithm>
#include <cmath>
#include <locale>
#include <numbers>
#include <random>
#include <sstream>

#include "mapping/system/plain_text.hpp"
#include "mapping/system/random_unit.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway::check {
namespace {

constexpr double tolerance = 1e-9;                    ///< m, rad
constexpr int configurations = 50;                    ///< random ones
constexpr double most_turn = 2.0 * std::numbers::pi;  ///< looked at of a joint without limits

/// Both limits, the middle, then random ones.
Configuration configuration(const Robot& robot, int number, std::mt19937_64& random) {
  Configuration q(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const double lower = std::max(robot.joints[j].lower, -most_turn);
    const double upper = std::min(robot.joints[j].upper, most_turn);
    const double share = number < 3 ? 0.5 * number : random_unit(random);
    q[static_cast<Eigen::Index>(j)] = lower + share * (upper - lower);
  }
  return q;
}

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.linear() - b.linear()).norm() / std::numbers::sqrt2;  // of small angles
}

void require_near(const Robot& robot, const std::string& what, const Eigen::Isometry3d& ours,
                  const Eigen::Isometry3d& theirs, const Configuration& q) {
  const double apart = (ours.translation() - theirs.translation()).norm();
  const double turned = angle_between(ours, theirs);
  if (apart <= tolerance && turned <= tolerance) return;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << what << " is " << apart << " m and " << turned
       << " rad away from where kdl_parser puts it, with the joints at "
       << q.transpose().format(Eigen::IOFormat(6, Eigen::DontAlignCols, ", ", "", "", "", "(", ")"));
  disagree(robot, text.str());
}

}  // namespace

void require_same_poses(const Robot& robot, const KdlArm& arm) {
  if (robot.source.empty() && robot.loads.empty()) return;  // it is of no file
  std::mt19937_64 random(1);
  std::vector<Eigen::Isometry3d> links;
  BodyPoses bodies;
  Robot on_base = robot;
  on_base.map_from_base.setIdentity();  // far from the map's origin there would be no digits left for 1e-9 m
  for (int number = 0; number < 3 + configurations; ++number) {
    const Configuration q = configuration(robot, number, random);
    const LinkPoses ours = forward_kinematics(on_base, q);
    arm.place_on_base(q, links, bodies);
    for (std::size_t i = 0; i < ours.size(); ++i)
      require_near(robot, "link " + quote(robot.links[i].name), ours[i], links[i], q);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Body& body = robot.bodies[b];
      require_near(robot, "a body of link '" + robot.links[static_cast<std::size_t>(body.link)].name + "'",
                   ours[static_cast<std::size_t>(body.link)] * body.link_from_shape, bodies[b], q);
    }
  }
}

}  // namespace clearway::check
