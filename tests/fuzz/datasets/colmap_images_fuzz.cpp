// libFuzzer on COLMAP's images, as text and binary.
#include "datasets/cameras/colmap_images.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int colmap_images_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string text(fuzz::as_text(data, size));
  if (!is_colmap_images(text)) return 0;
  return fuzz::read_or_refuse([&] {
    for (const ColmapImage& image : parse_colmap_images(text, "fuzzed"))
      if (image.name.empty() || !image.world_from_camera.matrix().allFinite()) std::abort();
  });
}
