#include "datasets/pictures/depth_casting.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "datasets/pictures/depth_picture.hpp"
#include "datasets/pictures/picture_file.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/input_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

/// The rays (1, y, z) of all pixels, row by row: x forward, y left, z up; 0 where the lens sees nothing.
std::vector<Eigen::Vector3f> rays_of(const CameraIntrinsics& camera) {
  std::vector<Eigen::Vector3f> rays;
  for (const Eigen::Vector2d& optical : depth_rays(camera))
    rays.push_back(optical.allFinite() ? Eigen::Vector3d(1.0, -optical.x(), -optical.y()).cast<float>()
                                       : Eigen::Vector3f(0.0F, 0.0F, 0.0F));
  return rays;
}

/// A camera, and its rays.
struct CastCamera {
  CameraIntrinsics camera;
  std::vector<Eigen::Vector3f> rays;

  void become(const CameraIntrinsics& next) {
    if (camera == next && !rays.empty()) return;
    camera = next;
    rays = rays_of(next);
  }
};

/// The camera of pictures that were made larger or smaller; nothing: their sides have another ratio.
std::optional<CameraIntrinsics> resized(CameraIntrinsics camera, int width, int height) {
  if (std::int64_t{camera.width} * height != std::int64_t{camera.height} * width) return std::nullopt;
  const double by = static_cast<double>(width) / camera.width;
  camera.width = width;
  camera.height = height;
  camera.fx *= by;
  camera.fy *= by;
  camera.cx = (camera.cx + 0.5) * by - 0.5;
  camera.cy = (camera.cy + 0.5) * by - 0.5;
  return camera;
}

/// In the child: what the sensor itself had no confidence in (0 of 0, 1 and 2) is none.
void leave_out_doubtful(const fs::path& confidence, DepthPicture& depth) {
  const GrayImage levels = decode_picture(read_input(confidence, "confidence picture", 64U << 20U));
  if (levels.width != depth.size.width || levels.height != depth.size.height)
    throw std::runtime_error("its confidence picture has another size");
  for (std::size_t i = 0; i < depth.values.size(); ++i)
    if (levels.pixels[i] == 0) depth.values[i] = 0.0F;
}

/// In the child. @param confidence the picture of it; empty: there is none
CloudFrame decode_depth(const std::string& bytes, const CameraIntrinsics& stated, bool may_be_resized,
                        CastCamera& cast, const DepthOptions& options, const DepthNumbers& numbers,
                        const fs::path& confidence) {
  DepthPicture depth = decode_depth_picture(bytes);
  if (!confidence.empty()) leave_out_doubtful(confidence, depth);
  if (depth.is_real != numbers.is_real)
    throw std::runtime_error(std::string("it holds ") + (numbers.is_real ? "whole" : "real") +
                             " numbers, and the first depth picture " + (numbers.is_real ? "real" : "whole") +
                             " ones");
  const auto [width, height] = depth.size;
  const bool has_size = width == stated.width && height == stated.height;
  const auto camera = has_size || !may_be_resized ? stated : resized(stated, width, height);
  if (!camera || width != camera->width || height != camera->height)
    throw std::runtime_error("it has " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels, expected the camera's " + std::to_string(stated.width) + " x " +
                             std::to_string(stated.height));
  cast.become(*camera);
  CloudFrame cloud;
  cloud.kind = "depth";
  cloud.max_range = options.max_range;
  for (std::size_t i = 0; i < depth.values.size(); ++i) {
    const Eigen::Vector3f& ray = cast.rays[i];
    const double distance = *options.scale * numbers.value_of(depth.values[i]);
    if (distance == 0.0 || distance >= numbers.background || ray.x() == 0.0F) continue;
    cloud.points.push_back(static_cast<float>(distance) * ray);
  }
  return cloud;
}

}  // namespace

std::vector<fs::path> confidence_of(const std::vector<fs::path>& pictures, const fs::path& folder) {
  std::vector<fs::path> files(pictures.size());
  std::error_code error;
  for (std::size_t i = 0; i < pictures.size() && !folder.empty(); ++i)
    for (const char* end : {"_conf.png", ".png"})
      if (const fs::path file = folder / (pictures[i].stem().string() + end);
          file != pictures[i] && fs::exists(file, error)) {
        files[i] = file;
        break;
      }
  return files;
}

FilesInChild::Decode depth_decoder(const DepthCameras& cameras, const DepthOptions& options,
                                   const DepthNumbers& numbers, const std::vector<fs::path>& confidence) {
  const auto cast = std::make_shared<CastCamera>();
  if (!cameras.may_be_resized) cast->become(cameras.of_picture.front());
  return [cameras, cast, options, numbers, confidence](const std::string& bytes, std::size_t number) {
    const CameraIntrinsics& camera = cameras.of_picture[std::min(number, cameras.of_picture.size() - 1)];
    return decode_depth(bytes, camera, cameras.may_be_resized, *cast, options, numbers, confidence[number]);
  };
}

}  // namespace clearway
