// libFuzzer on matrices of cameras that lie beside pictures, each called as its picture is.
#include "datasets/cameras/picture_matrices.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int picture_matrix_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFolder folder("matrices");
  folder.write("1.txt", fuzz::as_text(data, size));
  return fuzz::read_or_refuse([&] {
    for (const CameraIntrinsics& camera : cameras_of_matrices(folder.path(), {"1.png"}, ImageSize{640, 480}))
      if (!(camera.fx > 0.0 && camera.fy > 0.0)) std::abort();
  });
}
