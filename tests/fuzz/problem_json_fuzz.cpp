// libFuzzer on problem sets as JSON.
#include "apps/problem_sets/planning_scene.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int problem_json_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    const ForeignSet set = read_problem_json(std::string(fuzz::as_text(data, size)), "fuzzed.json");
    for (const std::string& sentence : set.left_out) fuzz::require_sentence(std::runtime_error(sentence));
  });
}
