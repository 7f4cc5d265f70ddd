#include "apps/compare/line_process.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <string>
#include <thread>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace line_process_test {

const auto never = [] { return false; };

/// What the end of a program is told as.
std::string end_of(const std::string& command) {
  try {
    LineProcess(command).ask("line", never);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(LineProcess, AnswersLineByLineHoweverLongTheyAre) {
  LineProcess cat("cat");
  EXPECT_EQ(cat.ask("one", never), "one");
  const std::string long_line(std::size_t{3} << 20U, 'x');  // more than any buffer between holds
  EXPECT_EQ(cat.ask(long_line, never), long_line);
  EXPECT_EQ(cat.ask("", never), "");
  EXPECT_GE(cat.cpu_seconds(), 0.0);
}

TEST(LineProcess, ReadsWhatIsWrittenBeforeItAsksAndAfter) {
  LineProcess both("sh -c 'while read l; do echo \"$l $l\"; echo more; done'");
  EXPECT_EQ(both.ask("a", never), "a a");
  EXPECT_EQ(both.ask("b", never), "more");
  EXPECT_EQ(both.ask("c", never), "b b");
}

TEST(LineProcess, GivesUpWhenItIsLate) {
  LineProcess deaf("sleep 1000");
  int asked = 0;
  EXPECT_EQ(deaf.ask("line", [&] { return ++asked > 3; }), std::nullopt);
}

/// What the shell itself does before a program, and signals as programs expect them.
TEST(LineProcess, RunsWhateverTheShellRuns) {
  for (const char* command : {"WORD=b sh -c 'read l; echo $l $WORD'", "cd / && sh -c 'read l; echo $l b'",
                              ". /dev/null; sh -c 'read l; echo $l b'", "sed -u 's/$/ b/' | sed -u p -n"})
    EXPECT_EQ(LineProcess(command).ask("a", never), "a b") << command;
}

TEST(LineProcess, LeavesNoSignalBlocked) {
  sigset_t some, before;
  sigemptyset(&some);
  sigaddset(&some, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &some, &before);
  LineProcess reader("sh -c 'read l; grep SigBlk /proc/self/status'");
  EXPECT_EQ(reader.ask("line", never), "SigBlk:\t0000000000000000");
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST(LineProcess, CountsTheWorkOfAProgramBehindTheShell) {
  LineProcess busy(
      "cd / && sh -c 'read l; i=0; while [ $i -lt 60000 ]; do i=$((i+1)); done; echo done; read l' && true");
  EXPECT_EQ(busy.ask("line", never), "done");
  EXPECT_GT(busy.cpu_seconds(), 0.01);
}

TEST(LineProcess, SaysHowItEndedAndItsLastLineOfErrors) {
  EXPECT_EQ(end_of("sh -c 'read l; echo first >&2; echo second >&2; exit 3'"),
            "the planner's program ended with status 3; its last line of errors: 'second'");
  EXPECT_EQ(end_of("sh -c 'read l; kill -SEGV $$'"), "the planner's program ended by SIGSEGV");
  EXPECT_NE(end_of("/nowhere/program").find("ended with status 127; its last line of errors: "),
            std::string::npos);
  EXPECT_EQ(end_of("sh -c 'read l; exec 0<&- 1>&-; sleep 1000'"),
            "the planner's program ended without an answer");
  const std::string noisy = end_of("sh -c 'read l; seq 100000 >&2'");  // more than a pipe holds
  EXPECT_EQ(noisy, "the planner's program ended with status 0; its last line of errors: '100000'");
}

TEST(LineProcess, SaysThatAnIsolatedRunMayNotWriteIntoFiles) {
  const std::string python = "sh -c 'read l; echo \"OSError: [Errno 27] File too large\" >&2; exit 1'";
  const std::string ended =
      "the planner's program ended with status 1; its last line of errors: 'OSError: [Errno 27] File too "
      "large'";
  EXPECT_EQ(end_of(python), ended);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit none{0, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);  // as in an isolated run
  const std::string isolated = end_of(python), another = end_of("sh -c 'read l; echo other >&2; exit 1'");
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(isolated,
            ended + "; it tried to write into a file, which an isolated run may not: --isolate no lets it");
  EXPECT_EQ(another.find("--isolate"), std::string::npos) << another;
}

bool is_short_of_memory(const std::string& command) {
  try {
    LineProcess(command).ask("line", never);
  } catch (const ProgramOutOfMemory&) {
    return true;
  } catch (const std::runtime_error&) {
  }
  return false;
}

TEST(LineProcess, SaysWhetherAProgramEndsForWantOfMemoryThatIsLimited) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers map more than any limit";
#endif
  const std::string python = "sh -c 'read l; echo MemoryError >&2; exit 1'";
  EXPECT_FALSE(is_short_of_memory(python));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
  const rlimit much{rlim_t{1} << 40U, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &much), 0);
  EXPECT_TRUE(is_short_of_memory(python));
  EXPECT_FALSE(is_short_of_memory("sh -c 'read l; echo other >&2; exit 1'"));
  EXPECT_FALSE(
      is_short_of_memory("sh -c 'read l; echo CUDA out of memory >&2; echo IndexError >&2; exit 1'"));
  EXPECT_FALSE(is_short_of_memory("sh -c 'read l; echo MemoryError >&2; exit 0'"));
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &before), 0);
}

TEST(LineProcess, SaysThatAnAnswerHasNoNewline) {
  const std::string words = "; its last line has no newline, expected one after each answer";
  EXPECT_EQ(end_of("sh -c 'read l; printf answer'"), "the planner's program ended with status 0" + words);
  EXPECT_EQ(end_of("sh -c 'read l; exit 3'").find("newline"), std::string::npos);
}

TEST(LineProcess, EndsTheProgramAndWhatThatStarted) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "pids").string();
  {
    LineProcess parent("sh -c 'sleep 1000 & echo $$ $! > " + file + "; read l; echo ready; wait'");
    ASSERT_EQ(parent.ask("line", never), "ready");
  }
  std::istringstream pids(read_file(file));
  int count = 0;
  for (pid_t pid = 0; pids >> pid; ++count) {
    bool is_there = true;  // a child of the child is waited for by init, in its own time
    for (int i = 0; i < 500 && is_there; ++i) {
      is_there = ::kill(pid, 0) == 0 &&
                 read_file("/proc/" + std::to_string(pid) + "/stat").find(") Z") == std::string::npos;
      if (is_there) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_FALSE(is_there) << pid;
  }
  EXPECT_EQ(count, 2);
}

}  // namespace line_process_test
}  // namespace clearway
