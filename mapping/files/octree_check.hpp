#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace clearway {

/// An OctoMap file whose header and seal were checked; its nodes are checked as they are read
/// (octree_reader.hpp).
struct CheckedOctree {
  std::string type;         ///< as the header names it, e.g. OcTree
  bool binary = false;      ///< .bt: free or occupied only
  std::size_t nodes = 0;    ///< as the header says
  double resolution = 0.0;  ///< metres
  std::string_view header;  ///< with comments
  std::string_view data;
};

/// The header of an OctoMap file, up to the first byte of data; the resolution with every digit.
std::string octree_header(bool binary, std::string_view type, std::size_t nodes, double resolution);

/// Checks the header: known type, resolution in [1e-4, 100]; and the seal of a file of ours.
/// @throws DamagedFile naming `file` and what is wrong.
CheckedOctree check_octree(std::string_view bytes, const std::filesystem::path& file);

/// Line 2 of our own files: CRC32 of all other bytes, and the length of the file. Stock readers skip it.
std::string seal_line(std::string_view before, std::string_view after);

/// True when the second line is the right seal for the rest.
bool is_sealed(std::string_view bytes);

}  // namespace clearway
