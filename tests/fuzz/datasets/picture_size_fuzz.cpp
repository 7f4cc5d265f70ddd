// libFuzzer on what the heads of JPEG, PGM and PNG say of their sizes, and on where a JPEG ends.
#include "datasets/pictures/picture_file.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int picture_size_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".picture");
  const std::string bytes(fuzz::as_text(data, size));
  static_cast<void>(is_whole(bytes));
  const auto sides = picture_size(file.write(bytes));
  const auto is_side = [](int side) { return side >= 1 && side <= longest_side; };
  if (sides && !(is_side(sides->width) && is_side(sides->height))) std::abort();
  return 0;
}
