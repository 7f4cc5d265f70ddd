#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "tests/mutation/test_program.hpp"

namespace clearway::mutation {

/// What earlier runs found, so that one that was cut off goes on: a line for each fault, appended at once.
class Records {
 public:
  /// @param trust_noticed what other builds of the same tests noticed counts as noticed still
  Records(const std::filesystem::path& file, bool trust_noticed);

  /// For a fault in a source of this text, tried with the test program of this digest.
  std::optional<Outcome> find(const std::string& key, const std::string& digest) const;
  void add(const std::string& key, const std::string& digest, const Outcome& outcome);

 private:
  struct Known {
    std::string digest;
    Outcome outcome;
  };
  bool trust_noticed_;
  std::multimap<std::string, Known> known_;
  std::ofstream out_;
  mutable std::mutex mutex_;
};

}  // namespace clearway::mutation
