// libFuzzer on pose files (TUM).
#include "datasets/poses/tum_poses.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int pose_stream_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse(
      [&] { parse_tum_poses(std::string(fuzz::as_text(data, size)), "fuzzed.tum", 0.5); });
}
