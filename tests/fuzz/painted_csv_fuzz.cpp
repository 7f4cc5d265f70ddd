// libFuzzer on painted.csv.
#include "mapping/files/painted_csv.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int painted_csv_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    const auto volumes = parse_painted(fuzz::as_text(data, size), "fuzzed.csv");
    const std::string again = format_painted(volumes);  // what was accepted reads back the same
    if (format_painted(parse_painted(again, "again.csv")) != again) std::abort();
  });
}
