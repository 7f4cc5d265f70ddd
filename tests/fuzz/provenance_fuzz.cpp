// libFuzzer on provenance.bin.
#include "mapping/history/provenance.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] { parse_provenance(fuzz::as_text(data, size), "fuzzed.bin"); });
}
