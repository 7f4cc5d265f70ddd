#include "apps/overlay/canvas.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "apps/overlay/tile.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

constexpr int round_sides = 20;
constexpr int most_layers = 16;
constexpr float crack = 0.1F;  ///< pixels

const Eigen::Vector3d& towards_light() {
  static const Eigen::Vector3d way = Eigen::Vector3d(-0.45, -0.65, -0.6).normalized();
  return way;
}

/// The triangles of the image, by the tile that they may touch; in their order.
class TileLists {
 public:
  TileLists(const std::vector<Canvas::Drawn>& triangles, int width, int height)
      : columns_((width + Tile::side - 1) / Tile::side), rows_((height + Tile::side - 1) / Tile::side) {
    begin_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    const auto visit = [&](auto take) {
      for (std::size_t i = 0; i < triangles.size(); ++i)
        visit_tiles(triangles[i], [&](int tile) { take(i, tile); });
    };
    visit([&](std::size_t, int tile) { ++begin_[static_cast<std::size_t>(tile) + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    list_.resize(begin_.back());
    std::vector<std::size_t> next = begin_;
    visit([&](std::size_t i, int tile) {
      list_[next[static_cast<std::size_t>(tile)]++] = static_cast<std::uint32_t>(i);
    });
  }

  int columns() const { return columns_; }
  int count() const { return columns_ * rows_; }
  template <class Take>
  void visit_tile(int tile, Take take) const {
    const auto at = static_cast<std::size_t>(tile);
    for (std::size_t i = begin_[at]; i < begin_[at + 1]; ++i) take(list_[i]);
  }

 private:
  template <class Take>
  void visit_tiles(const Canvas::Drawn& triangle, Take take) const {
    const auto& [a, b, c] = triangle.corners;
    const float reach = 0.5F + triangle.grow;
    const auto tile = [&](float pixel, int count) {
      return static_cast<int>(std::clamp(std::floor(pixel / Tile::side), -1.0F, static_cast<float>(count)));
    };
    const int left = std::max(0, tile(std::min({a.x, b.x, c.x}) - reach, columns_));
    const int right = std::min(columns_ - 1, tile(std::max({a.x, b.x, c.x}) + reach, columns_));
    const int top = std::max(0, tile(std::min({a.y, b.y, c.y}) - reach, rows_));
    const int bottom = std::min(rows_ - 1, tile(std::max({a.y, b.y, c.y}) + reach, rows_));
    for (int row = top; row <= bottom; ++row)
      for (int column = left; column <= right; ++column) take(row * columns_ + column);
  }

  int columns_, rows_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> list_;
};

}  // namespace

Canvas::Canvas(const Camera& camera, const Eigen::Isometry3d& camera_from_map,
               const ProjectorOptions& options)
    : projector_(camera, options), camera_from_map_(camera_from_map) {}

int Canvas::add_layer(double alpha, bool is_over) {
  if (!(alpha >= 0.0 && alpha <= 1.0)) throw std::invalid_argument("canvas: alpha is expected to be 0 to 1");
  if (layers_.size() == most_layers)
    throw std::invalid_argument("canvas: at most " + std::to_string(most_layers) + " layers are drawn");
  layers_.push_back({static_cast<float>(alpha), is_over});
  return static_cast<int>(layers_.size()) - 1;
}

Canvas::Drawn Canvas::look(Colour colour, int layer) const {
  static_cast<void>(layers_.at(static_cast<std::size_t>(layer)));
  Drawn look;
  look.colour = 0xff000000U | static_cast<std::uint32_t>(colour.red) << 16 |
                static_cast<std::uint32_t>(colour.green) << 8 | colour.blue;
  look.layer = static_cast<std::uint8_t>(layer);
  return look;
}

void Canvas::add_drawn(const ScreenTriangle& corners, const Drawn& look) {
  triangles_.push_back(look);
  triangles_.back().corners = corners;
}

void Canvas::add(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh, const Paint& paint, int layer) {
  add_mesh(mesh, map_from_mesh, paint, look(paint.colour, layer));
}

void Canvas::add_occluder(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh) {
  Drawn hidden;
  hidden.grow = crack;
  add_mesh(mesh, map_from_mesh, {}, hidden);
}

void Canvas::add_mesh(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh, const Paint& paint,
                      Drawn look) {
  const Eigen::Isometry3d camera_from_mesh = camera_from_map_ * map_from_mesh;
  const Eigen::Vector3d light = camera_from_mesh.linear().transpose() * towards_light();
  enum class Place : std::uint8_t { not_asked, plain, to_cut };
  std::vector<Place> places(mesh.corners.size(), Place::not_asked);
  std::vector<CameraCorner> corners(mesh.corners.size());
  std::vector<ScreenCorner> seen(mesh.corners.size());
  const Eigen::Matrix3d turn = camera_from_mesh.linear();
  const Eigen::Vector3d shift = camera_from_mesh.translation();
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i].point = turn * mesh.corners[i] + shift;
  const auto ask = [&](std::uint32_t i) {
    if (places[i] != Place::not_asked) return places[i];
    corners[i].light = paint.ambient + (1.0 - paint.ambient) * std::max(0.0, mesh.normals[i].dot(light));
    const auto corner = projector_.plain_corner(corners[i]);
    if (corner) seen[i] = *corner;
    return places[i] = corner ? Place::plain : Place::to_cut;
  };
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d &a = corners[i].point, &b = corners[j].point, &c = corners[k].point;
    if (!((b - a).cross(c - a).dot(a) < 0.0)) continue;  // seen from inside
    if (std::max({a.z(), b.z(), c.z()}) < projector_.near()) continue;
    const Place p = ask(i), q = ask(j), r = ask(k);
    if (p == Place::plain && q == Place::plain && r == Place::plain && projector_.is_plain(a, b, c))
      add_drawn({seen[i], seen[j], seen[k]}, look);
    else
      projector_.triangle({corners[i], corners[j], corners[k]},
                          [&](const ScreenTriangle& piece) { add_drawn(piece, look); });
  }
}

void Canvas::set_depth(std::vector<float> depth) {
  const Camera& camera = projector_.camera();
  if (depth.size() != static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height))
    throw std::invalid_argument("canvas: the depth image is expected to have the camera's " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                " pixels");
  depth_ = std::move(depth);
}

void Canvas::add_fan(const ScreenCorner& center, const std::vector<ScreenCorner>& around, const Drawn& look) {
  for (std::size_t i = 0; i < around.size(); ++i)
    add_drawn({center, around[i], around[(i + 1) % around.size()]}, look);
}

void Canvas::add_round(const ScreenCorner& center, double radius_px, const Drawn& look) {
  std::vector<ScreenCorner> around(round_sides, center);
  for (int i = 0; i < round_sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / round_sides;
    around[static_cast<std::size_t>(i)].x += static_cast<float>(radius_px * std::cos(angle));
    around[static_cast<std::size_t>(i)].y += static_cast<float>(radius_px * std::sin(angle));
  }
  add_fan(center, around, look);
}

void Canvas::add_line(const std::vector<Eigen::Vector3d>& points, double width, Colour colour, int layer) {
  const Drawn drawn = look(colour, layer);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (const auto& [from, to] :
         projector_.segment(camera_from_map_ * points[i], camera_from_map_ * points[i + 1])) {
      add_round(from, 0.5 * width, drawn);
      add_round(to, 0.5 * width, drawn);
      const float dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
      if (!(length > 0.0F)) continue;
      const float aside = 0.5F * static_cast<float>(width) / length;
      std::array<ScreenCorner, 4> quad{from, to, to, from};
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const float sign = corner < 2 ? 1.0F : -1.0F;
        quad[corner].x -= sign * aside * dy;
        quad[corner].y += sign * aside * dx;
      }
      add_drawn({quad[0], quad[1], quad[2]}, drawn);
      add_drawn({quad[0], quad[2], quad[3]}, drawn);
    }
  }
}

void Canvas::add_disc(const Eigen::Vector3d& center, double radius, Colour colour, int layer) {
  const Eigen::Vector3d middle = camera_from_map_ * center;
  const double away = middle.norm();
  if (!(away > radius) || !(radius > 0.0)) return;  // the camera is in it
  const double outline =
      radius * away / std::sqrt(away * away - radius * radius);  // of the cone that it fills
  const Eigen::Vector3d across = middle.unitOrthogonal(), up = middle.normalized().cross(across);
  const Drawn drawn = look(colour, layer);
  constexpr int rim = 48;
  const auto at = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / rim;
    return CameraCorner{middle + outline * (std::cos(angle) * across + std::sin(angle) * up), 1.0};
  };
  for (int i = 0; i < rim; ++i)
    projector_.triangle({CameraCorner{middle, 1.0}, at(i), at((i + 1) % rim)},
                        [&](const ScreenTriangle& piece) { add_drawn(piece, drawn); });
}

void Canvas::add_point(const Eigen::Vector3d& point, double radius_px, Colour colour, int layer) {
  const Eigen::Vector3d at = camera_from_map_ * point;
  const auto pixel = projector_.pixel(at);
  if (!pixel) return;
  add_round({static_cast<float>(pixel->x()), static_cast<float>(pixel->y()), static_cast<float>(1.0 / at.z()),
             1.0F},
            radius_px, look(colour, layer));
}

cv::Mat Canvas::draw(const cv::Mat& image, std::size_t threads) const {
  const Camera& camera = projector_.camera();
  if ((image.type() != CV_8UC1 && image.type() != CV_8UC3) || image.cols != camera.width ||
      image.rows != camera.height)
    throw std::invalid_argument("canvas: expected a grey or BGR image of 8 bits with the camera's " +
                                std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                                " pixels");
  cv::Mat picture;
  if (image.channels() == 1)
    cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  else
    picture = image.clone();
  const TileLists lists(triangles_, camera.width, camera.height);
  std::atomic<int> next = 0;
  const auto draw_tiles = [&](std::size_t) {
    Tile tile(layers_.size());
    for (int i = next++; i < lists.count(); i = next++) {
      bool shows_something = false;
      lists.visit_tile(i, [&](std::uint32_t at) { shows_something |= triangles_[at].colour != 0; });
      if (!shows_something) continue;  // what hides has nothing to hide
      const int x = i % lists.columns() * Tile::side, y = i / lists.columns() * Tile::side;
      tile.begin(x, y, std::min(Tile::side, camera.width - x), std::min(Tile::side, camera.height - y),
                 depth_, camera.width);
      lists.visit_tile(i, [&](std::uint32_t triangle) { tile.raster(triangles_[triangle]); });
      tile.blend(layers_, picture);
    }
  };
  parallel(threads, draw_tiles);
  return picture;
}

}  // namespace clearway
