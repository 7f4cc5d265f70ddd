// libFuzzer on tables of joint positions over time (CSV).
#include "datasets/sources/joint_stream.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int joint_states_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    const JointStream stream = parse_joint_states(std::string(fuzz::as_text(data, size)), "fuzzed.csv", 0.5);
    if (const auto last = stream.last_time()) static_cast<void>(stream.at(stream.names(), *last));
  });
}
