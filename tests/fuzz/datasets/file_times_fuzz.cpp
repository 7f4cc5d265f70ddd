// libFuzzer on tables of pictures' times, TUM's associations among them.
#include "datasets/pictures/picture_times.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int file_times_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string text(fuzz::as_text(data, size));
  fuzz::read_or_refuse([&] { parse_associations(text, "associations.txt"); });
  return fuzz::read_or_refuse([&] { parse_file_times(text, "fuzzed.csv"); });
}
