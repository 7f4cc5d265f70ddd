#include "datasets/cameras/off_centre.hpp"

#include <cmath>

#include "mapping/system/number_text.hpp"

namespace clearway {

bool is_off_centre(const CameraIntrinsics& camera) {
  constexpr double farthest = 0.1;  // of the size; real cameras are within 0.08
  return std::abs(camera.cx / camera.width - 0.5) > farthest ||
         std::abs(camera.cy / camera.height - 0.5) > farthest;
}

std::string off_centre_clause(const CameraIntrinsics& camera) {
  return "has its principal point at (" + short_text(camera.cx) + ", " + short_text(camera.cy) +
         "), far from the middle of pictures of " + std::to_string(camera.width) + " x " +
         std::to_string(camera.height) + " pixels, as of a camera of another size of pictures";
}

}  // namespace clearway
