#include "datasets/simulation/noisy_depth.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

/// One image's camera: casts the ray of a place in the image.
struct Eye {
  const CameraIntrinsics& camera;
  Lens lens;
  const Eigen::Isometry3d& pose;
  std::vector<SurfaceView> surfaces;

  /// Empty beyond the lens's field.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const {
    const auto optical = lens.pixel_ray(pixel);
    if (!optical) return std::nullopt;
    return pose.linear() * Eigen::Vector3d(1, -optical->x(), -optical->y()).normalized();
  }
  CastResult look(const Eigen::Vector3d& ray) const { return cast_ray(surfaces, ray); }
};

/// Random numbers of one image: a stream for each effect, a counter for each pixel.
class Chances {
 public:
  Chances(uint64_t seed, size_t index)
      : numbers_(seed, 3'000'000'000 + index), patches_(seed, 9'000'000'000 + index) {}
  const RandomNumbers& patches() const { return patches_; }
  double uniform(size_t pixel, int effect) const { return numbers_.uniform(16 * pixel + effect); }
  RandomNumbers::Pair gaussian(size_t pixel, int effect) const {
    return numbers_.gaussian(8 * pixel + static_cast<size_t>(effect));  // counters 16 pixel + 2 effect + 0, 1
  }

 private:
  RandomNumbers numbers_, patches_;
};

constexpr int aim = 0, range_error = 1;                            // pairs: counters 0 to 3
constexpr int fly = 4, fly_share = 5, lost = 6, lost_grazing = 7;  // single counters

double sigma_of(double depth, const DepthNoise& noise) {
  const double kinect = noise.range_scale * (0.0012 + 0.0019 * (depth - 0.4) * (depth - 0.4));
  const double further = noise.constant + noise.proportional * depth + noise.quadratic * depth * depth;
  return kinect > 0.0 ? std::hypot(kinect, further) : further;
}

/// Smooth over the image, 0 to 1: between random numbers on a grid of 96 pixels of a focal length of 525.
double patch_value(const RandomNumbers& numbers, const CameraIntrinsics& camera,
                   const Eigen::Vector2d& place) {
  constexpr double patch = 96.0 / 525.0;
  const double u = (place.x() - camera.cx) / camera.fx / patch + 512.0;
  const double v = (place.y() - camera.cy) / camera.fy / patch + 512.0;
  const double x = std::floor(u), y = std::floor(v);
  const auto corner = [&](double i, double j) {
    return numbers.uniform(static_cast<uint64_t>(i) * 1024 + static_cast<uint64_t>(j));
  };
  const double low = (x + 1 - u) * corner(x, y) + (u - x) * corner(x + 1, y);
  const double high = (x + 1 - u) * corner(x, y + 1) + (u - x) * corner(x + 1, y + 1);
  return (y + 1 - v) * low + (v - y) * high;
}

/// Depth after counting whole steps of disparity; the nearest step, as a matcher finds it.
double quantised(double depth, double focal, const DepthNoise& noise) {
  const double scale = focal * noise.baseline / noise.disparity_step;
  return scale / std::max(1.0, std::round(scale / depth));
}

/// Range along the pixel's ray after all effects; 0 for no return.
double measure(const Eye& eye, const Eigen::Vector2d& place, size_t pixel, const Chances& chances,
               const DepthNoise& noise) {
  const auto sight = eye.ray(place);
  if (!sight) return 0.0;
  const Eigen::Vector3d& ray = *sight;
  CastResult seen = eye.look(ray);
  double range = seen.hit.along;
  if (noise.lateral_px > 0.0) {
    const auto offset = chances.gaussian(pixel, aim);
    const auto aside = eye.ray(place + noise.lateral_px * Eigen::Vector2d(offset.first, offset.second));
    const CastResult beside = eye.look(aside.value_or(ray));
    const bool edge = std::isfinite(range) && std::isfinite(beside.hit.along) &&
                      std::abs(beside.hit.along - range) > 0.05 * range;
    const double other = beside.hit.along;
    if (edge && chances.uniform(pixel, fly) < noise.flying) {
      const double share = chances.uniform(pixel, fly_share);
      range = share * range + (1.0 - share) * other;
    } else {
      range = other;
    }
    seen = beside;
  }
  if (seen.index < 0) return 0.0;
  if (noise.dropout > 0.0 && chances.uniform(pixel, lost) < noise.dropout) return 0.0;
  const double cosine = -seen.hit.normal.dot(ray);
  if (cosine < noise.grazing_cosine && chances.uniform(pixel, lost_grazing) > cosine / noise.grazing_cosine)
    return 0.0;
  const double along_axis = eye.pose.linear().col(0).dot(ray);
  double depth = range * along_axis;
  if (noise.multipath > 0.0) {
    const double patch = patch_value(chances.patches(), eye.camera, place);
    depth *= 1.0 + noise.multipath * patch * patch;
  }
  const double sigma = sigma_of(depth, noise);
  if (sigma > 0.0) depth += sigma * chances.gaussian(pixel, range_error).first;
  if (noise.disparity_step > 0.0) depth = quantised(depth, eye.camera.fx, noise);
  return std::max(0.0, depth / along_axis);
}

}  // namespace

DepthImage render_noisy_depth(const SceneDepth& depth, size_t index, std::span<const Surface> surfaces,
                              uint64_t seed, const DepthNoise& noise) {
  const CameraIntrinsics& camera = depth.intrinsics;
  const size_t width = static_cast<size_t>(camera.width), height = static_cast<size_t>(camera.height);
  DepthImage image{camera, std::vector<float>(width * height, 0), depth.unit, depth.max_range,
                   depth.map_from_sensor[index % depth.map_from_sensor.size()]};
  const Eye eye{camera, Lens(camera), image.world_from_sensor,
                views_from(image.world_from_sensor.translation(), surfaces)};
  const Chances chances(seed, index);
  parallel_for(height, [&](size_t row) {
    for (size_t column = 0; column < width; ++column) {
      const size_t pixel = row * width + column;
      const double range =
          measure(eye, {static_cast<double>(column), static_cast<double>(row)}, pixel, chances, noise);
      if (range <= depth.max_range) image.ranges[pixel] = static_cast<float>(range);
    }
  });
  return image;
}

}  // namespace clearway
