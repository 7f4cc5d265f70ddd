// libFuzzer on tables of pictures' times.
#include "datasets/pictures/picture_times.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse(
      [&] { parse_file_times(std::string(fuzz::as_text(data, size)), "fuzzed.csv"); });
}
