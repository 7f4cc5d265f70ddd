#pragma once

#include <array>

namespace clearway {

/// The cells of a tag36h11 tag as one sees it, row by row from the top left: 10 x 10, the outer ring is the
/// white quiet zone, the next one the black border (whose outer edge is the tag's `size`). True is white.
/// @throws std::invalid_argument when the family has no such id.
std::array<bool, 100> tag36h11_cells(int id);

}  // namespace clearway
