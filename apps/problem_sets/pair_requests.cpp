#include <algorithm>
#include <stdexcept>

#include "apps/problem_sets/import_suite.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// The digits at the end of a name.
std::string digits_of(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  return last == std::string::npos ? name : name.substr(last + 1);
}

/// What the world has in the robot's hand, where the problem does not say otherwise.
void take_attached(const std::vector<ForeignAttached>& bodies, ForeignProblem& problem,
                   std::vector<std::string>& left_out) {
  for (const ForeignAttached& body : bodies) {
    const bool is_detached =
        std::any_of(problem.detached.begin(), problem.detached.end(), [&](const ForeignDetached& off) {
          return off.name == body.name || (off.name.empty() && off.link == body.link);
        });
    const bool is_replaced = std::any_of(problem.attached.begin(), problem.attached.end(),
                                         [&](const ForeignAttached& own) { return own.name == body.name; });
    if (is_detached || is_replaced) continue;
    if (problem.keeps_attached)
      problem.attached.push_back(body);
    else
      left_out.push_back(problem.name + ": attached body " + quote(body.name) +
                         " of its scene, as its start_state is no diff and has other bodies, or none");
  }
}

}  // namespace

void pair_requests(ForeignSet& set) {
  for (ForeignProblem& problem : set.problems) {
    std::vector<std::size_t> found, beside;  // sets of several folders count from 1 in each
    for (std::size_t i = 0; i < set.worlds.size(); ++i) {
      const std::string digits = digits_of(problem.name);
      if (set.worlds.size() > 1 && (digits.empty() || digits_of(set.worlds[i].name) != digits)) continue;
      found.push_back(i);
      if (set.worlds[i].folder == problem.folder) beside.push_back(i);
    }
    if (beside.size() == 1) found = beside;
    if (found.size() != 1)
      throw std::invalid_argument("request " + quote(problem.name) + ": " + std::to_string(found.size()) +
                                  " scenes have names that end in its number, expected one");
    problem.world = found.front();
    const auto& stands = set.worlds[problem.world].joints;
    problem.start.by_joint.insert(stands.begin(), stands.end());  // of what the request does not say
    take_attached(set.worlds[problem.world].attached, problem, set.left_out);
  }
}

}  // namespace clearway
