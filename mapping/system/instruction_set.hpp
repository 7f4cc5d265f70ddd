#pragma once

namespace clearway {

/// Which instructions hot loops use, each including those before it. All give the same result, bit for bit.
enum class InstructionSet { portable, avx2, avx512 };

/// The best that this machine has; avx512 stands for F, BW, DQ and VL.
InstructionSet best_instruction_set();

}  // namespace clearway
