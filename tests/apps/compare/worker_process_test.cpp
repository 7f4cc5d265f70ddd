#include "apps/compare/worker_process.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <string>

namespace clearway {
namespace worker_process_test {

/// All that arrives until there are `count` replies or the worker has ended.
std::vector<std::string> wait_for(WorkerProcess& worker, std::size_t count) {
  std::vector<std::string> all;
  while (all.size() < count && !worker.has_ended())
    for (std::string& reply : worker.replies()) all.push_back(std::move(reply));
  return all;
}

TEST(WorkerProcess, AnswersInTurnAndKeepsWhatItPrepared) {
  int asked = 0;  // the worker's copy counts, ours does not
  WorkerProcess worker([&](std::string_view request, const WorkerProcess::Reply& reply) {
    reply(std::string(request) + std::to_string(++asked));
    if (request == "twice") reply("again");
  });
  worker.ask("a");
  worker.ask("twice");
  worker.ask("");
  EXPECT_EQ(wait_for(worker, 4), (std::vector<std::string>{"a1", "twice2", "again", "3"}));
  EXPECT_EQ(asked, 0);
}

TEST(WorkerProcess, CarriesLargeMessagesOfAnyBytes) {
  WorkerProcess worker([](std::string_view request, const WorkerProcess::Reply& reply) {
    std::string all;
    for (int i = 0; i < 100; ++i) all += request;
    reply(all);
  });
  std::string bytes;
  for (int i = 0; i < 30000; ++i) bytes += static_cast<char>(i * 7);
  worker.ask(bytes);
  const auto replies = wait_for(worker, 1);
  ASSERT_EQ(replies.size(), 1U);
  ASSERT_EQ(replies[0].size(), 100 * bytes.size());
  for (std::size_t i = 0; i < 100; ++i)
    ASSERT_EQ(replies[0].compare(i * bytes.size(), bytes.size(), bytes), 0) << i;
}

TEST(WorkerProcess, ReportsHowItEnded) {
  WorkerProcess crashing([](std::string_view, const WorkerProcess::Reply& reply) {
    reply("before");
    ::raise(SIGSEGV);
  });
  crashing.ask("go");
  EXPECT_EQ(wait_for(crashing, 9), std::vector<std::string>{"before"});
  ASSERT_TRUE(crashing.has_ended());
  EXPECT_EQ(crashing.how_it_ended(), "ended by SIGSEGV");
  WorkerProcess leaving([](std::string_view, const WorkerProcess::Reply&) { ::_exit(3); });
  leaving.ask("go");
  EXPECT_TRUE(wait_for(leaving, 1).empty());
  EXPECT_EQ(leaving.how_it_ended(), "ended with status 3");
}

TEST(WorkerProcess, EndsWithItsObjectWhateverItDoes) {
  std::vector<std::string> replies;
  {
    WorkerProcess worker([](std::string_view, const WorkerProcess::Reply& reply) {
      reply(std::to_string(::getpid()));
      for (;;) ::pause();
    });
    worker.ask("go");
    replies = wait_for(worker, 1);
  }
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(::kill(static_cast<pid_t>(std::stol(replies[0])), 0), -1) << "it is gone";
}

TEST(WorkerProcess, HasItsPlaceToItselfBesideOthers) {
  const auto echo = [](std::string_view request, const WorkerProcess::Reply& reply) { reply(request); };
  auto first = std::make_unique<WorkerProcess>(echo);
  WorkerProcess second(echo);  // holds no end of the first one's pipes
  first->ask("one");
  second.ask("two");
  EXPECT_EQ(wait_for(*first, 1), std::vector<std::string>{"one"});
  first.reset();
  EXPECT_EQ(wait_for(second, 1), std::vector<std::string>{"two"});
}

}  // namespace worker_process_test
}  // namespace clearway
