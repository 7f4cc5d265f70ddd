// What a hostile file, a pipe or a slip of the hand may do to any command: one sentence, and nothing else.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <new>
#include <stdexcept>

#include "apps/console/failure.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace hostile_inputs_test {

const std::string source = CLEARWAY_SOURCE_DIR;
const std::string map = source + "/datasets/suites/maps/workbench.bt";

class HostileInputs : public ::testing::Test {
 protected:
  void SetUp() override { ::alarm(60); }  // a command that waits for ever ends the tests
  void TearDown() override { ::alarm(0); }

  void expect_refused(const std::vector<std::string>& arguments, const std::string& because) {
    const CommandRun run = run_command(arguments);
    EXPECT_EQ(run.status, exit_bad_input) << arguments[0] << ": " << run.log;
    EXPECT_TRUE(run.complains_in_one_sentence()) << arguments[0] << ": " << run.log;
    EXPECT_NE(run.log.find(because), std::string::npos) << arguments[0] << ": " << run.log;
    EXPECT_LT(run.log.size(), 700u) << run.log;
  }

  TemporaryFolder folder_;
};

TEST_F(HostileInputs, a_pipe_or_a_device_is_refused_as_any_input_of_any_command) {
  const std::string plan = folder_.write("plan.json", "{}"), out = folder_.file("out");
  const std::string zeros = "0,0,0,0,0";
  const auto fifo = [&](const std::string& name) {
    EXPECT_EQ(::mkfifo(folder_.file(name).c_str(), 0600), 0);
    return folder_.file(name);
  };
  const std::string pipe = fifo("pipe");
  for (const std::string& file : {pipe, std::string("/dev/zero"), std::string("/dev/stdin")}) {
    const std::string because = file == pipe ? "it is a pipe" : "cannot be read: it is a ";
    expect_refused({"check", file, "--map", map, "--robot", "arm5"}, because);
    expect_refused({"replay", file, "--out", out}, because);
    expect_refused({"compare", file, "--out", out}, because);
    expect_refused({"simulate", file, "--out", out}, because);
    const std::string scene = folder_.write("scene.yaml", "setup: setup.yaml\n");
    std::filesystem::remove(folder_.file("setup.yaml"));
    std::filesystem::create_symlink(file, folder_.file("setup.yaml"));
    expect_refused({"simulate", scene, "--out", out}, because);
  }
  for (const char* kind : {".ot", ".bt", ".pcd", ".ply"})
    expect_refused({"inspect", fifo(std::string("map") + kind)}, "it is a pipe");
  for (const char* kind : {".urdf", ".yaml"}) {
    expect_refused({"plan", "--map", map, "--robot", fifo(std::string("robot") + kind), "--start", zeros,
                    "--goal", zeros, "--planner", "beam"},
                   "it is a pipe");
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(HostileInputs, of_a_file_that_is_none_of_ours_nothing_is_shown) {
  const std::string secret = folder_.write("secret", "root:x:0:0:topsecret:/root:/bin/bash\n");
  const std::string out = folder_.file("out.rawlog");
  std::filesystem::create_symlink(secret, folder_.file("secret.yaml"));
  for (const std::string& text : {"setup: " + secret, std::string("setup: secret.yaml")}) {
    const std::string scene = folder_.write("scene.yaml", text + "\n");
    const CommandRun run = run_command({"simulate", scene, "--out", out});
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_EQ(run.log.find("topsecret"), std::string::npos) << run.log;
  }
  expect_refused({"simulate", folder_.write("scene.yaml", "setup: /etc/passwd\n"), "--out", out},
                 "expected the name of a .yaml file, got '/etc/passwd'");
  for (const char* command : {"simulate", "compare"}) {
    const CommandRun run = run_command({command, secret, "--out", out});
    EXPECT_EQ(run.log.find("topsecret"), std::string::npos) << run.log;
  }
}

TEST_F(HostileInputs, what_is_repeated_from_a_file_is_short_and_cannot_command_a_terminal) {
  const std::string out = folder_.file("out");
  const std::string endless(100'000, 'x'), colour = "\\e[31m\\e]0;owned\\a";
  for (const std::string& yaml :
       {"title: a\n? " + endless + "\n: 1\n", "seed: " + endless + "\n", "name: " + endless + "\n",
        "worlds: [{name: w, map: " + endless + "}]\n", "title: \"" + colour + "\"\n",
        "\"" + colour + "\": 1\n", "worlds: [{name: \"" + colour + "\", map: a.bt}]\n",
        "worlds: [{name: w, map: a.bt}]\nexperiments: [{name: e, robot: arm5, world: " + endless + "}]\n"}) {
    const CommandRun run = run_command({"compare", folder_.write("suite.yaml", yaml), "--out", out});
    EXPECT_EQ(run.status, exit_bad_input);
    EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
    EXPECT_LT(run.log.size(), 600u);
    EXPECT_EQ(run.log.find('\x1b'), std::string::npos) << run.log;
  }
  const std::string robot = folder_.write("r.yaml", "? " + endless + "\n: 1\n");
  expect_refused({"plan", "--map", map, "--robot", robot, "--start", "0", "--goal", "0", "--planner", "beam"},
                 "unknown key 'xxx");
}

TEST_F(HostileInputs, json_that_is_none_is_reported_by_line_and_column_in_our_words) {
  const auto check = [&](const std::string& text) {
    return std::vector<std::string>{"check", folder_.write("plan.json", text), "--map", map, "--robot",
                                    "arm5"};
  };
  expect_refused(check("{\"robot\": \"x\",\n \"joints\": [1,,2]}"),
                 "is not valid JSON at line 2, column 15: expected a value");
  expect_refused(check(std::string(100'000, '[')), "at most 64 arrays and objects inside each other");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "{\"a\":";
  expect_refused(check(deep), "at most 64 arrays and objects inside each other");
}

TEST(Failure, what_libraries_and_the_language_throw_never_reaches_the_user) {
  const auto failure_from = [](const auto& error) { return failure_of(std::make_exception_ptr(error)); };
  for (const Failure& failure : {failure_from(std::bad_alloc()), failure_from(std::bad_array_new_length()),
                                 failure_from(std::length_error("vector::_M_default_append"))}) {
    EXPECT_EQ(failure.status, exit_bad_input);
    EXPECT_TRUE(failure.sentence.starts_with("out of memory: expected")) << failure.sentence;
  }
  for (const Failure& failure :
       {failure_from(std::out_of_range("vector::_M_range_check")), failure_from(std::logic_error("x")),
        failure_from(std::bad_cast()), failure_from(3)}) {
    EXPECT_EQ(failure.status, exit_bad_input);
    EXPECT_EQ(failure.sentence, "a library that the program uses could not handle its input");
  }
  EXPECT_EQ(failure_from(std::invalid_argument("plan 'a\x1b[1mb'\nis wrong")).sentence,
            "plan 'a\\x1b[1mb'\\nis wrong");
  EXPECT_LT(failure_from(std::runtime_error(std::string(100'000, 'x'))).sentence.size(), 2010u);
  const Failure gone = failure_from(std::filesystem::filesystem_error(
      "cannot rename", "/a", std::make_error_code(std::errc::no_such_file_or_directory)));
  EXPECT_EQ(gone.sentence, "'/a' cannot be used: No such file or directory");
}

}  // namespace hostile_inputs_test
}  // namespace clearway
