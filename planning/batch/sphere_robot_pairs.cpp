#include "planning/batch/sphere_robot_pairs.hpp"

#include <algorithm>

namespace clearway {
namespace {

class PairLists {
 public:
  PairLists(SphereRobot& out, const SphereGround& ground, std::span<const BodyPair> pairs)
      : out_(out), ground_(ground), pairs_(pairs) {}

  /// The pairs of bodies by the frames that they are in.
  void pair_up() {
    struct FramePair {
      SphereRobot::Pair pair;
      int a, b;
    };
    std::vector<FramePair> all;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      SphereRobot::Pair pair{pairs_[i].first, pairs_[i].second,
                             static_cast<int>(ground_.field_of.size() + i)};
      const auto frame = [&](int body) {
        return out_.frame_of[first_sphere(static_cast<std::size_t>(body))];
      };
      if (frame(pair.a) < frame(pair.b)) std::swap(pair.a, pair.b);
      all.push_back({pair, frame(pair.a), frame(pair.b)});
    }
    std::stable_sort(all.begin(), all.end(), [](const FramePair& x, const FramePair& y) {
      return std::pair(x.a, x.b) < std::pair(y.a, y.b);
    });
    for (const FramePair& entry : all) {
      const int index = static_cast<int>(out_.body_pairs.size());
      if (out_.frame_pairs.empty() || out_.frame_pairs.back().a != entry.a ||
          out_.frame_pairs.back().b != entry.b)
        out_.frame_pairs.push_back({entry.a, entry.b, meeting(entry.a, entry.b), index, index, nullptr});
      ++out_.frame_pairs.back().last;
      out_.body_pairs.push_back(entry.pair);
    }
  }

  /// The spheres in trees: one for each frame and field, the last frames first.
  void grow_trees() {
    std::vector<int> body_of(out_.clusters.size());
    for (std::size_t body = 0; body < out_.bodies.size(); ++body) {
      for (int i = out_.bodies[body].first; i < out_.bodies[body].last; ++i)
        body_of[static_cast<std::size_t>(i)] = static_cast<int>(body);
    }
    std::vector<std::vector<SphereTree::Leaf>> leaves;  // of each branch
    for (std::size_t i = out_.clusters.size(); i-- > 0;) {
      const SphereRobot::Cluster& cluster = out_.clusters[i];
      for (int k = cluster.first; k < cluster.last; ++k) {
        const auto sphere = static_cast<std::size_t>(k);
        const std::size_t branch = branch_of(sphere);
        if (branch == leaves.size()) leaves.emplace_back();
        leaves[branch].push_back({out_.spheres[sphere], out_.inner[sphere], body_of[i], out_.member[sphere]});
      }
    }
    for (std::size_t i = 0; i < leaves.size(); ++i) out_.branches[i].root = out_.tree.add(leaves[i]);
    pair_branches();
  }

 private:
  /// The first sphere that covers the body.
  std::size_t first_sphere(std::size_t body) const {
    const auto cluster = static_cast<std::size_t>(out_.bodies[body].first);
    return static_cast<std::size_t>(out_.clusters[cluster].first);
  }

  /// The last frame that moves both.
  int meeting(int a, int b) const {
    while (a != b) {  // parents come first
      int& later = a > b ? a : b;
      later = out_.frames[static_cast<std::size_t>(later)].parent;
    }
    return a;
  }

  /// Of each two branches that hold bodies of a pair, and which pair two bodies are.
  void pair_branches() {
    const std::size_t count = out_.bodies.size();
    out_.pair_member.assign(count * count, -1);
    std::vector<std::size_t> branches(count);
    for (std::size_t i = 0; i < count; ++i) branches[i] = branch_of(first_sphere(i));
    std::vector<std::vector<BodyPair>> bodies;  // of each pair of branches
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto a = static_cast<std::size_t>(pairs_[i].first),
                 b = static_cast<std::size_t>(pairs_[i].second);
      out_.pair_member[a * count + b] = out_.pair_member[b * count + a] =
          static_cast<int>(ground_.field_of.size() + i);
      const int first = static_cast<int>(std::max(branches[a], branches[b]));
      const int second = static_cast<int>(std::min(branches[a], branches[b]));
      std::size_t known = 0;
      while (known < bodies.size() &&
             (out_.branch_pairs[known].a != first || out_.branch_pairs[known].b != second))
        ++known;
      if (known == bodies.size()) {
        bodies.emplace_back();
        out_.branch_pairs.push_back({first, second, nullptr});
      }
      bodies[known].push_back(pairs_[i]);
    }
    for (std::size_t i = 0; i < bodies.size(); ++i)
      out_.branch_pairs[i].table = PairTable::of(*out_.robot, std::move(bodies[i]));
    share_tables();
  }

  /// Two frames that are one branch each have the table of these.
  void share_tables() {
    const auto branches_at = [&](int frame) {
      return std::count_if(out_.branches.begin(), out_.branches.end(),
                           [&](const SphereRobot::Branch& branch) { return branch.frame == frame; });
    };
    for (const SphereRobot::BranchPair& pair : out_.branch_pairs) {
      const int a = out_.branches[static_cast<std::size_t>(pair.a)].frame;
      const int b = out_.branches[static_cast<std::size_t>(pair.b)].frame;
      if (branches_at(a) != 1 || branches_at(b) != 1) continue;
      for (SphereRobot::FramePair& frames : out_.frame_pairs) {
        if (std::minmax({frames.a, frames.b}) == std::minmax({a, b})) frames.table = pair.table;
      }
    }
  }

  std::size_t branch_of(std::size_t sphere) {
    const int frame = out_.frame_of[sphere], member = out_.member[sphere];
    const int field = member < 0 ? -1 : ground_.field_of[static_cast<std::size_t>(member)];
    std::size_t i = 0;
    while (i < out_.branches.size() && (out_.branches[i].frame != frame || out_.branches[i].field != field))
      ++i;
    if (i == out_.branches.size()) out_.branches.push_back({frame, field, 0});
    return i;
  }

  SphereRobot& out_;
  const SphereGround& ground_;
  std::span<const BodyPair> pairs_;
};

}  // namespace

void pair_spheres(SphereRobot& robot, const SphereGround& ground, std::span<const BodyPair> pairs) {
  PairLists lists(robot, ground, pairs);
  lists.pair_up();
  lists.grow_trees();
}

}  // namespace clearway
