#include "mapping/system/instruction_set.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace clearway {
namespace instruction_set_test {

/// What Linux says of the first core.
bool has_flag(const std::string& wanted) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      if (word == wanted) return true;
    }
    return false;
  }
  return false;
}

TEST(InstructionSet, IsTheBestThatTheKernelNames) {
  const bool has_avx512 =
      has_flag("avx512f") && has_flag("avx512bw") && has_flag("avx512dq") && has_flag("avx512vl");
  const InstructionSet expected = has_avx512         ? InstructionSet::avx512
                                  : has_flag("avx2") ? InstructionSet::avx2
                                                     : InstructionSet::portable;
  EXPECT_EQ(best_instruction_set(), expected);
}

}  // namespace instruction_set_test
}  // namespace clearway
