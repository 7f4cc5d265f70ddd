#include "datasets/simulation/taken_pictures.hpp"

#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"

namespace clearway {
namespace {

constexpr std::uint64_t lost_stream = 7'400'000'000, light_stream = 7'410'000'000;

}  // namespace

std::vector<TakenPicture> take_pictures(const Scene& scene) {
  const PictureErrors& errors = scene.camera->errors;
  const RandomNumbers arrivals(scene.seed, lost_stream);
  const double interval = 1 / scene.camera->rate_hz;
  const auto count = static_cast<std::size_t>(duration_of_pictures(scene) / interval + 1e-9) + 1;
  std::vector<TakenPicture> pictures;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) * interval;
    if (i == 0 || !(arrivals.uniform(2 * i) < errors.dropped)) pictures.push_back({i, time, time});
    if (arrivals.uniform(2 * i + 1) < errors.repeated) {
      const TakenPicture last = pictures.back();
      pictures.push_back({last.number, last.taken, time + 0.5 * interval});
    }
  }
  return pictures;
}

Exposure exposure_at(const Scene& scene, double time) {
  const PictureErrors& errors = scene.camera->errors;
  if (errors.brightness == 0.0 && errors.noise == 0.0) return {};
  const ShakeMotion light(Shake{1, 0, 0.05, 0.5}, scene.seed, light_stream);
  const Eigen::Vector3d waves = light.shift(time);
  return {std::exp2(errors.brightness * waves.x()), std::exp2(errors.noise * waves.y())};
}

}  // namespace clearway
