// What no single test can show: many drawn problems, altered paths and chunks, put to the independent check,
// and painting sessions whose truth the tracker does not know.
//   clearway_evidence problems --count 10000 --seed 1 --jobs 2
//   clearway_evidence altered --count 2000 --seed 1 --jobs 2
//   clearway_evidence gate --count 1000000 --seed 1 --jobs 2
//   clearway_evidence poses --count 1000 --seed 1 --jobs 2
//   clearway_evidence motions --count 1000 --seed 1 --jobs 2
//   clearway_evidence motions --suite datasets/suites/quick.yaml --count 20
//   clearway_evidence people --count 50 --seed 1 --jobs 2
//   clearway_evidence picks --count 500 --seed 1 --jobs 2
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
#include "tests/evidence/motion_evidence.hpp"
#include "tests/evidence/path_evidence.hpp"
#include "tests/evidence/people_evidence.hpp"
#include "tests/evidence/pick_evidence.hpp"
#include "tests/evidence/pose_evidence.hpp"

namespace {

using clearway::evidence::Evidence;
using clearway::evidence::GateEvidence;
using clearway::evidence::PoseEvidence;

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

double quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

/// Exit status 1 when more than 0.3 % of the accepted samples are outside their bound, or a painted voxel is
/// where the ball never was.
int run_poses(std::uint64_t count, std::uint64_t seed, double severity, unsigned jobs) {
  constexpr int frames = 60;
  PoseEvidence evidence = in_parts<PoseEvidence>(count, jobs, [&](std::uint64_t i) {
    return clearway::evidence::track_session(seed * 1000003 + i, frames, severity);
  });
  const double outside = static_cast<double>(evidence.outside) /
                         static_cast<double>(std::max<std::uint64_t>(1, evidence.accepted));
  const nlohmann::ordered_json json{
      {"name", "poses"},
      {"seed", seed},
      {"severity", severity},
      {"sessions", evidence.sessions},
      {"samples", evidence.samples},
      {"accepted", evidence.accepted},
      {"outside_bound", evidence.outside},
      {"outside_share", outside},
      {"refused", evidence.refused},
      {"accepted_by_tags", evidence.accepted_by_tags},
      {"outside_by_tags", evidence.outside_by_tags},
      {"error_over_bound",
       {{"median", quantile(evidence.ratio, 0.5)}, {"p99", quantile(evidence.ratio, 0.99)}}},
      {"painted_over_ball",
       {{"p10", quantile(evidence.share, 0.1)}, {"median", quantile(evidence.share, 0.5)}}},
      {"painted_voxels", evidence.painted_voxels},
      {"voxels_beyond_free", evidence.voxels_beyond},
      {"broken", evidence.broken}};
  std::cout << json.dump(2) << std::endl;
  return outside <= 0.003 && evidence.voxels_beyond == 0 && evidence.accepted > 0 ? 0 : 1;
}

/// Exit status 1 when a motion exceeds a limit or is not found valid.
int run_motions(std::uint64_t count, std::uint64_t seed, unsigned jobs, const std::string& suite) {
  using clearway::evidence::MotionEvidence;
  constexpr std::uint64_t each = 24;
  MotionEvidence evidence =
      suite.empty() ? in_parts<MotionEvidence>((count + each - 1) / each, jobs,
                                               [&](std::uint64_t i) {
                                                 return clearway::evidence::judge_motions(
                                                     seed, i * each, std::min(count, (i + 1) * each));
                                               })
                    : clearway::evidence::judge_motions_of(suite, count);
  const nlohmann::ordered_json json{
      {"name", "motions"},
      {"seed", seed},
      {"paths", evidence.paths},
      {"waypoints_blended", evidence.blended},
      {"waypoints_with_a_stop", evidence.stops},
      {"time_over_edge_trajectories",
       {{"p10", quantile(evidence.ratio, 0.1)},
        {"median", quantile(evidence.ratio, 0.5)},
        {"p90", quantile(evidence.ratio, 0.9)}}},
      {"cpu_ms",
       {{"median", 1e3 * quantile(evidence.cpu, 0.5)},
        {"p90", 1e3 * quantile(evidence.cpu, 0.9)},
        {"median_of_20_waypoints", 2e4 * quantile(evidence.cpu_by_waypoint, 0.5)}}},
      {"samples", evidence.samples},
      {"greatest_share_of_limits",
       {{"velocity", evidence.velocity}, {"acceleration", evidence.acceleration}, {"jerk", evidence.jerk}}},
      {"refused_by_the_check", evidence.refused},
      {"broken", evidence.broken}};
  std::cout << json.dump(2) << std::endl;
  return evidence.broken.empty() && evidence.paths > 0 ? 0 : 1;
}

int run_people(std::uint64_t count, std::uint64_t seed, unsigned jobs) {
  using clearway::evidence::PeopleEvidence;
  const PeopleEvidence evidence = in_parts<PeopleEvidence>(
      count, jobs, [&](std::uint64_t i) { return clearway::evidence::teach_session(seed * 1000003 + i); });
  const nlohmann::ordered_json json{{"name", "people"},
                                    {"seed", seed},
                                    {"sessions", evidence.sessions},
                                    {"approved", evidence.approved},
                                    {"explained", evidence.explained},
                                    {"approved_by_attempt", evidence.approved_by_attempt},
                                    {"not_approved_because", evidence.not_approved_by_reason},
                                    {"with_a_walking_camera", evidence.walked},
                                    {"probe_set_down", evidence.set_down},
                                    {"strokes_through_an_obstacle", evidence.mistakes},
                                    {"of_these_met_by_sensors", evidence.mistakes_met},
                                    {"painted_voxels", evidence.painted},
                                    {"deep_inside_of_obstacles", evidence.painted_inside},
                                    {"points_seen_on_obstacles", evidence.seen_points},
                                    {"of_these_painted_over", evidence.painted_over},
                                    {"refused_events", evidence.refused},
                                    {"broken", evidence.broken}};
  std::cout << json.dump(2) << std::endl;
  const bool some_approve = evidence.approved > 0 || count < 10;
  return evidence.broken.empty() && some_approve ? 0 : 1;
}

/// Exit status 1 when the check refuses a plan or its motion; reports how many are planned in time.
int run_picks(std::uint64_t count, std::uint64_t seed, unsigned jobs) {
  using clearway::evidence::PickEvidence;
  PickEvidence evidence = in_parts<PickEvidence>(
      count, jobs, [&](std::uint64_t i) { return clearway::evidence::pick_and_place(seed, i); });
  nlohmann::ordered_json json{{"name", "picks"}, {"seed", seed}};
  std::uint64_t asked = 0, planned = 0, in_time = 0;
  for (auto& [name, tally] : evidence.tallies) {
    const auto quick = static_cast<std::uint64_t>(
        std::count_if(tally.seconds.begin(), tally.seconds.end(), [](double s) { return s <= 1.0; }));
    json["by"][name] = {
        {"asked", tally.asked},
        {"planned", tally.planned},
        {"refused_by_the_check", tally.refused},
        {"within_1_s_of_cpu", quick},
        {"cpu_s", {{"median", quantile(tally.seconds, 0.5)}, {"p95", quantile(tally.seconds, 0.95)}}}};
    asked += tally.asked;
    planned += tally.planned;
    in_time += quick;
  }
  json["asked"] = asked;
  json["planned"] = planned;
  json["planned_within_1_s_of_cpu"] = in_time;
  json["failures"] = evidence.failures;
  auto& motions = evidence.motions;
  json["motions"] = {
      {"made", motions.made},
      {"refused_by_the_check", motions.refused},
      {"waypoints_with_a_stop", motions.stops},
      {"legs_without_blends", motions.unblended},
      {"time_over_edge_trajectories",
       {{"p10", quantile(motions.ratio, 0.1)},
        {"median", quantile(motions.ratio, 0.5)},
        {"p90", quantile(motions.ratio, 0.9)}}},
      {"cpu_ms", {{"median", 1e3 * quantile(motions.cpu, 0.5)}, {"p90", 1e3 * quantile(motions.cpu, 0.9)}}}};
  json["broken"] = evidence.broken;
  std::cout << json.dump(2) << std::endl;
  return evidence.broken.empty() && planned > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Drawn problems, altered paths and chunks, put to the independent check."};
  std::string what, suite;
  std::uint64_t count = 240, seed = 1;
  unsigned jobs = 1;
  double severity = 1.0;
  app.add_option("WHAT", what, "problems, altered, gate, poses, motions, people or picks")
      ->required()
      ->check(CLI::IsMember({"problems", "altered", "gate", "poses", "motions", "people", "picks"}));
  app.add_option("--count", count, "Problems, altered paths that are violated, chunks, sessions, or picks");
  app.add_option("--suite", suite, "motions: of this suite, count problems of each experiment");
  app.add_option("--severity", severity, "poses: multiplies all errors that the tracker does not know");
  app.add_option("--seed", seed, "The same seed draws the same");
  app.add_option("--jobs", jobs, "Threads")->check(CLI::Range(1U, 64U));
  CLI11_PARSE(app, argc, argv);
  if (what == "gate") return run_gate(count, seed, jobs);
  if (what == "picks") return run_picks(count, seed, jobs);
  if (what == "motions") return run_motions(count, seed, jobs, suite);
  if (what == "people") return run_people(count, seed, jobs);
  if (what == "poses") return run_poses(count, seed, severity, jobs);
  const std::uint64_t chunk = what == "problems" ? clearway::evidence::problems_of_a_world : 25;
  const Evidence evidence = in_parts<Evidence>((count + chunk - 1) / chunk, jobs, [&](std::uint64_t i) {
    if (what == "problems")
      return clearway::evidence::plan_problems(seed, i * chunk, std::min(count, (i + 1) * chunk));
    return clearway::evidence::alter_paths(seed * 65537 + i, std::min(chunk, count - i * chunk));
  });
  std::cout << to_json(what, seed, evidence).dump(2) << std::endl;
  return evidence.broken.empty() ? 0 : 1;
}
