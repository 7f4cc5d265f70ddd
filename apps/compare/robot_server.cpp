#include "apps/compare/robot_server.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "apps/console/failure.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/query/loads.hpp"
#include "apps/results/compare_columns.hpp"
#include "apps/results/compare_files.hpp"
#include "apps/results/compare_record.hpp"
#include "apps/suites/suite_draws.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/damaged_file.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/thread_time.hpp"
#include "planning/path/any_angle.hpp"
#include "planning/path/path_pieces.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planned_motion.hpp"
#include "planning/space/joint_weights.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Kind = ProblemReply::Kind;

std::string verdict_of(const Plan& plan) {
  if (plan.validation.valid) return "valid";
  if (plan.waypoints().empty()) return "none";
  return plan.validation.undecided ? "undecided" : "refused";
}

/// For Chong 2008, eq. 9, edges are cut into pieces of at most that, rad (m): so paths of few long edges and
/// of many short ones are judged alike, whatever their planner reckons.
constexpr double cost_step = 0.05;

/// Nothing for a motion that lasts too long to be sampled.
std::optional<CompareMotion> motion_of(const Plan& plan, const Robot& robot) try {
  if (plan.motion) {
    const MotionShares shares = shares_of(greatest_rates(plan.motion->motion), rate_limits(robot));
    return CompareMotion{plan.motion->motion.duration(), shares.velocity, shares.acceleration, shares.jerk};
  }
  const Trajectory trajectory = trajectory_of(robot, plan);
  const LimitShares shares = limit_shares(robot, trajectory);
  CompareMotion motion{trajectory.points.back().time, shares.velocity, shares.acceleration};
  motion.note = plan.motion_caveat;
  return motion;
} catch (const std::invalid_argument&) {
  return std::nullopt;
}

/// As pages show them. A longer one may take longer to make and to check than a run is granted.
bool is_short_enough_to_move(const Plan& plan, const Robot& robot) {
  constexpr double longest_motion = 1200.0;  // s
  return least_duration(robot, plan.waypoints()) <= longest_motion;
}

/// The motion along a proved plan, which is no part of the time that it took to plan.
void add_motion(Plan plan, const ConfigurationSpace& space, CompareRun& run) {
  if (!plan.is_proved() || !is_short_enough_to_move(plan, space.robot())) return;
  const ThreadStopwatch cpu(run.motion_cpu);
  give_motion(space, plan);
  run.motion = motion_of(plan, space.robot());
}

/// rad per metre that the planner was given; 0, automatic, where it was given none.
double given_prismatic_scale(const Plan& plan) {
  const auto found = plan.options.find("prismatic_scale");
  double scale = 0.0;
  if (found != plan.options.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), scale);
  return scale;
}

/// J of the legs solved, each with the loads that rode on it.
double cost_of(const Plan& plan, const PlanQuery& query) {
  const Eigen::VectorXd weights = joint_weights(query.space, given_prismatic_scale(plan));
  if (plan.loads.empty()) return sampled_cost(path_cost(query), plan.waypoints(), weights, cost_step);
  double joules = 0.0;
  for (std::size_t leg = 0; leg < plan.legs.size(); ++leg) {
    if (plan.legs[leg].status != PlanStatus::solved) continue;
    const Robot loaded = robot_of_leg(query.space.robot(), plan.loads, static_cast<int>(leg));
    joules += sampled_cost(path_cost(query, loaded), plan.legs[leg].waypoints, weights, cost_step);
  }
  return joules;
}

CompareRun run_of(const Plan& plan, const PlanQuery& query) {
  const ConfigurationSpace& space = query.space;
  CompareRun run;
  run.seed = plan.seed;
  run.status = plan.status();
  run.explanation = plan.explanation();
  run.check = verdict_of(plan);
  run.contact = plan.validation.first_contact;
  run.length = joint_space_length(plan.waypoints());
  run.cost = plan.cost_caveat.empty() ? cost_of(plan, query) : std::numeric_limits<double>::quiet_NaN();
  run.waypoints = plan.waypoints().size();
  run.min_clearance = plan.validation.min_clearance;
  run.time = plan.time_s;
  run.cpu = plan.cpu_s;
  run.check_time = plan.check_s;
  run.check_cpu = plan.check_cpu_s;
  run.statistics = column_statistics(plan.legs);
  run.solved_by = solving_stage(plan.legs);
  add_motion(plan, space, run);
  for (const PlanResult& leg : plan.legs) {
    run.legs += leg.status == PlanStatus::solved;
    run.configurations += leg.configurations_checked;
    run.edges += leg.edges_checked;
    run.work = run.work + leg.work;
    if (leg.status != PlanStatus::solved) continue;
    run.steps += static_cast<std::size_t>(leg.search_steps);
  }
  return run;
}

/// "&cut=z:0.5,-x:0.1"; empty for no values.
std::string asked_for(const std::string& key, const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "&" + key + "=" : ",") + value;
  return text;
}

/// What the page's address would ask for (apps/viewer/README.md).
std::string address_of(const SuiteView& view) {
  std::vector<std::string> planes, eye;
  for (const auto& [plane, at] : view.cut) planes.push_back(plane + ":" + to_text(at));
  for (const double angle : view.eye_deg) eye.push_back(to_text(angle));
  if (!eye.empty()) eye.push_back(to_text(view.zoom));
  const std::string all =
      asked_for("cut", planes) + asked_for("view", eye) + asked_for("layers", view.layers);
  return all.substr(all.empty() ? 0 : 1);
}

/// A stage with the space that all its problems share.
struct OpenStage {
  std::size_t index = 0;
  SuiteStage stage;
  ConfigurationSpace space;
  double space_cpu = 0.0;  ///< s, to make the space
};

class RobotServer : public ProblemServer {
 public:
  RobotServer(const Suite& suite, const PreparedExperiment& experiment, const CompareChoice& choice)
      : experiment_(experiment),
        choice_(choice),
        stages_(suite, experiment_.setup, experiment_.robot),
        names_(names_as_files(experiment.planners)) {}

 private:
  void open(std::size_t index, const Send& send) override {
    try {
      send(opening(opened(index).stage));
    } catch (const DrawnInVain& vain) {
      send({.kind = Kind::opened, .sentence = vain.what()});
    }
  }

  ProblemReply opening(const SuiteStage& stage) const {
    ProblemReply reply{.kind = Kind::opened};
    for (const StageProblem& problem : stage.problems)
      reply.problems.push_back({problem.name,
                                stage.world,
                                stage.map_file,
                                stage.digest,
                                stage.map.resolution(),
                                problem.start,
                                problem.goals,
                                {}});
    if (is_kept_) {
      for (auto& [name, bytes] : files_of_map(stage.map))
        reply.files.emplace(map_folder(stage) / name, std::move(bytes));
    }
    return reply;
  }

  void plan(const ProblemRequest& request, const Send& send) override {
    const OpenStage& open = opened(request.stage);
    const StageProblem& problem = open.stage.problems.at(*request.problem);
    std::map<std::size_t, std::string> first_plans;  ///< of each planner's first run
    for (std::size_t i = 0; i < experiment_.planners.size(); ++i) {
      for (int number = 1; number <= experiment_.setup.runs; ++number) {
        if (request.have.contains({i, number}) || request.wanted_not.contains({i, number})) continue;
        ProblemReply reply{.kind = Kind::run};
        const bool is_safe = !request.unsafe.contains(i);
        double derive_cpu = is_safe ? derived(open, problem, i, send) : 0.0;
        reply.run = run_once(open, problem, i, number, is_safe, derive_cpu, reply.files);
        if (number == 1 && !reply.files.empty()) first_plans[i] = reply.files.begin()->second;
        send(reply);
      }
    }
    ProblemReply end{.kind = Kind::finished};
    const auto& plots = experiment_.setup.plots;
    if (std::find(plots.begin(), plots.end(), "animation") != plots.end()) {
      end.page = page_file(problem);
      end.files[end.page] = page_of_problem(open, problem, 1, first_plans);
    }
    send(end);
  }

  void draw(const ProblemRequest& request, const Send& send) override {
    const OpenStage& open = opened(request.stage);
    const StageProblem& problem = open.stage.problems.at(*request.problem);
    ProblemReply end{.kind = Kind::finished};
    end.page = page_file(problem);
    end.files[end.page] = page_of_problem(open, problem, *request.drawn_number, {});
    send(end);
  }

  const OpenStage& opened(std::size_t index) {
    if (open_ && open_->index == index) return *open_;
    open_.reset();  // two may not fit into the memory
    SuiteStage stage = stages_.make(index);
    const double before = thread_cpu_seconds();
    ConfigurationSpace space(experiment_.robot, stage.map, experiment_.policies,
                             {.padding = experiment_.setup.padding.value_or(0.0)});
    const double space_cpu = thread_cpu_seconds() - before;
    is_kept_ = stage.map_file.empty() && (choice_.keep_maps || !experiment_.setup.generate);
    if (is_kept_) stage.map_file = map_folder(stage).string();
    open_.emplace(OpenStage{index, std::move(stage), std::move(space), space_cpu});
    return *open_;
  }

  /// Below the results: a folder that `clearway check --map` reads, named by what is in it.
  static fs::path map_folder(const SuiteStage& stage) {
    return fs::path("maps") / (name_as_file(stage.world) + "-" + stage.digest.substr(0, 8));
  }

  PlanQuery query_of(const OpenStage& open, const StageProblem& problem, std::size_t planner,
                     int number) const {
    return {.space = open.space,
            .start = problem.start,
            .goals = problem.goals,
            .planner = experiment_.makers[planner],
            .seed = choice_.seed + static_cast<std::uint64_t>(number - 1),
            .time_limit = experiment_.time_limit,
            .loads = problem.loads,
            .payload = experiment_.setup.payload,
            .gravity = experiment_.setup.gravity,
            .survey = std::nullopt,  // suites judge planners, in scenes whose unknown is theirs
            .advice_time = 0.0,
            .splits_cpu = true,
            .robot_name = experiment_.setup.robot,
            .map_file = open.stage.map_file,
            .map_digest = open.stage.digest};
  }

  /// CPU time, s, of what the planner derives from the map, which is no part of a plan's time. It stays here,
  /// for all runs to come.
  double derived(const OpenStage& open, const StageProblem& problem, std::size_t planner,
                 const Send& send) const {
    send({.kind = Kind::preparing, .planner = planner});
    double cpu = 0.0;
    derive(query_of(open, problem, planner, 1), problem, planner, cpu);
    send({.kind = Kind::prepared});
    return cpu;
  }

  void derive(const PlanQuery& query, const StageProblem& problem, std::size_t planner, double& cpu) const {
    reported(problem, planner, [&] {
      const ThreadStopwatch watch(cpu);
      query.planner->plan({query.space, path_cost(query), problem.start, problem.start, query.seed});
    });
  }

  CompareRun run_once(const OpenStage& open, const StageProblem& problem, std::size_t planner, int number,
                      bool is_derived, double derive_cpu, std::map<std::string, std::string>& files) const {
    const PlanQuery query = query_of(open, problem, planner, number);
    const auto work = [&](const SendPart& send) {
      if (!is_derived) derive(query, problem, planner, derive_cpu);
      reported(problem, planner, [&] {
        const Plan plan = plan_and_check(query);
        CompareRun run = run_of(plan, query);
        run.derive_cpu = derive_cpu;
        send(record_of(run).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
        send(to_json(plan));
      });
    };
    double wall = 0.0;
    const IsolatedEnd end = [&] {
      const Stopwatch watch(wall);
      return run_isolated(
          work, choice_.isolation,
          experiment_.time_limit * static_cast<double>(problem.goals.size()) + choice_.isolation.grace);
    }();
    CompareRun run;
    if (end.ended.empty()) {
      run = run_of_record(nlohmann::ordered_json::parse(end.parts.at(0)));
      run.plan_file = plan_file(problem, planner, number);
      files.emplace(run.plan_file, end.parts.at(1));
    } else {
      run.seed = query.seed;
      run.time = wall;
      run.derive_cpu = derive_cpu;
      run.ended = end.ended;
      run.explanation = end.explanation;
    }
    run.space_cpu = open.space_cpu;
    run.planner = planner;
    run.number = number;
    return run;
  }

  template <typename Work>
  void reported(const StageProblem& problem, std::size_t planner, const Work& work) const {
    const std::string where = "experiment '" + experiment_.setup.name + "', problem '" + problem.name +
                              "', planner '" + experiment_.planners[planner].label + "': ";
    try {
      work();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(where + error.what());
    } catch (const DamagedFile&) {
      throw;
    } catch (...) {
      if (choice_.isolation.is_on) throw;  // it is the outcome of its run
      throw std::runtime_error(
          where + "the run ended with an error: " + failure_of(std::current_exception()).sentence +
          "; --isolate yes makes it an outcome of the run");
    }
  }

  std::string plan_file(const StageProblem& problem, std::size_t planner, int number) const {
    const std::string run = experiment_.setup.runs > 1 ? "-" + std::to_string(number) : "";
    return fs::path("plans") / name_as_file(experiment_.setup.name) / name_as_file(problem.name) /
           (names_[planner] + run + ".json");
  }

  std::string page_file(const StageProblem& problem) const {
    return fs::path("animations") / name_as_file(experiment_.setup.name) /
           (name_as_file(problem.name) + ".html");
  }

  /// Of the runs of that number. What an interrupted comparison planned is read from its files.
  std::string page_of_problem(const OpenStage& open, const StageProblem& problem, int number,
                              const std::map<std::size_t, std::string>& plans) const {
    ReportPage page = page_of_map(MapLeaves(open.stage.map), experiment_.setup.title + ": " + problem.name);
    page.subtitle = problem.view.caption;
    page.opens = address_of(problem.view);
    look_from(page, open.stage.map, experiment_.robot.map_from_base.translation());
    show_robot(page, with_all_loads(experiment_.robot, problem.loads), problem.start);
    for (std::size_t i = 0; i < experiment_.planners.size(); ++i) {
      const fs::path file = choice_.out / plan_file(problem, i, number);
      const auto planned = plans.find(i);
      if (planned == plans.end() && !fs::exists(file)) continue;
      Plan plan = planned == plans.end() ? load_plan(file) : parse_plan(planned->second, file.string());
      plan.map_integration = to_string(integration_of(open.stage.map));
      plan.map_caveat = map_caveat(open.stage.map);
      if (is_short_enough_to_move(plan, experiment_.robot)) give_motion(open.space, plan);
      page.plans.push_back(page_of_plan(plan, open.space, problem.start, experiment_.planners[i].label));
    }
    return render_report_page(page);
  }

  const PreparedExperiment& experiment_;
  const CompareChoice& choice_;
  SuiteStages stages_;
  std::vector<std::string> names_;
  std::optional<OpenStage> open_;
  bool is_kept_ = false;  ///< the map of the open stage, below the folder of results
};

}  // namespace

std::unique_ptr<ProblemServer> make_robot_server(const Suite& suite, const PreparedExperiment& experiment,
                                                 const CompareChoice& choice) {
  return std::make_unique<RobotServer>(suite, experiment, choice);
}

}  // namespace clearway
