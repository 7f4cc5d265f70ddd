// libFuzzer on plan.json; what is accepted can be written again.
#include "planning/files/plan_file.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int plan_file_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".json");
  return fuzz::read_or_refuse([&] {
    const Plan plan = load_plan(file.write(fuzz::as_text(data, size)));
    static_cast<void>(plan.waypoints());
    static_cast<void>(to_json(plan));
  });
}
