// libFuzzer on provenance.bin with its seal put right. What is accepted reads back the same.
#include "mapping/history/provenance.hpp"

#include "tests/fuzz/fuzzed_input.hpp"
#include "tests/worlds/bytes/resealed.hpp"

extern "C" int provenance_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    const std::string bytes = resealed(std::string(fuzz::as_text(data, size)));
    const std::string again = format_provenance(parse_provenance(bytes, "fuzzed.bin"));
    if (format_provenance(parse_provenance(again, "again.bin")) != again) std::abort();
  });
}
