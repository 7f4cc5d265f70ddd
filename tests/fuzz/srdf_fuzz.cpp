// libFuzzer on groups, states and exempt pairs (SRDF).
#include "planning/robot_files/srdf_file.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int srdf_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".srdf");
  return fuzz::read_or_refuse([&] { read_srdf(file.write(fuzz::as_text(data, size))); });
}
