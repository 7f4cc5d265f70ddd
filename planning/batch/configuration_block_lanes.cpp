#include <algorithm>
#include <bit>
#include <cmath>

#include "mapping/system/highway_targets.hpp"
#include "planning/batch/configuration_block.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/batch/configuration_block_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "planning/batch/lane_frames.hpp"
#include "planning/batch/lane_packs.hpp"
#include "planning/batch/lane_proofs.hpp"
#include "planning/batch/lane_sight.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

using FloatSphere = SphereTree::FloatSphere;

/// One look at a block of configurations.
class BlockLook {
 public:
  BlockLook(const SphereRobot& robot, ConfigurationBlock& block) : robot_(robot), block_(block) {}

  void run() {
    place_frames_and_middles();
    for (std::size_t i = 0; i < robot_.branches.size(); ++i) {
      if (robot_.branches[i].field >= 0) look_at(i);
    }
    for (const SphereRobot::BranchPair& pair : robot_.branch_pairs) look_at(pair);
  }

 private:
  const SphereTree::Node& node(int i) const { return robot_.tree.nodes[static_cast<std::size_t>(i)]; }
  const SphereTree::Leaf& leaf(int i) const { return robot_.tree.leaves[static_cast<std::size_t>(i)]; }
  const FloatSphere& bound(std::size_t branch) const { return node(robot_.branches[branch].root).bound; }

  std::size_t rows() const { return (block_.count + lane_count - 1) / lane_count; }
  LaneFloats* pose(std::size_t row, int frame) const {
    return &block_.pose[12 * (row * robot_.frames.size() + static_cast<std::size_t>(frame))];
  }
  LaneFloats* middle(std::size_t row, std::size_t branch) const {
    return &block_.middle[3 * (row * robot_.branches.size() + branch)];
  }

  void place_frames_and_middles() {
    for (std::size_t row = 0; row < rows(); ++row) {
      LaneFloats* value = &block_.value[row * robot_.frames.size()];
      read_values(robot_, block_.q.data() + row * robot_.joints, value);
      place_frames(robot_, value, pose(row, 0));
      for (std::size_t i = 0; i < robot_.branches.size(); ++i) {
        for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
          const LaneFloats* from = pose(row, robot_.branches[i].frame);
          store_point(clearway::HWY_NAMESPACE::placed(from, bound(i), lane), middle(row, i), lane);
        }
      }
    }
  }

  /// The configurations of that row from that lane on that are asked for and not known to be blocked.
  HWY_INLINE unsigned alive(std::size_t row, std::size_t lane) const {
    const std::size_t first = row * lane_count + lane;
    if (first >= block_.count) return 0;
    const std::uint64_t blocked = block_.blocked[first / 64] >> (first % 64);
    return lanes_in_use(block_.count, first) & ~static_cast<unsigned>(blocked);
  }

  // Bodies against the field.

  void look_at(std::size_t index) {
    const SphereRobot::Branch& branch = robot_.branches[index];
    field_ = &robot_.fields[static_cast<std::size_t>(branch.field)];
    const Vector need = all(needed(bound(index)));
    PackedPoses& open = block_.pack(0);
    open.count = 0;
    for (std::size_t row = 0; row < rows(); ++row) {
      for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
        const unsigned asked = alive(row, lane);
        if (asked == 0) continue;
        const Sight seen = sight(*field_, load_point(middle(row, index), lane));
        const unsigned near = bits(hn::Not(hn::Ge(seen.lower, need))) & asked;  // also what is no number
        if (near != 0) append(pose(row, branch.frame), row, lane, near, open);
      }
    }
    if (open.count > 0) look_into(branch.root, 0);
    settle_doubts();
  }

  float needed(const FloatSphere& sphere) const { return sphere.radius + robot_.padding + robot_.slack; }

  void look_into(int index, std::size_t level) {
    const SphereTree::Node& here = node(index);
    const PackedPoses& asked = block_.pack(level);
    for (int i = here.first; i < here.last; ++i) {
      if (here.holds_leaves) {
        look_at_leaf(i, asked);
      } else if (node(i).holds_leaves && node(i).count() == 1) {
        look_at_leaf(node(i).first, asked);
      } else {
        PackedPoses& open = block_.pack(level + 1);
        find_near(node(i).bound, asked, open);
        if (open.count > 0) look_into(i, level + 1);
      }
    }
  }

  void find_near(const FloatSphere& sphere, const PackedPoses& asked, PackedPoses& open) {
    const Vector need = all(needed(sphere));
    open.count = 0;
    for (std::size_t k = 0; k < asked.count; k += hn::Lanes(Tag())) {
      const Sight seen = sight(*field_, clearway::HWY_NAMESPACE::placed(asked, sphere, k));
      unsigned near = bits(hn::Not(hn::Ge(seen.lower, need))) & lanes_in_use(asked.count, k);
      if (near != 0) near = undecided(near, asked.place + k);
      if (near != 0) append(asked, k, near, open);
    }
  }

  void look_at_leaf(int index, const PackedPoses& asked) {
    const SphereTree::Leaf& of = leaf(index);
    const Vector need = all(needed(of.sphere)), sure = all(sure_clearance(of));
    for (std::size_t k = 0; k < asked.count; k += hn::Lanes(Tag())) {
      const Point point = clearway::HWY_NAMESPACE::placed(asked, of.sphere, k);
      const Sight seen = sight(*field_, point);
      unsigned near = bits(hn::Not(hn::Ge(seen.lower, need))) & lanes_in_use(asked.count, k);
      if (near != 0) near = undecided(near, asked.place + k);
      if (near == 0) continue;
      const unsigned met = bits(hn::Lt(seen.upper, sure)) & near;
      block(met, asked.place + k);
      add_doubts(point, asked.place + k, index, near & ~met);
    }
  }

  /// A blocked cube that is nearer to the sphere's middle surely meets the body; below 0: none does.
  float sure_clearance(const SphereTree::Leaf& of) const {
    return of.inner > 0.0F ? of.inner + robot_.padding - robot_.slack : -1.0F;
  }

  /// Of a sphere that its own cell does not prove clear.
  HWY_INLINE void add_doubts(const Point& point, const std::int32_t* places, int leaf, unsigned lanes) {
    ConfigurationBlock::Doubt& doubts = block_.doubts[0];
    const Mask mask = mask_of(lanes);
    pack(point.x, mask, doubts.x + doubts.count);
    pack(point.y, mask, doubts.y + doubts.count);
    pack(point.z, mask, doubts.z + doubts.count);
    pack(hn::Load(WholeTag(), places), mask, doubts.place + doubts.count);
    hn::StoreU(hn::Set(WholeTag(), leaf), WholeTag(), doubts.leaf + doubts.count);
    doubts.count += static_cast<std::size_t>(std::popcount(lanes));
    if (doubts.count > ConfigurationBlock::Doubt::most - lane_count) settle_doubts();
  }

  /// Looks closer at the spheres that their own cells do not prove clear.
  void settle_doubts() {
    ConfigurationBlock::Doubt& doubts = block_.doubts[0];
    leave_out_blocked(doubts);
    for (std::size_t k = 0; k < doubts.count; k += hn::Lanes(Tag())) {
      const Point point{hn::Load(Tag(), doubts.x + k), hn::Load(Tag(), doubts.y + k),
                        hn::Load(Tag(), doubts.z + k)};
      const Sight seen = close_sight(*field_, point);
      alignas(64) float lower[lane_count], upper[lane_count];
      hn::Store(seen.lower, Tag(), lower);
      hn::Store(seen.upper, Tag(), upper);
      const std::size_t last = std::min(hn::Lanes(Tag()), doubts.count - k);
      for (std::size_t lane = 0; lane < last; ++lane) {
        const SphereTree::Leaf& of = leaf(doubts.leaf[k + lane]);
        const auto place = static_cast<std::size_t>(doubts.place[k + lane]);
        if (lower[lane] >= needed(of.sphere)) continue;
        if (upper[lane] < sure_clearance(of))
          block(place);
        else
          fail(of.member, place);
      }
    }
    doubts.count = 0;
  }

  void leave_out_blocked(ConfigurationBlock::Doubt& doubts) const {
    std::size_t left = 0;
    for (std::size_t k = 0; k < doubts.count; k += hn::Lanes(Tag())) {
      const unsigned open = undecided(lanes_in_use(doubts.count, k), doubts.place + k);
      const Mask mask = mask_of(open);
      for (float* row : {doubts.x, doubts.y, doubts.z}) pack(hn::Load(Tag(), row + k), mask, row + left);
      for (std::int32_t* row : {doubts.place, doubts.leaf})
        pack(hn::Load(WholeTag(), row + k), mask, row + left);
      left += static_cast<std::size_t>(std::popcount(open));
    }
    doubts.count = left;
  }

  void block(std::size_t place) { block_.blocked[place / 64] |= std::uint64_t{1} << (place % 64); }
  void block(unsigned lanes, const std::int32_t* places) {
    for (; lanes != 0; lanes &= lanes - 1U) block(static_cast<std::size_t>(places[std::countr_zero(lanes)]));
  }

  void fail(int member, std::size_t place) {
    ConfigurationBlock::Places& failed = block_.failed[static_cast<std::size_t>(member)];
    if (ConfigurationBlock::holds(failed, place)) return;
    if (failed == ConfigurationBlock::Places{}) block_.members.push_back(member);
    failed[place / 64] |= std::uint64_t{1} << (place % 64);
  }

  // Bodies against bodies.

  void look_at(const SphereRobot::BranchPair& pair) {
    const auto first = static_cast<std::size_t>(pair.a), second = static_cast<std::size_t>(pair.b);
    const SphereRobot::Branch &a = robot_.branches[first], &b = robot_.branches[second];
    const float radii = bound(first).radius + bound(second).radius + robot_.slack;
    PackedPoses& open = block_.pack(0);
    open.count = 0;
    for (std::size_t row = 0; row < rows(); ++row) {
      for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
        const unsigned asked = alive(row, lane);
        if (asked == 0) continue;
        const Point from = load_point(middle(row, first), lane), to = load_point(middle(row, second), lane);
        unsigned near = bits(hn::Not(hn::Gt(gap(from, to), all(radii * radii)))) & asked;
        if (near != 0 && pair.table) near = not_decided(*pair.table, row, lane, near);
        if (near != 0) append_relative(pose(row, a.frame), pose(row, b.frame), row, lane, near, open);
      }
    }
    if (open.count > 0) look_into(a.root, b.root, 0);
  }

  /// Those of the lanes of which the table proves nothing; where it proves an overlap they are blocked.
  unsigned not_decided(const PairTable& table, std::size_t row, std::size_t lane, unsigned lanes) {
    const Proofs found = proofs(table, block_.q.data() + row * robot_.joints, lane, lanes);
    for (unsigned met = found.overlap; met != 0; met &= met - 1U)
      block(row * lane_count + lane + static_cast<std::size_t>(std::countr_zero(met)));
    return lanes & ~found.apart & ~found.overlap;
  }

  /// The square of the distance, rounded down.
  static HWY_INLINE Vector gap(const Point& a, const Point& b) {
    return hn::Mul(squared(minus(a, b)), all(1.0F - 1e-5F));
  }

  void look_into(int first, int second, std::size_t level) {
    const SphereTree::Node &a = node(first), &b = node(second);
    const PackedPoses& asked = block_.pack(level);
    if (a.holds_leaves && b.holds_leaves) return look_at_leaves(a, b, asked);
    const bool is_a_cut = b.holds_leaves || (!a.holds_leaves && a.bound.radius > b.bound.radius);
    const SphereTree::Node& cut = is_a_cut ? a : b;
    PackedPoses& open = block_.pack(level + 1);
    for (int i = cut.first; i < cut.last; ++i) {
      const int next_a = is_a_cut ? i : first, next_b = is_a_cut ? second : i;
      find_near(node(next_a), node(next_b), asked, open);
      if (open.count > 0) look_into(next_a, next_b, level + 1);
    }
  }

  static HWY_INLINE Point at(const FloatSphere& sphere) {
    return {all(sphere.x), all(sphere.y), all(sphere.z)};
  }

  void find_near(const SphereTree::Node& a, const SphereTree::Node& b, const PackedPoses& asked,
                 PackedPoses& open) {
    const float radii = a.bound.radius + b.bound.radius + robot_.slack;
    const SphereTree::Leaf &core_a = leaf(a.core), &core_b = leaf(b.core);
    const float sure =
        robot_.member_of_pair(core_a.body, core_b.body) < 0 ? 0.0F : inner_reach(core_a, core_b);
    const int member = a.body < 0 || b.body < 0 ? -1 : robot_.member_of_pair(a.body, b.body);
    open.count = 0;
    for (std::size_t k = 0; k < asked.count; k += hn::Lanes(Tag())) {
      const Vector between = gap(at(a.bound), clearway::HWY_NAMESPACE::placed(asked, b.bound, k));
      unsigned near = bits(hn::Not(hn::Gt(between, all(radii * radii)))) & lanes_in_use(asked.count, k);
      if (near != 0 && sure > 0.0F) {
        const Point point = clearway::HWY_NAMESPACE::placed(asked, core_b.sphere, k);
        block(bits(is_within(sure, gap(at(core_a.sphere), point))) & near, asked.place + k);
      }
      near = undecided(near, asked.place + k, member);
      if (near != 0) append(asked, k, near, open);
    }
  }

  /// Spheres inside the leaves' bodies surely overlap when their middles are nearer than this; 0: not known.
  float inner_reach(const SphereTree::Leaf& a, const SphereTree::Leaf& b) const {
    return std::min(a.inner, b.inner) > 0.0F ? std::max(a.inner + b.inner - robot_.slack, 0.0F) : 0.0F;
  }
  static HWY_INLINE Mask is_within(float reach, Vector between) {
    return hn::Lt(between, all((1.0F - 3e-5F) * reach * reach));
  }

  /// Of the lanes those that are not known to be blocked, nor to fail the member.
  unsigned undecided(unsigned lanes, const std::int32_t* places, int member = -1) const {
    unsigned left = lanes;
    for (; lanes != 0; lanes &= lanes - 1U) {
      const auto place = static_cast<std::size_t>(places[std::countr_zero(lanes)]);
      if (ConfigurationBlock::holds(block_.blocked, place) ||
          (member >= 0 && ConfigurationBlock::holds(block_.failed[static_cast<std::size_t>(member)], place)))
        left &= ~(lanes & (0U - lanes));
    }
    return left;
  }

  void look_at_leaves(const SphereTree::Node& a, const SphereTree::Node& b, const PackedPoses& asked) {
    for (int second = b.first; second < b.last; ++second) {
      for (std::size_t k = 0; k < asked.count; k += hn::Lanes(Tag())) {
        const Point point = clearway::HWY_NAMESPACE::placed(asked, leaf(second).sphere, k);
        const unsigned lanes = lanes_in_use(asked.count, k);
        for (int first = a.first; first < a.last; ++first)
          look_at_two(leaf(first), leaf(second), point, lanes, asked.place + k);
      }
    }
  }

  HWY_INLINE void look_at_two(const SphereTree::Leaf& a, const SphereTree::Leaf& b, const Point& point,
                              unsigned lanes, const std::int32_t* places) {
    const int member = robot_.member_of_pair(a.body, b.body);
    if (member < 0) return;
    const float radii = a.sphere.radius + b.sphere.radius + robot_.slack;
    const Vector between = gap(at(a.sphere), point);
    unsigned near = bits(hn::Not(hn::Gt(between, all(radii * radii)))) & lanes;
    if (near == 0) return;
    const float sure = inner_reach(a, b);
    const unsigned met = sure > 0.0F ? bits(is_within(sure, between)) : 0U;
    for (; near != 0; near &= near - 1U) {
      const auto lane = static_cast<unsigned>(std::countr_zero(near));
      const auto place = static_cast<std::size_t>(places[lane]);
      if ((met >> lane & 1U) != 0)
        block(place);
      else
        fail(member, place);
    }
  }

  const SphereRobot& robot_;
  ConfigurationBlock& block_;
  const SphereRobot::Field* field_ = nullptr;
};

void look_at_block(const SphereRobot& robot, ConfigurationBlock& block) { BlockLook(robot, block).run(); }

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {
namespace {

void look_with(const SphereRobot& robot, ConfigurationBlock& block, [[maybe_unused]] InstructionSet vectors) {
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::look_at_block(robot, block);
  if (vectors == InstructionSet::avx2) return N_AVX2::look_at_block(robot, block);
#endif
  HWY_STATIC_DISPATCH(look_at_block)(robot, block);
}

}  // namespace

void look(const SphereRobot& robot, ConfigurationBlock& block) {
  static const InstructionSet widest = best_instruction_set();
  look(robot, block, widest);
}

void look(const SphereRobot& robot, ConfigurationBlock& block, InstructionSet vectors) {
  block.forget();
  look_with(robot, block, vectors);
  block.leave_out_blocked();
}

}  // namespace clearway
#endif  // HWY_ONCE
