// Quadratic programs of the local step: QuadraticSolver against quadprog, and against the plain dense form of
// the same method. And how far random programs of many kinds are from the optimality conditions.

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/peers/dense_program.hpp"
#include "apps/bench/peers/quadprog.hpp"
#include "apps/bench/worlds/random_programs.hpp"
#include "planning/constraint/quadratic_solver.hpp"

namespace clearway::bench {
namespace {

constexpr int judged_a_run = 100'000, timed = 1'000;  ///< programs

/// Of one kind: what was found, and the worst residuals.
struct KindFound {
  int feasible = 0, infeasible = 0, not_a_number = 0, above = 0;
  Judgement solved;
  double proof = 0.0;

  void add(const QuadraticProgram& program) {
    const QuadraticSolution solution = solve(program);
    const Judgement judgement = bench::judge(program, solution);
    not_a_number += !judgement.is_number;
    (solution.feasible ? feasible : infeasible)++;
    if (!solution.feasible) {
      proof = std::max(proof, judgement.relative);
      return;
    }
    solved.relative = std::max(solved.relative, judgement.relative);
    solved.absolute = std::max(solved.absolute, judgement.absolute);
    above += judgement.absolute > 1e-9;
  }
  nlohmann::ordered_json json() const {
    return {{"feasible", feasible},
            {"infeasible_proved", infeasible},
            {"not_a_number", not_a_number},
            {"worst_residual", solved.relative},
            {"worst_residual_absolute", solved.absolute},
            {"absolute_above_1e-9", above},
            {"worst_residual_of_proofs", proof}};
  }
};

Table judge_kinds(const BenchOptions& options, nlohmann::ordered_json& detail) {
  Table table{
      "Random programs, up to 14 joints and 200 rows; worst residual of the optimality conditions, or of the "
      "proof that there is no solution, relative to the size of the terms:",
      {"kind", "solved", "proved infeasible", "worst of solutions", "worst of proofs"},
      {}};
  const int count = judged_a_run * options.runs / static_cast<int>(program_kinds.size()) + 1;
  double worst = 0.0;
  for (std::size_t i = 0; i < program_kinds.size(); ++i) {
    options.say(std::string("judging ") + program_kinds[i]);
    ProgramDice dice(17 + i);
    KindFound found;
    for (int k = 0; k < count; ++k)
      found.add(random_program(dice, static_cast<ProgramKind>(i), dice.below(20) == 0 ? 200 : 40));
    detail[program_kinds[i]] = found.json();
    worst = std::max({worst, found.solved.relative, found.proof});
    table.rows.push_back({program_kinds[i], count_text(found.feasible), count_text(found.infeasible),
                          figure(found.solved.relative), figure(found.proof)});
  }
  detail["worst_residual"] = worst;
  return table;
}

/// Steps of an arm with six joints among `constraints` constraints, of which some are active.
std::vector<QuadraticProgram> steps(int constraints) {
  ProgramDice dice(5);
  std::vector<QuadraticProgram> programs(timed);
  for (QuadraticProgram& p : programs) {
    p.target = dice.vector(6, 0.01);
    p.matrix.resize(constraints, 6);
    for (Eigen::Index i = 0; i < constraints; ++i) p.matrix.row(i) = dice.vector(6, 0.5).transpose();
    p.bounds = dice.vector(constraints, 0.006).array() + 0.008;
    p.lower = Eigen::VectorXd::Constant(6, -0.02);
    p.upper = -p.lower;
  }
  return programs;
}

/// CPU us a program with a solver that is kept, constraints handed over one by one.
double time_ours(const std::vector<QuadraticProgram>& programs, QuadraticSolver& solver, int& iterations) {
  iterations = 0;
  std::vector<Eigen::MatrixXd> normals;
  for (const QuadraticProgram& p : programs) normals.emplace_back(p.matrix.transpose());
  const auto numbers = [](const auto& dense) {
    return std::span(dense.data(), static_cast<std::size_t>(dense.size()));
  };
  return 1e6 / timed * cpu_seconds([&] {
           for (std::size_t k = 0; k < programs.size(); ++k) {
             const QuadraticProgram& p = programs[k];
             solver.begin(6);
             solver.set_target(numbers(p.target));
             solver.set_limits(numbers(p.lower), numbers(p.upper));
             for (Eigen::Index i = 0; i < p.bounds.size(); ++i)
               solver.add_constraint({normals[k].col(i).data(), 6}, p.bounds[i]);
             solver.solve();
             iterations += solver.iterations();
           }
         });
}

/// CPU us a program, handed over as quadprog wants it beforehand.
double time_quadprog(const std::vector<QuadraticProgram>& programs, Quadprog& quadprog) {
  std::vector<Quadprog::Program> prepared;
  for (const QuadraticProgram& p : programs) prepared.push_back(Quadprog::prepare(p));
  return 1e6 / timed * cpu_seconds([&] {
           for (const Quadprog::Program& p : prepared) quadprog.solve(p);
         });
}

double time_dense(const std::vector<QuadraticProgram>& programs) {
  return 1e6 / timed * cpu_seconds([&] {
           for (const QuadraticProgram& program : programs) solve_densely(program);
         });
}

/// The farthest that a solution of quadprog's is from ours.
/// @throws std::logic_error when only one of them finds any.
double difference(const std::vector<QuadraticProgram>& programs, Quadprog& quadprog) {
  double most = 0.0;
  for (const QuadraticProgram& p : programs) {
    const QuadraticSolution ours = solve(p);
    const std::vector<double>& theirs = quadprog.solve(Quadprog::prepare(p));
    if (ours.feasible == theirs.empty()) throw std::logic_error("quadprog differs about what is feasible");
    for (std::size_t j = 0; j < theirs.size(); ++j)
      most = std::max(most, std::abs(theirs[j] - ours.x[static_cast<Eigen::Index>(j)]));
  }
  return most;
}

/// Medians of the runs, CPU us a program.
struct ProgramTimes {
  std::vector<double> ours, quadprog, dense;
  double iterations = 0.0, apart = 0.0;
};

ProgramTimes time_programs(const BenchOptions& options, int constraints, Quadprog& quadprog) {
  const std::vector<QuadraticProgram> programs = steps(constraints);
  QuadraticSolver solver;
  ProgramTimes times;
  int iterations = 0;
  if (quadprog.is_there()) times.apart = difference(programs, quadprog);
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    times.ours.push_back(time_ours(programs, solver, iterations));
    if (quadprog.is_there()) times.quadprog.push_back(time_quadprog(programs, quadprog));
    times.dense.push_back(time_dense(programs));
  }
  times.iterations = static_cast<double>(iterations) / timed;
  return times;
}

}  // namespace

BenchResult bench_qp(const BenchOptions& options) {
  Quadprog quadprog;
  const std::string name = "the same method in dense matrices";
  BenchResult result{0,
                     0,
                     quadprog.is_there() ? "quadprog (Goldfarb-Idnani)" : name,
                     "CPU us, 6 joints, 10 rows",
                     true,
                     options.runs,
                     {}};
  Table table{"Steps of an arm with 6 joints, CPU us per program; solutions are at most this far apart:",
              {"rows", "ours", "quadprog", "ratio", name, "ratio to it", "apart, rad"},
              {}};
  for (const int constraints : {5, 40, 10}) {
    const ProgramTimes times = time_programs(options, constraints, quadprog);
    const double ours = median(times.ours), dense = median(times.dense), theirs = median(times.quadprog);
    auto& constraint = result.detail["rows_" + std::to_string(constraints)];
    constraint = {{"ours_us", ours}, {"dense_us", dense}, {"iterations", times.iterations}};
    if (quadprog.is_there()) constraint.update({{"quadprog_us", theirs}, {"apart", times.apart}});
    const auto reported = [&](double value) { return quadprog.is_there() ? figure(value) : "–"; };
    table.rows.push_back({std::to_string(constraints), figure(ours), reported(theirs),
                          reported(theirs / ours), figure(dense), figure(dense / ours),
                          reported(times.apart)});
    result.ours = ours;
    result.peer = quadprog.is_there() ? theirs : dense;
  }
  if (!quadprog.is_there()) table.note = "quadprog is left out: install `" + Quadprog::package() + "`.";
  result.compared =
      "1,000 random quadratic programs like an arm's steps, with limits: `QuadraticSolver` against Turlach's "
      "quadprog (Debian's `r-cran-quadprog`), the solver behind R's and Python's, called without R and given "
      "the Hessian's factor; and against our own textbook form of the method. quadprog knows no limits: "
      "they are 12 more rows.";
  result.tables = {table, judge_kinds(options, result.detail)};
  return result;
}

}  // namespace clearway::bench
