// libFuzzer on trajectories of other programs that `check` reads: YAML, or JSON where it begins so.
#include "apps/check/trajectory_file.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int check_trajectory_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile yaml(".yaml"), json(".json");
  const std::string_view text = fuzz::as_text(data, size);
  return fuzz::read_or_refuse([&] { read_trajectories((text.starts_with('{') ? json : yaml).write(text)); });
}
