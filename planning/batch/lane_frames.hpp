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
/// @param used this and what follows work on so many lanes from the first on, and on the rest of a register
inline void read_values(const SphereRobot& robot, const LaneDoubles* q, LaneFloats* value,
                        std::size_t used = lane_count) {
  using DoubleTag = hn::Repartition<double, Tag>;
  using HalfTag = hn::Rebind<float, DoubleTag>;
  const auto number = [](double x) HWY_ATTR { return hn::Set(DoubleTag(), x); };
  const auto turn = number(6.283185307179586), turns = number(1.0 / 6.283185307179586);
  const auto magic = number(6755399441055744.0);  // rounds what is added to it
  for (std::size_t i = 1; i < robot.frames.size(); ++i) {
    const SphereRobot::Frame& frame = robot.frames[i];
    const double* from = q[static_cast<std::size_t>(frame.joint)].at;
    for (std::size_t lane = 0; lane < used; lane += hn::Lanes(DoubleTag())) {
      const auto joint = hn::Load(DoubleTag(), from + lane);
      auto at = hn::Add(hn::Mul(number(frame.multiplier), joint), number(frame.offset));
      const auto whole = hn::Sub(hn::Add(hn::Mul(at, turns), magic), magic);
      if (frame.turns) at = hn::Sub(at, hn::Mul(turn, whole));
      hn::Store(hn::DemoteTo(HalfTag(), at), HalfTag(), value[i].at + lane);
    }
  }
}

/// How far the joints' motions go.
inline void read_motions(const SphereRobot& robot, const LaneDoubles* step, LaneFloats* motion,
                         std::size_t used = lane_count) {
  for (std::size_t i = 1; i < robot.frames.size(); ++i) {
    const SphereRobot::Frame& frame = robot.frames[i];
    const double* by = step[static_cast<std::size_t>(frame.joint)].at;
    for (std::size_t lane = 0; lane < used; ++lane)
      motion[i].at[lane] = static_cast<float>(frame.multiplier * by[lane]);
  }
}

/// Poses of a frame are 12 rows of lanes: 9 of its rotation, 3 of its place. `value`: of its joint's motion.
HWY_INLINE void place_frame(const SphereRobot& robot, const LaneFloats* values, LaneFloats* pose,
                            std::size_t index, std::size_t lane) {
  const SphereRobot::Frame& frame = robot.frames[index];
  const LaneFloats* above = &pose[12 * static_cast<std::size_t>(frame.parent)];
  LaneFloats* here = &pose[12 * index];
  const Vector value = load(values[index], lane);
  Vector sine = all(0.0F), cosine = all(1.0F);
  if (frame.turns) sine_and_cosine(value, sine, cosine);
  for (int row = 0; row < 3; ++row) {
    const Vector a = load(above[3 * row], lane), b = load(above[3 * row + 1], lane),
                 c = load(above[3 * row + 2], lane);
    const auto product = [&](float x, float y, float z) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(a, all(x)), hn::Mul(b, all(y))), hn::Mul(c, all(z)));
    };
    const Vector first = product(frame.rotation[0], frame.rotation[3], frame.rotation[6]);
    const Vector second = product(frame.rotation[1], frame.rotation[4], frame.rotation[7]);
    const Vector axis = product(frame.rotation[2], frame.rotation[5], frame.rotation[8]);
    Vector place = hn::Add(product(frame.translation[0], frame.translation[1], frame.translation[2]),
                           load(above[9 + row], lane));
    if (!frame.turns) place = hn::Add(place, hn::Mul(value, axis));
    store(hn::Add(hn::Mul(cosine, first), hn::Mul(sine, second)), here[3 * row], lane);
    store(hn::Sub(hn::Mul(cosine, second), hn::Mul(sine, first)), here[3 * row + 1], lane);
    store(axis, here[3 * row + 2], lane);
    store(place, here[9 + row], lane);
  }
}

/// The poses of all frames for the values of their joints' motions.
inline void place_frames(const SphereRobot& robot, const LaneFloats* value, LaneFloats* pose,
                         std::size_t used = lane_count) {
  for (std::size_t lane = 0; lane < used; lane += hn::Lanes(Tag())) {
    for (int i = 0; i < 12; ++i) store(all(i < 9 ? robot.base[i] : 0.0F), pose[i], lane);
    for (std::size_t i = 1; i < robot.frames.size(); ++i) place_frame(robot, value, pose, i, lane);
  }
}

/// The twists of all frames, 6 rows of lanes each, for the motions of their joints where they are: turn, then
/// velocity of what is at the base.
inline void move_frames(const SphereRobot& robot, const LaneFloats* motion, const LaneFloats* pose,
                        LaneFloats* twist, std::size_t used = lane_count) {
  for (std::size_t lane = 0; lane < used; lane += hn::Lanes(Tag())) {
    for (int i = 0; i < 6; ++i) store(all(0.0F), twist[i], lane);
    for (std::size_t i = 1; i < robot.frames.size(); ++i) {
      const LaneFloats *here = &pose[12 * i],
                       *above = &twist[6 * static_cast<std::size_t>(robot.frames[i].parent)];
      const Point axis{load(here[2], lane), load(here[5], lane), load(here[8], lane)};
      const Point along = times(load(motion[i], lane), axis);
      Point turn = load_point(above, lane), velocity = load_point(above + 3, lane);
      if (robot.frames[i].turns) {
        turn = plus(turn, along);
        velocity = plus(velocity, cross(load_point(here + 9, lane), along));
      } else {
        velocity = plus(velocity, along);
      }
      store_point(turn, &twist[6 * i], lane);
      store_point(velocity, &twist[6 * i + 3], lane);
    }
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
HWY_INLINE Point placed(const LaneFloats* pose, const SphereRobot::FloatSphere& sphere, std::size_t lane) {
  return placed(pose, Point{all(sphere.x), all(sphere.y), all(sphere.z)}, lane);
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
