#pragma once

#include <cstdint>

namespace clearway {

/// Bytes that this process may still take before the machine, its cgroup or its own limit of addresses has
/// none left: MemAvailable of /proc/meminfo, /sys/fs/cgroup, RLIMIT_AS. The largest number where none is
/// known.
std::uint64_t available_memory();

/// For work whose memory grows with an input's numbers and would be ended by the system without a word.
/// @param what has to be held, for the sentence: "a scan's voxels".
/// @throws std::runtime_error when more than 15/16 of available_memory() would be taken.
void require_memory(std::uint64_t bytes, const char* what);

}  // namespace clearway
