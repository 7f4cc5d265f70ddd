#include "apps/overlay/projector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace clearway {
namespace {

constexpr int deepest = 16;  ///< halvings of a triangle: only one at the lens's fold ever needs so many

/// Whether the piece lies on one side of the image.
template <std::size_t N>
bool is_beside(const std::array<ScreenCorner, N>& corners, const Camera& camera) {
  const auto all = [&](auto is_out) { return std::all_of(corners.begin(), corners.end(), is_out); };
  const auto width = static_cast<float>(camera.width), height = static_cast<float>(camera.height);
  constexpr float margin = 16.0F;  // lines have a width
  return all([&](const ScreenCorner& c) { return c.x < -margin; }) ||
         all([&](const ScreenCorner& c) { return c.y < -margin; }) ||
         all([&](const ScreenCorner& c) { return c.x > width + margin; }) ||
         all([&](const ScreenCorner& c) { return c.y > height + margin; });
}

/// Sutherland and Hodgman 1974: the part of a polygon where `side` >= 0.
template <class Corner, class Side, class Between>
std::vector<Corner> clipped(const std::vector<Corner>& polygon, Side side, Between between) {
  std::vector<Corner> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double at_from = side(from), at_to = side(to);
    if (at_from >= 0.0) kept.push_back(from);
    if ((at_from >= 0.0) != (at_to >= 0.0)) kept.push_back(between(from, to, at_from / (at_from - at_to)));
  }
  return kept;
}

CameraCorner camera_between(const CameraCorner& a, const CameraCorner& b, double share) {
  return {a.point + share * (b.point - a.point), a.light + share * (b.light - a.light)};
}

}  // namespace

Projector::Projector(const Camera& camera, const ProjectorOptions& options)
    : camera_(camera), options_(options), lens_(camera.distortion, camera.lens) {
  camera.validate();
  if (!(options.near > 0.0 && std::isfinite(options.near)))
    throw std::invalid_argument("projector: near is expected to be a distance > 0 m");
  if (!(options.tolerance > 0.0))
    throw std::invalid_argument("projector: tolerance is expected to be > 0 px");
  seen_ = seen_rays(camera);
  const double bend = camera.lens == LensDistortion::Model::plumb_bob ? strongest_bend() : 0.0;
  longest_squared_ = bend > 0.0 ? 8.0 * options.tolerance / bend : std::numeric_limits<double>::infinity();
}

/// The rectangle of the rays that end in the image, a little larger: lines have a width. Of a lens whose
/// field ends within the image, all of that field, a fisheye's up to 89 degrees.
Projector::Bounds Projector::seen_rays(const Camera& camera) {
  Eigen::AlignedBox2d box;
  const auto add = [&](const Eigen::Vector2d& pixel) {
    if (const auto ray = camera.undistort(pixel)) {
      box.extend(*ray);
      return;
    }
    constexpr double widest = 57.29;  // the tangent of 89 degrees
    const double end =
        std::min(widest, std::sqrt(LensDistortion(camera.distortion, camera.lens).fold_squared()));
    box.extend(Eigen::Vector2d(-end, -end));
    box.extend(Eigen::Vector2d(end, end));
  };
  constexpr int steps = 64;
  for (int i = 0; i <= steps; ++i) {
    const double x = -0.5 + camera.width * static_cast<double>(i) / steps;
    const double y = -0.5 + camera.height * static_cast<double>(i) / steps;
    for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(x, -0.5), Eigen::Vector2d(x, camera.height - 0.5),
                                         Eigen::Vector2d(-0.5, y), Eigen::Vector2d(camera.width - 0.5, y)})
      add(pixel);
  }
  const Eigen::Array2d margin = 0.05 * box.sizes().array();
  return {box.min().array() - margin, box.max().array() + margin};
}

/// The largest second derivative of the pixel along any straight line of the plane of rays, pixels: an edge
/// of length L leaves its chord by an eighth of it times L^2 at most. Sampled, with half as much again.
double Projector::strongest_bend() const {
  if (lens_.is_none()) return 0.0;
  constexpr int steps = 24;
  const Eigen::Array2d cell = (seen_.high - seen_.low) / steps;
  const double h = 0.25 * cell.minCoeff();
  double strongest = 0.0;
  Eigen::Matrix2d unused;
  const Eigen::Array2d focal(camera_.fx, camera_.fy);
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps; ++j) {
      const Eigen::Vector2d at = (seen_.low + cell * Eigen::Array2d(i, j)).matrix();
      for (const Eigen::Vector2d& way :
           {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(M_SQRT1_2, M_SQRT1_2),
            Eigen::Vector2d(M_SQRT1_2, -M_SQRT1_2)}) {
        const auto before = lens_.distort(at - h * way, unused), here = lens_.distort(at, unused),
                   after = lens_.distort(at + h * way, unused);
        if (!before || !here || !after) continue;
        const Eigen::Array2d second = (*before - 2.0 * *here + *after).array() / (h * h) * focal;
        strongest = std::max(strongest, second.matrix().norm());
      }
    }
  }
  return 1.5 * strongest;
}

Projector::RayCorner Projector::ray(const CameraCorner& corner) {
  const double inverse = 1.0 / corner.point.z();
  return {corner.point.x() * inverse, corner.point.y() * inverse, inverse, corner.light};
}

Projector::RayCorner Projector::between(const RayCorner& a, const RayCorner& b, double share) {
  return {a.u + share * (b.u - a.u), a.v + share * (b.v - a.v),
          a.inverse_depth + share * (b.inverse_depth - a.inverse_depth),
          a.light + share * (b.light - a.light)};
}

std::optional<ScreenCorner> Projector::screen(const RayCorner& corner) const {
  Eigen::Matrix2d unused;
  const auto seen = lens_.distort({corner.u, corner.v}, unused);
  if (!seen) return std::nullopt;
  return ScreenCorner{static_cast<float>(camera_.fx * seen->x() + camera_.cx),
                      static_cast<float>(camera_.fy * seen->y() + camera_.cy),
                      static_cast<float>(corner.inverse_depth), static_cast<float>(corner.light)};
}

std::optional<Eigen::Vector2d> Projector::pixel(const Eigen::Vector3d& point) const {
  if (!(point.z() >= options_.near) || !point.allFinite()) return std::nullopt;
  Eigen::Matrix2d unused;
  const auto seen = lens_.distort(point.head<2>() / point.z(), unused);
  if (!seen) return std::nullopt;
  return Eigen::Vector2d(camera_.fx * seen->x() + camera_.cx, camera_.fy * seen->y() + camera_.cy);
}

std::optional<ScreenCorner> Projector::plain_corner(const CameraCorner& corner) const {
  if (!(corner.point.z() >= options_.near)) return std::nullopt;
  const RayCorner at = ray(corner);
  const Eigen::Array2d size = seen_.high - seen_.low, uv(at.u, at.v);
  if (!(uv >= seen_.low - size).all() || !(uv <= seen_.high + size).all()) return std::nullopt;
  return screen(at);
}

/// Whether the lens moves the parts of an edge away from where they lie between the pixels of its ends. A
/// plumb bob bends alike everywhere, so its edges are asked for their length; a wide lens bends its middle
/// most, so there the pixels are compared.
bool Projector::is_bent(const RayCorner& a, const RayCorner& b) const {
  if (camera_.lens == LensDistortion::Model::plumb_bob) return is_long(a, b);
  const auto first = screen(a), last = screen(b);
  if (!first || !last) return false;  // `halve` asks where the field ends
  const Eigen::Array2d from(first->x, first->y), to(last->x, last->y);
  for (const double share : {0.25, 0.5, 0.75}) {
    const auto part = screen(between(a, b, share));
    if (!part) return true;
    const Eigen::Array2d off = Eigen::Array2d(part->x, part->y) - from - share * (to - from);
    if (off.matrix().norm() > 0.8 * options_.tolerance) return true;
  }
  return false;
}

bool Projector::is_plain(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) const {
  if (lens_.is_none()) return true;
  if (camera_.lens != LensDistortion::Model::plumb_bob) {
    const RayCorner at_a = ray({a, 1.0}), at_b = ray({b, 1.0}), at_c = ray({c, 1.0});
    return !is_bent(at_a, at_b) && !is_bent(at_b, at_c) && !is_bent(at_c, at_a);
  }
  const Eigen::Vector2d p = a.head<2>() / a.z(), q = b.head<2>() / b.z(), r = c.head<2>() / c.z();
  return (p - q).squaredNorm() <= longest_squared_ && (q - r).squaredNorm() <= longest_squared_ &&
         (r - p).squaredNorm() <= longest_squared_;
}

bool Projector::is_long(const RayCorner& a, const RayCorner& b) const {
  const double u = a.u - b.u, v = a.v - b.v;
  return u * u + v * v > longest_squared_;
}

/// The polygon that is left before the near plane and within the seen rays.
std::vector<Projector::RayCorner> Projector::cut(const std::array<CameraCorner, 3>& corners) const {
  std::vector<CameraCorner> front(corners.begin(), corners.end());
  if (std::any_of(front.begin(), front.end(),
                  [&](const CameraCorner& c) { return !(c.point.z() >= options_.near); }))
    front = clipped(
        front, [&](const CameraCorner& c) { return c.point.z() - options_.near; }, camera_between);
  std::vector<RayCorner> polygon;
  for (const CameraCorner& corner : front) polygon.push_back(ray(corner));
  polygon = clipped(
      polygon, [&](const RayCorner& c) { return c.u - seen_.low.x(); }, between);
  polygon = clipped(
      polygon, [&](const RayCorner& c) { return seen_.high.x() - c.u; }, between);
  polygon = clipped(
      polygon, [&](const RayCorner& c) { return c.v - seen_.low.y(); }, between);
  return clipped(
      polygon, [&](const RayCorner& c) { return seen_.high.y() - c.v; }, between);
}

void Projector::triangle(const std::array<CameraCorner, 3>& corners,
                         const std::function<void(const ScreenTriangle&)>& emit) const {
  for (const CameraCorner& corner : corners)
    if (!corner.point.allFinite()) return;
  const std::vector<RayCorner> polygon = cut(corners);
  for (std::size_t i = 2; i < polygon.size(); ++i) halve({polygon[0], polygon[i - 1], polygon[i]}, 0, emit);
}

void Projector::halve(const std::array<RayCorner, 3>& corners, int depth,
                      const std::function<void(const ScreenTriangle&)>& emit) const {
  ScreenTriangle drawn;
  int seen = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if (const auto corner = screen(corners[i])) {
      drawn[i] = *corner;
      ++seen;
    }
  std::size_t longest = 0;
  double length = -1.0;
  bool is_halved = seen == 1 || seen == 2;
  for (std::size_t i = 0; i < 3; ++i) {
    const RayCorner &a = corners[i], &b = corners[(i + 1) % 3];
    is_halved = is_halved || is_bent(a, b);
    const double squared = (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
    if (squared > length) {
      length = squared;
      longest = i;
    }
  }
  if (!is_halved || depth == deepest) {
    if (seen == 3 && !is_beside(drawn, camera_)) emit(drawn);
    return;
  }
  const RayCorner &a = corners[longest], &b = corners[(longest + 1) % 3], &c = corners[(longest + 2) % 3];
  const RayCorner middle = between(a, b, 0.5);
  halve({a, middle, c}, depth + 1, emit);
  halve({middle, b, c}, depth + 1, emit);
}

/// Where the pieces of a segment end, as shares of it.
std::vector<double> Projector::shares_of(const RayCorner& begin, const RayCorner& end) const {
  std::vector<double> shares;
  if (camera_.lens == LensDistortion::Model::plumb_bob) {
    const double length = std::hypot(begin.u - end.u, begin.v - end.v);
    const double count = std::clamp(std::ceil(length / std::sqrt(longest_squared_)), 1.0, 4096.0);
    for (double i = 1.0; i <= count; i += 1.0) shares.push_back(i / count);
    return shares;
  }
  constexpr double shortest = 1.0 / 4096.0;
  const std::function<void(double, double)> halve_between = [&](double from, double to) {
    const RayCorner a = between(begin, end, from), b = between(begin, end, to);
    const bool ends_field = screen(a).has_value() != screen(b).has_value();
    if (to - from > shortest && (ends_field || is_bent(a, b))) {
      halve_between(from, 0.5 * (from + to));
      halve_between(0.5 * (from + to), to);
    } else {
      shares.push_back(to);
    }
  };
  halve_between(0.0, 1.0);
  return shares;
}

std::vector<std::array<ScreenCorner, 2>> Projector::segment(const Eigen::Vector3d& from,
                                                            const Eigen::Vector3d& to) const {
  std::vector<std::array<ScreenCorner, 2>> pieces;
  if (!from.allFinite() || !to.allFinite()) return pieces;
  CameraCorner a{from, 1.0}, b{to, 1.0};
  const double near_a = from.z() - options_.near, near_b = to.z() - options_.near;
  if (near_a < 0.0 && near_b < 0.0) return pieces;
  if (near_a < 0.0) a = camera_between(a, b, near_a / (near_a - near_b));
  if (near_b < 0.0) b = camera_between(b, a, near_b / (near_b - (a.point.z() - options_.near)));
  RayCorner begin = ray(a), end = ray(b);
  const auto keep = [&](auto side) {  // Sutherland and Hodgman for two corners
    const double at_begin = side(begin), at_end = side(end);
    if (at_begin < 0.0 && at_end < 0.0) return false;
    if (at_begin < 0.0) begin = between(begin, end, at_begin / (at_begin - at_end));
    if (at_end < 0.0) end = between(end, begin, at_end / (at_end - side(begin)));
    return true;
  };
  if (!keep([&](const RayCorner& c) { return c.u - seen_.low.x(); }) ||
      !keep([&](const RayCorner& c) { return seen_.high.x() - c.u; }) ||
      !keep([&](const RayCorner& c) { return c.v - seen_.low.y(); }) ||
      !keep([&](const RayCorner& c) { return seen_.high.y() - c.v; }))
    return pieces;
  std::optional<ScreenCorner> last = screen(begin);
  for (const double share : shares_of(begin, end)) {
    const auto next = screen(between(begin, end, share));
    if (last && next && !is_beside<2>({*last, *next}, camera_)) pieces.push_back({*last, *next});
    last = next;
  }
  return pieces;
}

}  // namespace clearway
