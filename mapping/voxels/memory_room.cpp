#include "mapping/voxels/memory_room.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// The number that such a file holds; none where it is missing or says "max".
std::optional<std::uint64_t> number_in(const char* path) {
  std::ifstream file(path);
  std::uint64_t number = 0;
  return file >> number ? std::optional(number) : std::nullopt;
}

std::optional<std::uint64_t> available_in_machine() {
  std::ifstream file("/proc/meminfo");
  for (std::string name; file >> name; file.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    std::uint64_t kibibytes = 0;
    if (name == "MemAvailable:" && file >> kibibytes) return 1024 * kibibytes;
  }
  return std::nullopt;
}

/// What a cgroup has used holds files that the system keeps while it needs the memory for nothing else.
std::uint64_t given_back(const char* statistics) {
  std::ifstream file(statistics);
  std::uint64_t sum = 0, value = 0;
  for (std::string name; file >> name >> value;)
    if (name == "inactive_file" || name == "active_file") sum += value;
  return sum;
}

std::optional<std::uint64_t> available_in_group(const char* limit, const char* used, const char* statistics) {
  const auto most = number_in(limit), taken = number_in(used);
  if (!most || !taken) return std::nullopt;
  const std::uint64_t held = *taken - std::min(*taken, given_back(statistics));
  return *most - std::min(*most, held);
}

/// What `ulimit -v` leaves.
std::optional<std::uint64_t> available_in_process() {
  rlimit limit{};
  const auto pages = number_in("/proc/self/statm");
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || !pages) return std::nullopt;
  const std::uint64_t most = limit.rlim_cur,
                      held = *pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return most - std::min(most, held);
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr std::uint64_t giga = 1'000'000'000, mega = 1'000'000;
  return bytes < giga ? std::to_string(bytes / mega) + " MB"
                      : short_text(0.1 * static_cast<double>(bytes / (giga / 10))) + " GB";
}

}  // namespace

std::uint64_t available_memory() {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (const auto& known : {available_in_machine(), available_in_process(),
                            available_in_group("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current",
                                               "/sys/fs/cgroup/memory.stat"),
                            available_in_group("/sys/fs/cgroup/memory/memory.limit_in_bytes",
                                               "/sys/fs/cgroup/memory/memory.usage_in_bytes",
                                               "/sys/fs/cgroup/memory/memory.stat")})
    if (known) least = std::min(least, *known);
  return least;
}

void require_memory(std::uint64_t bytes, const char* what) {
  const std::uint64_t available = available_memory();
  if (bytes <= available - available / 16) return;
  throw std::runtime_error(std::string(what) + " need some " + bytes_text(bytes) + ", and " +
                           bytes_text(available) +
                           " are available: choose coarser voxels or a smaller maximum range");
}

}  // namespace clearway
