#include "datasets/sources/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace clearway {

size_t thread_count() {
  size_t count = std::thread::hardware_concurrency();
  if (const char* given = std::getenv("CLEARWAY_THREADS"))
    std::from_chars(given, given + std::strlen(given), count);
  return std::clamp<size_t>(count, 1, 64);
}

void on_threads(size_t threads, const std::function<bool()>& step) {
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
  for (size_t i = 1; i < threads; ++i) others.emplace_back(run);
  run();
  others.clear();
  if (error) std::rethrow_exception(error);
}

void for_each_index(size_t count, const std::function<void(size_t)>& work) {
  std::atomic<size_t> next = 0;
  on_threads(std::min(thread_count(), count), [&] {
    const size_t i = next++;
    if (i >= count) return false;
    work(i);
    return true;
  });
}

}  // namespace clearway
