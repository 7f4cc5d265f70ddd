#include "tests/evidence/drawn_world.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

#include "planning/check/path_check_model.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/evidence/random_arm.hpp"

namespace clearway::evidence {
namespace {

/// Loaded as a user would load it: from a file.
Robot drawn_arm(Random& random, std::uint64_t seed) {
  const std::string text = random_arm_urdf(random, 3 + random.below(4));
  const auto file = std::filesystem::temp_directory_path() /
                    ("clearway_arm_" + std::to_string(::getpid()) + "_" + std::to_string(seed) + ".urdf");
  std::ofstream(file) << text;
  Robot robot = load_robot(file.string());
  check::require_same_poses(robot, check::KdlArm(robot));  // as each check would, were the file still there
  std::filesystem::remove(file);
  robot.source.clear();
  return robot;
}

Robot draw_robot(Random& random, std::uint64_t seed) {
  const auto known = available_robots();
  const int choice = random.below(static_cast<int>(known.size()) + 3);
  if (choice >= static_cast<int>(known.size())) return drawn_arm(random, seed);
  Robot robot = load_robot(known[static_cast<std::size_t>(choice)].first);
  if (random.below(3) == 0) robot = scaled(robot, random.between(0.3, 2.0));
  if (random.below(3) == 0) robot.map_from_base = random.pose(0.5);
  return robot;
}

/// Farthest that the middle of a body comes from the base, over seeded configurations.
double reach_of(const Robot& robot, Random& random) {
  double reach = 0.0;
  for (int i = 0; i < 200; ++i) {
    const LinkPoses poses = forward_kinematics(robot, random.configuration(robot));
    for (const Body& body : robot.bodies) {
      const Eigen::Vector3d middle =
          poses[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation();
      reach =
          std::max(reach, (middle - robot.map_from_base.translation()).norm() + body.shape.bounding_radius());
    }
  }
  return reach;
}

struct Draft {
  Robot robot;
  double reach = 0.0, resolution = 0.0;
  Eigen::Vector3d near(Random& random, double share) const {
    return robot.map_from_base.translation() + random.point(share * reach);
  }
};

using Boxes = std::vector<Eigen::AlignedBox3d>;

Boxes draw_boxes(const Draft& draft, Random& random) {
  Boxes boxes;
  for (int i = 2 + random.below(8); i > 0; --i) {
    const Eigen::Vector3d middle = draft.near(random, 0.9);
    const Eigen::Vector3d half =
        (random.point(1.0).cwiseAbs() * 0.15).array() * draft.reach + draft.resolution;
    boxes.emplace_back(middle - half, middle + half);
  }
  return boxes;
}

/// Where a ray from `origin` along the unit `direction` meets the nearest box; infinite when none.
double first_hit(const Boxes& boxes, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Eigen::AlignedBox3d& box : boxes) {
    const Eigen::Array3d a = (box.min() - origin).array() / direction.array(),
                         b = (box.max() - origin).array() / direction.array();
    const double in = a.min(b).maxCoeff(), out = a.max(b).minCoeff();
    if (in <= out && in > 0.0) nearest = std::min(nearest, in);
  }
  return nearest;
}

/// Rays in all directions from `origin`; those that meet nothing end three reaches away, in a far wall.
Scan look_round(const Draft& draft, const Boxes& boxes, const Eigen::Vector3d& origin, int rays,
                Random& random) {
  Scan scan;
  scan.map_from_sensor.translation() = origin;
  for (int i = 0; i < rays; ++i) {
    const Eigen::Vector3d direction = random.pose(1.0).linear().col(0);
    const double range = std::min(first_hit(boxes, origin, direction), 3.0 * draft.reach);
    scan.points.push_back((range * direction).cast<float>());
  }
  return scan;
}

void fill(FreeSpaceMap& map, const Boxes& boxes, double edge) {
  for (const Eigen::AlignedBox3d& box : boxes) {
    const Eigen::Array3i low = (box.min() / edge).array().floor().cast<int>(),
                         high = (box.max() / edge).array().floor().cast<int>();
    for (int x = low.x(); x <= high.x(); ++x)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int z = low.z(); z <= high.z(); ++z)
          if (x == low.x() || x == high.x() || y == low.y() || y == high.y() || z == low.z() || z == high.z())
            occupy(map, (Eigen::Array3d(x, y, z) + 0.5) * edge);
  }
}

/// Spheres all about the robot, a few places left out; then obstacles.
void paint_about(FreeSpaceMap& map, const Draft& draft, const Boxes& boxes, Random& random,
                 const std::vector<std::string>& critical_parts) {
  const int volume = map.add_volume("free", critical_parts);
  for (int i = 0; i < 120; ++i)
    map.paint(volume, {draft.near(random, 1.1), random.between(0.25, 0.6) * draft.reach});
  fill(map, boxes, draft.resolution);
}

Draft draw_draft(Random& random, std::uint64_t seed) {
  Draft draft{draw_robot(random, seed)};
  draft.reach = reach_of(draft.robot, random);
  draft.resolution = random.between(0.02, 0.06) * draft.reach;
  return draft;
}

DrawnWorld finished(Draft draft, const std::string& kind, const FreeSpaceMap& map, const Policies& policies,
                    Random& random) {
  const double padding = random.below(2) == 0 ? 0.0 : random.between(0.0, 0.01) * draft.reach;
  std::ostringstream what;
  what << draft.robot.name << " (scale " << draft.robot.scale << "), " << kind << ", voxels of "
       << draft.resolution << " m, padding " << padding << " m";
  return {what.str(), std::make_unique<ConfigurationSpace>(std::move(draft.robot), map.snapshot(), policies,
                                                           SpaceOptions{.padding = padding})};
}

}  // namespace

DrawnWorld draw_world_that_ends(std::uint64_t seed) {
  Random random(seed * 0x9e3779b97f4a7c15ULL + 2);
  Draft draft = draw_draft(random, seed);
  const Boxes boxes = draw_boxes(draft, random);
  FreeSpaceMap map({.resolution = draft.resolution, .discretize = true});
  for (int view = 1 + random.below(3); view > 0; --view)
    map.insert(look_round(draft, boxes, draft.near(random, 0.3), 2000, random),
               {.max_range = random.between(0.3, 0.9) * draft.reach});
  const Policies policies{.other = Policy::not_occupied, .critical_by_default = false};
  return finished(std::move(draft), "short looks", map, policies, random);
}

DrawnWorld draw_world(std::uint64_t seed) {
  Random random(seed * 0x9e3779b97f4a7c15ULL + 1);
  Draft draft = draw_draft(random, seed);
  const Boxes boxes = draw_boxes(draft, random);
  FreeSpaceMap map({.resolution = draft.resolution, .discretize = true});
  Policies policies;
  policies.critical_by_default = false;
  const int kind = random.below(4);
  constexpr std::array names{"obstacles", "paint", "scans", "painted tool"};
  if (kind == 0) fill(map, boxes, draft.resolution);
  if (kind == 1) paint_about(map, draft, boxes, random, {});
  if (kind == 2) {
    for (int view = 0; view < 4; ++view)
      map.insert(look_round(draft, boxes, draft.near(random, 1.0), 20000, random));
  }
  if (kind == 1 || kind == 2) policies.other = Policy::known_free;
  if (kind == 3) {
    paint_about(map, draft, boxes, random, {draft.robot.bodies.back().part});
    policies.critical_by_default = true;
  }
  return finished(std::move(draft), names[static_cast<std::size_t>(kind)], map, policies, random);
}

std::optional<std::pair<Configuration, Configuration>> draw_ends(const ConfigurationSpace& space,
                                                                 Random& random) {
  const double share = std::array{0.1, 0.3, 1.0}[static_cast<std::size_t>(random.below(3))];
  for (int i = 0; i < 400; ++i) {
    const Configuration start = random.configuration(space.robot());
    const Configuration goal = start + share * (random.configuration(space.robot()) - start);
    if (space.is_free(start) && space.is_free(goal)) return std::pair(start, goal);
  }
  return std::nullopt;
}

}  // namespace clearway::evidence
