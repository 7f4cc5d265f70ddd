// clearway_bench NAME: one thing against its named peer, interleaved in one run.

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "apps/bench/bench.hpp"

namespace clearway::bench {
namespace {

struct Entry {
  const char* name;
  const char* what;
  Benchmark run;
};

constexpr Entry table[] = {
    {"insert", "scan insertion against OctoMap's insertPointCloud", bench_insert},
    {"erosion", "held-out surface points that the map calls free, ours in safe integration against OctoMap's",
     bench_erosion},
    {"field", "the distance field from nothing and its look-ups against dynamicEDT3D", bench_field},
    {"field_update", "the distance field after one more depth frame against dynamicEDT3D",
     bench_field_update},
    {"cast_ray", "rays through the map against OctoMap's castRay", bench_cast_ray},
    {"snapshot", "a snapshot against OctoMap's copy; readers beside a live writer", bench_snapshot},
    {"checks", "configuration checks against FCL shapes on fcl::OcTree", bench_checks},
    {"load", "loading a map of 10 million nodes against octomap::OcTree", bench_load},
    {"paint", "painting balls along a stroke against OctoMap's updateNode", bench_paint},
    {"bodies", "bodies in a painted volume: its voxels against the exact balls", bench_bodies},
    {"provenance", "inserting scans with keeping what they touched against without", bench_provenance},
    {"beam", "the beam search against its literal expansion", bench_beam},
    {"qp", "quadratic programs of the local step against the same method in dense matrices", bench_qp},
    {"control", "one control step of an arm against the same with FCL distances to fcl::OcTree",
     bench_control},
    {"live", "a control loop beside a thread that fuses depth frames against the same update in the loop",
     bench_live},
};

double machine_load() {
  double load = 0.0;
  std::ifstream("/proc/loadavg") >> load;
  return load;
}

void print(const Entry& entry, const BenchResult& result, double load, bool json) {
  const double ratio = result.smaller_is_better ? result.peer / result.ours : result.ours / result.peer;
  nlohmann::ordered_json line{
      {"name", entry.name},  {"ours", result.ours}, {"peer", result.peer}, {"peer_name", result.peer_name},
      {"unit", result.unit}, {"ratio", ratio},      {"runs", result.runs}, {"detail", result.detail}};
  line["detail"]["machine_load"] = load;
  if (json) {
    std::cout << line.dump() << std::endl;
    return;
  }
  std::printf("%-13s %10.4g %s   %s %10.4g %s   ratio %.3g   (%d runs, load %.2f)\n", entry.name, result.ours,
              result.unit.c_str(), result.peer_name.c_str(), result.peer, result.unit.c_str(), ratio,
              result.runs, load);
  for (const auto& [key, value] : result.detail.items()) std::cout << "  " << key << ": " << value << '\n';
  std::cout.flush();
}

int run(int argc, char** argv) {
  CLI::App app{"Measures one thing against its named peer, interleaved in one run."};
  std::string name;
  BenchOptions options;
  bool json = false;
  std::string names = "all";
  for (const Entry& entry : table) names += std::string("\n  ") + entry.name + ": " + entry.what;
  app.add_option("NAME", name, "What to measure: " + names)->required();
  app.add_option("--input", options.input, "Recording, map or cloud to measure on; without it, generated");
  app.add_option("--resolution", options.resolution, "Edge of a voxel, metres")->check(CLI::PositiveNumber);
  app.add_option("--runs", options.runs, "Interleaved runs")->check(CLI::Range(1, 100000));
  app.add_flag("--json", json, "One JSON object a benchmark on stdout");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  bool known = false;
  for (const Entry& entry : table) {
    if (name != "all" && name != entry.name) continue;
    known = true;
    const double load = machine_load();
    print(entry, entry.run(options), load, json);
  }
  if (known) return 0;
  std::cerr << "clearway_bench: unknown benchmark '" << name << "', expected " << names << '\n';
  return 2;
}

}  // namespace
}  // namespace clearway::bench

int main(int argc, char** argv) {
  try {
    return clearway::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "clearway_bench: " << error.what() << '\n';
    return 2;
  }
}
