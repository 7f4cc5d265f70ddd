#include "mapping/system/instruction_set.hpp"

namespace clearway {
namespace {

InstructionSet detected() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return InstructionSet::avx512;
  if (__builtin_cpu_supports("avx2")) return InstructionSet::avx2;
#endif
  return InstructionSet::portable;
}

}  // namespace

InstructionSet best_instruction_set() {
  static const InstructionSet best = detected();
  return best;
}

}  // namespace clearway
