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

std::size_t scene_of(const std::filesystem::path& request, const std::vector<ForeignWorld>& scenes) {
  const std::string name = request.stem().string(), digits = digits_of(name);
  std::vector<std::size_t> found, beside;  // sets of several folders count from 1 in each
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (scenes.size() > 1 && (digits.empty() || digits_of(scenes[i].name) != digits)) continue;
    found.push_back(i);
    if (scenes[i].folder == request.parent_path()) beside.push_back(i);
  }
  if (beside.size() == 1) found = beside;
  if (found.size() != 1)
    throw std::invalid_argument("request " + quote(name) + ": " + std::to_string(found.size()) +
                                " scenes have names that end in its number, expected one");
  return found.front();
}

void take_scene(const ForeignWorld& scene, ForeignProblem& problem, std::vector<std::string>& left_out) {
  problem.start.by_joint.insert(scene.joints.begin(),
                                scene.joints.end());  // of what the request does not say
  take_attached(scene.attached, problem, left_out);
}

}  // namespace clearway
