#include <algorithm>
#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/simulation/image_renderer.hpp"

namespace clearway {
namespace {

/// One half of a Gaussian kernel, the middle first, that sums to one with its mirror image.
std::vector<float> half_kernel(double sigma) {
  std::vector<float> kernel;
  double sum = -1;
  for (int i = 0; i <= std::ceil(3.5 * sigma); ++i) {
    kernel.push_back(static_cast<float>(std::exp(-i * i / (2 * sigma * sigma))));
    sum += 2 * kernel.back();
  }
  for (float& value : kernel) value = static_cast<float>(value / sum);
  return kernel;
}

/// Blurs along the rows and turns the picture over its diagonal: twice is a blur both ways. Beyond the rim
/// the last pixel goes on.
Radiance blur_and_transpose(const Radiance& in, const std::vector<float>& kernel) {
  Radiance out{in.height, in.width, std::vector<float>(in.values.size())};
  const int reach = static_cast<int>(kernel.size()) - 1;
  std::vector<float> line(static_cast<size_t>(in.width + 2 * reach));
  for (int row = 0; row < in.height; ++row) {
    const float* from = &in.values[static_cast<size_t>(row) * static_cast<size_t>(in.width)];
    std::fill_n(line.begin(), reach, from[0]);
    std::copy_n(from, in.width, line.begin() + reach);
    std::fill_n(line.end() - reach, reach, from[in.width - 1]);
    for (int column = 0; column < in.width; ++column) {
      const float* middle = &line[static_cast<size_t>(column + reach)];
      float sum = kernel[0] * middle[0];
      for (int i = 1; i <= reach; ++i) sum += kernel[static_cast<size_t>(i)] * (middle[-i] + middle[i]);
      out.values[static_cast<size_t>(column) * static_cast<size_t>(in.height) + static_cast<size_t>(row)] =
          sum;
    }
  }
  return out;
}

uint8_t level(double value) { return static_cast<uint8_t>(std::clamp(std::round(value), 0.0, 255.0)); }

}  // namespace

GrayImage expose(const Radiance& picture, double blur_px, double noise_sigma, uint64_t seed,
                 uint64_t number) {
  Radiance blurred = picture;
  if (blur_px > 0) {
    const auto kernel = half_kernel(blur_px);
    blurred = blur_and_transpose(blur_and_transpose(picture, kernel), kernel);
  }
  GrayImage image{picture.width, picture.height, std::vector<uint8_t>(blurred.values.size())};
  const RandomNumbers random(seed, number);
  for (size_t i = 0; i < image.pixels.size(); i += 2) {
    const auto noise = noise_sigma > 0 ? random.gaussian(i / 2) : RandomNumbers::Pair{0, 0};
    image.pixels[i] = level(blurred.values[i] + noise_sigma * noise.first);
    if (i + 1 < image.pixels.size())
      image.pixels[i + 1] = level(blurred.values[i + 1] + noise_sigma * noise.second);
  }
  return image;
}

}  // namespace clearway
