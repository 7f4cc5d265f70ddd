#include "mapping/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <stdexcept>
#include <vector>

namespace clearway {
namespace {

constexpr ChildLimits roomy{std::size_t{64} << 20U, std::size_t{16} << 20U, 10};

TEST(ChildProcess, BringsBackWhatTheWorkReturned) {
  std::string bytes;
  for (int i = 0; i < 1000000; ++i) bytes += static_cast<char>(i * 7);
  const ChildOutcome outcome = run_in_child([&] { return bytes; }, roomy);
  EXPECT_TRUE(outcome.finished);
  EXPECT_EQ(outcome.output, bytes);
  EXPECT_TRUE(run_in_child([] { return std::string(); }, roomy).finished);
}

TEST(ChildProcess, TellsTheTextOfAnException) {
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

}  // namespace
}  // namespace clearway
