#include "apps/commands/manual.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
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

/// What bash offers for the last of these words.
std::string offered(const std::string& words) {
  const TemporaryFolder folder;
  folder.write("own.urdf", "");
  folder.write("completion", run_command({"--completion", "bash"}).out);
  folder.write("ask",
               "cd '" + folder.path().string() + "'; source completion\nCOMP_WORDS=(" + words +
                   ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_clearway\necho ${COMPREPLY[*]} > said\n");
  EXPECT_EQ(std::system(("bash " + folder.file("ask")).c_str()), 0) << words;
  const std::string said = read_file(folder / "said");
  return said.substr(0, said.find('\n'));
}

TEST(Completion, OffersWhatAnOptionTakes) {
  EXPECT_EQ(offered("clearway pl"), "plan planners");
  EXPECT_EQ(offered("clearway plan --planner bou"), "boundary boundary_plus boundary_sides");
  EXPECT_EQ(offered("clearway plan --planner = bea"), "beam beam_guided beam_reference");
  EXPECT_EQ(offered("clearway check --policy ''"), "painted known_free not_occupied");
  EXPECT_EQ(offered("clearway plan --free-axis ''"), "x y z");
  EXPECT_EQ(offered("clearway plan --export ros"), "ros ros-json");
  EXPECT_EQ(offered("clearway compare quick --isolate ''"), "yes no");
  EXPECT_EQ(offered("clearway plan --robot p"), "panda planar2 point puma560 puma560_miniature");
  EXPECT_EQ(offered("clearway plan --robot o"), "own.urdf");
  EXPECT_EQ(offered("clearway calibrate ''"), "camera board probe base hand-eye");
  EXPECT_EQ(offered("clearway compare di"), "diff");
  EXPECT_EQ(offered("clearway compare me"), "merge");
  EXPECT_NE((" " + offered("clearway compare ''") + " ").find(" quick "), std::string::npos);
  EXPECT_EQ(offered("clearway compare diff o"), "own.urdf");
  EXPECT_NE(run_command({"--completion", "zsh"}).out.find(" diff merge; _files}"), std::string::npos);
  EXPECT_EQ(offered("clearway replay o"), "own.urdf");
  EXPECT_EQ(offered("clearway replay r --integration com"), "compatible");
}

TEST(Completion, HelpAndManualNameATypeWithoutItsValues) {
  EXPECT_NE(run_command({"plan", "--help"}).out.find("--free-axis AXIS "), std::string::npos);
  EXPECT_NE(run_command({"--manual"}).out.find("\\-\\-free\\-axis AXIS\n"), std::string::npos);
  const CommandRun run = run_command({"plan", "--map", "m", "--free-axis", "w"});
  EXPECT_NE(run.log.find("--free-axis: expected x, y or z, got 'w'"), std::string::npos) << run.log;
}

/// Help and manual say where files and JSON are described, and the pages are there.
TEST(Manual, NamesThePagesOfTheReference) {
  const std::string help = run_command({"--help"}).out, manual = run_command({"--manual"}).out;
  for (const char* page : {"datasets/FORMATS.md", "apps/OUTPUTS.md"}) {
    EXPECT_NE(help.find(page), std::string::npos) << page;
    EXPECT_NE(manual.find(std::string(".B ") + page + "\n"), std::string::npos) << page;
    EXPECT_TRUE(fs::exists(fs::path(CLEARWAY_SOURCE_DIR) / page)) << page;
  }
  for (const char* command : {"replay", "teach", "plan", "check", "gate", "inspect", "compare", "import",
                              "simulate", "track", "tags", "calibrate", "robots", "planners"}) {
    std::string text = run_command({command, "--help"}).out;
    text = std::regex_replace(text, std::regex("\\s+"), " ");
    EXPECT_NE(text.find("apps/OUTPUTS.md has its keys"), std::string::npos) << command;
  }
}

/// "..." stands in a command's help where several values may follow one flag, and nowhere else.
TEST(Manual, HelpShowsHowManyValuesAFlagTakes) {
  for (const char* command : {"plan", "check", "gate", "import"}) {
    const std::string help = run_command({command, "--help"}).out;
    const auto at = help.find("--fix JOINT=VALUE");
    ASSERT_NE(at, std::string::npos) << command;
    EXPECT_NE(help.substr(at, 24).find("--fix JOINT=VALUE "), std::string::npos);
    EXPECT_EQ(help.substr(at, 24).find("..."), std::string::npos) << help.substr(at, 24);
  }
  EXPECT_NE(run_command({"import", "--help"}).out.find("..."), std::string::npos);  // its files
  const CommandRun slow =
      run_command({"plan", "--map", "m", "--robot", "point", "--start=0,0", "--goal=0,0", "--speed", "1e-9"});
  EXPECT_EQ(slow.status, exit_bad_input);
  EXPECT_NE(slow.log.find("expected a share from 0.000001 to 1, got '1e-9'"), std::string::npos) << slow.log;
}

}  // namespace manual_test
}  // namespace clearway
