// libFuzzer on ScanNet's .sens, but for its JPEG, which is for a library.
#include "datasets/bags/sens_layout.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int sens_layout_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string_view bytes = fuzz::as_text(data, size);
  try {
    const SensLayout layout = read_sens_layout(size, [&](std::uint64_t at, std::size_t count) {
      return at < bytes.size() ? std::string(bytes.substr(at, count)) : std::string();
    });
    if (layout.depth.width > 1000 || layout.depth.height > 1000) return 0;  // for the speed of it
    for (const SensFrame& frame : layout.frames) {
      if (frame.depth.at + frame.depth.size > size || frame.colour.at + frame.colour.size > size)
        std::abort();
      try {
        pgm_of_sens(std::string(bytes.substr(frame.depth.at, frame.depth.size)), layout);
      } catch (const std::runtime_error& error) {
        fuzz::require_sentence(error);
      }
    }
  } catch (const std::runtime_error& error) {
    fuzz::require_sentence(error);
  }
  return 0;
}
