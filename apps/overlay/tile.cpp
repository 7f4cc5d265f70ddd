#include "apps/overlay/tile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>

namespace clearway {
namespace {

using FourFloats = float __attribute__((vector_size(16)));
constexpr FourFloats sample_x = {-0.125F, 0.375F, 0.125F, -0.375F};
constexpr FourFloats sample_y = {-0.375F, -0.125F, 0.375F, 0.125F};
constexpr double farthest_sample = 0.375;

FourFloats four(float value) { return FourFloats{value, value, value, value}; }

std::uint32_t scaled(std::uint32_t colour, float light) {
  const auto share = static_cast<std::uint32_t>(std::clamp(light, 0.0F, 1.0F) * 256.0F);
  const std::uint32_t red_blue = ((colour & 0xff00ffU) * share >> 8) & 0xff00ffU;
  const std::uint32_t green = ((colour & 0x00ff00U) * share >> 8) & 0x00ff00U;
  return (colour & 0xff000000U) | red_blue | green;
}

bool any(std::int32_t __attribute__((vector_size(16))) truths) {
  const auto halves = (std::int64_t __attribute__((vector_size(16))))truths;
  return (halves[0] | halves[1]) != 0;
}

struct Vertex {
  double x, y;
};

bool comes_first(const Vertex& a, const Vertex& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

}  // namespace

Tile::Tile(std::size_t layers) : layers_(layers) {
  for (Layer& layer : layers_) {
    layer.depth.resize(side * side);
    layer.colour.resize(side * side);
  }
}

void Tile::begin(int x, int y, int width, int height, const std::vector<float>& depth, int image_width) {
  x_ = x;
  y_ = y;
  width_ = width;
  height_ = height;
  for (Layer& layer : layers_) layer.is_touched = layer.is_coloured = false;
  if (depth.empty()) return;
  touch(layers_[0]);
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const float z = depth[static_cast<std::size_t>(y + row) * static_cast<std::size_t>(image_width) +
                            static_cast<std::size_t>(x + column)];
      if (z > 0.0F) layers_[0].depth[static_cast<std::size_t>(row * side + column)] = four(1.0F / z);
    }
}

void Tile::touch(Layer& layer) {
  if (layer.is_touched) return;
  layer.is_touched = true;
  std::fill(layer.depth.begin(), layer.depth.end(), Samples{});
  std::fill(layer.colour.begin(), layer.colour.end(), Colours{});
}

/// The lines of a triangle as this tile sees them. Two triangles that share an edge get the same numbers for
/// it, with opposite signs, so that no sample between them is lost.
bool Tile::set_up(const Canvas::Drawn& triangle, Setup& setup) const {
  std::array<Vertex, 3> at{};
  for (std::size_t i = 0; i < 3; ++i)
    at[i] = {static_cast<double>(triangle.corners[i].x) - x_,
             static_cast<double>(triangle.corners[i].y) - y_};
  const double x1 = at[1].x - at[0].x, y1 = at[1].y - at[0].y, x2 = at[2].x - at[0].x, y2 = at[2].y - at[0].y;
  const double area = x1 * y2 - x2 * y1;
  if (area == 0.0 || !std::isfinite(area)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex &from = at[i], &to = at[(i + 1) % 3];
    const bool is_turned = !comes_first(from, to);
    const Vertex &p = is_turned ? to : from, &q = is_turned ? from : to;
    const double a = p.y - q.y, b = q.x - p.x, c = -a * p.x - b * p.y;
    const double sign = is_turned == (area > 0.0) ? -1.0 : 1.0;
    const double grown = static_cast<double>(triangle.grow) * std::sqrt(a * a + b * b);
    const Cut cut{sign * a, sign * b, sign * c + grown, 0.0};
    setup.edges[i] = {static_cast<float>(cut.a), static_cast<float>(cut.b), static_cast<float>(cut.most)};
    constexpr double reach = farthest_sample + 1e-3;  // the samples, and more than the rounding of the edge
    setup.cuts[i] = {cut.a, cut.b, cut.most + reach * (std::abs(a) + std::abs(b)), 1.0 / cut.a};
  }
  const auto plane = [&](float v0, float v1, float v2) {
    const double d1 = static_cast<double>(v1) - v0, d2 = static_cast<double>(v2) - v0;
    const double a = (d1 * y2 - d2 * y1) / area, b = (d2 * x1 - d1 * x2) / area;
    return Line{static_cast<float>(a), static_cast<float>(b),
                static_cast<float>(v0 - a * at[0].x - b * at[0].y)};
  };
  const auto& [p, q, r] = triangle.corners;
  setup.depth = plane(p.inverse_depth, q.inverse_depth, r.inverse_depth);
  setup.light = plane(p.light, q.light, r.light);
  setup.least_depth = std::min({p.inverse_depth, q.inverse_depth, r.inverse_depth});
  setup.most_depth = std::max({p.inverse_depth, q.inverse_depth, r.inverse_depth});
  setup.is_lit_alike = setup.light.a == 0.0F && setup.light.b == 0.0F;
  setup.colour = scaled(triangle.colour, setup.light.c);
  const double reach = farthest_sample + static_cast<double>(triangle.grow);
  const auto first = [&](double low) { return static_cast<int>(std::max(0.0, std::ceil(low - reach))); };
  const auto last = [&](double high, int count) {
    return static_cast<int>(std::min(count - 1.0, std::floor(high + reach)));
  };
  setup.left = first(std::min({at[0].x, at[1].x, at[2].x}));
  setup.top = first(std::min({at[0].y, at[1].y, at[2].y}));
  setup.right = last(std::max({at[0].x, at[1].x, at[2].x}), width_);
  setup.bottom = last(std::max({at[0].y, at[1].y, at[2].y}), height_);
  return setup.left <= setup.right && setup.top <= setup.bottom;
}

void Tile::raster(const Canvas::Drawn& triangle) {
  Setup setup;
  if (!set_up(triangle, setup)) return;
  Layer& layer = layers_[triangle.layer];
  touch(layer);
  layer.is_coloured = layer.is_coloured || triangle.colour != 0;
  for (int y = setup.top; y <= setup.bottom; ++y) raster_row(setup, triangle, y, layer);
}

/// The pixels of a row that no edge leaves out; false for none.
bool Tile::cut_row(const Setup& setup, int y, int& left, int& right) {
  double from = setup.left, to = setup.right;
  for (const Cut& cut : setup.cuts) {
    const double most = cut.b * y + cut.most;
    if (cut.a > 0.0)
      from = std::max(from, -most * cut.inverse);
    else if (cut.a < 0.0)
      to = std::min(to, -most * cut.inverse);
    else if (most < 0.0)
      return false;
  }
  if (!(from <= to)) return false;
  left = static_cast<int>(from);
  right = std::min(static_cast<int>(to) + 1, setup.right);
  return true;
}

void Tile::raster_row(const Setup& setup, const Canvas::Drawn& triangle, int y, Layer& layer) const {
  int left = 0, right = 0;
  if (!cut_row(setup, y, left, right)) return;
  const Samples ys = four(static_cast<float>(y)) + sample_y;
  const Samples rest[3] = {setup.edges[0].b * ys + setup.edges[0].c, setup.edges[1].b * ys + setup.edges[1].c,
                           setup.edges[2].b * ys + setup.edges[2].c};
  const Samples depth_rest = setup.depth.b * ys + setup.depth.c;
  const Samples least = four(setup.least_depth), most = four(setup.most_depth);
  std::uint32_t colour = setup.colour;
  for (int x = left; x <= right; ++x) {
    const Samples xs = four(static_cast<float>(x)) + sample_x;
    Truths is_in = (setup.edges[0].a * xs + rest[0] >= 0.0F) & (setup.edges[1].a * xs + rest[1] >= 0.0F) &
                   (setup.edges[2].a * xs + rest[2] >= 0.0F);
    if (!any(is_in)) continue;
    Samples depth = setup.depth.a * xs + depth_rest;
    depth = depth < least ? least : depth;
    depth = depth > most ? most : depth;
    const auto place = static_cast<std::size_t>(y * side + x);
    Samples& nearest = layer.depth[place];
    Colours& seen = layer.colour[place];
    if (!setup.is_lit_alike)
      colour = scaled(triangle.colour, setup.light.a * static_cast<float>(x) +
                                           setup.light.b * static_cast<float>(y) + setup.light.c);
    const Colours colours = {colour, colour, colour, colour};
    is_in &= (depth > nearest) | ((depth == nearest) & static_cast<Truths>(colours < seen));
    nearest = is_in ? depth : nearest;
    seen = is_in ? colours : seen;
  }
}

void Tile::blend(const std::vector<Canvas::Layer>& looks, cv::Mat& image) const {
  const bool is_empty =
      std::none_of(layers_.begin(), layers_.end(), [](const Layer& layer) { return layer.is_coloured; });
  if (is_empty) return;
  for (int y = 0; y < height_; ++y) {
    auto* row = image.ptr<std::uint8_t>(y_ + y) + static_cast<std::ptrdiff_t>(3) * x_;
    for (int x = 0; x < width_; ++x)
      blend_pixel(static_cast<std::size_t>(y * side + x), looks, row + static_cast<std::ptrdiff_t>(3) * x);
  }
}

void Tile::blend_pixel(std::size_t place, const std::vector<Canvas::Layer>& looks, std::uint8_t* bgr) const {
  const Samples opaque = layers_[0].is_touched ? layers_[0].depth[place] : Samples{};
  const Colours solid = layers_[0].is_touched ? layers_[0].colour[place] : Colours{};
  constexpr std::size_t most = 16;
  std::size_t count = 0;
  std::array<std::size_t, most> visible;
  for (std::size_t i = 1; i < layers_.size(); ++i) {
    if (!layers_[i].is_touched) continue;
    const Truths nearer = layers_[i].depth[place] > opaque;
    if ((nearer[0] | nearer[1] | nearer[2] | nearer[3]) != 0) visible[count++] = i;
  }
  if (count == 0 && (solid[0] | solid[1] | solid[2] | solid[3]) == 0) return;
  std::array<float, 3> sum{};
  for (int sample = 0; sample < 4; ++sample) {
    std::array<float, 3> seen{};
    for (int channel = 0; channel < 3; ++channel)
      seen[static_cast<std::size_t>(channel)] =
          solid[sample] == 0 ? bgr[channel] : static_cast<float>(solid[sample] >> (8 * channel) & 0xffU);
    // from far to near
    std::array<std::size_t, most> order;
    std::size_t ordered = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float depth = layers_[visible[i]].depth[place][sample];
      if (!(depth > opaque[sample])) continue;
      const auto is_after = [&](std::size_t other) {
        if (looks[visible[i]].is_over) return false;  // in their order
        if (looks[other].is_over) return true;
        return layers_[other].depth[place][sample] > depth;
      };
      std::size_t at = ordered++;
      for (; at > 0 && is_after(order[at - 1]); --at) order[at] = order[at - 1];
      order[at] = visible[i];
    }
    for (std::size_t i = 0; i < ordered; ++i) {
      const float alpha = looks[order[i]].alpha;
      const std::uint32_t colour = layers_[order[i]].colour[place][sample];
      for (std::size_t channel = 0; channel < 3; ++channel)
        seen[channel] += alpha * (static_cast<float>(colour >> (8 * channel) & 0xffU) - seen[channel]);
    }
    for (std::size_t channel = 0; channel < 3; ++channel) sum[channel] += seen[channel];
  }
  for (std::size_t channel = 0; channel < 3; ++channel)
    bgr[channel] = static_cast<std::uint8_t>(0.25F * sum[channel] + 0.5F);
}

}  // namespace clearway
