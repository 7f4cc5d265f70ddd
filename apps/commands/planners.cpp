#include <nlohmann/json.hpp>
#include <ostream>

#include "apps/console/commands.hpp"
#include "apps/console/table.hpp"
#include "apps/query/option_meanings.hpp"
#include "planning/planner_table.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

int run_planners(Console& console) {
  std::vector<std::vector<std::string>> rows{{"planner", "description"}};
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const PlannerEntry& entry : planner_table()) {
    rows.push_back({std::string(entry.name), std::string(entry.description)});
    const PlannerOptions options = make_planner(entry.name)->options();
    nlohmann::ordered_json meanings = nlohmann::ordered_json::object();
    for (const auto& [option, value] : options)
      meanings[option] = option_meaning(std::string(entry.name), option);
    json.push_back({{"name", entry.name},
                    {"description", entry.description},
                    {"options", options},
                    {"meanings", meanings}});
  }
  if (console.json) {
    console.out() << nlohmann::ordered_json{{"planners", json}}.dump(2) << '\n';
  } else {
    print_table(console.out(), rows);
  }
  return exit_done;
}

}  // namespace clearway
