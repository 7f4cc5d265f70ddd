// libFuzzer on depth as arrays of NumPy and as PFM, and on the heads of TIFF.
#include "datasets/pictures/depth_picture.hpp"

#include "datasets/depth_files/npy_file.hpp"
#include "datasets/depth_files/tiff_numbers.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int depth_picture_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  const std::string bytes(fuzz::as_text(data, size));
  if (with_signed_numbers(bytes).size() < bytes.size()) std::abort();
  if (!is_npy(bytes) && !bytes.starts_with("Pf")) return 0;  // others are for libraries
  try {
    const DepthPicture picture = decode_depth_picture(bytes);
    if (picture.values.size() != std::size_t(picture.size.width) * std::size_t(picture.size.height))
      std::abort();
  } catch (const std::runtime_error& error) {
    fuzz::require_sentence(error);
  }
  return 0;
}
