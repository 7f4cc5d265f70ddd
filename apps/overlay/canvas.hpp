#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "apps/overlay/mesh.hpp"
#include "apps/overlay/projector.hpp"

namespace cv {
class Mat;
}

namespace clearway {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// How a surface looks.
struct Paint {
  Colour colour;
  double ambient =
      0.45;  ///< brightness where no light falls; the light comes over the viewer's left shoulder
};

/// Draws meshes, lines and discs into a camera's image: depth-tested, anti-aliased, transparent where asked.
///
/// Each pixel has four samples. Per sample the nearest thing of each layer counts, whatever the order in
/// which things were added; of several at the same depth the one of the lowest colour. Layer 0 is opaque;
/// what is nearer of the others is blended over it, from far to near. Occluders are in layer 0 and show the
/// image: they hide. The image is drawn tile by tile, each from the same list, so that it is the same byte
/// for byte whatever the threads.
class Canvas {
 public:
  /// @throws std::invalid_argument as Projector
  Canvas(const Camera& camera, const Eigen::Isometry3d& camera_from_map,
         const ProjectorOptions& options = {});

  const Projector& projector() const { return projector_; }
  const Eigen::Isometry3d& camera_from_map() const { return camera_from_map_; }

  /// A further layer, whose number is returned: 1, 2, ...
  /// @param alpha 0: not seen, 1: hides what is behind. @throws std::invalid_argument outside of [0, 1]
  /// @param is_over blended over all that are not, also over nearer ones, in the order in which they were
  /// added; hidden by layer 0 alone
  int add_layer(double alpha, bool is_over = false);

  /// The outside of a closed mesh. @throws std::out_of_range for a layer that was not added, as all others
  void add(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh, const Paint& paint, int layer = 0);
  /// What hides: faces grow by a tenth of a pixel, so that no crack between them lets anything through.
  void add_occluder(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh = Eigen::Isometry3d::Identity());
  /// What hides, seen by a depth camera with the same lens: z of each pixel, metres, row by row from the top;
  /// 0: not known. It replaces the one before. @throws std::invalid_argument for another size than the
  /// image's
  void set_depth(std::vector<float> depth);
  /// A polyline, map frame, with round ends and corners. @param width pixels
  void add_line(const std::vector<Eigen::Vector3d>& points, double width, Colour colour, int layer = 0);
  /// A ball, map frame, metres: a disc as large as its outline, facing the camera, at its centre's depth.
  void add_disc(const Eigen::Vector3d& center, double radius, Colour colour, int layer = 0);
  /// A disc of so many pixels at the depth of a point, map frame.
  void add_point(const Eigen::Vector3d& point, double radius_px, Colour colour, int layer = 0);

  /// The image with all that was added. @param image CV_8UC1 or CV_8UC3 (BGR) of the camera's size
  /// @param threads >= 1. @throws std::invalid_argument for another image
  cv::Mat draw(const cv::Mat& image, std::size_t threads = 1) const;

  std::size_t triangles() const { return triangles_.size(); }  ///< in the image, after cutting and halving

  /// How a layer is blended.
  struct Layer {
    float alpha = 1.0F;
    bool is_over = false;
  };
  /// A triangle in the image.
  struct Drawn {
    ScreenTriangle corners;
    std::uint32_t colour = 0;  ///< 0xAARRGGBB; 0: shows the image
    float grow = 0.0F;         ///< pixels by which its edges move outwards
    std::uint8_t layer = 0;
  };

 private:
  void add_mesh(const Mesh& mesh, const Eigen::Isometry3d& map_from_mesh, const Paint& paint, Drawn look);
  void add_drawn(const ScreenTriangle& corners, const Drawn& look);
  void add_fan(const ScreenCorner& center, const std::vector<ScreenCorner>& around, const Drawn& look);
  void add_round(const ScreenCorner& center, double radius_px, const Drawn& look);
  Drawn look(Colour colour, int layer) const;

  Projector projector_;
  Eigen::Isometry3d camera_from_map_;
  std::vector<Layer> layers_{Layer{}};
  std::vector<float> depth_;
  std::vector<Drawn> triangles_;
};

}  // namespace clearway
