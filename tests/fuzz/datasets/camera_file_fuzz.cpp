// libFuzzer on cameras as other tools write them: YAML, XML, JSON and a matrix alone.
#include "datasets/camera_files/camera_file.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int camera_file_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string text(fuzz::as_text(data, size));
  for (const bool is_rectified : {false, true}) {
    fuzz::read_or_refuse([&] {
      std::string note;
      parse_camera_file(text, "fuzzed.yaml", "", is_rectified, ImageSize{640, 480}, {}, &note);
      if (!note.empty()) fuzz::require_sentence(std::runtime_error(note));
    });
  }
  return 0;
}
