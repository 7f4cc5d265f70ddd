#pragma once

#include <cstddef>
#include <vector>

#include "datasets/descriptions/scene.hpp"

namespace clearway {

/// One picture as it arrives.
struct TakenPicture {
  std::size_t number;  ///< which of the pictures that were due
  double taken;        ///< s after the first one was due: what it shows
  double stamp;        ///< the same, as stated; later for a picture that is repeated
};

/// The pictures of a scene in the order in which they arrive: dropped ones are missing, repeated ones come
/// twice. @pre scene.camera
std::vector<TakenPicture> take_pictures(const Scene& scene);

/// What exposure does to the grey levels and to the noise of a picture that is taken at a time: factors whose
/// logarithm changes slowly (0.05 to 0.5 Hz).
struct Exposure {
  double gain = 1, noise = 1;
};
Exposure exposure_at(const Scene& scene, double time);

}  // namespace clearway
