#include "apps/commands/manual.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "tests/apps/run_command.hpp"

namespace clearway {
namespace manual_test {

namespace fs = std::filesystem;

/// The variables of the environment that our code asks for.
std::set<std::string> variables_read() {
  const std::regex asks(R"rx(getenv\("(\w+)"\))rx");
  std::set<std::string> found;
  for (const char* floor : {"mapping", "planning", "tracking", "datasets", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(CLEARWAY_SOURCE_DIR) / floor)) {
      if (entry.path().extension() != ".cpp" ||
          entry.path().string().find("/apps/bench/") != std::string::npos)
        continue;
      const std::string text = read_file(entry.path());
      for (std::sregex_iterator at(text.begin(), text.end(), asks), end; at != end; ++at)
        found.insert((*at)[1]);
    }
  }
  return found;
}

TEST(Manual, NamesEveryVariableOfTheEnvironment) {
  const std::string page = run_command({"--manual"}).out;
  const std::set<std::string> variables = variables_read();
  EXPECT_GE(variables.size(), 2U);
  for (const std::string& variable : variables)
    EXPECT_NE(page.find(".B " + variable + "\n"), std::string::npos) << variable;
}

}  // namespace manual_test
}  // namespace clearway
