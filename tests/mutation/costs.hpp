#pragma once

#include <map>
#include <mutex>
#include <string>

namespace clearway::mutation {

/// Where the CPU time goes. Several threads may use one object.
class Costs {
 public:
  void add(const std::string& work, double seconds);

  /// "1234 CPU s: compiling 400, …", what takes most first.
  std::string told() const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, double> seconds_;  ///< by work
};

}  // namespace clearway::mutation
