// Verdicts on chunks of 16 configurations beside a thread that fuses depth frames and publishes maps: how
// long each takes. Against FCL shapes on an fcl::OcTree at configurations 0.01 rad apart, which prove
// nothing.

#include <algorithm>
#include <atomic>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/live_world.hpp"
#include "apps/bench/worlds/arm_damper.hpp"
#include "apps/bench/worlds/arm_worlds.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/gate/gate.hpp"
#include "planning/sampling/fcl_octree_space.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t waypoints = 16, chunk_count = 600;
constexpr double period = 0.05;           ///< between configurations, s
constexpr double peer_chunk_step = 0.01;  ///< rad
constexpr double frames_per_second = 30.0;
constexpr double chunks_per_second = 100.0;

GateOptions limits_of_gate() { return {.limits = {.max_velocity = {1.0}, .deceleration = {5.0}}}; }

/// From a free configuration towards another one, slower or faster, with a bend.
std::vector<MotionChunk> draw_chunks(const ConfigurationSpace& space) {
  Dice dice(7);
  std::vector<MotionChunk> chunks;
  while (chunks.size() < chunk_count) {
    Configuration q = dice.configuration(space.robot());
    if (!space.is_free(q)) continue;
    Eigen::VectorXd way = dice.configuration(space.robot()) - q;
    const Eigen::VectorXd bend = dice.configuration(space.robot()) - q;
    const double step = period * dice.between(0.1, 0.9);
    MotionChunk chunk;
    for (std::size_t i = 0; i < waypoints; ++i) {
      chunk.times.push_back(period * static_cast<double>(i));
      chunk.positions.push_back(q);
      way += 0.05 * bend;
      q += step / way.cwiseAbs().maxCoeff() * way;
    }
    const bool is_within = std::all_of(chunk.positions.begin(), chunk.positions.end(), [&](const auto& at) {
      return limit_violation(space.robot(), at).empty();
    });
    if (is_within) chunks.push_back(std::move(chunk));
  }
  return chunks;
}

/// Seconds of each verdict.
struct Verdicts {
  std::vector<double> passed, passed_cpu, refused, refused_cpu;
  std::uint64_t maps = 0;
};

/// Judges chunks for so many seconds, paced.
Verdicts judge_chunks(Gate& gate, const std::vector<MotionChunk>& chunks, double duration) {
  Verdicts verdicts;
  const double begin = steady_seconds();
  for (std::size_t i = 0; steady_seconds() < begin + duration; ++i) {
    std::this_thread::sleep_until(steady_time(begin + static_cast<double>(i) / chunks_per_second));
    gate.restart();
    const double cpu = thread_cpu_seconds(), wall = steady_seconds();
    const GateVerdict verdict = gate.judge(chunks[i % chunks.size()]);
    const double took = steady_seconds() - wall, took_cpu = thread_cpu_seconds() - cpu;
    (verdict.is_passed() ? verdicts.passed : verdicts.refused).push_back(took);
    (verdict.is_passed() ? verdicts.passed_cpu : verdicts.refused_cpu).push_back(took_cpu);
    verdicts.maps = verdict.map;
  }
  return verdicts;
}

Json reported(const Verdicts& verdicts) {
  return {{"passed", verdicts.passed.size()},
          {"refused", verdicts.refused.size()},
          {"maps", verdicts.maps},
          {"passed_us", microseconds(verdicts.passed)},
          {"passed_cpu_us", microseconds(verdicts.passed_cpu)},
          {"refused_us", microseconds(verdicts.refused)},
          {"refused_cpu_us", microseconds(verdicts.refused_cpu)}};
}

Verdicts judge_beside_mapping(LiveWorld& world, Gate& gate, const std::vector<MotionChunk>& chunks,
                              double duration) {
  std::atomic<bool> done = false;
  std::thread mapper([&] {
    const double begin = steady_seconds();
    for (std::size_t next = 0; !done;) {
      std::this_thread::sleep_until(steady_time(begin + static_cast<double>(next) / frames_per_second));
      world.map.insert(world.frames[next % world.frames.size()].scan);
      gate.publish(world.space(world.map.snapshot()));
      next = std::max(next + 1, static_cast<std::size_t>((steady_seconds() - begin) * frames_per_second));
    }
  });
  Verdicts verdicts = judge_chunks(gate, chunks, duration);
  done = true;
  mapper.join();
  return verdicts;
}

/// The same edges, sampled. Returns whether all samples are free.
bool is_sampled_free(const FclOctreeSpace& fcl, const MotionChunk& chunk) {
  for (std::size_t i = 1; i < chunk.positions.size(); ++i) {
    const Eigen::VectorXd step = chunk.positions[i] - chunk.positions[i - 1];
    const int samples =
        std::max(1, static_cast<int>(std::ceil(step.cwiseAbs().maxCoeff() / peer_chunk_step)));
    for (int k = 0; k < samples; ++k) {
      if (!fcl.is_free(chunk.positions[i - 1] + static_cast<double>(k) / samples * step)) return false;
    }
  }
  return true;
}

/// CPU ms of a chunk that is passed, ours and the peer's.
Pair compare_alone(const BenchOptions& options, Gate& gate, const FclOctreeSpace& fcl,
                   const std::vector<MotionChunk>& chunks) {
  std::vector<MotionChunk> passed;
  for (const MotionChunk& chunk : chunks) {
    gate.restart();
    if (gate.judge(chunk).is_passed() && passed.size() < 100) passed.push_back(chunk);
  }
  const auto each_ms = [&](const auto& judge) {
    const double seconds = cpu_seconds([&] {
      for (const MotionChunk& chunk : passed) judge(chunk);
    });
    return 1e3 * seconds / static_cast<double>(passed.size());
  };
  return interleave(
      options,
      [&] {
        return each_ms([&](const MotionChunk& chunk) {
          gate.restart();
          return gate.judge(chunk).is_passed();
        });
      },
      [&] { return each_ms([&](const MotionChunk& chunk) { return is_sampled_free(fcl, chunk); }); });
}

std::vector<std::string> latency_row(const std::string& name, const Json& reported) {
  return {name, figure(reported["median"].get<double>()), figure(reported["p99"].get<double>()),
          figure(reported["max"].get<double>())};
}

Table verdict_table(const Json& detail) {
  Table table{"Verdicts:", {"us", "median", "p99", "most"}, {}};
  for (const auto& [key, name] :
       {std::pair{"alone", "alone"}, std::pair{"beside_mapping", "beside mapping"}}) {
    const Json& reported = detail[key];
    const std::string where = name;
    table.rows.push_back(latency_row("passed, " + where + ", wall", reported["passed_us"]));
    table.rows.push_back(latency_row("passed, " + where + ", CPU", reported["passed_cpu_us"]));
    table.rows.push_back(latency_row("refused, " + where + ", wall", reported["refused_us"]));
    table.rows.push_back(latency_row("refused, " + where + ", CPU", reported["refused_cpu_us"]));
  }
  return table;
}

/// "median and p99 beside mapping: passed 0.18, 0.49, refused 0.26, 0.86"
std::string latencies_in_ms(const Json& reported) {
  const auto pair = [&](const std::string& which) {
    const Json& us = reported[which + "_cpu_us"];
    return which + " " + figure(1e-3 * us["median"].get<double>()) + ", " +
           figure(1e-3 * us["p99"].get<double>());
  };
  return "median and p99 beside mapping: " + pair("passed") + ", " + pair("refused");
}

}  // namespace

BenchResult bench_gate(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  LiveWorld world = make_live_world(resolution, influence);
  const double duration = std::min(options.runs, 60);
  const ConfigurationSpace space = world.space(world.map.snapshot());
  const std::vector<MotionChunk> chunks = draw_chunks(space);
  Gate gate(limits_of_gate());
  gate.publish(world.space(world.map.snapshot()));
  options.say("alone");
  Json detail{{"resolution", resolution}, {"waypoints", waypoints}, {"seconds", duration}};
  detail["alone"] = reported(judge_chunks(gate, chunks, duration));
  options.say("beside mapping");
  detail["beside_mapping"] = reported(judge_beside_mapping(world, gate, chunks, duration));
  Gate still(limits_of_gate());
  still.publish(world.space(space.map()));
  BenchOptions fewer = options;
  fewer.runs = std::max(3, options.runs / 3);
  const Pair pair = compare_alone(fewer, still, FclOctreeSpace(space), chunks);
  BenchResult result{pair.ours,
                     pair.peer,
                     "FCL shapes on fcl::OcTree, 0.01 rad apart, no stop",
                     "CPU ms per passed chunk of 16 configurations",
                     true,
                     options.runs,
                     detail};
  result.compared =
      "Chunks of 16 configurations, 50 ms apart, of a PUMA 560 in a room at " + length_text(resolution) +
      ", proved with their stops, 100 each second: alone, and while 640 × 480 frames come at 30 Hz and each "
      "makes a new map. The peer samples the same edges and proves nothing.";
  result.tables = {verdict_table(detail)};
  result.also = latencies_in_ms(detail["beside_mapping"]);
  return result;
}

}  // namespace clearway::bench
