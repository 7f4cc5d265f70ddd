// libFuzzer on setups (YAML).
#include "datasets/descriptions/setup.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int setup_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] { parse_setup(std::string(fuzz::as_text(data, size)), "fuzzed.yaml"); });
}
