#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "apps/commands/command_line.hpp"
#include "tests/apps/outputs_page.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

/// What a command printed and how it ended.
struct CommandRun {
  int status = -1;
  std::string out, log;

  /// The log is one sentence of ours: one line, and it starts with the program's name.
  bool complains_in_one_sentence() const {
    return log.starts_with("clearway: ") && std::count(log.begin(), log.end(), '\n') == 1;
  }
};

/// Whatever JSON it prints has to be described on apps/OUTPUTS.md. @throws std::logic_error when it is not
inline CommandRun run_command(const std::vector<std::string>& arguments) {
  std::ostringstream out, log;
  Console console(out, log);
  CommandRun run;
  run.status = run_command_line(arguments, console);
  run.out = out.str();
  run.log = log.str();
  if (console.json && !run.out.empty()) {
    const nlohmann::json printed = nlohmann::json::parse(run.out);
    require_described(printed, section_of(arguments, printed));
  }
  return run;
}

}  // namespace clearway
