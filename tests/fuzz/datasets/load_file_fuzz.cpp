// libFuzzer on loads and picks (YAML), and on the points of a hull.
#include "datasets/descriptions/load_setup.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int load_file_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".yaml"), hull(".hull"), of_hull(".load");
  const std::filesystem::path& points = hull.write(fuzz::as_text(data, size));
  of_hull.write("name: a\nlink: l\nhull: " + points.string() + "\n");
  const std::filesystem::path& text = file.write(fuzz::as_text(data, size));
  fuzz::read_or_refuse([&] { load_load(text); });
  fuzz::read_or_refuse([&] { load_pick(text); });
  return fuzz::read_or_refuse([&] { load_load(of_hull.path()); });
}
