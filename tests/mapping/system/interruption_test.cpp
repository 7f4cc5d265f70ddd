#include "mapping/system/interruption.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <optional>
#include <thread>

#include "mapping/system/atomic_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace interruption_test {

struct Ending {
  int status = 0;
  std::string what_is_there;
};

/// What a process leaves that does `work` and then gets SIGTERM.
template <typename Work>
Ending ended_by_signal(const Work& work) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    end_in_order_on_signals([&](int, const std::string& there) {
      [[maybe_unused]] const auto written = ::write(ends[1], there.data(), there.size());
    });
    work();
    ::_exit(0);
  }
  ::close(ends[1]);
  Ending ending;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = ::read(ends[0], buffer.data(), buffer.size())) > 0;)
    ending.what_is_there.append(buffer.data(), static_cast<std::size_t>(n));
  ::close(ends[0]);
  ::waitpid(child, &ending.status, 0);
  return ending;
}

void expect_ended(const Ending& ending, const std::string& what_is_there) {
  EXPECT_TRUE(WIFEXITED(ending.status));
  EXPECT_EQ(WEXITSTATUS(ending.status), 128 + SIGTERM);
  EXPECT_EQ(ending.what_is_there, what_is_there);
}

[[noreturn]] void wait_for_sigterm() {
  ::kill(::getpid(), SIGTERM);
  for (;;) ::pause();
}

TEST(Interruption, EndsWorkWhatBeganLastFirst) {
  expect_ended(ended_by_signal([] { wait_for_sigterm(); }), "nothing was written");
  expect_ended(ended_by_signal([] {
                 const UnfinishedWork first([] { return "the first"; });
                 {
                   const UnfinishedWork done([] { return "what is done"; });
                 }
                 const UnfinishedWork second([] { return "the second"; }), silent([] { return ""; });
                 written_file("a.csv");
                 wait_for_sigterm();
               }),
               "the second; the first; 'a.csv' is written whole");
}

/// As the tables of a comparison that is interrupted, each of which is a file that is written in its turn.
TEST(Interruption, WorkMayBeginAndEndOtherWorkWhileItEnds) {
  for (const int begun : {1, 3, 4, 100}) {
    expect_ended(ended_by_signal([&] {
                   const UnfinishedWork first([] { return "the first"; }, "folder");
                   const UnfinishedWork second([&]() -> std::string {
                     std::deque<UnfinishedWork> other;
                     for (int i = 0; i < begun; ++i) other.emplace_back([] { return "never"; });
                     written_file("folder/table.csv");
                     return "the second";
                   });
                   wait_for_sigterm();
                 }),
                 "the second; the first");
  }
}

TEST(Interruption, TheFirstSignalOnlyAsksWhoEndsInOrder) {
  for (const int signals : {1, 2}) {
    const Ending ending = ended_by_signal([&] {
      std::atomic<int> asked = 0;
      const UnfinishedWork work([&] { return "the work, asked " + std::to_string(asked.load()) + " time"; });
      std::optional<OrderlyEnd> orderly(std::in_place, [&](int number) { asked += number == SIGTERM; });
      ::kill(::getpid(), SIGTERM);
      while (asked == 0) std::this_thread::yield();
      if (signals == 2) wait_for_sigterm();
      orderly.reset();
      wait_for_sigterm();  // as without it
    });
    expect_ended(ending, "the work, asked 1 time");
  }
}

/// Another thread that goes on with its work while the signal's ends.
TEST(Interruption, NoFolderIsMadeAfterItsWorkEnded) {
  const TemporaryFolder folder;
  const auto work = folder / "work";
  expect_ended(ended_by_signal([&] {
                 const UnfinishedWork all([&] {
                   std::filesystem::remove_all(work);
                   std::this_thread::sleep_for(std::chrono::milliseconds(50));
                   return "removed";
                 });
                 ::kill(::getpid(), SIGTERM);
                 for (;;) make_folder_of(work / "plans" / "plan.json");
               }),
               "removed");
  EXPECT_FALSE(std::filesystem::exists(work));
}

}  // namespace interruption_test
}  // namespace clearway
