// Linked into a test program whose sources hold probes, calls of clearway_reached(number): writes for each
// suite of tests its seconds of CPU time and the probes that it reached, a line each, to the file
// CLEARWAY_REACHED.

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <string>

namespace {

constexpr std::size_t most = 4096;

/// Shared with children that a test forks.
std::atomic<char>* table() {
  static auto* const made = static_cast<std::atomic<char>*>(
      ::mmap(nullptr, most, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  return made;
}

double seconds(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

class Reached : public testing::EmptyTestEventListener {
  void OnTestProgramStart(const testing::UnitTest& /*program*/) override { write("*"); }
  void OnTestSuiteEnd(const testing::TestSuite& suite) override { write(suite.name()); }

  void write(const std::string& suite) {
    const double now = seconds(RUSAGE_SELF) + seconds(RUSAGE_CHILDREN);
    std::ofstream out(std::getenv("CLEARWAY_REACHED"), std::ios::app);
    out << suite << ' ' << now - before_;
    before_ = now;
    for (std::size_t i = 0; i < most; ++i)
      if (table()[i].exchange(0) != 0) out << ' ' << i;
    out << '\n';
  }

  double before_ = 0.0;
};

const bool listens = [] {
  testing::UnitTest::GetInstance()->listeners().Append(new Reached);
  return true;
}();

}  // namespace

extern "C" void clearway_reached(int number) {
  std::atomic<char>& probe = table()[static_cast<std::size_t>(number)];
  if (probe.load(std::memory_order_relaxed) == 0) probe.store(1, std::memory_order_relaxed);
}
