// Geometric inverse kinematics of PUMA-like arms: Craig, "Introduction to Robotics", 2nd ed. 1989, sec. 4.7.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "planning/robot/kinematics.hpp"
#include "planning/robot/puma_branches.hpp"

namespace clearway {
namespace {

constexpr double at_limit = 1e-10;        ///< radians beyond a limit that are rounding
constexpr double table_tolerance = 1e-9;  ///< relative, on the table's zeros and right angles

/// The lengths of Craig's table, at the robot's scale.
struct PumaTable {
  double a2 = 0.0, a3 = 0.0, d3 = 0.0, d4 = 0.0;
  Eigen::Isometry3d map_from_shoulder = Eigen::Isometry3d::Identity();  ///< frame 0, unmoved
  Eigen::Isometry3d wrist_from_tip = Eigen::Isometry3d::Identity();     ///< frame 6 to the tip
};

/// Whether `link` is turned by `alpha` about x against its parent; its offset is then (a, -d sin, d cos).
bool is_turned(const Link& link, double alpha) {
  const Eigen::Matrix3d expected = Eigen::AngleAxisd(alpha, Eigen::Vector3d::UnitX()).toRotationMatrix();
  return (link.parent_from_link.linear() - expected).norm() < table_tolerance;
}

PumaTable read_table(const Robot& robot) {
  const auto refuse = [&] {
    throw std::invalid_argument(robot.name +
                                ": inverse_kinematics 'puma' needs six revolute joints that follow "
                                "Craig's table of the PUMA 560, use 'numeric' for other arms");
  };
  std::vector<int> chain;  // actuated links from the tip's to the root's
  PumaTable table;
  int from_wrist = robot.tip_link;
  table.wrist_from_tip = robot.link_from_tip;
  for (; from_wrist >= 0 && robot.links[static_cast<std::size_t>(from_wrist)].joint < 0;
       from_wrist = robot.links[static_cast<std::size_t>(from_wrist)].parent) {
    table.wrist_from_tip =
        robot.links[static_cast<std::size_t>(from_wrist)].parent_from_link * table.wrist_from_tip;
  }
  for (int i = from_wrist; i >= 0 && robot.links[static_cast<std::size_t>(i)].joint >= 0;
       i = robot.links[static_cast<std::size_t>(i)].parent) {
    chain.insert(chain.begin(), i);
  }
  if (chain.size() != 6 || robot.dof() != 6) refuse();
  std::array<Eigen::Vector3d, 6> offset;
  const double right = std::numbers::pi / 2;
  const std::array<double, 6> alpha{0.0, -right, 0.0, -right, right, -right};
  for (std::size_t i = 0; i < 6; ++i) {
    const Link& link = robot.links[static_cast<std::size_t>(chain[i])];
    const bool plain = link.joint == static_cast<int>(i) && link.multiplier == 1.0 && link.offset == 0.0;
    if (!plain || kind_of(robot, link) != JointKind::revolute ||
        (axis_of(robot, link) - Eigen::Vector3d::UnitZ()).norm() > table_tolerance)
      refuse();
    if (i > 0 && !is_turned(link, alpha[i])) refuse();
    offset[i] = link.parent_from_link.translation();
  }
  table.a2 = offset[2].x();
  table.d3 = offset[2].z();
  table.a3 = offset[3].x();
  table.d4 = offset[3].y();
  const double size = table_tolerance * (std::abs(table.a2) + std::abs(table.d4));
  const double zeros = std::max({offset[1].norm(), std::abs(offset[2].y()), std::abs(offset[3].z()),
                                 offset[4].norm(), offset[5].norm()});
  if (zeros > size || table.a2 <= 0.0 || table.d4 == 0.0) refuse();
  table.map_from_shoulder = robot.map_from_base;
  std::vector<int> above;
  for (int i = chain.front(); i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent)
    above.insert(above.begin(), i);
  for (int i : above)
    table.map_from_shoulder =
        table.map_from_shoulder * robot.links[static_cast<std::size_t>(i)].parent_from_link;
  return table;
}

/// theta_4..6 from the rotation of frame 6 against frame 3: with M = Rx(90 deg) R36, M = Rz(theta_4)
/// Ry(-theta_5) Rz(theta_6). At the wrist's singularity theta_4 is `theta4_hint`.
void solve_wrist(const Eigen::Matrix3d& r36, bool flipped, double theta4_hint, Configuration& q) {
  const Eigen::Matrix3d m =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()).toRotationMatrix() * r36;
  const double sine = (flipped ? -1.0 : 1.0) * std::hypot(m(0, 2), m(1, 2));  // sin(-theta_5)
  q[4] = -std::atan2(sine, m(2, 2));
  if (std::abs(sine) > 1e-10) {
    q[3] = std::atan2(m(1, 2) / sine, m(0, 2) / sine);
    q[5] = std::atan2(m(2, 1) / sine, -m(2, 0) / sine);
    return;
  }
  q[3] = theta4_hint;
  // M is then Rz(theta_4 + theta_6), or with theta_5 at half a turn what theta_6 - theta_4 makes of it.
  q[5] =
      m(2, 2) > 0.0 ? std::atan2(m(1, 0), m(1, 1)) - theta4_hint : std::atan2(m(0, 1), m(1, 1)) + theta4_hint;
}

}  // namespace

std::array<std::optional<Configuration>, 8> puma_branches(const Robot& robot,
                                                          const Eigen::Isometry3d& map_from_tip,
                                                          double theta4_hint) {
  const PumaTable t = read_table(robot);
  const Eigen::Isometry3d wrist = t.map_from_shoulder.inverse() * map_from_tip * t.wrist_from_tip.inverse();
  const Eigen::Vector3d p = wrist.translation();
  std::array<std::optional<Configuration>, 8> branches;
  const double rho_squared = p.x() * p.x() + p.y() * p.y() - t.d3 * t.d3;
  const double k = (p.squaredNorm() - t.a2 * t.a2 - t.a3 * t.a3 - t.d3 * t.d3 - t.d4 * t.d4) /
                   (2.0 * t.a2);  // Craig 1989, eq. 4.73
  const double elbow_squared = t.a3 * t.a3 + t.d4 * t.d4 - k * k;
  if (rho_squared < 0.0 || elbow_squared < 0.0) return branches;
  for (std::size_t i = 0; i < branches.size(); ++i) {
    const double shoulder = (i & 4u) ? -1.0 : 1.0, elbow = (i & 2u) ? -1.0 : 1.0;
    Configuration q(6);
    q[0] = std::atan2(p.y(), p.x()) -
           std::atan2(t.d3, shoulder * std::sqrt(rho_squared));                       // Craig 1989, eq. 4.70
    q[2] = std::atan2(t.a3, t.d4) - std::atan2(k, elbow * std::sqrt(elbow_squared));  // Craig 1989, eq. 4.75
    const double c1 = std::cos(q[0]), s1 = std::sin(q[0]), c3 = std::cos(q[2]), s3 = std::sin(q[2]);
    const double along = c1 * p.x() + s1 * p.y();
    const double theta23 =
        std::atan2((-t.a3 - t.a2 * c3) * p.z() - along * (t.d4 - t.a2 * s3),
                   (t.a2 * s3 - t.d4) * p.z() + (t.a3 + t.a2 * c3) * along);  // Craig 1989, eq. 4.80
    q[1] = theta23 - q[2];                                                    // Craig 1989, eq. 4.81
    const Eigen::Matrix3d r03 = (Eigen::AngleAxisd(q[0], Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(-std::numbers::pi / 2, Eigen::Vector3d::UnitX()) *
                                 Eigen::AngleAxisd(theta23, Eigen::Vector3d::UnitZ()))
                                    .toRotationMatrix();
    solve_wrist(r03.transpose() * wrist.linear(), (i & 1u) != 0, theta4_hint, q);
    branches[i] = q;
  }
  return branches;
}

std::size_t puma_branch_of(const Robot& robot, const Configuration& q) {
  const auto branches = puma_branches(robot, tip_pose(robot, q), q[3]);
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < branches.size(); ++i) {
    if (!branches[i]) continue;
    double error = 0.0;
    for (Eigen::Index j = 0; j < q.size(); ++j)
      error += std::abs(std::remainder((*branches[i])[j] - q[j], 2.0 * std::numbers::pi));
    if (error < least) {
      least = error;
      best = i;
    }
  }
  return best;
}

std::optional<Configuration> unwrapped_within_limits(const Robot& robot, Configuration q,
                                                     const Configuration& near) {
  constexpr double turn = 2.0 * std::numbers::pi;
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    if (robot.joints[j].kind != JointKind::revolute) continue;
    double& value = q[static_cast<Eigen::Index>(j)];
    const double wanted = near[static_cast<Eigen::Index>(j)];
    const double lower = robot.joints[j].lower, upper = robot.joints[j].upper;
    if (is_same_after_turns(robot, j)) {
      value += turn * std::round((wanted - value) / turn);
      if (value < lower - at_limit) value += turn;
      if (value > upper + at_limit) value -= turn;
    }
    if (value < lower - at_limit || value > upper + at_limit) return std::nullopt;
    value = std::clamp(value, lower, upper);
  }
  return q;
}

std::vector<Configuration> puma_inverse_kinematics(const Robot& robot,
                                                   const Eigen::Isometry3d& map_from_tip) {
  Configuration middle(static_cast<Eigen::Index>(robot.dof()));
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    const Joint& joint = robot.joints[j];
    middle[static_cast<Eigen::Index>(j)] =
        std::isfinite(joint.upper - joint.lower) ? (joint.lower + joint.upper) / 2 : 0.0;
  }
  std::vector<Configuration> solutions;
  if (!map_from_tip.matrix().allFinite()) return solutions;
  for (const auto& branch : puma_branches(robot, map_from_tip, 0.0)) {
    if (!branch) continue;
    if (const auto q = unwrapped_within_limits(robot, *branch, middle)) solutions.push_back(*q);
  }
  return solutions;
}

}  // namespace clearway
