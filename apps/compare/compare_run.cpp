#include "apps/compare/compare_run.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <deque>
#include <map>
#include <set>
#include <stdexcept>

#include "apps/compare/compare_inputs.hpp"
#include "apps/compare/compare_team.hpp"
#include "apps/compare/problem_server.hpp"
#include "apps/compare/worker_process.hpp"
#include "apps/results/compare_files.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/damaged_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Kind = ProblemReply::Kind;

/// What a worker does: plans a problem, or (none) opens a stage.
struct ServerTask {
  std::size_t stage = 0;
  std::optional<std::size_t> problem;
  bool operator<(const ServerTask& other) const {
    return std::pair(stage, problem) < std::pair(other.stage, other.problem);
  }
};

/// Its place at the table.
struct Seat {
  std::unique_ptr<WorkerProcess> worker;
  std::optional<std::size_t> stage;  ///< that it has open
  std::optional<ServerTask> task;
  std::optional<std::size_t> preparing;  ///< a planner
  Clock::time_point prepared_by = {};
};

/// A stage, and which of its problems nobody has taken.
struct StageState {
  enum { closed, opening, open } is = closed;
  std::deque<std::size_t> to_do;
};

std::size_t stage_count(const PreparedExperiment& experiment, const std::optional<SuiteStages>& stages) {
  return experiment.setup.teams ? 1 : stages->size();
}

std::size_t most_problems(const PreparedExperiment& experiment, const std::optional<SuiteStages>& stages,
                          std::size_t stage) {
  return experiment.setup.teams ? count_teams(experiment.setup) : stages->problems(stage);
}

int runs_of(const PreparedExperiment& experiment) {
  return experiment.setup.teams ? 1 : experiment.setup.runs;
}

std::optional<SuiteStages> stages_of(const Suite& suite, const PreparedExperiment& experiment) {
  if (experiment.setup.teams) return std::nullopt;
  return std::optional<SuiteStages>(std::in_place, suite, experiment.setup, experiment.robot);
}

/// One experiment, handed out to workers problem by problem.
class ExperimentRunner {
 public:
  ExperimentRunner(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                   const CompareChoice& choice, CompareRecords& records, const CompareProgress& progress)
      : suite_(suite),
        experiment_(experiment),
        index_(index),
        choice_(choice),
        records_(records),
        progress_(progress),
        all_(count_runs(suite, experiment, index, choice)),
        seats_(static_cast<std::size_t>(choice.isolation.is_on ? choice.jobs : 1)) {
    const auto stages = stages_of(suite, experiment);
    stages_.resize(stage_count(experiment, stages));
    for (std::size_t s = 0; s < stages_.size(); ++s) {
      const std::size_t problems = most_problems(experiment, stages, s);
      bool is_mine = choice.only.has_value();
      for (std::size_t i = 0; i < problems; ++i) is_mine = is_mine || is_in(choice.shard, index, s, i);
      if (!is_mine) stages_[s].is = StageState::open;  // nothing to do there
      if (records.stage(index, s) != nullptr) take_up(s);
    }
  }

  void run() {
    while (hand_out()) wait();
  }

 private:
  /// What is left of a stage that is known.
  void take_up(std::size_t s) {
    const CompareRecords::Stage& stage = *records_.stage(index_, s);
    stages_[s].is = StageState::open;
    for (std::size_t i = 0; i < stage.size(); ++i) {
      if (!is_wanted(s, i, stage[i].found)) continue;
      done_ += stage[i].found.runs.size();
      if (!stage[i].is_finished) stages_[s].to_do.push_back(i);
    }
    if (choice_.only && !stages_[s].to_do.empty())
      for (StageState& other : stages_) other.is = StageState::open;
  }

  bool is_wanted(std::size_t s, std::size_t i, const CompareProblem& problem) const {
    if (choice_.only) return name_as_file(problem.name) == choice_.only->problem;
    return is_in(choice_.shard, index_, s, i);
  }

  /// Gives every idle worker something to do, as far as there is something. False when all is done.
  bool hand_out() {
    for (Seat& seat : seats_) {
      while (!seat.task) {  // without isolation it is done when it was started
        seat.task = next_task(seat);
        if (!seat.task) break;
        start(seat);
      }
    }
    return std::any_of(seats_.begin(), seats_.end(), [](const Seat& seat) { return seat.task.has_value(); });
  }

  /// Of the stage that the worker has open; else a new stage; else of the stage with most to do, which the
  /// worker then opens, too.
  std::optional<ServerTask> next_task(const Seat& seat) {
    if (seat.stage && !stages_[*seat.stage].to_do.empty()) return take(*seat.stage);
    for (std::size_t s = 0; s < stages_.size(); ++s) {
      if (stages_[s].is != StageState::closed) continue;
      stages_[s].is = StageState::opening;
      return ServerTask{s, std::nullopt};
    }
    const auto most = std::max_element(
        stages_.begin(), stages_.end(),
        [](const StageState& a, const StageState& b) { return a.to_do.size() < b.to_do.size(); });
    if (most == stages_.end() || most->to_do.empty()) return std::nullopt;
    return take(static_cast<std::size_t>(most - stages_.begin()));
  }

  ServerTask take(std::size_t s) {
    const ServerTask task{s, stages_[s].to_do.front()};
    stages_[s].to_do.pop_front();
    return task;
  }

  void start(Seat& seat) {
    const ProblemRequest request = request_for(*seat.task);
    seat.stage = seat.task->stage;
    if (!choice_.isolation.is_on) {
      if (!server_) server_ = make_problem_server(suite_, experiment_, choice_);
      server_->answer(request, [&](const ProblemReply& reply) { take_reply(seat, reply); });
      return;
    }
    if (!seat.worker) seat.worker = std::make_unique<WorkerProcess>(service());
    seat.worker->ask(to_bytes(request));
  }

  /// What a worker does, in its own process.
  WorkerProcess::Serve service() const {
    return [this, server = std::shared_ptr<ProblemServer>()](std::string_view bytes,
                                                             const WorkerProcess::Reply& reply) mutable {
      if (!server) server = make_problem_server(suite_, experiment_, choice_);
      server->answer(request_of_bytes(bytes),
                     [&](const ProblemReply& reported) { reply(to_bytes(reported)); });
    };
  }

  ProblemRequest request_for(const ServerTask& task) const {
    ProblemRequest request{.stage = task.stage, .problem = task.problem, .unsafe = unsafe_};
    if (!task.problem) return request;
    for (const CompareRun& run : records_.stage(index_, task.stage)->at(*task.problem).found.runs)
      request.have.emplace(run.planner, run.number);
    for (std::size_t p = 0; choice_.only && p < experiment_.planners.size(); ++p)
      for (int number = 1; number <= runs_of(experiment_); ++number)
        if (number != choice_.only->number) request.wanted_not.emplace(p, number);
    return request;
  }

  /// Until a worker says something, a second is over, or somebody has prepared for too long.
  void wait() {
    std::vector<pollfd> waiting;
    std::vector<Seat*> who;
    for (Seat& seat : seats_) {
      if (!seat.task || !seat.worker) continue;
      waiting.push_back({seat.worker->descriptor(), POLLIN, 0});
      who.push_back(&seat);
    }
    constexpr int a_second = 1000;
    const int ready = ::poll(waiting.data(), waiting.size(), waiting.empty() ? 0 : a_second);
    if (ready < 0 && errno != EINTR) throw std::runtime_error("cannot wait for the planners' processes");
    progress_(done_, all_);
    for (std::size_t i = 0; i < who.size(); ++i) {
      if (ready > 0 && waiting[i].revents != 0) listen(*who[i]);
      if (who[i]->preparing && Clock::now() > who[i]->prepared_by) lose(*who[i]);
    }
  }

  void listen(Seat& seat) {
    for (const std::string& bytes : seat.worker->replies()) take_reply(seat, reply_of_bytes(bytes));
    if (seat.worker->has_ended()) lose(seat);
  }

  /// The worker crashed, or hangs. What it was at is given out again; a planner that did that while it
  /// prepared does so in its runs' own processes from now on.
  void lose(Seat& seat) {
    const ServerTask task = *seat.task;
    const std::string how = seat.worker->has_ended() ? seat.worker->how_it_ended() : "did not end";
    seat.worker.reset();
    seat.stage.reset();
    seat.task.reset();
    if (seat.preparing) {
      unsafe_.insert(*seat.preparing);
    } else if (++lost_[task] > 1) {
      throw std::runtime_error("experiment '" + experiment_.setup.name + "': the process that " +
                               (task.problem ? "plans" : "makes the world") + " " + how + ", twice");
    }
    seat.preparing.reset();
    if (task.problem) {
      stages_[task.stage].to_do.push_front(*task.problem);
    } else {
      stages_[task.stage].is = StageState::closed;
    }
  }

  void take_reply(Seat& seat, const ProblemReply& reply) {
    const ServerTask task = *seat.task;
    switch (reply.kind) {
      case Kind::opened:
        save(reply);
        records_.open(index_, task.stage, reply.problems, reply.sentence);
        take_up(task.stage);
        return seat.task.reset();
      case Kind::preparing:
        seat.preparing = reply.planner;
        seat.prepared_by = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(choice_.isolation.grace));
        return;
      case Kind::prepared:
        return seat.preparing.reset();
      case Kind::run:
        save(reply);
        records_.add(index_, task.stage, *task.problem, *reply.run);
        ++done_;
        return progress_(done_, all_);
      case Kind::finished:
        save(reply);
        records_.finish(index_, task.stage, *task.problem, reply.page);
        return seat.task.reset();
      case Kind::bad_input:
        throw std::invalid_argument(reply.sentence);
      case Kind::damaged:
        throw DamagedFile(reply.sentence);
      case Kind::failed:
        throw std::runtime_error(reply.sentence);
    }
  }

  /// Maps that several stages share are written once.
  void save(const ProblemReply& reply) const {
    for (const auto& [name, bytes] : reply.files) {
      const fs::path file = choice_.out / name;
      make_folder_of(file);
      if (reply.kind == Kind::opened && fs::exists(file) && fs::file_size(file) == bytes.size()) continue;
      save_file(file, bytes);
    }
  }

  const Suite& suite_;
  const PreparedExperiment& experiment_;
  std::size_t index_;
  const CompareChoice& choice_;
  CompareRecords& records_;
  const CompareProgress& progress_;
  std::size_t all_, done_ = 0;  ///< runs
  std::vector<Seat> seats_;
  std::vector<StageState> stages_;
  std::set<std::size_t> unsafe_;           ///< planners that took a worker down
  std::map<ServerTask, int> lost_;         ///< how often a worker ended in it
  std::unique_ptr<ProblemServer> server_;  ///< without isolation
};

}  // namespace

std::size_t count_runs(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                       const CompareChoice& choice, const CompareRecords* records) {
  if (choice.only) return 1;
  const auto stages = stages_of(suite, experiment);
  std::size_t problems = 0;
  for (std::size_t s = 0; s < stage_count(experiment, stages); ++s) {
    if (records != nullptr && records->is_drawn_in_vain(index, s)) continue;
    for (std::size_t i = 0; i < most_problems(experiment, stages, s); ++i)
      problems += is_in(choice.shard, index, s, i);
  }
  return problems * experiment.planners.size() * static_cast<std::size_t>(runs_of(experiment));
}

CompareExperiment asked_of(const PreparedExperiment& experiment) {
  CompareExperiment asked;
  asked.setup = experiment.setup;
  asked.time_limit = experiment.time_limit;
  asked.planners = experiment.planners;
  asked.problems_sha256 = problems_digest(experiment.setup);
  asked.robot_sha256 =
      experiment.setup.teams ? team_robots_digest(*experiment.setup.teams) : robot_digest(experiment.robot);
  if (experiment.setup.teams) return asked;
  asked.robot_file = experiment.robot.source.string();
  asked.scale = experiment.robot.scale;
  for (const Joint& joint : experiment.robot.joints) {
    asked.joints.push_back(joint.name);
    asked.is_prismatic.push_back(joint.kind == JointKind::prismatic);
  }
  return asked;
}

void run_experiment(const Suite& suite, const PreparedExperiment& experiment, std::size_t index,
                    const CompareChoice& choice, CompareRecords& records, const CompareProgress& progress) {
  ExperimentRunner(suite, experiment, index, choice, records, progress).run();
}

CompareExperiment run_experiment(const Suite& suite, const PreparedExperiment& experiment,
                                 const CompareChoice& choice) {
  CompareAsked asked;
  asked.results.experiments.push_back(asked_of(experiment));
  CompareRecords records(std::move(asked));
  run_experiment(suite, experiment, 0, choice, records, [](std::size_t, std::size_t) {});
  return records.results(choice.out).experiments.front();
}

}  // namespace clearway
