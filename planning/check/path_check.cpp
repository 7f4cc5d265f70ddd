#include "planning/check/path_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "mapping/stamps/seen_stamps.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/space/part_policies.hpp"

namespace clearway {
namespace {

constexpr double finest_step = 1e-6;        ///< joint-space length (rad, m) at which an advance has stalled
constexpr double probe_step = 1e-4;         ///< how far past a stall a contact is looked for closely
constexpr double most_looks = 2000.0;       ///< along a whole path, where a contact is looked for beyond that
constexpr double most_cells_at_once = 3e7;  ///< of one block of voxels; longer paths are checked in pieces
constexpr double most_cells_in_all = 4e8;   ///< where pieces save nothing
constexpr double most_cells_of_edge = 9e8;  ///< about all bodies together; else body by body

struct Contact {
  int edge = 0;
  double parameter = 0.0;
  bool undecided = false;
  std::string what;
};

using check::Item;
using check::Nearest;

class Checker {
 public:
  Checker(const Robot& robot, const check::KdlArm& arm, const Snapshot& map,
          const std::map<std::string, Policy>& policies, double padding,
          const std::vector<Configuration>& path, double cap, double seen_within,
          const std::vector<Eigen::VectorXd>& deviations)
      : robot_(robot),
        map_(map),
        padding_(padding),
        seen_within_(seen_within),
        path_(path),
        deviations_(deviations),
        cap_(cap),
        arm_(arm),
        fcl_(robot),
        tasks_(check::list_tasks(robot, map, policies, arm_, fcl_)) {
    verdict_.clearance.assign(path.size(), cap);
    for (std::size_t i = 1; i < path.size(); ++i)
      travelled_.push_back(travelled_.back() + (path[i] - path[i - 1]).norm());
    least_ = measured_ = cap;
  }

  PathVerdict run() {
    const int edges =
        std::max<int>(1, static_cast<int>(path_.size()) - 1);  // a lone waypoint: an edge to itself
    check_edges(0, edges);
    verdict_.valid = !contact_;
    verdict_.min_clearance = contact_ ? 0.0 : least_;
    if (contact_) {
      verdict_.undecided = contact_->undecided;
      verdict_.edge = contact_->edge;
      verdict_.parameter = contact_->parameter;
      std::ostringstream text;
      text.imbue(std::locale::classic());
      text << "edge " << contact_->edge << " at " << contact_->parameter << ": " << contact_->what;
      verdict_.first_contact = text.str();
    }
    return verdict_;
  }

 private:
  const Configuration& start(int edge) const { return path_[static_cast<std::size_t>(edge)]; }
  Eigen::VectorXd step(int edge) const {
    const auto end = std::min(static_cast<std::size_t>(edge) + 1, path_.size() - 1);
    return path_[end] - start(edge);
  }

  /// What the bodies of a group and the voxels that concern them take up on these edges.
  Eigen::AlignedBox3d box_of(const check::Tasks& tasks, std::size_t group, int first, int last) const {
    Eigen::AlignedBox3d box;
    for (int edge = first; edge < last; ++edge)
      box.extend(
          check::swept_box(arm_, fcl_, tasks, group, start(edge), step(edge), 10.0 * map_.resolution()));
    box.min().array() -= cap_ + padding_ + 2 * map_.resolution();
    box.max().array() += cap_ + padding_ + 2 * map_.resolution();
    return box;
  }

  std::vector<Eigen::AlignedBox3d> boxes_of(int first, int last) const {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (std::size_t group = 0; group < tasks_.groups.size(); ++group)
      boxes.push_back(box_of(tasks_, group, first, last));
    return boxes;
  }

  /// Of the largest of these boxes.
  double cells_in(const std::vector<Eigen::AlignedBox3d>& boxes) const {
    double most = 0.0;
    for (const Eigen::AlignedBox3d& box : boxes)
      most = std::max(most, (box.sizes() / map_.resolution()).prod());
    return most;
  }

  /// The edges in two halves, when their voxels together are too many, or less would be read for the halves:
  /// not so for many short edges, each of which needs nearly all.
  void check_edges(int first, int last) {
    const std::vector<Eigen::AlignedBox3d> boxes = boxes_of(first, last);
    const double most = cells_in(boxes);
    if (most > most_cells_at_once && last - first > 1) {
      const int middle = first + (last - first) / 2;
      if (most > most_cells_in_all ||
          cells_in(boxes_of(first, middle)) + cells_in(boxes_of(middle, last)) < most) {
        check_edges(first, middle);
        if (!is_refused()) check_edges(middle, last);
        return;
      }
    }
    cells_.clear();
    if (most > most_cells_of_edge) {
      for (int edge = first; edge < last && !is_refused(); ++edge) check_body_by_body(edge);
      return;
    }
    for (std::size_t group = 0; group < tasks_.groups.size(); ++group) {
      cells_.emplace_back(map_, tasks_.groups[group].policy, tasks_.groups[group].volumes, boxes[group],
                          seen_within_);
    }
    for (int edge = first; edge < last && !is_refused(); ++edge) {
      for (const Item& item : tasks_.items) pass(item, edge);
    }
    if (!contact_ && last + 1 == static_cast<int>(path_.size())) measure_waypoint(path_.size() - 1);
  }

  /// An edge about which all bodies together have too many voxels, as these are fine.
  void check_body_by_body(int edge) {
    for (const Item& item : tasks_.items) {
      if (!item.other) {
        const check::Group& group = tasks_.groups[item.group];
        own_cells_.emplace(map_, group.policy, group.volumes,
                           box_of({{group}, {{item.body, std::nullopt, 0}}}, 0, edge, edge + 1),
                           seen_within_);
      }
      pass(item, edge);
      if (!item.other && edge + 2 == static_cast<int>(path_.size()))
        note_clearance(path_.size() - 1, nearest(item, path_.back()).distance);
    }
    own_cells_.reset();
  }

  bool is_refused() const { return contact_ && !contact_->undecided; }

  /// Once a place is undecided, what touches on the rest of the way decides about the path.
  void pass(const Item& item, int edge) {
    if (!contact_ || contact_->edge == edge) advance(item, edge);
    if (contact_ && contact_->undecided)
      look_for_contact(item, edge, contact_->edge == edge ? contact_->parameter : 0.0);
  }

  /// Conservative advancement: from each place the item moves on by less than its certified distance. Keeps
  /// the first contact over all items of the edge.
  void advance(const Item& item, int edge) {
    const Eigen::VectorXd dq = step(edge), abs_dq = dq.cwiseAbs();
    const double rate = (1.0 + 1e-9) * (item.other ? arm_.approach(item.body, *item.other, abs_dq)
                                                   : arm_.motion(item.body, abs_dq));
    const double aside = motion_aside(item, edge);
    const double keep = aside + (item.other ? 0.0 : padding_);
    const double length = dq.norm();
    std::optional<Eigen::Vector3d> hint;
    for (double t = 0.0;;) {
      if (contact_ && contact_->edge == edge && contact_->parameter <= t) return;
      // No more is asked of a pair than takes it through the rest of the edge.
      Nearest near = nearest(item, start(edge) + t * dq, aside + (1.0 - t) * rate / 0.9, hint);
      hint = near.cube;
      if (t == 0.0 && !item.other) note_clearance(static_cast<std::size_t>(edge), near.distance);
      const double room = near.distance - keep;
      // On to where the proof has fallen to 0.8 of the least distance measured so far, not to nothing.
      if (!item.other) measured_ = std::min(measured_, near.distance);
      const double spend = item.other ? room : std::min(near.distance - 0.8 * measured_, room);
      const double ahead = rate > 0.0 ? 0.9 * spend / rate : 1.0;
      if (room <= 0.0 || (t + ahead < 1.0 && ahead * length < finest_step))
        return stall(item, edge, t, length, near);
      if (!item.other) least_ = std::min(least_, near.distance - aside - std::min(ahead, 1.0 - t) * rate);
      t += ahead;
      if (t >= 1.0) return;
    }
  }

  void stall(const Item& item, int edge, double t, double length, Nearest near);
  void look_for_contact(const Item& item, int edge, double begin);
  void keep(const Contact& contact);

  /// How much nearer the item may be where the joints leave the edge.
  double motion_aside(const Item& item, int edge) const {
    if (deviations_.empty()) return 0.0;
    const Eigen::VectorXd& deviation = deviations_[static_cast<std::size_t>(edge)];
    return (1.0 + 1e-9) * (item.other ? arm_.approach(item.body, *item.other, deviation)
                                      : arm_.motion(item.body, deviation));
  }

  /// @param enough of a pair's distance: where more is proved, it may be less than the distance
  /// @param hint a blocked voxel that may be near
  Nearest nearest(const Item& item, const Configuration& q, double enough = HUGE_VAL,
                  const std::optional<Eigen::Vector3d>& hint = std::nullopt) const {
    const Eigen::Isometry3d pose = arm_.place(q, item.body);
    if (item.other)
      return {fcl_.distance(item.body, pose, *item.other, arm_.place(q, *item.other), enough), {}};
    return nearest_voxel(item, pose, cap_ + padding_, hint);
  }

  Nearest nearest_voxel(const Item& item, const Eigen::Isometry3d& pose, double limit,
                        const std::optional<Eigen::Vector3d>& hint = std::nullopt) const {
    return check::nearest_voxel(fcl_, item.body, pose, inner_point(item.body, pose),
                                own_cells_ ? *own_cells_ : cells_[item.group], limit, hint);
  }

  /// What touches the item there, or comes too near to it; none: nothing.
  std::optional<Nearest> contact_at(const Item& item, const Configuration& q) const {
    const Nearest near = item.other
                             ? nearest(item, q, 0.0)
                             : nearest_voxel(item, arm_.place(q, item.body), padding_ + map_.resolution());
    return near.distance <= (item.other ? 0.0 : padding_) ? std::optional(near) : std::nullopt;
  }

  /// A point inside the body: the centre of its frame, or of a hull's corners.
  Eigen::Vector3d inner_point(std::size_t body, const Eigen::Isometry3d& pose) const {
    const std::vector<Eigen::Vector3d>& corners = robot_.bodies[body].shape.vertices();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& corner : corners) sum += corner;
    return corners.empty() ? Eigen::Vector3d(pose.translation())
                           : pose * (sum / static_cast<double>(corners.size()));
  }

  void note_clearance(std::size_t waypoint, double distance) {
    double& known = verdict_.clearance[waypoint];
    known = std::min(known, distance);
  }

  void measure_waypoint(std::size_t waypoint) {
    for (const Item& item : tasks_.items) {
      if (!item.other) note_clearance(waypoint, nearest(item, path_[waypoint]).distance);
    }
  }

  std::string describe(const Item& item, const Nearest& near) const;
  std::string last_look(const Eigen::Vector3d& cube) const;

  const Robot& robot_;
  const Snapshot& map_;
  double padding_;
  double seen_within_;
  const std::vector<Configuration>& path_;
  std::vector<double> travelled_{0.0};              ///< up to each waypoint, in joint space
  const std::vector<Eigen::VectorXd>& deviations_;  ///< of each edge; empty: none
  double cap_;
  const check::KdlArm& arm_;
  check::FclBodies fcl_;
  check::Tasks tasks_;
  std::vector<check::BlockedCells> cells_;        ///< of the edges at hand, one for each group
  std::optional<check::BlockedCells> own_cells_;  ///< of the body at hand, where these are too many
  PathVerdict verdict_;
  std::optional<Contact> contact_;
  double least_ = 0.0;     ///< proved over all that was passed so far
  double measured_ = 0.0;  ///< at the places where the advance stood
};

/// The advance came to rest before a contact, or so near to one that nothing more can be proved: whether
/// something does touch within a short way decides which.
void Checker::stall(const Item& item, int edge, double t, double length, Nearest near) {
  const Eigen::VectorXd dq = step(edge);
  bool touches = near.distance <= (item.other ? 0.0 : padding_);
  for (int i = 1; i <= 10 && !touches && length > 0.0; ++i) {
    const auto there = contact_at(item, start(edge) + std::min(1.0, t + i * probe_step / 10.0 / length) * dq);
    touches = there.has_value();
    if (touches) near = *there;
  }
  keep({edge, t, !touches, describe(item, near) + (touches ? "" : " (too near to prove it does not)")});
  if (!touches && is_refused()) look_for_contact(item, edge, t);  // it may touch before that contact
}

/// At places that are evenly spaced along the whole path, those of this edge from `begin` on.
void Checker::look_for_contact(const Item& item, int edge, double begin) {
  const Eigen::VectorXd dq = step(edge);
  const double length = dq.norm(), all = travelled_.back();
  if (!(length > 0.0)) return;
  const auto at = static_cast<std::size_t>(edge);
  const double before = travelled_[at];
  for (double k = std::ceil((before + begin * length) / all * most_looks); k <= most_looks; ++k) {
    const double place = k / most_looks * all;
    if (place > travelled_[at + 1]) return;
    const double t = std::clamp((place - before) / length, 0.0, 1.0);
    const auto there = contact_at(item, start(edge) + t * dq);
    if (there) return keep({edge, t, false, describe(item, *there)});
  }
}

/// Of contacts the first; of undecided places the first, while there is no contact.
void Checker::keep(const Contact& contact) {
  if (contact_ && contact_->undecided == contact.undecided) {
    if (contact_->edge < contact.edge || contact_->parameter <= contact.parameter) return;
  } else if (contact_ && contact.undecided) {
    return;
  }
  contact_ = contact;
}

std::string Checker::describe(const Item& item, const Nearest& near) const {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << shortened(robot_.bodies[item.body].part);
  if (item.other) {
    text << " touches " << shortened(robot_.bodies[*item.other].part);
  } else if (near.cube) {
    const Policy policy = tasks_.groups[item.group].policy;
    const std::string_view state = to_string(map_.state(*near.cube));
    text << (padding_ > 0.0 ? " comes too near to " : " touches ") << "a voxel that is " << state
         << (policy == Policy::painted && state == "painted" ? " by volumes of other parts" : "") << ", at ("
         << near.cube->x() << ", " << near.cube->y() << ", " << near.cube->z() << "); its policy is "
         << to_string(policy);
    if (policy == Policy::known_free && seen_within_ > 0.0 && map_.state(*near.cube) == VoxelState::seen_free)
      text << ", seen within " << seen_within_ << " s: " << last_look(*near.cube);
  } else {
    text << " comes too near to a blocked voxel";
  }
  return text.str();
}

/// When a voxel was last seen, in words.
std::string Checker::last_look(const Eigen::Vector3d& cube) const {
  const auto seen = map_.last_seen(cube);
  if (!seen) return "it was last seen nobody knows when";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "it was last seen " << map_.seen()->newest() - *seen << " s before the newest look";
  return text.str();
}

void require_deviations(const std::vector<Configuration>& path,
                        const std::vector<Eigen::VectorXd>& deviations) {
  if (deviations.empty()) return;
  if (deviations.size() != std::max<std::size_t>(path.size(), 2) - 1)
    throw std::invalid_argument("deviations must be one for each edge");
  for (const Eigen::VectorXd& deviation : deviations)
    if (deviation.size() != path.front().size() || !deviation.allFinite() || deviation.minCoeff() < 0.0)
      throw std::invalid_argument("a deviation must be of finite numbers not below 0, one for each joint");
}

}  // namespace

PathVerdict check_path(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                       double padding, const std::vector<Configuration>& waypoints, double distance_cap,
                       double seen_within) {
  for (const auto& [part, policy] : policies) {
    const auto is_its = [&part = part](const Body& body) { return body.part == part; };
    if (std::none_of(robot.bodies.begin(), robot.bodies.end(), is_its))
      throw std::invalid_argument("policies name the part " + quote(part) +
                                  ", expected a part of the robot or a load");
  }
  return check_tubes(robot, map, policies, padding, waypoints, {}, distance_cap, seen_within);
}

PathVerdict check_tubes(const Robot& robot, const Snapshot& map,
                        const std::map<std::string, Policy>& policies, double padding,
                        const std::vector<Configuration>& waypoints,
                        const std::vector<Eigen::VectorXd>& deviations, double distance_cap,
                        double seen_within) {
  require_deviations(waypoints, deviations);
  if (!std::isfinite(padding) || padding < 0.0)
    throw std::invalid_argument("padding must be a finite length not below 0, in metres");
  if (!std::isfinite(distance_cap) || distance_cap < 0.0)
    throw std::invalid_argument("distance_cap must be a finite length not below 0, in metres");
  require_seen_within(seen_within, map, policies);
  if (distance_cap == 0.0) distance_cap = 0.2 * robot.scale;
  PathVerdict verdict;
  verdict.first_contact = check::malformed(robot, waypoints, verdict.edge);
  if (!verdict.first_contact.empty()) return verdict;
  verdict.edge = -1;
  try {
    const Robot stated = check::with_stated_loads(robot);
    const check::KdlArm arm(stated);
    check::require_same_poses(robot, arm);
    verdict.first_contact = check::let_go(stated, arm, waypoints, deviations);
    if (!verdict.first_contact.empty()) return verdict;
    return Checker(stated, arm, map, policies, padding, waypoints, distance_cap, seen_within, deviations)
        .run();
  } catch (const check::FileDisagrees& error) {
    verdict.first_contact = error.what();
    return verdict;
  }
}

std::string file_disagreement(const Robot& robot) {
  try {
    check::require_same_poses(robot, check::KdlArm(check::with_stated_loads(robot)));
    return {};
  } catch (const check::FileDisagrees& error) {
    return error.what();
  }
}

}  // namespace clearway
