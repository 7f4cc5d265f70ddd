#include "planning/batch/piece_lanes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "mapping/field/byte_field.hpp"

#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/batch/piece_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "planning/batch/lane_frames.hpp"
#include "planning/batch/lane_sight.hpp"
#include "planning/batch/lane_spots.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

using Floats = LaneFloats;
using Lanes = LaneBits;
using FloatSphere = SphereRobot::FloatSphere;

/// One look at pieces.
template <bool moving>
class Look {
 public:
  Look(const SphereRobot& robot, PieceLanes& lanes) : robot_(robot), lanes_(lanes) {}

  void run() {
    if (!lanes_.are_frames_placed) {
      read_values(robot_, lanes_.q.data(), lanes_.value.data(), used_);
      place_frames(robot_, lanes_.value.data(), lanes_.pose.data(), used_);
    }
    if (moving) {
      read_motions(robot_, lanes_.step.data(), lanes_.motion.data(), used_);
      move_frames(robot_, lanes_.motion.data(), lanes_.pose.data(), lanes_.twist.data(), used_);
    }
    std::fill(lanes_.is_placed.begin(), lanes_.is_placed.end(), Lanes{0});
    for (const SphereRobot::Group& group : robot_.groups) {
      look_at(group);
      if (is_enough()) return;
    }
    place_middles();
    for (std::size_t pair = 0; pair < robot_.frame_pairs.size(); ++pair) {
      look_at_pair(pair);
      if (lanes_.all_or_nothing && is_enough()) return;
    }
  }

 private:
  static constexpr float rounded_up = 1.0F + 1e-5F;  ///< of speeds: a few roundings

  bool is_enough() const {
    const unsigned found = lanes_.all_or_nothing ? lanes_.blocked | lanes_.stuck : lanes_.blocked;
    return (found & lanes_.enough) != 0;
  }

  HWY_INLINE Point placed(int frame, const FloatSphere& sphere, std::size_t lane) const {
    return clearway::HWY_NAMESPACE::placed(&lanes_.pose[12 * static_cast<std::size_t>(frame)], sphere, lane);
  }

  /// The velocity of what is at `point` and moves with the frame.
  HWY_INLINE Point velocity(int frame, const Point& point, std::size_t lane) const {
    const Floats* twist = &lanes_.twist[6 * static_cast<std::size_t>(frame)];
    return plus(load_point(twist + 3, lane), cross(load_point(twist, lane), point));
  }

  /// How far from what blocks it a sphere's middle has to be in the middle of the piece.
  HWY_INLINE Vector needed(int frame, const FloatSphere& sphere, const Point& point, std::size_t lane) const {
    const Vector need = all(reach_of(sphere));
    if (!moving) return need;
    const Vector speed = hn::Sqrt(squared(velocity(frame, point, lane)));
    return hn::Add(need, hn::Add(hn::Mul(speed, all(rounded_up)),
                                 load(lanes_.bend[static_cast<std::size_t>(frame)], lane)));
  }
  float reach_of(const FloatSphere& sphere) const { return sphere.radius + robot_.padding + robot_.slack; }

  /// Of the lanes, those in which a sphere is not proved clear.
  Lanes near(const SphereRobot::Group& group, const FloatSphere& sphere, Lanes asked) const {
    const SphereRobot::Field& field = robot_.fields[static_cast<std::size_t>(group.field)];
    unsigned open = 0;
    for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
      if ((asked >> lane & all_bits) == 0) continue;
      const Point point = placed(group.frame, sphere, lane);
      const Vector need = needed(group.frame, sphere, point, lane);
      open |= not_proved(sight(field, point), need) << lane;
    }
    return static_cast<Lanes>(open & asked);
  }
  static HWY_INLINE unsigned not_proved(const Sight& seen, Vector need) {
    return bits(hn::Not(hn::Ge(seen.lower, need)));  // also what is no number
  }

  void look_at(const SphereRobot::Group& group) {
    field_ = &robot_.fields[static_cast<std::size_t>(group.field)];
    const Lanes here = near(group, group.bound, lanes_.active);
    if (here == 0) return;
    for (int i = group.first; i < group.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      const auto member = static_cast<std::size_t>(robot_.member[static_cast<std::size_t>(cluster.first)]);
      Lanes asked = here & lanes_.wanted[member];
      if (asked != 0 && cluster.last - cluster.first > 1) asked = near(group, cluster.bound, asked);
      if (asked == 0) continue;
      for (int sphere = cluster.first; sphere < cluster.last; ++sphere) {
        ask_for_sphere(group.frame, sphere, asked);
        if (is_enough()) return;
      }
    }
    look_at_asked(asked_.count);
    look_at_doubts(doubts_.count);
  }

  void ask_for_sphere(int frame, int index, Lanes asked) {
    const auto i = static_cast<std::size_t>(index);
    for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
      const unsigned here = asked >> lane & all_bits;
      if (here == 0) continue;
      const Point point = placed(frame, robot_.spheres[i], lane);
      store_point(point, &lanes_.place[3 * i], lane);
      lanes_.is_placed[i] |= static_cast<Lanes>(1U << (lane / hn::Lanes(Tag())));
      asked_.add(point, needed(frame, robot_.spheres[i], point, lane), here, lane, index);
    }
    if (asked_.count >= lane_count) look_at_asked(lane_count);
  }

  /// At the last ones; those that their own cells do not prove clear are doubts.
  void look_at_asked(std::size_t last) {
    const std::size_t first = asked_.count - last;
    for (std::size_t k = first; k < asked_.count; k += hn::Lanes(Tag())) {
      const unsigned near =
          not_proved(sight(*field_, asked_.point(k)), asked_.needed(k)) & lanes_in_use(asked_.count, k);
      if (near != 0) doubts_.add(asked_, k, near);
    }
    asked_.count = first;
    if (doubts_.count >= lane_count) look_at_doubts(lane_count);
  }

  /// Closer, at the last ones.
  void look_at_doubts(std::size_t last) {
    const std::size_t first = doubts_.count - last;
    for (std::size_t k = first; k < doubts_.count; k += hn::Lanes(Tag())) {
      const Sight seen = close_sight(*field_, doubts_.point(k));
      const unsigned near = not_proved(seen, doubts_.needed(k)) & lanes_in_use(doubts_.count, k);
      alignas(64) float lower[lane_count], upper[lane_count];
      hn::Store(seen.lower, Tag(), lower);
      hn::Store(seen.upper, Tag(), upper);
      for (unsigned left = near; left != 0; left &= left - 1U) {
        const auto i = static_cast<std::size_t>(std::countr_zero(left));
        fail(doubts_.sphere[k + i], static_cast<std::size_t>(doubts_.lane[k + i]), lower[i], upper[i]);
      }
    }
    doubts_.count = first;
  }

  /// @param lower, upper what is known of the distance to what blocks the sphere
  void fail(int sphere, std::size_t lane, float lower, float upper) {
    const auto i = static_cast<std::size_t>(sphere);
    const auto resolution = static_cast<float>(field_->bytes->resolution);
    const float inner = robot_.inner[i];
    Finding finding{.open = 1};
    finding.stuck = lower < reach_of(robot_.spheres[i]) + 0.1F * resolution ? 1U : 0U;
    if (inner > 0.0F) finding.blocked = upper < inner + robot_.padding - robot_.slack ? 1U : 0U;
    fail(static_cast<std::size_t>(robot_.member[i]), finding, 1U, lane);
  }

  /// Of the lanes of a register.
  struct Finding {
    unsigned open = 0, blocked = 0, stuck = 0;
  };
  void fail(std::size_t member, const Finding& finding, unsigned here, std::size_t lane) {
    const unsigned open = finding.open & here;
    if (open == 0) return;
    lanes_.blocked |= static_cast<Lanes>((finding.blocked & here) << lane);
    lanes_.stuck |= static_cast<Lanes>((finding.stuck & open) << lane);
    if (lanes_.failed[member] == 0) lanes_.members.push_back(static_cast<int>(member));
    lanes_.failed[member] |= static_cast<Lanes>(open << lane);
  }

  void place_middles() {
    for (std::size_t i = 0; i < robot_.frames.size(); ++i) {
      if (robot_.bounds[i].radius < 0.0F) continue;
      for (std::size_t lane = 0; lane < used_; lane += hn::Lanes(Tag()))
        store_point(placed(static_cast<int>(i), robot_.bounds[i], lane), &lanes_.middle[3 * i], lane);
    }
  }

  HWY_INLINE Point sphere_at(int index, std::size_t lane) const {
    const auto i = static_cast<std::size_t>(index);
    const auto bit = static_cast<Lanes>(1U << (lane / hn::Lanes(Tag())));
    if ((lanes_.is_placed[i] & bit) == 0) {
      store_point(placed(robot_.frame_of[i], robot_.spheres[i], lane), &lanes_.place[3 * i], lane);
      lanes_.is_placed[i] |= bit;
    }
    return load_point(&lanes_.place[3 * i], lane);
  }

  /// The speed of a point of one of the frames, seen from another one.
  HWY_INLINE Vector speed(int frame, int seen_from, const Point& point, std::size_t lane) const {
    const Floats* own = &lanes_.twist[6 * static_cast<std::size_t>(frame)];
    const Floats* other = &lanes_.twist[6 * static_cast<std::size_t>(seen_from)];
    const Point turn = minus(load_point(own, lane), load_point(other, lane));
    const Point velocity = minus(load_point(own + 3, lane), load_point(other + 3, lane));
    return hn::Sqrt(squared(plus(velocity, cross(turn, point))));
  }

  HWY_INLINE Finding look_at_two(const SphereRobot::FramePair& pair, const Point& a, const Point& b,
                                 float radii, float inner, Vector most, Vector bend, std::size_t lane) const {
    Finding finding;
    const Vector gap = hn::Mul(squared(minus(a, b)), all(1.0F - 1e-5F));
    Vector need = hn::Add(most, all(radii));
    finding.open = bits(hn::Not(hn::Gt(gap, hn::Mul(need, need))));
    if (!moving || finding.open == 0) return finding_at(finding, gap, radii, inner);
    Vector sum = speed(pair.a, pair.meet, a, lane);
    if (pair.meet != pair.b) sum = hn::Add(sum, speed(pair.b, pair.meet, b, lane));
    need = hn::Add(hn::Add(hn::Mul(sum, all(rounded_up)), bend), all(radii + robot_.slack));
    finding.open = bits(hn::Not(hn::Gt(gap, hn::Mul(need, need))));
    return finding_at(finding, gap, radii, inner);
  }
  HWY_INLINE Finding finding_at(Finding finding, Vector gap, float radii, float inner) const {
    if (finding.open == 0) return finding;
    const float least = radii + 3.0F * robot_.slack, sure = inner - robot_.slack;
    finding.stuck = bits(hn::Le(gap, all(1.05F * least * least)));
    if (sure > 0.0F) finding.blocked = bits(hn::Lt(gap, all((1.0F - 3e-5F) * sure * sure)));
    return finding;
  }

  void look_at_pair(std::size_t index) {
    const SphereRobot::FramePair& pair = robot_.frame_pairs[index];
    const float radii = robot_.bounds[static_cast<std::size_t>(pair.a)].radius +
                        robot_.bounds[static_cast<std::size_t>(pair.b)].radius;
    Lanes asked = 0;
    for (int i = pair.first; i < pair.last; ++i) asked |= wanted(i);
    asked &= lanes_.active;
    for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
      unsigned here = asked >> lane & all_bits;
      if (here == 0) continue;
      const Vector slack = all(robot_.slack);
      const Vector most = moving ? hn::Add(load(lanes_.approach[index], lane), slack) : slack;
      const Vector bend = moving ? load(lanes_.pair_bend[index], lane) : hn::Zero(Tag());
      const Point a = load_point(&lanes_.middle[3 * static_cast<std::size_t>(pair.a)], lane);
      const Point b = load_point(&lanes_.middle[3 * static_cast<std::size_t>(pair.b)], lane);
      here &= look_at_two(pair, a, b, radii, 0.0F, most, bend, lane).open;
      if (pair.table) here = not_apart(*pair.table, here, lane);
      for (int i = pair.first; i < pair.last && here != 0; ++i)
        look_at_bodies(pair, robot_.body_pairs[static_cast<std::size_t>(i)], here, most, bend, lane);
    }
  }

  /// Of the lanes, those in which the table does not know the bodies to be apart.
  unsigned not_apart(const PairTable& table, unsigned lanes, std::size_t lane) const {
    const auto first = static_cast<std::size_t>(table.joints()[0]);
    const auto second = table.joints()[1] < 0 ? first : static_cast<std::size_t>(table.joints()[1]);
    unsigned open = 0;
    for (; lanes != 0; lanes &= lanes - 1U) {
      const auto at = static_cast<std::size_t>(std::countr_zero(lanes));
      std::array<double, 2> lower{}, upper{};
      for (const std::size_t i : {0, 1}) {
        const std::size_t joint = i == 0 ? first : second;
        const double middle = lanes_.q[joint].at[lane + at];
        const double way = moving ? std::abs(lanes_.step[joint].at[lane + at]) * (1.0 + 1e-9) : 0.0;
        lower[i] = middle - way;
        upper[i] = middle + way;
      }
      if (!table.is_apart(lower, upper)) open |= 1U << at;
    }
    return open;
  }

  Lanes wanted(int pair) const {
    return lanes_.wanted[static_cast<std::size_t>(robot_.body_pairs[static_cast<std::size_t>(pair)].member)];
  }

  void look_at_bodies(const SphereRobot::FramePair& frames, const SphereRobot::Pair& pair, unsigned here,
                      Vector most, Vector bend, std::size_t lane) {
    const auto member = static_cast<std::size_t>(pair.member);
    here &= lanes_.wanted[member] >> lane;
    if (here == 0) return;
    const SphereRobot::Range& first = robot_.bodies[static_cast<std::size_t>(pair.a)];
    const SphereRobot::Range& second = robot_.bodies[static_cast<std::size_t>(pair.b)];
    const FloatSphere& around = robot_.body_bounds[static_cast<std::size_t>(pair.b)];
    const Point middle = placed(frames.b, around, lane);
    for (int i = first.first; i < first.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      if (cluster.last - cluster.first > 1) {
        const Point at = placed(frames.a, cluster.bound, lane);
        const float radii = cluster.bound.radius + around.radius;
        if ((look_at_two(frames, at, middle, radii, 0.0F, most, bend, lane).open & here) == 0) continue;
      }
      for (int sphere = cluster.first; sphere < cluster.last; ++sphere)
        look_at_sphere_and_body(frames, sphere, member, second, here, most, bend, lane);
    }
  }

  void look_at_sphere_and_body(const SphereRobot::FramePair& frames, int index, std::size_t member,
                               const SphereRobot::Range& body, unsigned here, Vector most, Vector bend,
                               std::size_t lane) {
    const Point at = sphere_at(index, lane);
    const float radius = robot_.spheres[static_cast<std::size_t>(index)].radius;
    const float inner = robot_.inner[static_cast<std::size_t>(index)];
    for (int i = body.first; i < body.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      if (cluster.last - cluster.first > 1) {
        const Point middle = placed(frames.b, cluster.bound, lane);
        const float radii = radius + cluster.bound.radius;
        if ((look_at_two(frames, at, middle, radii, 0.0F, most, bend, lane).open & here) == 0) continue;
      }
      for (int sphere = cluster.first; sphere < cluster.last; ++sphere) {
        const float other = robot_.inner[static_cast<std::size_t>(sphere)];
        const float radii = radius + robot_.spheres[static_cast<std::size_t>(sphere)].radius;
        const float sure = std::min(inner, other) > 0.0F ? inner + other : 0.0F;
        fail(member, look_at_two(frames, at, sphere_at(sphere, lane), radii, sure, most, bend, lane), here,
             lane);
      }
    }
  }

  const SphereRobot& robot_;
  PieceLanes& lanes_;
  const SphereRobot::Field* field_ = nullptr;  ///< of what is asked and in doubt
  Spots asked_, doubts_;
  const std::size_t used_ = static_cast<std::size_t>(std::bit_width(lanes_.active));  ///< lanes
};

void look_at_all(const SphereRobot& robot, PieceLanes& lanes) {
  if (lanes.moving)
    Look<true>(robot, lanes).run();
  else
    Look<false>(robot, lanes).run();
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

PieceLanes::PieceLanes(const SphereRobot& robot)
    : q(robot.joints, Doubles{}),
      step(robot.joints, Doubles{}),
      bend(robot.frames.size(), Floats{}),
      pair_bend(robot.frame_pairs.size(), Floats{}),
      approach(robot.frame_pairs.size(), Floats{}),
      wanted(robot.members, 0),
      failed(robot.members, 0),
      value(robot.frames.size(), Floats{}),
      motion(robot.frames.size(), Floats{}),
      pose(12 * robot.frames.size(), Floats{}),
      twist(6 * robot.frames.size(), Floats{}),
      middle(3 * robot.frames.size(), Floats{}),
      place(3 * robot.spheres.size(), Floats{}),
      is_placed(robot.spheres.size(), 0) {}

void PieceLanes::want_all(int lanes) {
  active = static_cast<Lanes>((1U << lanes) - 1U);
  std::fill(wanted.begin(), wanted.end(), active);
}

PieceLanes::Lanes PieceLanes::failing() const {
  Lanes lanes = 0;
  for (const int member : members) lanes |= failed[static_cast<std::size_t>(member)];
  return lanes;
}

void PieceLanes::want_none() { std::fill(wanted.begin(), wanted.end(), Lanes{0}); }

namespace {

void look_with(const SphereRobot& robot, PieceLanes& lanes, [[maybe_unused]] InstructionSet vectors) {
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::look_at_all(robot, lanes);
  if (vectors == InstructionSet::avx2) return N_AVX2::look_at_all(robot, lanes);
#endif
  HWY_STATIC_DISPATCH(look_at_all)(robot, lanes);
}

}  // namespace

void look(const SphereRobot& robot, PieceLanes& lanes) {
  static const InstructionSet widest = best_instruction_set();
  look(robot, lanes, widest);
}

void look(const SphereRobot& robot, PieceLanes& lanes, InstructionSet vectors) {
  for (const int member : lanes.members) lanes.failed[static_cast<std::size_t>(member)] = 0;
  lanes.members.clear();
  lanes.blocked = lanes.stuck = 0;
  look_with(robot, lanes, vectors);
  lanes.are_frames_placed = false;
  std::sort(lanes.members.begin(), lanes.members.end());  // found in an order that depends on the registers
}

}  // namespace clearway
#endif  // HWY_ONCE
