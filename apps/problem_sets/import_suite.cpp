#include "apps/problem_sets/import_suite.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/solid_cells.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Letters, digits and ._-= of a name, at most 60; others become _.
std::string file_word(const std::string& name) {
  std::string word;
  for (const char c : name.substr(0, 60)) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          c == '.' || c == '_' || c == '-' || c == '=';
    word += is_plain ? c : '_';
  }
  return word.empty() || word.front() == '.' ? "_" + word : word;
}

/// A word for each name, each once: a second one of the same letters gets a number.
class Words {
 public:
  std::string of(const std::string& name) {
    std::string word = file_word(name);
    for (int number = 2; !taken_.insert(word).second; ++number)
      word = file_word(name) + "-" + std::to_string(number);
    return word;
  }

 private:
  std::set<std::string> taken_;
};

/// What moves in an experiment, and with it where the rest stands.
struct Motion {
  std::string name, group;
  std::map<std::string, double> fixed;
  bool operator<(const Motion& other) const {
    return std::tie(name, group, fixed) < std::tie(other.name, other.group, other.fixed);
  }
};

struct ReadyProblem {
  std::string name;
  std::size_t world = 0;
  std::vector<double> start, goal;
};

class SuiteWriter {
 public:
  SuiteWriter(const ForeignSet& set, const SuiteImport& import)
      : set_(set), import_(import), whole_(load_robot(without_motion(import.robot))) {
    if (!whole_.map_from_base.isApprox(Eigen::Isometry3d::Identity(), 1e-9) || whole_.scale != 1.0)
      throw std::invalid_argument(
          "import: robot " + quote(whole_.name) +
          " is moved or scaled by its settings, expected one of full size whose base is "
          "the sets' origin");
    outcome_.left_out = set.left_out;
    if (!whole_.srdf.empty()) srdf_ = read_srdf(whole_.srdf);
  }

  ImportOutcome write() {
    std::string refusal;  // the first
    for (const ForeignProblem& problem : set_.problems) {
      try {
        add(problem);
      } catch (const std::invalid_argument& error) {
        const std::string why = error.what();
        if (refusal.empty()) refusal = why;
        outcome_.left_out.push_back(why.starts_with("problem ") ? why : problem.name + ": " + why);
      }
    }
    if (outcome_.problems == 0 && !set_.problems.empty())
      throw std::invalid_argument(
          refusal.empty() ? "import: no request has a goal of joint values, expected at least one"
                          : "import: no problem is for robot " + quote(whole_.name) + ": " + refusal);
    fs::create_directories(import_.out / "maps");
    write_maps();
    if (!experiments_.empty()) write_files();
    save_file(import_.out / "import.json",
              record().dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    outcome_.worlds = set_.worlds.size();
    outcome_.experiments = experiments_.size();
    return std::move(outcome_);
  }

 private:
  static RobotRequest without_motion(RobotRequest request) {
    request.group.clear();
    request.fixed.clear();
    return request;
  }

  void leave(const ForeignProblem& problem, const std::string& why) {
    outcome_.left_out.push_back(problem.name + ": " + why);
  }

  /// The group that the user names; else the problem's, where the robot's SRDF has it; else the joints that
  /// the goal names move.
  Motion motion_of(const ForeignProblem& problem) const {
    Motion motion{problem.experiment.empty() ? problem.group : problem.experiment, import_.robot.group,
                  import_.robot.fixed};
    if (motion.name.empty()) motion.name = "problems";
    if (problem.goal.by_joint.empty()) return motion;  // values in the robot's order
    for (const auto& [joint, value] : problem.goal.by_joint) require_joint(problem, joint);
    if (motion.group.empty() && srdf_ && srdf_->groups.contains(problem.group)) motion.group = problem.group;
    std::set<std::string> planned;
    if (!motion.group.empty() && srdf_) {
      planned = joints_of_group(whole_, *srdf_, motion.group, whole_.srdf);
    } else {
      for (const auto& [joint, value] : problem.goal.by_joint) planned.insert(joint);
    }
    for (const Joint& joint : whole_.joints) {
      const auto start = problem.start.by_joint.find(joint.name);
      if (planned.contains(joint.name) || motion.fixed.contains(joint.name)) continue;
      if (start != problem.start.by_joint.end())
        motion.fixed[joint.name] = near_limits(joint, start->second);
      else if (motion.group.empty())
        motion.fixed[joint.name] = std::clamp(0.0, joint.lower, joint.upper);
    }
    return motion;
  }

  /// Foreign files round: what is a thousandth beyond a limit stands at it.
  static double near_limits(const Joint& joint, double value) {
    const double nearest = std::clamp(value, joint.lower, joint.upper);
    return std::abs(nearest - value) <= 1e-3 ? nearest : value;
  }

  void require_joint(const ForeignProblem& problem, const std::string& name) const {
    std::vector<std::string> names;
    for (const Joint& joint : whole_.joints) names.push_back(joint.name);
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    throw std::invalid_argument("problem " + quote(problem.name) + ": its goal names joint " + quote(name) +
                                ", which robot " + quote(whole_.name) + " does not have, did you mean " +
                                quote(nearest_name(name.substr(0, 100), names)) + "?");
  }

  const Robot& robot_of(const Motion& motion) {
    const auto [known, is_new] = robots_.try_emplace({motion.group, motion.fixed});
    if (is_new) {
      RobotRequest request = import_.robot;
      request.group = motion.group;
      request.fixed = motion.fixed;
      known->second = load_robot(request);
    }
    return known->second;
  }

  /// In the robot's order; a joint that is left out of a start stands at 0.
  std::vector<double> values(const Robot& robot, const ForeignProblem& problem, const ForeignState& state,
                             const char* what) const {
    if (!state.values.empty() || state.by_joint.empty()) {
      if (state.values.size() == robot.dof()) return state.values;
      throw std::invalid_argument("problem " + quote(problem.name) + ", " + what + ": got " +
                                  std::to_string(state.values.size()) + " values, expected " +
                                  std::to_string(robot.dof()) + ", one for each joint of robot " +
                                  quote(robot.name) + " (--group and --fix choose which)");
    }
    std::vector<double> result;
    for (const Joint& joint : robot.joints) {
      const auto value = state.by_joint.find(joint.name);
      if (value == state.by_joint.end())
        throw std::invalid_argument("problem " + quote(problem.name) + ", " + what +
                                    ": expected a value of joint " + quote(joint.name) + " of robot " +
                                    quote(robot.name));
      result.push_back(near_limits(joint, value->second));
    }
    return result;
  }

  /// The robot's joint of that name, or its only one of which the name is the longer form with a prefix, as
  /// panda_joint1 is of joint1.
  std::string own_name(const std::string& name) const {
    std::string found = name;
    int longer = 0;
    for (const Joint& joint : whole_.joints) {
      if (joint.name == name) return name;
      if (!name.ends_with("_" + joint.name)) continue;
      found = joint.name;
      ++longer;
    }
    return longer == 1 ? found : name;
  }

  ForeignState with_own_names(const ForeignState& state) const {
    ForeignState own{{}, state.values};
    for (const auto& [joint, value] : state.by_joint)
      if (!own.by_joint.emplace(own_name(joint), value).second)
        throw std::invalid_argument("joint " + quote(joint) + " and another one both stand for joint " +
                                    quote(own_name(joint)) + " of robot " + quote(whole_.name) +
                                    ", expected one name for each");
    return own;
  }

  void add(const ForeignProblem& given) {
    ForeignProblem problem = given;
    problem.start = with_own_names(given.start);
    problem.goal = with_own_names(given.goal);
    if (problem.goal.by_joint.empty() && problem.goal.values.empty())
      return leave(problem, "it has no goal of joint values");
    const Motion motion = motion_of(problem);
    const Robot& robot = robot_of(motion);
    ReadyProblem ready{problem.name, problem.world, values(robot, problem, problem.start, "start"),
                       values(robot, problem, problem.goal, "goal")};
    experiments_[motion].push_back(std::move(ready));
    ++outcome_.problems;
  }

  void write_maps() {
    for (const ForeignWorld& world : set_.worlds) {
      world_words_.push_back(words_.of(world.name));
      cells_.emplace_back();
      const Snapshot map = map_of_foreign_world(world, import_.resolution, cells_.back());
      save_map(map, import_.out / "maps" / world_words_.back());
    }
  }

  /// The robot as the suite names it: a shipped name as it is, a file by its whole path.
  std::string robot_name() const {
    const fs::path path = import_.robot.robot;
    return path.has_extension() ? fs::weakly_canonical(path).string() : import_.robot.robot;
  }

  void write_files() {
    Json suite = {{"title", "Imported problems"}, {"time_limit", 10}};
    for (const std::string& word : world_words_)
      suite["worlds"].push_back({{"name", word}, {"map", "maps/" + word}});
    suite["planners"] = Json::array({{{"planner", "rrtconnect"}}});
    fs::create_directories(import_.out / "problems");
    Words names;
    for (const auto& [motion, problems] : experiments_) {
      const std::string name = names.of(motion.name);
      suite["experiments"].push_back(experiment(name, motion));
      Json list;
      Words problem_names;
      for (const ReadyProblem& problem : problems)
        list["problems"].push_back({{"name", problem_names.of(problem.name)},
                                    {"world", world_words_[problem.world]},
                                    {"start", problem.start},
                                    {"goals", {problem.goal}}});
      save_file(import_.out / "problems" / (name + ".yaml"), lines_of(list));
    }
    outcome_.suite = import_.out / "suite.yaml";
    save_file(outcome_.suite, lines_of(suite));
  }

  Json experiment(const std::string& name, const Motion& motion) const {
    Json json = {{"name", name}, {"robot", robot_name()}};
    if (!import_.robot.srdf.empty()) json["srdf"] = fs::weakly_canonical(import_.robot.srdf).string();
    if (!motion.group.empty()) json["group"] = motion.group;
    if (!motion.fixed.empty()) json["fixed"] = motion.fixed;
    for (const auto& [package, folder] : import_.robot.packages)
      json["packages"][package] = fs::weakly_canonical(folder).string();
    for (const auto& [argument, value] : import_.robot.xacro) json["xacro"][argument] = value;
    json["policies"] = {{"default", "not_occupied"}};
    json["padding"] = 0;
    json["problems"] = "problems/" + name + ".yaml";
    return json;
  }

  /// YAML that people can read: a line for each entry of a list. JSON is YAML.
  static std::string lines_of(const Json& json) {
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

  Json record() const {
    Json json = {{"resolution_m", import_.resolution}, {"robot", robot_name()}};
    json["worlds"] = Json::array();
    for (std::size_t i = 0; i < set_.worlds.size(); ++i) {
      Json objects = Json::array();
      for (std::size_t k = 0; k < set_.worlds[i].solids.size(); ++k) {
        const ForeignSolid& solid = set_.worlds[i].solids[k];
        objects.push_back({{"object", solid.object}, {"kind", solid.kind}, {"voxels", cells_[i][k]}});
      }
      json["worlds"].push_back(
          {{"name", set_.worlds[i].name}, {"map", "maps/" + world_words_[i]}, {"objects", objects}});
    }
    json["problems"] = Json::array();
    for (const ForeignProblem& problem : set_.problems)
      json["problems"].push_back(
          {{"name", problem.name}, {"world", set_.worlds[problem.world].name}, {"group", problem.group}});
    json["left_out"] = outcome_.left_out;
    return json;
  }

  const ForeignSet& set_;
  const SuiteImport& import_;
  Robot whole_;
  std::optional<Srdf> srdf_;
  std::map<std::pair<std::string, std::map<std::string, double>>, Robot> robots_;
  std::map<Motion, std::vector<ReadyProblem>> experiments_;
  Words words_;
  std::vector<std::string> world_words_;
  std::vector<std::vector<std::size_t>> cells_;
  ImportOutcome outcome_;
};

/// The digits at the end of a name.
std::string digits_of(const std::string& name) {
  const std::size_t last = name.find_last_not_of("0123456789");
  return last == std::string::npos ? name : name.substr(last + 1);
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
  }
}

ImportOutcome write_suite(const ForeignSet& set, const SuiteImport& import) {
  return SuiteWriter(set, import).write();
}

}  // namespace clearway
