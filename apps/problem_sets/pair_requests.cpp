#include <algorithm>
#include <set>
#include <span>
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

/// Bodies in the hand without shapes are the scene's objects of their names; returns these.
std::set<std::string> take_objects(const ForeignWorld& world, ForeignProblem& problem) {
  std::set<std::string> taken;
  for (ForeignAttached& body : problem.attached) {
    if (!body.pieces.empty()) continue;
    for (const ForeignSolid& solid : world.solids)
      if (solid.object == body.name && solid.kind != "octomap" && solid.kind != "plane")
        body.pieces.push_back(solid);
    if (body.pieces.empty()) continue;
    body.frame.clear();
    taken.insert(body.name);
  }
  return taken;
}

/// A world of the set that is the scene without these objects; problems that take the same share it.
std::size_t world_without(const std::set<std::string>& objects, std::size_t scene, ForeignSet& set) {
  ForeignWorld world = set.worlds[scene];
  std::erase_if(world.solids, [&](const ForeignSolid& solid) { return objects.contains(solid.object); });
  world.name += "_without";
  for (const std::string& object : objects) world.name += "_" + object;
  const auto known = std::find_if(set.worlds.begin(), set.worlds.end(), [&](const ForeignWorld& other) {
    return other.name == world.name && other.folder == world.folder;
  });
  if (known != set.worlds.end()) return static_cast<std::size_t>(known - set.worlds.begin());
  set.worlds.push_back(std::move(world));
  return set.worlds.size() - 1;
}

}  // namespace

std::size_t scene_of(const std::filesystem::path& request, std::span<const ForeignWorld> scenes) {
  const std::string name = request.stem().string(), digits = digits_of(name);
  std::vector<std::size_t> found, beside;  // sets of several folders count from 1 in each
  std::string twin = name;  // of MotionBenchMaker's folders, which have scene_sensed0001 as well
  if (const std::size_t at = twin.find("request"); at != std::string::npos) twin.replace(at, 7, "scene");
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (scenes.size() > 1 && (digits.empty() || digits_of(scenes[i].name) != digits)) continue;
    found.push_back(i);
    if (scenes[i].folder == request.parent_path()) beside.push_back(i);
  }
  if (!beside.empty()) found = beside;
  const auto is_twin = [&](std::size_t i) { return scenes[i].name == twin; };
  if (found.size() > 1 && std::count_if(found.begin(), found.end(), is_twin) == 1)
    found = {*std::find_if(found.begin(), found.end(), is_twin)};
  if (found.size() != 1) {
    std::vector<std::string> names;
    for (const std::size_t i : found)
      names.push_back(quote_path((scenes[i].folder / scenes[i].name).string()));
    throw std::invalid_argument("request " + quote(name) + ": " + std::to_string(found.size()) +
                                " scenes have names that end in its number" +
                                (names.empty() ? "" : ", " + listed(names)) + ", expected one");
  }
  return found.front();
}

void take_scene(std::size_t scene, ForeignProblem& problem, ForeignSet& set) {
  const ForeignWorld& world = set.worlds[scene];
  problem.world = scene;
  problem.start.by_joint.insert(world.joints.begin(),
                                world.joints.end());  // of what the request does not say
  take_attached(world.attached, problem, set.left_out);
  const std::set<std::string> taken = take_objects(world, problem);
  if (!taken.empty()) problem.world = world_without(taken, scene, set);
}

}  // namespace clearway
