// libFuzzer on MoveIt's text of scenes (.scene).
#include "apps/problem_sets/planning_scene.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int scene_text_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse(
      [&] { read_scene_text(std::string(fuzz::as_text(data, size)), "fuzzed.scene", {}); });
}
