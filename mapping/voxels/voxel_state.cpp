#include "mapping/voxels/voxel_state.hpp"

#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {

bool allows(const Requirement& requirement, VoxelState state, std::uint16_t mask) {
  if (state == VoxelState::occupied || state == VoxelState::conflict) return false;
  switch (requirement.policy) {
    case Policy::painted:
      return (mask & requirement.volumes) != 0;
    case Policy::known_free:
      return state == VoxelState::painted || state == VoxelState::seen_free;
    case Policy::not_occupied:
      return true;
  }
  return false;
}

std::string_view to_string(VoxelState state) {
  switch (state) {
    case VoxelState::unknown:
      return "unknown";
    case VoxelState::seen_free:
      return "seen_free";
    case VoxelState::painted:
      return "painted";
    case VoxelState::occupied:
      return "occupied";
    case VoxelState::conflict:
      return "conflict";
  }
  return "unknown";
}

std::string_view to_string(Policy policy) {
  switch (policy) {
    case Policy::painted:
      return "painted";
    case Policy::known_free:
      return "known_free";
    case Policy::not_occupied:
      return "not_occupied";
  }
  return "not_occupied";
}

Policy parse_policy(std::string_view text) {
  for (Policy policy : {Policy::painted, Policy::known_free, Policy::not_occupied}) {
    if (text == to_string(policy)) return policy;
  }
  throw std::invalid_argument("unknown policy " + quote(text) +
                              ": expected painted, known_free or not_occupied");
}

}  // namespace clearway
