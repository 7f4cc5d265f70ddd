#include "datasets/simulation/depth_renderer.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {

DepthImage render_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                        uint64_t seed) {
  const CameraIntrinsics& camera = depth.intrinsics;
  const size_t width = static_cast<size_t>(camera.width), height = static_cast<size_t>(camera.height);
  DepthImage image{camera, std::vector<float>(width * height, 0), depth.unit, depth.max_range,
                   depth.map_from_sensor[index % depth.map_from_sensor.size()]};
  const std::vector<SurfaceView> views = views_from(image.world_from_sensor.translation(), surfaces);
  const RandomNumbers noise(seed, 1'000'000'000 + 2 * index), losses(seed, 1'000'000'001 + 2 * index);

  const Lens lens(camera);
  parallel_for(height, [&](size_t row) {
    for (size_t column = 0; column < width; ++column) {
      const auto optical = lens.pixel_ray({static_cast<double>(column), static_cast<double>(row)});
      if (!optical) continue;
      const Eigen::Vector3d ray =
          image.world_from_sensor.linear() * Eigen::Vector3d(1, -optical->x(), -optical->y()).normalized();
      const auto result = cast_ray(views, ray);
      const size_t pixel = row * width + column;
      if (result.index < 0 || result.hit.along > depth.max_range) continue;
      if (depth.dropout > 0 && losses.uniform(pixel) < depth.dropout) continue;
      const double range = result.hit.along;
      const double sigma = depth.noise_constant + depth.noise_quadratic * range * range;
      image.ranges[pixel] = static_cast<float>(range + (sigma > 0 ? sigma * noise.gaussian(pixel).first : 0));
    }
  });
  return image;
}

void count_whole_steps(DepthImage& image) {
  constexpr double rounding = 1e-3;  // of a step: far more than float and pose rounding can add
  for (float& range : image.ranges) {
    const double steps = std::floor(static_cast<double>(range) / image.unit - rounding);
    range = static_cast<float>(std::max(0.0, steps) * image.unit);
  }
}

}  // namespace clearway
