#include "datasets/descriptions/suite.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "datasets/descriptions/query_fields.hpp"
#include "datasets/descriptions/suite_limits.hpp"
#include "datasets/descriptions/suite_strokes.hpp"
#include "datasets/yaml/yaml_fields.hpp"
#include "datasets/yaml/yaml_gate.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr Bounds resolutions{1e-4, 100};
// Drawn scenes are as large as the arm that they are for, a metre or so.
constexpr Bounds generated_resolutions{0.002, 100};

SuiteVolume read_volume(const YamlFields& fields) {
  SuiteVolume volume;
  volume.label = fields.text("label");
  volume.critical_parts = fields.full_texts("critical_parts");
  for (const auto& entry : fields.list_of_maps("strokes")) volume.strokes.push_back(read_suite_stroke(entry));
  if (volume.strokes.empty()) fields.fail("strokes", "expected at least one stroke");
  fields.finish();
  return volume;
}

void read_made_world(const YamlFields& fields, SuiteWorld& world) {
  world.resolution = fields.number("resolution", resolutions, world.resolution);
  std::set<std::string> names, labels;
  for (const auto& entry : fields.list_of_maps("solids")) {
    world.solids.push_back(read_scene_shape(entry));
    take_name(names, world.solids.back().name, entry, "name");
  }
  world.is_exact = fields.has("exact") && fields.boolean("exact");
  for (const char* key : {"sensors", "sensor_range", "volumes", "pockets"})
    if (world.is_exact && fields.has(key)) fields.fail(key, "expected nothing: an exact world is its solids");
  if (world.is_exact && world.solids.empty()) fields.fail("solids", "expected at least one");
  if (world.is_exact) return;
  if (fields.has("sensors"))
    for (const auto& at : fields.lists_of_numbers("sensors", within_reach, 3))
      world.sensors.emplace_back(at.data());
  world.sensor_range = fields.number("sensor_range", above_zero, world.sensor_range);
  for (const auto& entry : fields.list_of_maps("volumes")) {
    world.volumes.push_back(read_volume(entry));
    take_name(labels, world.volumes.back().label, entry, "label");
  }
  if (world.volumes.size() > 15) fields.fail("volumes", "expected at most 15 of them");
  if (fields.has("pockets")) world.pockets = read_spheres(fields, "pockets");
  if (!world.solids.empty() && world.sensors.empty())
    fields.fail("sensors", "expected at least one sensor that looks at the solids");
  if (world.sensors.empty() && world.volumes.empty())
    fields.fail("volumes", "expected a map, or sensors or volumes to make one of");
}

SuiteWorld read_world(const YamlFields& fields, const std::filesystem::path& folder) {
  SuiteWorld world;
  world.name = fields.text("name");
  if (fields.has("map"))
    world.map = folder / fields.file("map");
  else
    read_made_world(fields, world);
  fields.finish();
  require_size(fields, world);
  return world;
}

void require_world(const YamlFields& fields, const Suite& suite, const std::string& name);

const std::vector<std::string> page_layers = {"painted", "occupied", "conflict", "seen_free", "balls",
                                              "robot",   "ghosts",   "tip",      "others",    "seen"};

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

SuiteView read_view(const YamlFields& fields) {
  SuiteView view;
  view.caption = fields.prose("caption", "");
  if (fields.has("cut")) {
    const YamlFields cut = fields.map("cut");
    for (const std::string& plane : cut.keys()) {
      const std::string axis = plane.substr(plane.starts_with('-') ? 1 : 0);
      if (axis != "x" && axis != "y" && axis != "z")
        cut.fail(plane, "expected planes of x, y or z, or -x, -y or -z to see the other side");
      view.cut[plane] = cut.number(plane, within_reach);
    }
  }
  if (fields.has("eye_deg")) view.eye_deg = fields.numbers("eye_deg", {-360, 360}, 2);
  if (fields.has("zoom") && view.eye_deg.empty()) fields.fail("zoom", "expected 'eye_deg' beside it");
  view.zoom = fields.number("zoom", {0.01, 100}, view.zoom);
  view.layers = fields.texts("layers");
  for (const std::string& layer : view.layers)
    if (std::find(page_layers.begin(), page_layers.end(), layer) == page_layers.end())
      fields.fail("layers", "expected any of " + list_of(page_layers) + ", got " + quote(layer));
  fields.finish();
  return view;
}

/// Of a problem with its legs known.
std::vector<LoadSetup> read_leg_loads(const YamlFields& fields, const std::filesystem::path& folder,
                                      std::size_t legs) {
  std::vector<LoadSetup> loads;
  for (const auto& entry : fields.list_of_maps("loads")) {
    loads.push_back(read_load(entry, folder));
    for (const int leg : loads.back().legs)
      if (leg > static_cast<int>(legs))
        entry.fail("legs", "expected legs from 1 to " + std::to_string(legs) + ", one for each goal, got " +
                               std::to_string(leg));
  }
  return loads;
}

/// A list, or the name of a file beside the suite that holds one under `problems`.
std::vector<SuiteProblem> read_problems(const YamlFields& given, const Suite& suite,
                                        const std::filesystem::path& folder, const std::string& usual_world) {
  std::optional<YamlFields> file;
  if (!given.is_list("problems")) {
    const std::filesystem::path name = folder / given.file("problems");
    file.emplace(read_text(name, "file of problems"), "problems " + quote_path(name.string()));
  }
  const YamlFields& fields = file ? *file : given;
  std::vector<SuiteProblem> problems;
  std::set<std::string> names;
  for (const auto& entry : fields.list_of_maps("problems")) {
    SuiteProblem& problem = problems.emplace_back();
    problem.name = entry.text("name");
    take_name(names, problem.name, entry, "name");
    if (entry.has("world")) {
      problem.world = entry.text("world");
      require_world(entry, suite, problem.world);
    } else if (usual_world.empty()) {
      entry.fail("world", "expected one here, or one for the whole experiment");
    }
    read_start(entry, problem);
    read_goals(entry, problem);
    if (problem.goals.empty()) entry.fail("goals", "expected at least one goal");
    problem.loads = read_leg_loads(entry, folder, problem.goals.size());
    if (entry.has("view")) problem.view = read_view(entry.map("view"));
    entry.finish();
  }
  if (problems.empty()) fields.fail("problems", "expected at least one problem");
  if (file) file->finish();
  return problems;
}

SuiteGenerator read_generator(const YamlFields& fields) {
  SuiteGenerator generator;
  generator.kind = fields.text("kind");
  generator.count = fields.integer("count", {1, 10000000});
  generator.seed = fields.seed("seed", 1);
  generator.resolution = fields.number("resolution", generated_resolutions, generator.resolution);
  fields.finish();
  return generator;
}

std::vector<SuitePlanner> read_planners(const YamlFields& fields) {
  std::vector<SuitePlanner> planners;
  std::set<std::string> labels;
  for (const auto& entry : fields.list_of_maps("planners")) {
    SuitePlanner& planner = planners.emplace_back();
    planner.planner = entry.text("planner");
    planner.label = entry.text("label", planner.planner);
    take_name(labels, planner.label, entry, entry.has("label") ? "label" : "planner");
    if (entry.has("options")) planner.options = read_options(entry.map("options"));
    entry.finish();
  }
  return planners;
}

void require_world(const YamlFields& fields, const Suite& suite, const std::string& name) {
  std::string names;
  for (const SuiteWorld& world : suite.worlds) {
    if (world.name == name) return;
    if (names.size() > 200 && !names.ends_with("…")) names += ", …";
    if (!names.ends_with("…")) names += (names.empty() ? "" : ", ") + world.name;
  }
  if (names.empty()) fields.fail("world", "got '" + name + "', but the suite has no 'worlds'");
  fields.fail("world", "expected the name of one of the suite's worlds (" + names + "), got '" + name + "'");
}

/// The world and the problems in it, or the generator of both.
void read_tasks(const YamlFields& fields, const Suite& suite, const std::filesystem::path& folder,
                SuiteExperiment& experiment) {
  if (fields.has("generate") + fields.has("problems") + fields.has("teams") != 1)
    fields.fail("problems", "expected one of: 'world' and 'problems'; 'generate'; 'teams'");
  if (fields.has("generate")) experiment.generate = read_generator(fields.map("generate"));
  const bool is_team =
      fields.has("teams") || (experiment.generate && experiment.generate->kind == "crossings");
  if (is_team) experiment.teams = read_suite_teams(fields, folder);
  if (!is_team) experiment.robot = fields.robot("robot", folder);
  if (experiment.generate || (is_team && !fields.has("world"))) return;
  if (is_team || fields.has("world")) {
    experiment.world = fields.text("world");
    require_world(fields, suite, experiment.world);
  }
  if (!is_team) experiment.problems = read_problems(fields, suite, folder, experiment.world);
}

/// What of the robot moves, and where its files are.
void take_robot_terms(const YamlFields& fields, const std::filesystem::path& folder,
                      SuiteExperiment& experiment) {
  for (const char* key : {"srdf", "group", "fixed", "packages", "xacro"})
    if (experiment.teams && fields.has(key)) fields.fail(key, "expected nothing: it does not apply to teams");
  static_cast<RobotTermsSetup&>(experiment) = read_robot_terms(fields, folder);
}

std::set<std::string> used_worlds(const SuiteExperiment& experiment) {
  std::set<std::string> names;
  for (const SuiteProblem& problem : experiment.problems)
    names.insert(problem.world.empty() ? experiment.world : problem.world);
  return names;
}

/// Of an experiment whose worlds are made: of a map that is loaded the resolution is what it is.
void read_resolutions(const YamlFields& fields, const Suite& suite, SuiteExperiment& experiment) {
  if (!fields.has("resolutions")) return;
  if (experiment.teams) fields.fail("resolutions", "expected nothing: it does not apply to teams");
  experiment.resolutions =
      fields.numbers("resolutions", experiment.generate ? generated_resolutions : resolutions);
  constexpr std::size_t most = 20;
  if (experiment.resolutions.size() < 2 || experiment.resolutions.size() > most)
    fields.fail("resolutions", "expected 2 to " + std::to_string(most) + " resolutions, got " +
                                   std::to_string(experiment.resolutions.size()) +
                                   "; a single one stands in 'resolution'");
  if (std::set<double>(experiment.resolutions.begin(), experiment.resolutions.end()).size() !=
      experiment.resolutions.size())
    fields.fail("resolutions", "expected each resolution once");
  if (experiment.generate && fields.map("generate").has("resolution"))
    fields.fail("resolutions", "expected nothing beside the 'resolution' of 'generate'; state one of them");
  const std::set<std::string> used = used_worlds(experiment);
  for (const SuiteWorld& world : suite.worlds)
    if (used.contains(world.name) && !world.map.empty())
      fields.fail("resolutions", "expected worlds that are made here, but the map of world " +
                                     quote(world.name) + " is loaded and has a resolution of its own");
}

SuiteExperiment read_experiment(const YamlFields& fields, const Suite& suite,
                                const std::filesystem::path& folder, const std::vector<SuitePlanner>& usual) {
  SuiteExperiment experiment;
  experiment.name = fields.text("name");
  experiment.title = fields.prose("title", experiment.name);
  experiment.paper = fields.prose("paper", "");
  experiment.notes = fields.prose("notes", "");
  experiment.scale = fields.optional_number("scale", robot_scales);
  if (fields.has_angles("base")) experiment.map_from_base = fields.pose("base");
  experiment.payload = fields.number("payload", not_negative, experiment.payload);
  if (fields.has("gravity")) experiment.gravity = fields.vector("gravity");
  read_tasks(fields, suite, folder, experiment);
  read_resolutions(fields, suite, experiment);
  take_robot_terms(fields, folder, experiment);
  for (const char* key : {"scale", "payload", "base", "base_deg"})
    if (experiment.teams && fields.has(key)) fields.fail(key, "expected it beside each robot of a team");
  if (fields.has("policies")) experiment.policies = read_policies(fields.map("policies"));
  experiment.padding = read_padding(fields);
  experiment.planners = fields.has("planners") ? read_planners(fields) : usual;
  if (experiment.planners.empty()) fields.fail("planners", "expected at least one planner");
  experiment.runs = fields.integer("runs", {1, 10000}, experiment.runs);
  experiment.time_limit = fields.optional_number("time_limit", above_zero);
  experiment.plots = fields.texts("plots");
  for (const char* key : {"padding", "runs"})
    if (experiment.teams && fields.has(key)) fields.fail(key, "expected nothing: it does not apply to teams");
  fields.finish();
  require_size(fields, experiment);
  return experiment;
}

/// Each world at each resolution that an experiment wants it at.
void require_sizes_at_resolutions(const YamlFields& fields, const Suite& suite,
                                  const SuiteExperiment& experiment) {
  const std::set<std::string> used = used_worlds(experiment);
  const auto entries = fields.list_of_maps("worlds");
  for (std::size_t i = 0; i < suite.worlds.size(); ++i) {
    SuiteWorld world = suite.worlds[i];
    for (const double resolution : experiment.resolutions) {
      world.resolution = resolution;
      if (used.contains(world.name)) require_size(entries[i], world);
    }
  }
}

}  // namespace

Suite parse_suite(const std::string& text, const std::string& name) {
  const YamlFields fields(text, "suite " + quote_path(name));
  const std::filesystem::path file = name;
  Suite suite;
  suite.name = fields.text("name", file.stem().string());
  suite.title = fields.prose("title", suite.name);
  suite.seed = fields.seed("seed", 1);
  suite.time_limit = fields.number("time_limit", above_zero, suite.time_limit);
  std::set<std::string> worlds, experiments;
  for (const auto& entry : fields.list_of_maps("worlds")) {
    suite.worlds.push_back(read_world(entry, file.parent_path()));
    take_name(worlds, suite.worlds.back().name, entry, "name");
  }
  const auto usual = read_planners(fields);
  for (const auto& entry : fields.list_of_maps("experiments")) {
    suite.experiments.push_back(read_experiment(entry, suite, file.parent_path(), usual));
    take_name(experiments, suite.experiments.back().name, entry, "name");
    require_sizes_at_resolutions(fields, suite, suite.experiments.back());
  }
  if (suite.experiments.empty()) fields.fail("experiments", "expected at least one experiment");
  fields.finish();
  return suite;
}

Suite load_suite(const std::filesystem::path& file) {
  return parse_suite(read_text(file, "suite"), file.string());
}

}  // namespace clearway
