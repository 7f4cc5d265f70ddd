#pragma once

#include <chrono>
#include <ctime>

namespace clearway {

/// Wall time, s.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// CPU time that the calling thread has used so far, s; threads that it started count for themselves.
inline double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Adds the CPU time that the calling thread uses in its scope to a total, s.
class ThreadStopwatch {
 public:
  explicit ThreadStopwatch(double& total) : total_(total) {}
  ~ThreadStopwatch() { total_ += thread_cpu_seconds() - begin_; }
  ThreadStopwatch(const ThreadStopwatch&) = delete;
  ThreadStopwatch& operator=(const ThreadStopwatch&) = delete;

 private:
  double& total_;
  double begin_ = thread_cpu_seconds();
};

}  // namespace clearway
