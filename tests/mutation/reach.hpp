#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

namespace clearway::mutation {

/// Where a statement may stand that is run whenever what stands at `at` is: before the statement that holds
/// it, or before an earlier one that leads to it; npos where none is found. What is put there need not
/// compile.
std::size_t place_of_probe(const std::string& source, std::size_t at);

/// The source with a probe there, a call that tells that it was run; see probes/reached.cpp.
std::string with_probe(const std::string& source, std::size_t place, int number);
/// What a source with probes begins with.
extern const char* const declares_probes;

/// Which suites of a floor's tests run a place at all, and how long they take. Others need not be run to know
/// whether they notice a fault there.
struct Reach {
  std::map<int, std::set<std::string>> suites;  ///< by probe; "*": reached before any test began
  std::map<std::string, double> times;          ///< s of CPU time, by suite

  /// Adds what a program with probes wrote; nothing where the file is not there.
  void read(const std::filesystem::path& file);
};

}  // namespace clearway::mutation
