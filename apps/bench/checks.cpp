// Configuration checks: ConfigurationSpace::is_free against FCL's shapes on an fcl::OcTree of the same map.
// In `detail`: how often ours is wrong against brute force, and what its first stage alone would refuse.

#include "apps/bench/bench.hpp"
#include "apps/bench/peers/brute_force.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/fcl_octree_space.hpp"
#include "planning/space/body_collision.hpp"

namespace clearway::bench {
namespace {

/// What the first stage, spheres against the field, would say alone.
class SpheresAlone {
 public:
  SpheresAlone(const Robot& robot, const Snapshot& map) {
    for (const Body& body : robot.bodies) {
      if (!is_moved(robot, body.link)) continue;
      const Eigen::AlignedBox3d reach = reach_box(robot, body);
      bodies_.emplace_back(body, map.blocked_space({}, reach, 0.5), reach);
    }
  }
  bool is_clear(const LinkPoses& poses) const {
    return std::all_of(bodies_.begin(), bodies_.end(), [&](const BodyCollision& body) {
      return body.quick_clearance(poses[static_cast<std::size_t>(body.body().link)]) > 0.0;
    });
  }

 private:
  std::vector<BodyCollision> bodies_;
};

constexpr int judged = 100'000;  ///< configurations of each arm against brute force

nlohmann::ordered_json count_errors(const Robot& robot, const Snapshot& map) {
  Agreement uniform, borderline;
  Dice dice(3);
  for (const Policies& policies : {Policies{.critical_by_default = false}, Policies{},
                                   Policies{.other = Policy::known_free, .critical_by_default = false}}) {
    const ConfigurationSpace space(robot, map, policies);
    const BruteForce truth = brute_force_of(space);
    uniform += compare(space, truth, dice, judged / 3 + 1, 0, 0);
    borderline += compare(space, truth, dice, 0, 2'000, 16);  // some 10 um from touching
  }
  const auto told = [](const Agreement& sum) {
    return nlohmann::ordered_json{{"checked", sum.checked},
                                  {"free", sum.free},
                                  {"wrongly_accepted", sum.wrongly_accepted},
                                  {"wrongly_refused", sum.wrongly_refused},
                                  {"widest_wrongly_refused_m", sum.widest}};
  };
  return {{"uniform", told(uniform)}, {"borderline", told(borderline)}};
}

/// Of the truly free configurations, those that spheres alone would refuse, percent.
double refused_by_spheres(const Robot& robot, const Snapshot& map, const std::vector<Configuration>& list) {
  const ConfigurationSpace space(robot, map, {.critical_by_default = false});
  const SpheresAlone spheres(robot, map);
  int free = 0, refused = 0;
  for (const Configuration& q : list) {
    if (!space.is_free(q)) continue;
    ++free;
    refused += !spheres.is_clear(forward_kinematics(robot, q));
  }
  return 100.0 * refused / std::max(free, 1);
}

}  // namespace

BenchResult bench_checks(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  std::vector<double> ours, peer;
  nlohmann::ordered_json detail{{"resolution", resolution}};
  for (const char* name : {"puma560", "panda"}) {
    const Robot robot = load_robot(name);
    const Snapshot map = ArmWorld{.resolution = resolution,
                                  .half = 1.2,
                                  .gap = resolution,
                                  .painted = 40,
                                  .critical = robot.critical_parts}
                             .snapshot(robot);
    const ConfigurationSpace space(robot, map, {.critical_by_default = false});
    const FclOctreeSpace fcl(space);
    Dice dice(1);
    std::vector<Configuration> list(2'000);
    for (Configuration& q : list) q = dice.configuration(robot);
    int free_ours = 0, free_peer = 0;
    const auto rate = [&](const auto& checker, std::size_t count, int& free) {
      free = 0;
      const double seconds = cpu_seconds([&] {
        for (std::size_t i = 0; i < count; ++i) free += checker.is_free(list[i]);
      });
      return static_cast<double>(count) / seconds;
    };
    const Pair pair = interleave(
        options.runs, [&] { return rate(space, list.size(), free_ours); },
        [&] { return rate(fcl, list.size() / 10, free_peer); });
    ours.push_back(pair.ours);
    peer.push_back(pair.peer);
    detail[name] = {{"ours_per_s", pair.ours},
                    {"peer_per_s", pair.peer},
                    {"occupied_voxels", map.counts().occupied},
                    {"free_percent", 100.0 * free_ours / static_cast<double>(list.size())},
                    {"free_but_refused_by_balls_alone_percent", refused_by_spheres(robot, map, list)},
                    {"against_brute_force", count_errors(robot, map)}};
  }
  return {*std::min_element(ours.begin(), ours.end()),
          *std::max_element(peer.begin(), peer.end()),
          "FCL shapes on fcl::OcTree",
          "configurations/s",
          false,
          options.runs,
          detail};
}

}  // namespace clearway::bench
