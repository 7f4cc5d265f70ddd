#pragma once

#include <cstddef>
#include <cstdint>

#include "mapping/system/instruction_set.hpp"

namespace clearway {

/// The numbers of ByteField for squared distances in half voxels: out[i] = min(1 + floor(units / 2 *
/// sqrt(squared[i])), 255), exactly. @pre `count` is a multiple of 64, squared[i] <= largest_cap, units <= 16
void number_bytes(const std::uint16_t* squared, std::size_t count, int units, InstructionSet vectors,
                  std::uint8_t* out);

}  // namespace clearway
