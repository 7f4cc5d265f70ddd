#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include "apps/compare/compare_results.hpp"
#include "mapping/system/atomic_folder.hpp"

namespace clearway {

/// What a comparison found so far: `finished.csv` in its folder of results, the columns of results.csv in the
/// order in which problems end, brought to the disk with each. Any thread may add.
class FinishedProblems {
 public:
  /// @throws std::runtime_error naming the file when it cannot be written, as does add().
  FinishedProblems(AtomicFolder& folder, std::string suite);

  void add(const std::string& experiment, const std::vector<ComparePlanner>& planners,
           const CompareProblem& problem);

  /// The other files of results hold all of it now.
  void remove_file() const;

 private:
  void append(const std::string& text) const;

  AtomicFolder& folder_;
  std::string suite_;
  std::filesystem::path file_;
  FileDescriptor descriptor_;
  std::mutex mutex_;
  std::size_t count_ = 0;
};

}  // namespace clearway
