#include "tests/evidence/path_evidence.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <memory>

#include "mapping/continued_map.hpp"
#include "planning/check/path_check.hpp"
#include "planning/planner_table.hpp"
#include "planning/problem/planner.hpp"
#include "tests/evidence/drawn_world.hpp"
#include "tests/evidence/exact_violation.hpp"

namespace clearway::evidence {
namespace {

/// The slow twin and what improves its path until time is out look less long.
PlannerOptions brief(std::string_view planner) {
  if (planner == "rrtstar" || planner.starts_with("bitstar")) return {{"max_samples", "400"}};
  if (planner == "beam_reference") return {{"width", "2"}, {"max_steps", "40"}};
  if (planner == "beam") return {{"width", "5"}};
  return {};
}

std::function<bool()> deadline(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  return [end] { return std::chrono::steady_clock::now() > end; };
}

PathVerdict verdict_of(const ConfigurationSpace& space, const std::vector<Configuration>& path) {
  return check_path(space.robot(), space.map(), space.policies(), space.options().padding, path);
}

void count(Tally& tally, const PathVerdict& verdict) {
  ++tally.solved;
  ++(verdict.valid ? tally.accepted : verdict.undecided ? tally.undecided : tally.refused);
}

}  // namespace

void Evidence::add(const Evidence& other) {
  for (const auto& [name, tally] : other.tallies) {
    Tally& sum = tallies[name];
    sum.asked += tally.asked;
    sum.solved += tally.solved;
    sum.accepted += tally.accepted;
    sum.undecided += tally.undecided;
    sum.refused += tally.refused;
  }
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
}

Evidence plan_problems(std::uint64_t seed, std::uint64_t begin, std::uint64_t end) {
  Evidence evidence;
  DrawnWorld world;
  std::map<std::string_view, std::unique_ptr<Planner>> planners;  // of this world: some read its map once
  std::uint64_t of_world = ~std::uint64_t{0};
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::uint64_t number = seed * 1000003 + i / problems_of_a_world;
    if (of_world != number) {
      planners.clear();
      world = draw_world(of_world = number);
    }
    const PlannerEntry& planner = planner_table()[i % planner_table().size()];
    Random random(seed * 0x2545f4914f6cdd1dULL + i);
    const auto ends = draw_ends(*world.space, random);
    Tally& tally = evidence.tallies[std::string(planner.name)];
    ++tally.asked;
    if (!ends) continue;
    const PathCost cost(world.space->robot());
    std::unique_ptr<Planner>& made = planners[planner.name];
    if (!made) made = planner.make(brief(planner.name));
    const PlanResult result =
        made->plan({*world.space, cost, ends->first, ends->second, i + 1, deadline(0.3)});
    if (result.status != PlanStatus::solved) continue;
    const PathVerdict verdict = verdict_of(*world.space, result.waypoints);
    count(tally, verdict);
    if (verdict.valid || !planner.certifies) continue;
    evidence.broken.push_back("problem " + std::to_string(i) + ", " + std::string(planner.name) + ", " +
                              world.what + ": " + (verdict.undecided ? "undecided: " : "") +
                              verdict.first_contact);
  }
  return evidence;
}

namespace {

/// A valid path altered, and the map and robot that it is then judged in.
struct Altered {
  std::string how;
  Robot robot;
  Snapshot map;
  std::vector<Configuration> path;
  bool is_past_limit = false;
};

Snapshot with_obstacle(const Snapshot& map, const Robot& robot, const Configuration& q, Random& random) {
  const int last = static_cast<int>(robot.bodies.size()) - 1;
  const Body& body = robot.bodies[static_cast<std::size_t>(last - random.below(std::min(2, last + 1)))];
  const Eigen::Vector3d middle =
      forward_kinematics(robot, q)[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation();
  Scan scan;
  scan.map_from_sensor.translation() = ((middle / map.resolution()).array().floor() + 0.5) * map.resolution();
  scan.points = {Eigen::Vector3f(static_cast<float>(0.01 * map.resolution()), 0.0F, 0.0F)};
  ContinuedMap continued(map, {.resolution = map.resolution()});
  continued.insert(scan);
  return continued.snapshot();
}

Altered alter(const ConfigurationSpace& space, std::vector<Configuration> path, Random& random) {
  Altered altered{"", space.robot(), space.map(), std::move(path)};
  auto& way = altered.path;
  const auto any = [&] { return static_cast<std::size_t>(random.below(static_cast<int>(way.size()))); };
  switch (random.below(12)) {
    case 0:
    case 1:
    case 2: {
      altered.how = "a waypoint moved";
      Configuration& q = way[any()];
      q += random.between(0.1, 1.0) * (random.configuration(altered.robot) - q);
      break;
    }
    case 3:
      altered.how = "all but start and goal left out";
      if (way.size() > 2) way = {way.front(), way.back()};
      break;
    case 4:
    case 5:
      altered.how = "two waypoints exchanged";
      std::swap(way[any()], way[any()]);
      break;
    case 6:
    case 7:
    case 8:
      altered.how = "the base moved";
      altered.robot.map_from_base.translation() += 10.0 * space.map().resolution() * random.point(1.0);
      break;
    case 9:
    case 10:
      altered.how = "an obstacle put in the way";
      altered.map = with_obstacle(space.map(), altered.robot, way[any()], random);
      break;
    default: {
      altered.how = "a joint led past its limit";
      const auto j = static_cast<std::size_t>(random.below(static_cast<int>(altered.robot.dof())));
      const double upper = altered.robot.joints[j].upper;
      if (!std::isfinite(upper)) break;
      way[any()][static_cast<Eigen::Index>(j)] = upper + random.between(0.001, 0.1);
      altered.is_past_limit = true;
    }
  }
  return altered;
}

/// A valid path of short edges and long ones, found by walking.
std::vector<Configuration> walk(const ConfigurationSpace& space, Random& random) {
  const auto ends = draw_ends(space, random);
  if (!ends) return {};
  std::vector<Configuration> path{ends->first};
  for (int i = 0; i < 60 && path.size() < 5; ++i) {
    const Configuration next =
        path.back() + random.between(0.02, 0.4) * (random.configuration(space.robot()) - path.back());
    if (space.is_edge_free(path.back(), next)) path.push_back(next);
  }
  return path.size() < 2 ? std::vector<Configuration>{} : path;
}

}  // namespace

Evidence alter_paths(std::uint64_t seed, std::uint64_t number) {
  constexpr double depth = 0.001;
  Evidence evidence;
  std::uint64_t violated = 0;
  for (std::uint64_t world_seed = seed * 1000003; violated < number; ++world_seed) {
    const DrawnWorld world = draw_world(world_seed);
    Random random(world_seed + 7);
    for (int i = 0; i < 16 && violated < number; ++i) {
      const std::vector<Configuration> path = walk(*world.space, random);
      if (path.empty()) break;
      const Altered altered = alter(*world.space, path, random);
      Tally& tally = evidence.tallies[altered.how];
      ++tally.asked;
      if (!altered.is_past_limit &&
          !is_violated(altered.robot, altered.map, world.space->policies(), altered.path, depth, 40))
        continue;
      ++violated;
      const PathVerdict verdict =
          check_path(altered.robot, altered.map, world.space->policies(), 0.0, altered.path);
      count(tally, verdict);
      if (verdict.valid)
        evidence.broken.push_back("world " + std::to_string(world_seed) + ", path " + std::to_string(i) +
                                  ", " + altered.how + ", " + world.what + ": held valid");
    }
  }
  return evidence;
}

}  // namespace clearway::evidence
