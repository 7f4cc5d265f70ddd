#include "datasets/ros/transform_tree.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

namespace clearway {

void TransformTree::add(const RosTransform& transform, bool is_fixed, double recorded) {
  const double length = transform.rotation.norm();
  const bool is_sound = std::abs(length - 1.0) <= 0.01 && transform.translation.allFinite() &&
                        std::isfinite(transform.header.time);
  if (!is_sound || transform.child == transform.header.frame) {
    ++left_out_;
    return;
  }
  std::vector<Edge>& edges = edges_[transform.child];
  auto edge = std::find_if(edges.begin(), edges.end(),
                           [&](const Edge& known) { return known.parent == transform.header.frame; });
  if (edge == edges.end()) edge = edges.insert(edge, {transform.header.frame, is_fixed, {}});
  ++edge->transforms;
  const Pose pose{transform.translation, transform.rotation.normalized()};
  const double time = edge->is_fixed ? recorded : transform.header.time;
  const auto [known, is_new_time] = edge->poses.try_emplace(time, pose);
  if (is_new_time) return;
  const double distance = (known->second.translation - pose.translation).norm();
  constexpr double least = 1e-3;  // m, rad
  if (distance > least || known->second.rotation.angularDistance(pose.rotation) > least) {
    ++edge->contradicted;
    edge->farthest = std::max(edge->farthest, distance);
  }
  known->second = pose;
}

const TransformTree::Edge* TransformTree::edge_of(const std::string& frame) const {
  const auto found = edges_.find(frame);
  return found == edges_.end() ? nullptr : &found->second.front();
}

bool TransformTree::leads_to(const Edge& edge, const std::string& frame, const std::string& root) const {
  std::set<std::string> seen{frame, edge.parent};
  for (std::vector<std::string> next{edge.parent}; !next.empty();) {
    const std::string at = next.back();
    next.pop_back();
    if (at == root) return true;
    if (const auto found = edges_.find(at); found != edges_.end())
      for (const Edge& above : found->second)
        if (seen.insert(above.parent).second) next.push_back(above.parent);
  }
  return false;
}

void TransformTree::prefer_ways_to(const std::string& root) {
  for (auto& [frame, edges] : edges_)
    if (frame != root)
      std::stable_partition(edges.begin(), edges.end(),
                            [&, &name = frame](const Edge& edge) { return leads_to(edge, name, root); });
}

std::vector<FrameParent> TransformTree::parents_of(const std::string& frame, const std::string& root) const {
  std::vector<FrameParent> parents;
  if (const auto found = edges_.find(frame); found != edges_.end())
    for (const Edge& edge : found->second)
      parents.push_back({edge.parent, edge.transforms, frame != root && leads_to(edge, frame, root)});
  return parents;
}

bool TransformTree::are_joined(const std::string& root, const std::string& frame) const {
  const std::vector<std::string> of_frame = chain_of(frame), of_root = chain_of(root);
  return std::find_first_of(of_frame.begin(), of_frame.end(), of_root.begin(), of_root.end()) !=
         of_frame.end();
}

std::set<std::string> TransformTree::way_between(const std::string& root, const std::string& frame) const {
  const std::vector<std::string> of_frame = chain_of(frame), of_root = chain_of(root);
  std::set<std::string> frames;
  const auto add = [&](const std::vector<std::string>& chain, const std::vector<std::string>& other) {
    for (const std::string& link : chain) {
      if (std::find(other.begin(), other.end(), link) != other.end()) return;
      frames.insert(link);
    }
  };
  add(of_frame, of_root);
  add(of_root, of_frame);
  return frames;
}

PoseConflicts TransformTree::conflicts_of(const std::string& frame) const {
  const Edge* const found = edge_of(frame);
  if (found == nullptr || found->is_fixed) return {};
  const Edge& edge = *found;
  PoseConflicts conflicts{edge.poses.size() + edge.contradicted, edge.contradicted, 0, edge.farthest};
  if (edge.poses.size() < 3) return conflicts;
  for (auto before = edge.poses.begin(), pose = std::next(before), after = std::next(pose);
       after != edge.poses.end(); ++before, ++pose, ++after) {
    if (after->first - before->first > max_gap) continue;
    const double part = (pose->first - before->first) / (after->first - before->first);
    const Eigen::Vector3d way = after->second.translation - before->second.translation;
    const double off = (pose->second.translation - before->second.translation - part * way).norm();
    constexpr double least_off = 0.05;  // m
    if (off < least_off || off < 4.0 * way.norm()) continue;
    ++conflicts.alternating;
    conflicts.farthest = std::max(conflicts.farthest, off);
  }
  return conflicts;
}

bool TransformTree::is_jump(const Poses& poses, Poses::const_iterator after) {
  using Motion = Eigen::Matrix<double, 6, 1>;  // m and rad
  const auto motion = [](const Pose& from, const Pose& to) {
    const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
    const double angle = turn.angle() > M_PI ? turn.angle() - 2.0 * M_PI : turn.angle();
    return Motion((Motion() << to.translation - from.translation, angle * turn.axis()).finished());
  };
  const auto speed = [&](Poses::const_iterator first, Poses::const_iterator second) -> std::optional<Motion> {
    const double gap = second->first - first->first;
    if (gap > max_gap) return std::nullopt;
    return motion(first->second, second->second) / gap;
  };
  const auto before = std::prev(after);
  std::optional<Motion> earlier, later;
  if (before != poses.begin()) earlier = speed(std::prev(before), before);
  if (std::next(after) != poses.end()) later = speed(after, std::next(after));
  if (!earlier && !later) return false;
  const double gap = after->first - before->first;
  const Motion step = motion(before->second, after->second);
  const Motion first = gap * (earlier ? *earlier : *later), last = gap * (later ? *later : *earlier);
  const auto off = [](const Eigen::Vector3d& made, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d way = to - from;  // speeds in between are driven, too
    const double part = way.isZero() ? 0.0 : std::clamp((made - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
    return (made - from - part * way).norm();
  };
  const auto is_beyond = [&](double distance, double acceleration) {
    constexpr double least = 0.1;  // m, rad
    const double needed = (earlier && later ? 4.0 : 1.0) * distance / (gap * gap);
    return distance > least && needed > acceleration;
  };
  return is_beyond(off(step.head<3>(), first.head<3>(), last.head<3>()), 10.0) ||
         is_beyond(off(step.tail<3>(), first.tail<3>(), last.tail<3>()), 40.0);
}

std::optional<PoseJump> TransformTree::jump_between(const std::string& root, const std::string& frame,
                                                    double time) const {
  for (const std::string& link : way_between(root, frame)) {
    const Edge* const edge = edge_of(link);
    if (edge == nullptr || edge->is_fixed) continue;
    const auto after = edge->poses.lower_bound(time);
    if (after == edge->poses.end() || after == edge->poses.begin() || after->first == time) continue;
    const auto before = std::prev(after);
    if (is_jump(edge->poses, after))
      return PoseJump{link,
                      edge->parent,
                      before->first,
                      after->first,
                      (after->second.translation - before->second.translation).norm(),
                      before->second.rotation.angularDistance(after->second.rotation)};
  }
  return std::nullopt;
}

std::optional<std::pair<double, double>> TransformTree::times_between(const std::string& root,
                                                                      const std::string& frame) const {
  std::optional<std::pair<double, double>> times;
  if (!are_joined(root, frame)) return times;
  for (const std::string& link : way_between(root, frame)) {
    const Edge* const edge = edge_of(link);
    if (edge == nullptr || edge->is_fixed || edge->poses.empty()) continue;
    const double first = edge->poses.begin()->first, last = edge->poses.rbegin()->first;
    if (!times) times = {first, last};
    times = {std::max(times->first, first), std::min(times->second, last)};
  }
  return times;
}

std::optional<Eigen::Isometry3d> TransformTree::pose_at(const Edge& edge, double time, double recorded) {
  const auto isometry = [](const Pose& pose) {
    return Eigen::Isometry3d(Eigen::Translation3d(pose.translation) * pose.rotation);
  };
  if (edge.is_fixed) {
    const auto later = edge.poses.upper_bound(recorded);
    return isometry((later == edge.poses.begin() ? later : std::prev(later))->second);
  }
  const auto after = edge.poses.lower_bound(time);
  if (after == edge.poses.end()) return std::nullopt;
  if (after->first == time) return isometry(after->second);
  if (after == edge.poses.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const double gap = after->first - before->first;
  if (gap > max_gap || is_jump(edge.poses, after)) return std::nullopt;
  const double part = (time - before->first) / gap;
  return isometry({(1.0 - part) * before->second.translation + part * after->second.translation,
                   before->second.rotation.slerp(part, after->second.rotation)});
}

std::vector<std::string> TransformTree::chain_of(const std::string& frame) const {
  std::vector<std::string> chain{frame};
  for (const Edge* edge = edge_of(frame); edge != nullptr && chain.size() <= edges_.size();
       edge = edge_of(chain.back()))
    chain.push_back(edge->parent);
  return chain;
}

std::vector<std::string> TransformTree::loop_above(const std::string& frame) const {
  std::vector<std::string> chain{frame};
  for (const Edge* edge = edge_of(frame); edge != nullptr; edge = edge_of(chain.back())) {
    const auto first = std::find(chain.begin(), chain.end(), edge->parent) - chain.begin();
    const bool is_loop = first < static_cast<std::ptrdiff_t>(chain.size());
    chain.push_back(edge->parent);
    if (is_loop) return {chain.begin() + first, chain.end()};
  }
  return {};
}

std::optional<Eigen::Isometry3d> TransformTree::root_from_frame(const std::string& root,
                                                                const std::string& frame, double time,
                                                                double recorded) const {
  const std::vector<std::string> of_frame = chain_of(frame), of_root = chain_of(root);
  const auto common = std::find_first_of(of_frame.begin(), of_frame.end(), of_root.begin(), of_root.end());
  if (common == of_frame.end()) return std::nullopt;
  const auto common_from = [&](const std::vector<std::string>& chain) -> std::optional<Eigen::Isometry3d> {
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    for (const std::string& link : chain) {
      if (link == *common) return result;
      const auto pose = pose_at(*edge_of(link), time, recorded);
      if (!pose) return std::nullopt;
      result = *pose * result;
    }
    return result;
  };
  const auto from_root = common_from(of_root), from_frame = common_from(of_frame);
  if (!from_root || !from_frame) return std::nullopt;
  return from_root->inverse() * *from_frame;
}

double TransformTree::way_of(const std::string& frame) const {
  const Edge* const found = edge_of(frame);
  if (found == nullptr || found->is_fixed) return 0.0;
  Eigen::AlignedBox3d box;
  for (const auto& [time, pose] : found->poses) box.extend(pose.translation);
  return box.diagonal().norm();
}

double TransformTree::turn_of(const std::string& frame) const {
  const Edge* const found = edge_of(frame);
  if (found == nullptr || found->is_fixed) return 0.0;
  double largest = 0.0;
  for (const auto& [time, pose] : found->poses)
    largest = std::max(largest, pose.rotation.angularDistance(found->poses.begin()->second.rotation));
  return largest;
}

double TransformTree::longest_step_of(const std::string& frame) const {
  const Edge* const edge = edge_of(frame);
  if (edge == nullptr || edge->is_fixed) return 0.0;
  double longest = 0.0;
  for (auto pose = edge->poses.begin(); pose != edge->poses.end(); ++pose)
    if (const auto next = std::next(pose); next != edge->poses.end())
      longest = std::max(longest, (next->second.translation - pose->second.translation).norm());
  return longest;
}

std::size_t TransformTree::changes_of(const std::string& frame) const {
  const Edge* const found = edge_of(frame);
  if (found == nullptr || !found->is_fixed) return 0;
  const auto differ = [](const auto& before, const auto& after) {
    constexpr double least = 1e-9;  // m, and of the quaternion
    const Pose &a = before.second, &b = after.second;
    return (a.translation - b.translation).norm() > least ||
           std::min((a.rotation.coeffs() - b.rotation.coeffs()).norm(),
                    (a.rotation.coeffs() + b.rotation.coeffs()).norm()) > least;
  };
  std::size_t changes = 0;
  const auto& poses = found->poses;
  for (auto pose = poses.begin(); std::next(pose) != poses.end(); ++pose)
    changes += differ(*pose, *std::next(pose)) ? 1 : 0;
  return changes;
}

std::vector<BagFrame> TransformTree::edges() const {
  std::vector<BagFrame> frames;
  for (const auto& [child, edges] : edges_)
    for (const Edge& edge : edges) frames.push_back({child, edge.parent, edge.is_fixed});
  return frames;
}

std::vector<std::string> TransformTree::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edges] : edges_)
    for (const Edge& edge : edges) names.insert({child, edge.parent});
  return {names.begin(), names.end()};
}

}  // namespace clearway
