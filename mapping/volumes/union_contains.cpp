// Bodies in the exact union of spheres: cubes that lie in one sphere, down to a tolerance.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "mapping/volumes/painted_body.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_cubes = 1'000'000;

/// The body's point that is nearest to `p`.
Eigen::Vector3d nearest_point(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius, bool flat,
                              const Eigen::Vector3d& p) {
  const double length = (b - a).norm();
  const Eigen::Vector3d axis = length > 0.0 ? Eigen::Vector3d((b - a) / length) : Eigen::Vector3d::Zero();
  const double along = (p - a).dot(axis);
  const double kept = std::clamp(along, 0.0, length);
  const Eigen::Vector3d foot = a + kept * axis;
  const Eigen::Vector3d away = flat ? Eigen::Vector3d(p - a - along * axis) : Eigen::Vector3d(p - foot);
  const double distance = away.norm();
  const Eigen::Vector3d off = distance > radius ? Eigen::Vector3d(away * (radius / distance)) : away;
  return foot + off;
}

template <class Body>
class UnionTest {
 public:
  UnionTest(const std::vector<Sphere>& spheres, const Body& body, bool flat, double tolerance)
      : spheres_(spheres), body_(body), flat_(flat), tolerance_(tolerance) {}

  /// Level by level, so that a point outside is found in as large a cube as shows it.
  Containment run() {
    lists_.emplace_back(spheres_.size());
    std::iota(lists_[0].begin(), lists_[0].end(), 0U);
    double half = 0.5 * (body_.b - body_.a).cwiseAbs().maxCoeff() + body_.radius;
    std::vector<Cube> cubes{{0.5 * (body_.a + body_.b), 0}};
    for (std::size_t looked = 0; !cubes.empty(); half *= 0.5) {
      looked += cubes.size();
      if (half < tolerance_ || looked > most_cubes) return Containment::undecided;
      std::vector<Cube> smaller;
      for (const Cube& cube : cubes) {
        if (!look(cube, half, smaller)) return Containment::outside;
      }
      cubes = std::move(smaller);
    }
    return Containment::inside;
  }

 private:
  struct Cube {
    Eigen::Vector3d center;
    std::size_t list;  ///< the spheres that may reach it, in `lists_`
  };

  /// False when a point of the body in the cube lies in no sphere. Leaves what one sphere does not hold to
  /// smaller cubes.
  bool look(const Cube& cube, double half, std::vector<Cube>& smaller) {
    const Eigen::Vector3d point = nearest_point(body_.a, body_.b, body_.radius, flat_, cube.center);
    if ((point - cube.center).norm() > std::sqrt(3.0) * half * (1.0 + 1e-9)) return true;
    std::vector<unsigned> near;
    bool held = false;
    for (const unsigned index : lists_[cube.list]) {
      const Sphere& sphere = spheres_[index];
      const Eigen::Array3d away = (sphere.center - cube.center).array().abs();
      const double squared = sphere.radius * sphere.radius;
      if ((away + half).square().sum() <= squared) return true;
      if ((away - half).max(0.0).square().sum() > squared) continue;
      near.push_back(index);
      held = held || (point - sphere.center).squaredNorm() <= squared;
    }
    const bool in_cube = ((point - cube.center).array().abs() <= half).all();
    if (in_cube && !held) return false;
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Array3d side(i & 1U ? 1.0 : -1.0, i & 2U ? 1.0 : -1.0, i & 4U ? 1.0 : -1.0);
      smaller.push_back({cube.center + (0.5 * half * side).matrix(), lists_.size()});
    }
    lists_.push_back(std::move(near));
    return true;
  }

  const std::vector<Sphere>& spheres_;
  Body body_;
  bool flat_;
  double tolerance_;
  std::vector<std::vector<unsigned>> lists_;
};

template <class Body>
Containment test(const std::vector<Sphere>& spheres, const Body& body, bool flat, double tolerance) {
  if (!body.a.allFinite() || !body.b.allFinite() || !std::isfinite(body.radius) || !(body.radius > 0.0) ||
      !(tolerance > 0.0)) {
    throw std::invalid_argument(
        "body in a union of balls: expected finite ends, a radius and a tolerance > 0 in metres");
  }
  return UnionTest<Body>(spheres, body, flat, tolerance).run();
}

}  // namespace

Containment union_contains(const std::vector<Sphere>& spheres, const Capsule& capsule, double tolerance) {
  return test(spheres, capsule, false, tolerance);
}

Containment union_contains(const std::vector<Sphere>& spheres, const Cylinder& cylinder, double tolerance) {
  return test(spheres, cylinder, cylinder.a != cylinder.b, tolerance);
}

}  // namespace clearway
