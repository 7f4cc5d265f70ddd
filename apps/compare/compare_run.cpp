#include "apps/compare/compare_run.hpp"

#include <algorithm>
#include <charconv>
#include <mutex>
#include <stdexcept>

#include "apps/compare/compare_columns.hpp"
#include "apps/compare/compare_files.hpp"
#include "apps/compare/compare_tasks.hpp"
#include "apps/compare/compare_team.hpp"
#include "apps/pages/map_page.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

std::string verdict_of(const Plan& plan) {
  if (plan.validation.valid) return "valid";
  if (plan.waypoints().empty()) return "none";
  return plan.validation.undecided ? "undecided" : "refused";
}

/// For Chong 2008, eq. 9, edges are cut into pieces of at most that, rad (m): so paths of few long edges and
/// of many short ones are judged alike, whatever their planner reckons.
constexpr double cost_step = 0.05;

/// Nothing for a motion that lasts too long to be sampled.
std::optional<CompareMotion> motion_of(const Robot& robot, const std::vector<Configuration>& path) try {
  const Trajectory trajectory = time_parameterize(robot, path);
  const LimitShares shares = limit_shares(robot, trajectory);
  return CompareMotion{trajectory.points.back().time, shares.velocity, shares.acceleration};
} catch (const std::invalid_argument&) {
  return std::nullopt;
}

/// rad per metre that the planner was given; 0, automatic, where it was given none.
double given_prismatic_scale(const Plan& plan) {
  const auto found = plan.options.find("prismatic_scale");
  double scale = 0.0;
  if (found != plan.options.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), scale);
  return scale;
}

/// @param cost what the planner reckoned with
CompareRun run_of(const Plan& plan, const ConfigurationSpace& space, const PathCost& cost) {
  CompareRun run;
  run.seed = plan.seed;
  run.status = plan.status();
  run.explanation = plan.explanation();
  run.check = verdict_of(plan);
  run.contact = plan.validation.first_contact;
  run.length = joint_space_length(plan.waypoints());
  run.cost =
      sampled_cost(cost, plan.waypoints(), joint_weights(space, given_prismatic_scale(plan)), cost_step);
  run.waypoints = plan.waypoints().size();
  run.min_clearance = plan.validation.min_clearance;
  run.time = plan.time_s;
  run.cpu = plan.cpu_s;
  run.check_time = plan.check_s;
  run.check_cpu = plan.check_cpu_s;
  run.statistics = column_statistics(plan.legs);
  if (plan.validation.valid) run.motion = motion_of(space.robot(), plan.waypoints());
  for (const PlanResult& leg : plan.legs) {
    run.legs += leg.status == PlanStatus::solved;
    run.configurations += leg.configurations_checked;
    run.edges += leg.edges_checked;
    if (leg.status != PlanStatus::solved) continue;
    run.steps += static_cast<std::size_t>(leg.search_steps);
  }
  return run;
}

/// What is found, in the order of stages and problems.
class Collected {
 public:
  explicit Collected(std::size_t stages) : stages_(stages) {}

  void open(std::size_t stage, std::size_t problems) {
    const std::lock_guard lock(mutex_);
    stages_[stage].resize(problems);
  }
  /// Returns the share of all that is done, a stage that is not open counted as one.
  double add(std::size_t stage, std::size_t problem, CompareProblem found,
             std::vector<CompareProfile> profiles) {
    const std::lock_guard lock(mutex_);
    auto& place = stages_[stage];
    place[problem] = std::move(found);
    if (stage == 0 && problem == 0) profiles_ = std::move(profiles);
    done_ += 1.0 / static_cast<double>(place.size());
    return done_ / static_cast<double>(stages_.size());
  }
  void move_to(CompareExperiment& experiment) {
    for (auto& stage : stages_) {
      for (CompareProblem& problem : stage) experiment.problems.push_back(std::move(problem));
    }
    experiment.profiles = std::move(profiles_);
  }

 private:
  std::mutex mutex_;
  std::vector<std::vector<CompareProblem>> stages_;
  std::vector<CompareProfile> profiles_;
  double done_ = 0.0;
};

/// One experiment, planned by several threads.
class Runner {
 public:
  Runner(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : experiment_(experiment),
        choice_(choice),
        stages_(suite, experiment_.setup, experiment_.robot),
        names_(names_as_files(experiment.planners)),
        collected_(stages_.size()),
        tasks_(stages_.size(), [this](std::size_t index) { return make_stage(index); }) {}

  void run(CompareExperiment& result, const std::function<void(double)>& progress) {
    std::mutex mutex;
    parallel_until_false(static_cast<std::size_t>(choice_.jobs), [&] {
      try {
        const auto task = tasks_.next();
        if (!task) return false;
        const double done = plan(*task);
        const std::lock_guard lock(mutex);
        progress(done);
        return true;
      } catch (...) {
        tasks_.fail();  // or those that wait for a stage would wait for ever
        throw;
      }
    });
    collected_.move_to(result);
  }

 private:
  std::shared_ptr<OpenStage> make_stage(std::size_t index) {
    SuiteStage stage = stages_.make(index);
    const double before = thread_cpu_seconds();
    ConfigurationSpace space(experiment_.robot, stage.map, experiment_.policies,
                             {.padding = experiment_.setup.padding.value_or(0.0)});
    const double space_cpu = thread_cpu_seconds() - before;
    collected_.open(index, stage.problems.size());
    if (stage.map_file.empty() && (choice_.keep_maps || !experiment_.setup.generate)) {
      stage.map_file = keep_map(stage).string();
    }
    return std::make_shared<OpenStage>(OpenStage{std::move(stage), std::move(space), index, space_cpu});
  }

  /// A folder that `clearway check --map` reads, named by what is in it.
  fs::path keep_map(const SuiteStage& stage) {
    const fs::path name = fs::path("maps") / (name_as_file(stage.world) + "-" + stage.digest.substr(0, 8));
    const fs::path folder = choice_.out / name;
    const std::lock_guard lock(maps_);
    if (!fs::exists(folder / "map.ot") || map_sha256(folder) != stage.digest) {
      fs::create_directories(folder);
      save_map(stage.map, folder);
    }
    return choice_.shown_out / name;
  }

  double plan(const StageTask& task) {
    const SuiteStage& stage = task.stage->stage;
    const StageProblem& problem = stage.problems[task.problem];
    CompareProblem found{problem.name,           stage.world,   stage.map_file, stage.digest,
                         stage.map.resolution(), problem.start, problem.goals,  {}};
    std::vector<CompareProfile> profiles;
    const auto& plots = experiment_.setup.plots;
    const bool profiled = std::find(plots.begin(), plots.end(), "profiles") != plots.end() &&
                          task.stage->index == 0 && task.problem == 0;
    const bool is_shown = std::find(plots.begin(), plots.end(), "animation") != plots.end();
    ReportPage page;
    if (is_shown) page = page_of_problem(*task.stage, problem);
    for (std::size_t i = 0; i < experiment_.planners.size(); ++i) {
      for (int number = 1; number <= experiment_.setup.runs; ++number) {
        const PlanQuery query = query_of(*task.stage, problem, i, number);
        double derive_cpu = 0.0;
        const Plan plan = plan_once(query, problem, i, derive_cpu);
        CompareRun run = run_of(plan, task.stage->space, path_cost(query));
        run.space_cpu = task.stage->space_cpu;
        run.derive_cpu = derive_cpu;
        run.planner = i;
        run.number = number;
        run.plan_file = save_plan(plan, problem, i, number);
        found.runs.push_back(std::move(run));
        if (is_shown && number == 1)
          page.plans.push_back(
              page_of_plan(plan, task.stage->space, problem.start, experiment_.planners[i].label));
        if (profiled && number == 1 && !plan.waypoints().empty()) profiles.push_back({i, plan.waypoints()});
      }
    }
    if (is_shown) found.page = save_page(page, problem);
    if (choice_.finished != nullptr)
      choice_.finished->add(experiment_.setup.name, experiment_.planners, found);
    return collected_.add(task.stage->index, task.problem, std::move(found), std::move(profiles));
  }

  PlanQuery query_of(const OpenStage& open, const StageProblem& problem, std::size_t planner,
                     int number) const {
    return {.space = open.space,
            .start = problem.start,
            .goals = problem.goals,
            .planner = experiment_.makers[planner],
            .seed = choice_.seed + static_cast<std::uint64_t>(number - 1),
            .time_limit = experiment_.time_limit,
            .payload = experiment_.setup.payload,
            .gravity = experiment_.setup.gravity,
            .survey = std::nullopt,  // suites judge planners, in scenes whose unknown is theirs
            .advice_time = 0.0,
            .robot_name = experiment_.setup.robot,
            .map_file = open.stage.map_file,
            .map_digest = open.stage.digest};
  }

  /// @param derive_cpu s, of what the planner derives from the map, which is no part of the plan's time
  Plan plan_once(const PlanQuery& query, const StageProblem& problem, std::size_t planner,
                 double& derive_cpu) const {
    try {
      {
        const ThreadStopwatch cpu(derive_cpu);
        query.planner->plan({query.space, path_cost(query), problem.start, problem.start, query.seed});
      }
      return plan_and_check(query);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("experiment '" + experiment_.setup.name + "', problem '" + problem.name +
                                  "', planner '" + experiment_.planners[planner].label +
                                  "': " + error.what());
    }
  }

  ReportPage page_of_problem(const OpenStage& open, const StageProblem& problem) const {
    ReportPage page = page_of_map(open.stage.map, experiment_.setup.title + ": " + problem.name);
    look_from(page, open.stage.map, experiment_.robot.map_from_base.translation());
    show_robot(page, experiment_.robot, problem.start);
    return page;
  }

  std::string save_page(const ReportPage& page, const StageProblem& problem) const {
    const fs::path file = fs::path("animations") / name_as_file(experiment_.setup.name) /
                          (name_as_file(problem.name) + ".html");
    fs::create_directories(choice_.out / file.parent_path());
    save_file(choice_.out / file, render_report_page(page));
    return file.string();
  }

  std::string save_plan(const Plan& plan, const StageProblem& problem, std::size_t planner,
                        int number) const {
    const std::string run = experiment_.setup.runs > 1 ? "-" + std::to_string(number) : "";
    const fs::path file = fs::path("plans") / name_as_file(experiment_.setup.name) /
                          name_as_file(problem.name) / (names_[planner] + run + ".json");
    fs::create_directories(choice_.out / file.parent_path());
    save_file(choice_.out / file, to_json(plan));
    return file.string();
  }

  const PreparedExperiment& experiment_;
  const CompareChoice& choice_;
  SuiteStages stages_;
  std::vector<std::string> names_;
  Collected collected_;
  StageTasks tasks_;
  std::mutex maps_;
};

}  // namespace

CompareExperiment run_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                 const CompareChoice& choice, const std::function<void(double)>& progress) {
  if (experiment.setup.teams) return run_team_experiment(suite, experiment, choice, progress);
  CompareExperiment result;
  result.setup = experiment.setup;
  result.robot_file = experiment.robot.source.string();
  result.scale = experiment.robot.scale;
  result.time_limit = experiment.time_limit;
  for (const Joint& joint : experiment.robot.joints) {
    result.joints.push_back(joint.name);
    result.is_prismatic.push_back(joint.kind == JointKind::prismatic);
  }
  result.planners = experiment.planners;
  Runner(suite, experiment, choice).run(result, progress);
  return result;
}

}  // namespace clearway
