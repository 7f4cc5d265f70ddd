// libFuzzer on suites (YAML).
#include "datasets/descriptions/suite.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int suite_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] { parse_suite(std::string(fuzz::as_text(data, size)), "fuzzed.yaml"); });
}
