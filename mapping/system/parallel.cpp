#include "mapping/system/parallel.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace clearway {
namespace {

using Work = std::function<void(std::size_t)>;

/// The helpers of one thread.
class Helpers {
 public:
  Helpers() = default;
  Helpers(const Helpers&) = delete;
  Helpers& operator=(const Helpers&) = delete;

  ~Helpers() {
    {
      const std::lock_guard lock(guard_);
      ending_ = true;
    }
    wake_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  void run(std::size_t threads, const Work& work) {
    while (threads_.size() + 1 < threads) {
      const std::size_t index = threads_.size() + 1;
      threads_.emplace_back([this, index, call = call_] { help(index, call); });
    }
    {
      const std::lock_guard lock(guard_);
      work_ = &work;
      wanted_ = threads;
      missing_ = threads - 1;
      failure_ = nullptr;
      ++call_;
    }
    wake_.notify_all();
    try_to(work, 0);
    std::unique_lock lock(guard_);
    done_.wait(lock, [&] { return missing_ == 0; });
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void help(std::size_t index, std::uint64_t call) {
    std::unique_lock lock(guard_);
    while (true) {
      wake_.wait(lock, [&] { return ending_ || call_ != call; });
      if (ending_) return;
      call = call_;
      if (index >= wanted_) continue;
      const Work& work = *work_;
      lock.unlock();
      try_to(work, index);
      lock.lock();
      if (--missing_ == 0) done_.notify_one();
    }
  }

  void try_to(const Work& work, std::size_t index) {
    try {
      work(index);
    } catch (...) {
      const std::lock_guard lock(guard_);
      failure_ = std::current_exception();
    }
  }

  std::mutex guard_;
  std::condition_variable wake_, done_;
  const Work* work_ = nullptr;
  std::size_t wanted_ = 0, missing_ = 0;
  std::uint64_t call_ = 0;  ///< number of the present call
  bool ending_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;
};

/// A forked process inherits the object but not its threads; it leaves it alone and makes one of its own.
struct Owner {
  Helpers* helpers = nullptr;
  pid_t process = 0;

  Owner() = default;
  Owner(const Owner&) = delete;
  Owner& operator=(const Owner&) = delete;
  ~Owner() {
    if (process == getpid()) delete helpers;
  }
};
thread_local Owner owner;

}  // namespace

void parallel(std::size_t threads, const Work& work) {
  if (threads <= 1) return work(0);
  if (owner.process != getpid()) {
    owner.helpers = new Helpers;
    owner.process = getpid();
  }
  owner.helpers->run(threads, work);
}

void parallel_until_false(std::size_t threads, const std::function<bool()>& step) {
  std::atomic<bool> has_failed = false;
  std::exception_ptr error;
  std::mutex error_mutex;
  const auto run = [&] {
    try {
      while (!has_failed && step()) {
      }
    } catch (...) {
      has_failed = true;
      const std::lock_guard lock(error_mutex);
      if (!error) error = std::current_exception();
    }
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < threads; ++i) others.emplace_back(run);
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

void parallel_for(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  parallel_until_false(std::min(thread_count(), count), [&] {
    const std::size_t i = next++;
    if (i >= count) return false;
    work(i);
    return true;
  });
}

std::size_t thread_count() {
  std::size_t count = std::thread::hardware_concurrency();
  if (const char* given = std::getenv("CLEARWAY_THREADS"))
    std::from_chars(given, given + std::strlen(given), count);
  return std::clamp<std::size_t>(count, 1, 64);
}

}  // namespace clearway
