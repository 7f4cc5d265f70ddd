// Bodies in a painted volume: the voxel test against the exact union of spheres, in time and in answers.

#include <cmath>
#include <random>

#include "apps/bench/bench.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/volumes/painted_body.hpp"

namespace clearway::bench {
namespace {

constexpr double radius = 0.05;
constexpr int bodies_a_map = 40'000;

/// A winding stroke of spheres 1 cm apart.
std::vector<Sphere> stroke() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 150; ++i) {
    const double t = 0.033 * i;
    spheres.push_back({{0.3 * std::cos(t), 0.3 * std::sin(t), 0.1 * std::sin(1.7 * t)}, radius});
  }
  return spheres;
}

/// Spheres, capsules and cylinders about a sample of the stroke, of a fifth to nine tenths of its radius.
struct Body {
  Capsule capsule;
  bool flat = false;
};

std::vector<Body> random_bodies(const std::vector<Sphere>& spheres, int count) {
  std::mt19937 engine(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  std::vector<Body> bodies;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(uniform(0.0, static_cast<double>(spheres.size() - 12)));
    const auto off = [&]() -> Eigen::Vector3d {
      return Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * 0.4 * radius;
    };
    const Eigen::Vector3d a = spheres[at].center + off();
    const int kind = i % 3;  // sphere, capsule, cylinder
    const Eigen::Vector3d b = kind == 0 ? a : Eigen::Vector3d(spheres[at + 8].center + off());
    bodies.push_back({{a, b, radius * uniform(0.2, 0.9)}, kind == 2});
  }
  return bodies;
}

bool in_voxels(const PaintedSpace& space, const Body& body) {
  const Capsule& c = body.capsule;
  return body.flat ? space.contains(Cylinder{c.a, c.b, c.radius}) : space.contains(c);
}

Containment in_spheres(const std::vector<Sphere>& spheres, const Body& body, double tolerance) {
  const Capsule& c = body.capsule;
  return body.flat ? union_contains(spheres, Cylinder{c.a, c.b, c.radius}, tolerance)
                   : union_contains(spheres, c, tolerance);
}

}  // namespace

BenchResult bench_bodies(const BenchOptions& options) {
  const std::vector<Sphere> spheres = stroke();
  const std::vector<Body> bodies = random_bodies(spheres, bodies_a_map);
  std::vector<Containment> truth;
  const double exact = cpu_seconds([&] {
    for (const Body& body : bodies) truth.push_back(in_spheres(spheres, body, 1e-4));
  });
  BenchResult result{0.0, 1e6 * exact / bodies_a_map, "exact union of balls", "CPU us per body", true, 1, {}};
  std::vector<double> resolutions{0.01, 0.005, 0.0025};
  if (options.resolution > 0.0) resolutions = {options.resolution};
  for (const double resolution : resolutions) {
    FreeSpaceMap map({.resolution = resolution});
    map.add_volume("stroke", {});
    for (const Sphere& sphere : spheres) map.paint(0, sphere);
    const PaintedSpace space(map.snapshot(), 1);
    std::size_t inside = 0, held = 0, wrong = 0;
    const double seconds = cpu_seconds([&] {
      for (const Body& body : bodies) held += in_voxels(space, body) ? 1 : 0;
    });
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      inside += truth[i] == Containment::inside ? 1 : 0;
      if (truth[i] == Containment::inside || !in_voxels(space, bodies[i])) continue;
      const bool proved =
          truth[i] == Containment::undecided && in_spheres(spheres, bodies[i], 1e-7) == Containment::inside;
      wrong += proved ? 0 : 1;
    }
    result.ours = 1e6 * seconds / bodies_a_map;
    result.detail["at_" + std::to_string(static_cast<int>(std::lround(resolution * 1e5))) + "e-5_m"] = {
        {"bodies", bodies.size()},
        {"inside_balls", inside},
        {"inside_voxels", held},
        {"inside_voxels_not_balls", wrong},
        {"refused_share_of_inside",
         1.0 - static_cast<double>(held) / static_cast<double>(std::max<std::size_t>(inside, 1))},
        {"cpu_us_per_body", result.ours}};
  }
  return result;
}

}  // namespace clearway::bench
