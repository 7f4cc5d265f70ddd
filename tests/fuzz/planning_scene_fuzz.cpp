// libFuzzer on planning scenes and motion requests of MoveIt (YAML).
#include "apps/problem_sets/planning_scene.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int planning_scene_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string text(fuzz::as_text(data, size));
  std::vector<std::string> left_out;
  fuzz::read_or_refuse([&] {
    if (kind_of_scene_file(text, "fuzzed.yaml") == SceneFileKind::request)
      read_motion_request(text, "fuzzed.yaml", {}, {}, left_out);
    else
      read_planning_scene(text, "fuzzed.yaml", {}, left_out);
  });
  for (const std::string& sentence : left_out) fuzz::require_sentence(std::runtime_error(sentence));
  return 0;
}
