#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/suite.hpp"
#include "planning/problem/planner.hpp"

namespace clearway {

/// A planner of an experiment with the options in force.
struct ComparePlanner {
  std::string label, planner;
  PlannerOptions options;
  bool certified = true;  ///< promises that every path it returns is valid
};

/// How a run moves in time: a robot smoothly (plan_motion), a team as it moved.
struct CompareMotion {
  double time = 0.0;                                       ///< s, from first to last step
  double speed = 0.0;                                      ///< greatest share of a joint's velocity limit
  double acceleration = 0.0;                               ///< greatest share of the acceleration limit
  double jerk = std::numeric_limits<double>::quiet_NaN();  ///< the same; not a number where there is no bound
  std::string note = {};  ///< why it goes edge by edge (time_parameterize), one sentence; empty: smoothly
};

/// What a run of a team has beside its path.
struct CompareTeamRun {
  double security_distance = 0.0;  ///< d_s, m
  double step_bound = 0.0;         ///< m: how much nearer two things can come in one period at most; what is
                                   ///< sensed: from one scan until the next is known
  double obstacle_speed = 0.0;     ///< v_obs, m/s: no obstacle is faster
  double between_robots = 0.0;     ///< m: least separation of robots from each other, by the check
  std::string outrun;              ///< who could not keep the separation; empty: nobody
};

/// One planner's answer to one problem with one seed.
struct CompareRun {
  std::size_t planner = 0;  ///< index in CompareExperiment::planners
  int number = 1;           ///< of the runs of this problem, from 1
  std::uint64_t seed = 1;
  PlanStatus status = PlanStatus::no_path;
  std::string ended;  ///< "crashed", "hung" or "out_of_memory" where there is no answer (problem_server.hpp)
  std::string explanation;
  std::size_t legs = 0;        ///< solved
  std::string check = "none";  ///< "valid", "undecided", "refused"; "none" when there was no path to check;
                               ///< teams: "outrun" and "unfinished", too (team_result)
  std::string contact;         ///< what the check found first; empty when valid
  double cost = 0.0;           ///< J, last segments included, of the legs solved; not a number: not known
  double length = 0.0;         ///< rad (m for sliding joints), joint-space length of the legs solved
  double min_clearance = 0.0;  ///< m, by the check
  std::size_t steps = 0, waypoints = 0;
  std::uint64_t configurations = 0, edges = 0;  ///< checked
  double time = 0.0;                            ///< s, wall clock, all legs
  double cpu = 0.0;                             ///< s of the same, by the thread that planned
  WorkTimes work;                               ///< what of `cpu` was spent on what
  double space_cpu = 0.0;   ///< s, before: the space of this problem's map, made once for all its runs
  double derive_cpu = 0.0;  ///< s, before: what the planner derives from map and robot; less once another did
  double check_time = 0.0, check_cpu = 0.0;  ///< s, after: the independent check
  double motion_cpu = 0.0;                   ///< s, after: giving the path its motion, and the check of that
  std::string plan_file;                     ///< below the folder of results
  std::string page;  ///< the same, of a worst case: its page in 3D, opened at this run; empty: none
  std::map<std::string, double> statistics;    ///< of those with columns of their own (compare_columns)
  std::optional<BoundaryPlusStage> solved_by;  ///< of several legs the last stage that was needed
  std::optional<CompareMotion> motion;         ///< of a valid path, or of a team
  std::optional<CompareTeamRun> team;          ///< teams: then min_clearance is the least separation

  bool is_solved() const { return ended.empty() && status == PlanStatus::solved; }
  bool is_valid() const { return is_solved() && check == "valid"; }
  /// What tables and the database show.
  std::string outcome() const { return ended.empty() ? std::string(to_string(status)) : ended; }
};

struct CompareProblem {
  std::string name, world;
  std::string map_file, map_sha256;
  double resolution = 0.0;  ///< m
  Configuration start;
  std::vector<Configuration> goals;
  std::vector<CompareRun> runs;  ///< planner by planner, seed by seed
  std::string page = {};         ///< its animation, below the folder of results; empty: none
};

/// A path to plot: joint values at each waypoint.
struct CompareProfile {
  std::size_t planner = 0;
  std::vector<Configuration> waypoints;
};

struct CompareExperiment {
  SuiteExperiment setup;
  std::string robot_file;
  std::string robot_sha256, problems_sha256;  ///< of what was read (compare_inputs.hpp)
  double scale = 1.0, time_limit = 0.0;       ///< as used; s a leg, or a run of a team (infinity: none)
  std::vector<std::string> joints;
  std::vector<bool> is_prismatic;
  std::vector<ComparePlanner> planners;
  std::vector<CompareProblem> problems;
  std::vector<CompareProfile> profiles;  ///< first problem, first run of each planner that found a path
};

/// Of the length of a path in joint space: "rad", "m", or "rad and m", which count alike.
std::string length_unit(const CompareExperiment& experiment);

/// What `clearway compare` found, and where and when.
struct CompareResults {
  std::string suite, title, file;
  std::string flags =
      {};  ///< that took the place of what the suite says, " --seed 7"; a run's repetition needs them
  std::string part = {};  ///< "part 3 of 70": of a shard; empty: the whole
  std::uint64_t seed = 1;
  int jobs = 1;
  std::string version, commit, host, processor, date;  ///< date: UTC, ISO 8601
  std::map<std::string, std::string> map_sha256 = {};  ///< of maps that are files, by world
  std::vector<std::string> notes = {};  ///< what a reader should know of its maps, a sentence each
  double time = 0.0;                    ///< s, all of it
  std::vector<CompareExperiment> experiments;
};

/// A planner's runs in one experiment, added up. Times are of solved runs, cost, length and steps of valid
/// ones; NaN when there is none.
struct CompareSummary {
  std::size_t solved = 0, valid = 0, total = 0;
  std::size_t problems = 0;     ///< that these runs are of
  double effective_runs = 0.0;  ///< how many independent runs they are worth (compare_statistics.hpp)
  std::size_t safe = 0, outrun = 0, refused = 0;  ///< teams: by the check, arrived or not
  double least_separation = std::numeric_limits<double>::quiet_NaN();  ///< m: of the runs that are not outrun
  double worst_shortfall = 0.0;    ///< m: of the runs that are not outrun, d_s less the least separation
  double allowed_shortfall = 0.0;  ///< m: of the same, the largest step_bound
  /// Of the same, the greatest share of the limit: separation goes first.
  double top_acceleration = std::numeric_limits<double>::quiet_NaN();
  double motion_median = 0.0;                   ///< s, of valid runs
  double time_median = 0.0, time_p95 = 0.0;     ///< s
  double cpu_median = 0.0, check_median = 0.0;  ///< s, CPU: to plan; to check what was planned
  double motion_cpu_median = 0.0;               ///< s, CPU: to give valid paths their motions
  WorkTimes work_mean;      ///< s, CPU to plan by what it was spent on: means, which add up
  double space_mean = 0.0;  ///< s, CPU, means: before planning, spaces and what planners derive from them;
  double check_mean = 0.0;  ///< after it, the check
  std::size_t edge_by_edge = 0;  ///< valid runs without a smooth motion
  double cost_median = 0.0;      ///< J
  double length_median = 0.0;    ///< rad
  double steps_median = 0.0;
  std::map<std::string, std::size_t> unsolved;  ///< by status
};
CompareSummary summary(const CompareExperiment& experiment, std::size_t planner);
/// The same of any runs, problem by problem, whatever experiments and planners they are of.
CompareSummary summary_of(const std::vector<std::vector<const CompareRun*>>& problems);

/// Sentences about paths that their planner promised to be valid and that the check does not hold valid.
std::vector<std::string> broken_promises(const CompareResults& results);

/// The table of an experiment: a header, then a row for each planner.
std::vector<std::vector<std::string>> summary_table(const CompareExperiment& experiment);

/// Three numbers of a table: "4 / 3 / 6", solved, valid and all.
std::string counts_text(const CompareSummary& sum);
/// The share of valid runs in percent with its interval at 95 % (effective_runs): "60 (31.3 to 83.2)"; "-"
/// without runs.
std::string success_text(const CompareSummary& sum);
/// Of the CPU to plan in percent: search, shortcuts and proofs, "4 / 3 / 93"; "-" for what there is none of.
std::string work_text(const CompareSummary& sum);
/// "no_path 2, timed_out 1"; "-" when all are solved.
std::string unsolved_text(const CompareSummary& sum);
/// A figure of a table; "-" for none.
std::string cell_text(double value, int digits = 3);

/// One row a run. Times stand in the column `time_s` and nowhere else.
std::string to_csv(const CompareResults& results);
std::string csv_header();
std::string csv_rows(const std::string& suite, const std::string& experiment,
                     const std::vector<ComparePlanner>& planners, const CompareProblem& problem);

/// The same in the format of OMPL's benchmark logs, which ompl_benchmark_statistics reads.
std::string to_ompl_log(const CompareResults& results);

/// A self-contained page with tables and plots.
std::string to_html(const CompareResults& results);

/// One JSON object: the summaries.
std::string to_json(const CompareResults& results);

/// Writes a SQLite database; runs have the columns of compare_columns.hpp.
void save_database(const CompareResults& results, const std::filesystem::path& file);

}  // namespace clearway
