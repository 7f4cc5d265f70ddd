#include "datasets/simulation/tag_pattern.hpp"

#include <apriltag.h>
#include <tag36h11.h>

#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

namespace clearway {

std::array<bool, 100> tag36h11_cells(int id) {
  const std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)> family(tag36h11_create(),
                                                                               tag36h11_destroy);
  if (id < 0 || static_cast<uint32_t>(id) >= family->ncodes)
    throw std::invalid_argument("tag " + std::to_string(id) + " is not in tag36h11; expected 0 to " +
                                std::to_string(family->ncodes - 1) + ".");
  image_u8_t* image = apriltag_to_image(family.get(), static_cast<uint32_t>(id));
  std::array<bool, 100> cells{};
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 10; ++column)
      cells[static_cast<size_t>(10 * row + column)] = image->buf[row * image->stride + column] > 127;
  std::free(image->buf);  // Debian's library does not export image_u8_destroy
  std::free(image);
  return cells;
}

}  // namespace clearway
