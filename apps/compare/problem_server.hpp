#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/compare/compare_run.hpp"
#include "mapping/system/child_process.hpp"

namespace clearway {

/// What a worker of a comparison is asked.
struct ProblemRequest {
  std::size_t stage = 0;
  std::optional<std::size_t> problem = {};                ///< none: which problems the stage has
  std::set<std::pair<std::size_t, int>> have = {};        ///< planner and number: runs that need no repeating
  std::set<std::pair<std::size_t, int>> wanted_not = {};  ///< runs that nobody asked for
  std::set<std::size_t> unsafe = {};                      ///< planners that took a worker down
  std::optional<int> drawn_number = {};  ///< nothing is planned: a page of the runs of that number is drawn
};

/// What it reports, step by step.
struct ProblemReply {
  enum class Kind { opened, preparing, prepared, run, finished, bad_input, damaged, failed } kind;
  std::vector<CompareProblem> problems = {};      ///< opened: of the stage, without runs
  std::size_t planner = 0;                        ///< preparing
  std::optional<CompareRun> run = {};             ///< run
  std::map<std::string, std::string> files = {};  ///< to be saved below the folder of results: bytes by name
  std::string page = {};                          ///< finished: which of the files is its page; empty: none
  std::string sentence = {};  ///< bad_input, damaged, failed; opened: why the stage has no problems
};

std::string to_bytes(const ProblemRequest& request);
ProblemRequest request_of_bytes(std::string_view bytes);
std::string to_bytes(const ProblemReply& reply);
ProblemReply reply_of_bytes(std::string_view bytes);

/// Makes the stages of one experiment and runs planners on their problems. Every run has a process of its
/// own, which holds the stage by copy-on-write, unless `choice.isolation` says otherwise: a crash, a hang and
/// too much memory are outcomes of that run (CompareRun::ended).
class ProblemServer {
 public:
  using Send = std::function<void(const ProblemReply&)>;

  virtual ~ProblemServer() = default;
  /// Answers with `opened`, or with `run`s and `finished`, or with `finished` and a page alone, or with an
  /// error. Before a planner derives what it keeps of a map comes `preparing`, then `prepared`: what happens
  /// between happens in this process.
  void answer(const ProblemRequest& request, const Send& send);

 private:
  virtual void open(std::size_t stage, const Send& send) = 0;
  virtual void plan(const ProblemRequest& request, const Send& send) = 0;
  /// Sends `finished` with the page of the runs that are saved.
  virtual void draw(const ProblemRequest& request, const Send& send) = 0;
};

std::unique_ptr<ProblemServer> make_problem_server(const Suite& suite, const PreparedExperiment& experiment,
                                                   const CompareChoice& choice);

/// How work in a process of its own ended.
struct IsolatedEnd {
  std::vector<std::string> parts;  ///< what it sent before its end
  std::string ended;               ///< as CompareRun::ended
  std::string explanation;         ///< a sentence about that
};

/// Runs `work` as `isolation` has it, at most `seconds`.
/// @throws std::invalid_argument that `work` threw
IsolatedEnd run_isolated(const PartedWork& work, const CompareIsolation& isolation, double seconds);

}  // namespace clearway
