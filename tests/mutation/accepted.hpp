#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/mutation/draw.hpp"

namespace clearway::mutation {

/// Faults that no test can or need notice, each with its reason: the program does the same, or only slower.
class AcceptedSurvivors {
 public:
  /// Blocks of four lines, "file:", "line:" (its text), "fault:" (kind: change) and "reason:", with empty
  /// lines between; # begins a comment.
  /// @throws std::runtime_error naming the file and line that are not so
  explicit AcceptedSurvivors(const std::filesystem::path& file);

  /// Why the fault is accepted; empty: it is not. "equivalent: …": it changes no result.
  std::string reason(const Candidate& candidate) const;

 private:
  struct Entry {
    std::string file, line, fault, reason;
  };
  std::vector<Entry> entries_;
};

}  // namespace clearway::mutation
