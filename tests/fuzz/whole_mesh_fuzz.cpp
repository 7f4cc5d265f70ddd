// libFuzzer on our own look at mesh files, before assimp gets them. The first byte chooses the kind.
#include "planning/robot_files/collada_check.hpp"
#include "planning/robot_files/mesh_numbers.hpp"
#include "planning/robot_files/whole_mesh.hpp"

#include <array>

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int whole_mesh_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static constexpr std::array kinds = {"ply", "stl", "obj", "dae"};
  if (size == 0) return 0;
  try {
    const std::string content(fuzz::as_text(data + 1, size - 1)), kind = kinds[data[0] % kinds.size()];
    check_mesh_is_whole(content, kind);
    if (kind == "ply") {
      check_numbers_of_ply(content);
      vertices_of_ply(plain_ply(content));
    }
    if (kind == "stl") plain_stl(content);
    if (kind == "obj") vertices_of_obj(plain_obj(content));
    if (kind == "dae") checked_collada(content);
  } catch (const std::runtime_error& error) {
    fuzz::require_sentence(error);
  }
  return 0;
}
