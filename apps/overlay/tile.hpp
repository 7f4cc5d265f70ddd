#pragma once

#include <cstdint>
#include <vector>

#include "apps/overlay/canvas.hpp"

namespace cv {
class Mat;
}

namespace clearway {

/// A small square of the image in which Canvas::draw works: four samples a pixel, for each layer the nearest
/// inverse depth and its colour. Samples lie on a turned grid, so that edges near both axes are smooth.
class Tile {
 public:
  static constexpr int side = 32;  ///< pixels: the samples of a layer fit into the fastest cache

  explicit Tile(std::size_t layers);

  /// Begins the tile whose upper left pixel is (x, y). @param depth z of the image's pixels; may be empty
  void begin(int x, int y, int width, int height, const std::vector<float>& depth, int image_width);
  void raster(const Canvas::Drawn& triangle);
  /// Blends the samples over `image` (CV_8UC3).
  void blend(const std::vector<Canvas::Layer>& looks, cv::Mat& image) const;

 private:
  using Samples = float __attribute__((vector_size(16)));  // of any x86-64, and of 64-bit ARM
  using Colours = std::uint32_t __attribute__((vector_size(16)));
  using Truths = std::int32_t __attribute__((vector_size(16)));
  struct Layer {
    std::vector<Samples> depth;
    std::vector<Colours> colour;
    bool is_touched = false, is_coloured = false;
  };
  struct Line {
    float a = 0.0F, b = 0.0F, c = 0.0F;  ///< a x + b y + c, from the tile's corner on
  };
  /// Where an edge cuts a row of pixels, at most: -(b y + most) / a.
  struct Cut {
    double a = 0.0, b = 0.0, most = 0.0, inverse = 0.0;
  };
  struct Setup {
    Line edges[3];  ///< >= 0 inside
    Cut cuts[3];
    Line depth, light;
    float least_depth = 0.0F, most_depth = 0.0F;
    bool is_lit_alike = false;
    std::uint32_t colour = 0;                      ///< where it is lit alike
    int left = 0, right = 0, top = 0, bottom = 0;  ///< pixels of the tile, ends included
  };
  bool set_up(const Canvas::Drawn& triangle, Setup& setup) const;
  void touch(Layer& layer);
  static bool cut_row(const Setup& setup, int y, int& left, int& right);
  void raster_row(const Setup& setup, const Canvas::Drawn& triangle, int y, Layer& layer) const;
  void blend_pixel(std::size_t place, const std::vector<Canvas::Layer>& looks, std::uint8_t* bgr) const;

  std::vector<Layer> layers_;
  int x_ = 0, y_ = 0, width_ = 0, height_ = 0;
};

}  // namespace clearway
