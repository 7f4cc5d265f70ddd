// libFuzzer on Stray Scanner's poses and camera.
#include "datasets/pictures/stray_folder.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int stray_poses_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile camera(".csv");
  const std::string text(fuzz::as_text(data, size));
  fuzz::read_or_refuse([&] { stray_camera(camera.write(text), ImageSize{256, 192}); });
  return fuzz::read_or_refuse([&] {
    if (const auto poses = parse_stray_poses(text, "odometry.csv"))
      for (const auto& [number, pose] : poses->poses)
        if (!pose || !pose->matrix().allFinite()) std::abort();
  });
}
