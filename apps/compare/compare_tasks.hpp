#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "apps/suites/suite_stages.hpp"

namespace clearway {

/// A stage with the space that all its problems share.
struct OpenStage {
  SuiteStage stage;
  ConfigurationSpace space;
  std::size_t index = 0;
  double space_cpu = 0.0;  ///< s, to make the space
  std::size_t next = 0;    ///< first problem that nobody has taken
};

/// One problem of an open stage.
struct StageTask {
  std::shared_ptr<const OpenStage> stage;
  std::size_t problem = 0;
};

/// Gives out the problems of all stages, in order, to any number of threads. A stage is made by whoever finds
/// no problem left, and goes when nobody works on it any more: few are in memory at a time.
class StageTasks {
 public:
  using MakeStage = std::function<std::shared_ptr<OpenStage>(std::size_t)>;
  StageTasks(std::size_t stages, MakeStage make) : stages_(stages), make_(std::move(make)) {}

  /// Nothing when all is given out, or after fail(). What `make` throws is passed on; call fail() then, or
  /// others wait for ever.
  std::optional<StageTask> next();

  /// Whoever asks from now on gets nothing.
  void fail();

 private:
  StageTask take();
  void open_one(std::unique_lock<std::mutex>& lock);

  std::size_t stages_, next_stage_ = 0, making_ = 0;
  MakeStage make_;
  std::deque<std::shared_ptr<OpenStage>> open_;
  bool failed_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace clearway
