#include "apps/results/compare_records.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "apps/results/compare_files.hpp"
#include "apps/results/compare_record.hpp"
#include "apps/results/compare_worst.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_text.hpp"
#include "planning/files/plan_file.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;
using StageKey = std::pair<std::size_t, std::size_t>;

std::string line_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string asked_line(const CompareAsked& asked) {
  Json experiments = Json::array();
  for (const CompareExperiment& experiment : asked.results.experiments)
    experiments.push_back(record_of(experiment));
  return line_of({{"clearway_runs", 1},
                  {"asked", record_of(asked.results)},
                  {"suite_sha256", asked.suite_sha256},
                  {"shard", {asked.shard.index, asked.shard.count}},
                  {"experiments", experiments}});
}

Json json_of_line(const std::string& line) {
  require_json(line, records_name);
  return Json::parse(line);
}

CompareAsked asked_of_line(const std::string& line) {
  const Json json = json_of_line(line);
  if (json.at("clearway_runs") != 1) throw std::invalid_argument("of another version");
  CompareAsked asked;
  asked.results = results_of_record(json.at("asked"));
  json.at("suite_sha256").get_to(asked.suite_sha256);
  json.at("shard").at(0).get_to(asked.shard.index);
  json.at("shard").at(1).get_to(asked.shard.count);
  for (const Json& experiment : json.at("experiments"))
    asked.results.experiments.push_back(experiment_of_record(experiment));
  return asked;
}

std::string stage_line(const StageKey& key, const std::vector<CompareProblem>& problems,
                       const std::string& in_vain) {
  Json list = Json::array();
  for (const CompareProblem& problem : problems) list.push_back(record_of(problem));
  Json line = {{"stage", {key.first, key.second}}, {"problems", list}};
  if (!in_vain.empty()) line["in_vain"] = in_vain;
  return line_of(line);
}

std::string run_line(const StageKey& key, std::size_t problem, const CompareRun& run) {
  return line_of({{"of", {key.first, key.second, problem}}, {"run", record_of(run)}});
}

std::string end_line(const StageKey& key, std::size_t problem, const std::string& page) {
  return line_of({{"of", {key.first, key.second, problem}}, {"page", page}});
}

std::string time_line(double seconds) { return line_of({{"time_s", seconds}}); }

bool is_before(const CompareRun& a, const CompareRun& b) {
  return std::pair(a.planner, a.number) < std::pair(b.planner, b.number);
}

void put(std::vector<CompareRun>& runs, const CompareRun& run) {
  const auto place = std::lower_bound(runs.begin(), runs.end(), run, is_before);
  if (place != runs.end() && !is_before(run, *place)) {
    *place = run;
  } else {
    runs.insert(place, run);
  }
}

std::vector<std::string> labels_of(const CompareExperiment& experiment) {
  std::vector<std::string> labels;
  for (const ComparePlanner& who : experiment.planners) labels.push_back(who.label);
  return labels;
}

}  // namespace

bool is_in(const CompareShard& shard, std::size_t experiment, std::size_t stage, std::size_t problem) {
  return (experiment + stage + problem) % static_cast<std::size_t>(shard.count) + 1 ==
         static_cast<std::size_t>(shard.index);
}

std::string difference(const CompareAsked& a, const CompareAsked& b) {
  const CompareResults &one = a.results, &other = b.results;
  if (one.version != other.version || one.commit != other.commit)
    return "the program's version (" + one.version + ", commit " + one.commit + ", not " + other.version +
           ", commit " + other.commit + ")";
  if (a.suite_sha256 != b.suite_sha256) return "the suite's file (" + plain(one.file) + ")";
  if (one.seed != other.seed)
    return "the seed (" + std::to_string(one.seed) + ", not " + std::to_string(other.seed) + ")";
  if (one.experiments.size() != other.experiments.size()) return "the experiments";
  for (const auto& [world, digest] : one.map_sha256)
    if (const auto same = other.map_sha256.find(world);
        same != other.map_sha256.end() && same->second != digest)
      return "the map of world '" + plain(world) + "', whose file is another now";
  for (std::size_t e = 0; e < one.experiments.size(); ++e) {
    const CompareExperiment &first = one.experiments[e], &second = other.experiments[e];
    const std::string name = " of experiment '" + first.setup.name + "'";
    if (first.setup.name != second.setup.name) return "the experiments";
    if (labels_of(first) != labels_of(second)) return "the planners" + name;
    if (first.time_limit != second.time_limit) return "the time limit" + name;
    if (first.robot_sha256 != second.robot_sha256)
      return "the robot" + name + ", whose files say something else now";
    if (first.problems_sha256 != second.problems_sha256)
      return "the problems" + name + ", whose files say something else now";
    Json left = record_of(first), right = record_of(second);
    left.erase("robot_file");  // where the program's data lie
    right.erase("robot_file");
    if (left != right) return "the settings" + name;
  }
  return "";
}

CompareRecords::CompareRecords(CompareAsked asked, Sink sink)
    : asked_(std::move(asked)), sink_(std::move(sink)) {
  write(asked_line(asked_));
}

CompareRecords::CompareRecords(CompareRecords&& other) noexcept
    : asked_(std::move(other.asked_)),
      sink_(std::move(other.sink_)),
      stages_(std::move(other.stages_)),
      in_vain_(std::move(other.in_vain_)),
      time_(other.time_) {}

namespace {

constexpr std::size_t largest_records = std::size_t{1} << 30U;

/// What records name beside them is read and copied: by the names that a comparison gives, in its folder.
void require_beside(const std::filesystem::path& file) {
  if (!file.empty() && (file.lexically_normal() != file || !is_of_comparison(file)))
    throw std::invalid_argument("no file of a comparison");
}

}  // namespace

CompareRecords CompareRecords::read(const std::filesystem::path& file) {
  const std::string text = read_input(file, "records of runs", largest_records);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  std::size_t number = 1;
  try {
    std::string line;
    std::getline(lines, line);
    CompareRecords records(asked_of_line(line));
    while (std::getline(lines, line)) {
      ++number;
      records.read_line(line);
    }
    return records;
  } catch (const std::exception&) {  // JSON's, or ours
    throw std::invalid_argument("'" + plain(file.string()) + "', line " + std::to_string(number) +
                                ": expected what `clearway compare` of this version writes");
  }
}

void CompareRecords::read_line(const std::string& line) {
  const Json json = json_of_line(line);
  if (json.contains("time_s")) {
    time_ += json.at("time_s").get<double>();
  } else if (json.contains("stage")) {
    const StageKey key{json.at("stage").at(0), json.at("stage").at(1)};
    if (key.first >= asked_.results.experiments.size()) throw std::invalid_argument("no such experiment");
    Stage& stage = stages_[key];
    stage.clear();
    for (const Json& problem : json.at("problems")) stage.push_back({problem_of_record(problem)});
    if (json.contains("in_vain")) json.at("in_vain").get_to(in_vain_[key]);
  } else {
    const Json& of = json.at("of");
    Problem& problem = stages_.at({of.at(0), of.at(1)}).at(of.at(2).get<std::size_t>());
    if (json.contains("run")) {
      const CompareRun run = run_of_record(json.at("run"));
      if (run.planner >= asked_.results.experiments[of.at(0).get<std::size_t>()].planners.size())
        throw std::invalid_argument("no such planner");
      require_beside(run.plan_file);
      put(problem.found.runs, run);
    } else {
      json.at("page").get_to(problem.found.page);
      require_beside(problem.found.page);
      problem.is_finished = true;
    }
  }
}

void CompareRecords::write(const std::string& line) const {
  if (sink_) sink_(line);
}

const CompareRecords::Stage* CompareRecords::stage(std::size_t experiment, std::size_t stage) const {
  const auto found = stages_.find({experiment, stage});
  return found == stages_.end() ? nullptr : &found->second;
}

std::vector<StageKey> CompareRecords::stages() const {
  std::vector<StageKey> keys;
  for (const auto& [key, stage] : stages_) keys.push_back(key);
  return keys;
}

std::size_t CompareRecords::count() const {
  std::size_t runs = 0;
  for (const auto& [key, stage] : stages_)
    for (const Problem& problem : stage) runs += problem.found.runs.size();
  return runs;
}

bool CompareRecords::is_drawn_in_vain(std::size_t experiment, std::size_t stage) const {
  return in_vain_.contains({experiment, stage});
}

void CompareRecords::require_problems() const {
  const std::lock_guard lock(mutex_);
  const bool has_some =
      std::any_of(stages_.begin(), stages_.end(), [](const auto& opened) { return !opened.second.empty(); });
  if (!has_some && !in_vain_.empty()) throw std::runtime_error(in_vain_.begin()->second);
}

void CompareRecords::open(std::size_t experiment, std::size_t stage, std::vector<CompareProblem> problems,
                          const std::string& in_vain) {
  write(stage_line({experiment, stage}, problems, in_vain));
  const std::lock_guard lock(mutex_);
  Stage& opened = stages_[{experiment, stage}];
  opened.clear();
  for (CompareProblem& problem : problems) opened.push_back({std::move(problem)});
  if (!in_vain.empty()) in_vain_[{experiment, stage}] = in_vain;
}

void CompareRecords::add(std::size_t experiment, std::size_t stage, std::size_t problem,
                         const CompareRun& run) {
  write(run_line({experiment, stage}, problem, run));
  const std::lock_guard lock(mutex_);
  put(stages_.at({experiment, stage}).at(problem).found.runs, run);
}

void CompareRecords::finish(std::size_t experiment, std::size_t stage, std::size_t problem,
                            const std::string& page) {
  write(end_line({experiment, stage}, problem, page));
  const std::lock_guard lock(mutex_);
  Problem& finished = stages_.at({experiment, stage}).at(problem);
  finished.found.page = page;
  finished.is_finished = true;
}

void CompareRecords::add_time(double seconds) {
  write(time_line(seconds));
  const std::lock_guard lock(mutex_);
  time_ += seconds;
}

CompareExperiment CompareRecords::experiment(std::size_t index) const {
  const std::lock_guard lock(mutex_);
  CompareExperiment found = asked_.results.experiments.at(index);
  for (const auto& [key, stage] : stages_) {
    if (key.first != index) continue;
    for (const Problem& problem : stage)
      if (!problem.found.runs.empty()) found.problems.push_back(problem.found);
  }
  return found;
}

std::vector<std::pair<std::size_t, std::size_t>> CompareRecords::places(std::size_t index) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::pair<std::size_t, std::size_t>> places;
  for (const auto& [key, stage] : stages_)
    for (std::size_t i = 0; key.first == index && i < stage.size(); ++i)
      if (!stage[i].found.runs.empty()) places.emplace_back(key.second, i);
  return places;
}

CompareResults CompareRecords::results(const std::filesystem::path& folder, std::size_t end) const {
  CompareResults all = asked_.results;
  all.experiments.resize(std::min(end, all.experiments.size()));
  for (std::size_t e = 0; e < all.experiments.size(); ++e) {
    all.experiments[e] = experiment(e);
    all.experiments[e].profiles = profiles_of(all.experiments[e], folder);
    link_worst_pages(folder, all.experiments[e]);
  }
  const std::lock_guard lock(mutex_);
  for (const auto& [key, why] : in_vain_)
    if (key.first < all.experiments.size())
      all.notes.push_back("experiment '" + all.experiments[key.first].setup.name +
                          "' is without one of its worlds: " + why);
  all.time = time_;
  return all;
}

std::string CompareRecords::text() const {
  const std::lock_guard lock(mutex_);
  std::string text = asked_line(asked_);
  for (const auto& [key, stage] : stages_) {
    std::vector<CompareProblem> problems;
    for (const Problem& problem : stage) problems.push_back(problem.found);
    const auto why = in_vain_.find(key);
    text += stage_line(key, problems, why == in_vain_.end() ? "" : why->second);
    for (std::size_t i = 0; i < stage.size(); ++i) {
      for (const CompareRun& run : stage[i].found.runs) text += run_line(key, i, run);
      if (stage[i].is_finished) text += end_line(key, i, stage[i].found.page);
    }
  }
  return text + time_line(time_);
}

std::vector<CompareProfile> profiles_of(const CompareExperiment& experiment,
                                        const std::filesystem::path& folder) {
  std::vector<CompareProfile> profiles;
  const auto& plots = experiment.setup.plots;
  if (std::find(plots.begin(), plots.end(), "profiles") == plots.end() || experiment.problems.empty())
    return profiles;
  for (const CompareRun& run : experiment.problems.front().runs) {
    std::error_code error;
    if (run.number != 1 || run.plan_file.empty() || !std::filesystem::exists(folder / run.plan_file, error))
      continue;
    std::vector<Configuration> waypoints = load_plan(folder / run.plan_file).waypoints();
    if (!waypoints.empty()) profiles.push_back({run.planner, std::move(waypoints)});
  }
  return profiles;
}

}  // namespace clearway
