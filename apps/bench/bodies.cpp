// Bodies in a painted volume: what its voxels answer beside the exact union of spheres, and what each costs.
// The two are ours and answer different questions: voxels refuse what lies between them and the spheres'
// surface.

#include <algorithm>
#include <cmath>
#include <random>

#include "apps/bench/bench.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/volumes/painted_body.hpp"

namespace clearway::bench {
namespace {

constexpr double stroke_radius = 0.05;
constexpr int bodies_a_map = 40'000;

/// A winding stroke of spheres 1 cm apart.
std::vector<Sphere> stroke() {
  std::vector<Sphere> spheres;
  for (int i = 0; i < 150; ++i) {
    const double t = 0.033 * i;
    spheres.push_back({{0.3 * std::cos(t), 0.3 * std::sin(t), 0.1 * std::sin(1.7 * t)}, stroke_radius});
  }
  return spheres;
}

/// Spheres, capsules and cylinders about a sample of the stroke, of a fifth to nine tenths of its radius.
struct RandomBody {
  Capsule capsule;
  bool flat = false;
};

std::vector<RandomBody> random_bodies(const std::vector<Sphere>& spheres, int count) {
  std::mt19937 engine(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  std::vector<RandomBody> bodies;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(uniform(0.0, static_cast<double>(spheres.size() - 12)));
    const auto off = [&]() -> Eigen::Vector3d {
      return Eigen::Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)) * 0.4 * stroke_radius;
    };
    const Eigen::Vector3d a = spheres[at].center + off();
    const int kind = i % 3;  // sphere, capsule, cylinder
    const Eigen::Vector3d b = kind == 0 ? a : Eigen::Vector3d(spheres[at + 8].center + off());
    bodies.push_back({{a, b, stroke_radius * uniform(0.2, 0.9)}, kind == 2});
  }
  return bodies;
}

bool in_voxels(const PaintedSpace& space, const RandomBody& body) {
  const Capsule& c = body.capsule;
  return body.flat ? space.contains(Cylinder{c.a, c.b, c.radius}) : space.contains(c);
}

Containment in_spheres(const std::vector<Sphere>& spheres, const RandomBody& body, double tolerance) {
  const Capsule& c = body.capsule;
  return body.flat ? union_contains(spheres, Cylinder{c.a, c.b, c.radius}, tolerance)
                   : union_contains(spheres, c, tolerance);
}

/// What the voxels of one size answer.
struct VoxelAnswers {
  double us = 0.0;  ///< CPU time per body, median of the runs
  std::size_t inside = 0, held = 0,
              wrong = 0;  ///< in the spheres; in the voxels; of these not in the spheres

  double refused() const {
    return 1.0 - static_cast<double>(held) / static_cast<double>(std::max<std::size_t>(inside, 1));
  }
};

VoxelAnswers ask_voxels(const std::vector<Sphere>& spheres, const std::vector<RandomBody>& bodies,
                        const std::vector<Containment>& truth, double resolution, int runs) {
  FreeSpaceMap map({.resolution = resolution});
  map.add_volume("stroke", {});
  for (const Sphere& sphere : spheres) map.paint(0, sphere);
  const PaintedSpace space(map.snapshot(), 1);
  VoxelAnswers answers;
  std::vector<double> seconds;
  for (int run = 0; run < runs; ++run) {
    answers.held = 0;
    seconds.push_back(cpu_seconds([&] {
      for (const RandomBody& body : bodies) answers.held += in_voxels(space, body) ? 1 : 0;
    }));
  }
  answers.us = 1e6 * median(seconds) / static_cast<double>(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    answers.inside += truth[i] == Containment::inside ? 1 : 0;
    if (truth[i] == Containment::inside || !in_voxels(space, bodies[i])) continue;
    const bool proved =
        truth[i] == Containment::undecided && in_spheres(spheres, bodies[i], 1e-7) == Containment::inside;
    answers.wrong += proved ? 0 : 1;
  }
  return answers;
}

}  // namespace

BenchResult bench_bodies(const BenchOptions& options) {
  const std::vector<Sphere> spheres = stroke();
  const std::vector<RandomBody> bodies = random_bodies(spheres, bodies_a_map);
  std::vector<Containment> truth;
  std::vector<double> seconds;
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    truth.clear();
    seconds.push_back(cpu_seconds([&] {
      for (const RandomBody& body : bodies) truth.push_back(in_spheres(spheres, body, 1e-4));
    }));
  }
  BenchResult result{0.0,
                     1e6 * median(seconds) / bodies_a_map,
                     "exact union of balls",
                     "CPU us per body",
                     true,
                     options.runs,
                     {}};
  Table table{"", {"test", "us per body", "inside", "refused though inside the balls", "wrongly inside"}, {}};
  std::vector<double> resolutions{0.01, 0.005, 0.0025};
  if (options.resolution > 0.0) resolutions = {options.resolution};
  for (const double resolution : resolutions) {
    const VoxelAnswers answers = ask_voxels(spheres, bodies, truth, resolution, options.runs);
    result.ours = answers.us;
    result.detail["at_" + std::to_string(static_cast<int>(std::lround(resolution * 1e5))) + "e-5_m"] = {
        {"bodies", bodies.size()},
        {"inside_balls", answers.inside},
        {"inside_voxels", answers.held},
        {"inside_voxels_not_balls", answers.wrong},
        {"refused_share_of_inside", answers.refused()},
        {"cpu_us_per_body", answers.us}};
    table.rows.push_back({"voxels of " + length_text(resolution), figure(answers.us),
                          count_text(static_cast<double>(answers.held)), percent(answers.refused()),
                          std::to_string(answers.wrong)});
  }
  const auto inside = std::count(truth.begin(), truth.end(), Containment::inside);
  table.rows.push_back(
      {"exact union of balls", figure(result.peer), count_text(static_cast<double>(inside)), "–", "–"});
  result.tables = {table};
  result.compared =
      "40,000 random bodies (ball, capsule, cylinder) about a stroke of 150 balls of 5 cm, most of them "
      "near its surface: the test on voxels beside the exact test on the balls.";
  result.no_ratio =
      "both tests are ours, and the one on voxels refuses what lies between them and the balls.";
  return result;
}

}  // namespace clearway::bench
