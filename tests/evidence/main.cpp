// What no single test can show: many drawn problems, altered paths and chunks, put to the independent check.
//   clearway_evidence problems --count 10000 --seed 1 --jobs 2
//   clearway_evidence altered --count 2000 --seed 1 --jobs 2
//   clearway_evidence gate --count 1000000 --seed 1 --jobs 2
// Prints one JSON object; exit status 1 when a promise is broken. The same seed draws the same problems.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <functional>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/evidence/gate_evidence.hpp"
#include "tests/evidence/path_evidence.hpp"

namespace {

using clearway::evidence::Evidence;
using clearway::evidence::GateEvidence;

/// Parts of the work, shared by threads; added up in order, so that the result does not depend on them.
template <class Sum>
Sum in_parts(std::uint64_t count, unsigned jobs, const std::function<Sum(std::uint64_t)>& work) {
  std::vector<Sum> parts(count);
  std::atomic<std::uint64_t> next{0};
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < jobs; ++i) {
    threads.emplace_back([&] {
      for (std::uint64_t part = next++; part < count; part = next++) parts[part] = work(part);
    });
  }
  for (std::thread& thread : threads) thread.join();
  Sum sum;
  for (const Sum& part : parts) sum.add(part);
  return sum;
}

nlohmann::ordered_json to_json(const std::string& what, std::uint64_t seed, const Evidence& evidence) {
  nlohmann::ordered_json json{{"name", what}, {"seed", seed}};
  clearway::evidence::Tally sum;
  Evidence all;
  for (const auto& [name, tally] : evidence.tallies) {
    const nlohmann::ordered_json row{{"asked", tally.asked},
                                     {what == "problems" ? "solved" : "violated", tally.solved},
                                     {"held_valid", tally.accepted},
                                     {"undecided", tally.undecided},
                                     {"refused", tally.refused}};
    json["by"][name] = row;
    sum.asked += tally.asked;
    sum.solved += tally.solved;
  }
  json["asked"] = sum.asked;
  json[what == "problems" ? "solved" : "violated"] = sum.solved;
  json["broken"] = evidence.broken;
  return json;
}

nlohmann::ordered_json to_json(std::uint64_t seed, const GateEvidence& evidence) {
  return {{"name", "gate"},
          {"seed", seed},
          {"asked", evidence.asked},
          {"hostile", evidence.hostile},
          {"passed", evidence.passed},
          {"refused", evidence.refused},
          {"checked_edges", evidence.checked_edges},
          {"clear", evidence.clear},
          {"clear_but_refused", evidence.clear_but_refused},
          {"broken", evidence.broken}};
}

int run_gate(std::uint64_t count, std::uint64_t seed, unsigned jobs) {
  constexpr std::uint64_t each = clearway::evidence::chunks_of_a_world;
  const GateEvidence evidence = in_parts<GateEvidence>((count + each - 1) / each, jobs, [&](std::uint64_t i) {
    return clearway::evidence::judge_chunks(seed, i, std::min(each, count - i * each));
  });
  std::cout << to_json(seed, evidence).dump(2) << std::endl;
  return evidence.broken.empty() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Drawn problems, altered paths and chunks, put to the independent check."};
  std::string what;
  std::uint64_t count = 240, seed = 1;
  unsigned jobs = 1;
  app.add_option("WHAT", what, "problems, altered or gate")
      ->required()
      ->check(CLI::IsMember({"problems", "altered", "gate"}));
  app.add_option("--count", count, "Problems, altered paths that are violated, or chunks");
  app.add_option("--seed", seed, "The same seed draws the same");
  app.add_option("--jobs", jobs, "Threads")->check(CLI::Range(1U, 64U));
  CLI11_PARSE(app, argc, argv);
  if (what == "gate") return run_gate(count, seed, jobs);
  const std::uint64_t chunk = what == "problems" ? 24 : 25;
  const Evidence evidence = in_parts<Evidence>((count + chunk - 1) / chunk, jobs, [&](std::uint64_t i) {
    if (what == "problems")
      return clearway::evidence::plan_problems(seed, i * chunk, std::min(count, (i + 1) * chunk));
    return clearway::evidence::alter_paths(seed * 65537 + i, std::min(chunk, count - i * chunk));
  });
  std::cout << to_json(what, seed, evidence).dump(2) << std::endl;
  return evidence.broken.empty() ? 0 : 1;
}
