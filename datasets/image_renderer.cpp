#include "datasets/image_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/lens.hpp"
#include "datasets/parallel.hpp"

namespace clearway {
namespace {

constexpr int tile_size = 16;

/// Fibonacci lattice: 34 points, each with a column and a row of its own.
std::array<Eigen::Vector2d, 34> spread_points() {
  std::array<Eigen::Vector2d, 34> points;
  for (int i = 0; i < 34; ++i) points[static_cast<size_t>(i)] = {(i + 0.5) / 34, (i * 21 % 34 + 0.5) / 34};
  return points;
}

}  // namespace

ImageRenderer::ImageRenderer(const CameraIntrinsics& camera, const Eigen::Isometry3d& map_from_camera,
                             std::vector<Surface> still, double background)
    : camera_(camera), map_from_camera_(map_from_camera), still_(std::move(still)), background_(background) {
  const int columns = camera.width + 1;
  corner_rays_.resize(static_cast<size_t>(columns) * static_cast<size_t>(camera.height + 1));
  for_each_index(static_cast<size_t>(camera.height) + 1, [&](size_t row) {
    for (int column = 0; column < columns; ++column)
      corner_rays_[row * static_cast<size_t>(columns) + static_cast<size_t>(column)] =
          pixel_ray(camera, {column - 0.5, static_cast<double>(row) - 0.5}).head<2>();
  });
  make_tiles();
  empty_ = {camera.width, camera.height,
            std::vector<float>(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height))};
  for_each_index(tiles_.size(), [&](size_t i) { draw_tile(tiles_[i], tiles_[i].still, empty_); });
}

void ImageRenderer::make_tiles() {
  for (int row = 0; row < camera_.height; row += tile_size) {
    for (int column = 0; column < camera_.width; column += tile_size) {
      Tile tile{column, row, {}, 0, {}};
      // One pixel more on every side: neighbours decide where edges are.
      const double left = column - 1.5, top = row - 1.5, side = tile_size + 2;
      tile.axis = ray(left + side / 2, top + side / 2).normalized();
      for (int i = 0; i <= 4; ++i)
        for (const Eigen::Vector2d& at : {Eigen::Vector2d(i, 0), {i, 4}, {0, i}, {4, i}}) {
          const auto edge = ray(left + at.x() * side / 4, top + at.y() * side / 4).normalized();
          tile.half_angle = std::max(tile.half_angle, 1.01 * std::acos(std::min(1.0, edge.dot(tile.axis))));
        }
      for (const auto& surface : still_)
        if (touches(tile, surface)) tile.still.push_back(&surface);
      tiles_.push_back(std::move(tile));
    }
  }
}

bool ImageRenderer::touches(const Tile& tile, const Surface& surface) const {
  const Eigen::Vector3d to_center = surface.center() - map_from_camera_.translation();
  const double distance = to_center.norm();
  if (distance <= surface.reach()) return true;
  const double angle = std::acos(std::clamp(to_center.dot(tile.axis) / distance, -1.0, 1.0));
  return angle <= tile.half_angle + std::asin(surface.reach() / distance);
}

Eigen::Vector3d ImageRenderer::ray(double column, double row) const {
  const double x = column + 0.5, y = row + 0.5;  // in units of corners
  const int i = std::clamp(static_cast<int>(std::floor(x)), 0, camera_.width - 1);
  const int j = std::clamp(static_cast<int>(std::floor(y)), 0, camera_.height - 1);
  const auto* corner =
      &corner_rays_[static_cast<size_t>(j) * static_cast<size_t>(camera_.width + 1) + static_cast<size_t>(i)];
  const auto* below = corner + camera_.width + 1;
  const double u = x - i, v = y - j;
  const Eigen::Vector2d at =
      (1 - v) * ((1 - u) * corner[0] + u * corner[1]) + v * ((1 - u) * below[0] + u * below[1]);
  return map_from_camera_.linear() * at.homogeneous();
}

double ImageRenderer::shade(const CastResult& result) const {
  if (result.index < 0) return background_;
  static const Eigen::Vector3d light = Eigen::Vector3d(0.5, -0.25, 0.83).normalized();
  return result.hit.grey * (0.55 + 0.45 * std::max(0.0, result.hit.normal.dot(light)));
}

void ImageRenderer::draw_tile(const Tile& tile, const Candidates& candidates, Radiance& picture) const {
  static const auto spread = spread_points();
  constexpr int side = tile_size + 2;
  std::array<int, side * side> met;  // which part of which surface the centre of each pixel sees
  std::array<double, side * side> level;
  const Eigen::Vector3d& eye = map_from_camera_.translation();
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const auto result = cast_ray(candidates, eye, ray(tile.column + i - 1, tile.row + j - 1));
      met[static_cast<size_t>(j * side + i)] = result.index < 0 ? -1 : 8 * result.index + result.hit.part;
      level[static_cast<size_t>(j * side + i)] = shade(result);
    }
  }
  for (int j = 1; j <= std::min(tile_size, camera_.height - tile.row); ++j) {
    for (int i = 1; i <= std::min(tile_size, camera_.width - tile.column); ++i) {
      const int* here = &met[static_cast<size_t>(j * side + i)];
      bool edge = false;
      for (int offset : {-side - 1, -side, -side + 1, -1, 1, side - 1, side, side + 1})
        edge = edge || here[offset] != *here;
      double value = level[static_cast<size_t>(j * side + i)];
      const int column = tile.column + i - 1, row = tile.row + j - 1;
      if (edge) {
        value = 0;
        for (const auto& at : spread)
          value += shade(cast_ray(candidates, eye, ray(column - 0.5 + at.x(), row - 0.5 + at.y())));
        value /= static_cast<double>(spread.size());
      }
      picture.values[static_cast<size_t>(row) * static_cast<size_t>(camera_.width) +
                     static_cast<size_t>(column)] = static_cast<float>(value);
    }
  }
}

Radiance ImageRenderer::draw(std::span<const Surface> moving) const {
  Radiance picture = empty_;
  for (const auto& tile : tiles_) {
    Candidates candidates;
    for (const auto& surface : moving)
      if (touches(tile, surface)) candidates.push_back(&surface);
    if (candidates.empty()) continue;
    candidates.insert(candidates.end(), tile.still.begin(), tile.still.end());
    draw_tile(tile, candidates, picture);
  }
  return picture;
}

}  // namespace clearway
