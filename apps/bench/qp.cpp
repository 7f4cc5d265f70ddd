// Quadratic programs of the local step: QuadraticSolver against the plain dense form of the same method. In
// `detail`: how far a million random programs of many kinds are from the optimality conditions.

#include "apps/bench/bench.hpp"
#include "apps/bench/peers/dense_program.hpp"
#include "apps/bench/worlds/random_programs.hpp"
#include "planning/constraint/quadratic_solver.hpp"

namespace clearway::bench {
namespace {

constexpr int judged = 1'000'000;
constexpr int timed = 1'000;

/// Of one kind: what was found, and the worst residuals.
nlohmann::ordered_json judge_kind(ProgramKind kind, int count, double& worst) {
  ProgramDice dice(17 + static_cast<std::uint64_t>(kind));
  int feasible = 0, infeasible = 0, not_a_number = 0, above = 0;
  Judgement solved;
  double proof = 0.0;
  while (feasible + infeasible < count) {
    const QuadraticProgram program = random_program(dice, kind, dice.below(20) == 0 ? 200 : 40);
    const QuadraticSolution solution = solve(program);
    const Judgement judgement = judge(program, solution);
    not_a_number += !judgement.is_number;
    worst = std::max(worst, judgement.relative);
    if (solution.feasible) {
      ++feasible;
      solved.relative = std::max(solved.relative, judgement.relative);
      solved.absolute = std::max(solved.absolute, judgement.absolute);
      above += judgement.absolute > 1e-9;
    } else {
      ++infeasible;
      proof = std::max(proof, judgement.relative);
    }
  }
  return {{"feasible", feasible},
          {"infeasible_proved", infeasible},
          {"not_a_number", not_a_number},
          {"worst_residual", solved.relative},
          {"worst_residual_absolute", solved.absolute},
          {"absolute_above_1e-9", above},
          {"worst_residual_of_proofs", proof}};
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

}  // namespace

BenchResult bench_qp(const BenchOptions& options) {
  nlohmann::ordered_json detail;
  double worst = 0.0;
  for (std::size_t kind = 0; kind < program_kinds.size(); ++kind) {
    const int count = judged / static_cast<int>(program_kinds.size()) + 1;
    detail[program_kinds[kind]] = judge_kind(static_cast<ProgramKind>(kind), count, worst);
  }
  detail["worst_residual"] = worst;
  QuadraticSolver solver;
  Pair pair;
  for (const int constraints : {5, 40, 10}) {
    const std::vector<QuadraticProgram> programs = steps(constraints);
    int iterations = 0;
    pair = interleave(
        options.runs, [&] { return time_ours(programs, solver, iterations); },
        [&] {
          return 1e6 / timed * cpu_seconds([&] {
                   for (const QuadraticProgram& program : programs) solve_densely(program);
                 });
        });
    detail["rows_" + std::to_string(constraints)] = {{"ours_us", pair.ours},
                                                     {"peer_us", pair.peer},
                                                     {"iterations", static_cast<double>(iterations) / timed}};
  }
  return {pair.ours,    pair.peer, "the same method in dense matrices", "CPU us, 6 joints, 10 rows", true,
          options.runs, detail};
}

}  // namespace clearway::bench
