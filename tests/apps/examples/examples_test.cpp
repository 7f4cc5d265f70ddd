// The examples as a newcomer meets them; that they build and run is held against the installed package.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

namespace examples_test {

namespace fs = std::filesystem;

const fs::path examples = fs::path(CLEARWAY_SOURCE_DIR) / "apps/examples";

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    line.erase(0, line.find_first_not_of(' '));
    lines.push_back(line);
  }
  return lines;
}

std::vector<fs::path> programs() {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator(examples)) {
    if (entry.path().extension() == ".cpp") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Examples, AreNumberedShortAndAllBuilt) {
  ASSERT_EQ(programs().size(), 6U);
  const std::vector<std::string> build = lines_of(examples / "CMakeLists.txt");
  int number = 0;
  for (const fs::path& program : programs()) {
    const std::string name = program.stem();
    EXPECT_EQ(name.substr(0, 3), "0" + std::to_string(++number) + "_") << name;
    EXPECT_LE(lines_of(program).size(), 100U) << name;
    const bool is_built = std::any_of(build.begin(), build.end(), [&](const std::string& line) {
      return line.find(name) != std::string::npos;
    });
    EXPECT_TRUE(is_built) << name;
  }
}

TEST(Examples, NameHeadersAsAnInstalledPackageDoes) {
  const std::regex ours(R"(#include <(mapping|planning|tracking|datasets)/.*\.hpp>)");
  for (const fs::path& program : programs()) {
    int includes = 0;
    for (const std::string& line : lines_of(program)) {
      EXPECT_EQ(line.rfind("#include \"", 0), std::string::npos) << program << ": " << line;
      includes += std::regex_match(line, ours);
    }
    EXPECT_GT(includes, 0) << program;
  }
}

TEST(Examples, TheSnippetOfPlanningIsTheThirdLineByLine) {
  const std::vector<std::string> page = lines_of(fs::path(CLEARWAY_SOURCE_DIR) / "planning/README.md");
  const std::vector<std::string> program = lines_of(examples / "03_plan_and_check.cpp");
  auto line = std::find(page.begin(), page.end(), "```cpp");
  ASSERT_NE(line, page.end());
  auto place = program.begin();
  int shown = 0;
  for (++line; line != page.end() && *line != "```"; ++line, ++shown) {
    place = std::find(place, program.end(), *line);
    ASSERT_NE(place, program.end()) << *line;
  }
  EXPECT_GT(shown, 3);
}

}  // namespace examples_test
