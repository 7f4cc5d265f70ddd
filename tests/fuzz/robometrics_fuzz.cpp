// libFuzzer on problem sets of robometrics and worlds of cuRobo (YAML, JSON).
#include "apps/problem_sets/planning_scene.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int robometrics_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const SceneContext context{load_robot("panda")};
  return fuzz::read_or_refuse([&] {
    const ForeignSet set = read_robometrics(std::string(fuzz::as_text(data, size)), "fuzzed.yaml", context);
    for (const std::string& sentence : set.left_out) fuzz::require_sentence(std::runtime_error(sentence));
  });
}
