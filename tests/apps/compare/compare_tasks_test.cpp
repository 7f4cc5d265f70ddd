#include "apps/compare/compare_tasks.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <stdexcept>
#include <thread>

#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace compare_tasks_test {

std::shared_ptr<OpenStage> stage_of(std::size_t index, std::size_t problems) {
  SuiteStage stage;
  stage.problems.resize(problems);
  return std::make_shared<OpenStage>(
      OpenStage{stage, ConfigurationSpace(load_robot("point"), stage.map), index});
}

TEST(StageTasks, EveryProblemIsGivenOutOnceToSomeThread) {
  const std::vector<std::size_t> problems{3, 0, 1, 7, 0, 0, 2, 1, 1, 5};
  for (const int threads : {1, 2, 5}) {
    StageTasks tasks(problems.size(), [&](std::size_t index) { return stage_of(index, problems[index]); });
    std::mutex mutex;
    std::map<std::pair<std::size_t, std::size_t>, int> given;
    std::vector<std::jthread> workers;
    for (int i = 0; i < threads; ++i) {
      workers.emplace_back([&] {
        while (const auto task = tasks.next()) {
          const std::lock_guard lock(mutex);
          ++given[{task->stage->index, task->problem}];
        }
      });
    }
    workers.clear();
    EXPECT_EQ(given.size(), 20U);
    for (const auto& [task, times] : given) {
      EXPECT_EQ(times, 1);
      EXPECT_LT(task.second, problems[task.first]);
    }
  }
}

TEST(StageTasks, OneThreadHoldsOneStageAtATime) {
  std::vector<std::weak_ptr<OpenStage>> made;
  StageTasks tasks(4, [&](std::size_t index) {
    for (const auto& stage : made) EXPECT_TRUE(stage.expired());
    const auto stage = stage_of(index, 2);
    made.push_back(stage);
    return stage;
  });
  while (tasks.next()) {
  }
  EXPECT_EQ(made.size(), 4U);
}

TEST(StageTasks, NobodyWaitsForAStageThatCannotBeMade) {
  std::atomic<int> failures = 0;
  StageTasks tasks(2, [](std::size_t index) -> std::shared_ptr<OpenStage> {
    if (index == 0) throw std::runtime_error("no map");
    return stage_of(index, 1);
  });
  std::vector<std::jthread> workers;
  for (int i = 0; i < 3; ++i) {
    workers.emplace_back([&] {
      try {
        while (tasks.next()) {
        }
      } catch (const std::runtime_error&) {
        ++failures;
        tasks.fail();
      }
    });
  }
  workers.clear();
  EXPECT_EQ(failures, 1);
  EXPECT_FALSE(tasks.next().has_value());
}

}  // namespace compare_tasks_test
}  // namespace clearway
