#include "planning/batch/core_lanes.hpp"

#include <bit>
#include <cmath>

#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/batch/core_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "planning/batch/lane_frames.hpp"
#include "planning/batch/lane_sight.hpp"
#include "planning/batch/lane_spots.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// One look for bodies that touch what blocks them.
class CoreLook {
 public:
  CoreLook(const SphereRobot& robot, PieceLanes& lanes, LaneBits enough)
      : robot_(robot), lanes_(lanes), enough_(enough) {}

  LaneBits run() {
    read_values(robot_, lanes_.q.data(), lanes_.value.data());
    place_frames(robot_, lanes_.value.data(), lanes_.pose.data());
    lanes_.are_frames_placed = true;
    for (const SphereRobot::Group& group : robot_.groups) {
      if (group.first_core == group.last_core || !is_near(group)) continue;
      look_at_cores(group);
      if (is_enough()) break;
    }
    return found_;
  }

 private:
  bool is_enough() const { return (found_ & enough_) != 0; }

  /// Whether the sphere around all of the group is not proved clear in some lane.
  bool is_near(const SphereRobot::Group& group) {
    field_ = &robot_.fields[static_cast<std::size_t>(group.field)];
    pose_ = &lanes_.pose[12 * static_cast<std::size_t>(group.frame)];
    const Vector need = all(group.bound.radius + robot_.padding + robot_.slack);
    unsigned near = 0;
    for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
      const Sight seen = sight(*field_, placed(pose_, group.bound, lane));
      store(seen.lower, clearance_, lane);
      near |= bits(hn::Not(hn::Ge(seen.lower, need))) << lane;
    }
    return (near & lanes_.active) != 0;
  }

  /// At spheres that lie in bodies, until there is enough.
  void look_at_cores(const SphereRobot::Group& group) {
    for (int i = group.first_core; i < group.last_core && !is_enough(); ++i) {
      ask_for_core(group.bound, i);
      if (asked_.count >= lane_count) look_at_asked(lane_count);
    }
    if (!is_enough()) look_at_asked(asked_.count);
  }

  /// Not where the middle of the group is so far from what blocks it that this sphere cannot reach that.
  void ask_for_core(const SphereRobot::FloatSphere& bound, int index) {
    const SphereRobot::FloatSphere& core = robot_.cores[static_cast<std::size_t>(index)];
    const float x = core.x - bound.x, y = core.y - bound.y, z = core.z - bound.z;
    const float away = std::sqrt(x * x + y * y + z * z);
    const Vector far = all(away + core.radius + robot_.padding + robot_.slack);
    const Vector sure = all(core.radius + robot_.padding - robot_.slack);
    for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) {
      const unsigned near = bits(hn::Lt(load(clearance_, lane), far)) & lanes_.active >> lane;
      if (near != 0) asked_.add(placed(pose_, core, lane), sure, near, lane, index);
    }
  }

  void look_at_asked(std::size_t last) {
    const std::size_t first = asked_.count - last;
    for (std::size_t k = first; k < asked_.count; k += hn::Lanes(Tag())) {
      const Sight seen = sight(*field_, asked_.point(k));
      unsigned met = bits(hn::Lt(seen.upper, asked_.needed(k))) & lanes_in_use(asked_.count, k);
      for (; met != 0; met &= met - 1U)
        found_ |=
            static_cast<LaneBits>(1U << asked_.lane[k + static_cast<std::size_t>(std::countr_zero(met))]);
    }
    asked_.count = first;
  }

  const SphereRobot& robot_;
  PieceLanes& lanes_;
  LaneBits enough_, found_ = 0;
  const SphereRobot::Field* field_ = nullptr;  ///< of the group, as its pose
  const LaneFloats* pose_ = nullptr;
  LaneFloats clearance_;  ///< of the middle of the group, at least
  Spots asked_;
};

LaneBits find_touching(const SphereRobot& robot, PieceLanes& lanes, LaneBits enough) {
  return CoreLook(robot, lanes, enough).run();
}

}  // namespace clearway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace clearway {

PieceLanes::Lanes touching_lanes(const SphereRobot& robot, PieceLanes& lanes, PieceLanes::Lanes enough) {
  static const InstructionSet widest = best_instruction_set();
  return touching_lanes(robot, lanes, enough, widest);
}

PieceLanes::Lanes touching_lanes(const SphereRobot& robot, PieceLanes& lanes, PieceLanes::Lanes enough,
                                 [[maybe_unused]] InstructionSet vectors) {
#if HWY_ARCH_X86
  if (vectors == InstructionSet::avx512) return N_AVX3::find_touching(robot, lanes, enough);
  if (vectors == InstructionSet::avx2) return N_AVX2::find_touching(robot, lanes, enough);
#endif
  return HWY_STATIC_DISPATCH(find_touching)(robot, lanes, enough);
}

}  // namespace clearway
#endif  // HWY_ONCE
