#include "apps/compare_team.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "apps/compare_files.hpp"
#include "apps/map_page.hpp"
#include "apps/parse.hpp"
#include "apps/sensed_spaces.hpp"
#include "apps/stopwatch.hpp"
#include "apps/suite_teams.hpp"
#include "apps/suite_world.hpp"
#include "apps/team_page.hpp"
#include "mapping/map_digest.hpp"
#include "mapping/map_file.hpp"
#include "mapping/save_file.hpp"
#include "planning/joint_weights.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

SuiteWorld world_of(const Suite& suite, const SuiteExperiment& experiment) {
  for (const SuiteWorld& world : suite.worlds)
    if (world.name == experiment.world) return world;
  return {};
}

Snapshot map_of(const SuiteWorld& world) {
  if (world.name.empty()) return empty_map();
  return world.map.empty() ? make_map(world, {}) : load_map(world.map);
}

double length_of(const std::vector<Configuration>& path) {
  double length = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) length += (path[i] - path[i - 1]).norm();
  return length;
}

/// What a thing that is known from scans alone can move from when it is seen until the next scan is known, m.
double unseen_motion(const Team& team, const std::optional<SuiteSensing>& sensing) {
  double farthest = 0.0;
  for (const MovingObstacle& obstacle : team.obstacles)
    if (obstacle.is_sensed && sensing)
      farthest = std::max(farthest, obstacle.greatest_speed() * (sensing->latency + 1.0 / sensing->rate_hz));
  return farthest;
}

/// Where an obstacle outran a robot, distances from obstacles do not count, and robots that it drove together
/// need only not touch. @param bound of one period's motion @param unseen that of sensed obstacles
std::string check_word(const TeamRun& run, const TeamVerdict& verdict, double bound, double unseen) {
  const double least = run.figures.security_distance - bound;
  const bool keeps = verdict.least_separation >= least - unseen && verdict.between_robots >= least;
  if (verdict.greatest_speed_share > 1.0 + 1e-6 || !verdict.robots_are_apart) return "refused";
  if (!run.outrun.empty()) return "outrun";
  return verdict.is_apart && keeps ? "valid" : "refused";
}

std::string contact_of(const TeamVerdict& verdict) {
  if (!verdict.contact.empty()) return verdict.contact;
  return verdict.between + " came within " + significant(1000.0 * verdict.least_separation) + " mm at " +
         significant(verdict.time, 4) + " s";
}

/// The runs of one experiment's teams, shared out to several threads.
class TeamRunner {
 public:
  TeamRunner(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : experiment_(experiment),
        choice_(choice),
        world_(world_of(suite, experiment.setup)),
        map_(map_of(world_)),
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
    std::exception_ptr error;
    const auto work = [&] {
      try {
        for (std::size_t i = next++; i < count; i = next++) {
          result.problems[i] = run_team_number(i);
          const std::lock_guard lock(mutex);
          progress(static_cast<double>(++done) / static_cast<double>(count));
        }
      } catch (...) {
        next = count;
        const std::lock_guard lock(mutex);
        if (!error) error = std::current_exception();
      }
    };
    std::vector<std::jthread> others;
    for (int i = 1; i < choice_.jobs; ++i) others.emplace_back(work);
    work();
    others.clear();
    if (error) std::rethrow_exception(error);
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
    const fs::path folder = fs::path("teams") / name_as_file(experiment_.setup.name);
    ReportPage page = page_of_team(team, map_, experiment_.setup.title + ": " + given.name);
    for (std::size_t p = 0; p < experiment_.planners.size(); ++p) {
      const TeamOptions& options = experiment_.leaders[p];
      CompareRun found;
      TeamRun run;
      const auto& sensing = experiment_.setup.teams->sensing;
      std::optional<SensedSpaces> spaces;
      if (sensing) {
        spaces.emplace(team, given.moving, *sensing, world_, experiment_.setup.policies);
        team.sensed = [&spaces](std::size_t robot, double time) { return spaces->at(robot, time); };
      }
      {
        const Stopwatch watch(found.time);
        run = told(given, p, [&] { return run_team(team, options); });
      }
      const TeamVerdict verdict =
          check_team(team, run, options.max_acceleration, run.figures.influence_distance);
      describe(team, run, verdict, unseen_motion(team, sensing), found);
      found.planner = p;
      found.seed = choice_.seed;
      if (!experiment_.setup.generate || found.check == "refused") {
        const fs::path file = folder / name_as_file(given.name) / (labels_[p] + ".json");
        fs::create_directories(choice_.out / file.parent_path());
        save_file(choice_.out / file, team_json(team, run, verdict, experiment_.planners[p].planner,
                                                experiment_.planners[p].options));
        found.plan_file = file.string();
        if (spaces) show_map(page, spaces->map());
        page.plans.push_back(page_of_run(team, run, verdict, found, experiment_.planners[p].label));
      }
      problem.runs.push_back(std::move(found));
    }
    if (!page.plans.empty()) {
      const fs::path file = folder / (name_as_file(given.name) + ".html");
      save_file(choice_.out / file, render_report_page(page));
      problem.page = file.string();
    }
    return problem;
  }

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

  static void describe(const Team& team, const TeamRun& run, const TeamVerdict& verdict, double unseen,
                       CompareRun& found) {
    found.status = run.status;
    found.explanation = run.explanation;
    found.team.emplace();
    found.team->security_distance = run.figures.security_distance;
    found.team->step_bound = run.step_bound() + unseen;
    found.team->obstacle_speed = run.figures.greatest_obstacle_speed;
    found.team->motion_time = static_cast<double>(run.steps()) * run.period;
    found.team->outrun = run.outrun;
    found.team->acceleration = verdict.greatest_acceleration_share;
    if (run.steps() == 0) return;
    found.check = check_word(run, verdict, run.step_bound(), unseen);
    if (found.check == "refused") found.contact = contact_of(verdict);
    found.legs = run.status == PlanStatus::solved ? 1 : 0;
    found.steps = run.steps();
    found.waypoints = run.steps() + 1;
    found.min_clearance = verdict.least_separation;
    for (std::size_t i = 0; i < run.traces.size(); ++i) {
      found.length += length_of(run.traces[i].positions);
      found.cost += PathCost(team.robots[i].space->robot())(run.traces[i].positions);
      found.team->deadlocks += run.traces[i].deadlocks;
      found.team->over_acceleration += run.traces[i].accelerated;
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
