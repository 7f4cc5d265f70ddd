// libFuzzer on clouds as text.
#include "mapping/files/xyz_file.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int xyz_file_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".xyz");
  return fuzz::read_or_refuse([&] { read_xyz_file(file.write(fuzz::as_text(data, size))); });
}
