#include <CLI/CLI.hpp>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {

Command add_compare(CLI::App& app, Console& console) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      add_command(app, "compare", "planners against problems on voxel maps, every path re-checked", console);
  command
      ->add_option("suite", options->suite,
                   "suite file, or the name of one that comes with the program (quick, local, …)")
      ->required()
      ->type_name("SUITE.yaml");
  command->add_option("--out", options->out, "folder for results.sqlite, .csv, .log, report.html and plans")
      ->required()
      ->check(file_name)
      ->type_name("DIR");
  command
      ->add_option(
          "--planners", options->planners,
          "only those labels or planners; one that the suite does not list is added, with its defaults")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->take_all()
      ->type_name("A,B,…");
  command->add_option("--experiments", options->experiments, "only those experiments")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->take_all()
      ->type_name("A,B,…");
  command->add_option("--jobs", options->jobs, "problems at the same time; times are best taken with 1")
      ->check(number("a whole number from 1 to 256", 1, 256))
      ->type_name("N");
  command->add_option("--seed", options->seed, "of each problem's first run, instead of the suite's")
      ->type_name("N")
      ->check(whole_number);
  command
      ->add_option("--time-limit", options->time_limit,
                   "seconds for each leg of a plan, instead of the suite's, and for each run of a team")
      ->check(positive())
      ->type_name("S");
  command->add_flag("--keep-maps", options->keep_maps, "save the maps that generators make, too");
  return [options](Console& c) { return run_compare(*options, c); };
}

}  // namespace clearway
