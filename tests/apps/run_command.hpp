#pragma once

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "apps/commands/command_line.hpp"

namespace clearway {

/// What a command printed and how it ended.
struct CommandRun {
  int status = -1;
  std::string out, log;

  /// The log is one sentence of ours: one line, and it starts with the program's name.
  bool told_in_one_sentence() const {
    return log.starts_with("clearway: ") && std::count(log.begin(), log.end(), '\n') == 1;
  }
};

inline CommandRun run_command(const std::vector<std::string>& arguments) {
  std::ostringstream out, log;
  Console console(out, log);
  CommandRun run;
  run.status = run_command_line(arguments, console);
  run.out = out.str();
  run.log = log.str();
  return run;
}

/// A fresh folder that goes away with the test.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "clearway-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return file(name);
  }
  /// Files below the folder, relative, sorted: for "no half-written file".
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
      if (entry.is_regular_file()) names.push_back(std::filesystem::relative(entry.path(), path_).string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace clearway
