// libFuzzer on the reader of OctoMap files (cmake --preset fuzz; clang-14 and libclang-rt-14-dev):
//   build/fuzz/bin/map_file_fuzz -max_total_time=300 -rss_limit_mb=2048 CORPUS_FOLDER
// What is accepted is written again as a file of ours, which must read back as the same tree.

#include <cstdint>
#include <cstdlib>
#include <string>

#include "mapping/files/map_file.hpp"
#include "mapping/files/octree_check.hpp"
#include "mapping/files/octree_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace {

using clearway::DamagedFile;
using clearway::OctreeContent;

/// A fuzzer cannot guess a checksum: gives a file of our type the right seal, so that what is behind it is
/// reached.
std::string sealed(const std::string& bytes) {
  const auto first = bytes.find('\n');
  if (first == std::string::npos || (bytes.find("id ClearwayFusedTree") == std::string::npos &&
                                     bytes.find("\n# clearway ") == std::string::npos))
    return bytes;
  const std::string before = bytes.substr(0, first + 1);
  std::string after = bytes.substr(first + 1);
  if (after.starts_with("# clearway seal")) after.erase(0, after.find('\n') + 1);
  return before + clearway::seal_line(before, after) + after;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
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
