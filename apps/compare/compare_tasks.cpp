#include "apps/compare/compare_tasks.hpp"

namespace clearway {

std::optional<StageTask> StageTasks::next() {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (failed_) return std::nullopt;
    if (!open_.empty()) return take();
    if (next_stage_ < stages_) {
      open_one(lock);
    } else if (making_ > 0) {
      changed_.wait(lock);
    } else {
      return std::nullopt;
    }
  }
}

void StageTasks::fail() {
  const std::lock_guard lock(mutex_);
  failed_ = true;
  changed_.notify_all();
}

StageTask StageTasks::take() {
  StageTask task{open_.front(), open_.front()->next++};
  if (open_.front()->next == open_.front()->stage.problems.size()) open_.pop_front();
  return task;
}

void StageTasks::open_one(std::unique_lock<std::mutex>& lock) {
  const std::size_t index = next_stage_++;
  ++making_;
  lock.unlock();
  std::shared_ptr<OpenStage> made = make_(index);
  lock.lock();
  --making_;
  if (!made->stage.problems.empty()) open_.push_back(std::move(made));
  changed_.notify_all();
}

}  // namespace clearway
