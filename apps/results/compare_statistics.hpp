#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "apps/results/compare_results.hpp"

namespace clearway {

/// Shares of successes that agree with `successes` of `total` trials, at 95 % confidence: Wilson's score
/// interval (E. B. Wilson 1927, J. Am. Stat. Assoc. 22, p. 209). 0 and 1 without trials.
std::pair<double, double> wilson_interval(std::size_t successes, std::size_t total);

/// Two-sided exact sign test: how probable it is that of `more + fewer` fair coins so many or more fall on
/// one side. 1 when there is none.
double sign_test(std::size_t more, std::size_t fewer);

/// Two-sided Wilcoxon signed-rank test (F. Wilcoxon 1945, Biometrics Bull. 1, p. 80) of paired differences:
/// how probable ranks so far from even are when both signs are equally likely. Zeros are left out, equal
/// sizes share their mean rank. Exact up to 100 differences, beyond by the normal approximation with
/// corrections for ties and continuity. 1 when there is none.
double signed_rank_test(const std::vector<double>& differences);

/// p values corrected for their number (S. Holm 1979, Scand. J. Stat. 6, p. 65), in their order: with all of
/// them below 0.05 taken as differences, one in twenty families has a wrong one.
std::vector<double> holm_corrected(const std::vector<double>& p_values);

/// One figure of two planners, problem by problem: of each the median over its valid runs.
struct PairedFigure {
  std::size_t problems = 0;  ///< that both have valid runs of
  std::size_t less = 0;      ///< of these: the first planner has less
  double ratio = 1.0;        ///< median of the first's share of the second's
  double p = 1.0;            ///< signed-rank test of the logarithms of the shares
};

/// Two planners on the same problems.
struct PairedPlanners {
  std::size_t first = 0, second = 0;            ///< indices of the experiment's planners
  std::size_t first_more = 0, second_more = 0;  ///< problems of which one has more valid runs
  double success_p = 1.0;                       ///< sign test of these
  PairedFigure cpu = {}, cost = {};
  std::string words = {};  ///< what that means, a sentence or more
};

/// All pairs of an experiment of single robots, none of teams; p values are corrected for the number of
/// pairs.
std::vector<PairedPlanners> paired_planners(const CompareExperiment& experiment);

/// "0.012", "< 0.0001".
std::string p_text(double p);

}  // namespace clearway
