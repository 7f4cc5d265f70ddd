#include "apps/bench/live_loop.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <thread>

namespace clearway::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t restart = 400;  ///< turns

double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

long involuntary_switches() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nivcsw;
}

bool set_scheduling(int policy, int priority) {
  const sched_param parameters{.sched_priority = priority};
  return pthread_setschedparam(pthread_self(), policy, &parameters) == 0;
}

/// Which of the places hold a voxel that some constraint keeps the arm from.
std::uint32_t places_in_constraints(const LoopTask& task, const ControlConstraints& constraints) {
  std::uint32_t found = 0;
  for (const ControlConstraint& constraint : constraints.constraints()) {
    if (constraint.other >= 0) continue;
    const Eigen::Vector3d at = constraint.point + constraint.distance * constraint.normal;
    for (std::size_t k = 0; k < task.places.size(); ++k) {
      const double within = task.places[k].radius + 2.0 * task.resolution;
      if ((at - task.places[k].center).squaredNorm() < within * within) found |= 1U << k;
    }
  }
  return found;
}

}  // namespace

double steady_seconds() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

LiveControl::Time steady_time(double seconds) {
  return Clock::time_point(
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
}

LoopLog run_loop(LiveControl& live, const LoopTask& task, bool real_time,
                 const std::function<void()>& before_turn) {
  LoopLog log;
  log.turns.resize(static_cast<std::size_t>(task.duration / (task.period > 0.0 ? task.period : 2e-6)) + 1);
  log.is_real_time = real_time && set_scheduling(SCHED_FIFO, 10);
  const long switches = involuntary_switches();
  const double start = steady_seconds();
  Configuration q = task.one, goal = task.other;
  Eigen::VectorXd wanted = q;
  std::size_t count = 0;
  for (; count < log.turns.size() && steady_seconds() < start + task.duration; ++count) {
    if (task.period > 0.0)
      std::this_thread::sleep_until(steady_time(start + static_cast<double>(count) * task.period));
    before_turn();
    LoopTurn& turn = log.turns[count];
    const double cpu = thread_seconds();
    turn.begin = steady_seconds();
    turn.is_new = live.fetch(q);
    turn.fetch = steady_seconds() - turn.begin;
    turn.fetch_cpu = thread_seconds() - cpu;
    wanted = step_to_goal(live.control().options(), q, goal);
    const LiveControl::Time now = Clock::now();
    live.control().look(q);
    const Eigen::VectorXd& step = live.solve(wanted, now);
    turn.end = steady_seconds();
    turn.cpu = thread_seconds() - cpu;
    turn.age = std::chrono::duration<double>(live.age(now)).count();
    turn.number = static_cast<std::uint32_t>(live.number());
    turn.is_braking = live.is_braking();
    turn.places = places_in_constraints(task, live.control().constraints());
    q += step;
    if ((goal - q).norm() < 1e-3) goal = goal == task.one ? task.other : task.one;
    if (count % restart == restart - 1) q = task.one;
  }
  log.turns.resize(count);
  log.involuntary_switches = involuntary_switches() - switches;
  if (log.is_real_time) set_scheduling(SCHED_OTHER, 0);
  return log;
}

nlohmann::ordered_json microseconds(const std::vector<double>& seconds) {
  return {{"median", 1e6 * median(seconds)},
          {"p99", 1e6 * quantile(seconds, 0.99)},
          {"max", 1e6 * quantile(seconds, 1.0)}};
}

nlohmann::ordered_json reported(const LoopLog& log) {
  std::vector<double> wall, cpu, fetch, fetch_cpu, first, first_cpu, age;
  std::size_t braking = 0;
  for (const LoopTurn& turn : log.turns) {
    wall.push_back(turn.end - turn.begin);
    cpu.push_back(turn.cpu);
    age.push_back(turn.age);
    braking += turn.is_braking;
    if (!turn.is_new) continue;
    fetch.push_back(turn.fetch);
    fetch_cpu.push_back(turn.fetch_cpu);
    first.push_back(turn.end - turn.begin);
    first_cpu.push_back(turn.cpu);
  }
  nlohmann::ordered_json json{{"turns", log.turns.size()},
                              {"real_time_priority", log.is_real_time},
                              {"involuntary_switches", log.involuntary_switches},
                              {"step_us", microseconds(wall)},
                              {"step_cpu_us", microseconds(cpu)}};
  if (fetch.empty()) return json;
  json["maps_taken_over"] = fetch.size();
  json["held_by_hand_over_us"] = microseconds(fetch);
  json["held_by_hand_over_cpu_us"] = microseconds(fetch_cpu);
  json["first_step_with_a_map_us"] = microseconds(first);
  json["first_step_with_a_map_cpu_us"] = microseconds(first_cpu);
  json["age_ms"] = {{"median", 1e3 * median(age)}, {"max", 1e3 * quantile(age, 1.0)}};
  json["turns_braked_for_age"] = braking;
  return json;
}

}  // namespace clearway::bench
