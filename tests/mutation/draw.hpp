#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/mutation/operators.hpp"

namespace clearway::mutation {

/// A fault in a file, as reports and the list of accepted survivors name it.
struct Candidate {
  std::string file;  ///< relative to the repository, as "planning/geometry/gjk.cpp"
  int line = 0;
  std::string text;    ///< of the line
  std::string change;  ///< "was -> is", and which of several on that line: "< -> <= (2)"
  Fault fault;

  std::string name() const { return file + ":" + std::to_string(line) + " " + fault.kind + ": " + change; }
};

/// The sources that decide what is free, blocked, proved or accepted.
/// @throws std::runtime_error when one of the list is not there: a file renamed must not drop out in silence
std::vector<std::string> deciding_files(const std::filesystem::path& repository);

/// All faults of these files in the order in which they are tried: a file's are shuffled by the seed and by
/// what they change, so that a line or a file that moves, or another file's change, does not change them;
/// then the first of each file, the second of each, and so on, the files in an order of the seed's as well.
std::vector<Candidate> drawn(const std::filesystem::path& repository, std::vector<std::string> files,
                             std::uint64_t seed);

/// The faults of a list, in its order: blocks of "file:", "line:" (its text) and "fault:" (what stands there
/// instead).
/// @throws std::runtime_error naming an entry whose line the file does not have exactly once
std::vector<Candidate> named(const std::filesystem::path& repository, const std::filesystem::path& list);

std::uint64_t hash_of(const std::string& text, std::uint64_t seed = 0);
std::string read_whole(const std::filesystem::path& file);

}  // namespace clearway::mutation
