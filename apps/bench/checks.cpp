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

constexpr int uniform_a_run = 5'000, borderline_a_run = 150;  ///< configurations of each arm to judge

/// Against brute force, by `runs` times as many configurations.
nlohmann::ordered_json count_errors(const Robot& robot, const Snapshot& map, int runs) {
  Agreement uniform, borderline;
  Dice dice(3);
  for (const Policies& policies : {Policies{.critical_by_default = false}, Policies{},
                                   Policies{.other = Policy::known_free, .critical_by_default = false}}) {
    const ConfigurationSpace space(robot, map, policies);
    const BruteForce truth = brute_force_of(space);
    uniform += compare(space, truth, dice, uniform_a_run * runs / 3 + 1, 0, 0);
    borderline +=
        compare(space, truth, dice, 0, borderline_a_run * runs / 3, 16);  // some 10 um from touching
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

/// One arm: both on the same configurations.
struct ArmRates {
  Pair per_second;
  double together = 0.0;  ///< ours, many in one call
  double free_percent = 0.0;
};

ArmRates measure_arm(const ConfigurationSpace& space, const std::vector<Configuration>& list,
                     const BenchOptions& options) {
  const FclOctreeSpace fcl(space);
  std::size_t free = 0;
  const auto rate = [&](const auto& checker) {
    free = 0;
    const double seconds = cpu_seconds([&] {
      for (const Configuration& q : list) free += checker.is_free(q);
    });
    return static_cast<double>(list.size()) / seconds;
  };
  ArmRates rates;
  rates.per_second = interleave(
      options, [&] { return rate(space); }, [&] { return rate(fcl); });
  std::vector<double> together;
  for (int run = 0; run < options.runs; ++run) {
    std::vector<bool> answers;
    const double seconds = cpu_seconds([&] { answers = space.is_free(list); });
    together.push_back(static_cast<double>(answers.size()) / seconds);
  }
  rates.together = median(together);
  rate(space);
  rates.free_percent = 100.0 * static_cast<double>(free) / static_cast<double>(list.size());
  return rates;
}

std::vector<std::string> agreement_row(const std::string& name, const nlohmann::ordered_json& told) {
  return {name, count_text(told["checked"].get<double>()), count_text(told["wrongly_accepted"].get<double>()),
          count_text(told["wrongly_refused"].get<double>()),
          figure(1e6 * told["widest_wrongly_refused_m"].get<double>())};
}

}  // namespace

BenchResult bench_checks(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  BenchResult result{0.0, 0.0, "FCL shapes on fcl::OcTree", "configurations/s", false, options.runs, {}};
  result.detail = {{"resolution", resolution}};
  Table speed{"",
              {"robot", "ours, per s", "many in one call, per s", "FCL, per s", "ratio", "free",
               "free, but refused by balls alone"},
              {}};
  Table errors{
      "Against brute force, every body against every blocked cube near it, three choices of policies:",
      {"configurations", "checked", "touching but accepted", "free but refused",
       "these at most from touching, um"},
      {}};
  double occupied = 0.0;
  for (const char* name : {"puma560", "panda", "arm6"}) {
    const Robot robot = load_robot(name);
    const Snapshot map = ArmWorld{.resolution = resolution,
                                  .half = 1.2,
                                  .gap = resolution,
                                  .painted = 40,
                                  .critical = robot.critical_parts}
                             .snapshot(robot);
    const ConfigurationSpace space(robot, map, {.critical_by_default = false});
    Dice dice(1);
    std::vector<Configuration> list(2'000);
    for (Configuration& q : list) q = dice.configuration(robot);
    const ArmRates rates = measure_arm(space, list, options);
    options.say(std::string("judging ") + name);
    const double by_spheres = refused_by_spheres(robot, map, list);
    const auto judged = count_errors(robot, map, options.runs);
    occupied = static_cast<double>(map.counts().occupied);
    result.detail[name] = {
        {"ours_per_s", rates.per_second.ours}, {"ours_together_per_s", rates.together},
        {"peer_per_s", rates.per_second.peer}, {"occupied_voxels", occupied},
        {"free_percent", rates.free_percent},  {"free_but_refused_by_balls_alone_percent", by_spheres},
        {"against_brute_force", judged}};
    const double ratio = rates.per_second.ours / rates.per_second.peer;
    speed.rows.push_back({name, figure(rates.per_second.ours), figure(rates.together),
                          figure(rates.per_second.peer), figure(ratio), figure(rates.free_percent) + " %",
                          figure(by_spheres) + " %"});
    errors.rows.push_back(agreement_row(std::string(name) + ", uniform", judged["uniform"]));
    errors.rows.push_back(
        agreement_row(std::string(name) + ", some 10 um from touching", judged["borderline"]));
    if (result.ours == 0.0 || ratio < result.ratio()) {
      result.ours = rates.per_second.ours;
      result.peer = rates.per_second.peer;
    }
  }
  result.tables = {speed, errors};
  result.compared =
      "2,000 random configurations in a furnished room of " + count_text(occupied) + " occupied voxels at " +
      length_text(resolution) +
      ": `ConfigurationSpace::is_free` against FCL's shapes on an `fcl::OcTree` of the same map, both "
      "with self-collision. The summary has the robot with the smaller ratio.";
  return result;
}

}  // namespace clearway::bench
