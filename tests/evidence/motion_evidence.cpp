#include "tests/evidence/motion_evidence.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>

#include "apps/compare/compare_run.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"
#include "tests/evidence/drawn_world.hpp"

namespace clearway::evidence {
namespace {

constexpr std::uint64_t motions_of_a_world = 24;
constexpr double rounding_of_shares = 1e-6, sampling = 1e-3;

/// Differences of positions a millisecond apart, by nothing but the cubics' positions: velocities exactly
/// their mean, accelerations and jerk likewise, so that none may exceed its limit.
void sample_motion(const Motion& motion, const RateLimits& limits, MotionEvidence& evidence) {
  const auto share = [](const Eigen::VectorXd& values, const Eigen::VectorXd& limit) {
    return values.cwiseAbs().cwiseQuotient(limit).maxCoeff();
  };
  std::array<Configuration, 4> last{};  // the newest first
  last.fill(motion.positions.front());
  const double h = sampling;
  for (double k = 1.0; (k - 4.0) * h <= motion.duration(); ++k) {
    std::rotate(last.begin(), last.end() - 1, last.end());
    last[0] = motion.at(k * h).position;
    evidence.velocity = std::max(evidence.velocity, share((last[0] - last[1]) / h, limits.velocity));
    evidence.acceleration =
        std::max(evidence.acceleration,
                 share(((last[0] - last[1]) - (last[1] - last[2])) / (h * h), limits.acceleration));
    ++evidence.samples;
  }
  const MotionShares rates = shares_of(greatest_rates(motion), limits);
  evidence.velocity = std::max(evidence.velocity, rates.velocity);
  evidence.acceleration = std::max(evidence.acceleration, rates.acceleration);
  evidence.jerk = std::max(evidence.jerk, rates.jerk);
}

void judge(const ConfigurationSpace& space, const Plan& plan, const std::string& name,
           MotionEvidence& evidence) {
  const std::vector<Configuration> path = plan.waypoints();
  if (path.size() < 2 || path.front() == path.back()) return;
  const PlannedMotion planned = plan_motion(space, plan);
  const RateLimits limits = rate_limits(space.robot());
  MotionEvidence own;
  sample_motion(planned.motion, limits, own);
  const double today = time_parameterize(space.robot(), path).points.back().time;
  ++own.paths;
  own.blended = planned.blended;
  own.stops = planned.stops;
  own.ratio = {planned.motion.duration() / today};
  own.cpu = {planned.cpu_s};
  own.cpu_by_waypoint = {planned.cpu_s / static_cast<double>(path.size())};
  const double worst = std::max({own.velocity, own.acceleration, own.jerk});
  if (!planned.validation.valid) {
    ++own.refused;
    own.broken.push_back(name + ": " + planned.validation.fault);
  } else if (!(worst <= 1.0 + rounding_of_shares)) {
    own.broken.push_back(name + ": a limit is exceeded, " + std::to_string(worst) + " of it");
  }
  evidence.add(own);
}

}  // namespace

void MotionEvidence::add(const MotionEvidence& other) {
  paths += other.paths;
  blended += other.blended;
  stops += other.stops;
  samples += other.samples;
  refused += other.refused;
  velocity = std::max(velocity, other.velocity);
  acceleration = std::max(acceleration, other.acceleration);
  jerk = std::max(jerk, other.jerk);
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  append(ratio, other.ratio);
  append(cpu, other.cpu);
  append(cpu_by_waypoint, other.cpu_by_waypoint);
  append(broken, other.broken);
}

MotionEvidence judge_motions(std::uint64_t seed, std::uint64_t begin, std::uint64_t end) {
  constexpr std::array<const char*, 4> planners{"rrtconnect", "boundary_plus", "beam_guided", "auto"};
  MotionEvidence evidence;
  DrawnWorld world;
  std::uint64_t of_world = ~std::uint64_t{0};
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::uint64_t number = seed * 1000003 + i / motions_of_a_world;
    if (of_world != number) world = draw_world(of_world = number);
    Random random(seed * 0x2545f4914f6cdd1dULL + i);
    const auto ends = draw_ends(*world.space, random);
    if (!ends) continue;
    const char* planner = planners[i % planners.size()];
    const Plan plan = plan_and_check({.space = *world.space,
                                      .start = ends->first,
                                      .goals = {ends->second},
                                      .planner = make_planner(planner, {}),
                                      .seed = i + 1,
                                      .time_limit = 1.0,
                                      .survey = std::nullopt,
                                      .advice_time = 0.0});
    if (plan.is_proved())
      judge(*world.space, plan, "problem " + std::to_string(i) + ", " + planner + ", " + world.what,
            evidence);
  }
  return evidence;
}

MotionEvidence judge_motions_of(const std::filesystem::path& file, std::size_t most) {
  MotionEvidence evidence;
  const Suite suite = load_suite(file);
  for (const SuiteExperiment& experiment : suite.experiments) {
    if (experiment.teams || (experiment.generate && experiment.generate->kind == "crossings")) continue;
    const PreparedExperiment prepared = prepare(suite, experiment, {});
    const SuiteStages stages(suite, prepared.setup, prepared.robot);
    std::size_t count = 0;
    for (std::size_t s = 0; s < stages.size() && count < most; ++s) {
      const SuiteStage stage = stages.make(s);
      const ConfigurationSpace space(prepared.robot, stage.map, prepared.policies,
                                     {.padding = prepared.setup.padding.value_or(0.0)});
      for (const StageProblem& problem : stage.problems) {
        if (++count > most) break;
        for (std::size_t p = 0; p < prepared.makers.size(); ++p) {
          const Plan plan = plan_and_check({.space = space,
                                            .start = problem.start,
                                            .goals = problem.goals,
                                            .planner = prepared.makers[p],
                                            .time_limit = std::min(prepared.time_limit, 2.0),
                                            .survey = std::nullopt,
                                            .advice_time = 0.0});
          if (plan.is_proved())
            judge(space, plan, experiment.name + ", " + problem.name + ", " + prepared.planners[p].label,
                  evidence);
        }
      }
    }
  }
  return evidence;
}

}  // namespace clearway::evidence
