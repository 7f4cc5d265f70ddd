#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// Shares of successes that agree with a share of so many trials, at 95 % confidence: Wilson's score interval
/// (E. B. Wilson 1927, J. Am. Stat. Assoc. 22, p. 209). 0 and 1 without trials.
/// @param trials need not be whole, see effective_runs
std::pair<double, double> wilson_interval(double share, double trials);

/// The runs of a planner on one problem, one for each seed.
struct ProblemRuns {
  std::size_t valid = 0, total = 0;
};

/// How many independent runs the runs on these problems are worth, where an interval is to hold for problems
/// like these: seeds of one problem tend to agree. It is the effective sample size of a sample of clusters,
/// share (1 - share) / (variance of the share between problems), corrected for few problems by quantiles of
/// Student's t, at most the number of runs (E. L. Korn and B. I. Graubard 1998, Survey Methodology 24,
/// p. 193); Wilson's interval of so many trials is what N. Dean and M. Pagano 2015, J. Surv. Stat. Methodol.
/// 3, p. 484 recommend. It is at least what it would be if all seeds of each problem agreed: the number of
/// problems, where each has as many runs. That it is too where all runs succeed or all fail, or of one
/// problem. With one run each it is the number of runs; 0 without runs.
double effective_runs(const std::vector<ProblemRuns>& problems);

/// What the intervals of shares are, in a sentence.
extern const char* const interval_note;

/// Two-sided exact sign test: how probable it is that of `more + fewer` fair coins so many or more fall on
/// one side. 1 when there is none.
double sign_test(std::size_t more, std::size_t fewer);

/// Two-sided Wilcoxon signed-rank test (F. Wilcoxon 1945, Biometrics Bull. 1, p. 80) of paired differences:
/// how probable ranks so far from even are when both signs are equally likely. Zeros are left out, equal
/// sizes share their mean rank. Exact up to 100 differences, beyond by the normal approximation with
/// corrections for ties and continuity. 1 when there is none.
double signed_rank_test(const std::vector<double>& differences);

/// log(one / other) of positive figures; 0 where they are the same but for rounding.
double log_ratio(double one, double other);

/// exp of the median of those logarithms that are not 0; 1 without one.
double median_of_others(std::vector<double> logarithms);

/// p values corrected for their number (S. Holm 1979, Scand. J. Stat. 6, p. 65), in their order: with all of
/// them below 0.05 taken as differences, one in twenty families has a wrong one.
std::vector<double> holm_corrected(const std::vector<double>& p_values);

/// One figure of two planners, problem by problem: of each the median over its valid runs.
struct PairedFigure {
  std::size_t problems = 0;  ///< that both have valid runs of
  std::size_t less = 0;      ///< of these: the first planner has less
  double ratio = 1.0;        ///< median of the first's share of the second's
  double other = 1.0;        ///< the same median of those problems where it is not 1
  double p = 1.0;            ///< signed-rank test of the logarithms of the shares

  /// The median is 1 to a thousandth, as where most problems have one figure: those that have two say more.
  bool is_of_others() const { return std::abs(ratio - 1.0) < 1e-3; }
  double effect() const { return is_of_others() ? other : ratio; }
  /// So is that of the others: whatever the p value, no planner has an edge worth a word.
  bool is_equal() const { return std::abs(effect() - 1.0) < 1e-3; }
};

/// Two planners on the same problems.
struct PairedPlanners {
  std::size_t first = 0, second = 0;            ///< indices of the experiment's planners
  std::size_t first_more = 0, second_more = 0;  ///< problems of which one has more valid runs
  std::size_t solved = 0;                       ///< problems of which one or both have a valid run
  double success_p = 1.0;                       ///< sign test of those of which one has more
  PairedFigure cpu = {}, cost = {};
  std::string words = {};  ///< what that means, a sentence or more
};

/// All pairs of an experiment of single robots, none of teams; p values are corrected for the number of
/// pairs.
std::vector<PairedPlanners> paired_planners(const CompareExperiment& experiment);

/// "0.012", "< 0.0001".
std::string p_text(double p);

}  // namespace clearway
