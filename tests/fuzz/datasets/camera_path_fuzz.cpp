// libFuzzer on the ways of cameras as JSON (transforms.json, Open3D's trajectories).
#include "datasets/pictures/camera_path.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int camera_path_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    parse_camera_path(std::string(fuzz::as_text(data, size)), "fuzzed.json",
                      PictureSizes{ImageSize{48, 36}, ImageSize{640, 480}});
  });
}
