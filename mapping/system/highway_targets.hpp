#pragma once

// Which instruction sets Highway compiles for: those of InstructionSet. Included before hwy/foreach_target.h
// by each file
// *_lanes.cpp, which Highway includes once more for each of them. best_instruction_set() chooses at run time;
// Highway's library, which would choose among more, is neither needed nor linked.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4)
// best_instruction_set() does not ask for these.
#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLE_F16C
#define HWY_DISABLE_BMI2_FMA
