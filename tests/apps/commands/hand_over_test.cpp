// The program itself, from outside: what it loads, and that nobody notices where it goes on in clearway-full.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/small_suite.hpp"

namespace clearway {
namespace hand_over_test {

/// `line` in a shell, with `clearway` before it.
CommandRun run_program(const std::string& line, const std::string& program = CLEARWAY_BINARY) {
  const TemporaryFolder folder;
  const std::string command = "'" + program + "' " + line + " 2> " + folder.file("log");
  CommandRun run;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> part{};
  for (std::size_t count = 0; (count = fread(part.data(), 1, part.size(), pipe)) > 0;)
    run.out.append(part.data(), count);
  const int status = pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  run.log = read_file(folder.path() / "log");
  return run;
}

void expect_same(const CommandRun& a, const CommandRun& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.out, b.out);
  EXPECT_EQ(a.log, b.log);
}

std::string libraries_of(const std::string& program) { return run_program("'" + program + "'", "ldd").out; }

TEST(HandOver, TheProgramLoadsNothingForSensors) {
  const std::string own = libraries_of(CLEARWAY_BINARY);
  const std::string full = libraries_of(
      (std::filesystem::path(CLEARWAY_BINARY).parent_path().parent_path() / "libexec" / "clearway-full")
          .string());
  for (const char* library : {"libvtk", "libmrpt", "libopencv", "libpcl"}) {
    EXPECT_EQ(own.find(library), std::string::npos) << library;
    EXPECT_NE(full.find(library), std::string::npos) << library;
  }
  EXPECT_NE(own.find("libfcl"), std::string::npos);
}

class HandOverOfMaps : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("cloud.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n3 2 0.1\n3 2.1 0.1\n3 2.2 0.2\n");
    ASSERT_EQ(run_command({"inspect", folder_.file("cloud.ply"), "--export", folder_.file("map.ot")}).status,
              0);
  }
  std::string file(const std::string& name) const { return folder_.file(name); }

  const TemporaryFolder folder_;
};

TEST_F(HandOverOfMaps, CloudsAreReadWhereverAMapIs) {
  expect_same(run_program("inspect " + file("cloud.ply") + " --at 3,2,0.1"),
              run_command({"inspect", file("cloud.ply"), "--at", "3,2,0.1"}));
  expect_same(run_program("inspect " + file("map.ot") + " --diff " + file("cloud.ply")),
              run_command({"inspect", file("map.ot"), "--diff", file("cloud.ply")}));
  const std::string query =
      " --robot point --start 0.2,0 --goal 0.5,0.2 --planner rrtconnect --policy not_occupied";
  expect_same(
      run_program("plan --map " + file("cloud.ply") + query + " --csv " + file("own.csv") + " > /dev/null"),
      {.status = 0, .out = "", .log = ""});
  ASSERT_EQ(run_program("plan --map " + file("map.ot") + query + " --csv " + file("octree.csv")).status, 0);
  EXPECT_EQ(read_file(file("own.csv")), read_file(file("octree.csv")));
  folder_.write("cut.ply", "ply\nformat ascii 1.0\n");
  expect_same(run_program("inspect " + file("cut.ply")), run_command({"inspect", file("cut.ply")}));
}

TEST_F(HandOverOfMaps, SlicesAreDrawn) {
  expect_same(run_program("inspect " + file("map.ot") + " --slice z=0.1 " + file("own.png") + " > /dev/null"),
              {.status = 0, .out = "", .log = ""});
  ASSERT_EQ(run_command({"inspect", file("map.ot"), "--slice", "z=0.1", file("full.png")}).status, 0);
  EXPECT_EQ(read_file(file("own.png")), read_file(file("full.png")));
}

/// The second experiment has a cloud: the tables of both come once.
TEST_F(HandOverOfMaps, AComparisonBeginsOnce) {
  std::string suite = small_suite;
  const std::string at = "experiments:";
  suite.insert(suite.find(at), "  - {name: cloud, map: cloud.ply}\n");
  const std::string wall = "robot: planar2\n    world: wall";
  suite.replace(suite.find(wall), wall.size(), "robot: planar2\n    world: cloud");
  folder_.write("suite.yaml", suite);
  const CommandRun run =
      run_program("compare " + file("suite.yaml") + " --out " + file("out") + " --planners rrtconnect");
  EXPECT_EQ(run.status, 0) << run.log;
  for (const char* title : {"== round", "== swing"}) {
    const std::size_t first = run.out.find(title);
    ASSERT_NE(first, std::string::npos) << run.out << run.log;
    EXPECT_EQ(run.out.find(title, first + 1), std::string::npos);
  }
}

TEST(HandOver, RecordingsAreWrittenAndRead) {
  const TemporaryFolder folder;
  folder.write("setup.yaml", small_setup);
  const std::string scene = folder.write("scene.yaml", small_scene);
  const CommandRun made =
      run_program("simulate " + scene + " --out " + folder.file("own.rawlog") + " --json");
  ASSERT_EQ(made.status, 0) << made.log;
  EXPECT_GT(nlohmann::json::parse(made.out).at("images").get<int>(), 0);
  std::filesystem::create_directory(folder / "by_full");
  ASSERT_EQ(run_command({"simulate", scene, "--out", folder.file("by_full/own.rawlog")}).status, 0);
  EXPECT_EQ(read_file(folder.file("own.rawlog")), read_file(folder.file("by_full/own.rawlog")));
  const std::string recording = folder.file("own.rawlog"), flags = " --no-plan --quiet --out ";
  ASSERT_EQ(run_program("replay " + recording + flags + folder.file("own")).status, 0);
  ASSERT_EQ(run_command({"replay", recording, "--no-plan", "--quiet", "--out", folder.file("full")}).status,
            0);
  EXPECT_EQ(read_file(folder.file("own/map.ot")), read_file(folder.file("full/map.ot")));
  expect_same(run_program("replay nowhere.rawlog --out " + folder.file("x")),
              run_command({"replay", "nowhere.rawlog", "--out", folder.file("x")}));
}

TEST(HandOver, AProgramWithoutTheOtherSaysSo) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "bin");
  std::filesystem::copy(CLEARWAY_BINARY, folder.path() / "bin" / "clearway");
  const CommandRun run =
      run_program("simulate miniature_kitchen --out x.rawlog", folder.file("bin/clearway"));
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  EXPECT_NE(run.log.find("libexec/clearway-full' cannot be started"), std::string::npos) << run.log;
}

}  // namespace hand_over_test
}  // namespace clearway
