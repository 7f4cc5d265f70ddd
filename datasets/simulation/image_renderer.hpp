#pragma once

#include <limits>
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

/// A part of the plane of depth 1 before a camera.
struct Patch {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), high = -low;

  /// What is not finite is no point.
  void add(const Eigen::Array2d& point) {
    if (!point.isFinite().all()) return;
    low = low.min(point);
    high = high.max(point);
  }
  bool meets(const Patch& other) const { return (low <= other.high).all() && (other.low <= high).all(); }
};

/// Where the pixels of a camera look: exact at their corners, interpolated within. Made once for all pictures
/// of a camera that moves.
class PixelRays {
 public:
  explicit PixelRays(const CameraIntrinsics& camera);
  int width() const { return width_; }
  int height() const { return height_; }
  /// In the camera frame, of depth 1; (0, 0) is the centre of the first pixel. Not finite in pixels with a
  /// corner beyond the lens's field.
  Eigen::Vector3d at(double column, double row) const;
  /// Holds all that a pixel looks at.
  Patch patch(int column, int row) const;

 private:
  int width_, height_;
  std::vector<Eigen::Vector2d> corners_;
};

/// Of the rays of a pixel at an edge every `step`-th, from `first` on: the pictures that make up one exposure
/// share them.
struct EdgeRays {
  int first = 0, step = 1;
};

/// Draws what a still camera sees by casting rays through its lens. Pixels at edges (another surface, face or
/// tag cell within one pixel) take the mean of 34 rays spread evenly over the pixel, the others one ray. What
/// never moves is drawn once; a picture then redraws only the 16 x 16 tiles that moving surfaces may touch.
/// Pixels beyond the lens's field are black. Shading: half ambient, half by the angle to a light above the
/// scene; no shadows.
class ImageRenderer {
 public:
  ImageRenderer(std::shared_ptr<const PixelRays> rays, const Eigen::Isometry3d& map_from_camera,
                std::vector<Surface> still, double background, EdgeRays edge_rays = {});
  ImageRenderer(const ImageRenderer&) = delete;  // the tiles point at the surfaces
  ImageRenderer& operator=(const ImageRenderer&) = delete;

  /// The picture with `moving` in the scene. Safe to call from several threads.
  Radiance draw(std::span<const Surface> moving, EdgeRays edge_rays = {}) const;

 private:
  /// A surface from the camera, and what holds its picture.
  struct Candidate {
    const SurfaceView* view;
    Patch patch;
  };
  using Candidates = std::vector<Candidate>;
  /// What the centre of a pixel sees.
  struct Sight {
    int part = -1;  ///< -1: the background; -2: beyond the lens's field; neighbours that differ have an edge
                    ///< between them
    double along = 0, level = 0;
  };
  struct Tile {
    int column, row;  ///< of its first pixel
    Patch patch;      ///< holds all its rays, and those of one pixel more on every side
    Candidates still;
  };

  void make_tiles();
  Candidates candidates_of(std::span<const SurfaceView> views) const;
  /// All of the plane, where a corner of the surface is not well before the camera.
  Patch patch_of(const Surface& surface) const;
  Eigen::Vector3d ray(double column, double row) const {
    return map_from_camera_.linear() * rays_->at(column, row);
  }
  /// What of the candidates a ray meets first.
  struct Meeting {
    Hit hit;
    const SurfaceView* view = nullptr;
  };
  static Meeting cast(const Candidates& candidates, const Eigen::Vector3d& ray);
  double shade(const Meeting& meeting) const;
  /// `first` is the first of the surfaces the candidates are chosen from.
  Sight look(const Candidates& candidates, const SurfaceView* first, int column, int row) const;
  double average(const Candidates& candidates, EdgeRays edge_rays, int column, int row) const;
  Sight& still_sight(int column, int row);
  const Sight& still_sight(int column, int row) const;
  void draw_still_tile(const Tile& tile, EdgeRays edge_rays);
  void draw_moving_tile(const Tile& tile, const Candidates& moving, const SurfaceView* first,
                        EdgeRays edge_rays, Radiance& picture) const;
  float& value(Radiance& picture, int column, int row) const;

  std::shared_ptr<const PixelRays> rays_;
  int width_, height_;
  Eigen::Isometry3d map_from_camera_;
  std::vector<Surface> still_;
  std::vector<SurfaceView> still_views_;
  double background_;
  std::vector<Tile> tiles_;
  std::vector<Sight> still_sights_;  ///< with a rim of one pixel around the image
  Radiance empty_;                   ///< the picture without moving surfaces
};

/// What the sensor makes of a picture: lens blur, noise of its own for each (seed, picture), 8 bits.
GrayImage expose(const Radiance& picture, double blur_px, double noise_sigma, uint64_t seed, uint64_t number);

}  // namespace clearway
