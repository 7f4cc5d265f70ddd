// libFuzzer on poses as arrays of NumPy.
#include "datasets/depth_files/npy_poses.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int pose_arrays_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string bytes(fuzz::as_text(data, size));
  return fuzz::read_or_refuse([&] {
    for (const auto& [number, pose] : parse_npy_poses(bytes, "fuzzed.npy").poses)
      if (pose && !(pose->linear() * pose->linear().transpose()).isIdentity(1e-9)) std::abort();
  });
}
