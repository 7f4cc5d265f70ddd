#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "tests/mutation/command.hpp"
#include "tests/mutation/costs.hpp"
#include "tests/mutation/draw.hpp"

namespace clearway::mutation {

/// How the test program of a floor is built with some sources exchanged. Sources and the build folder's own
/// files are only read. Several threads may use one object.
class FloorBuild {
 public:
  /// @param build a folder configured with Ninja, in which the program is built and up to date
  /// @throws std::runtime_error when it is not
  FloorBuild(const std::filesystem::path& repository, const std::filesystem::path& build,
             const std::string& floor, Costs& costs);

  /// The program as it is.
  std::filesystem::path program() const { return build_ / "bin" / (floor_ + "_tests"); }

  /// Compiles and links the candidate's file with the fault: "tests" in `folder`. Not good where it does not
  /// compile. @throws std::runtime_error when it compiles and does not link
  Ended build(const Candidate& candidate, const std::filesystem::path& folder);

  /// The same without faults and with a probe before each candidate, which has its number in the list (see
  /// reach.hpp). Returns the numbers of those for which that is possible.
  /// @throws std::runtime_error when it does not link
  std::set<int> build_with_probes(const std::vector<Candidate>& candidates,
                                  const std::filesystem::path& folder);

 private:
  using Objects = std::vector<std::filesystem::path>;
  void add_batch(const std::filesystem::path& batch, const std::string& command);

  /// What is compiled for a source: itself, or the batch that holds it.
  struct Unit {
    std::filesystem::path source;
    std::string command;
  };
  /// What becomes of the library's own object: the new one stands for all of it, or only comes before it.
  enum class Link { in_its_place, beside_its_batch };
  /// The source that is compiled for a fault in this file.
  std::string source_of(const std::string& file) const;
  /// A file with another text, in `folder`; of a header, the source that includes it.
  std::filesystem::path write(const std::string& file, std::string text,
                              const std::filesystem::path& folder) const;
  Ended compiled(const Unit& unit, const std::filesystem::path& source, const std::filesystem::path& object,
                 const std::filesystem::path& folder) const;
  /// "tests" in `folder`, of these objects and the others of the floor.
  Ended linked(const Objects& objects, const std::filesystem::path& folder, Link how) const;
  /// Whether an object shows data to other files: what these took over at compile time is without the fault.
  bool shows_data(const std::filesystem::path& object, const std::filesystem::path& folder) const;
  /// Whether the source as it is compiles without its batch.
  bool compiles_alone(const std::string& source, const std::filesystem::path& folder);
  /// The numbers among these, candidates of one file, whose probes compile, and the object with them.
  std::set<int> probed(const std::vector<Candidate>& candidates, const std::vector<int>& numbers,
                       const std::filesystem::path& object, const std::filesystem::path& folder) const;

  std::filesystem::path repository_, build_;
  std::string floor_, link_;
  Costs& costs_;
  std::map<std::string, Unit> units_;  ///< by source, relative
  std::mutex mutex_;
  std::map<std::string, bool> alone_;  ///< by source: whether it compiles so
};

std::string quoted(const std::filesystem::path& path);

}  // namespace clearway::mutation
