#include "apps/results/compare_files.hpp"

#include <algorithm>
#include <string_view>

namespace clearway {

std::vector<std::string> names_as_files(const std::vector<ComparePlanner>& planners) {
  std::vector<std::string> names;
  for (const ComparePlanner& planner : planners) {
    std::string name = name_as_file(planner.label);
    while (std::find(names.begin(), names.end(), name) != names.end()) name += "_";
    names.push_back(name);
  }
  return names;
}

std::string run_id(const CompareExperiment& experiment, const CompareProblem& problem,
                   const CompareRun& run) {
  return name_as_file(experiment.setup.name) + "/" + name_as_file(problem.name) + "/" +
         names_as_files(experiment.planners)[run.planner] +
         (experiment.setup.runs > 1 ? "-" + std::to_string(run.number) : "");
}

bool is_of_comparison(const std::filesystem::path& relative) {
  if (std::find(result_files.begin(), result_files.end(), relative) != result_files.end()) return true;
  const std::filesystem::path folder = *relative.begin(), kind = relative.extension();
  if (folder == "maps") return relative.filename() == "map.ot" || relative.filename() == "painted.csv";
  if (folder == "plans" || folder == "teams") return kind == ".json" || kind == ".html";
  return (folder == "animations" || folder == "worst") && kind == ".html";
}

}  // namespace clearway
