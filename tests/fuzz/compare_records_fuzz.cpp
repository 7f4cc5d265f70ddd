// libFuzzer on the records of a comparison (runs.jsonl). What is written of them is read back alike.
#include "apps/results/compare_records.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int compare_records_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".jsonl");
  return fuzz::read_or_refuse([&] {
    const std::string written = CompareRecords::read(file.write(fuzz::as_text(data, size))).text();
    if (CompareRecords::read(file.write(written)).text() != written) std::abort();
  });
}
