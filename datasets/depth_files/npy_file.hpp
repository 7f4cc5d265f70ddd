#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "datasets/depth_files/depth_values.hpp"

namespace clearway {

/// Whether these are the bytes of a NumPy array (.npy).
bool is_npy(const std::string& bytes);

/// A picture of one number a pixel as numpy.save writes it (numpy.lib.format, versions 1 to 3): rows and
/// columns, or these and a third axis of one entry before or behind; whole numbers of 8 to 64 bits or real
/// ones of 16 to 64, in either order of bytes. @throws std::runtime_error a clause that says why it is none
DepthPicture decode_npy(const std::string& bytes);

/// An array of numbers of any shape.
struct NpyNumbers {
  std::vector<std::int64_t> shape;
  std::string shape_text;      ///< "12 x 4 x 4"
  std::string type;            ///< as NumPy calls it, without the order of bytes: "f4"
  std::vector<double> values;  ///< in the order of C, whatever the file's is
};

/// @param most numbers that it may hold @throws std::runtime_error a clause that says why it is none
NpyNumbers decode_npy_numbers(const std::string& bytes, std::size_t most);

}  // namespace clearway
