#include "planning/beam/lattice_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "planning/robot/link_pose.hpp"
#include "planning/space/collision_model.hpp"

namespace clearway {
namespace {

constexpr double rounding = 1e-9;    ///< metres by which a bound must hold to decide in place of a look
constexpr double pair_slack = 1e-6;  ///< metres that a distance of two bodies may fall short of the true one
constexpr std::size_t tabled_joints = 10;  ///< at most, as the table has 2^joints entries
constexpr double field_slack = 2.0;        ///< voxels that coarse_clearance may fall short of the distance

}  // namespace

LatticeChecks::LatticeChecks(const ConfigurationSpace& space, const Lattice& lattice)
    : model_(space.collision_model()),
      meter_(space.meter()),
      lattice_(lattice),
      poses_(model_.robot, lattice),
      edge_(std::make_unique<EdgePoses>()) {
  const auto members = static_cast<Eigen::Index>(model_.members());
  const std::size_t links = model_.robot.links.size();
  for (LinkPoses* poses : {&edge_->begin, &edge_->middle, &edge_->end}) poses->resize(links);
  map_from_link_.resize(links);
  placed_.resize(links);
  step_motion_.resize(members, lattice.dof());
  whole_motion_.resize(members);
  motion_.resize(model_.members());
  recent_.resize(model_.bodies.size());
  order_.resize(model_.members());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (std::size_t m = 0; m < model_.members(); ++m) {
    const auto row = static_cast<Eigen::Index>(m);
    for (Eigen::Index j = 0; j < lattice.dof(); ++j)
      step_motion_(row, j) = model_.motion(m, lattice.step(j) * Eigen::VectorXd::Unit(lattice.dof(), j));
    whole_motion_[row] = step_motion_.row(row).sum();
    joints_of_.push_back(static_cast<std::size_t>(lattice.dof()));
    while (joints_of_[m] > 0 && !(model_.rates(m)[static_cast<Eigen::Index>(joints_of_[m]) - 1] > 0.0))
      --joints_of_[m];
    deciding_joints_ = std::max(deciding_joints_, joints_of_[m]);
    if (m >= model_.bodies.size()) {
      slack_.push_back(pair_slack);
      continue;
    }
    // is_edge_free proves a body at once when each of its spheres is farther than the motion by the coarse
    // field at the middle: these stand out of the body, and the field falls short of the distance and ends.
    const BodyCollision& body = model_.bodies[m];
    double largest = 0.0;
    for (const Sphere& sphere : body.body().cover) largest = std::max(largest, sphere.radius);
    // At most |motion| / |length of the edge| times half of its resolution: levers . |dq| <= |levers| |dq|.
    edge_margin_.push_back(model_.options.padding +
                           model_.levers[m].norm() * model_.options.edge_resolution / 2.0 * (1.0 + 1e-6));
    const double short_by = field_slack * body.space().resolution();
    const bool in_field =
        largest + model_.options.padding + whole_motion_[row] + short_by < body.space().max_distance();
    slack_.push_back(in_field ? body.cover_excess() + short_by : std::numeric_limits<double>::infinity());
  }
}

LatticeChecks::~LatticeChecks() = default;

void LatticeChecks::go_to(const LatticeIndex& node) {
  const std::vector<Link>& links = model_.robot.links;
  for (std::size_t i = 0; i < links.size(); ++i) {  // a link stays where its parent and its joint stay
    const auto joint = static_cast<std::size_t>(links[i].joint);
    const bool moves = links[i].joint >= 0 && (node_.empty() || node_[joint] != node[joint]);
    if (moves || (links[i].parent >= 0 && !placed_[static_cast<std::size_t>(links[i].parent)]))
      placed_[i] = false;
  }
  node_ = node;
}

const Eigen::Isometry3d& LatticeChecks::pose(std::size_t link) {
  if (placed_[link]) return map_from_link_[link];
  const Link& which = model_.robot.links[link];
  const Eigen::Isometry3d& parent =
      which.parent < 0 ? model_.robot.map_from_base : pose(static_cast<std::size_t>(which.parent));
  place_link(parent, poses_.at(link, node_), map_from_link_[link]);
  placed_[link] = true;
  return map_from_link_[link];
}

void LatticeChecks::place_edge(const LatticeIndex& from, const LatticeIndex& to) {
  const auto place = [&](LinkPoses& poses, std::size_t link, const Eigen::Isometry3d& on_parent) {
    const int parent = model_.robot.links[link].parent;
    place_link(parent < 0 ? model_.robot.map_from_base : poses[static_cast<std::size_t>(parent)], on_parent,
               poses[link]);
  };
  go_to(to);
  for (std::size_t link = 0; link < model_.robot.links.size(); ++link) {  // parents first
    place(edge_->begin, link, poses_.at(link, from));
    place(edge_->middle, link, poses_.between(link, from, to));
    edge_->end[link] = pose(link);
  }
}

void LatticeChecks::find_motion(const LatticeIndex& from, const LatticeIndex& to) {
  Eigen::Map<Eigen::VectorXd> motion(motion_.data(), static_cast<Eigen::Index>(motion_.size()));
  std::size_t which = 0;  // of the joints, as bits
  if (from.size() <= tabled_joints) {
    for (std::size_t j = 0; j < from.size(); ++j) which |= static_cast<std::size_t>(from[j] != to[j]) << j;
    if (motions_.empty()) motions_.resize(std::size_t{1} << from.size());
    if (motions_[which].size() > 0) {
      motion = motions_[which];
      return;
    }
  }
  motion.setZero();
  for (std::size_t j = 0; j < from.size(); ++j) {
    if (from[j] != to[j]) motion += step_motion_.col(static_cast<Eigen::Index>(j));
  }
  if (from.size() <= tabled_joints) motions_[which] = motion;
}

/// A lower bound from spheres, fields and bounding spheres alone.
double LatticeChecks::quick_clearance(std::size_t member) {
  if (member < model_.bodies.size()) {
    const BodyCollision& body = model_.bodies[member];
    return body.coarse_clearance(pose(static_cast<std::size_t>(body.body().link)));
  }
  const BodyPair& pair = model_.pairs[member - model_.bodies.size()];
  for (const int body : {pair.first, pair.second})
    pose(static_cast<std::size_t>(model_.robot.bodies[static_cast<std::size_t>(body)].link));
  return pair_distance_bound(model_.robot, pair, map_from_link_,
                             2.0 * whole_motion_[static_cast<Eigen::Index>(member)]);
}

KnownClearances LatticeChecks::measure(const LatticeIndex& node) {
  go_to(node);
  KnownClearances known;
  for (std::size_t m = 0; m < model_.members(); ++m)
    known.at_least.push_back(std::max(0.0, quick_clearance(m)));
  known.less_than.assign(model_.members(), std::numeric_limits<double>::infinity());
  return known;
}

/// Whether the body or pair is free at the node, when what is known of its clearance does not say enough.
bool LatticeChecks::refresh(std::size_t member, KnownClearances& own) {
  double& known = own.at_least[member];
  if (member >= model_.bodies.size()) {
    known = std::max(known, quick_clearance(member));
    return known > rounding ||
           is_apart(model_.robot, model_.pairs[member - model_.bodies.size()], map_from_link_, 0.0);
  }
  const BodyCollision& body = model_.bodies[member];
  const Eigen::Isometry3d& map_from_link = pose(static_cast<std::size_t>(body.body().link));
  const double padding = model_.options.padding, margin = edge_margin_[member];  // what edges will ask
  const double found = body.clearance_beyond(map_from_link, padding, margin, recent_[member]);
  if (found < margin) own.less_than[member] = margin;
  known = std::max(known, found);
  return found >= 0.0 || known > padding + rounding;
}

bool LatticeChecks::is_free(const LatticeIndex& node, const LatticeIndex& neighbour,
                            const KnownClearances& of_neighbour, KnownClearances& own) {
  go_to(node);
  find_motion(neighbour, node);
  own.at_least.resize(model_.members());
  own.less_than.assign(model_.members(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const std::size_t member = order_[i];
    const double padding = member < model_.bodies.size() ? model_.options.padding : 0.0;
    own.at_least[member] =
        std::max(0.0, of_neighbour.at_least[member] - motion_[member] * (1.0 + rounding) - rounding);
    const double slack = std::isfinite(slack_[member]) ? slack_[member] : 0.0;
    const double enough = padding + whole_motion_[static_cast<Eigen::Index>(member)] + slack + rounding;
    if (own.at_least[member] > enough || refresh(member, own)) continue;
    std::rotate(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(i),
                order_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    return false;
  }
  return true;
}

bool LatticeChecks::is_edge_free(const LatticeIndex& from, KnownClearances& of_from, const LatticeIndex& to,
                                 KnownClearances& of_to) {
  const WorkMeter::Scope scope(meter_, PlanWork::proofs);
  find_motion(from, to);
  open_.clear();
  for (const std::size_t member : order_) {
    if (motion_[member] == 0.0) continue;  // free at both ends
    const double padding = member < model_.bodies.size() ? model_.options.padding : 0.0;
    const double enough = padding + motion_[member] * (1.0 + rounding) + slack_[member] + rounding;
    if (std::max(of_from.at_least[member], of_to.at_least[member]) <= enough)
      open_.push_back(static_cast<int>(member));
  }
  if (open_.empty()) return true;
  place_edge(from, to);
  return model_.is_edge_free(lattice_.configuration(from), lattice_.configuration(to), open_, recent_,
                             &of_from, &of_to, edge_.get());
}

}  // namespace clearway
