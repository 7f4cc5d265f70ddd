#include "tracking/camera.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearway {
namespace {

constexpr double kNearest = 1e-9;  // metres before the camera

[[noreturn]] void refuse(const std::string& field, double value, const std::string& expected) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "camera: " << field << " is " << value << ", expected " << expected;
  throw std::invalid_argument(text.str());
}

bool is_free_of_distortion(const LensDistortion::Coefficients& d) {
  return std::all_of(d.begin(), d.end(), [](double k) { return k == 0.0; });
}

// Half the diagonal, taken from the principal point to the farthest corner of the image.
double corner_distance(const Camera& camera) {
  return std::hypot(std::max(camera.cx, camera.width - 1.0 - camera.cx),
                    std::max(camera.cy, camera.height - 1.0 - camera.cy));
}

/// How many coefficients a model has, and their names.
std::pair<std::size_t, std::string> coefficients_of(LensDistortion::Model model) {
  switch (model) {
    case LensDistortion::Model::rational:
      return {8, "eight finite numbers k1, k2, p1, p2, k3, k4, k5, k6"};
    case LensDistortion::Model::fisheye:
      return {4, "four finite numbers k1, k2, k3, k4"};
    case LensDistortion::Model::plumb_bob:
      break;
  }
  return {5, "five finite numbers k1, k2, p1, p2, k3"};
}

/// Pixels that must be seen: all around the border; of a lens that may see less, half-way to it.
std::vector<Eigen::Vector2d> pixels_to_see(const Camera& camera) {
  const double w = camera.width, h = camera.height;
  if (camera.lens != LensDistortion::Model::plumb_bob)
    return {{0.5 * (camera.cx - 0.5), camera.cy},
            {0.5 * (camera.cx + w - 0.5), camera.cy},
            {camera.cx, 0.5 * (camera.cy - 0.5)},
            {camera.cx, 0.5 * (camera.cy + h - 0.5)}};
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i <= 16; ++i) {
    const double x = -0.5 + camera.width * i / 16.0, y = -0.5 + camera.height * i / 16.0;
    pixels.insert(pixels.end(), {{x, -0.5}, {x, h - 0.5}, {-0.5, y}, {w - 0.5, y}});
  }
  return pixels;
}

void require_distortion(const Camera& camera) {
  const auto [count, names] = coefficients_of(camera.lens);
  for (std::size_t i = 0; i < camera.distortion.size(); ++i)
    if (const double k = camera.distortion[i]; !std::isfinite(k) || (i >= count && k != 0.0))
      refuse("distortion", k, names);
  for (const Eigen::Vector2d& pixel : pixels_to_see(camera))
    if (!camera.undistort(pixel))
      refuse("distortion", camera.distortion[0],
             camera.lens == LensDistortion::Model::plumb_bob
                 ? "coefficients that map the whole image one to one (k1 named)"
                 : "coefficients that map at least the middle of the image one to one (k1 named)");
}

constexpr double kUnknownDistortion = 0.01;  // of half the diagonal

}  // namespace

void CameraErrors::validate() const {
  const auto check = [](const std::string& field, double value) {
    if (!(std::isfinite(value) && value >= 0.0)) refuse("errors: " + field, value, "0 or more");
  };
  check("focal", focal);
  check("aspect", aspect);
  check("center", center);
  check("distortion", distortion.value_or(0.0));
}

Eigen::Matrix<double, 2, kCameraModes> Camera::shift_by_errors(const Eigen::Vector2d& pixel) const {
  const double reach = corner_distance(*this);
  const double distorted = errors.distortion.value_or(
      is_free_of_distortion(distortion) ? kUnknownDistortion * reach : kKnownDistortion);
  const Eigen::Vector2d off = pixel - Eigen::Vector2d(cx, cy);
  const Eigen::Vector2d p = off / reach;  // at most 1 long
  const double s = p.squaredNorm();
  Eigen::Matrix<double, 2, kCameraModes> shift;
  shift.col(0) = errors.focal * off;
  shift.col(1) = errors.aspect * Eigen::Vector2d(0.5 * off.x(), -0.5 * off.y());
  shift.col(2) = errors.center * Eigen::Vector2d::UnitX();
  shift.col(3) = errors.center * Eigen::Vector2d::UnitY();
  shift.col(4) = distorted * s * p;
  shift.col(5) = distorted * s * s * p;
  shift.col(6) = distorted / 3.0 * Eigen::Vector2d(2.0 * p.x() * p.y(), s + 2.0 * p.y() * p.y());
  shift.col(7) = distorted / 3.0 * Eigen::Vector2d(s + 2.0 * p.x() * p.x(), 2.0 * p.x() * p.y());
  return shift;
}

void Camera::validate() const {
  errors.validate();
  if (width < 32 || width > 20000) refuse("width", width, "32 to 20000 pixels");
  if (height < 32 || height > 20000) refuse("height", height, "32 to 20000 pixels");
  if (!(std::isfinite(fx) && fx > 0.0)) refuse("fx", fx, "a focal length > 0 pixels");
  if (!(std::isfinite(fy) && fy > 0.0)) refuse("fy", fy, "a focal length > 0 pixels");
  if (!(cx >= 0.0 && cx <= width - 1.0)) refuse("cx", cx, "a principal point inside the image");
  if (!(cy >= 0.0 && cy <= height - 1.0)) refuse("cy", cy, "a principal point inside the image");
  require_distortion(*this);
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& point) const {
  Eigen::Matrix<double, 2, 3> unused;
  return project(point, unused);
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& point,
                                               Eigen::Matrix<double, 2, 3>& pixel_by_point) const {
  if (!(point.z() > kNearest) || !point.allFinite()) return std::nullopt;
  const Eigen::Vector2d ray = point.head<2>() / point.z();
  Eigen::Matrix2d seen_by_ray;
  const auto seen = LensDistortion(distortion, lens).distort(ray, seen_by_ray);
  if (!seen) return std::nullopt;
  Eigen::Matrix<double, 2, 3> ray_by_point;
  ray_by_point << 1.0, 0.0, -ray.x(), 0.0, 1.0, -ray.y();
  pixel_by_point = Eigen::Vector2d(fx, fy).asDiagonal() * (seen_by_ray * ray_by_point) / point.z();
  return Eigen::Vector2d(fx * seen->x() + cx, fy * seen->y() + cy);
}

std::optional<Eigen::Vector2d> Camera::undistort(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d seen((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  return LensDistortion(distortion, lens).undistort(seen);
}

bool Camera::sees(const Eigen::Vector2d& pixel, double margin) const {
  return pixel.x() >= margin - 0.5 && pixel.x() <= width - 0.5 - margin && pixel.y() >= margin - 0.5 &&
         pixel.y() <= height - 0.5 - margin;
}

}  // namespace clearway
