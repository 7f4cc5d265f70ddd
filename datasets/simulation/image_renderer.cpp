#include "datasets/simulation/image_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "datasets/sources/lens.hpp"
#include "mapping/system/parallel.hpp"

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

CornerRays::CornerRays(const CameraIntrinsics& camera) : camera_(camera) {
  const auto columns = static_cast<size_t>(camera.width + 1);
  std::vector<Eigen::Vector2d> rays(columns * static_cast<size_t>(camera.height + 1));
  parallel_for(static_cast<size_t>(camera.height) + 1, [&](size_t row) {
    for (size_t column = 0; column < columns; ++column)
      rays[row * columns + column] =
          pixel_ray(camera, {static_cast<double>(column) - 0.5, static_cast<double>(row) - 0.5}).head<2>();
  });
  rays_ = std::make_shared<const std::vector<Eigen::Vector2d>>(std::move(rays));
}

ImageRenderer::ImageRenderer(const CornerRays& lens, const Eigen::Isometry3d& map_from_camera,
                             std::vector<Surface> still, double background)
    : lens_(lens),
      camera_(lens.camera()),
      map_from_camera_(map_from_camera),
      still_(std::move(still)),
      background_(background) {
  make_tiles();
  still_sights_.resize(static_cast<size_t>(camera_.width + 2) * static_cast<size_t>(camera_.height + 2));
  empty_ = {camera_.width, camera_.height,
            std::vector<float>(static_cast<size_t>(camera_.width) * static_cast<size_t>(camera_.height))};
  parallel_for(tiles_.size(), [&](size_t i) {
    const Tile& tile = tiles_[i];
    // Tiles at the rim of the image look at the pixels just outside as well.
    const int left = tile.column == 0 ? -1 : tile.column, top = tile.row == 0 ? -1 : tile.row;
    const int right = std::min(tile.column + tile_size, camera_.width);
    const int bottom = std::min(tile.row + tile_size, camera_.height);
    for (int row = top; row < bottom + (bottom == camera_.height); ++row)
      for (int column = left; column < right + (right == camera_.width); ++column)
        still_sight(column, row) = look(tile.still, still_.data(), column, row);
  });
  parallel_for(tiles_.size(), [&](size_t i) { draw_still_tile(tiles_[i]); });
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
  const Eigen::Vector2d *corner = lens_.row(j) + i, *below = lens_.row(j + 1) + i;
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

ImageRenderer::Sight& ImageRenderer::still_sight(int column, int row) {
  return still_sights_[static_cast<size_t>(row + 1) * static_cast<size_t>(camera_.width + 2) +
                       static_cast<size_t>(column + 1)];
}

const ImageRenderer::Sight& ImageRenderer::still_sight(int column, int row) const {
  return const_cast<ImageRenderer*>(this)->still_sight(column, row);
}

float& ImageRenderer::value(Radiance& picture, int column, int row) const {
  return picture
      .values[static_cast<size_t>(row) * static_cast<size_t>(camera_.width) + static_cast<size_t>(column)];
}

ImageRenderer::Sight ImageRenderer::look(const Candidates& candidates, const Surface* first, int column,
                                         int row) const {
  const auto result = cast_ray(candidates, map_from_camera_.translation(), ray(column, row));
  if (result.index < 0) return {-1, result.hit.along, shade(result)};
  const auto surface = candidates[static_cast<size_t>(result.index)] - first;
  return {8 * static_cast<int>(surface) + result.hit.part, result.hit.along, shade(result)};
}

double ImageRenderer::average(const Candidates& candidates, int column, int row) const {
  static const auto spread = spread_points();
  double sum = 0;
  for (const auto& at : spread)
    sum += shade(
        cast_ray(candidates, map_from_camera_.translation(), ray(column - 0.5 + at.x(), row - 0.5 + at.y())));
  return sum / static_cast<double>(spread.size());
}

void ImageRenderer::draw_still_tile(const Tile& tile) {
  for (int row = tile.row; row < std::min(tile.row + tile_size, camera_.height); ++row) {
    for (int column = tile.column; column < std::min(tile.column + tile_size, camera_.width); ++column) {
      const Sight& here = still_sight(column, row);
      bool edge = false;
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) edge = edge || still_sight(column + i, row + j).part != here.part;
      value(empty_, column, row) = static_cast<float>(edge ? average(tile.still, column, row) : here.level);
    }
  }
}

void ImageRenderer::draw_moving_tile(const Tile& tile, const Candidates& moving, const Surface* first,
                                     Radiance& picture) const {
  constexpr int side = tile_size + 2;
  std::array<Sight, side * side> sights;
  std::array<bool, side * side> moves{};
  const int rows = std::min(tile_size, camera_.height - tile.row);
  const int columns = std::min(tile_size, camera_.width - tile.column);
  const auto index = [](int i, int j) { return static_cast<size_t>((j + 1) * side + i + 1); };
  for (int j = -1; j <= rows; ++j) {
    for (int i = -1; i <= columns; ++i) {
      const Sight& still = still_sight(tile.column + i, tile.row + j);
      Sight sight = look(moving, first, tile.column + i, tile.row + j);
      moves[index(i, j)] = sight.part >= 0 && sight.along < still.along;
      sight.part += 8 * static_cast<int>(still_.size());  // told apart from the still ones
      sights[index(i, j)] = moves[index(i, j)] ? sight : still;
    }
  }
  Candidates all = moving;
  all.insert(all.end(), tile.still.begin(), tile.still.end());
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      bool edge = false, touched = false;
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj) {
          touched = touched || moves[index(i + di, j + dj)];
          edge = edge || sights[index(i + di, j + dj)].part != sights[index(i, j)].part;
        }
      if (!touched) continue;
      value(picture, tile.column + i, tile.row + j) =
          static_cast<float>(edge ? average(all, tile.column + i, tile.row + j) : sights[index(i, j)].level);
    }
  }
}

Radiance ImageRenderer::draw(std::span<const Surface> moving) const {
  Radiance picture = empty_;
  for (const auto& tile : tiles_) {
    Candidates candidates;
    for (const auto& surface : moving)
      if (touches(tile, surface)) candidates.push_back(&surface);
    if (!candidates.empty()) draw_moving_tile(tile, candidates, moving.data(), picture);
  }
  return picture;
}

}  // namespace clearway
