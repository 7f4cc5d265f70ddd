#pragma once

// Not part of the installed library.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mapping/system/instruction_set.hpp"
#include "planning/batch/lanes.hpp"
#include "planning/batch/sphere_robot.hpp"

namespace clearway {

/// Poses of one frame, or of one frame seen from another, at those configurations of a block that are still
/// open where it is asked: side by side without gaps.
struct PackedPoses {
  static constexpr std::size_t most = 1024;
  alignas(64) float rows[12][most + lane_count];  ///< 9 of the rotation, 3 of the place
  std::int32_t place[most + lane_count];          ///< of each: which configuration of the block
  std::size_t count = 0;
};

/// Configurations that are looked at together, sixteen side by side. A sphere around much is looked up first;
/// only where it is not proved clear those inside it are, and the configurations that are left are packed
/// together for that.
struct ConfigurationBlock {
  static constexpr std::size_t most = PackedPoses::most;
  using Places = std::array<std::uint64_t, most / 64>;  ///< a bit for each configuration

  explicit ConfigurationBlock(const SphereRobot& robot);

  /// Adds a configuration that the robot `suits`. @pre count < most
  void add(const Configuration& q);
  void clear() { count = 0; }

  // What is asked.
  std::size_t count = 0;
  std::vector<LaneDoubles> q;  ///< [row of lanes * joints + joint]

  // What was found.
  Places blocked{};            ///< some body surely touches what blocks it, or another body
  std::vector<Places> failed;  ///< of each member: where it was not proved free, of what is not blocked
  std::vector<int> members;    ///< those that failed somewhere

  static bool holds(const Places& places, std::size_t i) { return (places[i / 64] >> (i % 64) & 1U) != 0; }
  /// Forgets what was found before.
  void forget();
  /// Takes what is blocked out of `failed`.
  void leave_out_blocked();
  /// Where some member was not proved free.
  Places failing() const;
  /// How many are neither proved free nor known to be blocked.
  std::size_t undecided() const;

  // Memory of look(), as much as was needed so far.
  std::vector<LaneFloats> value, pose;              ///< [row of lanes * ...]: as in PieceLanes
  std::vector<LaneFloats> middle;                   ///< [row of lanes * ...]: of branches
  std::vector<std::unique_ptr<PackedPoses>> packs;  ///< one for each level of a tree
  PackedPoses& pack(std::size_t level) {
    if (!packs[level]) packs[level] = std::make_unique<PackedPoses>();
    return *packs[level];
  }
  struct Doubt {  ///< spheres that the field's own cell does not prove clear
    static constexpr std::size_t most = PackedPoses::most;
    alignas(64) float x[most + lane_count], y[most + lane_count], z[most + lane_count];
    std::int32_t place[most + lane_count], leaf[most + lane_count];
    std::size_t count = 0;
  };
  std::vector<Doubt> doubts;  ///< one

 private:
  void make_room(std::size_t rows);

  std::size_t joints_, frames_, branches_;  ///< of the robot
};

/// Fills in what was found: by spheres and fields alone, so never more than is true. The same for each
/// configuration on every machine and whatever is beside it.
void look(const SphereRobot& robot, ConfigurationBlock& block);
/// The same with the given instruction set, which the machine must support.
void look(const SphereRobot& robot, ConfigurationBlock& block, InstructionSet vectors);

}  // namespace clearway
