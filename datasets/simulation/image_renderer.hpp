#pragma once

#include <memory>
#include <span>
#include <vector>

#include "datasets/simulation/surface.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// A picture before it meets the sensor: grey levels 0 to 255, row by row.
struct Radiance {
  int width = 0, height = 0;
  std::vector<float> values;
};

/// A camera and the exact rays of its pixels' corners, which do not depend on where it stands. Copies share
/// them.
class CornerRays {
 public:
  CornerRays(const CameraIntrinsics& camera);  // NOLINT: a camera stands for its rays
  const CameraIntrinsics& camera() const { return camera_; }
  /// Row by row, one more of both than there are pixels: (x, y) where z is 1.
  const Eigen::Vector2d* row(int row) const {
    return rays_->data() + static_cast<size_t>(row) * static_cast<size_t>(camera_.width + 1);
  }

 private:
  CameraIntrinsics camera_;
  std::shared_ptr<const std::vector<Eigen::Vector2d>> rays_;
};

/// Draws what a still camera sees by casting rays through its lens. Pixels at edges (another surface, face or
/// tag cell within one pixel) take the mean of 34 rays spread evenly over the pixel, the others one ray. What
/// never moves is drawn once; a picture then redraws only the 16 x 16 tiles that moving surfaces may touch.
/// Shading: half ambient, half by the angle to a light above the scene; no shadows.
class ImageRenderer {
 public:
  ImageRenderer(const CornerRays& lens, const Eigen::Isometry3d& map_from_camera, std::vector<Surface> still,
                double background);
  ImageRenderer(const ImageRenderer&) = delete;  // the tiles point at the surfaces
  ImageRenderer& operator=(const ImageRenderer&) = delete;

  /// The picture with `moving` in the scene. Safe to call from several threads.
  Radiance draw(std::span<const Surface> moving) const;

 private:
  using Candidates = std::vector<const Surface*>;
  /// What the centre of a pixel sees.
  struct Sight {
    int part = -1;  ///< neighbours that differ have an edge between them
    double along = 0, level = 0;
  };
  struct Tile {
    int column, row;       ///< of its first pixel
    Eigen::Vector3d axis;  ///< of a cone, in the map frame, that holds all its rays
    double half_angle;
    Candidates still;
  };

  void make_tiles();
  bool touches(const Tile& tile, const Surface& surface) const;
  Eigen::Vector3d ray(double column, double row) const;
  double shade(const CastResult& result) const;
  /// `first` is the first of the surfaces the candidates are chosen from.
  Sight look(const Candidates& candidates, const Surface* first, int column, int row) const;
  double average(const Candidates& candidates, int column, int row) const;
  Sight& still_sight(int column, int row);
  const Sight& still_sight(int column, int row) const;
  void draw_still_tile(const Tile& tile);
  void draw_moving_tile(const Tile& tile, const Candidates& moving, const Surface* first,
                        Radiance& picture) const;
  float& value(Radiance& picture, int column, int row) const;

  CornerRays lens_;  ///< within a pixel interpolated
  CameraIntrinsics camera_;
  Eigen::Isometry3d map_from_camera_;
  std::vector<Surface> still_;
  double background_;
  std::vector<Tile> tiles_;
  std::vector<Sight> still_sights_;  ///< with a rim of one pixel around the image
  Radiance empty_;                   ///< the picture without moving surfaces
};

/// What the sensor makes of a picture: lens blur, noise of its own for each (seed, picture), 8 bits.
GrayImage expose(const Radiance& picture, double blur_px, double noise_sigma, uint64_t seed, uint64_t number);

}  // namespace clearway
