// Configuration checks: ConfigurationSpace::is_free against FCL's shapes on an fcl::OcTree of the same map.
// Many in one call: uniform, near contact, and along slow motions; beside what spheres side by side alone
// decide. In `detail`: how often ours is wrong against brute force, and what its first stage alone would
// refuse.

#include "apps/bench/bench.hpp"
#include "apps/bench/peers/brute_force.hpp"
#include "apps/bench/worlds/panda_variants.hpp"
#include "planning/batch/configuration_block.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/fcl_octree_space.hpp"
#include "planning/space/body_collision.hpp"
#include "planning/space/collision_model.hpp"

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
  const auto reported = [](const Agreement& sum) {
    return nlohmann::ordered_json{{"checked", sum.checked},
                                  {"free", sum.free},
                                  {"wrongly_accepted", sum.wrongly_accepted},
                                  {"wrongly_refused", sum.wrongly_refused},
                                  {"widest_wrongly_refused_m", sum.widest}};
  };
  return {{"uniform", reported(uniform)}, {"borderline", reported(borderline)}};
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
  rate(space);
  rates.free_percent = 100.0 * static_cast<double>(free) / static_cast<double>(list.size());
  return rates;
}

constexpr std::size_t drawn = 2'000;

std::vector<Configuration> uniform(const ConfigurationSpace& space) {
  Dice dice(1);
  std::vector<Configuration> list(drawn);
  for (Configuration& q : list) q = dice.configuration(space.robot());
  return list;
}

/// Both ends of what is left of ways from free to blocked configurations, halved eight times: a few
/// millimetres from touching.
std::vector<Configuration> near_contact(const ConfigurationSpace& space) {
  Dice dice(2);
  std::vector<Configuration> list;
  while (list.size() < drawn) {
    Configuration free = dice.configuration(space.robot()), blocked = dice.configuration(space.robot());
    if (!space.is_free(free) || space.is_free(blocked)) continue;
    for (int k = 0; k < 8; ++k) {
      const Configuration middle = (free + blocked) / 2;
      (space.is_free(middle) ? free : blocked) = middle;
    }
    list.push_back(free);
    list.push_back(blocked);
  }
  return list;
}

/// A hundred on each of some straight ways between uniform ones.
std::vector<Configuration> along_ways(const ConfigurationSpace& space) {
  Dice dice(4);
  std::vector<Configuration> list;
  while (list.size() < drawn) {
    const Configuration from = dice.configuration(space.robot()), to = dice.configuration(space.robot());
    for (int k = 0; k < 100; ++k) list.push_back(from + k / 100.0 * (to - from));
  }
  return list;
}

/// Many in one call.
struct SpanRates {
  double exact = 0.0, conservative = 0.0;  ///< per s; what is not decided counts as not free for the latter
  double free = 0.0, undecided = 0.0;      ///< percent; by the former, by the latter
};

SpanRates measure_spans(const ConfigurationSpace& space, const std::vector<Configuration>& list, int runs) {
  const SphereRobot& spheres = *space.collision_model().spheres;
  ConfigurationBlock block(spheres);
  const auto count = static_cast<double>(list.size());
  SpanRates rates;
  std::vector<double> exact, conservative;
  for (int run = 0; run < runs; ++run) {
    std::vector<bool> answers;
    exact.push_back(count / cpu_seconds([&] { answers = space.is_free(list); }));
    rates.free = 100.0 * static_cast<double>(std::count(answers.begin(), answers.end(), true)) / count;
    std::size_t undecided = 0;
    conservative.push_back(
        count / cpu_seconds([&] {
          for (std::size_t first = 0; first < list.size(); first += ConfigurationBlock::most) {
            block.clear();
            for (std::size_t i = first; i < std::min(list.size(), first + ConfigurationBlock::most); ++i)
              block.add(list[i]);
            look(spheres, block);
            undecided += block.undecided();
          }
        }));
    rates.undecided = 100.0 * static_cast<double>(undecided) / count;
  }
  rates.exact = median(exact);
  rates.conservative = median(conservative);
  return rates;
}

/// Rows of the table of spans, for one robot.
void add_spans(const std::string& name, const ConfigurationSpace& space, int runs, Table& table,
               nlohmann::ordered_json& detail) {
  const auto balls = static_cast<double>(space.collision_model().spheres->tree.leaves.size());
  const std::pair<const char*, std::vector<Configuration>> draws[] = {
      {"uniform", uniform(space)}, {"near contact", near_contact(space)}, {"along ways", along_ways(space)}};
  for (const auto& [draw, list] : draws) {
    const SpanRates rates = measure_spans(space, list, runs);
    const double each = 1e9 / rates.conservative / balls;
    detail[draw] = {{"exact_per_s", rates.exact},
                    {"conservative_per_s", rates.conservative},
                    {"undecided_percent", rates.undecided},
                    {"free_percent", rates.free},
                    {"balls", balls},
                    {"ns_a_ball", each}};
    table.rows.push_back({name, draw, figure(rates.exact), figure(rates.conservative),
                          figure(rates.undecided) + " %", figure(rates.free) + " %", figure(balls),
                          figure(each)});
  }
}

/// Robots to measure; the less is judged of those that brute force is slow for.
struct NamedRobot {
  std::string name;
  Robot robot;
  int judged_runs;
};

std::vector<NamedRobot> robots(int runs) {
  std::vector<NamedRobot> list;
  for (const char* name : {"puma560", "panda", "arm6"}) list.push_back({name, load_robot(name), runs});
  const int fewer = std::max(1, runs / 5);
  list.push_back({"panda of 59 spheres", panda_of_spheres(59), fewer});
  list.push_back({"panda of meshes", panda_of_meshes(), fewer});
  return list;
}

std::vector<std::string> agreement_row(const std::string& name, const nlohmann::ordered_json& reported) {
  return {name, count_text(reported["checked"].get<double>()),
          count_text(reported["wrongly_accepted"].get<double>()),
          count_text(reported["wrongly_refused"].get<double>()),
          figure(1e6 * reported["widest_wrongly_refused_m"].get<double>())};
}

}  // namespace

BenchResult bench_checks(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  BenchResult result{0.0, 0.0, "FCL shapes on fcl::OcTree", "configurations/s", false, options.runs, {}};
  result.detail = {{"resolution", resolution}};
  Table speed{
      "", {"robot", "ours, per s", "FCL, per s", "ratio", "free", "free, but refused by balls alone"}, {}};
  Table spans{
      "Many in one call; beside it what spheres side by side decide alone, all else refused. A ball: of "
      "those that cover the robot, most of which are never looked up:",
      {"robot", "configurations", "exact, per s", "by spheres alone, per s", "undecided", "free", "balls",
       "ns a ball"},
      {}};
  Table errors{
      "Against brute force, every body against every blocked cube near it, three choices of policies:",
      {"configurations", "checked", "touching but accepted", "free but refused",
       "these at most from touching, um"},
      {}};
  double occupied = 0.0;
  for (const auto& [name, robot, judged_runs] : robots(options.runs)) {
    options.say("measuring " + name);
    const Snapshot map = ArmWorld{.resolution = resolution,
                                  .half = 1.2,
                                  .gap = resolution,
                                  .painted = 40,
                                  .critical = robot.critical_parts}
                             .snapshot(robot);
    const ConfigurationSpace space(robot, map, {.critical_by_default = false});
    const std::vector<Configuration> list = uniform(space);
    const ArmRates rates = measure_arm(space, list, options);
    options.say("judging " + name);
    const double by_spheres = refused_by_spheres(robot, map, list);
    const auto judged = count_errors(robot, map, judged_runs);
    occupied = static_cast<double>(map.counts().occupied);
    result.detail[name] = {{"ours_per_s", rates.per_second.ours},
                           {"peer_per_s", rates.per_second.peer},
                           {"occupied_voxels", occupied},
                           {"free_percent", rates.free_percent},
                           {"free_but_refused_by_balls_alone_percent", by_spheres},
                           {"against_brute_force", judged}};
    add_spans(name, space, options.runs, spans, result.detail[name]["together"]);
    const double ratio = rates.per_second.ours / rates.per_second.peer;
    speed.rows.push_back({name, figure(rates.per_second.ours), figure(rates.per_second.peer), figure(ratio),
                          figure(rates.free_percent) + " %", figure(by_spheres) + " %"});
    errors.rows.push_back(agreement_row(name + ", uniform", judged["uniform"]));
    errors.rows.push_back(agreement_row(name + ", some 10 um from touching", judged["borderline"]));
    if (result.ours == 0.0 || ratio < result.ratio()) {
      result.ours = rates.per_second.ours;
      result.peer = rates.per_second.peer;
    }
  }
  result.tables = {speed, spans, errors};
  result.compared =
      "2,000 random configurations in a furnished room of " + count_text(occupied) + " occupied voxels at " +
      length_text(resolution) +
      ": `ConfigurationSpace::is_free` against FCL's shapes on an `fcl::OcTree` of the same map, both "
      "with self-collision. The summary has the robot with the smaller ratio.";
  return result;
}

}  // namespace clearway::bench
