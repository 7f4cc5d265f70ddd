#include "mapping/system/child_process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <vector>

namespace clearway {
namespace child_process_test {

constexpr ChildLimits roomy{std::size_t{64} << 20U, std::size_t{16} << 20U, 10};

TEST(ChildProcess, BringsBackWhatTheWorkReturned) {
  std::string bytes;
  for (int i = 0; i < 1000000; ++i) bytes += static_cast<char>(i * 7);
  const ChildOutcome outcome = run_in_child([&] { return bytes; }, roomy);
  EXPECT_TRUE(outcome.finished);
  EXPECT_EQ(outcome.parts, std::vector{bytes});
  EXPECT_TRUE(run_in_child([] { return std::string(); }, roomy).finished);
}

TEST(ChildProcess, ReportsTheTextOfAnException) {
  const ChildOutcome outcome =
      run_in_child([]() -> std::string { throw std::runtime_error("no such field"); }, roomy);
  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.failure, "no such field");
}

TEST(ChildProcess, SurvivesACrashOrAnEarlyExit) {
  const auto crash = []() -> std::string {
    std::raise(SIGSEGV);
    return "";
  };
  const auto leave = []() -> std::string { ::_exit(0); };
  EXPECT_FALSE(run_in_child(crash, roomy).finished);
  EXPECT_FALSE(run_in_child(leave, roomy).finished);
  EXPECT_FALSE(run_in_child(leave, roomy).failure.empty());
}

TEST(ChildProcess, EndsWorkThatTakesTooLong) {
  const auto sleep = []() -> std::string {
    ::sleep(60);
    return "late";
  };
  const ChildOutcome outcome = run_in_child(sleep, {std::size_t{64} << 20U, 100, 1});
  EXPECT_FALSE(outcome.finished);
  EXPECT_NE(outcome.failure.find("longer than 1 s"), std::string::npos);
  const auto wait = []() -> std::string {  // as where others keep the processor busy
    ::usleep(1'200'000);
    return "in time";
  };
  EXPECT_FALSE(run_in_child(wait, {std::size_t{64} << 20U, 100, 1}).finished);
  EXPECT_TRUE(
      run_in_child(wait, {.memory = std::size_t{64} << 20U, .output = 100, .seconds = 1, .patience = 8})
          .finished);
}

TEST(ChildProcess, RefusesMoreOutputThanAllowed) {
  EXPECT_FALSE(
      run_in_child([] { return std::string(5000, 'x'); }, {std::size_t{64} << 20U, 1000, 10}).finished);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildProcess, StopsWorkThatEatsMemory) {
  const auto eat = []() -> std::string { return std::string(std::size_t{2} << 30U, 'x').substr(0, 1); };
  EXPECT_FALSE(run_in_child(eat, roomy).finished);
}
#endif

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildProcess, SaysInOurWordsThatMemoryRanOut) {
  const auto eat = []() -> std::string { return std::string(std::size_t{2} << 30U, 'x'); };
  EXPECT_EQ(run_in_child(eat, roomy).failure, "it asks for more memory than a file of its size can justify");
}
#endif

TEST(ChildProcess, WorkThatNeverYieldsEndsWithItsProcessorTimeToo) {
  const auto spin = []() -> std::string {
    const volatile bool busy = true;
    while (busy) {
    }
    return "";
  };
  EXPECT_EQ(run_in_child(spin, {std::size_t{64} << 20U, 100, 1}).failure, "it took longer than 1 s");
}

TEST(ChildProcess, PartsThatArrivedBeforeACrashAreKept) {
  const ChildOutcome outcome = run_in_child(
      [](const SendPart& send_part) {
        send_part("one");
        send_part("");
        send_part("three");
        std::raise(SIGSEGV);
      },
      roomy);
  EXPECT_FALSE(outcome.finished);
  EXPECT_EQ(outcome.failure, "its reader crashed");
  EXPECT_EQ(outcome.parts, (std::vector<std::string>{"one", "", "three"}));
}

volatile std::sig_atomic_t caught = 0;

TEST(ChildProcess, HasNoneOfTheParentsFilesAndSignalHandlersAndWritesNoFile) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const auto before = std::signal(SIGTERM, [](int) { caught = 1; });
  const auto look = [&]() -> std::string {
    const bool open = ::write(ends[1], "x", 1) == 1;
    const bool handled = ::signal(SIGTERM, SIG_DFL) != SIG_DFL;
    ::signal(SIGXFSZ, SIG_IGN);
    const std::string name = "/tmp/clearway_child_" + std::to_string(::getpid());
    const int file = ::open(name.c_str(), O_CREAT | O_WRONLY, 0600);
    const bool written = file >= 0 && ::write(file, "x", 1) == 1;
    ::unlink(name.c_str());
    return std::string(open ? "open " : "") + (handled ? "handled " : "") + (written ? "written" : "");
  };
  EXPECT_EQ(run_in_child(look, roomy).parts, std::vector<std::string>{""});
  std::signal(SIGTERM, before);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(ChildProcess, IsSilent) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  run_in_child(
      [] {
        std::cout << "chatter" << std::endl;
        std::cerr << "chatter" << std::endl;
        return std::string();
      },
      roomy);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace child_process_test
}  // namespace clearway
