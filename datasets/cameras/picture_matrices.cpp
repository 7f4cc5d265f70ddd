#include "datasets/cameras/picture_matrices.hpp"

#include <stdexcept>

#include "datasets/cameras/matrix_text.hpp"
#include "datasets/cameras/off_centre.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

fs::path matrix_of(const fs::path& folder, const fs::path& picture) {
  return folder / (picture.stem().string() + ".txt");
}

}  // namespace

bool has_matrix_of(const fs::path& folder, const fs::path& picture) {
  return is_input_there(matrix_of(folder, picture));
}

std::vector<CameraIntrinsics> cameras_of_matrices(const fs::path& folder,
                                                  const std::vector<fs::path>& pictures,
                                                  const std::optional<ImageSize>& size) {
  constexpr std::size_t largest_matrix = 4096;  // bytes
  std::vector<CameraIntrinsics> cameras;
  for (const fs::path& picture : pictures) {
    const fs::path file = matrix_of(folder, picture);
    const std::string name = "camera file " + quote_path(file.string());
    if (!size)
      throw std::invalid_argument(name +
                                  " has a matrix alone, of colour pictures whose size is not known: expected "
                                  "them as PNG or JPEG");
    cameras.push_back(camera_of_matrix_text(read_input(file, "camera file", largest_matrix), name, size));
    if (is_off_centre(cameras.back()))
      throw std::invalid_argument(name + " " + off_centre_clause(cameras.back()) +
                                  ": expected the matrix of the colour pictures");
  }
  return cameras;
}

}  // namespace clearway
