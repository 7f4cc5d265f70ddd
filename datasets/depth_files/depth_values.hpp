#pragma once

#include <vector>

#include "datasets/cameras/image_size.hpp"

namespace clearway {

/// A picture of depth, as its file holds it.
struct DepthPicture {
  ImageSize size;
  std::vector<float> values;  ///< row by row; 0: none
  bool is_real = false;  ///< real numbers, of metres if nothing else is stated; else whole ones, of steps
};

}  // namespace clearway
