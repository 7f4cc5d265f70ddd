#include "tracking/camera.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace clearway {
namespace {

constexpr double kNearest = 1e-9;  // metres before the camera

[[noreturn]] void refuse(const std::string& field, double value, const std::string& expected) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << "camera: " << field << " is " << value << ", expected " << expected;
  throw std::invalid_argument(text.str());
}

bool is_free_of_distortion(const std::array<double, 5>& d) {
  return std::all_of(d.begin(), d.end(), [](double k) { return k == 0.0; });
}

double slope(const std::array<double, 5>& d, double s) {  // d(r f(r^2))/dr at s = r^2
  return 1.0 + s * (3.0 * d[0] + s * (5.0 * d[1] + s * 7.0 * d[4]));
}

// The square of the radius at which the radial polynomial stops growing: the smallest s > 0 with
// 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 = 0; infinity when there is none.
double fold_radius_squared(const std::array<double, 5>& d) {
  const double a = 21.0 * d[4], b = 10.0 * d[1], c = 3.0 * d[0];  // derivative: a s^2 + b s + c
  std::array<double, 3> ends{};
  int count = 0;
  if (const double root = b * b - 4.0 * a * c; a != 0.0 && root >= 0.0) {
    const double q = -0.5 * (b + std::copysign(std::sqrt(root), b));
    ends[count++] = q / a;
    if (q != 0.0) ends[count++] = c / q;
  } else if (a == 0.0 && b != 0.0) {
    ends[count++] = -c / b;
  }
  std::sort(ends.begin(), ends.begin() + count);
  double low = 0.0;
  const auto bisect = [&d](double from, double to) {
    for (int i = 0; i < 200 && to - from > 1e-12 * to; ++i) {
      const double middle = 0.5 * (from + to);
      (slope(d, middle) > 0.0 ? from : to) = middle;
    }
    return from;
  };
  for (int i = 0; i < count; ++i) {
    if (!(ends[i] > 0.0)) continue;
    if (slope(d, ends[i]) <= 0.0) return bisect(low, ends[i]);
    low = ends[i];
  }
  for (double high = std::max(1.0, 2.0 * low); high < 1e12; high *= 2.0)
    if (slope(d, high) <= 0.0) return bisect(low, high);
  return std::numeric_limits<double>::infinity();
}

// Brown-Conrady: the distorted normalised point, and its derivative by the undistorted one.
Eigen::Vector2d distort(const std::array<double, 5>& d, const Eigen::Vector2d& p, Eigen::Matrix2d& by_p) {
  const double x = p.x(), y = p.y(), s = p.squaredNorm();
  const double radial = 1.0 + s * (d[0] + s * (d[1] + s * d[4]));
  const double twice = 2.0 * (d[0] + s * (2.0 * d[1] + s * 3.0 * d[4]));  // d(radial)/dx = twice * x
  by_p(0, 0) = radial + x * x * twice + 2.0 * d[2] * y + 6.0 * d[3] * x;
  by_p(0, 1) = x * y * twice + 2.0 * d[2] * x + 2.0 * d[3] * y;
  by_p(1, 0) = by_p(0, 1);
  by_p(1, 1) = radial + y * y * twice + 6.0 * d[2] * y + 2.0 * d[3] * x;
  return {x * radial + 2.0 * d[2] * x * y + d[3] * (s + 2.0 * x * x),
          y * radial + d[2] * (s + 2.0 * y * y) + 2.0 * d[3] * x * y};
}

// Half the diagonal, taken from the principal point to the farthest corner of the image.
double corner_distance(const Camera& camera) {
  return std::hypot(std::max(camera.cx, camera.width - 1.0 - camera.cx),
                    std::max(camera.cy, camera.height - 1.0 - camera.cy));
}

constexpr double kKnownDistortion = 0.5;     // pixels
constexpr double kUnknownDistortion = 0.01;  // of half the diagonal

}  // namespace

LensDistortion::LensDistortion(const std::array<double, 5>& coefficients)
    : coefficients_(coefficients),
      is_none_(is_free_of_distortion(coefficients)),
      fold_squared_(is_none_ ? std::numeric_limits<double>::infinity() : fold_radius_squared(coefficients)) {}

std::optional<Eigen::Vector2d> LensDistortion::distort(const Eigen::Vector2d& ray,
                                                       Eigen::Matrix2d& by_ray) const {
  by_ray.setIdentity();
  if (is_none_) return ray;
  if (ray.squaredNorm() > fold_squared_) return std::nullopt;
  const Eigen::Vector2d seen = clearway::distort(coefficients_, ray, by_ray);
  if (!(by_ray.determinant() > 0.0)) return std::nullopt;
  return seen;
}

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
  for (double k : distortion)
    if (!std::isfinite(k)) refuse("distortion", k, "five finite numbers k1, k2, p1, p2, k3");
  for (int i = 0; i <= 16; ++i) {  // all around the border
    const double x = -0.5 + width * i / 16.0, y = -0.5 + height * i / 16.0;
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(x, -0.5), Eigen::Vector2d(x, height - 0.5),
                                         Eigen::Vector2d(-0.5, y), Eigen::Vector2d(width - 0.5, y)})
      if (!undistort(pixel))
        refuse("distortion", distortion[0], "coefficients that map the whole image one to one (k1 named)");
  }
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
  const auto seen = LensDistortion(distortion).distort(ray, seen_by_ray);
  if (!seen) return std::nullopt;
  Eigen::Matrix<double, 2, 3> ray_by_point;
  ray_by_point << 1.0, 0.0, -ray.x(), 0.0, 1.0, -ray.y();
  pixel_by_point = Eigen::Vector2d(fx, fy).asDiagonal() * (seen_by_ray * ray_by_point) / point.z();
  return Eigen::Vector2d(fx * seen->x() + cx, fy * seen->y() + cy);
}

std::optional<Eigen::Vector2d> Camera::undistort(const Eigen::Vector2d& pixel) const {
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d seen((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (is_free_of_distortion(distortion)) return seen;
  const double fold = fold_radius_squared(distortion);
  Eigen::Vector2d ray = seen.squaredNorm() < fold ? seen : Eigen::Vector2d::Zero();
  for (int i = 0; i < 100; ++i) {
    Eigen::Matrix2d by_ray;
    const Eigen::Vector2d error = distort(distortion, ray, by_ray) - seen;
    if (error.squaredNorm() < 1e-26) return ray;
    const double det = by_ray.determinant();
    if (!(det > 0.0)) return std::nullopt;
    Eigen::Vector2d step = by_ray.inverse() * error;
    double shorten = 1.0;  // a Newton step that would cross the fold is halved until it stays inside
    while (shorten > 1e-9 && (ray - shorten * step).squaredNorm() >= fold) shorten *= 0.5;
    ray -= shorten * step;
  }
  Eigen::Matrix2d unused;
  return (distort(distortion, ray, unused) - seen).norm() < 1e-9 ? std::optional(ray) : std::nullopt;
}

bool Camera::sees(const Eigen::Vector2d& pixel, double margin) const {
  return pixel.x() >= margin - 0.5 && pixel.x() <= width - 0.5 - margin && pixel.y() >= margin - 0.5 &&
         pixel.y() <= height - 0.5 - margin;
}

}  // namespace clearway
