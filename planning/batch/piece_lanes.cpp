#include "planning/batch/piece_lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "mapping/field/byte_field.hpp"

// Three widths are enough; the library that chooses among all is not needed, nor linked.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
#define HWY_DISABLE_PCLMUL_AES  // best_instruction_set() does not ask for them
#define HWY_DISABLE_F16C
#define HWY_DISABLE_BMI2_FMA
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/batch/piece_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, PieceLanes::count>;
using WholeTag = hn::RebindToSigned<Tag>;
using Vector = hn::Vec<Tag>;
using Whole = hn::Vec<WholeTag>;
using Mask = hn::Mask<Tag>;
using Floats = PieceLanes::Floats;
using Lanes = PieceLanes::Lanes;
using Ball = SphereRobot::Ball;

struct Point {
  Vector x, y, z;
};

HWY_INLINE Vector load(const Floats& row, std::size_t lane) { return hn::Load(Tag(), row.at + lane); }
HWY_INLINE void store(Vector numbers, Floats& row, std::size_t lane) {
  hn::Store(numbers, Tag(), row.at + lane);
}
HWY_INLINE Vector all(float number) { return hn::Set(Tag(), number); }
HWY_INLINE Point load_point(const Floats* rows, std::size_t lane) {
  return {load(rows[0], lane), load(rows[1], lane), load(rows[2], lane)};
}
HWY_INLINE void store_point(const Point& point, Floats* rows, std::size_t lane) {
  store(point.x, rows[0], lane), store(point.y, rows[1], lane), store(point.z, rows[2], lane);
}
HWY_INLINE Point minus(const Point& a, const Point& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Point plus(const Point& a, const Point& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Point times(Vector s, const Point& a) {
  return {hn::Mul(s, a.x), hn::Mul(s, a.y), hn::Mul(s, a.z)};
}
HWY_INLINE Point cross(const Point& a, const Point& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
HWY_INLINE Vector squared(const Point& a) {
  return hn::Add(hn::Add(hn::Mul(a.x, a.x), hn::Mul(a.y, a.y)), hn::Mul(a.z, a.z));
}

/// The bits of a mask, from lane 0 on.
HWY_INLINE unsigned bits(Mask mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Tag(), mask, bytes);
  std::uint32_t all_bits = 0;
  std::memcpy(&all_bits, bytes, sizeof(all_bits));
  return all_bits & ((1U << hn::Lanes(Tag())) - 1U);
}

/// Sine and cosine of angles between -pi and pi, within 2e-7.
HWY_INLINE void sine_and_cosine(Vector angle, Vector& sine, Vector& cosine) {
  const Vector quarters = hn::Round(hn::Mul(angle, all(0.636619772F)));
  Vector r = hn::Sub(angle, hn::Mul(quarters, all(1.5703125F)));  // pi / 2 in three parts
  r = hn::Sub(r, hn::Mul(quarters, all(4.8375129699707031e-4F)));
  r = hn::Sub(r, hn::Mul(quarters, all(7.5497899548918861e-8F)));
  const Vector rr = hn::Mul(r, r);
  Vector s = all(-1.9515295891e-4F);
  s = hn::Add(hn::Mul(s, rr), all(8.3321608736e-3F));
  s = hn::Add(hn::Mul(s, rr), all(-1.6666654611e-1F));
  s = hn::Add(hn::Mul(hn::Mul(s, rr), r), r);
  Vector c = all(2.443315711809948e-5F);
  c = hn::Add(hn::Mul(c, rr), all(-1.388731625493765e-3F));
  c = hn::Add(hn::Mul(c, rr), all(4.166664568298827e-2F));
  c = hn::Add(hn::Mul(hn::Mul(c, rr), rr), hn::Sub(all(1.0F), hn::Mul(all(0.5F), rr)));
  const auto quarter = hn::ConvertTo(WholeTag(), quarters);
  const auto one = hn::Set(WholeTag(), 1), two = hn::Set(WholeTag(), 2);
  const Mask swap = hn::RebindMask(Tag(), hn::TestBit(quarter, one));
  const Mask sine_is_negative = hn::RebindMask(Tag(), hn::TestBit(quarter, two));
  const Mask cosine_is_negative = hn::RebindMask(Tag(), hn::TestBit(hn::Add(quarter, one), two));
  const Vector first = hn::IfThenElse(swap, c, s), second = hn::IfThenElse(swap, s, c);
  sine = hn::IfThenElse(sine_is_negative, hn::Neg(first), first);
  cosine = hn::IfThenElse(cosine_is_negative, hn::Neg(second), second);
}

/// One look at pieces.
template <bool moving>
class Look {
 public:
  Look(const SphereRobot& robot, PieceLanes& lanes) : robot_(robot), lanes_(lanes) {}

  void run() {
    read_values();
    place_frames();
    std::fill(lanes_.is_placed.begin(), lanes_.is_placed.end(), Lanes{0});
    for (const SphereRobot::Group& group : robot_.groups) look_at(group);
    place_middles();
    for (std::size_t pair = 0; pair < robot_.frame_pairs.size(); ++pair) look_at_pair(pair);
  }

 private:
  static constexpr float rounded_up = 1.0F + 1e-5F;  ///< of speeds: a few roundings

  /// Values of the joints' motions as floats; angles between -pi and pi, which keeps them exact.
  void read_values() {
    constexpr double turn = 6.283185307179586, magic = 6755399441055744.0;  // rounds what is added to it
    for (std::size_t i = 1; i < robot_.frames.size(); ++i) {
      const SphereRobot::Frame& frame = robot_.frames[i];
      const auto joint = static_cast<std::size_t>(frame.joint);
      const double* q = lanes_.q[joint].at;
      const double* step = lanes_.step[joint].at;
      for (int lane = 0; lane < PieceLanes::count; ++lane) {
        double value = frame.multiplier * q[lane] + frame.offset;
        if (frame.turns) value -= turn * ((value * (1.0 / turn) + magic) - magic);
        lanes_.value[i].at[lane] = static_cast<float>(value);
        if (moving) lanes_.motion[i].at[lane] = static_cast<float>(frame.multiplier * step[lane]);
      }
    }
  }

  void place_frames() {
    Floats* base = lanes_.pose.data();
    for (std::size_t lane = 0; lane < PieceLanes::count; lane += hn::Lanes(Tag())) {
      for (int i = 0; i < 12; ++i) store(all(i < 9 ? robot_.base[i] : 0.0F), base[i], lane);
      for (int i = 0; i < 6 && moving; ++i) store(all(0.0F), lanes_.twist[static_cast<std::size_t>(i)], lane);
      for (std::size_t i = 1; i < robot_.frames.size(); ++i) place_frame(i, lane);
    }
  }

  HWY_INLINE void place_frame(std::size_t index, std::size_t lane) {
    const SphereRobot::Frame& frame = robot_.frames[index];
    const auto parent = static_cast<std::size_t>(frame.parent);
    const Floats* above = &lanes_.pose[12 * parent];
    Floats* here = &lanes_.pose[12 * index];
    const Vector value = load(lanes_.value[index], lane);
    Vector sine = all(0.0F), cosine = all(1.0F);
    if (frame.turns) sine_and_cosine(value, sine, cosine);
    Vector axis[3], place[3];
    for (int row = 0; row < 3; ++row) {
      const Vector a = load(above[3 * row], lane), b = load(above[3 * row + 1], lane),
                   c = load(above[3 * row + 2], lane);
      const auto product = [&](float x, float y, float z) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(a, all(x)), hn::Mul(b, all(y))), hn::Mul(c, all(z)));
      };
      const Vector first = product(frame.rotation[0], frame.rotation[3], frame.rotation[6]);
      const Vector second = product(frame.rotation[1], frame.rotation[4], frame.rotation[7]);
      axis[row] = product(frame.rotation[2], frame.rotation[5], frame.rotation[8]);
      place[row] = hn::Add(product(frame.translation[0], frame.translation[1], frame.translation[2]),
                           load(above[9 + row], lane));
      if (!frame.turns) place[row] = hn::Add(place[row], hn::Mul(value, axis[row]));
      store(hn::Add(hn::Mul(cosine, first), hn::Mul(sine, second)), here[3 * row], lane);
      store(hn::Sub(hn::Mul(cosine, second), hn::Mul(sine, first)), here[3 * row + 1], lane);
      store(axis[row], here[3 * row + 2], lane);
      store(place[row], here[9 + row], lane);
    }
    if (!moving) return;
    const Point along = times(load(lanes_.motion[index], lane), {axis[0], axis[1], axis[2]});
    Point turn = load_point(&lanes_.twist[6 * parent], lane);
    Point velocity = load_point(&lanes_.twist[6 * parent + 3], lane);
    if (frame.turns) {
      turn = plus(turn, along);
      velocity = plus(velocity, cross({place[0], place[1], place[2]}, along));
    } else {
      velocity = plus(velocity, along);
    }
    store_point(turn, &lanes_.twist[6 * index], lane);
    store_point(velocity, &lanes_.twist[6 * index + 3], lane);
  }

  HWY_INLINE Point placed(int frame, const Ball& ball, std::size_t lane) const {
    const Floats* pose = &lanes_.pose[12 * static_cast<std::size_t>(frame)];
    const Point point{all(ball.x), all(ball.y), all(ball.z)};
    return {placed(pose, pose + 9, point, lane), placed(pose + 3, pose + 10, point, lane),
            placed(pose + 6, pose + 11, point, lane)};
  }
  static HWY_INLINE Vector placed(const Floats* row, const Floats* place, const Point& point,
                                  std::size_t lane) {
    return hn::Add(hn::Add(hn::Mul(load(row[0], lane), point.x), hn::Mul(load(row[1], lane), point.y)),
                   hn::Add(hn::Mul(load(row[2], lane), point.z), load(*place, lane)));
  }

  /// The velocity of what is at `point` and moves with the frame.
  HWY_INLINE Point velocity(int frame, const Point& point, std::size_t lane) const {
    const Floats* twist = &lanes_.twist[6 * static_cast<std::size_t>(frame)];
    return plus(load_point(twist + 3, lane), cross(load_point(twist, lane), point));
  }

  struct Sight {
    Vector lower;  ///< no blocked cube is nearer, metres
    Vector upper;  ///< some blocked cube is no farther, where that is known
  };
  /// The numbers of cells; those that are not known yet are made.
  static HWY_INLINE Whole number_of(const ByteField& bytes, Whole cell) {
    const auto* first = reinterpret_cast<const std::int32_t*>(bytes.cells.data());
    const Whole byte = hn::Set(WholeTag(), 255);
    const Whole number = hn::And(hn::GatherOffset(WholeTag(), first, cell), byte);
    if (hn::AllFalse(WholeTag(), hn::Eq(number, hn::Zero(WholeTag())))) return number;
    know(bytes, cell, number);
    return hn::And(hn::GatherOffset(WholeTag(), first, cell), byte);
  }
  static HWY_NOINLINE void know(const ByteField& bytes, Whole cell, Whole number) {
    std::int32_t cells[PieceLanes::count], numbers[PieceLanes::count];
    hn::StoreU(cell, WholeTag(), cells);
    hn::StoreU(number, WholeTag(), numbers);
    for (std::size_t i = 0; i < hn::Lanes(WholeTag()); ++i) {
      if (numbers[i] == 0) bytes.know(static_cast<std::size_t>(cells[i]));
    }
  }
  /// A cell's distance, less and more by how far the point is from the cell's middle.
  HWY_INLINE Sight sight(const SphereRobot::Field& field, const Point& point) const {
    const ByteField& bytes = *field.bytes;
    const auto resolution = static_cast<float>(bytes.resolution);
    const Vector scale = all(static_cast<float>(1.0 / bytes.resolution));
    const Vector half = all(0.5F), zero = hn::Zero(Tag());
    const auto axis = [&](Vector at, int i, Vector& gap, Vector& border, Vector& beyond) HWY_ATTR {
      const Vector size = all(static_cast<float>(bytes.size[i]));
      const Vector offset = hn::Mul(hn::Sub(at, all(field.low[i])), scale);
      const Vector inside = hn::Min(hn::Max(offset, zero), size);
      const auto cell = hn::Min(hn::ConvertTo(WholeTag(), inside), hn::Set(WholeTag(), bytes.size[i] - 1));
      gap = hn::Sub(inside, hn::Add(hn::ConvertTo(Tag(), cell), half));
      border = hn::Min(border, hn::Min(offset, hn::Sub(size, offset)));
      beyond = hn::Add(beyond, hn::Abs(hn::Sub(offset, inside)));
      return cell;
    };
    Point gap;
    Vector border = all(1e30F), beyond = zero;
    const auto x = axis(point.x, 0, gap.x, border, beyond);
    const auto y = axis(point.y, 1, gap.y, border, beyond);
    const auto z = axis(point.z, 2, gap.z, border, beyond);
    const auto cell = hn::Add(hn::Mul(hn::Add(hn::Mul(z, hn::Set(WholeTag(), bytes.size[1])), y),
                                      hn::Set(WholeTag(), bytes.size[0])),
                              x);
    const Whole number = number_of(bytes, cell);
    const Vector units = hn::ConvertTo(Tag(), number);
    const Vector off = hn::Mul(hn::Sqrt(squared(gap)), all(resolution));
    const Vector step = all(static_cast<float>(bytes.step));
    Sight seen;
    seen.lower = hn::Sub(hn::Mul(units, step), off);
    if (bytes.outside_blocked) seen.lower = hn::Min(seen.lower, hn::Mul(border, all(resolution)));
    const Vector most = hn::Add(hn::Mul(hn::Add(units, all(1.0F)), step), off);
    const Mask unknown = hn::Or(hn::Ge(units, all(static_cast<float>(bytes.end))), hn::Gt(beyond, zero));
    seen.upper = hn::IfThenElse(unknown, all(1e30F), hn::IfThenZeroElse(hn::Eq(units, zero), most));
    return seen;
  }

  /// Which of the wanted lanes are not proved clear by a sphere, of those that begin at `lane`.
  struct Finding {
    unsigned open = 0, blocked = 0, stuck = 0;
  };
  HWY_INLINE Finding look_at_ball(int frame, const SphereRobot::Field& field, const Ball& ball, float inner,
                                  std::size_t lane, Floats* keep) const {
    const Point point = placed(frame, ball, lane);
    if (keep != nullptr) store_point(point, keep, lane);
    const Sight seen = sight(field, point);
    const float reach = ball.radius + robot_.padding + robot_.slack;
    Vector need = all(reach);
    if (moving) {
      const Vector speed = hn::Sqrt(squared(velocity(frame, point, lane)));
      need = hn::Add(need, hn::Add(hn::Mul(speed, all(rounded_up)),
                                   load(lanes_.bend[static_cast<std::size_t>(frame)], lane)));
    }
    Finding finding;
    finding.open = bits(hn::Not(hn::Ge(seen.lower, need)));  // what is no number is not proved
    if (finding.open == 0) return finding;
    const auto resolution = static_cast<float>(field.bytes->resolution);
    finding.stuck = bits(hn::Lt(seen.lower, all(reach + 0.1F * resolution)));
    if (inner > 0.0F) finding.blocked = bits(hn::Lt(seen.upper, all(inner + robot_.padding - robot_.slack)));
    return finding;
  }

  /// Of the lanes, those in which a sphere is not proved clear.
  Lanes near(const SphereRobot::Group& group, const Ball& ball, Lanes asked) const {
    const SphereRobot::Field& field = robot_.fields[static_cast<std::size_t>(group.field)];
    unsigned open = 0;
    for (std::size_t lane = 0; lane < PieceLanes::count; lane += hn::Lanes(Tag())) {
      if ((asked >> lane & ((1U << hn::Lanes(Tag())) - 1U)) == 0) continue;
      open |= look_at_ball(group.frame, field, ball, 0.0F, lane, nullptr).open << lane;
    }
    return static_cast<Lanes>(open & asked);
  }

  void look_at(const SphereRobot::Group& group) {
    const SphereRobot::Field& field = robot_.fields[static_cast<std::size_t>(group.field)];
    const Lanes here = near(group, group.bound, lanes_.active);
    if (here == 0) return;
    for (int i = group.first; i < group.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      const auto member = static_cast<std::size_t>(robot_.member[static_cast<std::size_t>(cluster.first)]);
      Lanes asked = here & lanes_.wanted[member];
      if (asked != 0 && cluster.last - cluster.first > 1) asked = near(group, cluster.bound, asked);
      if (asked == 0) continue;
      for (int ball = cluster.first; ball < cluster.last; ++ball) look_at_ball(group, field, ball, asked);
    }
  }

  void look_at_ball(const SphereRobot::Group& group, const SphereRobot::Field& field, int index,
                    Lanes asked) {
    const auto i = static_cast<std::size_t>(index);
    const auto member = static_cast<std::size_t>(robot_.member[i]);
    for (std::size_t lane = 0; lane < PieceLanes::count; lane += hn::Lanes(Tag())) {
      const unsigned here = asked >> lane & ((1U << hn::Lanes(Tag())) - 1U);
      if (here == 0) continue;
      const Finding finding =
          look_at_ball(group.frame, field, robot_.balls[i], robot_.inner[i], lane, &lanes_.place[3 * i]);
      lanes_.is_placed[i] |= static_cast<Lanes>(1U << (lane / hn::Lanes(Tag())));
      fail(member, finding, here, lane);
    }
  }

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
      for (std::size_t lane = 0; lane < PieceLanes::count; lane += hn::Lanes(Tag()))
        store_point(placed(static_cast<int>(i), robot_.bounds[i], lane), &lanes_.middle[3 * i], lane);
    }
  }

  HWY_INLINE Point ball_at(int index, std::size_t lane) const {
    const auto i = static_cast<std::size_t>(index);
    const auto bit = static_cast<Lanes>(1U << (lane / hn::Lanes(Tag())));
    if ((lanes_.is_placed[i] & bit) == 0) {
      store_point(placed(robot_.frame_of[i], robot_.balls[i], lane), &lanes_.place[3 * i], lane);
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
    for (std::size_t lane = 0; lane < PieceLanes::count; lane += hn::Lanes(Tag())) {
      unsigned here = asked >> lane & ((1U << hn::Lanes(Tag())) - 1U);
      if (here == 0) continue;
      const Vector slack = all(robot_.slack);
      const Vector most = moving ? hn::Add(load(lanes_.approach[index], lane), slack) : slack;
      const Vector bend = moving ? load(lanes_.pair_bend[index], lane) : hn::Zero(Tag());
      const Point a = load_point(&lanes_.middle[3 * static_cast<std::size_t>(pair.a)], lane);
      const Point b = load_point(&lanes_.middle[3 * static_cast<std::size_t>(pair.b)], lane);
      here &= look_at_two(pair, a, b, radii, 0.0F, most, bend, lane).open;
      for (int i = pair.first; i < pair.last && here != 0; ++i)
        look_at_bodies(pair, robot_.body_pairs[static_cast<std::size_t>(i)], here, most, bend, lane);
    }
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
    const Ball& around = robot_.body_bounds[static_cast<std::size_t>(pair.b)];
    const Point middle = placed(frames.b, around, lane);
    for (int i = first.first; i < first.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      if (cluster.last - cluster.first > 1) {
        const Point at = placed(frames.a, cluster.bound, lane);
        const float radii = cluster.bound.radius + around.radius;
        if ((look_at_two(frames, at, middle, radii, 0.0F, most, bend, lane).open & here) == 0) continue;
      }
      for (int ball = cluster.first; ball < cluster.last; ++ball)
        look_at_ball_and_body(frames, ball, member, second, here, most, bend, lane);
    }
  }

  void look_at_ball_and_body(const SphereRobot::FramePair& frames, int index, std::size_t member,
                             const SphereRobot::Range& body, unsigned here, Vector most, Vector bend,
                             std::size_t lane) {
    const Point at = ball_at(index, lane);
    const float radius = robot_.balls[static_cast<std::size_t>(index)].radius;
    const float inner = robot_.inner[static_cast<std::size_t>(index)];
    for (int i = body.first; i < body.last; ++i) {
      const SphereRobot::Cluster& cluster = robot_.clusters[static_cast<std::size_t>(i)];
      if (cluster.last - cluster.first > 1) {
        const Point middle = placed(frames.b, cluster.bound, lane);
        const float radii = radius + cluster.bound.radius;
        if ((look_at_two(frames, at, middle, radii, 0.0F, most, bend, lane).open & here) == 0) continue;
      }
      for (int ball = cluster.first; ball < cluster.last; ++ball) {
        const float other = robot_.inner[static_cast<std::size_t>(ball)];
        const float radii = radius + robot_.balls[static_cast<std::size_t>(ball)].radius;
        const float sure = std::min(inner, other) > 0.0F ? inner + other : 0.0F;
        fail(member, look_at_two(frames, at, ball_at(ball, lane), radii, sure, most, bend, lane), here, lane);
      }
    }
  }

  const SphereRobot& robot_;
  PieceLanes& lanes_;
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
      place(3 * robot.balls.size(), Floats{}),
      is_placed(robot.balls.size(), 0) {}

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

void look(const SphereRobot& robot, PieceLanes& lanes) {
  static const InstructionSet widest = best_instruction_set();
  look(robot, lanes, widest);
}

void look(const SphereRobot& robot, PieceLanes& lanes, InstructionSet vectors) {
  for (const int member : lanes.members) lanes.failed[static_cast<std::size_t>(member)] = 0;
  lanes.members.clear();
  lanes.blocked = lanes.stuck = 0;
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::look_at_all(robot, lanes);
  if (vectors == InstructionSet::avx2) return N_AVX2::look_at_all(robot, lanes);
#endif
  HWY_STATIC_DISPATCH(look_at_all)(robot, lanes);
}

}  // namespace clearway
#endif  // HWY_ONCE
