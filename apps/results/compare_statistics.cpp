#include "apps/results/compare_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

#include "apps/console/parse.hpp"
#include "apps/console/quantile.hpp"

namespace clearway {
namespace {

constexpr double significance = 0.05;
constexpr double normal_quantile = 1.959963984540054;  // of 95 %, two-sided

/// The same of Student's t: exact of 1 and 2 degrees of freedom, else the expansion of Abramowitz and Stegun,
/// 26.7.5, which is within 0.2 %.
double student_quantile(double degrees) {
  if (degrees <= 1.0) return 12.706204736174698;
  if (degrees <= 2.0) return 4.302652729911275;
  const double z = normal_quantile, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z, z9 = z7 * z * z;
  const double first = (z3 + z) / 4.0, second = (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 96.0,
               third = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / 384.0,
               fourth = (79.0 * z9 + 776.0 * z7 + 1482.0 * z5 - 1920.0 * z3 - 945.0 * z) / 92160.0;
  return z + (first + (second + (third + fourth / degrees) / degrees) / degrees) / degrees;
}

/// Twice the mean ranks of the sizes: whole numbers, whatever is tied.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& differences) {
  std::vector<std::size_t> order(differences.size()), ranks(differences.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto size = [&](std::size_t i) { return std::abs(differences[i]); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return size(a) < size(b); });
  for (std::size_t first = 0; first < order.size();) {
    std::size_t end = first;
    while (end < order.size() && size(order[end]) == size(order[first])) ++end;
    for (std::size_t k = first; k < end; ++k) ranks[order[k]] = first + end + 1;
    first = end;
  }
  return ranks;
}

/// Share of all choices of signs whose sum of doubled ranks of one sign is at most `sum`.
double exact_tail(const std::vector<std::size_t>& ranks, std::size_t sum) {
  std::vector<double> share(std::accumulate(ranks.begin(), ranks.end(), std::size_t{0}) + 1, 0.0);
  share[0] = 1.0;
  std::size_t reached = 0;
  for (const std::size_t rank : ranks) {
    reached += rank;
    for (std::size_t s = reached + 1; s-- > 0;)
      share[s] = 0.5 * (share[s] + (s >= rank ? share[s - rank] : 0.0));
  }
  return std::accumulate(share.begin(), share.begin() + static_cast<std::ptrdiff_t>(sum) + 1, 0.0);
}

/// The same by the normal distribution; the variance of doubled ranks holds the correction for ties.
double normal_tail(const std::vector<std::size_t>& ranks, std::size_t sum) {
  double total = 0.0, squares = 0.0;
  for (const std::size_t rank : ranks) {
    total += static_cast<double>(rank);
    squares += static_cast<double>(rank) * static_cast<double>(rank);
  }
  const double continuity = 1.0;  // half a rank, doubled
  const double z = (static_cast<double>(sum) + continuity - 0.5 * total) / std::sqrt(0.25 * squares);
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Of each problem by its index: the median figure of a planner's valid runs.
std::map<std::size_t, double> medians(const CompareExperiment& experiment, std::size_t planner,
                                      double CompareRun::*figure) {
  std::map<std::size_t, double> found;
  for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
    std::vector<double> values;
    for (const CompareRun& run : experiment.problems[i].runs)
      if (run.planner == planner && run.is_valid() && run.*figure > 0.0) values.push_back(run.*figure);
    if (!values.empty()) found[i] = quantile(values, 0.5);
  }
  return found;
}

PairedFigure paired(const CompareExperiment& experiment, std::size_t first, std::size_t second,
                    double CompareRun::*figure) {
  const auto ours = medians(experiment, first, figure), theirs = medians(experiment, second, figure);
  PairedFigure found;
  std::vector<double> logarithms;
  for (const auto& [problem, value] : ours) {
    const auto other = theirs.find(problem);
    if (other == theirs.end()) continue;
    ++found.problems;
    logarithms.push_back(log_ratio(value, other->second));
    found.less += logarithms.back() < 0.0;
  }
  if (logarithms.empty()) return found;
  found.p = signed_rank_test(logarithms);
  found.ratio = std::exp(quantile(logarithms, 0.5));
  found.other = median_of_others(logarithms);
  return found;
}

void count_successes(const CompareExperiment& experiment, PairedPlanners& pair) {
  for (const CompareProblem& problem : experiment.problems) {
    int difference = 0, runs_more = 0;
    bool is_solved = false;
    for (const CompareRun& run : problem.runs) {
      is_solved |= run.is_valid() && (run.planner == pair.first || run.planner == pair.second);
      if (run.planner == pair.first) difference += run.is_valid();
      if (run.planner == pair.second) difference -= run.is_valid();
      runs_more += (run.planner == pair.first) - (run.planner == pair.second);
    }
    if (runs_more != 0) continue;  // interrupted: one of them has not had its turn
    pair.first_more += difference > 0;
    pair.second_more += difference < 0;
    pair.solved += is_solved;
  }
  pair.success_p = sign_test(pair.first_more, pair.second_more);
}

void correct(std::vector<PairedPlanners>& pairs, const std::function<double&(PairedPlanners&)>& p_of) {
  std::vector<double> p_values;
  for (PairedPlanners& pair : pairs) p_values.push_back(p_of(pair));
  const std::vector<double> corrected = holm_corrected(p_values);
  for (std::size_t i = 0; i < pairs.size(); ++i) p_of(pairs[i]) = corrected[i];
}

std::string success_words(const PairedPlanners& pair, const std::string& a, const std::string& b) {
  const std::size_t differ = pair.first_more + pair.second_more;
  if (pair.solved == 0) return "Neither solves a problem.";
  if (differ == 0) return "Both solve the same problems.";
  const bool first_leads = pair.first_more > pair.second_more;
  const std::string counts = std::to_string(std::max(pair.first_more, pair.second_more)) + " of " +
                             counted(differ, "problem") + " on which they differ, p " +
                             p_text(pair.success_p);
  if (pair.success_p >= significance) return "No difference in success beyond chance (" + counts + ").";
  return (first_leads ? a : b) + " solves more (" + counts + ").";
}

std::string figure_words(const PairedFigure& figure, const std::string& what, const std::string& better,
                         const std::string& a, const std::string& b) {
  if (figure.problems == 0) return "";
  const std::string counts = std::to_string(figure.problems) +
                             (figure.problems == 1 ? " problem" : " problems") + " that both solve, p " +
                             p_text(figure.p);
  if (figure.p >= significance) return " No difference in " + what + " beyond chance (" + counts + ").";
  if (figure.is_equal())
    return " The median of " + what +
           " is the same to a thousandth, with and without those that are equal (" + counts + ").";
  const bool first_leads = figure.effect() < 1.0;
  const double share = first_leads ? figure.effect() : 1.0 / figure.effect();
  return " " + (first_leads ? a : b) + " " + better + " " + significant(100.0 * share) + " % of " +
         (first_leads ? b : a) + "'s " + what +
         (figure.is_of_others() ? " (median of those that differ, over " : " (median over ") + counts + ").";
}

}  // namespace

std::pair<double, double> wilson_interval(double share, double trials) {
  if (!(trials > 0.0)) return {0.0, 1.0};
  const double n = trials, z = normal_quantile;
  const double middle = share + z * z / (2.0 * n);
  const double half = z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  const double scale = 1.0 + z * z / n;
  return {share <= 0.0 ? 0.0 : (middle - half) / scale, share >= 1.0 ? 1.0 : (middle + half) / scale};
}

double effective_runs(const std::vector<ProblemRuns>& problems) {
  double runs = 0.0, valid = 0.0, squares = 0.0, with_runs = 0.0;
  for (const ProblemRuns& problem : problems) {
    const auto total = static_cast<double>(problem.total);
    runs += total;
    valid += static_cast<double>(problem.valid);
    squares += total * total;
    with_runs += problem.total > 0;
  }
  if (runs == 0.0) return 0.0;
  const double share = valid / runs, least = runs * runs / squares;
  if (with_runs < 2.0 || valid == 0.0 || valid == runs) return least;
  double scatter = 0.0;
  for (const ProblemRuns& problem : problems) {
    const double residual = static_cast<double>(problem.valid) - share * static_cast<double>(problem.total);
    scatter += residual * residual;
  }
  const double variance = with_runs / (with_runs - 1.0) * scatter / (runs * runs);
  const double correction = student_quantile(runs - 1.0) / student_quantile(with_runs - 1.0);
  const double effective = share * (1.0 - share) / variance * correction * correction;  // infinity: runs
  return std::clamp(effective, least, runs);
}

const char* const interval_note =
    "Intervals of success hold, at 95 % confidence, for problems like these: seeds of one problem tend to "
    "agree and count for fewer runs (Wilson's interval of the effective sample size, Korn and Graubard "
    "1998).";

double sign_test(std::size_t more, std::size_t fewer) {
  const std::size_t n = more + fewer, least = std::min(more, fewer);
  double tail = 0.0;
  for (std::size_t k = 0; k <= least; ++k) {
    const double logarithm = std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
    tail += std::exp(logarithm - static_cast<double>(n) * std::log(2.0));
  }
  return std::min(1.0, 2.0 * tail);
}

double median_of_others(std::vector<double> logarithms) {
  std::erase(logarithms, 0.0);
  return logarithms.empty() ? 1.0 : std::exp(quantile(logarithms, 0.5));
}

double log_ratio(double one, double other) {
  constexpr double rounding = 1e-9;
  const double logarithm = std::log(one / other);
  return std::abs(logarithm) < rounding ? 0.0 : logarithm;
}

double signed_rank_test(const std::vector<double>& differences) {
  std::vector<double> used;
  for (const double difference : differences)
    if (difference != 0.0) used.push_back(difference);
  if (used.empty()) return 1.0;
  const std::vector<std::size_t> ranks = doubled_ranks(used);
  std::size_t positive = 0, all = 0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    all += ranks[i];
    if (used[i] > 0.0) positive += ranks[i];
  }
  const std::size_t least = std::min(positive, all - positive);
  constexpr std::size_t most_exact = 100;
  const double tail = used.size() <= most_exact ? exact_tail(ranks, least) : normal_tail(ranks, least);
  return std::min(1.0, 2.0 * tail);
}

std::vector<double> holm_corrected(const std::vector<double>& p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> corrected(p_values.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    largest = std::max(largest, std::min(1.0, static_cast<double>(order.size() - k) * p_values[order[k]]));
    corrected[order[k]] = largest;
  }
  return corrected;
}

std::vector<PairedPlanners> paired_planners(const CompareExperiment& experiment) {
  std::vector<PairedPlanners> pairs;
  if (experiment.setup.teams) return pairs;
  for (std::size_t a = 0; a < experiment.planners.size(); ++a) {
    for (std::size_t b = a + 1; b < experiment.planners.size(); ++b) {
      PairedPlanners pair{.first = a, .second = b};
      count_successes(experiment, pair);
      pair.cpu = paired(experiment, a, b, &CompareRun::cpu);
      pair.cost = paired(experiment, a, b, &CompareRun::cost);
      pairs.push_back(pair);
    }
  }
  correct(pairs, [](PairedPlanners& pair) -> double& { return pair.success_p; });
  correct(pairs, [](PairedPlanners& pair) -> double& { return pair.cpu.p; });
  correct(pairs, [](PairedPlanners& pair) -> double& { return pair.cost.p; });
  for (PairedPlanners& pair : pairs) {
    const std::string &a = experiment.planners[pair.first].label, &b = experiment.planners[pair.second].label;
    pair.words = success_words(pair, a, b) + figure_words(pair.cpu, "CPU time", "needs", a, b) +
                 figure_words(pair.cost, "path cost", "has", a, b);
  }
  return pairs;
}

std::string p_text(double p) { return p < 1e-4 ? "< 0.0001" : "= " + significant(p, 2); }

}  // namespace clearway
