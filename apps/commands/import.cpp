#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <stdexcept>

#include "apps/console/flags.hpp"
#include "apps/console/table.hpp"
#include "apps/problem_sets/file_words.hpp"
#include "apps/problem_sets/import_suite.hpp"
#include "apps/problem_sets/planning_scene.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/atomic_folder.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/robot/reach.hpp"
#include "planning/robot_files/srdf_file.hpp"

namespace clearway {
namespace {

constexpr std::size_t largest_json = 256U << 20U, largest_scene = 64U << 20U;

/// The whole of a file that is no Python pickle.
std::string read_text(const std::filesystem::path& file, const char* what, std::size_t largest) {
  std::string text = read_input(file, what, largest);
  const std::string kind = extension_of(file);
  const bool begins_as_one = text.size() > 1 && text[0] == '\x80' && text[1] >= 2 && text[1] <= 5;
  if (begins_as_one || kind == ".pkl" || kind == ".pickle")
    throw std::invalid_argument(std::string(what) + " " + quote_path(file.string()) +
                                ": a Python pickle, which is a program and is not run here, expected YAML or "
                                "JSON: where you trust it, "
                                "pickle.load it in Python and json.dump plain lists and dictionaries");
  return text;
}

template <typename Read>
ForeignSet read_sets(const ImportOptions& options, const Read& read) {
  ForeignSet all;
  for (const std::filesystem::path& file : options.files) {
    ForeignSet set = read(read_text(file, "problem set", largest_json), file);
    for (ForeignProblem& problem : set.problems) {
      problem.world += all.worlds.size();
      all.problems.push_back(std::move(problem));
    }
    std::move(set.worlds.begin(), set.worlds.end(), std::back_inserter(all.worlds));
    all.left_out.insert(all.left_out.end(), set.left_out.begin(), set.left_out.end());
  }
  return all;
}

SceneContext scene_context(const ImportOptions& options, const RobotRequest& request) {
  Robot robot =
      load_robot(RobotRequest{request.robot, request.srdf, "", {}, request.packages, request.xacro});
  SceneContext context{std::move(robot), {}, request.packages, options.leave_out_unknown_frames};
  context.plane_reach = std::max(context.plane_reach, 1.5 * tip_reach(context.robot));
  if (!context.robot.srdf.empty()) context.planning_frames = read_srdf(context.robot.srdf).outer_frames;
  return context;
}

ForeignSet read_robometrics_sets(const ImportOptions& options, const RobotRequest& request) {
  const SceneContext context = scene_context(options, request);
  return read_sets(options, [&](const std::string& text, const std::filesystem::path& file) {
    return read_robometrics(text, file, context);
  });
}

/// Each folder's own word where files are of several folders, as MotionBenchMaker has one a set; else none.
class FolderWords {
 public:
  void add(const std::filesystem::path& file) {
    const std::filesystem::path folder = file.parent_path();
    if (words_.contains(folder)) return;
    words_[folder] = names_.of(std::filesystem::weakly_canonical(folder.empty() ? "." : folder).filename());
  }
  std::string of(const std::filesystem::path& folder) const {
    return words_.size() > 1 ? words_.at(folder) : "";
  }

 private:
  FileWords names_;
  std::map<std::filesystem::path, std::string> words_;
};

/// Scenes, as YAML or as MoveIt's text, and then requests, each in the frames of its scene. One that cannot
/// be read is left out: a scene with its requests.
class SceneSet {
 public:
  SceneSet(const ImportOptions& options, const RobotRequest& request)
      : context_(scene_context(options, request)) {
    for (const std::filesystem::path& file : options.files) add_file(file);
    if (faults_.size() == set_.worlds.size()) refuse();
    scenes_ = set_.worlds.size();  // others come behind them
    for (const auto& [file, text] : requests_) add_request(file, text);
    if (!requests_.empty() && set_.problems.empty() && !first_fault_.empty()) refuse();
  }

  ForeignSet set() {
    for (ForeignWorld& world : set_.worlds)
      if (const std::string word = of_scenes_.of(world.folder); !word.empty())
        world.name = word + "/" + world.name;
    remove_unread();
    return std::move(set_);
  }

 private:
  [[noreturn]] void refuse() const {
    if (!first_fault_.empty()) throw std::invalid_argument(first_fault_);
    const std::string why = set_.left_out.empty() ? "" : " (" + plain(set_.left_out.front()) + ")";
    throw std::invalid_argument("import: no file is a scene, expected at least one" + why);
  }

  void add_file(const std::filesystem::path& file) {
    std::string text = read_text(file, "scene or request", largest_scene);
    const bool is_text = extension_of(file) == ".scene";
    SceneFileKind kind = SceneFileKind::scene;
    if (!is_text && !try_to(file, [&] { kind = kind_of_scene_file(text, file); })) {
      if (file.stem().string().find("request") == std::string::npos) add_unread(file);
      return;
    }
    if (kind == SceneFileKind::request) {
      requests_.emplace_back(file, std::move(text));
      of_requests_.add(file);
    }
    if (kind == SceneFileKind::neither)
      set_.left_out.push_back(file.filename().string() +
                              ": neither a scene with 'world' nor a request with 'goal_constraints'");
    if (kind != SceneFileKind::scene) return;
    of_scenes_.add(file);
    const bool is_read = try_to(file, [&] {
      set_.worlds.push_back(is_text ? read_scene_text(text, file, context_)
                                    : read_planning_scene(text, file, context_, set_.left_out));
    });
    if (!is_read) return add_unread(file);
    set_.worlds.back().folder = file.parent_path();
  }

  /// A scene that is left out keeps its place, so that no other one takes its requests.
  void add_unread(const std::filesystem::path& file) {
    of_scenes_.add(file);
    faults_.insert(set_.worlds.size());
    set_.worlds.push_back({file.stem().string(), {}});
    set_.worlds.back().folder = file.parent_path();
  }

  void add_request(const std::filesystem::path& file, const std::string& text) {
    try_to(file, [&] {
      const std::size_t scene = scene_of(file, {set_.worlds.data(), scenes_});
      if (faults_.contains(scene)) {
        set_.left_out.push_back(file.filename().string() + ": its scene was left out");
        return;
      }
      ForeignProblem problem = read_motion_request(text, file, context_, set_.worlds[scene], set_.left_out);
      problem.experiment = of_requests_.of(file.parent_path());
      take_scene(scene, problem, set_);
      set_.problems.push_back(std::move(problem));
    });
  }

  /// Whether `read` came to its end; else the file is left out.
  bool try_to(const std::filesystem::path& file, const std::function<void()>& read) {
    const std::size_t left_out = set_.left_out.size();
    try {
      read();
      return true;
    } catch (const std::invalid_argument& fault) {
      set_.left_out.resize(left_out);
      set_.left_out.push_back(file.filename().string() + ": " + fault.what());
      if (first_fault_.empty()) first_fault_ = fault.what();
      return false;
    }
  }

  void remove_unread() {
    for (auto scene = faults_.rbegin(); scene != faults_.rend(); ++scene) {
      set_.worlds.erase(set_.worlds.begin() + static_cast<std::ptrdiff_t>(*scene));
      for (ForeignProblem& problem : set_.problems) problem.world -= problem.world > *scene;
    }
  }

  SceneContext context_;
  ForeignSet set_;
  FolderWords of_scenes_, of_requests_;
  std::vector<std::pair<std::filesystem::path, std::string>> requests_;
  std::set<std::size_t> faults_;  ///< indices of the scenes that were left out
  std::string first_fault_;
  std::size_t scenes_ = 0;
};

void report(const ImportOptions& options, const ImportOutcome& outcome, Console& console) {
  if (console.json) {
    const nlohmann::ordered_json json = {
        {"worlds", outcome.worlds}, {"problems", outcome.problems},    {"experiments", outcome.experiments},
        {"poses", outcome.poses},   {"suite", outcome.suite.string()}, {"left_out", outcome.left_out}};
    console.out() << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    return;
  }
  const std::string note =
      outcome.poses == 0 ? "" : ", " + std::to_string(outcome.poses) + " of them to a pose, as joint values";
  print_rows(console.out(), {{"worlds", std::to_string(outcome.worlds)},
                             {"problems", std::to_string(outcome.problems) + note},
                             {"left out", std::to_string(outcome.left_out.size())}});
  for (const std::string& what : outcome.left_out) console.out() << "    " << plain(what) << '\n';
  console.out() << "  " << (outcome.suite.empty() ? (options.out / "maps").string() : outcome.suite.string())
                << '\n';
}

}  // namespace

int run_import(const ImportOptions& options, Console& console) {
  for (const char* name : {"import.json", "suite.yaml", "maps", "problems", "hulls"})
    if (std::filesystem::exists(options.out / name))
      throw std::invalid_argument("--out: " + quote_path(options.out.string()) +
                                  " holds an import already, or what has its names, such as " + quote(name) +
                                  ", expected a new folder");
  // Refuses before the work what cannot be written; of what is there nothing is ours.
  AtomicFolder folder(options.out, [](const std::filesystem::path&) { return false; });
  const RobotRequest request = robot_request(options.robot);
  const ForeignSet set = options.kind == "json"          ? read_sets(options, read_problem_json)
                         : options.kind == "robometrics" ? read_robometrics_sets(options, request)
                                                         : SceneSet(options, request).set();
  ImportOutcome outcome =
      write_suite(set, {request, options.resolution, folder.path(), options.robot.padding});
  if (!outcome.suite.empty()) outcome.suite = options.out / outcome.suite.filename();
  folder.publish();
  for (const std::string& note : outcome.notes) console.warn("note: " + note);
  report(options, outcome, console);
  if (outcome.suite.empty())
    console.warn(options.kind == "robometrics"
                     ? "clearway: import: no file has problems, so there are maps and no suite"
                     : "clearway: import: no file is a request, so there are maps and no suite");
  return exit_done;
}

Command add_import(CLI::App& app, Console& console) {
  auto options = std::make_shared<ImportOptions>();
  options->robot.padding = 0.0;  // as other planners have it
  CLI::App* command = add_command(
      app, "import",
      "convert other problem sets to a suite with maps: solids and mesh surfaces are voxelized", console);
  command->footer(
      "mbm    scenes (MotionBenchMaker, MoveIt planning scenes as YAML, or .scene) and motion requests;\n"
      "       scene0001.yaml goes with request0001.yaml, one scene with all\n"
      "scene  the same\n"
      "json   problems.NAME[] with lists sphere, cylinder, box, and start, goals\n"
      "robometrics  NAME[] with obstacles (cuboid, cylinder, ...), start, goal_ik, goal_pose; cuRobo worlds");
  command->add_option("kind", options->kind, "mbm, scene, json or robometrics")
      ->required()
      ->check(one_of({"mbm", "scene", "json", "robometrics"}))
      ->type_name("KIND");
  command->add_option("files", options->files, "files of that kind")->required()->type_name("FILE…");
  command->add_option("--out", options->out, "new folder for suite.yaml, problems, maps and import.json")
      ->required()
      ->check(file_name)
      ->type_name("DIR");
  command->add_option("--resolution", options->resolution, "edge of a voxel, metres; default: 0.02")
      ->check(number("a length from 0.001 to 1 (metres)", 1e-3, 1.0))
      ->type_name("M");
  command->add_flag("--leave-out-unknown-frames", options->leave_out_unknown_frames,
                    "import scenes without what stands in a frame that is unknown, and list it");
  add_padding(*command, options->robot.padding, "; default: 0, as these problem sets are posed");
  add_model_flags(*command, options->robot);
  return [options](Console& c) { return run_import(*options, c); };
}

}  // namespace clearway
