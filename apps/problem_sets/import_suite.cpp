#include "apps/problem_sets/import_suite.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "apps/problem_sets/attached_loads.hpp"
#include "apps/problem_sets/file_words.hpp"
#include "apps/problem_sets/own_names.hpp"
#include "apps/problem_sets/problem_motion.hpp"
#include "apps/problem_sets/problem_values.hpp"
#include "apps/problem_sets/solid_cells.hpp"
#include "apps/problem_sets/suite_files.hpp"
#include "apps/suites/suite_stages.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

namespace fs = std::filesystem;

class SuiteWriter {
 public:
  SuiteWriter(const ForeignSet& set, const SuiteImport& import)
      : set_(set), import_(import), known_(load_whole_robot(import.robot)) {
    if (!whole_.map_from_base.isApprox(Eigen::Isometry3d::Identity(), 1e-9) || whole_.scale != 1.0)
      throw std::invalid_argument(
          "import: robot " + quote(whole_.name) +
          " is moved or scaled by its settings, expected one of full size whose base is "
          "the sets' origin");
    outcome_.left_out = set.left_out;
    outcome_.notes = robot_notes(whole_, import.robot.packages);
  }

  ImportOutcome write() {
    for (std::size_t i = 0; i < set_.problems.size(); ++i)
      if (auto ready = or_left_out(i, [&] { return ready_problem(i); })) ready_.push_back(std::move(*ready));
    require_some();
    for (const auto& [why, joints] : lost_joints_)
      outcome_.left_out.push_back("start states: " + listed({joints.begin(), joints.end()}) + ", " + why);
    fs::create_directories(import_.out / "maps");
    write_maps();
    require_some();
    if (!ready_.empty()) {
      outcome_.experiments = write_suite_files(set_, import_, suite_);
      outcome_.suite = import_.out / "suite.yaml";
    }
    write_import_record(set_, import_, suite_, outcome_.left_out);
    outcome_.worlds = set_.worlds.size();
    outcome_.problems = ready_.size();
    return std::move(outcome_);
  }

 private:
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

  const Robot& robot_of(const ExperimentMotion& motion) {
    const auto [known, is_new] = robots_.try_emplace({motion.group, motion.fixed});
    if (is_new) {
      RobotRequest request = import_.robot;
      request.group = motion.group;
      request.fixed = motion.fixed;
      known->second = load_robot(request);
    }
    return known->second;
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
      resolve_followers(problem, whole_, goal);
      require_known(problem, goal, whole_);
    });
    ReadyProblem ready{index, motion_of(problem, known_, import_.robot), {}};
    const Robot& robot = robot_of(ready.motion);
    for (const auto& [why, joints] : lost_joints(problem, whole_))
      lost_joints_[why].insert(joints.begin(), joints.end());
    ready.question = {
        problem.name, configuration(ordered_values(robot, problem, problem.start, "start")), {}, {}};
    keep_goals(problem,
               [&](ForeignGoal& goal) { settle_joints(problem, robot, ready.question.start, goal); });
    ready.question.goals = std::move(problem.goals);
    AttachedLoads attached = loads_of(problem.attached, robot, ready.question.start);
    ready.question.loads = std::move(attached.loads);
    for (const std::string& what : attached.left_out) leave(problem, what);
    return ready;
  }

  bool has_problem(std::size_t world) const {
    return std::any_of(ready_.begin(), ready_.end(), [&](const ReadyProblem& problem) {
      return set_.problems[problem.index].world == world;
    });
  }

  /// Objects that links may touch are bodies of a suite's problems, and in no map. Where there is no problem
  /// they are voxels, as all others, and block those links, too.
  Snapshot map_of_world(std::size_t index) {
    ForeignWorld world = set_.worlds[index];
    if (!has_problem(index)) world.touched.clear();
    return map_of_foreign_world(world, import_.resolution, suite_.cells.back());
  }

  void tell_of_touched_objects(std::size_t index) {
    const ForeignWorld& world = set_.worlds[index];
    if (world.touched.empty()) return;
    std::vector<std::string> objects;
    for (const auto& [object, links] : world.touched) objects.push_back(object);
    if (has_problem(index))
      outcome_.notes.push_back(
          "map " + quote(suite_.world_words.back()) + " lacks " + listed(objects) +
          ", which may be touched and so are bodies of the suite's problems: who plans in the "
          "map alone does not see them");
    else
      outcome_.left_out.push_back(world.name + ": which links may touch " + listed(objects) +
                                  " (allowed_collision_matrix): without a problem they block all");
  }

  void write_maps() {
    for (std::size_t i = 0; i < set_.worlds.size(); ++i) {
      suite_.world_words.push_back(words_.of(set_.worlds[i].name));
      suite_.cells.emplace_back();
      Snapshot map = map_of_world(i);
      const std::size_t left_out = std::erase_if(ready_, [&](ReadyProblem& problem) {
        return set_.problems[problem.index].world == i && !is_goal_chosen(problem, map);
      });
      if (left_out > 0 && !has_problem(i)) {
        suite_.cells.back() = {};
        map = map_of_world(i);
      }
      save_map(map, import_.out / "maps" / suite_.world_words.back());
      tell_of_touched_objects(i);
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

  const ForeignSet& set_;
  const SuiteImport& import_;
  WholeRobot known_;
  const Robot& whole_ = known_.robot;
  std::map<std::pair<std::string, std::map<std::string, double>>, Robot> robots_;
  ReadySuite suite_;
  std::vector<ReadyProblem>& ready_ = suite_.problems;
  std::map<std::string, std::set<std::string>> lost_joints_;  ///< of starts, by reason
  std::string refusal_;  ///< the first reason for which a problem was left out
  FileWords words_;      ///< of worlds
  ImportOutcome outcome_;
};

}  // namespace

ImportOutcome write_suite(const ForeignSet& set, const SuiteImport& import) {
  return SuiteWriter(set, import).write();
}

}  // namespace clearway
