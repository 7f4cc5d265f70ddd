#include "apps/problem_sets/import_suite.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/attached_loads.hpp"
#include "apps/problem_sets/file_words.hpp"
#include "apps/problem_sets/goal_choice.hpp"
#include "apps/problem_sets/goal_joints.hpp"
#include "apps/problem_sets/own_names.hpp"
#include "apps/problem_sets/solid_cells.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/load_json.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What moves in an experiment, and with it where the rest stands.
struct Motion {
  std::string name, group;
  std::map<std::string, double> fixed;
  bool operator<(const Motion& other) const {
    return std::tie(name, group, fixed) < std::tie(other.name, other.group, other.fixed);
  }
};

/// A problem whose robot is known; its goal is chosen when its map is there.
struct ReadyProblem {
  std::size_t index = 0;  ///< in the set
  Motion motion;
  GoalQuestion question;
  GoalChoice choice{};
  std::string experiment{}, name{};  ///< in the suite
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
    outcome_.notes = robot_notes(whole_, import.robot.packages);
    if (!whole_.srdf.empty()) srdf_ = read_srdf(whole_.srdf);
  }

  ImportOutcome write() {
    for (std::size_t i = 0; i < set_.problems.size(); ++i)
      if (auto ready = or_left_out(i, [&] { return ready_problem(i); })) ready_.push_back(std::move(*ready));
    require_some();
    fs::create_directories(import_.out / "maps");
    write_maps();
    require_some();
    if (!ready_.empty()) write_files();
    save_file(import_.out / "import.json",
              record().dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
    outcome_.worlds = set_.worlds.size();
    outcome_.problems = ready_.size();
    return std::move(outcome_);
  }

 private:
  static RobotRequest without_motion(RobotRequest request) {
    request.group.clear();
    request.fixed.clear();
    request.fixed_states.clear();
    return request;
  }

  void leave(const ForeignProblem& problem, const std::string& why) {
    outcome_.left_out.push_back(problem.name + ": " + why);
  }

  /// What `work` makes of a problem; nothing where it throws, and then the reason is reported.
  template <typename Work>
  auto or_left_out(std::size_t problem, const Work& work) -> decltype(work()) {
    try {
      return work();
    } catch (const std::invalid_argument& error) {
      const std::string why = error.what();
      if (refusal_.empty()) refusal_ = why;
      outcome_.left_out.push_back(why.starts_with("problem ") ? why
                                                              : set_.problems[problem].name + ": " + why);
      return {};
    }
  }

  void require_some() const {
    if (!ready_.empty()) return;
    if (set_.problems.empty()) {
      if (!set_.worlds.empty()) return;  // scenes without requests
      throw std::invalid_argument(set_.left_out.empty()
                                      ? "import: the files hold no problem, expected at least one"
                                      : "import: all problems are left out (" + set_.left_out.back() + ")");
    }
    throw std::invalid_argument(
        refusal_.empty() ? "import: no request has a goal of joint values or of a pose" + goal_left_out() +
                               ", expected at least one"
                         : "import: no problem fits robot " + quote(whole_.name) + ": " + refusal_);
  }

  /// In brackets, the first goal that a file's reader could not use.
  std::string goal_left_out() const {
    for (const std::string& what : set_.left_out)
      if (what.find(": a goal ") != std::string::npos) return " (" + what + ")";
    return "";
  }

  /// The first goal; where its values are not of all joints, one that says by its link of which they are.
  const ForeignGoal& goal_of_motion(const ForeignProblem& problem) const {
    const ForeignGoal& first = problem.goals.front();
    if (first.joints.values.empty() || first.joints.values.size() == whole_.dof()) return first;
    const auto placing =
        std::find_if(problem.goals.begin(), problem.goals.end(), [&](const ForeignGoal& goal) {
          return goal.pose && joints_above(whole_, goal.pose->link).size() == first.joints.values.size();
        });
    return placing != problem.goals.end() ? *placing : first;
  }

  /// The group that the user names; else the problem's, where the robot's SRDF has it; else the joints that
  /// the first goal names, or that move the link that it places.
  Motion motion_of(const ForeignProblem& problem) const {
    Motion motion{problem.experiment.empty() ? problem.group : problem.experiment, import_.robot.group,
                  import_.robot.fixed};
    if (motion.name.empty()) motion.name = "problems";
    const ForeignGoal& goal = goal_of_motion(problem);
    if (!goal.joints.values.empty()) return motion;  // in the robot's order
    if (motion.group.empty() && srdf_ && srdf_->groups.contains(problem.group)) motion.group = problem.group;
    std::set<std::string> planned;
    if (!motion.group.empty() && srdf_) {
      planned = joints_of_group(whole_, *srdf_, motion.group, whole_.srdf);
    } else {
      for (const auto& [joint, value] : goal.joints.by_joint) planned.insert(joint);
      if (goal.pose)
        for (const std::string& joint : joints_above(whole_, goal.pose->link)) planned.insert(joint);
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

  /// Joint values within limits, and nothing asked of a pose or of what stands still that they do not keep.
  void settle(const ForeignProblem& problem, const Robot& robot, ForeignGoal& goal) const {
    if (!goal.has_joints()) return;
    try {
      goal.joints.by_joint = allowed_values(goal, robot);
      require_held_as_asked(goal, robot);
      if (goal.pose) {
        const bool has_all = std::all_of(robot.joints.begin(), robot.joints.end(), [&](const Joint& joint) {
          return goal.joints.by_joint.contains(joint.name);
        });
        require_pose_as_asked(
            goal, robot,
            has_all ? configuration(values(robot, problem, goal.joints, "goal")) : Configuration());
      }
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("problem " + quote(problem.name) + ": " + error.what());
    }
    goal.joints.values = values(robot, problem, goal.joints, "goal");
    goal.pose.reset();
  }

  /// Foreign files round: what is a thousandth beyond a limit stands at it.
  static double near_limits(const Joint& joint, double value) {
    const double nearest = std::clamp(value, joint.lower, joint.upper);
    return std::abs(nearest - value) <= 1e-3 ? nearest : value;
  }

  /// Throws for a goal of a joint or link that the robot does not have.
  void require_known(const ForeignProblem& problem, const ForeignGoal& goal) const {
    std::vector<std::string> joints, links;
    for (const Joint& joint : whole_.joints) joints.push_back(joint.name);
    for (const Link& link : whole_.links) links.push_back(link.name);
    const auto require = [&](const std::string& name, const std::vector<std::string>& known,
                             const char* what) {
      if (std::find(known.begin(), known.end(), name) != known.end()) return;
      throw std::invalid_argument("problem " + quote(problem.name) + ": its goal names " + what + " " +
                                  quote(name) + ", which robot " + quote(whole_.name) +
                                  " does not have, did you mean " +
                                  quote(nearest_name(name.substr(0, 100), known)) + "?");
    };
    for (const auto& [joint, value] : goal.joints.by_joint) require(joint, joints, "joint");
    if (goal.pose) require(goal.pose->link, links, "link");
  }

  /// Takes out of a goal the joints that mimic others (a gripper's second finger): they agree with these, or
  /// say where these are. @throws std::invalid_argument when they do not agree
  void resolve_followers(const ForeignProblem& problem, ForeignGoal& goal) const {
    auto& values = goal.joints.by_joint;
    for (const Link& link : whole_.links) {
      if (link.joint < 0 || link.multiplier == 0.0) continue;
      const std::string& master = whole_.joints[static_cast<std::size_t>(link.joint)].name;
      const auto found = values.find(link.joint_name);
      if (link.joint_name == master || found == values.end()) continue;
      const double value = found->second;
      values.erase(found);
      const double at = values.try_emplace(master, (value - link.offset) / link.multiplier).first->second;
      const double follows = link.multiplier * at + link.offset;
      if (std::abs(follows - value) <= 1e-3) continue;
      throw std::invalid_argument("problem " + quote(problem.name) + ": its goal has joint " +
                                  quote(link.joint_name) + " at " + short_text(value) + ", which follows " +
                                  quote(master) + " and stands at " + short_text(follows));
    }
  }

  /// Leaves out the goals for which `work` throws, as any of the others counts; throws when none is left.
  template <typename Work>
  void keep_goals(ForeignProblem& problem, const Work& work) {
    std::vector<std::string> refusals;
    std::erase_if(problem.goals, [&](ForeignGoal& goal) {
      try {
        work(goal);
        return false;
      } catch (const std::invalid_argument& error) {
        refusals.emplace_back(error.what());
        return true;
      }
    });
    if (problem.goals.empty()) throw std::invalid_argument(refusals.front());
    outcome_.left_out.insert(outcome_.left_out.end(), refusals.begin(), refusals.end());
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

  std::optional<ReadyProblem> ready_problem(std::size_t index) {
    ForeignProblem problem = with_names_of(whole_, set_.problems[index]);
    const auto standing = standing_bodies(set_.worlds[problem.world], whole_.links.front().name);
    problem.attached.insert(problem.attached.end(), standing.begin(), standing.end());
    if (problem.goals.empty()) {
      leave(problem, "it has no goal of joint values or of a pose");
      return std::nullopt;
    }
    keep_goals(problem, [&](ForeignGoal& goal) {
      resolve_followers(problem, goal);
      require_known(problem, goal);
    });
    ReadyProblem ready{index, motion_of(problem), {}};
    const Robot& robot = robot_of(ready.motion);
    ready.question = {problem.name, configuration(values(robot, problem, problem.start, "start")), {}, {}};
    keep_goals(problem, [&](ForeignGoal& goal) { settle(problem, robot, goal); });
    ready.question.goals = std::move(problem.goals);
    AttachedLoads attached = loads_of(problem.attached, robot, ready.question.start);
    ready.question.loads = std::move(attached.loads);
    for (const std::string& what : attached.left_out) leave(problem, what);
    return ready;
  }

  void write_maps() {
    for (std::size_t i = 0; i < set_.worlds.size(); ++i) {
      world_words_.push_back(words_.of(set_.worlds[i].name));
      cells_.emplace_back();
      const Snapshot map = map_of_foreign_world(set_.worlds[i], import_.resolution, cells_.back());
      save_map(map, import_.out / "maps" / world_words_.back());
      std::erase_if(ready_, [&](ReadyProblem& problem) {
        return set_.problems[problem.index].world == i && !is_goal_chosen(problem, map);
      });
    }
  }

  /// A single goal of joint values is the goal, be it free or not; of several, or of a pose, the map says.
  bool is_goal_chosen(ReadyProblem& problem, const Snapshot& map) {
    const std::vector<ForeignGoal>& goals = problem.question.goals;
    if (goals.size() == 1 && !goals.front().pose) {
      problem.choice.q = configuration(goals.front().joints.values);
      return true;
    }
    const auto choice = or_left_out(problem.index, [&] {
      const Robot robot = robot_of(problem.motion);
      return std::optional(
          choose_goal(problem.question, robot, map, import_.padding.value_or(robot.position_accuracy)));
    });
    if (choice) problem.choice = *choice;
    outcome_.poses += choice && goals[choice->goal].pose;
    return choice.has_value();
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
    FileWords names;
    std::map<Motion, std::vector<ReadyProblem*>> experiments;
    for (ReadyProblem& problem : ready_) experiments[problem.motion].push_back(&problem);
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
    outcome_.experiments = experiments.size();
    outcome_.suite = import_.out / "suite.yaml";
    save_file(outcome_.suite, lines_of(suite));
  }

  Json problem_entry(const ReadyProblem& problem) {
    Json entry = {{"name", problem.name},
                  {"world", world_words_[set_.problems[problem.index].world]},
                  {"start", numbers(problem.question.start)},
                  {"goals", {numbers(problem.choice.q)}}};
    for (const LegLoad& load : problem.question.loads) entry["loads"].push_back(json_of(load.load));
    return entry;
  }

  static std::vector<double> numbers(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

  /// As a load's file has it, a hull of many corners in a file of its own, which loads that are alike share.
  Json json_of(const Load& load) {
    const Eigen::Vector3d yaw_pitch_roll = load.link_from_load.linear().eulerAngles(2, 1, 0);
    std::vector<double> pose = numbers(load.link_from_load.translation());
    for (const int i : {2, 1, 0}) pose.push_back(yaw_pitch_roll[i]);
    Json json = {{"name", load.name}, {"link", load.link}, {"pose", pose}};
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

  Json experiment(const std::string& name, const Motion& motion) {
    Json json = {{"name", name}, {"robot", robot_name()}};
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
        const auto touched = set_.worlds[i].touched.find(solid.object);
        if (touched != set_.worlds[i].touched.end()) objects.back()["may_be_touched_by"] = touched->second;
      }
      json["worlds"].push_back(
          {{"name", set_.worlds[i].name}, {"map", "maps/" + world_words_[i]}, {"objects", objects}});
    }
    json["problems"] = Json::array();
    for (const ForeignProblem& problem : set_.problems)
      json["problems"].push_back(
          {{"name", problem.name}, {"world", set_.worlds[problem.world].name}, {"group", problem.group}});
    for (const ReadyProblem& problem : ready_) {
      Json& entry = json["problems"][problem.index];
      entry["in_suite"] = {{"experiment", problem.experiment}, {"problem", problem.name}};
      add_goal(problem, entry);
    }
    json["left_out"] = outcome_.left_out;
    return json;
  }

  /// Which goal of several was chosen, and what it was before it was values of joints.
  static void add_goal(const ReadyProblem& problem, Json& json) {
    const ForeignGoal& goal = problem.question.goals[problem.choice.goal];
    if (problem.question.goals.size() > 1)
      json["goal"] = {{"number", problem.choice.goal + 1}, {"of", problem.question.goals.size()}};
    if (goal.pose) json["goal"].update(json_of(*goal.pose));
    if (json.contains("goal")) json["goal"]["free"] = problem.choice.is_free;
  }

  static Json json_of(const ForeignPose& goal) {
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

  const ForeignSet& set_;
  const SuiteImport& import_;
  Robot whole_;
  std::optional<Srdf> srdf_;
  std::map<std::pair<std::string, std::map<std::string, double>>, Robot> robots_;
  std::vector<ReadyProblem> ready_;
  std::string refusal_;  ///< the first reason for which a problem was left out
  FileWords words_, hull_names_;
  std::set<std::string> titles_;              ///< of experiments
  std::map<std::string, std::string> hulls_;  ///< their files by their text
  std::vector<std::string> world_words_;
  std::vector<std::vector<std::size_t>> cells_;
  ImportOutcome outcome_;
};

}  // namespace

ImportOutcome write_suite(const ForeignSet& set, const SuiteImport& import) {
  return SuiteWriter(set, import).write();
}

}  // namespace clearway
