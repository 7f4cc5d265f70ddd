#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tests/mutation/command.hpp"
#include "tests/mutation/draw.hpp"

namespace clearway::mutation {

/// What became of a fault.
struct Outcome {
  enum class Kind { noticed, survived, not_compiled } kind = Kind::survived;
  std::string by;  ///< the test, or what ended the program; of a fault that does not compile, the first error
};
std::string to_string(Outcome::Kind kind);

/// The test program of a floor, and how to build it with one source exchanged. Sources and the build folder's
/// own files are only read. Several threads may use one object.
class TestProgram {
 public:
  /// @param build a folder configured with Ninja, in which the program is built and up to date
  /// @throws std::runtime_error when it is not
  TestProgram(const std::filesystem::path& repository, const std::filesystem::path& build,
              const std::string& floor);

  /// Compiles and links the candidate's file with the fault, in `folder`, and runs the floor's tests until
  /// one fails: those of the mirrored file and of files that include its header first, then the others (of
  /// apps none: they start browsers); all of them with few drawn cases first, then, where CLEARWAY_TRIALS
  /// asks for them, with many. What fails must fail again. A program that crashes, or takes far more time
  /// than without the fault, has been noticed.
  Outcome tried(const Candidate& candidate, const std::filesystem::path& folder);

  /// Of the program as it is: what was found for another one says nothing.
  const std::string& digest() const { return digest_; }

 private:
  void add_batch(const std::filesystem::path& batch, const std::string& command);
  std::vector<std::string> tests_of(const std::string& filter, const std::filesystem::path& folder) const;
  /// Runs tests without a fault, to know their times. @throws std::runtime_error when one fails
  void measure(const std::string& filter, const std::filesystem::path& folder);
  void add_times(const std::filesystem::path& json, double cpu);
  void load_times();
  /// s of CPU time that these tests take without a fault. @throws as measure
  double usual_time(const std::string& filter, const std::filesystem::path& folder);
  enum class Trials { few, many };  ///< see tests/worlds/trials.hpp
  Ended run(const std::string& program, double usual, const std::string& filter,
            const std::filesystem::path& folder, Trials trials) const;

  /// What is compiled for a source: itself, or the batch that holds it.
  struct Unit {
    std::filesystem::path source;
    std::string command;
  };
  /// What becomes of the library's own object: the new one stands for all of it, or only comes before it.
  enum class Link { in_its_place, beside_its_batch };
  /// The source that is compiled for a fault in this file.
  std::string source_of(const std::string& file) const;
  /// The candidate's file with the fault, in `folder`; of a header, the source that includes it.
  std::filesystem::path write_faulty(const Candidate& candidate, const std::filesystem::path& folder) const;
  /// The program in `folder`, with this source. @throws std::runtime_error when it does not link in place
  Ended build(const Unit& unit, const std::filesystem::path& source, const std::filesystem::path& folder,
              Link how) const;
  /// What its tests say, by filters of gtest that are run one after the other.
  Outcome tested(const std::vector<std::string>& stages, const std::filesystem::path& folder, Trials trials);

  std::filesystem::path repository_, build_;
  std::string floor_, link_, digest_;
  Trials most_trials_;
  std::map<std::string, Unit> units_;  ///< by source, relative
  std::mutex mutex_;
  std::map<std::string, double> times_, usual_;  ///< s, by test, by filter
};

}  // namespace clearway::mutation
