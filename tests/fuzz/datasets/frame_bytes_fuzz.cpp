// libFuzzer on what a decoding child hands over, which may be a crashing child's last words.
#include "datasets/sources/frame_bytes.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int frame_bytes_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  try {
    const std::string again = frame_to_bytes(frame_from_bytes(fuzz::as_text(data, size)));
    if (frame_to_bytes(frame_from_bytes(again)) != again) std::abort();
  } catch (const std::runtime_error& error) {
    fuzz::require_sentence(error);
  }
  return 0;
}
