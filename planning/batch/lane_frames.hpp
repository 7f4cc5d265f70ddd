// Not part of the installed library. Included once for each instruction set, so there is no #pragma once.

#include "planning/batch/sphere_robot.hpp"

#if defined(CLEARWAY_LANE_FRAMES) == defined(HWY_TARGET_TOGGLE)
#ifdef CLEARWAY_LANE_FRAMES
#undef CLEARWAY_LANE_FRAMES
#else
#define CLEARWAY_LANE_FRAMES
#endif

#include "planning/batch/lane_vectors.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

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

/// Values of the joints' motions as floats; angles between -pi and pi, which keeps them exact.
template <bool moving>
void read_values(const SphereRobot& robot, const LaneDoubles* q, const LaneDoubles* step, LaneFloats* value,
                 LaneFloats* motion) {
  constexpr double turn = 6.283185307179586, magic = 6755399441055744.0;  // rounds what is added to it
  for (std::size_t i = 1; i < robot.frames.size(); ++i) {
    const SphereRobot::Frame& frame = robot.frames[i];
    const auto joint = static_cast<std::size_t>(frame.joint);
    for (int lane = 0; lane < lane_count; ++lane) {
      double at = frame.multiplier * q[joint].at[lane] + frame.offset;
      if (frame.turns) at -= turn * ((at * (1.0 / turn) + magic) - magic);
      value[i].at[lane] = static_cast<float>(at);
      if constexpr (moving) motion[i].at[lane] = static_cast<float>(frame.multiplier * step[joint].at[lane]);
    }
  }
}

/// Numbers of lanes about each frame: the value of its joint's motion; its pose, 9 rows of its rotation, then
/// 3 of its place; and when it moves, its motion over the piece and its twist: turn, then velocity of what is
/// at the base.
struct FrameRows {
  const LaneFloats *value, *motion;
  LaneFloats *pose, *twist;
};

template <bool moving>
HWY_INLINE void place_frame(const SphereRobot& robot, const FrameRows& rows, std::size_t index,
                            std::size_t lane) {
  const SphereRobot::Frame& frame = robot.frames[index];
  const auto parent = static_cast<std::size_t>(frame.parent);
  const LaneFloats* above = &rows.pose[12 * parent];
  LaneFloats* here = &rows.pose[12 * index];
  const Vector value = load(rows.value[index], lane);
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
  if constexpr (!moving) return;
  const Point along = times(load(rows.motion[index], lane), {axis[0], axis[1], axis[2]});
  Point turn = load_point(&rows.twist[6 * parent], lane);
  Point velocity = load_point(&rows.twist[6 * parent + 3], lane);
  if (frame.turns) {
    turn = plus(turn, along);
    velocity = plus(velocity, cross({place[0], place[1], place[2]}, along));
  } else {
    velocity = plus(velocity, along);
  }
  store_point(turn, &rows.twist[6 * index], lane);
  store_point(velocity, &rows.twist[6 * index + 3], lane);
}

template <bool moving>
void place_frames(const SphereRobot& robot, const FrameRows& rows) {
  for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
    for (int i = 0; i < 12; ++i) store(all(i < 9 ? robot.base[i] : 0.0F), rows.pose[i], lane);
    for (int i = 0; i < 6 && moving; ++i) store(all(0.0F), rows.twist[i], lane);
    for (std::size_t i = 1; i < robot.frames.size(); ++i) place_frame<moving>(robot, rows, i, lane);
  }
}

/// Where a point of a frame is; `pose` is that frame's.
HWY_INLINE Point placed(const LaneFloats* pose, const Point& point, std::size_t lane) {
  const auto row = [&](const LaneFloats* of, const LaneFloats& place) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(load(of[0], lane), point.x), hn::Mul(load(of[1], lane), point.y)),
                   hn::Add(hn::Mul(load(of[2], lane), point.z), load(place, lane)));
  };
  return {row(pose, pose[9]), row(pose + 3, pose[10]), row(pose + 6, pose[11])};
}
HWY_INLINE Point placed(const LaneFloats* pose, const SphereRobot::Ball& ball, std::size_t lane) {
  return placed(pose, Point{all(ball.x), all(ball.y), all(ball.z)}, lane);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
