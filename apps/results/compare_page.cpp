#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/console/number_or_null.hpp"
#include "apps/console/parse.hpp"
#include "apps/pages/page_template.hpp"
#include "apps/query/option_meanings.hpp"
#include "apps/results/compare_files.hpp"
#include "apps/results/compare_overview.hpp"
#include "apps/results/compare_resolutions.hpp"
#include "apps/results/compare_statistics.hpp"
#include "apps/results/compare_summary.hpp"
#include "apps/results/compare_worst.hpp"
#include "apps/viewer/page_templates.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json run_json(const CompareExperiment& experiment, const CompareRun& run, std::size_t problem) {
  Json json{{"planner", run.planner},
            {"problem", problem},
            {"run", run.number},
            {"status", run.outcome()},
            {"check", run.check},
            {"time", run.time},
            {"cpu", run.cpu},
            {"cost", number_or_null(run.cost)},
            {"clearance", number_or_null(run.min_clearance)},
            {"id", run_id(experiment, experiment.problems[problem], run)}};
  if (!run.page.empty()) json["page"] = run.page;
  if (!run.is_valid())
    json["explanation"] = run.is_solved() && !run.contact.empty() ? run.contact : run.explanation;
  return json;
}

/// The worst runs as indices into the page's runs, which stand problem by problem.
Json worst_json(const CompareExperiment& experiment) {
  std::vector<std::size_t> first(1, 0);
  for (const CompareProblem& problem : experiment.problems)
    first.push_back(first.back() + problem.runs.size());
  Json list = Json::array();
  for (const WorstCase& worst : worst_cases(experiment))
    list.push_back({{"kind", to_string(worst.kind)}, {"run", first[worst.problem] + worst.run}});
  return list;
}

Json figure_json(const PairedFigure& figure) {
  return {{"problems", figure.problems}, {"ratio", figure.ratio}, {"p", figure.p}};
}

Json pairs_json(const CompareExperiment& experiment) {
  Json pairs = Json::array();
  for (const PairedPlanners& pair : paired_planners(experiment))
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"firstMore", pair.first_more},
                     {"secondMore", pair.second_more},
                     {"successP", pair.success_p},
                     {"cpu", figure_json(pair.cpu)},
                     {"cost", figure_json(pair.cost)},
                     {"words", pair.words}});
  return pairs;
}

Json profile_json(const CompareProfile& profile) {
  Json waypoints = Json::array();
  for (const Configuration& q : profile.waypoints) {
    waypoints.push_back(std::vector<double>(q.begin(), q.end()));
  }
  return {{"planner", profile.planner}, {"waypoints", waypoints}};
}

/// Where the animations are, in words and as files below the folder of results.
Json pages_json(const CompareExperiment& experiment) {
  Json pages = Json::array();
  for (std::size_t i = 0; i < experiment.problems.size(); ++i)
    if (const CompareProblem& problem = experiment.problems[i]; !problem.page.empty())
      pages.push_back({{"name", problem.name}, {"file", problem.page}, {"problem", i}});
  return pages;
}

/// What the path cost is reckoned with, where that is not the usual.
std::string loads(const SuiteExperiment& setup) {
  std::string text;
  if (setup.payload > 0.0) text += "; payload " + significant(setup.payload) + " kg";
  if (setup.gravity != SuiteExperiment().gravity) {
    text += "; gravity (" + significant(setup.gravity.x()) + ", " + significant(setup.gravity.y()) + ", " +
            significant(setup.gravity.z()) + ") m/s^2";
  }
  return text;
}

std::string team_conditions(const CompareExperiment& experiment) {
  const SuiteTeams& teams = *experiment.setup.teams;
  return experiment.setup.name + ": " + counted(experiment.problems.size(), "team") + "; a step every " +
         significant(1000.0 * teams.period) + " ms, at most " + significant(teams.duration) +
         " s; joints accelerate by at most " + significant(teams.max_acceleration) + " rad/s^2 (m/s^2)" +
         loads(experiment.setup) +
         (std::isfinite(experiment.time_limit)
              ? "; computed within " + significant(experiment.time_limit) + " s, or ended there"
              : "");
}

/// Which motions are not those that controllers like, in words; empty for none.
std::string motion_note(const CompareExperiment& experiment) {
  std::size_t edge_by_edge = 0;
  for (std::size_t i = 0; i < experiment.planners.size(); ++i)
    edge_by_edge += summary(experiment, i).edge_by_edge;
  return edge_by_edge == 0 ? ""
                           : "; " + counted(edge_by_edge, "valid path") +
                                 " without a smooth motion, timed edge by edge (column motion_note says why)";
}

std::string conditions(const CompareExperiment& experiment) {
  if (experiment.setup.teams) return team_conditions(experiment);
  std::string text = experiment.setup.name + ": " + counted(experiment.problems.size(), "problem");
  if (experiment.setup.runs > 1)
    text += ", " + counted(static_cast<std::size_t>(experiment.setup.runs), "seed") + " each";
  text += "; robot " + experiment.setup.robot + ", " + counted(experiment.joints.size(), "joint");
  if (experiment.scale != 1.0) text += ", scale " + significant(experiment.scale);
  if (!experiment.problems.empty()) {
    text += "; voxels of " + significant(1000.0 * experiment.problems.front().resolution) + " mm";
  }
  for (const auto& [part, policy] : experiment.setup.policies) text += "; " + part + " " + policy;
  if (const double padding = experiment.setup.padding.value_or(0.0); padding > 0.0)
    text += "; padding " + significant(1000.0 * padding) + " mm";
  return text + loads(experiment.setup) + "; at most " + significant(experiment.time_limit) + " s a leg" +
         motion_note(experiment);
}

Json experiment_json(const CompareExperiment& experiment) {
  Json planners = Json::array(), problems = Json::array(), runs = Json::array(), profiles = Json::array();
  for (std::size_t i = 0; i < experiment.planners.size(); ++i)
    planners.push_back(summary_json(experiment, i));
  for (std::size_t i = 0; i < experiment.problems.size(); ++i) {
    problems.push_back(experiment.problems[i].name);
    for (const CompareRun& run : experiment.problems[i].runs) runs.push_back(run_json(experiment, run, i));
  }
  for (const CompareProfile& profile : experiment.profiles) profiles.push_back(profile_json(profile));
  return {{"name", experiment.setup.name},
          {"title", experiment.setup.title},
          {"paper", experiment.setup.paper},
          {"notes", experiment.setup.notes},
          {"conditions", conditions(experiment)},
          {"timeLimit", std::isfinite(experiment.time_limit) ? Json(experiment.time_limit) : Json(nullptr)},
          {"joints", experiment.joints},
          {"prismatic", experiment.is_prismatic},
          {"plots", experiment.setup.plots},
          {"planners", planners},
          {"problems", problems},
          {"runs", runs},
          {"profiles", profiles},
          {"pairs", pairs_json(experiment)},
          {"pages", pages_json(experiment)},
          {"worst", worst_json(experiment)},
          {"table", experiment.setup.teams ? Json(summary_table(experiment)) : Json(nullptr)}};
}

/// What the page says of the maps; empty: nothing.
std::string noted(const CompareResults& results) {
  std::string text;
  for (const std::string& note : results.notes) text += " Note: " + note + ".";
  return text;
}

/// What the tables of teams leave out; empty where there are none.
std::string team_note(const CompareResults& results) {
  const bool is_of_teams =
      std::any_of(results.experiments.begin(), results.experiments.end(),
                  [](const CompareExperiment& experiment) { return experiment.setup.teams.has_value(); });
  return is_of_teams ? " Least separation, below d_s and top acceleration of teams are of the runs that were "
                       "not outrun."
                     : "";
}

/// The flags that name planners of other programs, which a repeated run needs, too.
std::string externals_of(const CompareResults& results) {
  std::set<std::string> flags;
  for (const CompareExperiment& experiment : results.experiments)
    for (const ComparePlanner& who : experiment.planners)
      if (who.planner == "external") flags.insert(" --external " + who.label + "=COMMAND");
  std::string text;
  for (const std::string& flag : flags) text += flag;
  return text;
}

}  // namespace

std::string to_html(const CompareResults& results) {
  const std::string title = results.title.empty() ? results.suite : results.title;
  Json page{
      {"title", title},
      {"subtitle", "Suite " + results.suite + " (" + results.file + "), seed " +
                       std::to_string(results.seed) + (results.part.empty() ? "" : ", " + results.part)},
      {"about", "Clearway " + results.version + ", commit " + results.commit + ", " + results.date + ", on " +
                    results.host + " (" + results.processor + "), " +
                    counted(static_cast<std::size_t>(results.jobs), "problem") +
                    " at a time. Times are of solved runs; cost, length and steps are medians "
                    "of valid runs. " +
                    interval_note + team_note(results) +
                    " Every path was judged by the independent check, whoever planned it. "
                    "To repeat a run and see it in 3D: clearway compare " +
                    results.file + " --rerun ID --out DIR" + results.flags + externals_of(results) + "." +
                    noted(results)},
      {"overview", overview_json(overview(results))},
      {"resolutions", sweeps_json(results)},
      {"experiments", Json::array()}};
  Json& meanings = page["meanings"] = Json::object();
  for (const CompareExperiment& experiment : results.experiments)
    for (const ComparePlanner& who : experiment.planners)
      for (const auto& [option, value] : who.options)
        meanings[who.planner][option] = option_meaning(who.planner, option);
  for (const CompareExperiment& experiment : results.experiments)
    if (!experiment.problems.empty()) page["experiments"].push_back(experiment_json(experiment));
  return fill_page_template(compare_template(), title,
                            "<script type=\"application/json\" id=\"page\">" +
                                script_json(page.dump(-1, ' ', false, Json::error_handler_t::replace)) +
                                "</script>\n");
}

}  // namespace clearway
