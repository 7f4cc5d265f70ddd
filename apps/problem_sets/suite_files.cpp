#include "apps/problem_sets/suite_files.hpp"

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/problem_sets/file_words.hpp"
#include "datasets/yaml/pose_numbers.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/load_json.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<double> numbers(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

/// The robot as the suite names it: a shipped name as it is, a file by its whole path.
std::string robot_name(const SuiteImport& import) {
  const fs::path path = import.robot.robot;
  return path.has_extension() ? fs::weakly_canonical(path).string() : import.robot.robot;
}

/// YAML that people can read: a line for each entry of a list. JSON is YAML.
std::string lines_of(const Json& json) {
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += key + ":";
    if (!value.is_array()) {
      text += " " + value.dump() + "\n";
      continue;
    }
    text += "\n";
    for (const Json& entry : value) text += "  - " + entry.dump() + "\n";
  }
  return text;
}

class SuiteFiles {
 public:
  SuiteFiles(const ForeignSet& set, const SuiteImport& import, ReadySuite& suite)
      : set_(set), import_(import), suite_(suite) {}

  std::size_t write() {
    Json suite = {{"title", "Imported problems"}, {"time_limit", 10}};
    for (const std::string& word : suite_.world_words)
      suite["worlds"].push_back({{"name", word}, {"map", "maps/" + word}});
    suite["planners"] = {{{"planner", "auto"}}, {{"planner", "rrtconnect"}}};
    fs::create_directories(import_.out / "problems");
    FileWords names;
    std::map<ExperimentMotion, std::vector<ReadyProblem*>> experiments;
    for (ReadyProblem& problem : suite_.problems) experiments[problem.motion].push_back(&problem);
    for (const auto& [motion, problems] : experiments) {
      const std::string name = names.of(motion.name);
      suite["experiments"].push_back(experiment(name, motion));
      Json list;
      FileWords problem_names;
      for (ReadyProblem* problem : problems) {
        problem->experiment = name;
        problem->name = problem_names.of(problem->question.name);
        list["problems"].push_back(problem_entry(*problem));
      }
      save_file(import_.out / "problems" / (name + ".yaml"), lines_of(list));
    }
    save_file(import_.out / "suite.yaml", lines_of(suite));
    return experiments.size();
  }

 private:
  Json problem_entry(const ReadyProblem& problem) {
    Json entry = {{"name", problem.name},
                  {"world", suite_.world_words[set_.problems[problem.index].world]},
                  {"start", numbers(problem.question.start)},
                  {"goals", {numbers(problem.choice.q)}}};
    for (const LegLoad& load : problem.question.loads) entry["loads"].push_back(json_of(load.load));
    return entry;
  }

  /// As a load's file has it, a hull of many corners in a file of its own, which loads that are alike share.
  Json json_of(const Load& load) {
    Json json = {{"name", load.name}, {"link", load.link}, {"pose", pose_numbers(load.link_from_load)}};
    if (load.mass > 0.0) json["mass"] = load.mass;
    if (!load.touches.empty()) json["touches"] = load.touches;
    json.update(clearway::json_of(load.shape));
    constexpr std::size_t many_corners = 100;
    if (load.shape.vertices().size() > many_corners) json["hull"] = hull_file(load);
    return json;
  }

  std::string hull_file(const Load& load) {
    std::string text;
    for (const Eigen::Vector3d& corner : load.shape.vertices())
      for (int i = 0; i < 3; ++i) text += Json(corner[i]).dump() + (i < 2 ? ' ' : '\n');
    const auto [known, is_new] = hulls_.try_emplace(text);
    if (is_new) {
      known->second = "hulls/" + hull_names_.of(load.name) + ".txt";
      fs::create_directories(import_.out / "hulls");
      save_file(import_.out / known->second, text);
    }
    return known->second;
  }

  Json experiment(const std::string& name, const ExperimentMotion& motion) {
    Json json = {{"name", name}, {"robot", robot_name(import_)}};
    if (name != motion.name) {
      const std::string title = shortened(motion.name);
      json["title"] = titles_.insert(title).second ? title : title + " (" + name + ")";
    } else {
      titles_.insert(name);
    }
    if (!import_.robot.srdf.empty()) json["srdf"] = fs::weakly_canonical(import_.robot.srdf).string();
    if (!motion.group.empty()) json["group"] = motion.group;
    if (!motion.fixed.empty()) json["fixed"] = motion.fixed;
    for (const auto& [package, folder] : import_.robot.packages)
      json["packages"][package] = fs::weakly_canonical(folder).string();
    for (const auto& [argument, value] : import_.robot.xacro) json["xacro"][argument] = value;
    json["policies"] = {{"default", "not_occupied"}};
    json["padding"] = import_.padding ? Json(*import_.padding) : Json("auto");
    json["problems"] = "problems/" + name + ".yaml";
    return json;
  }

  const ForeignSet& set_;
  const SuiteImport& import_;
  ReadySuite& suite_;
  FileWords hull_names_;
  std::set<std::string> titles_;              ///< of experiments
  std::map<std::string, std::string> hulls_;  ///< their files by their text
};

Json json_of(const ForeignPose& goal) {
  const GoalPose& pose = goal.pose;
  const Eigen::Quaterniond turn(pose.map_from_tip.linear());
  Json json = {{"link", goal.link},
               {"point_m", numbers(goal.point)},
               {"position_m", numbers(pose.map_from_tip.translation())},
               {"orientation_xyzw", {turn.x(), turn.y(), turn.z(), turn.w()}},
               {"position_tolerance_m", pose.position_tolerance},
               {"turn_tolerance_rad", pose.turn_tolerance}};
  if (pose.free_axis) json["free_axis"] = std::string(1, "xyz"[*pose.free_axis]);
  return json;
}

/// Which goal of several was chosen, and what it was before it was values of joints.
void add_goal(const ReadyProblem& problem, Json& json) {
  const ForeignGoal& goal = problem.question.goals[problem.choice.goal];
  if (problem.question.goals.size() > 1)
    json["goal"] = {{"number", problem.choice.goal + 1}, {"of", problem.question.goals.size()}};
  if (goal.pose) json["goal"].update(json_of(*goal.pose));
  if (json.contains("goal")) json["goal"]["free"] = problem.choice.is_free;
}

Json record_of(const ForeignSet& set, const SuiteImport& import, const ReadySuite& suite,
               const std::vector<std::string>& left_out) {
  Json json = {{"resolution_m", import.resolution}, {"robot", robot_name(import)}};
  json["worlds"] = Json::array();
  for (std::size_t i = 0; i < set.worlds.size(); ++i) {
    Json objects = Json::array();
    for (std::size_t k = 0; k < set.worlds[i].solids.size(); ++k) {
      const ForeignSolid& solid = set.worlds[i].solids[k];
      objects.push_back({{"object", solid.object}, {"kind", solid.kind}, {"voxels", suite.cells[i][k]}});
      const auto touched = set.worlds[i].touched.find(solid.object);
      if (touched != set.worlds[i].touched.end()) objects.back()["may_be_touched_by"] = touched->second;
    }
    json["worlds"].push_back(
        {{"name", set.worlds[i].name}, {"map", "maps/" + suite.world_words[i]}, {"objects", objects}});
  }
  json["problems"] = Json::array();
  for (const ForeignProblem& problem : set.problems)
    json["problems"].push_back(
        {{"name", problem.name}, {"world", set.worlds[problem.world].name}, {"group", problem.group}});
  for (const ReadyProblem& problem : suite.problems) {
    Json& entry = json["problems"][problem.index];
    entry["in_suite"] = {{"experiment", problem.experiment}, {"problem", problem.name}};
    add_goal(problem, entry);
  }
  json["left_out"] = left_out;
  return json;
}

}  // namespace

std::size_t write_suite_files(const ForeignSet& set, const SuiteImport& import, ReadySuite& suite) {
  return SuiteFiles(set, import, suite).write();
}

void write_import_record(const ForeignSet& set, const SuiteImport& import, const ReadySuite& suite,
                         const std::vector<std::string>& left_out) {
  save_file(
      import.out / "import.json",
      record_of(set, import, suite, left_out).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace clearway
