#include "apps/compare/compare_team.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>

#include "apps/compare/compare_files.hpp"
#include "apps/compare/sensed_page.hpp"
#include "apps/compare/team_page.hpp"
#include "apps/compare/team_result.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/suites/sensed_spaces.hpp"
#include "apps/suites/suite_teams.hpp"
#include "apps/suites/suite_world.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/parallel.hpp"

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

/// The runs of one experiment's teams, shared out to several threads.
class TeamRunner {
 public:
  TeamRunner(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : experiment_(experiment),
        choice_(choice),
        world_(world_of(suite, experiment.setup)),
        map_(*experiment.map),
        digest_(map_sha256(map_)),
        labels_(names_as_files(experiment.planners)) {}

  void run(CompareExperiment& result, const std::function<void(double)>& progress) {
    const std::size_t count = experiment_.setup.generate
                                  ? static_cast<std::size_t>(experiment_.setup.generate->count)
                                  : experiment_.setup.teams->teams.size();
    result.problems.resize(count);
    std::atomic<std::size_t> next = 0;
    std::size_t done = 0;
    std::mutex mutex;
    parallel_until_false(static_cast<std::size_t>(choice_.jobs), [&] {
      const std::size_t i = next++;
      if (i >= count) return false;
      result.problems[i] = run_team_number(i);
      if (choice_.finished != nullptr)
        choice_.finished->add(experiment_.setup.name, experiment_.planners, result.problems[i]);
      const std::lock_guard lock(mutex);
      progress(static_cast<double>(++done) / static_cast<double>(count));
      return true;
    });
  }

 private:
  SuiteTeam team_number(std::size_t i) const {
    if (experiment_.setup.generate) return draw_crossing(*experiment_.setup.generate, i);
    return experiment_.setup.teams->teams[i];
  }

  CompareProblem run_team_number(std::size_t i) const {
    const SuiteTeam given = team_number(i);
    Team team = make_team(given, map_, experiment_.setup.policies);
    CompareProblem problem;
    problem.name = given.name;
    problem.world = experiment_.setup.world.empty() ? "nothing" : experiment_.setup.world;
    problem.map_sha256 = digest_;
    problem.resolution = map_.resolution();
    ReportPage page = page_of_team(team, map_, experiment_.setup.title + ": " + given.name);
    look_from(page, map_, team.robots.front().space->robot().map_from_base.translation());
    for (std::size_t p = 0; p < experiment_.planners.size(); ++p)
      problem.runs.push_back(run_once(given, team, p, page));
    if (!page.plans.empty()) {
      const fs::path file = folder() / (name_as_file(given.name) + ".html");
      save_file(choice_.out / file, render_report_page(page));
      problem.page = file.string();
    }
    return problem;
  }

  /// One planner leads the team; what moved is saved and added to the page where it is shown.
  CompareRun run_once(const SuiteTeam& given, Team& team, std::size_t planner, ReportPage& page) const {
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
    const TeamRun run = told(given, planner, [&] {
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
    if (experiment_.setup.generate && found.check != "refused") return found;
    const fs::path file = folder() / name_as_file(given.name) / (labels_[planner] + ".json");
    fs::create_directories(choice_.out / file.parent_path());
    save_file(choice_.out / file, team_json(team, run, verdict, who.planner, who.options));
    found.plan_file = file.string();
    page.plans.push_back(page_of_run(team, run, verdict, found, options.max_acceleration, who.label));
    if (spaces) show_sensed(page.plans.back(), team, run, *spaces);
    return found;
  }

  fs::path folder() const { return fs::path("teams") / name_as_file(experiment_.setup.name); }

  template <typename Work>
  TeamRun told(const SuiteTeam& team, std::size_t planner, const Work& work) const {
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

CompareExperiment run_team_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                      const CompareChoice& choice,
                                      const std::function<void(double)>& progress) {
  CompareExperiment result;
  result.setup = experiment.setup;
  result.time_limit = experiment.time_limit;
  result.planners = experiment.planners;
  TeamRunner(suite, experiment, choice).run(result, progress);
  return result;
}

}  // namespace clearway
