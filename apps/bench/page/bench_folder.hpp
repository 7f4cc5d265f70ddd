#pragma once

#include <filesystem>
#include <string>

namespace clearway::bench {

/// A folder for the files of a benchmark, which goes with them.
class BenchFolder {
 public:
  explicit BenchFolder(const std::string& benchmark);
  ~BenchFolder();
  BenchFolder(const BenchFolder&) = delete;
  BenchFolder& operator=(const BenchFolder&) = delete;

  const std::filesystem::path path;
};

}  // namespace clearway::bench
