// libFuzzer on scenes (YAML).
#include "datasets/descriptions/scene.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int scene_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse(
      [&] { parse_scene(std::string(fuzz::as_text(data, size)), "fuzzed.yaml", "/nonexistent"); });
}
