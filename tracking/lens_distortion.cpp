#include "tracking/lens_distortion.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace clearway {
namespace {

using Coefficients = LensDistortion::Coefficients;

constexpr double kNoFold = std::numeric_limits<double>::infinity();
constexpr double kWidest = M_PI_2 - 1e-6;  // radians: (x/z, y/z) are not more than a million

double slope(const Coefficients& d, double s) {  // d(r f(r^2))/dr at s = r^2
  return 1.0 + s * (3.0 * d[0] + s * (5.0 * d[1] + s * 7.0 * d[4]));
}

/// Whether the slope is far from 0 all the way to s, whatever the signs: then no fold has to be searched.
bool rises_well_to(const Coefficients& d, double s) {
  return s * (3.0 * std::abs(d[0]) + s * (5.0 * std::abs(d[1]) + s * 7.0 * std::abs(d[4]))) < 0.99;
}

// The square of the radius at which the radial polynomial stops growing: the smallest s > 0 with
// 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 = 0; infinity when there is none.
double fold_radius_squared(const Coefficients& d) {
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
  return kNoFold;
}

template <std::size_t N>
double value_at(const std::array<double, N>& polynomial, double t) {
  double value = 0.0;
  for (std::size_t i = N; i-- > 0;) value = value * t + polynomial[i];
  return value;
}

/// Whether a polynomial in Bernstein's form is positive on its interval: so it is where all of its
/// coefficients are, and halves are asked (de Casteljau) where they do not say.
template <std::size_t N>
bool is_positive(const std::array<double, N>& bernstein, int halvings) {
  if (!(bernstein.front() > 0.0 && bernstein.back() > 0.0)) return false;
  if (halvings == 0 || std::all_of(bernstein.begin(), bernstein.end(), [](double b) { return b > 0.0; }))
    return true;
  std::array<double, N> low, high = bernstein;
  for (std::size_t i = 0; i < N; ++i) {
    low[i] = high[0];
    for (std::size_t j = 0; j + i + 1 < N; ++j) high[j] = 0.5 * (high[j] + high[j + 1]);
  }
  return is_positive(low, halvings - 1) && is_positive(high, halvings - 1);
}

/// Bernstein's form of a polynomial between 0 and `t`.
template <std::size_t N>
std::array<double, N> bernstein_to(const std::array<double, N>& polynomial, double t) {
  std::array<double, N> bernstein{};
  double scaled = 1.0;  // t^i / binomial(N - 1, i)
  for (std::size_t i = 0; i < N; ++i) {
    double binomial = 1.0;  // of (j, i)
    for (std::size_t j = i; j < N; ++j) {
      bernstein[j] += binomial * scaled * polynomial[i];
      binomial *= static_cast<double>(j + 1) / static_cast<double>(j + 1 - i);
    }
    if (i + 1 < N) scaled *= t * static_cast<double>(i + 1) / static_cast<double>(N - 1 - i);
  }
  return bernstein;
}

/// Whether a polynomial is positive from 0 to `t`: so it is where its first coefficient outweighs all others;
/// else asked in stages, so that halves are small near 0.
template <std::size_t N>
bool is_positive_to(const std::array<double, N>& polynomial, double t) {
  double others = 0.0;
  for (std::size_t i = N; i-- > 1;) others = (others + std::abs(polynomial[i])) * t;
  if (polynomial[0] > others) return true;
  constexpr int halvings = 40;
  for (double end = 1.0; end < t; end *= 16.0)
    if (!is_positive(bernstein_to(polynomial, end), halvings)) return false;
  return is_positive(bernstein_to(polynomial, t), halvings);
}

// Brown-Conrady, of a rational lens over a denominator (OpenCV, "Camera Calibration and 3D Reconstruction"):
// the distorted normalised point, and its derivative by the undistorted one.
Eigen::Vector2d distort_radial(const Coefficients& d, const Eigen::Vector2d& p, Eigen::Matrix2d& by_p) {
  const double x = p.x(), y = p.y(), s = p.squaredNorm();
  const double above = 1.0 + s * (d[0] + s * (d[1] + s * d[4]));
  const double below = 1.0 + s * (d[5] + s * (d[6] + s * d[7]));
  const double above_by_s = d[0] + s * (2.0 * d[1] + s * 3.0 * d[4]);
  const double below_by_s = d[5] + s * (2.0 * d[6] + s * 3.0 * d[7]);
  const double radial = above / below;
  const double twice = 2.0 * (above_by_s - radial * below_by_s) / below;
  by_p(0, 0) = radial + x * x * twice + 2.0 * d[2] * y + 6.0 * d[3] * x;
  by_p(0, 1) = x * y * twice + 2.0 * d[2] * x + 2.0 * d[3] * y;
  by_p(1, 0) = by_p(0, 1);
  by_p(1, 1) = radial + y * y * twice + 6.0 * d[2] * y + 2.0 * d[3] * x;
  return {x * radial + 2.0 * d[2] * x * y + d[3] * (s + 2.0 * x * x),
          y * radial + d[2] * (s + 2.0 * y * y) + 2.0 * d[3] * x * y};
}

/// Of the rational model, in s = r^2, with N over D: N D + 2 s (N' D - N D'), the derivative of r N / D by r
/// times D^2.
std::array<double, 7> slope_of_rational(const Coefficients& d) {
  const std::array<double, 4> n{1.0, d[0], d[1], d[4]}, m{1.0, d[5], d[6], d[7]};
  std::array<double, 7> slope{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      slope[i + j] += n[i] * m[j] * (1.0 + 2.0 * (static_cast<double>(i) - static_cast<double>(j)));
  return slope;
}

/// Of the fisheye model, in the square of the angle.
std::array<double, 7> slope_of_angle(const Coefficients& d) {
  return {1.0, 3.0 * d[0], 5.0 * d[1], 7.0 * d[2], 9.0 * d[3], 0.0, 0.0};
}

/// The distorted angle.
double bent(const Coefficients& d, double angle) {
  const double t = angle * angle;
  return angle * (1.0 + t * (d[0] + t * (d[1] + t * (d[2] + t * d[3]))));
}

}  // namespace

LensDistortion::LensDistortion(const Coefficients& coefficients, Model model)
    : coefficients_(coefficients),
      model_(model),
      is_none_(model != Model::fisheye &&
               std::all_of(coefficients.begin(), coefficients.end(), [](double k) { return k == 0.0; })) {
  if (model == Model::fisheye) slope_ = slope_of_angle(coefficients);
  if (model == Model::rational) {
    slope_ = slope_of_rational(coefficients);
    divisor_ = {1.0, coefficients[5], coefficients[6], coefficients[7]};
  }
}

bool LensDistortion::rises_to(double squared) const {
  if (model_ == Model::plumb_bob) return rises_well_to(coefficients_, squared) || !(squared > fold_squared());
  if (model_ == Model::rational) return is_positive_to(divisor_, squared) && is_positive_to(slope_, squared);
  const double angle = std::atan(std::sqrt(squared));
  return is_positive_to(slope_, angle * angle);
}

double LensDistortion::fold_squared() const {
  if (model_ == Model::plumb_bob) return is_none_ ? kNoFold : fold_radius_squared(coefficients_);
  // By the angle, which has an end.
  const auto squared = [](double angle) { return std::tan(angle) * std::tan(angle); };
  if (rises_to(squared(kWidest))) return kNoFold;
  double low = 0.0, high = kWidest;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (rises_to(squared(middle)) ? low : high) = middle;
  }
  return squared(low);
}

Eigen::Vector2d LensDistortion::bend_angle(const Eigen::Vector2d& ray, Eigen::Matrix2d& by_ray) const {
  const double s = ray.squaredNorm();
  by_ray.setIdentity();
  if (s < 1e-18) return ray;
  const double radius = std::sqrt(s), angle = std::atan(radius);
  const double scale = bent(coefficients_, angle) / radius;
  const double outwards = value_at(slope_, angle * angle) / (1.0 + s);
  by_ray = scale * by_ray + (outwards - scale) / s * ray * ray.transpose();
  return scale * ray;
}

Eigen::Vector2d LensDistortion::bend(const Eigen::Vector2d& ray, Eigen::Matrix2d& by_ray) const {
  if (model_ == Model::fisheye) return bend_angle(ray, by_ray);
  return distort_radial(coefficients_, ray, by_ray);
}

std::optional<Eigen::Vector2d> LensDistortion::distort(const Eigen::Vector2d& ray,
                                                       Eigen::Matrix2d& by_ray) const {
  by_ray.setIdentity();
  if (is_none_) return ray;
  if (!rises_to(ray.squaredNorm())) return std::nullopt;
  const Eigen::Vector2d seen = bend(ray, by_ray);
  if (!(by_ray.determinant() > 0.0)) return std::nullopt;
  return seen;
}

std::optional<Eigen::Vector2d> LensDistortion::undistort(const Eigen::Vector2d& seen) const {
  if (is_none_) return seen;
  if (model_ == Model::plumb_bob) return undistort_polynomial(seen);
  return model_ == Model::rational ? undistort_rational(seen) : undistort_angle(seen);
}

std::optional<Eigen::Vector2d> LensDistortion::undistort_polynomial(const Eigen::Vector2d& seen) const {
  const double fold = fold_squared();
  Eigen::Vector2d ray = seen.squaredNorm() < fold ? seen : Eigen::Vector2d::Zero();
  for (int i = 0; i < 100; ++i) {
    Eigen::Matrix2d by_ray;
    const Eigen::Vector2d error = bend(ray, by_ray) - seen;
    if (error.squaredNorm() < 1e-26) return ray;
    const double det = by_ray.determinant();
    if (!(det > 0.0)) return std::nullopt;
    Eigen::Vector2d step = by_ray.inverse() * error;
    double shorten = 1.0;  // a Newton step that would cross the fold is halved until it stays inside
    while (shorten > 1e-9 && (ray - shorten * step).squaredNorm() >= fold) shorten *= 0.5;
    ray -= shorten * step;
  }
  Eigen::Matrix2d unused;
  return (bend(ray, unused) - seen).norm() < 1e-9 ? std::optional(ray) : std::nullopt;
}

/// Newton's steps, each halved until it stays within the fold and comes nearer.
std::optional<Eigen::Vector2d> LensDistortion::undistort_rational(const Eigen::Vector2d& seen) const {
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();
  Eigen::Matrix2d by_ray;
  Eigen::Vector2d error = bend(ray, by_ray) - seen;
  for (int i = 0; i < 100 && error.norm() > 1e-13; ++i) {
    if (!(by_ray.determinant() > 0.0)) return std::nullopt;
    const Eigen::Vector2d step = by_ray.inverse() * error;
    bool is_nearer = false;
    for (double share = 1.0; share > 1e-9 && !is_nearer; share *= 0.5) {
      const Eigen::Vector2d next = ray - share * step;
      if (!next.allFinite() || !rises_to(next.squaredNorm())) continue;
      Eigen::Matrix2d by_next;
      const Eigen::Vector2d left = bend(next, by_next) - seen;
      is_nearer = left.norm() < error.norm();
      if (!is_nearer) continue;
      ray = next;
      error = left;
      by_ray = by_next;
    }
    if (!is_nearer) break;
  }
  const double allowed = 1e-12 * std::max(1.0, seen.norm());
  return error.norm() <= allowed && by_ray.determinant() > 0.0 ? std::optional(ray) : std::nullopt;
}

/// Along the radius alone: Newton's steps between two angles that hold the one sought.
std::optional<Eigen::Vector2d> LensDistortion::undistort_angle(const Eigen::Vector2d& seen) const {
  const double radius = seen.norm();
  if (radius < 1e-9) return seen;
  double low = 0.0, high = std::min(kWidest, std::atan(std::sqrt(fold_squared())));
  if (!(bent(coefficients_, high) > radius)) return std::nullopt;
  double angle = std::min(radius, 0.5 * high);
  for (int i = 0; i < 200 && high - low > 1e-16 * high; ++i) {
    const double error = bent(coefficients_, angle) - radius;
    if (std::abs(error) < 1e-15 * std::max(1.0, radius)) break;
    (error < 0.0 ? low : high) = angle;
    const double next = angle - error / value_at(slope_, angle * angle);
    angle = next > low && next < high ? next : 0.5 * (low + high);
  }
  return Eigen::Vector2d(std::tan(angle) / radius * seen);
}

}  // namespace clearway
