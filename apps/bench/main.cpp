// clearway_bench NAME: one thing against its named peer, interleaved in one run; all of them make a page.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/bench/bench.hpp"
#include "apps/bench/page/own_process.hpp"
#include "apps/bench/page/page.hpp"
#include "mapping/system/atomic_file.hpp"

namespace clearway::bench {
namespace {

/// At these numbers of runs each ends within a minute on one core of a small machine.
std::vector<Entry> all_entries() {
  return {
      {"insert", "scan insertion against OctoMap's insertPointCloud", 3, bench_insert},
      {"erosion",
       "held-out surface points that the map calls free, ours in safe integration against OctoMap's", 3,
       bench_erosion},
      {"field", "the distance field from nothing and its look-ups against dynamicEDT3D", 3, bench_field},
      {"field_update", "the distance field after one more depth frame against dynamicEDT3D", 5,
       bench_field_update},
      {"cast_ray", "rays through the map against OctoMap's castRay", 10, bench_cast_ray},
      {"snapshot", "a snapshot against OctoMap's copy; readers beside a live writer", 10, bench_snapshot},
      {"checks", "configuration checks against FCL shapes on fcl::OcTree", 10, bench_checks},
      {"edges", "edges proved free or refused against FCL shapes on fcl::OcTree every 0.01 rad", 3,
       bench_edges},
      {"plan", "whole queries against OMPL's RRT-Connect with FCL on fcl::OcTree, warm and after a change", 2,
       bench_plan},
      {"motion", "smooth motion along planned paths against the motion edge by edge", 1, bench_motion},
      {"load", "loading a map of 10 million nodes against octomap::OcTree", 6, bench_load},
      {"paint", "painting balls along a stroke against OctoMap's updateNode", 5, bench_paint},
      {"bodies", "bodies in a painted volume: its voxels beside the exact balls", 3, bench_bodies},
      {"provenance", "inserting scans with keeping what they touched against without", 10, bench_provenance},
      {"beam", "the beam search against its literal expansion", 3, bench_beam},
      {"qp", "quadratic programs of the local step against quadprog's Goldfarb-Idnani", 10, bench_qp},
      {"control", "one control step of an arm against the same with FCL distances to fcl::OcTree", 10,
       bench_control},
      {"live", "a control loop beside a thread that fuses depth frames against the same update in the loop",
       4, bench_live},
      {"gate", "verdicts on chunks beside a thread that fuses depth frames; FCL on samples of the same", 15,
       bench_gate},
      {"teach",
       "tags, poses and paint of large images, and their pictures, against Chong 2008's ten a second", 3,
       bench_teach},
      {"overlay", "drawing the live overlay against the time between two pictures", 40, bench_overlay},
      {"sweep", "what a problem costs `compare`, against its planning, check and motion", 3, bench_sweep},
  };
}

struct Flags {
  std::string name;
  BenchOptions options;
  bool json = false, markdown = false, progress = false;
  std::filesystem::path out;
};

std::string names_of(const std::vector<Entry>& entries) {
  std::string names = "all";
  for (const Entry& entry : entries) names += "\n  " + entry.name + ": " + entry.what;
  return names;
}

void add_flags(CLI::App& app, Flags& flags, const std::string& names) {
  app.add_option("NAME", flags.name, "What to measure: " + names)->required();
  app.add_option("--input", flags.options.input,
                 "Recording, map or cloud to measure on; without it, generated");
  app.add_option("--resolution", flags.options.resolution, "Edge of a voxel, metres")
      ->check(CLI::PositiveNumber);
  app.add_option("--runs", flags.options.runs,
                 "Interleaved runs; without it so many that a benchmark ends within a minute")
      ->check(CLI::Range(1, 100000));
  CLI::Option* json = app.add_flag("--json", flags.json, "One JSON object a benchmark on stdout");
  CLI::Option* markdown =
      app.add_flag("--markdown", flags.markdown, "Tables; of `all` the whole of BENCHMARKS.md")
          ->excludes(json);
  app.add_option("--out", flags.out, "File for --markdown; without it, stdout")->needs(markdown);
  app.add_flag("--progress", flags.progress, "A line on stderr for each run");
}

void print_json(const Outcome& outcome) {
  const BenchResult& result = outcome.result;
  nlohmann::ordered_json line{
      {"name", outcome.name}, {"ours", result.ours}, {"peer", result.peer}, {"peer_name", result.peer_name},
      {"unit", result.unit},  {"ratio", nullptr},    {"runs", result.runs}, {"detail", result.detail}};
  if (result.no_ratio.empty()) line["ratio"] = result.ratio();
  line["detail"]["machine_load"] = outcome.before.average;
  std::cout << line.dump() << std::endl;
}

void print_text(const Outcome& outcome) {
  const BenchResult& result = outcome.result;
  const std::string ratio = result.no_ratio.empty() ? "ratio " + figure(result.ratio()) : "no ratio";
  std::printf("%-13s %10.4g %s   %s %10.4g %s   %s   (%d runs, load %.2f)\n", outcome.name.c_str(),
              result.ours, result.units().c_str(), result.peer_name.c_str(), result.peer, result.unit.c_str(),
              ratio.c_str(), result.runs, outcome.before.average);
  for (const auto& [key, value] : result.detail.items()) std::cout << "  " << key << ": " << value << '\n';
  std::cout.flush();
}

/// The whole page of all benchmarks, the section of one.
void put_markdown(const Flags& flags, const std::vector<Outcome>& outcomes) {
  const std::string text =
      flags.name == "all" ? whole_page(this_origin(), outcomes) : section(outcomes.front());
  if (flags.out.empty()) {
    std::cout << text << std::flush;
  } else {
    save_file(flags.out, text);
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Measures one thing against its named peer, interleaved in one run."};
  std::vector<Entry> entries = all_entries();
  const std::string names = names_of(entries);
  Flags flags;
  add_flags(app, flags, names);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (flags.name != "all") std::erase_if(entries, [&](const Entry& one) { return one.name != flags.name; });
  for (Entry& entry : entries) entry.run = isolated(entry.run);
  if (entries.empty()) {
    std::cerr << "clearway_bench: unknown benchmark '" << flags.name << "', expected " << names << '\n';
    return 2;
  }
  if (!flags.out.empty()) require_writable(flags.out);
  const Progress progress{std::cerr, isatty(STDERR_FILENO) == 1, flags.progress};
  const auto outcomes = run_benchmarks(entries, flags.options, progress, [&](const Outcome& outcome) {
    if (!outcome.failure.empty() || flags.markdown) return;
    flags.json ? print_json(outcome) : print_text(outcome);
  });
  if (flags.markdown) put_markdown(flags, outcomes);
  return exit_status(outcomes);
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
