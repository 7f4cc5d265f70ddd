#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace clearway {

/// An OctoMap file whose header and seal were checked; its nodes are checked as they are read
/// (octree_reader.hpp).
struct CheckedOctree {
  std::string type;         ///< as the header names it, e.g. OcTree
  bool binary = false;      ///< .bt: free or occupied only
  bool fused = false;       ///< ours: nodes with paint and flags
  std::size_t nodes = 0;    ///< as the header says
  double resolution = 0.0;  ///< metres
  std::string_view header;  ///< with comments
  std::string_view data;
};

/// The header of an OctoMap file, up to the first byte of data; the resolution with every digit.
std::string octree_header(bool binary, std::string_view type, std::size_t nodes, double resolution);

/// The comment that makes a ColorOcTree one of ours: its colours are paint and flags.
inline constexpr std::string_view fused_nodes_comment =
    "# clearway nodes hold the painted volumes and an observed flag where colours would be\n";

/// Checks the header: known type, resolution in [1e-4, 100]; and the seal of a file of ours. A
/// .bt of OctoMap before 1.0, whose header is numbers, has neither type nor comments.
/// @throws DamagedFile naming `file` and what is wrong.
CheckedOctree check_octree(std::string_view bytes, const std::filesystem::path& file);

/// The same of a file of which only the start is in memory: its header and as much as there is of its data.
/// @param is_sealed whether all of the file agrees with its seal; asked of files of ours alone
CheckedOctree check_octree_start(std::string_view start, const std::filesystem::path& file,
                                 const std::function<bool()>& is_sealed);

/// Line 2 of our own files: CRC32 of all other bytes, and the length of the file. Stock readers skip it.
std::string seal_line(std::string_view before, std::string_view after);

/// The line for a CRC32 and a number of bytes.
std::string seal_line(unsigned long checksum, std::size_t length);

/// True when the second line is the right seal for the rest.
bool is_sealed(std::string_view bytes);

}  // namespace clearway
