#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tests/mutation/command.hpp"
#include "tests/mutation/costs.hpp"
#include "tests/mutation/draw.hpp"
#include "tests/mutation/floor_build.hpp"
#include "tests/mutation/reach.hpp"
#include "tests/mutation/test_stages.hpp"

namespace clearway::mutation {

/// What became of a fault.
struct Outcome {
  enum class Kind { noticed, survived, not_compiled, open } kind = Kind::survived;
  /// The test, or what ended the program; of a fault that does not compile, the first error; of a survivor,
  /// what may explain it. Open: not noticed by the near tests, the others are still to be run.
  std::string by;
};
std::string to_string(Outcome::Kind kind);

/// The tests of a floor, run with one fault. Several threads may use one object.
class TestProgram {
 public:
  /// @throws as FloorBuild
  TestProgram(const std::filesystem::path& repository, const std::filesystem::path& build,
              const std::string& floor, Costs& costs);

  /// Builds the program with the fault, in `folder`, and runs the tests near it (see test_stages.hpp) until
  /// one fails. What fails must fail again. A program that crashes, or takes far more time than without the
  /// fault, has been noticed.
  Outcome tried_nearby(const Candidate& candidate, const std::filesystem::path& folder);

  /// Runs all tests of the floor once, without faults, to know which of them run the places of these.
  /// @throws std::runtime_error when one fails
  void find_reach(const std::vector<Candidate>& open, const std::filesystem::path& folder);

  /// The same as tried_nearby with the other tests, of those asked for in find_reach the ones that run the
  /// place; with many drawn cases where CLEARWAY_TRIALS asks for them.
  Outcome tried_by_others(const Candidate& candidate, const std::filesystem::path& folder);

  /// Runs the tests that noticed faults once without any. @throws std::runtime_error when one fails
  void verify(const std::vector<Outcome>& outcomes, const std::filesystem::path& folder) const;

  /// Of the program as it is: what was found for another one says nothing.
  const std::string& digest() const { return digest_; }

 private:
  struct Run {
    std::filesystem::path program;
    std::string filter, environment;
    Trials trials = Trials::few;
    std::optional<double> usual;  ///< s of CPU time; none: not known yet
    bool ends_at_first = true;    ///< at the first test that fails
  };
  Ended run(const Run& what, const std::filesystem::path& folder) const;
  /// Runs tests that all must pass, as many at a time as there are cores, and returns s of CPU time.
  /// `environment` is told the number of each. @throws std::runtime_error when one fails
  template <typename Environment>
  double run_faultless(const Run& what, const Environment& environment,
                       const std::filesystem::path& folder) const;
  /// s of CPU time that the tests of a stage take without a fault. @throws as run_faultless
  double usual_time(const Stage& stage, const std::filesystem::path& folder);
  /// Of a stage the tests that run the candidate's place, and their usual time; an empty filter where none
  /// does.
  std::pair<std::string, std::optional<double>> reaching(const Candidate& candidate,
                                                         const Stage& stage) const;
  /// @param what of `stage`, or of a part of it
  Outcome tested(Run what, const Stage& stage, const std::filesystem::path& folder);
  /// The program as it is, linked to where the faulty ones run: a place in which all tests fail would notice
  /// every fault.
  std::filesystem::path faultless(const std::filesystem::path& folder) const;

  std::filesystem::path repository_;
  std::string floor_, digest_;
  Trials most_trials_;
  Costs& costs_;
  FloorBuild build_;
  std::mutex mutex_;
  std::map<std::string, double> usual_;  ///< s, by trials and filter
  std::map<std::string, int> probes_;    ///< by candidate's name
  std::map<Trials, Reach> reach_;
};

}  // namespace clearway::mutation
