// What no single test can show: many drawn problems and altered paths, put to the independent check.
//   clearway_evidence problems --count 10000 --seed 1 --jobs 2
//   clearway_evidence altered --count 2000 --seed 1 --jobs 2
// Prints one JSON object; exit status 1 when a promise is broken. The same seed draws the same problems.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <functional>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/evidence/path_evidence.hpp"

namespace {

using clearway::evidence::Evidence;

/// Chunks of the work, shared by threads; added up in order, so that the result does not depend on them.
Evidence in_chunks(std::uint64_t chunks, unsigned jobs, const std::function<Evidence(std::uint64_t)>& work) {
  std::vector<Evidence> parts(chunks);
  std::atomic<std::uint64_t> next{0};
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < jobs; ++i) {
    threads.emplace_back([&] {
      for (std::uint64_t chunk = next++; chunk < chunks; chunk = next++) parts[chunk] = work(chunk);
    });
  }
  for (std::thread& thread : threads) thread.join();
  Evidence sum;
  for (const Evidence& part : parts) sum.add(part);
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

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Drawn problems and altered paths, put to the independent check."};
  std::string what;
  std::uint64_t count = 240, seed = 1;
  unsigned jobs = 1;
  app.add_option("WHAT", what, "problems or altered")
      ->required()
      ->check(CLI::IsMember({"problems", "altered"}));
  app.add_option("--count", count, "Problems, or altered paths that are violated");
  app.add_option("--seed", seed, "The same seed draws the same");
  app.add_option("--jobs", jobs, "Threads")->check(CLI::Range(1U, 64U));
  CLI11_PARSE(app, argc, argv);
  const std::uint64_t chunk = what == "problems" ? 24 : 25;
  const Evidence evidence = in_chunks((count + chunk - 1) / chunk, jobs, [&](std::uint64_t i) {
    if (what == "problems")
      return clearway::evidence::plan_problems(seed, i * chunk, std::min(count, (i + 1) * chunk));
    return clearway::evidence::alter_paths(seed * 65537 + i, std::min(chunk, count - i * chunk));
  });
  std::cout << to_json(what, seed, evidence).dump(2) << std::endl;
  return evidence.broken.empty() ? 0 : 1;
}
