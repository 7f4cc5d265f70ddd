// libFuzzer on the reader of OctoMap files. What is accepted is written again as a file of ours, which must
// read back as the same tree.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "tests/worlds/bytes/resealed.hpp"

namespace {

using clearway::DamagedFile;
using clearway::OctreeContent;

/// A file of our type with the right seal.
std::string sealed(const std::string& bytes) {
  const bool is_ours = bytes.find("id ClearwayFusedTree") != std::string::npos ||
                       bytes.find("\n# clearway ") != std::string::npos;
  return is_ours ? clearway::resealed(bytes) : bytes;
}

}  // namespace

extern "C" int map_file_fuzz(const std::uint8_t* data, std::size_t size) {
  const std::string bytes = sealed({reinterpret_cast<const char*>(data), size});
  try {
    const OctreeContent content = clearway::parse_octree(bytes, "fuzzed.ot");
    const std::string again = clearway::format_fused_tree(*content.tree, content.volumes);
    const OctreeContent same = clearway::parse_octree(again, "again.ot");
    if (!(*same.tree == *content.tree) || clearway::format_fused_tree(*same.tree, same.volumes) != again) {
      std::abort();
    }
    if (!content.has_volumes &&
        !clearway::parse_octree(clearway::format_binary_tree(*content.tree), "a.bt").tree) {
      std::abort();
    }
  } catch (const DamagedFile&) {
  }
  return 0;
}
