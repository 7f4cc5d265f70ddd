#pragma once

// Not part of the installed library.

#include <cstdint>
#include <vector>

#include "mapping/system/instruction_set.hpp"
#include "planning/batch/lanes.hpp"
#include "planning/batch/sphere_robot.hpp"

namespace clearway {

/// Pieces of edges that are looked at side by side: lanes. On each piece the joints move at constant speed
/// from `q - step` to `q + step`; a piece without a step is one configuration.
struct PieceLanes {
  static constexpr int count = lane_count;
  using Floats = LaneFloats;
  using Doubles = LaneDoubles;
  using Lanes = LaneBits;

  explicit PieceLanes(const SphereRobot& robot);

  // What is asked.
  std::vector<Doubles> q, step;  ///< of each joint: in the middle, and from there to the end
  std::vector<Floats> bend;  ///< of each frame: how far any sphere's middle leaves the straight way that it
                             ///< is on in the middle of the piece, at most, metres
  std::vector<Floats> pair_bend;  ///< of each pair of frames, the same of both, seen from where they meet
  std::vector<Floats> approach;   ///< of each pair of frames: how much spheres of it approach at most, metres
  Lanes active = 0;               ///< lanes in use
  std::vector<Lanes> wanted;      ///< of each member: the lanes in which it is asked for
  Lanes enough = 0;  ///< when one of these is blocked nothing else is asked: the rest may be left out then
  bool all_or_nothing = false;     ///< the same when one of these is stuck
  bool moving = true;              ///< false: all steps are zero
  bool are_frames_placed = false;  ///< `pose` is that of `q`: look() need not find it

  // What was found.
  Lanes blocked = 0;          ///< in the middle some body surely touches what blocks it, or another body
  Lanes stuck = 0;            ///< spheres stand out too far to prove it on a shorter piece about the middle
  std::vector<Lanes> failed;  ///< of each member: the lanes in which it was not proved free
  std::vector<int> members;   ///< those of which some lane failed

  /// The lanes in which some member was not proved free.
  Lanes failing() const;

  /// Asks for all members in the first lanes.
  void want_all(int lanes);
  /// Asks for nothing, before `want`.
  void want_none();
  void want(int member, int lane) {
    wanted[static_cast<std::size_t>(member)] |= static_cast<Lanes>(1U << lane);
  }

  // Memory of look().
  std::vector<Floats> value, motion;  ///< of each frame: of its joint
  std::vector<Floats> pose;           ///< of each frame: 9 rows of its rotation, 3 of its place
  std::vector<Floats> twist;          ///< of each frame: turn, then velocity of what is at the base
  std::vector<Floats> middle;         ///< of each frame: of the sphere about its spheres, as below
  std::vector<Floats> place;          ///< of each sphere: x, y, z about the base
  std::vector<Lanes> is_placed;       ///< of each sphere: a bit a register
};

/// Fills in what was found: by spheres and fields alone, so never more than is true. The same bits on every
/// machine.
void look(const SphereRobot& robot, PieceLanes& lanes);
/// The same with the given instruction set, which the machine must support.
void look(const SphereRobot& robot, PieceLanes& lanes, InstructionSet vectors);

}  // namespace clearway
