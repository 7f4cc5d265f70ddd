#include "datasets/simulation/image_renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// At a corner, that corner alone: the other may see nothing.
Eigen::Vector2d mixed(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double share) {
  if (share == 0.0) return a;
  return share == 1.0 ? b : Eigen::Vector2d((1 - share) * a + share * b);
}

}  // namespace

PixelRays::PixelRays(const CameraIntrinsics& camera) : width_(camera.width), height_(camera.height) {
  const int columns = width_ + 1;
  const Lens lens(camera);
  const Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  corners_.resize(static_cast<size_t>(columns) * static_cast<size_t>(height_ + 1));
  parallel_for(static_cast<size_t>(height_) + 1, [&](size_t row) {
    for (int column = 0; column < columns; ++column) {
      const auto ray = lens.pixel_ray({column - 0.5, static_cast<double>(row) - 0.5});
      corners_[row * static_cast<size_t>(columns) + static_cast<size_t>(column)] =
          ray ? Eigen::Vector2d(ray->head<2>()) : nowhere;
    }
  });
}

Eigen::Vector3d PixelRays::at(double column, double row) const {
  const double x = column + 0.5, y = row + 0.5;  // in units of corners
  const int i = std::clamp(static_cast<int>(std::floor(x)), 0, width_ - 1);
  const int j = std::clamp(static_cast<int>(std::floor(y)), 0, height_ - 1);
  const auto* corner =
      &corners_[static_cast<size_t>(j) * static_cast<size_t>(width_ + 1) + static_cast<size_t>(i)];
  const auto* below = corner + width_ + 1;
  const double u = x - i, v = y - j;
  return mixed(mixed(corner[0], corner[1], u), mixed(below[0], below[1], u), v).homogeneous();
}

Patch PixelRays::patch(int column, int row) const {
  Patch patch;
  for (const double x : {column - 0.5, column + 0.5})
    for (const double y : {row - 0.5, row + 0.5}) patch.add(at(x, y).head<2>());
  return patch;
}

ImageRenderer::ImageRenderer(std::shared_ptr<const PixelRays> rays, const Eigen::Isometry3d& map_from_camera,
                             std::vector<Surface> still, double background, EdgeRays edge_rays)
    : rays_(std::move(rays)),
      width_(rays_->width()),
      height_(rays_->height()),
      map_from_camera_(map_from_camera),
      still_(std::move(still)),
      still_views_(views_from(map_from_camera.translation(), still_)),
      background_(background) {
  make_tiles();
  still_sights_.resize(static_cast<size_t>(width_ + 2) * static_cast<size_t>(height_ + 2));
  empty_ = {width_, height_, std::vector<float>(static_cast<size_t>(width_) * static_cast<size_t>(height_))};
  parallel_for(tiles_.size(), [&](size_t i) {
    const Tile& tile = tiles_[i];
    // Tiles at the rim of the image look at the pixels just outside as well.
    const int left = tile.column == 0 ? -1 : tile.column, top = tile.row == 0 ? -1 : tile.row;
    const int right = std::min(tile.column + tile_size, width_);
    const int bottom = std::min(tile.row + tile_size, height_);
    for (int row = top; row < bottom + (bottom == height_); ++row)
      for (int column = left; column < right + (right == width_); ++column)
        still_sight(column, row) = look(tile.still, still_views_.data(), column, row);
  });
  parallel_for(tiles_.size(), [&](size_t i) { draw_still_tile(tiles_[i], edge_rays); });
}

void ImageRenderer::make_tiles() {
  const Candidates still = candidates_of(still_views_);
  for (int row = 0; row < height_; row += tile_size) {
    for (int column = 0; column < width_; column += tile_size) {
      Tile tile{column, row, {}, {}};
      for (int i = -1; i <= tile_size + 1; ++i)  // neighbours decide where edges are
        for (int j = -1; j <= tile_size + 1; ++j)
          tile.patch.add(rays_->at(column + i - 0.5, row + j - 0.5).head<2>());
      for (const Candidate& candidate : still)
        if (candidate.patch.meets(tile.patch)) tile.still.push_back(candidate);
      tiles_.push_back(std::move(tile));
    }
  }
}

ImageRenderer::Candidates ImageRenderer::candidates_of(std::span<const SurfaceView> views) const {
  Candidates candidates;
  for (const SurfaceView& view : views) candidates.push_back({&view, patch_of(view.surface())});
  return candidates;
}

Patch ImageRenderer::patch_of(const Surface& surface) const {
  constexpr double shallow = 1e-3, rounding = 1e-9;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Eigen::Matrix<double, 3, 8> corners = map_from_camera_.inverse() * surface.corners();
  if (!(corners.row(2).minCoeff() > shallow))
    return {Eigen::Array2d::Constant(-infinity), Eigen::Array2d::Constant(infinity)};
  Patch patch;
  for (int i = 0; i < 8; ++i) patch.add(corners.col(i).hnormalized().array());
  return {patch.low - rounding, patch.high + rounding};
}

ImageRenderer::Meeting ImageRenderer::cast(const Candidates& candidates, const Eigen::Vector3d& ray) {
  Meeting meeting;
  for (const Candidate& candidate : candidates)
    if (candidate.view->meet(ray, meeting.hit)) meeting.view = candidate.view;
  return meeting;
}

double ImageRenderer::shade(const Meeting& meeting) const {
  if (!meeting.view) return background_;
  static const Eigen::Vector3d light = Eigen::Vector3d(0.5, -0.25, 0.83).normalized();
  return meeting.hit.grey * (0.55 + 0.45 * std::max(0.0, meeting.hit.normal.dot(light)));
}

ImageRenderer::Sight& ImageRenderer::still_sight(int column, int row) {
  return still_sights_[static_cast<size_t>(row + 1) * static_cast<size_t>(width_ + 2) +
                       static_cast<size_t>(column + 1)];
}

const ImageRenderer::Sight& ImageRenderer::still_sight(int column, int row) const {
  return const_cast<ImageRenderer*>(this)->still_sight(column, row);
}

float& ImageRenderer::value(Radiance& picture, int column, int row) const {
  return picture.values[static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column)];
}

ImageRenderer::Sight ImageRenderer::look(const Candidates& candidates, const SurfaceView* first, int column,
                                         int row) const {
  const Eigen::Vector3d in_camera = rays_->at(column, row);
  if (!in_camera.allFinite()) return {-2, std::numeric_limits<double>::infinity(), 0};
  const Meeting meeting = cast(candidates, map_from_camera_.linear() * in_camera);
  const int part = meeting.view ? 8 * static_cast<int>(meeting.view - first) + meeting.hit.part : -1;
  return {part, meeting.hit.along, shade(meeting)};
}

double ImageRenderer::average(const Candidates& candidates, EdgeRays edge_rays, int column, int row) const {
  static const auto spread = spread_points();
  if (!rays_->at(column, row).allFinite()) return 0;
  const Patch pixel = rays_->patch(column, row);
  Candidates near;
  for (const Candidate& candidate : candidates)
    if (candidate.patch.meets(pixel)) near.push_back(candidate);
  double sum = 0;
  int count = 0;
  for (auto i = static_cast<size_t>(edge_rays.first); i < spread.size();
       i += static_cast<size_t>(edge_rays.step), ++count)
    sum += shade(cast(near, ray(column - 0.5 + spread[i].x(), row - 0.5 + spread[i].y())));
  return sum / count;
}

void ImageRenderer::draw_still_tile(const Tile& tile, EdgeRays edge_rays) {
  for (int row = tile.row; row < std::min(tile.row + tile_size, height_); ++row) {
    for (int column = tile.column; column < std::min(tile.column + tile_size, width_); ++column) {
      const Sight& here = still_sight(column, row);
      bool edge = false;
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) edge = edge || still_sight(column + i, row + j).part != here.part;
      value(empty_, column, row) =
          static_cast<float>(edge ? average(tile.still, edge_rays, column, row) : here.level);
    }
  }
}

void ImageRenderer::draw_moving_tile(const Tile& tile, const Candidates& moving, const SurfaceView* first,
                                     EdgeRays edge_rays, Radiance& picture) const {
  constexpr int side = tile_size + 2;
  std::array<Sight, side * side> sights;
  std::array<bool, side * side> moves{};
  const int rows = std::min(tile_size, height_ - tile.row);
  const int columns = std::min(tile_size, width_ - tile.column);
  const auto index = [](int i, int j) { return static_cast<size_t>((j + 1) * side + i + 1); };
  for (int j = -1; j <= rows; ++j) {
    for (int i = -1; i <= columns; ++i) {
      const Sight& still = still_sight(tile.column + i, tile.row + j);
      Sight sight = look(moving, first, tile.column + i, tile.row + j);
      moves[index(i, j)] = sight.part >= 0 && sight.along < still.along;
      sight.part += 8 * static_cast<int>(still_.size());  // distinct from the still ones
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
      value(picture, tile.column + i, tile.row + j) = static_cast<float>(
          edge ? average(all, edge_rays, tile.column + i, tile.row + j) : sights[index(i, j)].level);
    }
  }
}

Radiance ImageRenderer::draw(std::span<const Surface> moving, EdgeRays edge_rays) const {
  Radiance picture = empty_;
  const std::vector<SurfaceView> seen = views_from(map_from_camera_.translation(), moving);
  const Candidates all = candidates_of(seen);
  for (const auto& tile : tiles_) {
    Candidates candidates;
    for (const Candidate& candidate : all)
      if (candidate.patch.meets(tile.patch)) candidates.push_back(candidate);
    if (!candidates.empty()) draw_moving_tile(tile, candidates, seen.data(), edge_rays, picture);
  }
  return picture;
}

}  // namespace clearway
