#include "apps/results/compare_record.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json real_record(double value) { return std::isfinite(value) ? Json(value) : Json(to_text(value)); }

double real_of(const Json& record) {
  if (!record.is_string()) return record.get<double>();
  const std::string text = record.get<std::string>();
  const double infinity = std::numeric_limits<double>::infinity();
  if (text == to_text(infinity)) return infinity;
  if (text == to_text(-infinity)) return -infinity;
  return std::numeric_limits<double>::quiet_NaN();
}

Json reals_record(const Configuration& q) {
  Json list = Json::array();
  for (const double value : q) list.push_back(real_record(value));
  return list;
}

Configuration configuration_of(const Json& record) {
  Configuration q(static_cast<Eigen::Index>(record.size()));
  for (std::size_t i = 0; i < record.size(); ++i) q[static_cast<Eigen::Index>(i)] = real_of(record.at(i));
  return q;
}

PlanStatus status_of(const std::string& text) {
  for (const PlanStatus known : {PlanStatus::solved, PlanStatus::start_invalid, PlanStatus::goal_invalid,
                                 PlanStatus::no_path, PlanStatus::timed_out}) {
    if (text == to_string(known)) return known;
  }
  throw std::invalid_argument("status " + quote(text) + " is unknown");
}

/// The figures of a run by their names in the record.
struct RunFigure {
  const char* name;
  double CompareRun::*value;
};
constexpr std::array run_figures = {RunFigure{"cost", &CompareRun::cost},
                                    RunFigure{"length", &CompareRun::length},
                                    RunFigure{"min_clearance", &CompareRun::min_clearance},
                                    RunFigure{"time", &CompareRun::time},
                                    RunFigure{"cpu", &CompareRun::cpu},
                                    RunFigure{"space_cpu", &CompareRun::space_cpu},
                                    RunFigure{"derive_cpu", &CompareRun::derive_cpu},
                                    RunFigure{"check_time", &CompareRun::check_time},
                                    RunFigure{"check_cpu", &CompareRun::check_cpu},
                                    RunFigure{"motion_cpu", &CompareRun::motion_cpu}};

/// Parts of `cpu`; absent where a run has none, as in records of older versions.
struct RunWork {
  const char* name;
  std::optional<double> WorkTimes::*value;
};
constexpr std::array run_works = {RunWork{"search_cpu", &WorkTimes::search},
                                  RunWork{"shortcut_cpu", &WorkTimes::shortcuts},
                                  RunWork{"proof_cpu", &WorkTimes::proofs}};

Json team_record(const CompareTeamRun& team) {
  return {{"security_distance", real_record(team.security_distance)},
          {"step_bound", real_record(team.step_bound)},
          {"obstacle_speed", real_record(team.obstacle_speed)},
          {"between_robots", real_record(team.between_robots)},
          {"outrun", team.outrun}};
}

CompareTeamRun team_of(const Json& record) {
  return {real_of(record.at("security_distance")), real_of(record.at("step_bound")),
          real_of(record.at("obstacle_speed")), real_of(record.at("between_robots")),
          record.at("outrun").get<std::string>()};
}

Json setup_record(const SuiteExperiment& setup) {
  Json record = {{"name", setup.name},       {"title", setup.title},
                 {"paper", setup.paper},     {"notes", setup.notes},
                 {"robot", setup.robot},     {"policies", setup.policies},
                 {"payload", setup.payload}, {"gravity", reals_record(setup.gravity)},
                 {"runs", setup.runs},       {"plots", setup.plots}};
  if (setup.padding) record["padding"] = *setup.padding;
  if (!setup.alike.empty()) record["alike"] = setup.alike;
  if (setup.teams)
    record["teams"] = {{"period", setup.teams->period},
                       {"duration", setup.teams->duration},
                       {"max_acceleration", setup.teams->max_acceleration}};
  return record;
}

SuiteExperiment setup_of(const Json& record) {
  SuiteExperiment setup;
  for (const auto& [name, text] :
       {std::pair{"name", &setup.name}, std::pair{"title", &setup.title}, std::pair{"paper", &setup.paper},
        std::pair{"notes", &setup.notes}, std::pair{"robot", &setup.robot}})
    record.at(name).get_to(*text);
  record.at("policies").get_to(setup.policies);
  record.at("payload").get_to(setup.payload);
  const Configuration gravity = configuration_of(record.at("gravity"));
  if (gravity.size() != 3) throw std::invalid_argument("gravity has other than three values");
  setup.gravity = gravity;
  record.at("runs").get_to(setup.runs);
  record.at("plots").get_to(setup.plots);
  if (record.contains("alike")) record.at("alike").get_to(setup.alike);
  if (record.contains("padding")) setup.padding = record.at("padding").get<double>();
  if (!record.contains("teams")) return setup;
  SuiteTeams teams;
  record.at("teams").at("period").get_to(teams.period);
  record.at("teams").at("duration").get_to(teams.duration);
  record.at("teams").at("max_acceleration").get_to(teams.max_acceleration);
  setup.teams = teams;
  return setup;
}

}  // namespace

Json record_of(const CompareRun& run) {
  Json record = {{"planner", run.planner},     {"number", run.number},
                 {"seed", run.seed},           {"status", to_string(run.status)},
                 {"ended", run.ended},         {"explanation", run.explanation},
                 {"legs", run.legs},           {"check", run.check},
                 {"contact", run.contact},     {"steps", run.steps},
                 {"waypoints", run.waypoints}, {"configurations", run.configurations},
                 {"edges", run.edges},         {"plan_file", run.plan_file}};
  for (const RunFigure& figure : run_figures) record[figure.name] = real_record(run.*figure.value);
  for (const RunWork& work : run_works)
    if (const std::optional<double>& spent = run.work.*work.value) record[work.name] = real_record(*spent);
  Json& statistics = record["statistics"] = Json::object();
  for (const auto& [name, value] : with_stage(run.statistics, run.solved_by))
    statistics[name] = real_record(value);
  if (run.motion)
    record["motion"] = {real_record(run.motion->time), real_record(run.motion->speed),
                        real_record(run.motion->acceleration), real_record(run.motion->jerk),
                        run.motion->note};
  if (run.team) record["team"] = team_record(*run.team);
  return record;
}

CompareRun run_of_record(const Json& record) {
  CompareRun run;
  record.at("planner").get_to(run.planner);
  record.at("number").get_to(run.number);
  record.at("seed").get_to(run.seed);
  run.status = status_of(record.at("status").get<std::string>());
  record.at("ended").get_to(run.ended);
  record.at("explanation").get_to(run.explanation);
  record.at("legs").get_to(run.legs);
  record.at("check").get_to(run.check);
  record.at("contact").get_to(run.contact);
  record.at("steps").get_to(run.steps);
  record.at("waypoints").get_to(run.waypoints);
  record.at("configurations").get_to(run.configurations);
  record.at("edges").get_to(run.edges);
  record.at("plan_file").get_to(run.plan_file);
  for (const RunFigure& figure : run_figures) run.*figure.value = real_of(record.at(figure.name));
  for (const RunWork& work : run_works)
    if (record.contains(work.name)) run.work.*work.value = real_of(record.at(work.name));
  for (const auto& [name, value] : record.at("statistics").items()) run.statistics[name] = real_of(value);
  run.solved_by = take_stage(run.statistics);
  if (record.contains("motion")) {
    const Json& motion = record.at("motion");
    run.motion = CompareMotion{real_of(motion.at(0)), real_of(motion.at(1)), real_of(motion.at(2)),
                               real_of(motion.at(3)), motion.at(4).get<std::string>()};
  }
  if (record.contains("team")) run.team = team_of(record.at("team"));
  return run;
}

Json record_of(const CompareProblem& problem) {
  Json goals = Json::array();
  for (const Configuration& goal : problem.goals) goals.push_back(reals_record(goal));
  return {{"name", problem.name},
          {"world", problem.world},
          {"map_file", problem.map_file},
          {"map_sha256", problem.map_sha256},
          {"resolution", problem.resolution},
          {"start", reals_record(problem.start)},
          {"goals", goals}};
}

CompareProblem problem_of_record(const Json& record) {
  CompareProblem problem;
  record.at("name").get_to(problem.name);
  record.at("world").get_to(problem.world);
  record.at("map_file").get_to(problem.map_file);
  record.at("map_sha256").get_to(problem.map_sha256);
  record.at("resolution").get_to(problem.resolution);
  problem.start = configuration_of(record.at("start"));
  for (const Json& goal : record.at("goals")) problem.goals.push_back(configuration_of(goal));
  return problem;
}

Json record_of(const CompareExperiment& experiment) {
  Json planners = Json::array();
  for (const ComparePlanner& who : experiment.planners)
    planners.push_back({{"label", who.label},
                        {"planner", who.planner},
                        {"options", who.options},
                        {"certified", who.certified}});
  return {{"setup", setup_record(experiment.setup)},
          {"robot_file", experiment.robot_file},
          {"robot_sha256", experiment.robot_sha256},
          {"problems_sha256", experiment.problems_sha256},
          {"scale", experiment.scale},
          {"time_limit", real_record(experiment.time_limit)},
          {"joints", experiment.joints},
          {"is_prismatic", experiment.is_prismatic},
          {"planners", planners}};
}

CompareExperiment experiment_of_record(const Json& record) {
  CompareExperiment experiment;
  experiment.setup = setup_of(record.at("setup"));
  record.at("robot_file").get_to(experiment.robot_file);
  record.at("robot_sha256").get_to(experiment.robot_sha256);
  record.at("problems_sha256").get_to(experiment.problems_sha256);
  record.at("scale").get_to(experiment.scale);
  experiment.time_limit = real_of(record.at("time_limit"));
  record.at("joints").get_to(experiment.joints);
  record.at("is_prismatic").get_to(experiment.is_prismatic);
  for (const Json& who : record.at("planners"))
    experiment.planners.push_back({who.at("label").get<std::string>(), who.at("planner").get<std::string>(),
                                   who.at("options").get<PlannerOptions>(), who.at("certified").get<bool>()});
  return experiment;
}

Json head_of(const CompareResults& results) {
  return {{"suite", results.suite},   {"title", results.title}, {"file", results.file},
          {"seed", results.seed},     {"jobs", results.jobs},   {"version", results.version},
          {"commit", results.commit}, {"host", results.host},   {"processor", results.processor},
          {"date", results.date}};
}

Json record_of(const CompareResults& results) {
  Json record = head_of(results);
  record["map_sha256"] = results.map_sha256;
  record["notes"] = results.notes;
  record["flags"] = results.flags;
  record["part"] = results.part;
  return record;
}

CompareResults results_of_record(const Json& record) {
  CompareResults results;
  for (const auto& [name, text] :
       {std::pair{"suite", &results.suite}, std::pair{"title", &results.title},
        std::pair{"file", &results.file}, std::pair{"version", &results.version},
        std::pair{"commit", &results.commit}, std::pair{"host", &results.host},
        std::pair{"processor", &results.processor}, std::pair{"date", &results.date}})
    record.at(name).get_to(*text);
  record.at("seed").get_to(results.seed);
  record.at("jobs").get_to(results.jobs);
  record.at("map_sha256").get_to(results.map_sha256);
  if (record.contains("notes")) record.at("notes").get_to(results.notes);  // older ones have none
  if (record.contains("flags")) record.at("flags").get_to(results.flags);
  if (record.contains("part")) record.at("part").get_to(results.part);
  return results;
}

}  // namespace clearway
