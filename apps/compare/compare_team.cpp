#include "apps/compare/compare_team.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/compare/sensed_page.hpp"
#include "apps/compare/team_page.hpp"
#include "apps/compare/team_result.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/results/compare_files.hpp"
#include "apps/results/compare_record.hpp"
#include "apps/suites/sensed_spaces.hpp"
#include "apps/suites/suite_teams.hpp"
#include "apps/suites/suite_world.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

SuiteWorld world_of(const Suite& suite, const SuiteExperiment& experiment) {
  for (const SuiteWorld& world : suite.worlds)
    if (world.name == experiment.world) return world;
  return {};
}

/// What a thing that is known from scans alone can move from when it is seen until the next scan is known, m.
double unseen_motion(const Team& team, const std::optional<SuiteSensing>& sensing) {
  double farthest = 0.0;
  for (const MovingObstacle& obstacle : team.obstacles)
    if (obstacle.is_sensed && sensing)
      farthest = std::max(farthest, obstacle.greatest_speed() * (sensing->latency + 1.0 / sensing->rate_hz));
  return farthest;
}

using Kind = ProblemReply::Kind;
using Json = nlohmann::ordered_json;
using Files = std::map<std::string, std::string>;

std::string part_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// The runs of one experiment's teams. All of a team's are one process, which draws their page, too.
class TeamServer : public ProblemServer {
 public:
  TeamServer(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : experiment_(experiment),
        choice_(choice),
        world_(world_of(suite, experiment.setup)),
        map_(*experiment.map),
        digest_(map_sha256(map_)),
        labels_(names_as_files(experiment.planners)) {}

 private:
  void open(std::size_t, const Send& send) override {
    ProblemReply reply{.kind = Kind::opened};
    for (std::size_t i = 0; i < count_teams(experiment_.setup); ++i) {
      CompareProblem& problem = reply.problems.emplace_back();
      problem.name = team_number(i).name;
      problem.world = experiment_.setup.world.empty() ? "nothing" : experiment_.setup.world;
      problem.map_sha256 = digest_;
      problem.resolution = map_.resolution();
    }
    send(reply);
  }

  /// A planner whose run did not end well is left out of a second go.
  void plan(const ProblemRequest& request, const Send& send) override {
    const SuiteTeam given = team_number(*request.problem);
    std::map<std::size_t, CompareRun> without_answer;
    for (;;) {
      std::vector<std::size_t> led;
      for (std::size_t p = 0; p < experiment_.planners.size(); ++p)
        if (!without_answer.contains(p)) led.push_back(p);
      double wall = 0.0;
      const IsolatedEnd end = [&] {
        const Stopwatch watch(wall);
        return run_isolated(
            [&](const SendPart& send_part) { run_all(given, led, send_part); }, choice_.isolation,
            static_cast<double>(led.size()) * experiment_.time_limit + choice_.isolation.grace);
      }();
      if (end.ended.empty()) return send_all(end.parts, without_answer, send);
      if (end.parts.size() >= led.size())
        throw std::runtime_error("experiment '" + experiment_.setup.name + "', team '" + given.name +
                                 "': its page could not be made. " + end.explanation);
      CompareRun& run = without_answer[led[end.parts.size()]];
      run.planner = led[end.parts.size()];
      run.seed = choice_.seed;
      run.time = wall;
      run.ended = end.ended;
      run.explanation = end.explanation;
      run.team.emplace();
    }
  }

  /// Teams draw their pages while they run.
  void draw(const ProblemRequest&, const Send& send) override { send({.kind = Kind::finished}); }

  /// In the order of the planners; the last part is the page's.
  static void send_all(const std::vector<std::string>& parts, const std::map<std::size_t, CompareRun>& others,
                       const Send& send) {
    for (const auto& [planner, run] : others) send({.kind = Kind::run, .run = run});
    for (const std::string& part : parts) {
      const Json json = Json::parse(part);
      ProblemReply reply{.kind = json.contains("run") ? Kind::run : Kind::finished};
      json.at("files").get_to(reply.files);
      if (json.contains("run")) reply.run = run_of_record(json.at("run"));
      if (json.contains("page")) json.at("page").get_to(reply.page);
      send(reply);
    }
  }

  SuiteTeam team_number(std::size_t i) const {
    if (experiment_.setup.generate) return draw_crossing(*experiment_.setup.generate, i);
    return experiment_.setup.teams->teams[i];
  }

  void run_all(const SuiteTeam& given, const std::vector<std::size_t>& led, const SendPart& send) const {
    Team team = make_team(given, map_, experiment_.setup.policies);
    ReportPage page = page_of_team(team, map_, experiment_.setup.title + ": " + given.name);
    look_from(page, map_, team.robots.front().space->robot().map_from_base.translation());
    for (const std::size_t p : led) {
      Files files;
      const CompareRun run = run_once(given, team, p, page, files);
      send(part_of({{"run", record_of(run)}, {"files", files}}));
    }
    Files files;
    const std::string name = folder() / (name_as_file(given.name) + ".html");
    if (!page.plans.empty()) files[name] = render_report_page(page);
    send(part_of({{"page", files.empty() ? "" : name}, {"files", files}}));
  }

  /// One planner leads the team; what moved is saved and added to the page where it is shown.
  CompareRun run_once(const SuiteTeam& given, Team& team, std::size_t planner, ReportPage& page,
                      Files& files) const {
    const ComparePlanner& who = experiment_.planners[planner];
    const TeamOptions& options = experiment_.leaders[planner];
    const auto& sensing = experiment_.setup.teams->sensing;
    std::optional<SensedSpaces> spaces;
    if (sensing) {
      spaces.emplace(team, given.moving, *sensing, world_, map_, experiment_.setup.policies);
      team.sensed = [&spaces](std::size_t robot, double time) { return spaces->at(robot, time); };
    }
    TeamCircumstances circumstances{.unseen_motion = unseen_motion(team, sensing),
                                    .gravity = experiment_.setup.gravity};
    for (const SuiteTeamRobot& robot : given.robots) circumstances.payloads.push_back(robot.payload);
    double time = 0.0;
    const TeamRun run = reported(given, planner, [&] {
      const Deadline deadline(experiment_.time_limit);
      const Stopwatch watch(time);
      return run_team(team, options, [&] { return circumstances.is_cut_short = deadline.is_over(); });
    });
    const TeamVerdict verdict =
        check_team(team, run, options.max_acceleration, run.figures.influence_distance);
    CompareRun found = team_result(team, run, verdict, circumstances);
    found.planner = planner;
    found.seed = choice_.seed;
    found.time = time;
    if (experiment_.setup.generate && found.check != "refused" && !choice_.only) return found;
    const fs::path file = folder() / name_as_file(given.name) / (labels_[planner] + ".json");
    files[file.string()] = team_json(team, run, verdict, who.planner, who.options);
    found.plan_file = file.string();
    page.plans.push_back(page_of_run(team, run, verdict, found, options.max_acceleration, who.label));
    if (spaces) show_sensed(page.plans.back(), team, run, *spaces);
    return found;
  }

  fs::path folder() const { return fs::path("teams") / name_as_file(experiment_.setup.name); }

  template <typename Work>
  TeamRun reported(const SuiteTeam& team, std::size_t planner, const Work& work) const {
    try {
      return work();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("experiment '" + experiment_.setup.name + "', team '" + team.name +
                                  "', planner '" + experiment_.planners[planner].label +
                                  "': " + error.what());
    }
  }

  const PreparedExperiment& experiment_;
  const CompareChoice& choice_;
  const SuiteWorld world_;
  const Snapshot map_;
  const std::string digest_;
  const std::vector<std::string> labels_;
};

}  // namespace

Snapshot team_map(const Suite& suite, const SuiteExperiment& experiment) {
  const SuiteWorld world = world_of(suite, experiment);
  if (world.name.empty()) return empty_map();
  return world.map.empty() ? make_map(world, {}) : load_map(world.map);
}

std::size_t count_teams(const SuiteExperiment& experiment) {
  return experiment.generate ? static_cast<std::size_t>(experiment.generate->count)
                             : experiment.teams->teams.size();
}

std::unique_ptr<ProblemServer> make_team_server(const Suite& suite, const PreparedExperiment& experiment,
                                                const CompareChoice& choice) {
  return std::make_unique<TeamServer>(suite, experiment, choice);
}

}  // namespace clearway
