// libFuzzer on poses without times: matrices of KITTI, Redwood and others, TartanAir's lines.
#include "datasets/poses/numbered_poses.hpp"

#include "datasets/poses/ned_poses.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int numbered_poses_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string text(fuzz::as_text(data, size));
  return fuzz::read_or_refuse([&] {
    if (is_ned_poses("pose_left.txt", text))
      parse_ned_poses(text, "fuzzed.txt");
    else
      parse_numbered_poses(text, "fuzzed.txt");
  });
}
