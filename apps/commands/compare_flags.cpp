#include <CLI/CLI.hpp>
#include <charconv>

#include "apps/console/commands.hpp"
#include "apps/console/flags.hpp"

namespace clearway {
namespace {

/// "2/5" into `options`; what was expected where it is none.
std::string read_shard(const std::string& text, CompareOptions& options) {
  const char* const end = text.data() + text.size();
  const auto [slash, first_error] = std::from_chars(text.data(), end, options.shard);
  const bool has_slash = first_error == std::errc() && slash != end && *slash == '/';
  const auto [rest, second_error] = has_slash ? std::from_chars(slash + 1, end, options.shards)
                                              : std::from_chars_result{slash, first_error};
  if (has_slash && second_error == std::errc() && rest == end && options.shard >= 1 &&
      options.shard <= options.shards && options.shards <= 1000000)
    return {};
  return "expected I/N, part I of N with 1 <= I <= N <= 1000000, got '" + text + "'";
}

void add_choice_flags(CLI::App& command, CompareOptions& options) {
  const auto add_names = [&](const char* flag, std::vector<std::string>& names, const char* what) {
    command.add_option(flag, names, what)
        ->delimiter(',')
        ->allow_extra_args(false)
        ->take_all()
        ->type_name("A,B,…");
  };
  add_names(
      "--planners", options.planners,
      "run only these labels or planners; a planner that the suite does not list is added with its defaults");
  command
      .add_option("--external", options.externals,
                  "add a planner in another program, which COMMAND starts: problems in, paths out, as JSON "
                  "lines (see apps/compare/YOUR_PLANNER.md); repeatable")
      ->allow_extra_args(false)
      ->take_all()
      ->check([](const std::string& text) {
        const std::size_t equals = text.find('=');
        return equals == 0 || equals + 1 >= text.size() || equals == std::string::npos
                   ? "expected NAME=COMMAND, got '" + text + "'"
                   : std::string{};
      })
      ->type_name("NAME=COMMAND");
  add_names("--experiments", options.experiments, "run only these experiments");
  command
      .add_option("--seed", options.seed, "random seed of each problem's first run, instead of the suite's")
      ->type_name("N")
      ->check(whole_number);
  command
      .add_option("--time-limit", options.time_limit,
                  "time limit per leg, and per run of a team, seconds, instead of the suite's")
      ->check(positive())
      ->type_name("S");
  command.add_flag("--keep-maps", options.keep_maps, "save generated maps, too");
}

void add_run_flags(CLI::App& command, const std::shared_ptr<CompareOptions>& options) {
  command.add_option("--jobs", options->jobs, "problems solved in parallel; use 1 for timings")
      ->check(number("a whole number from 1 to 256", 1, 256))
      ->type_name("N");
  command
      .add_option("--worst-pages", options->worst_pages,
                  "draw 3D pages of at most so many worst runs (failed, slowest, tightest, dearest) of each "
                  "experiment below worst/, linked from the report; 0: none")
      ->capture_default_str()
      ->check(number("a whole number from 0 to 1000", 0, 1000))
      ->type_name("N");
  command.add_flag("--resume", options->resume,
                   "continue the interrupted run in DIR.partial; where DIR is whole, show it; else begin");
  command
      .add_option("--rerun", options->rerun,
                  "repeat only the run with this id, as printed and as below plans/: "
                  "EXPERIMENT/PROBLEM/PLANNER[-RUN]; --out is a new folder, or omitted")
      ->type_name("ID");
  command
      .add_option_function<std::string>(
          "--shard", [options](const std::string& text) { read_shard(text, *options); },
          "run part I of N of all problems; `compare merge` joins the results")
      ->check([](const std::string& text) {
        CompareOptions unused;
        return read_shard(text, unused);
      })
      ->type_name("I/N");
  command
      .add_option_function<std::string>(
          "--isolate", [options](const std::string& text) { options->isolate = text == "yes"; },
          "yes: one process per run, so that crashes, hangs and memory overuse become its outcome; no: all "
          "runs in one process, for debuggers (default: yes)")
      ->check(one_of({"yes", "no"}))
      ->type_name("YES|NO");
  command
      .add_option(
          "--hang-after", options->grace,
          "seconds beyond the time limit (for preparation and check) after which a run counts as hung")
      ->capture_default_str()
      ->check(positive())
      ->type_name("S");
  command.add_option("--memory", options->memory, "memory limit of a run beyond its world, gigabytes")
      ->capture_default_str()
      ->check(number("a number from 0.001 to 100000", 1e-3, 1e5))
      ->type_name("GB");
}

}  // namespace

Command add_compare(CLI::App& app, Console& console) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* command =
      add_command(app, "compare", "run planners on problems in voxel maps, every path re-checked", console);
  command
      ->add_option("suite", options->what,
                   "suite file, or the name of one that comes with the program (quick, local, …); or `merge` "
                   "and the folders of all shards; or `diff` and two folders, or results.sqlite, old and new")
      ->required()
      ->type_name("SUITE.yaml | merge DIR… | diff OLD NEW");
  command->add_option("--out", options->out, "folder for results.sqlite, .csv, .log, report.html and plans")
      ->check(file_name)
      ->type_name("DIR");
  add_choice_flags(*command, *options);
  add_run_flags(*command, options);
  return [options](Console& c) { return run_compare(*options, c); };
}

}  // namespace clearway
