#include "planning/batch/core_lanes.hpp"

#include "mapping/system/highway_targets.hpp"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "planning/batch/core_lanes.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "planning/batch/lane_frames.hpp"
#include "planning/batch/lane_sight.hpp"

HWY_BEFORE_NAMESPACE();
namespace clearway::HWY_NAMESPACE {

/// Calls `look` with the first lane of each register.
template <class LookAtLanes>
HWY_INLINE LaneBits in_all_lanes(const LookAtLanes& look) {
  unsigned found = 0;
  for (std::size_t lane = 0; lane < lane_count; lane += hn::Lanes(Tag())) found |= look(lane) << lane;
  return static_cast<LaneBits>(found);
}

/// Lanes in which the sphere around all of the group is not proved clear.
LaneBits near_lanes(const SphereRobot& robot, const SphereRobot::Group& group, const LaneFloats* pose) {
  const SphereRobot::Field& field = robot.fields[static_cast<std::size_t>(group.field)];
  const Vector need = all(group.bound.radius + robot.padding + robot.slack);
  return in_all_lanes([&](std::size_t lane) HWY_ATTR {
    return bits(hn::Not(hn::Ge(sight(field, placed(pose, group.bound, lane)).lower, need)));
  });
}

/// Lanes of those in use in which a sphere that lies in a body reaches into what blocks the body; all of them
/// unless there are enough sooner.
LaneBits pierced_lanes(const SphereRobot& robot, const SphereRobot::Group& group, const PieceLanes& lanes,
                       LaneBits enough) {
  const SphereRobot::Field& field = robot.fields[static_cast<std::size_t>(group.field)];
  const LaneFloats* pose = &lanes.pose[12 * static_cast<std::size_t>(group.frame)];
  LaneBits found = 0;
  for (int i = group.first_core; i < group.last_core && (found & enough) == 0; ++i) {
    const SphereRobot::FloatSphere& core = robot.cores[static_cast<std::size_t>(i)];
    const Vector sure = all(core.radius + robot.padding - robot.slack);
    found |= lanes.active & in_all_lanes([&](std::size_t lane) HWY_ATTR {
               return bits(hn::Lt(sight(field, placed(pose, core, lane)).upper, sure));
             });
  }
  return found;
}

LaneBits find_touching(const SphereRobot& robot, PieceLanes& lanes, LaneBits enough) {
  read_values(robot, lanes.q.data(), lanes.value.data());
  place_frames(robot, lanes.value.data(), lanes.pose.data());
  lanes.are_frames_placed = true;
  LaneBits found = 0;
  for (const SphereRobot::Group& group : robot.groups) {
    const LaneFloats* pose = &lanes.pose[12 * static_cast<std::size_t>(group.frame)];
    if (group.first_core == group.last_core || (near_lanes(robot, group, pose) & lanes.active) == 0) continue;
    found |= pierced_lanes(robot, group, lanes, enough);
    if ((found & enough) != 0) break;
  }
  return found;
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
