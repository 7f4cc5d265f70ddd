#include "planning/geometry/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "planning/geometry/convex_hull.hpp"
#include "planning/geometry/farthest_vertex.hpp"

namespace clearway {
namespace {

/// `value`, when it is a size a body can have.
double checked_size(double value, const char* shape, const char* name, bool may_be_zero = false) {
  if (std::isfinite(value) && (value > 0.0 || (may_be_zero && value == 0.0))) return value;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << shape << " has " << name << " " << value << ", expected a finite number "
       << (may_be_zero ? "not below 0" : "above 0");
  throw std::invalid_argument(text.str());
}

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

}  // namespace

Shape Shape::sphere(double radius) {
  Shape shape;
  shape.kind_ = Kind::sphere;
  shape.radius_ = checked_size(radius, "sphere", "radius");
  return shape;
}

Shape Shape::capsule(double radius, double length) {
  Shape shape;
  shape.kind_ = Kind::capsule;
  shape.radius_ = checked_size(radius, "capsule", "radius");
  shape.length_ = checked_size(length, "capsule", "length", true);
  return shape;
}

Shape Shape::cylinder(double radius, double length) {
  Shape shape;
  shape.kind_ = Kind::cylinder;
  shape.radius_ = checked_size(radius, "cylinder", "radius");
  shape.length_ = checked_size(length, "cylinder", "length");
  return shape;
}

Shape Shape::box(const Eigen::Vector3d& edges) {
  Shape shape;
  shape.kind_ = Kind::box;
  for (int i = 0; i < 3; ++i) {
    shape.edges_[i] = checked_size(edges[i], "box", std::array{"x edge", "y edge", "z edge"}[i]);
  }
  return shape;
}

Shape Shape::convex(std::vector<Eigen::Vector3d> vertices) {
  if (vertices.empty()) throw std::invalid_argument("a convex body needs at least one vertex, got none");
  for (const Eigen::Vector3d& vertex : vertices) {
    if (!vertex.allFinite()) throw std::invalid_argument("a convex body has a vertex that is not finite");
  }
  Shape shape;
  shape.kind_ = Kind::convex;
  shape.vertices_ = hull_corners(std::move(vertices));
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : shape.vertices_) box.extend(vertex);
  shape.edges_ = box.sizes();
  shape.box_center_ = box.center();
  return shape;
}

Eigen::Vector3d Shape::support(const Eigen::Vector3d& direction) const {
  switch (kind_) {
    case Kind::sphere:
    case Kind::capsule: {
      const double norm = direction.norm();
      Eigen::Vector3d point =
          norm > 0.0 ? Eigen::Vector3d(direction * (radius_ / norm)) : Eigen::Vector3d(radius_, 0.0, 0.0);
      if (kind_ == Kind::capsule) point.z() += sign(direction.z()) * length_ / 2;
      return point;
    }
    case Kind::cylinder: {
      const double rho = direction.head<2>().norm();
      const double z = sign(direction.z()) * length_ / 2;
      if (rho == 0.0) return {radius_, 0.0, z};
      return {radius_ * direction.x() / rho, radius_ * direction.y() / rho, z};
    }
    case Kind::box:
      return {sign(direction.x()) * edges_.x() / 2, sign(direction.y()) * edges_.y() / 2,
              sign(direction.z()) * edges_.z() / 2};
    case Kind::convex:
      break;
  }
  return vertices_[farthest_vertex(vertices_, direction)];
}

Eigen::AlignedBox3d Shape::bounds(const Eigen::Isometry3d& pose) const {
  const Eigen::Matrix3d& rotation = pose.linear();
  Eigen::Vector3d half = Eigen::Vector3d::Constant(radius_);
  switch (kind_) {
    case Kind::sphere:
      break;
    case Kind::capsule:
      half += rotation.col(2).cwiseAbs() * (length_ / 2);
      break;
    case Kind::cylinder:
      for (int i = 0; i < 3; ++i) {
        half[i] =
            radius_ * std::hypot(rotation(i, 0), rotation(i, 1)) + std::abs(rotation(i, 2)) * length_ / 2;
      }
      break;
    case Kind::box:
      half = rotation.cwiseAbs() * (edges_ / 2);
      break;
    case Kind::convex: {
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& vertex : vertices_) box.extend(pose * vertex);
      return box;
    }
  }
  return {pose.translation() - half, pose.translation() + half};
}

double Shape::bounding_radius() const {
  switch (kind_) {
    case Kind::sphere:
      return radius_;
    case Kind::capsule:
      return radius_ + length_ / 2;
    case Kind::cylinder:
      return std::hypot(radius_, length_ / 2);
    case Kind::box:
      return edges_.norm() / 2;
    case Kind::convex:
      break;
  }
  return std::sqrt(largest_squared_norm(vertices_));
}

Sphere Shape::bounding_sphere() const {
  const Eigen::Vector3d middle = bounds(Eigen::Isometry3d::Identity()).center();
  if (kind_ != Kind::convex) return {middle, bounding_radius()};
  double squared = 0.0;
  for (const Eigen::Vector3d& vertex : vertices_)
    squared = std::max(squared, (vertex - middle).squaredNorm());
  return {middle, std::sqrt(squared)};
}

MedialSegment Shape::medial_segment() const {
  MedialSegment segment;
  segment.width = 2.0 * radius_;
  switch (kind_) {
    case Kind::sphere:
    case Kind::capsule:
      segment.half_length = length_ / 2;
      segment.half_extent = segment.half_length + radius_;
      return segment;
    case Kind::cylinder:
      segment.half_length = std::max(0.0, length_ / 2 - radius_);
      segment.half_extent = length_ / 2;
      return segment;
    case Kind::box:
    case Kind::convex:
      break;
  }
  int longest = 0;
  segment.half_extent = edges_.maxCoeff(&longest) / 2;
  segment.width = edges_.minCoeff();
  segment.half_length = std::max(0.0, segment.half_extent - segment.width / 2);
  segment.axis = Eigen::Vector3d::Unit(longest);
  return segment;
}

Shape Shape::grown(double padding) const {
  if (padding == 0.0) return *this;
  switch (kind_) {
    case Kind::sphere:
      return sphere(radius_ + padding);
    case Kind::capsule:
      return capsule(radius_ + padding, length_);
    case Kind::cylinder:
      return cylinder(radius_ + padding, length_ + 2 * padding);
    case Kind::box:
      return box((edges_.array() + 2 * padding).matrix());
    case Kind::convex:
      break;
  }
  std::vector<Eigen::Vector3d> corners;  // of a cube about each vertex
  for (const Eigen::Vector3d& vertex : vertices_) {
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3d side((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
      corners.push_back(vertex + padding * side);
    }
  }
  return convex(std::move(corners));
}

Shape Shape::scaled(double factor) const {
  Shape shape = *this;
  checked_size(factor, "a scaled body", "factor");
  shape.radius_ *= factor;
  shape.length_ *= factor;
  shape.edges_ *= factor;
  shape.box_center_ *= factor;
  for (Eigen::Vector3d& vertex : shape.vertices_) vertex *= factor;
  return shape;
}

double Shape::signed_distance(const Eigen::Vector3d& point) const {
  const auto of_extents = [](const auto& beyond) {  // beyond: how far outside along each own direction
    return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
  };
  switch (kind_) {
    case Kind::sphere:
      return point.norm() - radius_;
    case Kind::capsule: {
      const double beyond = std::max(std::abs(point.z()) - length_ / 2, 0.0);
      return Eigen::Vector3d(point.x(), point.y(), beyond).norm() - radius_;
    }
    case Kind::cylinder:
      return of_extents(Eigen::Vector2d(point.head<2>().norm() - radius_, std::abs(point.z()) - length_ / 2));
    case Kind::box:
    case Kind::convex:
      break;
  }
  return of_extents(Eigen::Vector3d((point - box_center_).cwiseAbs() - edges_ / 2));
}

Eigen::Vector3d Shape::offset_to(const Eigen::Vector3d& point) const {
  const auto past = [](double value, double half) { return value - std::clamp(value, -half, half); };
  switch (kind_) {
    case Kind::sphere:
    case Kind::capsule: {
      const Eigen::Vector3d offset(point.x(), point.y(), past(point.z(), length_ / 2));
      const double norm = offset.norm();
      return norm > radius_ ? Eigen::Vector3d(offset * (1.0 - radius_ / norm))
                            : Eigen::Vector3d(Eigen::Vector3d::Zero());
    }
    case Kind::cylinder: {
      const double rho = point.head<2>().norm();
      const double beyond = rho > radius_ ? 1.0 - radius_ / rho : 0.0;
      return {point.x() * beyond, point.y() * beyond, past(point.z(), length_ / 2)};
    }
    case Kind::box:
    case Kind::convex:
      break;
  }
  const Eigen::Vector3d local = point - box_center_;
  return local - local.cwiseMax(-edges_ / 2).cwiseMin(edges_ / 2);
}

}  // namespace clearway
