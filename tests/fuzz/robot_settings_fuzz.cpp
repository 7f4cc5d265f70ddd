// libFuzzer on the settings beside a robot file (YAML).
#include "planning/robot_files/robot_settings.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int robot_settings_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".yaml");
  return fuzz::read_or_refuse([&] { read_robot_settings(file.write(fuzz::as_text(data, size))); });
}
