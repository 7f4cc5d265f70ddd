#include "datasets/sources/lens.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

using Coefficients = std::array<double, 8>;

constexpr double flattest = M_PI_2 - 1e-6;  // radians: rays (x, y, 1) have no 90 degrees

/// Of the rational model: what divides; 1 for a plumb bob, 0 at a pole.
double divisor(const Coefficients& d, double r2) { return 1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])); }

/// Plumb bob and rational: a point of the ideal image plane z = 1 moved by the lens, and the derivative of
/// that.
Eigen::Vector2d distort(const Coefficients& d, const Eigen::Vector2d& ideal, Eigen::Matrix2d* derivative) {
  const double x = ideal.x(), y = ideal.y(), r2 = x * x + y * y;
  const double below = divisor(d, r2);
  const double radial = (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / below;
  if (derivative) {
    const double slope =
        (d[0] + r2 * (2 * d[1] + r2 * 3 * d[4]) - radial * (d[5] + r2 * (2 * d[6] + r2 * 3 * d[7]))) / below;
    const double mixed = 2 * x * y * slope + 2 * d[2] * x + 2 * d[3] * y;
    *derivative << radial + 2 * x * x * slope + 2 * d[2] * y + 6 * d[3] * x, mixed, mixed,
        radial + 2 * y * y * slope + 6 * d[2] * y + 2 * d[3] * x;
  }
  return {x * radial + 2 * d[2] * x * y + d[3] * (r2 + 2 * x * x),
          y * radial + d[2] * (r2 + 2 * y * y) + 2 * d[3] * x * y};
}

/// The angle that a fisheye makes of one.
double bent_angle(const Coefficients& d, double angle) {
  const double t = angle * angle;
  return angle * (1 + t * (d[0] + t * (d[1] + t * (d[2] + t * d[3]))));
}

/// Where `rises` is true up to some angle, that angle: to a step of 90 degrees / 4096, then by halving.
template <class Rises>
double last_angle(Rises rises) {
  constexpr int steps = 4096;
  double low = 0;
  for (int i = 1; i <= steps; ++i) {
    double high = flattest * i / steps;
    if (rises(high)) {
      low = high;
      continue;
    }
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = 0.5 * (low + high);
      (rises(middle) ? low : high) = middle;
    }
    return low;
  }
  return flattest;
}

double widest_of(const CameraIntrinsics& camera) {
  const Coefficients& d = camera.distortion;
  if (camera.lens == LensModel::fisheye)
    return last_angle([&](double angle) {
      const double t = angle * angle;
      return 1 + t * (3 * d[0] + t * (5 * d[1] + t * (7 * d[2] + t * 9 * d[3]))) > 0;
    });
  if (camera.lens == LensModel::rational)
    return last_angle([&](double angle) {
      const double r = std::tan(angle), r2 = r * r, below = divisor(d, r2);
      const double above = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
      const double slope = (d[0] + r2 * (2 * d[1] + r2 * 3 * d[4])) * below -
                           above * (d[5] + r2 * (2 * d[6] + r2 * 3 * d[7]));  // times below^2
      return below > 0 && above * below + 2 * r2 * slope > 0;
    });
  return M_PI_2;
}

std::string names_of(LensModel model) {
  if (model == LensModel::rational) return "k1, k2, p1, p2, k3, k4, k5, k6";
  return model == LensModel::fisheye ? "k1, k2, k3, k4" : "k1, k2, p1, p2, k3";
}

}  // namespace

std::string lens_name(LensModel model) {
  switch (model) {
    case LensModel::rational:
      return "rational";
    case LensModel::fisheye:
      return "fisheye";
    case LensModel::plumb_bob:
      break;
  }
  return "plumb_bob";
}

std::optional<LensModel> lens_named(const std::string& name) {
  if (name == "plumb_bob" || name == "radtan" || name == "radial-tangential") return LensModel::plumb_bob;
  if (name == "rational" || name == "rational_polynomial") return LensModel::rational;
  if (name == "fisheye" || name == "equidistant") return LensModel::fisheye;
  return std::nullopt;
}

std::size_t coefficient_count(LensModel model) {
  if (model == LensModel::rational) return 8;
  return model == LensModel::fisheye ? 4 : 5;
}

std::span<const double> coefficients_of(const CameraIntrinsics& camera) {
  return std::span(camera.distortion).first(coefficient_count(camera.lens));
}

bool has_distortion(const CameraIntrinsics& camera) {
  return camera.lens == LensModel::fisheye || camera.distortion != Coefficients{};
}

void set_lens(CameraIntrinsics& camera, LensModel model, std::span<const double> coefficients) {
  const std::size_t count = std::min(coefficients.size(), coefficient_count(model));
  const auto rest = coefficients.subspan(count);
  if (std::any_of(rest.begin(), rest.end(), [](double value) { return value != 0; }))
    throw std::runtime_error("expected " + counted(count, "number") + " other than 0 of a " +
                             lens_name(model) + " lens, " + names_of(model));
  camera.distortion = {};
  std::copy_n(coefficients.begin(), count, camera.distortion.begin());
  const auto& d = camera.distortion;
  const bool is_plumb_bob = model == LensModel::rational && d[5] == 0 && d[6] == 0 && d[7] == 0;
  camera.lens = is_plumb_bob ? LensModel::plumb_bob : model;
}

Lens::Lens(const CameraIntrinsics& camera) : camera_(camera), widest_(widest_of(camera)) {}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d ideal = point.head<2>() / point.z();
  const double radius = ideal.norm(), angle = std::atan(radius);
  if (camera_.lens != LensModel::plumb_bob && !(angle <= widest_)) return std::nullopt;
  Eigen::Vector2d seen = ideal;
  if (camera_.lens != LensModel::fisheye)
    seen = distort(camera_.distortion, ideal, nullptr);
  else if (radius > 0)
    seen *= bent_angle(camera_.distortion, angle) / radius;
  return Eigen::Vector2d(camera_.fx * seen.x() + camera_.cx, camera_.fy * seen.y() + camera_.cy);
}

std::optional<Eigen::Vector3d> Lens::pixel_ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d seen((pixel.x() - camera_.cx) / camera_.fx, (pixel.y() - camera_.cy) / camera_.fy);
  switch (camera_.lens) {
    case LensModel::rational:
      return ray_of_rational(seen);
    case LensModel::fisheye:
      return ray_of_fisheye(seen);
    case LensModel::plumb_bob:
      break;
  }
  return ray_of_plumb_bob(seen);
}

std::optional<Eigen::Vector3d> Lens::ray_of_plumb_bob(const Eigen::Vector2d& seen) const {
  Eigen::Vector2d ideal = seen, best = seen;
  double best_error = INFINITY;
  for (int step = 0; step < 30; ++step) {
    Eigen::Matrix2d derivative;
    const Eigen::Vector2d error = distort(camera_.distortion, ideal, &derivative) - seen;
    if (!(error.norm() < best_error)) break;
    best = ideal;
    best_error = error.norm();
    if (best_error < 1e-15) break;
    ideal -= derivative.inverse() * error;
  }
  return best.homogeneous();
}

/// How far from the axis the radial part of the model moves a ray at that angle.
double Lens::radial(double angle) const {
  if (camera_.lens == LensModel::fisheye) return bent_angle(camera_.distortion, angle);
  const auto& d = camera_.distortion;
  const double r = std::tan(angle), r2 = r * r;
  return r * (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / divisor(d, r2);
}

/// The radial part is solved by halving; what p1 and p2 add, by Newton's steps from there.
std::optional<Eigen::Vector3d> Lens::ray_of_rational(const Eigen::Vector2d& seen) const {
  const double radius = seen.norm();
  double low = 0, high = widest_;
  for (int halving = 0; halving < 20; ++halving) {
    const double middle = 0.5 * (low + high);
    (radial(middle) < radius ? low : high) = middle;
  }
  Eigen::Vector2d ideal = radius > 0 ? Eigen::Vector2d(std::tan(low) / radius * seen) : seen, best = ideal;
  double best_error = INFINITY;
  for (int step = 0; step < 30; ++step) {
    Eigen::Matrix2d derivative;
    const Eigen::Vector2d error = distort(camera_.distortion, ideal, &derivative) - seen;
    if (!(error.norm() < best_error) || !(derivative.determinant() > 0)) break;
    best = ideal;
    best_error = error.norm();
    if (best_error < 1e-15) break;
    ideal -= derivative.inverse() * error;
  }
  const bool is_seen = best_error < 1e-11 * std::max(1.0, radius) && std::atan(best.norm()) <= widest_;
  return is_seen ? std::optional<Eigen::Vector3d>(best.homogeneous()) : std::nullopt;
}

/// Newton's steps along the radius, between two angles that hold the one sought.
std::optional<Eigen::Vector3d> Lens::ray_of_fisheye(const Eigen::Vector2d& seen) const {
  const double radius = seen.norm();
  if (radius < 1e-12) return seen.homogeneous();
  if (!(radial(widest_) >= radius)) return std::nullopt;
  const auto& d = camera_.distortion;
  double low = 0, high = widest_, angle = std::min(radius, 0.5 * widest_);
  for (int step = 0; step < 100; ++step) {
    const double t = angle * angle, error = radial(angle) - radius;
    const double slope = 1 + t * (3 * d[0] + t * (5 * d[1] + t * (7 * d[2] + t * 9 * d[3])));
    (error < 0 ? low : high) = angle;
    double next = angle - error / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - angle) < 1e-16) break;
    angle = next;
  }
  return Eigen::Vector2d(std::tan(angle) / radius * seen).homogeneous();
}

std::vector<Eigen::Vector2d> depth_rays(const CameraIntrinsics& camera) {
  const bool is_bent = has_distortion(camera);
  CameraIntrinsics limited = camera;  // a plumb bob is a rational lens, and as such it has an end
  if (is_bent && camera.lens == LensModel::plumb_bob) limited.lens = LensModel::rational;
  const Lens lens(limited);
  const Eigen::Vector2d nowhere = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<Eigen::Vector2d> rays;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      if (!is_bent) {
        rays.emplace_back((column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy);
        continue;
      }
      const auto ray = lens.pixel_ray({column, row});
      rays.push_back(ray ? Eigen::Vector2d(ray->head<2>()) : nowhere);
    }
  }
  return rays;
}

}  // namespace clearway
