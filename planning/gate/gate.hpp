#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "mapping/latest_snapshot.hpp"
#include "planning/gate/motion_chunk.hpp"
#include "planning/gate/voxel_evidence.hpp"
#include "planning/space/configuration_space.hpp"

namespace clearway {

/// Limits and tolerances of a gate.
struct GateOptions {
  MotionLimits limits = {};                           ///< of velocity and braking
  double tolerance = 1e-3;                            ///< of where a chunk starts, each joint, rad or m, >= 0
  std::optional<Configuration> start = std::nullopt;  ///< of the first chunk; none: anywhere
  /// The newest map's `taken` may lie at most so many seconds before a chunk's first time, and after it: then
  /// both are of one clock. Infinite: unlimited.
  double max_age = std::numeric_limits<double>::infinity();
  std::vector<std::string> allow_outside = {};  ///< parts that may leave the map's bounds; "all": every part
};

/// One of the straight edges that have to be proved.
struct MotionPiece {
  enum class Kind {
    joining,  ///< from where the robot is to the first configuration, where they differ
    edge,     ///< from configuration `waypoint` to the next
    braking   ///< straight on from configuration `waypoint`, until the robot stands
  };
  Kind kind = Kind::edge;
  std::size_t waypoint = 0;
};
std::string to_text(const MotionPiece& piece);  ///< "from positions[3] to positions[4]"

/// How far a motion may go: up to `position` at `time`; braking from there it stands at `stop`.
struct ProvedPart {
  double time = 0.0;
  Configuration position, stop;
};

/// The answer to one chunk.
struct GateVerdict {
  GateReason reason = GateReason::none;  ///< none: the chunk is passed
  std::string sentence{};                ///< why it is refused; empty when passed
  std::uint64_t map = 0;                 ///< number of the map that judged; 0: none
  /// Of a chunk that was passed, all of it. Of one whose motion is not proved, a first part: the chunk of the
  /// configurations before `time` and of `position` would be passed. Not the farthest to the last digit.
  /// None: not even the first step.
  std::optional<ProvedPart> may_go{};

  // Of one whose motion is not proved:
  std::optional<MotionPiece> piece{};       ///< the first that is not
  double parameter = 0.0;                   ///< 0..1 along it: so far it is proved
  Verdict obstruction{};                    ///< there: which body, which voxel, joint or other body
  std::optional<VoxelEvidence> evidence{};  ///< where that voxel comes from

  bool is_passed() const { return reason == GateReason::none; }
};

/// Judges what other programs want an arm to do, chunk by chunk, against the newest map: a chunk is passed
/// only when all of its motion, and a way to stop after it, is proved free by
/// ConfigurationSpace::is_edge_free.
///
/// The motion. Straight joint-space edges join the configurations, each joint at a constant rate on each. All
/// configurations on them are proved, whenever they are taken. So a receiver must interpolate linearly in the
/// joints, at the chunk's times or slower, and start a chunk only where and when the last one ends, where
/// it says that it leaves that, or at rest. What it deviates by (blended corners, splines, control errors) is
/// the padding's: bodies stay clear of voxels as long as no point of them is farther than the padding from
/// where the edges have it. Towards other bodies of the robot there is no such margin.
///
/// The stop. A robot that gets no further chunk goes on at the last edge's velocity for the reaction time,
/// then brakes along that direction, all joints in proportion, and stands at stop_from(...). That edge is
/// proved as well; so is, at each configuration where the rates change by more than the joints can, the way
/// straight on. So at every moment there is a proved way to stop: run the chunk to its end and brake; or slow
/// down the chunk's clock, anywhere, which leaves the edges nowhere, slows no joint by more than its
/// deceleration on any of them, and ends at the latest where the stop after the end ends. Where a chunk
/// leaves the last one and the rates change by more than the joints can, the way straight on is proved, too.
/// Drives that brake each joint by itself leave the edges: only the padding stands for that.
///
/// The bounds. A part with the policy `not_occupied` must not leave the map's bounds (survey_path) anywhere
/// on these edges, unless `allow_outside` names it: of what is beyond them nothing is known.
///
/// The next chunk starts, within the tolerance, where the last passed one ends, or where the robot stands
/// after it; by whole turns of joints without limits it may differ, as encoders wrap between chunks, but not
/// within one: there a wrap is a turn back. What the tolerance leaves open is proved, too, from both where
/// both are within it. Who leaves a passed chunk at one of its configurations for the next chunk, as
/// controllers with a receding horizon do, says at which. Times of one chunk are not compared with those of
/// another. A refused chunk must not be run, not even in part: send the part as a chunk of its own. Positions
/// that single precision took beyond a joint's limit count as at it.
///
/// Not promised: what was passed is not judged again when the map changes; velocities from one chunk to the
/// next may jump (the stop after the last one is proved); no bound on the time that a verdict takes near
/// obstacles. The same chunks and maps give the same verdicts, byte for byte.
///
/// One thread publishes maps, one judges: judging waits for nothing but the exchange of a pointer, and old
/// maps are taken apart by the publishing thread.
class Gate {
 public:
  /// @throws std::invalid_argument for a tolerance below 0, a max_age that is not above 0, limits out of
  /// range, or a start that is not finite
  explicit Gate(GateOptions options = {});
  ~Gate();
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;

  /// Makes `space` the newest map. Returns its number, 1, 2, ...
  /// @param taken when its newest look was, seconds, by the clock of the chunks; only max_age asks for it
  /// @param history of the map, for what refusals say of a voxel; may be null
  /// @throws std::invalid_argument, and changes nothing, when options do not fit its robot, or the robot has
  /// other joints than that of the map before.
  std::uint64_t publish(ConfigurationSpace space, double taken = 0.0,
                        std::shared_ptr<const Provenance> history = nullptr);

  /// Judges a chunk, and remembers where the robot is after one that is passed.
  /// @param leaves_at the configuration of the last passed chunk, counted from 0, at which the robot leaves
  /// that for this one: then this one starts there, and the rest of that is not run. None: at its end, or
  /// where the robot stands after it
  /// @throws std::invalid_argument when what `restart` was given does not fit the map's robot
  GateVerdict judge(const MotionChunk& chunk, std::optional<std::size_t> leaves_at = std::nullopt);

  /// The robot was moved by other means: it stands at `start`; none: anywhere.
  /// @throws std::invalid_argument, and changes nothing, when `start` does not fit the robot of the newest
  /// map
  void restart(std::optional<Configuration> start = std::nullopt);

 private:
  struct Map;

  /// Where the robot may be when a chunk begins, beside the first of its configurations.
  std::vector<Configuration> places_for(const Map& map, const MotionChunk& chunk,
                                        std::optional<std::size_t> leaves_at) const;
  GateVerdict judge_on(const Map& map, const MotionChunk& chunk, std::optional<std::size_t> leaves_at);

  GateOptions options_;
  Latest<Map> maps_;
  std::uint64_t published_ = 0;             ///< the publishing thread's
  std::vector<Configuration> standing_;     ///< where the next chunk may start; none: anywhere
  MotionChunk passed_;                      ///< the last one; empty: none was passed since restart
  std::optional<Configuration> gripped_{};  ///< since the start: where the joints that hold loads stand
};

}  // namespace clearway
