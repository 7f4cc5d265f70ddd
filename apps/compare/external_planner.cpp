#include "apps/compare/external_planner.hpp"

#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "apps/compare/line_process.hpp"
#include "apps/compare/planner_world.hpp"
#include "apps/console/stopwatch.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"
#include "planning/problem/limit_rounding.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void refuse(const std::string& line, const std::string& expected) {
  throw std::runtime_error("the planner's program answered " + quote(line) + ": expected " + expected);
}

Json answer_of(const std::string& line) {
  std::string why;
  try {
    require_json(line, "the answer");  // which knows keys that stand twice
    Json answer = Json::parse(line);
    if (answer.is_object()) return answer;
  } catch (const std::invalid_argument& error) {
    why = std::string(" (") + error.what() + ")";
  }
  refuse(line, "one JSON object on a line, with each key once" + why);
}

std::vector<Configuration> path_of(const Json& path, const PlanProblem& problem, const std::string& line) {
  const Eigen::Index joints = problem.start.size();
  const std::string expected =
      "'path', a list of configurations of " + std::to_string(joints) + " finite numbers";
  if (!path.is_array() || path.empty()) refuse(line, expected);
  std::vector<Configuration> waypoints;
  for (const Json& row : path) {
    if (!row.is_array() || row.size() != static_cast<std::size_t>(joints)) refuse(line, expected);
    Configuration q(joints);
    for (Eigen::Index j = 0; j < joints; ++j) {
      const Json& value = row[static_cast<std::size_t>(j)];
      if (!value.is_number() || !std::isfinite(value.get<double>())) refuse(line, expected);
      q[j] = drawn_to_limit(problem.space.robot().joints[static_cast<std::size_t>(j)], value.get<double>());
    }
    waypoints.push_back(std::move(q));
  }
  return waypoints;
}

/// Rad or m: programs may round configurations, and check their goals by a tolerance.
constexpr double most_rounding = 1e-3;

/// The path with both ends exact, or the reason why its ends are elsewhere. An end that is off by more
/// than `contract_tolerance` stays, and an edge leads to it, which is judged like the others.
std::string join_ends(std::vector<Configuration>& waypoints, const PlanProblem& problem) {
  const auto off = [](const Configuration& a, const Configuration& b) {
    return (a - b).cwiseAbs().maxCoeff();
  };
  const double first = off(waypoints.front(), problem.start), last = off(waypoints.back(), problem.goal);
  const auto elsewhere = [](const std::string& does, double by, const std::string& from) {
    return "The program's path " + does + " " + short_text(by) + " (rad or m, of one joint) from the " +
           from + ": expected at most " + short_text(most_rounding) + ".";
  };
  if (first > most_rounding) return elsewhere("begins", first, "start");
  if (last > most_rounding) return elsewhere("ends", last, "goal");
  if (first > contract_tolerance) waypoints.insert(waypoints.begin(), problem.start);
  if (last > contract_tolerance) waypoints.push_back(problem.goal);
  waypoints.front() = problem.start;
  if (waypoints.size() > 1) waypoints.back() = problem.goal;
  return "";
}

/// Why the path winds a joint without limits farther than the check, and the motion, can follow; else empty.
std::string winding(const std::vector<Configuration>& waypoints, const Robot& robot) {
  constexpr double most_turns = 200.0;  // twice as many as from a start to a goal
  for (std::size_t joint = 0; joint < robot.dof(); ++joint) {
    if (!is_endless(robot.joints[joint])) continue;
    const auto j = static_cast<Eigen::Index>(joint);
    double turns = 0.0;
    for (std::size_t i = 1; i < waypoints.size(); ++i)
      turns += std::abs(waypoints[i][j] - waypoints[i - 1][j]) / (2.0 * std::numbers::pi);
    if (turns > most_turns)
      return "The program's path winds joint " + shortened(robot.joints[joint].name) + " by " +
             short_text(turns) + " turns in all: expected at most " + short_text(most_turns) + ".";
  }
  return "";
}

void read_answer(const std::string& line, const PlanProblem& problem, PlanResult& result) {
  const Json answer = answer_of(line);
  result.status = PlanStatus::no_path;
  if (answer.contains("failed")) {
    result.explanation = answer["failed"].is_string()
                             ? plain(answer["failed"].get<std::string>().substr(0, 200))
                             : std::string("The program gives no reason.");
    return;
  }
  if (!answer.contains("path")) refuse(line, "'path' or 'failed'");
  std::vector<Configuration> waypoints = path_of(answer["path"], problem, line);
  result.explanation = join_ends(waypoints, problem);
  if (result.explanation.empty()) result.explanation = winding(waypoints, problem.space.robot());
  if (!result.explanation.empty()) {
    result.explored = std::move(waypoints);
    return;
  }
  result.status = PlanStatus::solved;
  result.waypoints = std::move(waypoints);
  result.search_steps = static_cast<int>(result.waypoints.size()) - 1;
  result.cost = problem.cost(result.waypoints);
}

}  // namespace

struct ExternalPlanner::State {
  std::string command;
  std::mutex using_it;
  std::optional<ConfigurationSpace>
      space;  ///< that the program knows; kept, so that no other takes its place
  std::optional<LineProcess> program;

  void start(const ConfigurationSpace& asked) {
    const bool is_known = program && space && &space->robot() == &asked.robot();  // copies share the robot
    if (is_known) return;
    space.reset();
    program.emplace(command);
    const Deadline deadline(patience);
    const std::string world =
        Json{{"world", planner_world(asked)}}.dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::optional<std::string> line = program->ask(world, [&] { return deadline.is_over(); });
    if (!line) {
      program.reset();
      throw std::runtime_error("the planner's program did not read its world within " + short_text(patience) +
                               " s");
    }
    if (answer_of(*line).value("ready", Json()) != Json(true)) refuse(*line, "{\"ready\": true}");
    space.emplace(asked);
  }
};

ExternalPlanner::ExternalPlanner(const std::string& command)
    : Planner(planner_name, {{"command", command}}), state_(std::make_unique<State>()) {
  if (command.find_first_not_of(' ') == std::string::npos || command.find('\n') != std::string::npos)
    throw std::invalid_argument("--external: expected a command of one line that the shell can run");
  state_->command = command;
}

ExternalPlanner::~ExternalPlanner() = default;

void ExternalPlanner::prepare(const ConfigurationSpace& space) const {
  const std::lock_guard lock(state_->using_it);
  state_->start(space);
}

PlanResult ExternalPlanner::plan(const PlanProblem& problem) const {
  PlanResult result = check_ends(problem);
  result.process_time.emplace();
  if (result.status != PlanStatus::solved) return result;
  if (problem.start == problem.goal) {  // nobody need be asked
    result.waypoints = {problem.start};
    return result;
  }
  const std::lock_guard lock(state_->using_it);
  state_->start(problem.space);
  LineProcess& program = *state_->program;
  if (const auto unasked = program.unasked())
    refuse(*unasked, "one line for each question, and this one is to none");
  const double cpu_before = program.cpu_seconds();
  Json query{{"start", json_of(problem.start)}, {"goal", json_of(problem.goal)}, {"seed", problem.seed}};
  if (std::isfinite(problem.time_limit)) query["time_limit"] = problem.time_limit;
  const std::string question = Json{{"query", query}}.dump();
  std::optional<std::string> line;
  {
    const Stopwatch watch(result.process_time->wall);
    line = program.ask(question, problem.out_of_time);
  }
  result.process_time->cpu = program.cpu_seconds() - cpu_before;
  const bool is_late = result.process_time->wall > problem.time_limit;
  if (!line || is_late) {
    result.status = PlanStatus::timed_out;
    result.explanation =
        line ? "The program answered after its time limit." : "The program did not answer in time.";
    if (!line) state_->program.reset();  // its late answer is to no other question
    return result;
  }
  read_answer(*line, problem, result);
  return result;
}

}  // namespace clearway
