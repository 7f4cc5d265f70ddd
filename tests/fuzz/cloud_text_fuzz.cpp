// libFuzzer on our own look at .pcd and .ply clouds, and what we change in them, before PCL gets them. The
// first byte chooses the kind.
#include <array>

#include "mapping/files/ply_header.hpp"
#include "mapping/files/text_cloud.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

namespace {

template <typename Read>
void clause_or_nothing(const Read& read) {
  try {
    read();
  } catch (const std::runtime_error& error) {  // a clause
    clearway::fuzz::require_sentence(error);
  }
}

}  // namespace

extern "C" int cloud_text_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile pcd(".pcd"), ply(".ply");
  if (size == 0) return 0;
  const bool is_pcd = data[0] % 2 == 0;
  const std::string content(fuzz::as_text(data + 1, size - 1));
  clause_or_nothing([&] { check_data_of_cloud((is_pcd ? pcd : ply).write(content), is_pcd); });
  if (is_pcd) return 0;
  clause_or_nothing([&] {
    const PlyHeader header = ply_header(content);
    static_cast<void>(has_odd_colours(header) || has_scan_grid(header, content) || has_vertex_lists(header));
    clause_or_nothing([&] { bytes_of_elements(header, std::string_view(content).substr(header.length)); });
    clause_or_nothing([&] { as_pcl_reads_rightly(content); });
    clause_or_nothing([&] { without_vertex_lists(content); });
    clause_or_nothing([&] { ply_camera(content); });
    ply_vertices(header);
  });
  return 0;
}
