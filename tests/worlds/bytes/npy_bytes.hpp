#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace clearway {

/// An array as numpy.save writes it.
/// @param shape as Python says it: "(2, 4, 4)" @param values in the order of the file
template <typename Number>
std::string npy_bytes(const std::string& type, const std::string& shape, const std::vector<Number>& values,
                      bool is_fortran = false) {
  std::string head = "{'descr': '" + type + "', 'fortran_order': " + (is_fortran ? "True" : "False") +
                     ", 'shape': " + shape + ", }";
  head.resize(117, ' ');
  std::string data(values.size() * sizeof(Number), '\0');
  std::memcpy(data.data(), values.data(), data.size());
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + head + "\n" + data;
}

}  // namespace clearway
