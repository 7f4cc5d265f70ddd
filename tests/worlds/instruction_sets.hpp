#pragma once

#include <vector>

#include "mapping/system/instruction_set.hpp"

namespace clearway::worlds {

/// All instruction sets that this machine can run.
inline std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> sets{InstructionSet::portable};
  if (best_instruction_set() >= InstructionSet::avx2) sets.push_back(InstructionSet::avx2);
  if (best_instruction_set() >= InstructionSet::avx512) sets.push_back(InstructionSet::avx512);
  return sets;
}

}  // namespace clearway::worlds
